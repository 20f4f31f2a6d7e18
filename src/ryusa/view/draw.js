// Spheres, faces and lines in WebGL2. A grain is one quad; the sphere in it and its depth come from the ray.

const SPHERE_VERTEX = `#version 300 es
layout(location=0) in vec3 from; layout(location=1) in vec3 to; layout(location=2) in float radius;
layout(location=3) in float level;
uniform mat4 view, projection; uniform float share; uniform vec2 period; uniform bool flatView; uniform int picked;
out vec3 centre, place; out float r; flat out float tone; flat out int chosen;
void main() {
  vec3 p = mix(from, to, share);
  if (period.x > 0.0) p.x -= period.x * floor(p.x / period.x);
  if (period.y > 0.0) p.y -= period.y * floor(p.y / period.y);
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  centre = (view * vec4(p, 1.0)).xyz; r = radius; tone = level; chosen = int(gl_InstanceID == picked);
  if (flatView) place = centre + radius * vec3(corner, 0.0);
  else {
    float far = length(centre);
    vec3 sight = centre / far, right = normalize(cross(sight, vec3(0.0, 1.0, 0.0))), up = cross(right, sight);
    place = centre + radius * far * inversesqrt(max(far * far - radius * radius, 0.01 * radius * radius)) * (corner.x * right + corner.y * up);
  }
  gl_Position = projection * vec4(place, 1.0);
}`;
const SPHERE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 centre, place; in float r; flat in float tone; flat in int chosen;
uniform mat4 projection; uniform bool flatView; uniform sampler2D colours; uniform vec4 plain;
out vec4 seen;
void main() {
  vec3 origin = flatView ? vec3(place.xy, 0.0) : vec3(0.0), sight = flatView ? vec3(0.0, 0.0, -1.0) : normalize(place);
  vec3 out_ = origin - centre;
  float b = dot(out_, sight), h = b * b - dot(out_, out_) + r * r;
  if (h < 0.0) discard;
  vec3 at = origin + (-b - sqrt(h)) * sight, n = (at - centre) / r;
  vec4 clip = projection * vec4(at, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
  vec3 colour = plain.a > 0.0 ? plain.rgb : texture(colours, vec2((tone + 0.5) / 64.0, 0.5)).rgb;
  float facing = dot(n, -sight), light = max(dot(n, normalize(vec3(-0.35, 0.75, 0.55))), 0.0);
  if (chosen == 1 && facing < 0.5) colour = vec3(1.0, 0.35, 0.0);
  colour *= (0.5 + 0.5 * light) * mix(0.55, 1.0, smoothstep(0.0, 0.4, facing));
  seen = vec4(colour, 1.0);
}`;
const PLAIN_VERTEX = `#version 300 es
layout(location=0) in vec3 from; uniform mat4 view, projection;
void main() { gl_Position = projection * view * vec4(from, 1.0); }`;
const PLAIN_FRAGMENT = `#version 300 es
precision highp float; uniform vec4 plain; out vec4 seen;
void main() { seen = vec4(plain.rgb * plain.a, plain.a); }`;

class Painter {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!gl) throw new Error("This browser offers no WebGL2, which draws the grains. Current versions of Firefox, Chrome, Edge and Safari have it; it may be switched off in their settings, or the graphics driver may be blocked.");
    this.gl = gl; this.canvas = canvas;
    this.sphere = this.program(SPHERE_VERTEX, SPHERE_FRAGMENT);
    this.plain = this.program(PLAIN_VERTEX, PLAIN_FRAGMENT);
    this.spheres = {}; this.line = gl.createBuffer(); this.lineArray = gl.createVertexArray();
    this.map = gl.createTexture();
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  program(vertex, fragment) {
    const gl = this.gl, made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text); gl.compileShader(shader); gl.attachShader(made, shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error("The graphics driver refuses a shader: " + gl.getShaderInfoLog(shader));
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error("The graphics driver refuses a program: " + gl.getProgramInfoLog(made));
    const places = {};
    for (let k = 0; k < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); k++) {
      const { name } = gl.getActiveUniform(made, k);
      places[name] = gl.getUniformLocation(made, name);
    }
    return { made, places };
  }

  // Put a set of spheres on the card: columns from, to (3 n), radius, level (n); only those given are replaced.
  put(set, columns) {
    const gl = this.gl, widths = { from: 3, to: 3, radius: 1, level: 1 };
    const kept = this.spheres[set] ??= { array: gl.createVertexArray(), buffers: {}, count: 0 };
    gl.bindVertexArray(kept.array);
    Object.keys(widths).forEach((name, place) => {
      if (!columns[name]) return;
      kept.buffers[name] ??= gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, kept.buffers[name]);
      gl.bufferData(gl.ARRAY_BUFFER, columns[name], gl.DYNAMIC_DRAW);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, widths[name], columns[name] instanceof Uint8Array ? gl.UNSIGNED_BYTE : gl.FLOAT, false, 0, 0);
      gl.vertexAttribDivisor(place, 1);
      if (name === "radius") kept.count = columns.radius.length;
    });
    gl.bindVertexArray(null);
  }

  colours(list) {  // of a scale, "#rrggbb" each
    const gl = this.gl, bytes = new Uint8Array(list.flatMap((one) => [1, 3, 5].map((k) => parseInt(one.slice(k, k + 2), 16))));
    gl.bindTexture(gl.TEXTURE_2D, this.map);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, list.length, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, bytes);
    for (const edge of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, edge, gl.NEAREST);
  }

  begin({ view, projection }, flat) {
    const gl = this.gl;
    Object.assign(this, { view, projection, flat });
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0.965, 0.97, 0.975, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  use(program) {
    const gl = this.gl;
    gl.useProgram(program.made);
    gl.uniformMatrix4fv(program.places.view, false, this.view);
    gl.uniformMatrix4fv(program.places.projection, false, this.projection);
    return program.places;
  }

  drawSpheres(set, { share = 0, period = [0, 0], picked = -1, plain = null } = {}) {
    const gl = this.gl, kept = this.spheres[set];
    if (!kept || !kept.count) return;
    const at = this.use(this.sphere);
    gl.uniform1f(at.share, share); gl.uniform2fv(at.period, period); gl.uniform1i(at.flatView, this.flat ? 1 : 0);
    gl.uniform1i(at.picked, picked); gl.uniform4fv(at.plain, plain ? [...plain, 1] : [0, 0, 0, 0]);
    gl.bindVertexArray(kept.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, kept.count);
    gl.bindVertexArray(null);
  }

  // Faces (corners of one convex face) and lines (pairs of points), with a colour of four numbers.
  drawPlain(points, colour, kind) {
    const gl = this.gl;
    if (!points.length) return;
    const at = this.use(this.plain);
    gl.bindVertexArray(this.lineArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.line);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points.flat()), gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.uniform4fv(at.plain, colour);
    gl.enable(gl.BLEND); gl.depthMask(colour[3] === 1);
    gl.drawArrays({ face: gl.TRIANGLE_FAN, lines: gl.LINES, triangles: gl.TRIANGLES }[kind], 0, points.length);
    gl.depthMask(true); gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
  }
}
