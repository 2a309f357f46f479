// What the player shows: the world, the phase plane, and curves over time.
//
// Each view keeps what does not change while it plays in a picture of its own, so that also an
// episode of 50,000 steps plays smoothly.

const FONT = '12px system-ui, "DejaVu Sans", sans-serif';
const DEGREES = 180 / Math.PI;
const NEAR = 4;  // a target farther away than this many sizes of the way is only pointed to
const FOLLOWED = 2.4;  // [L] across the view that follows the swimmer
const RECENT = 2000;  // steps of the way that are shown then
const PIECE = 200;  // points of a line that are drawn at once

// About `count` round values between low and high.
function ticks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((s) => s * power >= raw) * power;
  const values = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) values.push(i * step);
  return values;
}

const label = (value) => String(Number(value.toPrecision(6))).replace("-", "−");

class View {
  constructor(player, name) {
    this.player = player;
    this.episode = player.episode;
    this.canvas = player.section.querySelector(`.${name} canvas`);
    this.pen = this.canvas.getContext("2d");
  }

  get colours() { return this.player.colours; }

  resize() {
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    this.prepare(this.canvas);
    this.still = document.createElement("canvas");
    const pen = this.prepare(this.still);
    if (this.width && this.height) this.drawStill(pen);
  }

  // Gives a canvas the size of the view; returns its pen, with the origin in the upper left corner.
  prepare(canvas) {
    const ratio = devicePixelRatio || 1;
    canvas.width = Math.round(this.width * ratio);
    canvas.height = Math.round(this.height * ratio);
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    pen.font = FONT;
    pen.lineJoin = pen.lineCap = "round";
    return pen;
  }

  clear() { this.pen.clearRect(0, 0, this.width, this.height); }
  lay(canvas) { this.pen.drawImage(canvas, 0, 0, this.width, this.height); }

  line(pen, points, colour, width) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.beginPath();
    let count = 0;
    for (const [x, y] of points) {
      pen.lineTo(x, y);
      if (++count % PIECE) continue;  // a browser takes far longer for a long line than for its pieces
      pen.stroke();
      pen.beginPath();
      pen.moveTo(x, y);
    }
    pen.stroke();
  }

  disc(pen, [x, y], radius, fill, edge) {
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.fillStyle = fill;
    pen.fill();
    if (!edge) return;
    pen.strokeStyle = edge;
    pen.lineWidth = 1.5;
    pen.stroke();
  }

  text(pen, words, x, y, colour, align = "left", baseline = "alphabetic") {
    pen.fillStyle = colour;
    pen.textAlign = align;
    pen.textBaseline = baseline;
    pen.fillText(words, x, y);
  }
}

class WorldView extends View {
  constructor(player) {
    super(player, "world");
    this.bounds = this.findBounds();
    this.trail = document.createElement("canvas");
  }

  // [x from, x to, y from, y to] of the whole way, and of targets and waypoints that are near it.
  findBounds() {
    const {centroid, target, waypoints} = this.episode;
    const box = [Infinity, -Infinity, Infinity, -Infinity];
    const add = (x, y) => {
      box[0] = Math.min(box[0], x); box[1] = Math.max(box[1], x);
      box[2] = Math.min(box[2], y); box[3] = Math.max(box[3], y);
    };
    for (let i = 0; i < centroid.length; i += 2) add(centroid[i], centroid[i + 1]);
    const [left, right, bottom, top] = [box[0] - 0.5, box[1] + 0.5, box[2] - 0.5, box[3] + 0.5];
    const reach = NEAR * Math.max(right - left, top - bottom);
    const points = [...waypoints.flat(), ...target];
    for (let i = 0; i < points.length; i += 2)
      if (Math.hypot(points[i] - (left + right) / 2, points[i + 1] - (bottom + top) / 2) < reach)
        add(points[i], points[i + 1]);
    return [Math.min(left, box[0] - 0.1), Math.max(right, box[1] + 0.1),
            Math.min(bottom, box[2] - 0.1), Math.max(top, box[3] + 0.1)];
  }

  look(x, y, scale) { Object.assign(this, {x, y, scale}); }
  lookAtAll() {
    const [left, right, bottom, top] = this.bounds;
    this.look((left + right) / 2, (bottom + top) / 2,
              Math.min(this.width / (right - left), this.height / (top - bottom)));
  }
  place(x, y) {
    return [this.width / 2 + this.scale * (x - this.x), this.height / 2 - this.scale * (y - this.y)];
  }
  placeOf(array, i) { return this.place(array[2 * i], array[2 * i + 1]); }

  drawStill(pen) {
    this.lookAtAll();
    this.drawGround(pen, 0, this.episode.last);
    this.trailPen = this.prepare(this.trail);
    this.drawn = 0;  // states whose way is in the trail
    this.dot = [Infinity, Infinity];
  }

  drawGround(pen, from, to) {
    const {colours, width, height, scale} = this;
    const across = Math.max(2, width / 90), up = Math.max(2, height / 90);
    for (const x of ticks(this.x - width / 2 / scale, this.x + width / 2 / scale, across)) {
      const [px] = this.place(x, 0);
      this.line(pen, [[px, 0], [px, height]], colours.line, 1);
      this.text(pen, label(x), px + 3, height - 4, colours.quiet);
    }
    for (const y of ticks(this.y - height / 2 / scale, this.y + height / 2 / scale, up)) {
      const [, py] = this.place(0, y);
      this.line(pen, [[0, py], [width, py]], colours.line, 1);
      if (py > 14 && py < height - 20) this.text(pen, label(y), 3, py - 3, colours.quiet);
    }
    this.line(pen, this.way(from, to), colours.faint, 1);
  }

  *way(from, to) {
    let ox = Infinity, oy = Infinity;
    for (let i = from; i <= to; ++i) {
      const [x, y] = this.placeOf(this.episode.centroid, i);
      if (i < to && Math.abs(x - ox) + Math.abs(y - oy) < 0.7) continue;  // nothing to see
      yield [ox = x, oy = y];
    }
  }

  // The ways of swimmer and target: a line and dots.
  drawTrail(pen, from, to) {
    this.line(pen, this.way(from, to), this.colours.swimmer, 2);
    if (this.episode.waypoints.length) return;
    for (let i = from; i <= to; ++i) {
      const point = this.placeOf(this.episode.target, i);
      if (Math.hypot(point[0] - this.dot[0], point[1] - this.dot[1]) < 7) continue;
      this.dot = point;
      this.disc(pen, point, 1.7, this.colours.target);
    }
  }

  draw(position) {
    if (!this.width) return;
    const state = Math.floor(position), pen = this.pen;
    this.clear();
    if (this.player.following) {
      const [x, y] = this.episode.point(this.episode.centroid, position);
      this.look(x, y, Math.min(this.width, this.height) / FOLLOWED);
      this.drawGround(pen, Math.max(0, state - RECENT), Math.min(this.episode.last, state + RECENT));
      this.dot = [Infinity, Infinity];
      this.drawTrail(pen, Math.max(0, state - RECENT), state);
      this.drawn = Infinity;
    } else {
      this.lookAtAll();
      if (state < this.drawn) this.startTrail();
      if (state > this.drawn) this.drawTrail(this.trailPen, this.drawn, state);
      this.drawn = state;
      this.lay(this.still);
      this.lay(this.trail);
    }
    this.drawWaypoints(pen, this.episode.reached(position));
    this.drawTarget(pen, position);
    this.drawSwimmer(pen, position);
  }

  startTrail() {
    this.trailPen.clearRect(0, 0, this.width, this.height);
    this.drawn = 0;
    this.dot = [Infinity, Infinity];
  }

  drawWaypoints(pen, reached) {
    const {colours} = this;
    this.episode.waypoints.forEach(([x, y], i) => {
      const point = this.place(x, y), done = i < reached;
      const [fill, edge] = done ? [colours.faint, colours.faint] : [colours.paper, colours.target];
      this.disc(pen, point, 5, fill, edge);
      this.text(pen, done ? "✓" : String(i + 1), point[0] + 8, point[1] - 6,
                done ? colours.quiet : colours.ink);
    });
  }

  drawTarget(pen, position) {
    const {episode} = this;
    // A waypoint jumps; only what moves is interpolated.
    const when = episode.waypoints.length ? Math.floor(position) : position;
    const [x, y] = episode.point(episode.target, when);
    if (Number.isNaN(x)) return;
    const [px, py] = this.place(x, y), margin = 16;
    if (px > -margin && px < this.width + margin && py > -margin && py < this.height + margin)
      this.drawStar(pen, px, py);
    else this.drawPointer(pen, Math.atan2(this.height / 2 - py, px - this.width / 2));
  }

  drawStar(pen, x, y) {
    pen.beginPath();
    for (let i = 0; i < 10; ++i) {
      const radius = i % 2 ? 4 : 10, angle = Math.PI * (i / 5 - 0.5);
      pen.lineTo(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
    }
    pen.closePath();
    pen.fillStyle = this.colours.target;
    pen.fill();
    pen.strokeStyle = this.colours.paper;
    pen.lineWidth = 1;
    pen.stroke();
  }

  // An arrow near the edge of the view, towards a target beyond it.
  drawPointer(pen, angle) {
    const c = Math.cos(angle), s = -Math.sin(angle);
    const reach = Math.min((this.width / 2 - 30) / Math.abs(c), (this.height / 2 - 30) / Math.abs(s));
    const [x, y] = [this.width / 2 + reach * c, this.height / 2 + reach * s];
    const {target} = this.colours;
    this.line(pen, [[x - 22 * c, y - 22 * s], [x, y]], target, 3);
    const barb = (side) => [x - 9 * c - side * s, y - 9 * s + side * c];
    this.line(pen, [barb(6), [x, y], barb(-6)], target, 3);
  }

  drawSwimmer(pen, position) {
    const ends = this.episode.ends(position).map(([x, y]) => this.place(x, y));
    this.line(pen, ends, this.colours.paper, 9);
    this.line(pen, ends, this.colours.ink, 5);
    for (const hinge of ends.slice(1, -1))
      this.disc(pen, hinge, 3.5, this.colours.paper, this.colours.ink);
    const centroid = this.place(...this.episode.point(this.episode.centroid, position));
    this.disc(pen, centroid, 4, this.colours.swimmer, this.colours.paper);
  }
}

class PlaneView extends View {
  constructor(player) { super(player, "plane"); }

  place(i) {
    const {alpha, links, jointLimit} = this.episode, hinges = links - 1;
    const half = Math.min(this.width, this.height) / 2 - 4, zoom = half / (jointLimit * 1.08);
    return [this.width / 2 + zoom * this.episode.at(alpha, hinges, 0, i),
            this.height / 2 - zoom * this.episode.at(alpha, hinges, hinges - 1, i)];
  }

  drawStill(pen) {
    const {colours, width, height} = this, {jointLimit} = this.episode;
    const zoom = (Math.min(width, height) / 2 - 4) / (jointLimit * 1.08);
    for (const value of ticks(-jointLimit * DEGREES, jointLimit * DEGREES, 4)) {
      const at = zoom * value / DEGREES;
      this.line(pen, [[width / 2 + at, 0], [width / 2 + at, height]], colours.line, 1);
      this.line(pen, [[0, height / 2 - at], [width, height / 2 - at]], colours.line, 1);
      this.text(pen, label(value), width / 2 + at, height - 3, colours.quiet, "center");
      if (value) this.text(pen, label(value), 2, height / 2 - at - 3, colours.quiet);
    }
    const edge = zoom * jointLimit;
    pen.strokeStyle = colours.faint;
    pen.setLineDash([4, 4]);
    pen.strokeRect(width / 2 - edge, height / 2 - edge, 2 * edge, 2 * edge);
    pen.setLineDash([]);
    this.line(pen, this.orbit(0, this.episode.last), colours.faint, 0.6);
  }

  *orbit(from, to) { for (let i = from; i <= to; ++i) yield this.place(i); }

  draw(position) {
    if (!this.width) return;
    this.clear();
    this.lay(this.still);
    const state = Math.floor(position), from = Math.max(0, state - this.episode.smoothing);
    const stroke = [...this.orbit(from, state), this.place(position)];
    this.line(this.pen, stroke, this.colours.swimmer, 2.5);
    this.disc(this.pen, this.place(position), 5, this.colours.swimmer, this.colours.paper);
  }
}
