import assert from 'node:assert/strict';
import { test } from 'node:test';
import { histogramSvg, layout, shownBins } from '../src/histogram.js';

const histogram = (more = {}) => ({
  title: 'Gap', unit: 'mm', bin_width: 0.5, shares: [0.1, 0.4, 0.3, 0.2, 0, 0, 0, 0], marks: [], limit: null, ...more,
});

test('the area of a bar is in proportion to its share', () => {
  const { bars } = layout(histogram());
  for (const bar of bars) assert.ok(Math.abs(bar.height / bars[1].height - bar.share / 0.4) < 1e-9);
  for (const bar of bars) assert.ok(Math.abs(bar.width - bars[0].width) < 1e-9);
});

test('bars stand side by side on one base', () => {
  const { bars } = layout(histogram());
  bars.slice(1).forEach((bar, i) => assert.ok(Math.abs(bar.x - bars[i].x - bars[i].width) < 1e-9));
  for (const bar of bars) assert.ok(Math.abs(bar.y + bar.height - bars[0].y - bars[0].height) < 1e-9);
});

test('empty bins at the end go, unless a mark lies there', () => {
  assert.equal(shownBins(histogram()), 4);
  assert.equal(shownBins(histogram({ marks: [{ value: 2.7, label: 'spacing' }] })), 7);
});

test('bins above the limit are faults', () => {
  const { bars } = layout(histogram({ limit: 1 }));
  assert.deepEqual(bars.slice(0, 4).map((bar) => bar.fault), [false, false, true, true]);
});

test('marks stand at their value', () => {
  const { bars, marks } = layout(histogram({ marks: [{ value: 1, label: 'm' }] }));
  assert.ok(Math.abs(marks[0].x - bars[2].x) < 1e-9);
});

test('text of others cannot end the picture', () => {
  const svg = histogramSvg(histogram({ title: '"><script>', marks: [{ value: 1, label: '<b>&' }] }));
  assert.ok(!svg.includes('<script>') && svg.includes('&lt;b&gt;&amp;'));
});

test('nothing at all still draws', () => {
  assert.match(histogramSvg(histogram({ shares: [0, 0] })), /^<svg.*<\/svg>$/);
});
