import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decodeBase64, readReport, splitLines } from '../src/data.js';

const base64 = (array) => Buffer.from(array.buffer).toString('base64');

test('base64 comes back byte for byte, for every length of the last group', () => {
  for (let n = 0; n < 9; ++n) {
    const bytes = Uint8Array.from({ length: n }, (_, i) => 251 - 37 * i);
    assert.deepEqual(new Uint8Array(decodeBase64(Buffer.from(bytes).toString('base64'))), bytes);
  }
});

test('lines are split by their number of points', () => {
  const lines = splitLines([{ points: 2, closed: false, level: 1 }, { points: 1, closed: true, level: 2 }],
    Float32Array.from([0, 1, 2, 3, 4, 5, 6, 7, 8]));
  assert.deepEqual(lines.map(({ positions }) => [...positions]), [[0, 1, 2, 3, 4, 5], [6, 7, 8]]);
  assert.deepEqual(lines.map(({ closed, level }) => [closed, level]), [[false, 1], [true, 2]]);
});

test('a report with a tool and without isolines', () => {
  const blocks = {
    meta: JSON.stringify({ scalars: [{ name: 'gap', unit: 'mm' }], isolines: [], impact: false, tool: true }),
    'mesh-positions': base64(Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0)),
    'mesh-triangles': base64(Uint32Array.of(0, 1, 2)),
    'scalar-0': base64(Float32Array.of(1, Infinity, 3)),
    'tool-tips': base64(Float32Array.of(0, 0, 0, 1, 1, 1)),
    'tool-axes': base64(Float32Array.of(0, 0, 1, 0, 0, 1)),
    'tool-moves': base64(Uint32Array.of(0, 0, 2, 5)),
    'tool-feeds': base64(Float32Array.of(100, 200)),
    'tool-times': base64(Float32Array.of(0, 3)),
  };
  const report = readReport((id) => blocks[id]);
  assert.deepEqual([...report.scalars[0].values], [1, Infinity, 3]);
  assert.deepEqual([...report.tool.kinds], [0, 2]);
  assert.deepEqual([...report.tool.pieces], [0, 5]);
  assert.deepEqual(report.isolines, []);
  assert.equal(report.impact, null);
});
