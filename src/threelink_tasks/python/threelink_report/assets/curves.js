// Curves over time, one below the other, with a cursor; a click or a drag goes to a time.

const LEFT = 54, BELOW = 20, GAP = 26, WIDEST = 180;  // [pixels], [degrees]

const signed = (degrees) => Math.asinh(degrees / 2.5);  // fine around 0, and up to 180 all the same

class CurvesView extends View {
  constructor(player) {
    super(player, "curves");
    const {speed, power, efficiency, theta_s, distance, smoothing} = this.episode;
    const shift = Math.floor(smoothing / 2);  // row j of a mean belongs to state j + shift
    this.rows = [
      {name: "speed", unit: "L/T₀", values: speed, shift},
      {name: "power", unit: "C⊥ L³/T₀²", values: power, shift},
      {name: "efficiency", unit: "%", values: efficiency.map((value) => 100 * value), shift},
      {name: "θs", unit: "°", values: theta_s, shift, map: signed, low: -WIDEST, high: WIDEST,
       ticks: [-180, -30, -2.5, 2.5, 30, 180], weight: 2},
      {name: "distance", unit: "L", values: distance, shift: 0},
    ];
    this.weight = 0;
    for (const row of this.rows) {
      row.above = this.weight;
      this.weight += row.weight ??= 1;
      const top = row.values.reduce((a, b) => b > a ? b : a, 0);
      row.low ??= 0;
      row.high ??= 1.05 * top || 1;
      row.map ??= (value) => value;
    }
    const onPointer = (event) => {
      if (event.type === "pointerdown") this.canvas.setPointerCapture(event.pointerId);
      else if (!event.buttons) return;
      const share = (event.offsetX - LEFT) / (this.width - LEFT - 1);
      player.pause();
      player.seek(share * this.episode.last);
    };
    this.canvas.addEventListener("pointerdown", onPointer);
    this.canvas.addEventListener("pointermove", onPointer);
  }

  x(state) { return LEFT + (this.width - LEFT - 1) * state / Math.max(1, this.episode.last); }
  top(row) { return row.above / this.weight * (this.height - BELOW); }
  y(row, value) {
    const [low, high] = [row.map(row.low), row.map(row.high)];
    const share = Math.max(0, Math.min(1, (row.map(value) - low) / (high - low)));
    const height = row.weight / this.weight * (this.height - BELOW);
    return this.top(row) + height - 2 - share * (height - GAP);
  }

  drawStill(pen) {
    const {colours, width, height, episode} = this;
    const [begin, end] = [episode.time(0), episode.time(episode.last)];
    for (const time of end > begin ? ticks(begin, end, Math.max(2, width / 110)) : [begin]) {
      const x = this.x(episode.last * (time - begin) / (end - begin || 1));
      this.line(pen, [[x, 0], [x, height - BELOW]], colours.line, 1);
      if (x > LEFT + 24)
        this.text(pen, label(time), Math.min(x, width - 16), height - 5, colours.quiet, "center");
    }
    this.text(pen, "time / T₀", 0, height - 5, colours.quiet);
    for (const row of this.rows) {
      if (row.map === signed) {
        pen.fillStyle = colours.band;
        const top = this.y(row, 2.5);
        pen.fillRect(LEFT, top, width - LEFT, this.y(row, -2.5) - top);
      }
      for (const value of row.ticks || ticks(row.low, row.high, 2)) {
        const y = this.y(row, value);
        this.line(pen, [[LEFT, y], [width, y]], colours.line, 1);
        this.text(pen, label(value), LEFT - 5, y, colours.quiet, "right", "middle");
      }
      this.drawCurve(pen, row);
    }
  }

  // Of all values in a pixel column the lowest and the highest.
  drawCurve(pen, row) {
    const {values, shift} = row;
    pen.beginPath();
    let column = -1, low, high, open = false;
    const flush = () => {
      if (!(low <= high)) { open = false; return; }
      const x = LEFT + column;
      if (open) pen.lineTo(x, this.y(row, low)); else pen.moveTo(x, this.y(row, low));
      if (high > low) pen.lineTo(x, this.y(row, high));
      open = true;
    };
    for (let i = 0; i < values.length; ++i) {
      const here = Math.round((this.x(i + shift) - LEFT) * 2) / 2;
      const turned = row.map === signed && Math.abs(values[i] - values[i - 1]) > WIDEST;
      if (here !== column || turned) {
        if (column >= 0) flush();
        if (turned) open = false;
        [column, low, high] = [here, Infinity, -Infinity];
      }
      if (values[i] < low) low = values[i];
      if (values[i] > high) high = values[i];
    }
    if (column >= 0) flush();
    pen.strokeStyle = this.colours.swimmer;
    pen.lineWidth = 1.2;
    pen.stroke();
  }

  draw(position) {
    if (!this.width) return;
    const {pen, colours} = this, x = this.x(position);
    this.clear();
    this.lay(this.still);
    this.line(pen, [[x, 0], [x, this.height - BELOW]], colours.ink, 1.2);
    for (const row of this.rows) {
      const {name, unit, values, shift} = row;
      const value = values[Math.floor(position) - shift];
      const known = value !== undefined && !Number.isNaN(value);
      const shown = known ? `${label(Number(value.toPrecision(4)))} ${unit}` : "–";
      this.text(pen, `${name} = ${shown}`, LEFT, this.top(row) + 15, colours.ink);
      if (known) this.disc(pen, [x, this.y(row, value)], 4, colours.swimmer, colours.paper);
    }
  }
}
