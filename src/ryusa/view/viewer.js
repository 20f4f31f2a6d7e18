// A viewer: its state, and what is shown at a moment.

const SIDE = 205;  // pixels of the water's profile
const SECONDS = 12;  // that a whole run takes at first
const VIEWS = { oblique: [-1.15, 0.38], side: [-Math.PI / 2, 0], top: [-Math.PI / 2, Math.PI / 2 - 1e-4] };

class Viewer {
  constructor(holder, data, base64) {
    Object.assign(this, { holder, data, time: data.t[0], playing: false, picked: -1, following: false, fixedShown: true, wallsShown: true, arrowsShown: true, colouring: 0, loaded: -1, scene: -1 });
    this.period = data.period.map((one) => one ?? 0);
    this.camera = new Camera();
    this.build();
    this.painter = new Painter(this.canvas);
    this.ready = decode(data, base64).then((arrays) => { this.arrays = arrays; this.start(); });
  }

  get frames() { return this.data.t.length; }
  get grains() { return this.arrays.radius.length; }
  get highest() { return this.high[2] + 1e-3 * (this.high[2] - this.low[2]); }  // water far above the grains is left out, as in the box
  get aspect() { return this.canvas.width / this.canvas.height; }

  build() {
    const { holder, data } = this;
    holder.classList.add("ryusa-view");
    holder.tabIndex = 0;
    holder.ariaLabel = `${data.title}: grains in motion; h lists the keys`;
    this.canvas = element("canvas", holder, { className: "grains", role: "img" });
    const head = this.head = element("div", holder, { className: "head" });
    element(holder.tagName === "MAIN" ? "h1" : "strong", head, { className: "title" }, data.title);  // a report has its own heading
    element("div", head, { className: "about" }, this.about());
    this.chosen = element("div", head, { className: "chosen", role: "status" });
    this.scale = element("div", holder, { className: "scale" });
    this.profile = element("canvas", holder, { className: "profile", role: "img", ariaLabel: "velocity of the water over height", hidden: !data.flow });
    this.axes = element("canvas", holder, { className: "axes", role: "img", ariaLabel: "directions of x, y, z and of gravity, g" });
    this.help = element("div", holder, { className: "help", role: "group", ariaLabel: "keys and mouse", tabIndex: 0, hidden: true });
    const listed = element("table", this.help);
    for (const [key, doc] of HELP) element("tr", listed, {}, element("th", null, { scope: "row" }, key), element("td", null, {}, doc));
    const bar = element("div", holder, { className: "bar" });
    const button = (text, title, act) => element("button", bar, { type: "button", title, onclick: act }, text);
    this.play = button("", "play, pause (space)", () => this.toggle());
    this.slider = element("input", bar, { type: "range", min: 0, max: Math.max(this.frames - 1, 1), step: "any", value: 0, ariaLabel: "frame", oninput: () => this.seek(+this.slider.value) });
    this.clock = element("output", bar, { className: "clock", ariaLive: "off" });  // a moving time is not read aloud
    this.speed = element("select", bar, { title: "speed of the film", ariaLabel: "speed of the film", onchange: () => { this.rate = +this.speed.value; } });
    this.colours = element("select", bar, { title: "colour of the grains (c)", ariaLabel: "colour of the grains", onchange: () => this.colourBy(this.colours.value) });
    for (const one of data.colourings) element("option", this.colours, { value: one.word }, one.word);
    for (const name of Object.keys(VIEWS)) button(name, `${name} view`, () => this.look(name));
    this.asked = button("?", "keys and mouse (h)", () => this.showHelp(this.help.hidden));
    this.asked.ariaLabel = "keys and mouse";
    this.pause(); this.showHelp(false);
    hands(this);
  }

  about() {
    const { data } = this, parts = [data.status];
    const shown = data.arrays.radius.shape[0];
    parts.push(shown < data.grains ? `${shown} of ${data.grains} grains, drawn by lot` : `${data.grains} grains`);
    if (data.flow?.arrows?.at.length) parts.push(`longest arrow ${data.flow.arrows.fastest.toPrecision(2)} m/s`);
    parts.push(this.frames < data.frames ? `${this.frames} of ${data.frames} frames` : `${data.frames} frames`);
    parts.push(data.folder);  // last: a long name is cut
    return parts.join(" \u00b7 ");
  }

  start() {
    const { data, arrays, painter } = this;
    painter.put("free", { radius: this.radii = arrays.radius.slice() });
    [this.low, this.high] = data.box;
    this.centre = this.low.map((one, k) => (one + this.high[k]) / 2);
    this.radius = Math.hypot(...minus(this.high, this.low)) / 2 + 2 * Math.max(...arrays.radius.subarray(0, 1000), 0);
    this.camera.flat = data.plane;
    const whole = data.t[this.frames - 1] - data.t[0];
    this.speeds(whole > 0 ? whole / SECONDS : 1);
    if (data.flow) this.fastest = arrays.u.reduce((most, one) => (one > most ? one : most), 1e-6);
    this.levels = new Uint8Array(this.grains);
    this.resize();
    new ResizeObserver(() => this.resize()).observe(this.holder);
    this.colourBy(data.colourings[0].word);
    this.look(data.plane ? "side" : "oblique");
    this.draw();
    this.holder.dataset.firstPicture = performance.now().toFixed(0);
  }

  speeds(usual) {
    const power = 10 ** Math.floor(Math.log10(usual)), near = [1, 2, 5].map((k) => k * power).filter((one) => one <= usual).pop();
    const every = [0.01, 0.1, 1, 10].flatMap((k) => [1, 2, 5].map((m) => k * m * near / (near / power)));
    for (const one of every) element("option", this.speed, { value: one, selected: one === near }, `${one >= 1 ? one.toFixed(0) : one.toPrecision(1)} \u00d7 real time`);
    this.rate = near; this.speed.value = near;
  }

  // ------------------------------------------------------------------------------------------------- the moment

  frameAt(time) {  // frames begun, and the share of the way to the next
    const { t } = this.data;
    let low = 0, high = t.length - 1;
    while (high - low > 1) { const middle = (low + high) >> 1; if (t[middle] <= time) low = middle; else high = middle; }
    return t.length < 2 ? [0, 0] : [low, Math.min(Math.max((time - t[low]) / (t[high] - t[low]), 0), 1)];
  }

  seek(frame) {
    const { t } = this.data, k = Math.min(Math.max(Math.floor(frame), 0), Math.max(t.length - 2, 0));
    this.time = t.length < 2 ? t[0] : t[k] + Math.min(Math.max(frame - k, 0), 1) * (t[k + 1] - t[k]);
    this.changed();
  }

  step(count) {
    const [k, share] = this.frameAt(this.time), now = share > 1 - 1e-6 ? k + 1 : k;
    this.pause();
    this.seek(Math.min(Math.max(count < 0 && share > 1e-6 && share < 1 - 1e-6 ? k : now + count, 0), this.frames - 1));
  }

  toggle() { this.playing ? this.pause() : this.begin(); }

  pause() { this.playing = false; this.playShows("play", "polite"); }

  playShows(does, live) {  // what the button does next; the numbers of a grain are read aloud only while they rest
    this.play.className = this.playing ? "playing" : ""; this.play.ariaLabel = does;
    this.chosen.ariaLive = live;
  }

  showHelp(shown) {
    const within = this.help.contains(document.activeElement);  // what is hidden hears no keys
    this.help.hidden = !shown; this.asked.ariaExpanded = shown;
    if (within && !shown) this.holder.focus({ preventScroll: true });
  }

  begin() {
    if (this.frames < 2) return;
    if (this.time >= this.data.t[this.frames - 1]) this.time = this.data.t[0];
    this.playing = true; this.before = null; this.playShows("pause", "off");
    const tick = (now) => {
      if (!this.playing) return;
      if (this.before !== null) this.time += this.rate * Math.min(now - this.before, 250) / 1000;
      this.before = now;
      if (this.time >= this.data.t[this.frames - 1]) { this.time = this.data.t[this.frames - 1]; this.pause(); }
      this.draw();
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  // Unwrapped centre of a grain at a frame [m].
  centreOf(grain, frame) {
    const at = 3 * (frame * this.grains + grain), { quantum } = this.data;
    return [0, 1, 2].map((k) => this.arrays.x[at + k] * quantum[k]);
  }

  // A point taken back into the periods.
  inside(point) { return point.map((one, k) => (this.period[k] ? one - this.period[k] * Math.floor(one / this.period[k]) : one)); }

  placeOf(grain) {
    const [k, share] = this.frameAt(this.time), from = this.centreOf(grain, k);
    return this.inside(share ? plus(from, minus(this.centreOf(grain, k + 1), from), share) : from);
  }

  load(k) {  // frames k and k + 1 onto the card
    const n = this.grains, { x } = this.arrays, { quantum } = this.data, next = Math.min(k + 1, this.frames - 1);
    const from = new Float32Array(3 * n), to = new Float32Array(3 * n);
    const cells = [0, 1, 2].map((axis) => (this.period[axis] ? Math.round(this.period[axis] / quantum[axis]) : 0));
    for (let i = 0, a = 3 * k * n, b = 3 * next * n; i < 3 * n; i++) {
      const axis = i % 3, cell = cells[axis];
      const here = cell ? ((x[a + i] % cell) + cell) % cell : x[a + i];
      from[i] = here * quantum[axis];
      to[i] = (here + x[b + i] - x[a + i]) * quantum[axis];
    }
    const { there, radius } = this.arrays;  // grains that feeds bring and exits take: away in both frames, not shown
    if (there) for (let g = 0; g < n; g++) this.radii[g] = there[k * n + g] || there[next * n + g] ? radius[g] : 0;
    this.painter.put("free", there ? { from, to, radius: this.radii } : { from, to });
    this.loaded = k; this.coloured = null;
  }

  level(frame) {  // of every grain on the scale of colours
    const one = this.data.colourings[this.colouring], n = this.grains, kept = this.arrays[one.word];
    if (kept) {
      const row = this.data.arrays[one.word].shape[0] > 1 ? frame : 0;
      this.levels.set(kept.subarray(row * n, (row + 1) * n));
    } else {  // height
      const { x } = this.arrays, scale = 63 / (one.high - one.low), cm = 100 * this.data.quantum[2];
      for (let g = 0; g < n; g++) this.levels[g] = Math.min(Math.max(Math.round((x[3 * (frame * n + g) + 2] * cm - one.low) * scale), 0), 63);
    }
    this.painter.put("free", { level: this.levels });
  }

  walls(index) {  // fixed grains that are there from a scene on
    const { fixed } = this.arrays, gone = new Set(this.data.scenes[index].fixed), place = [], radius = [];
    for (let k = 0; k < fixed.length / 4; k++) if (!gone.has(k)) { place.push(fixed[4 * k], fixed[4 * k + 1], fixed[4 * k + 2]); radius.push(fixed[4 * k + 3]); }
    const from = new Float32Array(place);
    this.painter.put("fixed", { from, to: from, radius: new Float32Array(radius), level: new Uint8Array(radius.length) });
    this.scene = index;
  }

  // ---------------------------------------------------------------------------------------------------- drawing

  changed() {  // drawn once, however much changed since the last picture
    if (!this.playing) this.due ??= requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.due = null;
    if (!this.arrays) return;
    const { data, camera, painter } = this, [k, share] = this.frameAt(this.time), nearest = share < 0.5 ? k : k + 1;
    const scene = data.scenes.reduce((found, one, i) => (one.t <= this.time + 1e-12 ? i : found), 0);
    if (k !== this.loaded) this.load(k);
    if (scene !== this.scene) this.walls(scene);
    const coloured = `${this.colouring} ${nearest}`;
    if (coloured !== this.coloured) { this.level(nearest); this.coloured = coloured; }
    if (this.following && this.picked >= 0) camera.target = this.placeOf(this.picked);
    painter.begin(camera.matrices(this.aspect, this.centre, this.radius), camera.flat);
    painter.drawSpheres("free", { share, period: this.period, picked: this.picked });
    if (this.fixedShown) painter.drawSpheres("fixed", { plain: [0.66, 0.64, 0.6] });
    if (this.picked >= 0) painter.drawPlain(this.track(nearest), [0.9, 0.3, 0, 1], "lines");
    painter.drawPlain(this.frame(), [0.55, 0.58, 0.62, 1], "lines");
    if (this.wallsShown) { this.drawWalls(data.scenes[scene], nearest); this.drawRow(k, share); }
    if (this.arrowsShown) this.drawArrows(k, share);
    this.words(k, share, nearest, scene);
  }

  drawWalls(scene, nearest) {
    const { painter } = this, room = 0.02 * this.radius;
    const low = this.low.map((one, k) => one - (this.period[k] ? 0 : room)), high = this.high.map((one, k) => one + (this.period[k] ? 0 : room));
    const rim = (corners) => corners.flatMap((one, k) => [one, corners[(k + 1) % corners.length]]);  // seen edge-on, too
    for (const { point, normal } of scene.planes) {
      const corners = planeInBox(point, normal, low, high);
      painter.drawPlain(rim(corners), [0.5, 0.47, 0.42, 1], "lines");
      painter.drawPlain(corners, [0.5, 0.47, 0.42, 0.25], "face");
    }
    scene.walls.forEach((motion, w) => {
      if (!motion) return;
      const place = poseOf(motion, this.time), { wall_faces, wall_face_of, wall_lines, wall_line_of } = this.arrays;
      painter.drawPlain(placed(wall_faces, wall_face_of, w, 3, place, this.period), [0.5, 0.47, 0.42, 0.12], "triangles");
      painter.drawPlain(placed(wall_lines, wall_line_of, w, 2, place, this.period), [0.5, 0.47, 0.42, 1], "lines");
    });
    const surface = this.surface(nearest);
    if (surface !== undefined && !this.arrays.line) {
      const corners = [[low[0], low[1], surface], [high[0], low[1], surface], [high[0], high[1], surface], [low[0], high[1], surface]];
      painter.drawPlain(rim(corners), [0.1, 0.45, 0.75, 1], "lines");
      painter.drawPlain(corners, [0.15, 0.5, 0.8, 0.22], "face");
    }
  }

  drawRow(k, share) {  // the surface along a row of columns, between frame k and the next; nan where it is dry
    const { arrays, low, high, painter } = this;
    if (!arrays.line) return;
    const { x } = this.data.flow, n = x.length, next = Math.min(k + 1, this.frames - 1), faces = [], lines = [];
    const z = x.map((_, i) => {
      const from = arrays.line[k * n + i], to = arrays.line[next * n + i], between = from + share * (to - from);
      return Number.isFinite(between) ? between : share < 0.5 ? from : to;
    });
    for (let i = 0; i + 1 < n; i++) {
      if (!(Math.max(z[i], z[i + 1]) <= this.highest)) continue;  // nan too
      const [a, b, c, d] = [[x[i], low[1], z[i]], [x[i + 1], low[1], z[i + 1]], [x[i + 1], high[1], z[i + 1]], [x[i], high[1], z[i]]];
      faces.push(a, b, c, a, c, d);
      lines.push(a, b, c, d);
    }
    painter.drawPlain(lines, [0.1, 0.45, 0.75, 1], "lines");
    painter.drawPlain(faces, [0.15, 0.5, 0.8, 0.22], "triangles");
  }

  drawArrows(k, share) {  // speeds of the water along a row, on the near side of the box, where no grain hides them
    const { arrows } = this.arrays;
    if (!arrows) return;
    const { at, length } = this.data.flow.arrows, n = at.length, y = this.low[1], next = Math.min(k + 1, this.frames - 1), lines = [];
    at.forEach(([x, z], i) => {
      const from = 2 * (k * n + i), to = 2 * (next * n + i), wet = [arrows[from] > 0, arrows[to] > 0];
      const part = wet[0] && wet[1] ? share : share < 0.5 ? 0 : 1;  // of the nearer frame where one is dry
      if (x < this.low[0] || x > this.high[0] || z > this.highest || !wet[part < 0.5 ? 0 : 1]) return;
      const [u, w] = [0, 1].map((axis) => length * ((1 - part) * arrows[from + axis] + part * arrows[to + axis] - 128) / 127);
      if (Math.hypot(u, w) < 0.02 * length) return;
      const tip = [x + u / 2, y, z + w / 2];
      lines.push([x - u / 2, y, z - w / 2], tip);
      for (const side of [-1, 1]) lines.push(tip, [tip[0] - 0.28 * u + 0.14 * side * w, y, tip[2] - 0.28 * w - 0.14 * side * u]);
    });
    this.painter.drawPlain(lines, [0.05, 0.2, 0.4, 1], "lines");
  }

  surface(frame) {
    const kept = this.arrays.surface;
    return kept && (kept.length > 1 ? kept[frame] : kept[0]);
  }

  frame() {  // edges of the box: the periods, where there are some
    const corner = (k) => [0, 1, 2].map((axis) => (k >> axis & 1 ? this.high : this.low)[axis]), lines = [];
    for (let k = 0; k < 8; k++) for (const axis of [1, 2, 4]) if (!(k & axis)) lines.push(corner(k), corner(k | axis));
    return lines;
  }

  track() {  // path of the chosen grain, cut where it leaves one side and enters the other
    const lines = [];
    for (let k = 0; k + 1 < this.frames; k++) {
      const from = this.centreOf(this.picked, k), way = minus(this.centreOf(this.picked, k + 1), from), a = this.inside(from), b = plus(a, way);
      if (this.period.every((one, axis) => !one || (b[axis] >= 0 && b[axis] < one))) lines.push(a, b);
      else { const c = this.inside(plus(from, way)); lines.push(a, this.cut(a, way), this.cut(c, way.map((one) => -one)), c); }
    }
    return lines;
  }

  cut(from, way) {  // where a straight way leaves the period
    const share = Math.min(1, ...[0, 1].map((k) => (!this.period[k] || !way[k] ? 1 : ((way[k] > 0 ? this.period[k] : 0) - from[k]) / way[k])));
    return plus(from, way, share);
  }

  words(k, share, nearest, scene) {
    const { data } = this;
    this.slider.value = k + share;
    this.clock.textContent = this.slider.ariaValueText = `t = ${this.time.toFixed(this.digits ??= Math.min(Math.max(0, Math.ceil(-Math.log10((data.t[data.t.length - 1] - data.t[0]) / data.t.length || 1) - 0.1) + 1), 6))} s`;
    if (data.flow) {
      const n = data.flow.z.length, row = data.arrays.u.shape[0] > 1 ? nearest : 0;
      drawProfile(this.profile, data.flow.z, this.arrays.u.subarray(row * n, (row + 1) * n), this.fastest, this.surface(nearest));
    }
    drawAxes(this.axes, this.camera, data.scenes[scene].gravity);
    if (this.picked < 0) this.chosen.textContent = "";
    else {
      const at = this.placeOf(this.picked), next = Math.min(k + 1, this.frames - 1), before = Math.max(next - 1, 0);
      const speed = next > before ? Math.hypot(...minus(this.centreOf(this.picked, next), this.centreOf(this.picked, before))) / (data.t[next] - data.t[before]) : 0;
      const id = this.arrays.id ? this.arrays.id[this.picked] : this.picked;
      this.chosen.textContent = `grain ${id}: d ${(2000 * this.arrays.radius[this.picked]).toPrecision(3)} mm, x ${(100 * at[0]).toFixed(2)}, y ${(100 * at[1]).toFixed(2)}, z ${(100 * at[2]).toFixed(2)} cm, ${speed.toPrecision(2)} m/s between two frames${this.following ? ", followed" : ""}`;
    }
  }

  // -------------------------------------------------------------------------------- what keys and mouse ask for

  colourBy(word) {
    this.colouring = this.data.colourings.findIndex((one) => one.word === word);
    this.colours.value = word; this.coloured = null;
    const one = this.data.colourings[this.colouring];
    this.painter.colours(one.colours);
    drawScale(this.scale, one);
    this.canvas.ariaLabel = `picture of the grains, coloured by ${one.label}: ${this.about()}`;
    this.changed();
  }

  look(name) {
    this.following = false;
    const covered = this.data.flow ? 2 * SIDE / this.canvas.clientWidth : 0;  // by the profile, of a width of 2
    const named = this.chosen.offsetTop || this.head.offsetHeight;  // what is said of a chosen grain lies below, and counts not
    const above = Math.min(2 * (this.head.offsetTop + named) / (this.canvas.clientHeight || 1), 1);  // by the title, of a height of 2
    this.camera.fit(this.low, this.high, this.aspect * (1 - covered / 2), 1 - above / 2, ...VIEWS[name]);
    const [right, up] = this.camera.axes, { half } = this.camera;
    this.camera.target = plus(plus(this.camera.target, right, covered / 2 * this.aspect * half), up, above / 2 * half);
    this.changed();
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.max(Math.round(this.canvas.clientWidth * ratio), 1);
    this.canvas.height = Math.max(Math.round(this.canvas.clientHeight * ratio), 1);
    this.changed();
  }

  zoom(factor, x = 0, y = 0) {
    const [right, up] = this.camera.axes, shift = this.following ? 0 : this.camera.half * (1 - factor);
    this.camera.target = plus(plus(this.camera.target, right, x * this.aspect * shift), up, y * shift);
    this.camera.half = Math.min(Math.max(this.camera.half * factor, 1e-3 * this.radius), 20 * this.radius);
    this.changed();
  }

  pick(x, y) {
    const [origin, sight] = this.camera.ray(x, y, this.aspect), radius = this.radii;
    let best = Infinity, found = -1;
    for (let g = 0; g < this.grains; g++) {
      if (!radius[g]) continue;
      const out = minus(origin, this.placeOf(g)), b = dot(out, sight), h = b * b - dot(out, out) + radius[g] ** 2;
      if (h >= 0 && -b - Math.sqrt(h) < best) { best = -b - Math.sqrt(h); found = g; }
    }
    this.picked = found; this.following &&= found >= 0;
    this.changed();
  }

  choose(step) {  // the next grain that is there, or the one before
    const n = this.grains, from = this.picked < 0 ? (step > 0 ? -1 : n) : this.picked;
    for (let k = 1, g; k <= n; k++) if (this.radii[g = (((from + k * step) % n) + n) % n]) { this.picked = g; break; }
    this.changed();
  }

  turn(across, up) {
    this.camera.azimuth += across;
    this.camera.elevation = Math.min(Math.max(this.camera.elevation + up, -1.55), Math.PI / 2 - 1e-4);
    this.changed();
  }

  shift(across, up) {  // the place looked at, by as many metres
    const [right, above] = this.camera.axes;
    this.following = false;
    this.camera.target = plus(plus(this.camera.target, right, across), above, up);
    this.changed();
  }

  save() {
    this.draw();
    this.canvas.toBlob((blob) => {
      const address = URL.createObjectURL(blob);
      element("a", null, { href: address, download: `${this.data.folder}-${this.time.toFixed(4)}s.png` }).click();
      setTimeout(() => URL.revokeObjectURL(address), 1000);
    });
  }

  faster(step) { this.speed.selectedIndex = Math.min(Math.max(this.speed.selectedIndex + step, 0), this.speed.length - 1); this.rate = +this.speed.value; }
}
