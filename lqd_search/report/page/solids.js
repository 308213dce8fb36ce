"use strict";

const CREASE = Math.cos(Math.PI / 4);

// Returns three corners a face, each a position and a normal that is smooth but over sharp edges.
function cornersOf(part, step) {
  const vertices = Float32Array.from(part.vertices, (value) => value * step);
  const faces = part.faces;
  const n = faces.length / 3;
  const normals = new Float32Array(3 * n);
  const around = Array.from({ length: vertices.length / 3 }, () => []);
  for (let f = 0; f < n; f++) {
    const [a, b, c] = [faces[3 * f], faces[3 * f + 1], faces[3 * f + 2]];
    normals.set(cross(edge(vertices, a, b), edge(vertices, a, c)), 3 * f);
    for (const vertex of [a, b, c]) around[vertex].push(f);
  }
  const corners = new Float32Array(18 * n);
  for (let f = 0; f < n; f++) {
    for (let k = 0; k < 3; k++) {
      const vertex = faces[3 * f + k];
      const at = 18 * f + 6 * k;
      corners.set(vertices.subarray(3 * vertex, 3 * vertex + 3), at);
      corners.set(smoothNormal(normals, f, around[vertex]), at + 3);
    }
  }
  return corners;
}

function smoothNormal(normals, face, neighbours) {
  const own = normals.subarray(3 * face, 3 * face + 3);
  const sum = [0, 0, 0];
  for (const other of neighbours) {
    const normal = normals.subarray(3 * other, 3 * other + 3);
    if (dot(own, normal) >= CREASE * Math.hypot(...own) * Math.hypot(...normal)) {
      for (let i = 0; i < 3; i++) sum[i] += normal[i];
    }
  }
  return unit(sum);
}

function edge(vertices, a, b) {
  return [0, 1, 2].map((i) => vertices[3 * b + i] - vertices[3 * a + i]);
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function unit(a) {
  const length = Math.hypot(...a) || 1;
  return a.map((value) => value / length);
}
