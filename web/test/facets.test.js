import assert from 'node:assert/strict';
import { test } from 'node:test';
import { cornerNormals, faceNormals, featureEdges, normalsInside } from '../src/facets.js';
import { segmentsOf } from '../src/isolines.js';
import { interpolate } from '../src/hover.js';

/** Two unit squares that meet along the y axis at an angle. */
function roof(angle) {
  const positions = Float32Array.of(0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0,
    -Math.cos(angle), 0, -Math.sin(angle), -Math.cos(angle), 1, -Math.sin(angle));
  return { positions, triangles: Uint32Array.of(0, 2, 1, 2, 3, 1, 0, 1, 4, 4, 1, 5) };
}
const cosine = Math.cos((35 * Math.PI) / 180);

test('the normal of a triangle has twice its area as length', () => {
  const { positions, triangles } = roof(0.3);
  const normals = faceNormals(positions, triangles);
  for (let f = 0; f < normals.length; f += 3) assert.ok(Math.abs(Math.hypot(...normals.subarray(f, f + 3)) - 1) < 1e-6);
});

test('a gentle bend is smoothed, a sharp one is kept', () => {
  for (const [angle, smooth] of [[0.3, true], [1.2, false]]) {
    const { positions, triangles } = roof(angle);
    const corners = cornerNormals(positions, triangles, faceNormals(positions, triangles), cosine);
    const flat = corners[2] > 1 - 1e-6;  // corner 0 of the level square, at the ridge
    assert.equal(flat, !smooth, `angle ${angle}`);
    assert.ok(corners[3 + 2] > 1 - 1e-6, 'away from the ridge nothing changes');
  }
});

test('feature edges are the boundary, and the ridge where it is sharp', () => {
  for (const [angle, expected] of [[0.3, 6], [1.2, 7]]) {
    const { positions, triangles } = roof(angle);
    assert.equal(featureEdges(positions, triangles, faceNormals(positions, triangles), cosine).length / 6, expected);
  }
});

test('closed isolines come round, open ones do not', () => {
  const positions = Float32Array.of(0, 0, 0, 1, 0, 0, 1, 1, 0);
  assert.equal(segmentsOf([{ positions, closed: false }]).length / 6, 2);
  const closed = segmentsOf([{ positions, closed: true }]);
  assert.equal(closed.length / 6, 3);
  assert.deepEqual([...closed.subarray(15)], [0, 0, 0]);
});

test('reading a value: linear, exact at vertices, and none where a corner that counts has none', () => {
  const values = [1, 5, Infinity];
  assert.equal(interpolate(values, [0, 1, 2], [0.25, 0.75, 0]), 4);
  assert.equal(interpolate(values, [0, 1, 2], [1, 0, 0]), 1);
  assert.ok(!Number.isFinite(interpolate(values, [0, 1, 2], [0.3, 0.3, 0.4])));
});

test('inside a triangle of the part, normals of a finer mesh go from corner to corner', () => {
  const { positions, triangles } = roof(0.3);
  const corners = cornerNormals(positions, triangles, faceNormals(positions, triangles), cosine);
  // The level square's first triangle (0, 2, 1) once more, halved from corner 0 to the middle of the other side.
  const finer = Float32Array.of(...positions, 0.5, 0.5, 0);
  const mesh = { positions: finer, triangles: Uint32Array.of(0, 2, 6, 0, 6, 1), part: { triangles, parents: Uint32Array.of(0, 0) } };
  const inside = normalsInside(mesh, corners);
  const close = (at, expected) => expected.forEach((x, k) => assert.ok(Math.abs(inside[3 * at + k] - x) < 1e-6, `corner ${at}`));
  close(0, corners.subarray(0, 3));
  close(1, corners.subarray(3, 6));
  close(5, corners.subarray(6, 9));
  const mean = [0, 1, 2].map((k) => corners[3 + k] + corners[6 + k]);
  close(2, mean.map((x) => x / Math.hypot(...mean)));
  close(4, mean.map((x) => x / Math.hypot(...mean)));
});
