import assert from 'node:assert/strict';
import { test } from 'node:test';
import { colourAt, colourTable, fromHex, fromOklab, sizeOfTable, toHex, toOklab } from '../src/colour_map.js';

test('OKLab: white is lightness one without chroma, and mixing comes back', () => {
  const [L, a, b] = toOklab([1, 1, 1]);
  assert.ok(Math.abs(L - 1) < 1e-6 && Math.abs(a) < 1e-6 && Math.abs(b) < 1e-6);
  for (const hex of ['#000000', '#ff0000', '#12f0a9', '#7f7f80', '#ffffff']) {
    assert.equal(toHex(fromOklab(toOklab(fromHex(hex)))), hex);
  }
});

test('the sequential ramp darkens steadily, so that it reads without colour vision', () => {
  let last = Infinity;
  for (let i = 0; i <= 50; ++i) {
    const [L] = toOklab(colourAt('sequential', i / 50));
    assert.ok(L < last, `lightness at ${i / 50}`);
    last = L;
  }
});

test('the diverging ramp is lightest at zero', () => {
  const lightness = (t) => toOklab(colourAt('diverging', t))[0];
  for (const t of [0, 0.2, 0.4, 0.6, 0.8, 1]) assert.ok(lightness(t) < lightness(0.5));
});

test('values beyond the ends take the end colours', () => {
  assert.deepEqual(colourAt('path', -3), colourAt('path', 0));
  assert.deepEqual(colourAt('path', 3), colourAt('path', 1));
});

test('a limit splits the table: blue side below, red side above', () => {
  const table = colourTable('sequential', 0.5);
  const at = (i) => [...table.subarray(4 * i, 4 * i + 3)];
  const [below, above] = [at(sizeOfTable / 2 - 1), at(sizeOfTable / 2)];
  assert.ok(below[2] > below[0], 'just below the limit is bluish');
  assert.ok(above[0] > above[2] + 60, 'just above the limit is reddish');
});

test('a limit above the range leaves all values good', () => {
  const table = colourTable('sequential', 2);
  for (let i = 0; i < sizeOfTable; ++i) {
    // Red never leads by more than in the paper tone that the ramp begins with.
    assert.ok(table[4 * i] - table[4 * i + 2] <= 0xf4 - 0xe2);
  }
});
