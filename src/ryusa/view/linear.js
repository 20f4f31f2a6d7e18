// Vectors of three numbers, matrices of 16 by columns, and the camera.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const plus = (a, b, k = 1) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
const unit = (a) => { const l = Math.hypot(...a); return [a[0] / l, a[1] / l, a[2] / l]; };

// Looks at a target; z is up. `half` is half the height of the picture at the target [m].
class Camera {
  constructor() { this.target = [0, 0, 0]; this.azimuth = -1.2; this.elevation = 0.35; this.half = 1; this.flat = false; }

  get axes() {  // right, up and backwards, in the scene's frame
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    return [[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]];
  }

  get distance() { return this.half / Math.tan(Camera.ANGLE / 2); }

  // Turn and shift so that a box fills the picture, of which that share of the height is free.
  fit(low, high, aspect, free, azimuth = this.azimuth, elevation = this.elevation) {
    Object.assign(this, { azimuth, elevation, target: low.map((l, k) => (l + high[k]) / 2) });
    const [right, up, back] = this.axes, near = Math.tan(Camera.ANGLE / 2);
    this.half = 1e-9;
    for (let corner = 0; corner < 8; corner++) {
      const at = minus([0, 1, 2].map((k) => (corner >> k & 1 ? high : low)[k]), this.target);
      const depth = this.flat ? 0 : near * dot(at, back);
      const over = dot(at, up), tall = Math.max(over + (2 * free - 1) * depth, depth - over) / free;  // what is free lies below
      this.half = Math.max(this.half, 1.06 * (Math.abs(dot(at, right)) / aspect + depth), 1.06 * tall);
    }
  }

  // View and projection for a scene within a sphere.
  matrices(aspect, centre, radius) {
    const [right, up, back] = this.axes, eye = plus(this.target, back, this.distance);
    const view = new Float32Array([
      right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
      -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
    ]);
    const middle = dot(back, minus(eye, centre));
    const far = middle + 1.01 * radius;
    const near = this.flat ? middle - 1.01 * radius : Math.max(middle - 1.01 * radius, 0.02 * this.distance);
    const d = Math.max(far, near * 1.001) - near, projection = new Float32Array(16);
    projection[0] = this.flat ? 1 / (this.half * aspect) : 1 / (Math.tan(Camera.ANGLE / 2) * aspect);
    projection[5] = projection[0] * aspect;
    projection[10] = this.flat ? -2 / d : -(far + near) / d;
    projection[11] = this.flat ? 0 : -1;
    projection[14] = this.flat ? -(far + near) / d : -2 * far * near / d;
    projection[15] = this.flat ? 1 : 0;
    return { view, projection };
  }

  // Origin and direction of the line of sight through a point of the picture, -1 .. 1 to the right and up.
  ray(x, y, aspect) {
    const [right, up, back] = this.axes;
    const across = plus(plus([0, 0, 0], right, x * aspect * this.half), up, y * this.half);
    if (this.flat) return [plus(plus(this.target, across), back, 1e3 * this.half), back.map((b) => -b)];
    const eye = plus(this.target, back, this.distance);
    return [eye, unit(minus(plus(this.target, across), eye))];
  }

  // Where a point of the scene lies in the picture, -1 .. 1 to the right and up.
  project(point, aspect) {
    const [right, up, back] = this.axes, at = minus(point, this.target);
    const shrink = this.flat ? 1 : this.distance / (this.distance - dot(at, back));
    return [shrink * dot(at, right) / (this.half * aspect), shrink * dot(at, up) / this.half];
  }
}
Camera.ANGLE = 0.6;  // of the picture's height as seen from the camera [rad]

// Part of a polygon or a line where the room at its corners is not negative.
function cutOff(corners, room) {
  const kept = [];
  corners.forEach((a, i) => {
    const b = corners[(i + 1) % corners.length], ia = room(a), ib = room(b);
    if (ia >= 0) kept.push(a);
    if ((ia >= 0) !== (ib >= 0)) kept.push(plus(a, minus(b, a), ia / (ia - ib)));
  });
  return corners.length === 2 ? kept.slice(0, 2) : kept;
}

// A line or triangle, cut where a period from 0 ends, with each part taken into it, as in model/wall_shape.py.
function withinPeriods(shape, period) {
  return period.reduce((shapes, length, axis) => (!length ? shapes : shapes.flatMap((one) => {
    const at = one.map((p) => p[axis] / length), end = 1e-6, least = Math.min(...at), most = Math.max(...at), found = [];
    if (least > -end && most < 1 + end) return [one];
    const first = Math.floor(least + end), last = Math.max(Math.ceil(most - end) - 1, first);
    for (let image = first; image <= last; image++) {
      let part = one.map((p) => p.map((value, k) => (k === axis ? value - image * length : value)));
      if (first < last) part = cutOff(cutOff(part, (p) => p[axis]), (p) => length - p[axis]);
      if (one.length === 2) found.push(part);
      else for (let a = 1; a + 1 < part.length; a++) found.push([part[0], part[a], part[a + 1]]);
    }
    return found;
  })), [shape]);
}

// Corners of a plane within a box.
function planeInBox(point, normal, low, high) {
  const side = unit(cross(normal, Math.abs(normal[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0])), other = cross(normal, side);
  const reach = 4 * Math.hypot(...minus(high, low)) + Math.hypot(...minus(point, low));
  let corners = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([a, b]) => plus(plus(point, side, a * reach), other, b * reach));
  for (let k = 0; k < 6 && corners.length; k++) {
    const axis = k >> 1;
    corners = cutOff(corners, (p) => (k & 1 ? high[axis] - p[axis] : p[axis] - low[axis]) + 1e-9 * reach);
  }
  return corners;
}

// Pose of a wall at a time, a function from its frame to the scene; the columns of its motion are those of model/walls.py.
function poseOf(motion, t) {
  const since = t - motion[0], turn = motion.slice(1, 10), shift = motion.slice(10, 13), axisPoint = motion.slice(13, 16);
  const spin = motion.slice(19, 22), rate = Math.hypot(...spin);
  const drift = [0, 1, 2].map((k) => motion[16 + k] * since + motion[22 + k] * (Math.sin(motion[25] * since + motion[26]) - Math.sin(motion[26])));
  const axis = rate ? spin.map((one) => one / rate) : [0, 0, 1], c = Math.cos(rate * since), s = Math.sin(rate * since);
  const turned = (p) => {
    const side = cross(axis, p), along = dot(axis, p) * (1 - c);
    return p.map((one, k) => c * one + s * side[k] + along * axis[k]);
  };
  return (p) => {
    const own = [0, 1, 2].map((k) => turn[3 * k] * p[0] + turn[3 * k + 1] * p[1] + turn[3 * k + 2] * p[2] + shift[k]);
    return plus(plus(turned(minus(own, axisPoint)), axisPoint), drift);
  };
}

// Points of one wall, `count` to each face or line, in the scene and inside its periods.
function placed(points, owner, wall, count, place, period) {
  const found = [];
  for (let k = 0; k < owner.length; k++) {
    if (owner[k] !== wall) continue;
    const shape = Array.from({ length: count }, (_, c) => place([...points.subarray(3 * (count * k + c), 3 * (count * k + c + 1))]));
    found.push(...withinPeriods(shape, period).flat());
  }
  return found;
}
