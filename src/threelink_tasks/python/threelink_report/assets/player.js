// A player of a recorded episode, for each <section class="threelink-player"> of the page.
//
// Position is the number of a state, with a fraction while it plays: between two states shape and
// place are interpolated. From outside: section.player.seek(), .play(), .pause().

const SPEEDS = [1, 2, 5, 10, 20, 50, 100, 200, 500];  // [T0/s]
const PLEASANT = 30;  // [s] that an episode should take

class Episode {
  constructor(data) {
    Object.assign(this, data);
    for (const [name, text] of Object.entries(data.arrays))
      this[name] = new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
    this.last = this.steps.length - 1;
    this.changes = [];  // states in which the next waypoint is on
    if (this.waypoints.length > 1)
      for (let i = 1; i <= this.last; ++i)
        if (this.target[2 * i] !== this.target[2 * i - 2] ||
            this.target[2 * i + 1] !== this.target[2 * i - 1]) this.changes.push(i);
    if (this.captured) this.changes.push(this.last);
  }

  time(position) { return this.dt * this.at(this.steps, 1, 0, position); }  // [T0]

  // Component c of an array of `width` columns, interpolated.
  at(array, width, c, position) {
    const i = Math.min(Math.floor(position), this.last), j = Math.min(i + 1, this.last);
    const a = array[width * i + c], b = array[width * j + c];
    return a + (position - i) * (b - a);
  }

  point(array, position) { return [0, 1].map((c) => this.at(array, 2, c, position)); }

  reached(position) { return this.changes.filter((state) => state <= position).length; }

  // [[x, y]] of the N + 1 ends of the links, from centroid, heading of link N/2 and hinge angles.
  ends(position) {
    const hinges = this.links - 1, middle = this.links >> 1;
    let angle = this.at(this.heading, 1, 0, position);
    for (let h = middle - 1; h >= 0; --h) angle -= this.at(this.alpha, hinges, h, position);
    const ends = [[0, 0]];
    let [mx, my] = [0, 0];  // mean of the midpoints
    for (let link = 0; link < this.links; ++link) {
      const [x, y] = ends[link];
      const dx = Math.cos(angle) / this.links, dy = Math.sin(angle) / this.links;
      ends.push([x + dx, y + dy]);
      mx += (x + dx / 2) / this.links;
      my += (y + dy / 2) / this.links;
      if (link < hinges) angle += this.at(this.alpha, hinges, link, position);
    }
    const [cx, cy] = this.point(this.centroid, position);
    return ends.map(([x, y]) => [x - mx + cx, y - my + cy]);
  }
}

class Player {
  constructor(section) {
    this.section = section;
    this.episode = new Episode(JSON.parse(section.querySelector(".data").textContent));
    this.position = 0;
    this.playing = false;
    for (const name of ["play", "back", "forth", "speed", "follow", "clock", "scrub"])
      this[name + "Control"] = section.querySelector("." + name);
    this.views = [new WorldView(this), new PlaneView(this), new CurvesView(this)];
    this.scrubControl.max = this.episode.last;
    const wanted = this.episode.dt * this.episode.last / PLEASANT;
    const nearest = SPEEDS.reduce((a, b) =>
      Math.abs(Math.log(b / wanted)) < Math.abs(Math.log(a / wanted)) ? b : a);
    for (const speed of SPEEDS)
      this.speedControl.add(new Option(`${speed} T₀/s`, speed, false, speed === nearest));
    this.listen();
    this.restyle();
  }

  get following() { return this.followControl.checked; }

  listen() {
    this.playControl.onclick = () => this.playing ? this.pause() : this.play();
    this.backControl.onclick = () => this.step(-1);
    this.forthControl.onclick = () => this.step(1);
    this.followControl.onchange = () => this.draw();
    this.scrubControl.oninput = () => this.seek(Number(this.scrubControl.value));
    this.section.addEventListener("keydown", (event) => this.onKey(event));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.restyle());
    new ResizeObserver(() => this.resize()).observe(this.section);
  }

  onKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const onControl = event.target.matches("button, select, input[type=checkbox]");
    const stride = event.shiftKey ? this.episode.smoothing : 1;
    const action = {
      " ": onControl ? null : () => this.playing ? this.pause() : this.play(),
      ArrowLeft: () => this.step(-stride),
      ArrowRight: () => this.step(stride),
      ArrowUp: () => this.changeSpeed(1),
      ArrowDown: () => this.changeSpeed(-1),
      Home: () => this.seek(0),
      End: () => this.seek(this.episode.last),
      f: () => { this.followControl.checked = !this.following; this.draw(); },
    }[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  play() {
    if (this.playing) return;
    if (this.position >= this.episode.last) this.position = 0;
    this.playing = true;
    this.playControl.textContent = "Pause";
    let before = null;
    const tick = (now) => {
      const speed = Number(this.speedControl.value) / this.episode.dt;  // [states/s]
      if (before !== null) this.position += speed * Math.min(now - before, 100) / 1000;
      before = now;
      this.seek(this.position);
      if (this.position >= this.episode.last) this.pause();
      else this.frame = requestAnimationFrame(tick);
    };
    this.frame = requestAnimationFrame(tick);
  }

  pause() {
    cancelAnimationFrame(this.frame);
    this.playing = false;
    this.playControl.textContent = "Play";
  }

  step(count) {
    this.pause();
    this.seek(Math.round(this.position) + count);
  }

  seek(position) {
    this.position = Math.max(0, Math.min(this.episode.last, position));
    this.draw();
  }

  changeSpeed(by) {
    const control = this.speedControl;
    control.selectedIndex = Math.max(0, Math.min(SPEEDS.length - 1, control.selectedIndex + by));
  }

  restyle() {
    const style = getComputedStyle(this.section);
    this.colours = {};
    for (const name of ["paper", "ink", "quiet", "line", "faint", "band", "swimmer", "target"])
      this.colours[name] = style.getPropertyValue("--" + name).trim();
    this.resize();
  }

  resize() {
    for (const view of this.views) view.resize();
    this.draw();
  }

  draw() {
    const {episode, position} = this;
    this.scrubControl.value = position;
    this.clockControl.textContent = `t = ${episode.time(position).toFixed(1)} T₀, step ` +
      `${episode.steps[Math.floor(position)]} of ${episode.steps[episode.last]}`;
    for (const view of this.views) view.draw(position);
  }
}

const sections = document.querySelectorAll(".threelink-player");
for (const section of sections) section.player = new Player(section);
if (sections.length === 1) sections[0].focus({preventScroll: true});  // so that keys work at once
