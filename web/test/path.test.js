import assert from 'node:assert/strict';
import { test } from 'node:test';
import { COVER, LIFT, LINK, moveAt, pathOf, poseAt, stations } from '../src/path.js';

const close = (actual, expected, bound = 1e-6) =>
  actual.forEach((value, k) => assert.ok(Math.abs(value - expected[k]) <= bound, `${actual} is not ${expected}`));

function elbow(times = [0, 2, 2, 6]) {
  return pathOf({
    tool: {
      positions: Float32Array.of(0, 0, 0, 4, 0, 0, 4, 0, 0, 4, 8, 0),
      axes: Float32Array.of(0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0),
      kinds: Uint8Array.of(COVER, COVER, LINK, COVER), pieces: Uint32Array.of(0, 0, 0, 0),
      feeds: Float32Array.of(0, 120, 120, 120), times: Float32Array.from(times),
    },
    impact: null,
  });
}

test('the clock is time; without times it is arc length', () => {
  assert.deepEqual([elbow().clockUnit, elbow().duration], ['s', 6]);
  assert.deepEqual([elbow([0, 0, 0, 0]).clockUnit, elbow([0, 0, 0, 0]).duration], ['mm', 12]);
  assert.equal(pathOf({ tool: null, impact: null }), null);
});

test('the pose is that of the points at their times', () => {
  const path = elbow();
  close(poseAt(path, 0).position, [0, 0, 0]);
  close(poseAt(path, 2).position, [4, 0, 0]);
  close(poseAt(path, 6).position, [4, 8, 0]);
  close(poseAt(path, 6).axis, [1, 0, 0]);
});

test('between points the tip goes evenly and the axis stays a unit vector', () => {
  const path = elbow();
  close(poseAt(path, 0.5).position, [1, 0, 0]);
  close(poseAt(path, 4).position, [4, 4, 0]);
  close(poseAt(path, 4).axis, [Math.SQRT1_2, 0, Math.SQRT1_2]);
  for (let t = 0; t <= 6; t += 0.1) assert.ok(Math.abs(Math.hypot(...poseAt(path, t).axis) - 1) < 1e-6);
});

test('the tip never jumps: it moves by at most its speed', () => {
  const path = elbow();
  for (let t = 0; t < 6; t += 0.01) {
    const [a, b] = [poseAt(path, t).position, poseAt(path, t + 0.01).position];
    assert.ok(Math.hypot(...a.map((x, k) => b[k] - x)) <= 2 * 0.01 + 1e-9);
  }
});

test('opposite axes do not make a vanishing one', () => {
  const path = elbow();
  path.axes = Float32Array.of(0, 0, 1, 0, 0, -1, 0, 0, -1, 0, 0, -1);
  assert.ok(Math.abs(Math.hypot(...poseAt(path, 1).axis) - 1) < 1e-6);
});

test('the move under way, against a plain search', () => {
  const clock = [0, 1, 1, 1, 2.5, 4, 4];
  for (let t = 0; t <= 4; t += 0.125) {  // exact in binary, so that it meets the ties
    let expected = 0;
    for (let i = 0; i <= clock.length - 2; ++i) if (clock[i] <= t) expected = i;
    assert.equal(moveAt(clock, t), expected, `at ${t}`);
  }
});

test('cover length counts covering moves only; a move has the kind of the point it arrives at', () => {
  const path = pathOf({
    tool: null,
    impact: {
      positions: Float32Array.of(0, 0, 0, 3, 0, 0, 3, 5, 0, 3, 5, 7), axes: new Float32Array(12),
      kinds: Uint8Array.of(LIFT, COVER, LINK, LIFT), pieces: new Uint32Array(4),
    },
  });
  assert.equal(path.coverLength, 3);
  assert.equal(path.duration, 15);
});

test('stations are evenly spaced along the path and only on covering moves', () => {
  const path = elbow();
  const places = stations(path, 1);
  assert.equal(places.length, 12);
  places.forEach(({ index, fraction }, k) => {
    const at = path.lengths[index] + fraction * (path.lengths[index + 1] - path.lengths[index]);
    assert.ok(Math.abs(at - (k + 0.5)) < 1e-9);
  });
  path.kinds[3] = LINK;
  assert.equal(stations(path, 1).length, 4);
});
