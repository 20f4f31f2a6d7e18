// What lies over the picture: element by element, the scale of colours, the water's profile, the axes.

function element(kind, parent, properties = {}, ...content) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(properties)) name in made ? made[name] = value : made.setAttribute(name, value);
  made.append(...content);
  parent?.append(made);
  return made;
}

// A few round numbers from low to high, at least `least` apart, and the digits they need.
function ticks(low, high, count, least = 0) {
  const raw = Math.max((high - low) / count, least), power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((k) => k * power >= raw) * power, found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return { found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

const written = (value, digits) => (Math.abs(value) < 0.5 * 10 ** -digits ? 0 : value).toFixed(digits).replace("-", "\u2212");

// The canvas at its size on the screen; its context draws in CSS pixels.
function fitted(canvas) {
  const ratio = window.devicePixelRatio || 1, [w, h] = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio);
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, w, h);
  pen.font = "11px system-ui, sans-serif";
  return [pen, w, h];
}

function drawScale(holder, one) {
  holder.replaceChildren();
  element("div", holder, { className: "label" }, one.unit ? `${one.label}  (${one.unit})` : one.label);
  const bar = element("div", holder, { className: "colours" });
  bar.style.background = `linear-gradient(to right, ${one.colours.join(",")})`;
  const { found, digits } = ticks(one.low, one.high, 4, one.unit ? 0 : 1);  // what has no unit is counted
  for (const value of found) {
    const mark = element("span", bar, {}, written(value, digits));
    mark.style.left = `${100 * (value - one.low) / (one.high - one.low)}%`;
  }
}

// Velocity of the water over height: u [m/s] at z [m], to the surface [m].
function drawProfile(canvas, z, u, most, surface) {
  const [pen, w, h] = fitted(canvas), [left, right, top, bottom] = [40, 10, 20, 34];
  const low = z[0], high = Math.max(z[z.length - 1], surface ?? -Infinity);
  const across = (value) => left + (w - left - right) * value / most;
  const upward = (value) => h - bottom - (h - top - bottom) * (value - low) / (high - low || 1);
  pen.strokeStyle = "#8a929a"; pen.fillStyle = "#2b333b"; pen.lineWidth = 1;
  pen.strokeRect(left + 0.5, top + 0.5, w - left - right - 1, h - top - bottom - 1);
  pen.textAlign = "center";
  const speeds = ticks(0, most, 3), levels = ticks(100 * low, 100 * high, 4);
  for (const value of speeds.found) { pen.fillRect(across(value), h - bottom - 3, 1, 3); pen.fillText(written(value, speeds.digits), across(value), h - bottom + 12); }
  pen.textAlign = "right";
  for (const value of levels.found) { pen.fillRect(left, upward(value / 100), 3, 1); pen.fillText(written(value, levels.digits), left - 3, upward(value / 100) + 4); }
  pen.textAlign = "center";
  pen.fillText("water  u  (m/s)", (left + w - right) / 2, h - 6);
  pen.textAlign = "left"; pen.fillText("z  (cm)", 4, 12);
  if (surface !== undefined && Number.isFinite(surface)) {
    pen.strokeStyle = "#0072b2"; pen.setLineDash([4, 3]);
    pen.beginPath(); pen.moveTo(left, upward(surface)); pen.lineTo(w - right, upward(surface)); pen.stroke(); pen.setLineDash([]);
  }
  pen.strokeStyle = "#0072b2"; pen.lineWidth = 1.8; pen.beginPath();
  let drawing = false;
  z.forEach((height, k) => {
    if (Number.isFinite(u[k])) { drawing ? pen.lineTo(across(u[k]), upward(height)) : pen.moveTo(across(u[k]), upward(height)); drawing = true; }
    else drawing = false;
  });
  pen.stroke();
}

// The directions of x, y, z and of gravity, as the camera sees them.
function drawAxes(canvas, camera, gravity) {
  const [pen, w, h] = fitted(canvas), [right, up] = camera.axes, long = 0.36 * Math.min(w, h);
  const strong = Math.hypot(...gravity) || 1;
  const arrows = [["x", [1, 0, 0], "#b5442d"], ["y", [0, 1, 0], "#3a7d44"], ["z", [0, 0, 1], "#2f5f98"], ["g", gravity.map((one) => 0.8 * one / strong), "#333"]];
  pen.textAlign = "center"; pen.textBaseline = "middle"; pen.lineJoin = "round";
  for (const [name, way, colour] of arrows) {
    const x = dot(way, right), y = -dot(way, up), length = Math.hypot(x, y);
    if (length < 0.08) continue;
    pen.strokeStyle = pen.fillStyle = colour; pen.lineWidth = 1.6;
    pen.beginPath(); pen.moveTo(w / 2, h / 2); pen.lineTo(w / 2 + long * x, h / 2 + long * y); pen.stroke();
    const more = 1 + 8 / (long * length), letter = [name, w / 2 + long * x * more, h / 2 + long * y * more];
    pen.strokeStyle = "#f6f7f9"; pen.lineWidth = 4;
    pen.strokeText(...letter);  // legible over grains too
    pen.fillText(...letter);
  }
}
