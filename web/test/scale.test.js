import assert from 'node:assert/strict';
import { test } from 'node:test';
import { finiteRange, formatNumber, formatTime, niceTicks, scaleOf, sizeQuantile } from '../src/scale.js';

const scalar = (values, more = {}) => ({ values: Float32Array.from(values), least: null, greatest: null, limit: null, diverging: false, ...more });

test('the range leaves out what is not finite', () => {
  assert.deepEqual(finiteRange([NaN, 3, -2, Infinity]), [-2, 3]);
  assert.deepEqual(finiteRange([NaN, Infinity]), [0, 1]);
});

test('a scale keeps the ends it was given and is never empty', () => {
  assert.deepEqual(scaleOf(scalar([1, 5], { least: 0 })), [0, 5]);
  assert.deepEqual(scaleOf(scalar([1, 5], { greatest: 4 })), [1, 4]);
  const [least, greatest] = scaleOf(scalar([7, 7]));
  assert.ok(greatest > least && least === 7);
});

test('a diverging scale is symmetric and not ruled by one extreme value', () => {
  const values = Array.from({ length: 999 }, (_, i) => Math.sin(i));
  const [least, greatest] = scaleOf(scalar([...values, 1e6], { diverging: true }));
  assert.equal(least, -greatest);
  assert.ok(greatest <= 1 && greatest > 0.9);
  assert.equal(sizeQuantile(Float32Array.of(-4, 1, 2, NaN, 3), 1), 4);
});

test('ticks are multiples of one round step inside the range', () => {
  for (const [least, greatest] of [[0, 60], [-0.0005, 0.0005], [3.1, 3.2], [0, 1e6], [-7, 13]]) {
    const ticks = niceTicks(least, greatest, 5);
    assert.ok(ticks.length >= 2 && ticks.length <= 7, `${ticks}`);
    const step = ticks[1] - ticks[0];
    for (const tick of ticks) {
      assert.ok(tick >= least - 1e-9 * step && tick <= greatest + 1e-9 * step);
      assert.ok(Math.abs(tick / step - Math.round(tick / step)) < 1e-6);
    }
    const lead = step / 10 ** Math.floor(Math.log10(step * (1 + 1e-9)));
    assert.ok([1, 2, 2.5, 5].some((x) => Math.abs(x - lead) < 1e-6), `step ${step}`);
  }
});

test('numbers are written with the digits that matter', () => {
  assert.equal(formatNumber(3.14159, 0.01), '3.14');
  assert.equal(formatNumber(120, 10), '120');
  assert.equal(formatNumber(2.5, 0.001), '2.5');
  assert.equal(formatNumber(-0.0001, 0.01), '0');
  assert.equal(formatNumber(-2, 1), '\u22122');
  assert.equal(formatNumber(NaN), '–');
  assert.equal(formatNumber(1e-12), '1.00e-12');
});

test('times carry over', () => {
  assert.equal(formatTime(7.31), '0:07.3');
  assert.equal(formatTime(59.97), '1:00.0');
  assert.equal(formatTime(3727), '1:02:07');
});
