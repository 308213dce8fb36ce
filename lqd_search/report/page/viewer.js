"use strict";

const VERTEX_SHADER = `
attribute vec3 position, normal;
uniform mat4 view, pose;
uniform float shadow;
varying vec3 seen, turned;
void main() {
  vec4 place = pose * vec4(position, 1.0);
  if (shadow > 0.0) place.z = 0.0006;
  seen = place.xyz;
  turned = mat3(pose[0].xyz, pose[1].xyz, pose[2].xyz) * normal;
  gl_Position = view * place;
}`;
const FRAGMENT_SHADER = `
precision highp float;
uniform vec3 color, eye;
uniform float shadow;
varying vec3 seen, turned;
void main() {
  if (shadow > 0.0) { gl_FragColor = vec4(0.0, 0.0, 0.0, shadow); return; }
  vec3 toEye = normalize(eye - seen);
  vec3 n = normalize(turned);
  if (dot(n, toEye) < 0.0) n = -n;
  vec3 lamp = normalize(vec3(0.25, 0.45, 1.0));
  float light = 0.42 + 0.16 * n.z + 0.42 * max(dot(n, lamp), 0.0) + 0.12 * max(dot(n, toEye), 0.0);
  float shine = 0.18 * pow(max(dot(n, normalize(lamp + toEye)), 0.0), 40.0);
  gl_FragColor = vec4(color * light + shine, 1.0);
}`;
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const BACKGROUND = [0.89, 0.91, 0.94];

// Draws one scene after another in a canvas; the camera stays where it was left.
class Viewer {
  constructor(canvas, step) {
    this.canvas = canvas;
    this.step = step;
    this.camera = { target: [0.42, 0.0, 0.16], azimuth: 1.95, elevation: 0.42, distance: 1.35 };
    this.gl = canvas.getContext("webgl", { alpha: false, antialias: true, stencil: true, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error("This browser has no WebGL, which the rollouts need; switch it on, or use another.");
    this.program = compile(this.gl);
    this.parts = [];
    this.poses = [];
    this.bodies = [];
    this.listen();
    new ResizeObserver(() => this.fit()).observe(canvas);
  }

  show(stage) {
    const gl = this.gl;
    for (const part of this.parts) gl.deleteBuffer(part.buffer);
    this.bodies = stage.bodies;
    this.parts = stage.parts.map((part) => {
      const corners = cornersOf(part, this.step);
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, corners, gl.STATIC_DRAW);
      const raised = part.vertices.some((value, i) => i % 3 === 2 && value > 0);
      return { buffer, count: corners.length / 6, color: part.color, body: part.body, shades: part.body >= 0 || raised };
    });
  }

  clear() {
    this.show({ bodies: [], parts: [] });
    this.pose([], 0);
  }

  // `poses` holds seven whole numbers for each body of the scene, from `start` on.
  pose(poses, start) {
    this.matrices = new Map(this.bodies.map((body, i) => [body, poseMatrix(poses, start + 7 * i, this.step)]));
    this.draw();
  }

  fit() {
    const scale = window.devicePixelRatio || 1;
    this.canvas.width = Math.max(1, Math.round(this.canvas.clientWidth * scale));
    this.canvas.height = Math.max(1, Math.round(this.canvas.clientHeight * scale));
    this.draw();
  }

  draw() {
    if (!this.matrices) return;
    const gl = this.gl;
    const { view, eye } = this.looking();
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(...BACKGROUND, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.useProgram(this.program.handle);
    gl.enable(gl.DEPTH_TEST);
    gl.uniformMatrix4fv(this.program.view, false, view);
    gl.uniform3fv(this.program.eye, eye);
    gl.uniform1f(this.program.shadow, 0);
    for (const part of this.parts) this.drawPart(part);
    this.drawShadows();
  }

  // Each pixel is darkened once, however many parts lie above it.
  drawShadows() {
    const gl = this.gl;
    gl.enable(gl.STENCIL_TEST);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.uniform1f(this.program.shadow, 0.22);
    for (const part of this.parts) if (part.shades) this.drawPart(part);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    gl.disable(gl.STENCIL_TEST);
  }

  drawPart(part) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, part.buffer);
    gl.vertexAttribPointer(this.program.position, 3, gl.FLOAT, false, 24, 0);
    gl.vertexAttribPointer(this.program.normal, 3, gl.FLOAT, false, 24, 12);
    gl.enableVertexAttribArray(this.program.position);
    gl.enableVertexAttribArray(this.program.normal);
    gl.uniformMatrix4fv(this.program.pose, false, this.matrices.get(part.body) || IDENTITY);
    gl.uniform3fv(this.program.color, part.color);
    gl.drawArrays(gl.TRIANGLES, 0, part.count);
  }

  looking() {
    const { target, azimuth, elevation, distance } = this.camera;
    const back = [
      Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation),
    ];
    const eye = target.map((value, i) => value + distance * back[i]);
    const right = unit(cross([0, 0, 1], back));
    const up = cross(back, right);
    return { view: multiply(perspective(this.canvas.width / this.canvas.height), lookAt(eye, right, up, back)), eye, right, up };
  }

  listen() {
    const canvas = this.canvas;
    let last = null;
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointerup", () => { last = null; });
    canvas.addEventListener("pointercancel", () => { last = null; });
    canvas.addEventListener("pointermove", (event) => {
      if (!last) return;
      const moved = [event.clientX - last[0], event.clientY - last[1]];
      last = [event.clientX, event.clientY];
      if (event.shiftKey || event.buttons & 2) this.move(...moved);
      else this.turn(...moved);
    });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      const distance = this.camera.distance * Math.exp(0.001 * event.deltaY);
      this.camera.distance = Math.min(6, Math.max(0.2, distance));
      this.draw();
    }, { passive: false });
  }

  turn(x, y) {
    this.camera.azimuth -= 0.008 * x;
    this.camera.elevation = Math.min(1.5, Math.max(-0.3, this.camera.elevation + 0.008 * y));
    this.draw();
  }

  move(x, y) {
    const { right, up } = this.looking();
    const scale = 0.0012 * this.camera.distance;
    this.camera.target = this.camera.target.map((value, i) => value + scale * (y * up[i] - x * right[i]));
    this.draw();
  }
}

function compile(gl) {
  const handle = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(handle, shader);
  }
  gl.linkProgram(handle);
  if (!gl.getProgramParameter(handle, gl.LINK_STATUS)) throw new Error(`WebGL refused the shaders: ${gl.getProgramInfoLog(handle)}`);
  const program = { handle };
  for (const name of ["position", "normal"]) program[name] = gl.getAttribLocation(handle, name);
  for (const name of ["view", "pose", "color", "eye", "shadow"]) program[name] = gl.getUniformLocation(handle, name);
  return program;
}

function poseMatrix(poses, start, step) {
  const [x, y, z] = [0, 1, 2].map((i) => poses[start + i] * step);
  const quaternion = [3, 4, 5, 6].map((i) => poses[start + i]);
  const length = Math.hypot(...quaternion);
  const [w, i, j, k] = quaternion.map((value) => value / length);
  return [
    1 - 2 * (j * j + k * k), 2 * (i * j + k * w), 2 * (i * k - j * w), 0,
    2 * (i * j - k * w), 1 - 2 * (i * i + k * k), 2 * (j * k + i * w), 0,
    2 * (i * k + j * w), 2 * (j * k - i * w), 1 - 2 * (i * i + j * j), 0,
    x, y, z, 1,
  ];
}

function perspective(aspect) {
  const [near, far, f] = [0.05, 12, 1 / Math.tan(0.35)];
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
}

function lookAt(eye, right, up, back) {
  return [
    right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
  ];
}

// Both are 4 by 4 and stand column after column.
function multiply(a, b) {
  return IDENTITY.map((_, at) => {
    const [column, row] = [at >> 2, at & 3];
    return [0, 1, 2, 3].reduce((sum, k) => sum + a[4 * k + row] * b[4 * column + k], 0);
  });
}
