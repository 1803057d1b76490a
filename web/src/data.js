// Reads the data blocks of the page back: the other side of src/isopath/post/report_blocks.cpp.

/** The bytes that a base64 text stands for, as an ArrayBuffer. */
export function decodeBase64(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes.buffer;
}

/** The report of the page; `read(id)` gives the text of a block. Every computer that has WebGL is little-endian. */
export function readReport(read) {
  const meta = JSON.parse(read('meta'));
  const floats = (id) => new Float32Array(decodeBase64(read(id)));
  const words = (id) => new Uint32Array(decodeBase64(read(id)));
  return {
    meta,
    mesh: {
      positions: floats('mesh-positions'), triangles: words('mesh-triangles'),
      // The part's own triangles where the shown ones are finer, and which of them each shown one is a part of.
      part: meta.refined ? { triangles: words('part-triangles'), parents: words('mesh-parents') } : null,
    },
    scalars: meta.scalars.map((scalar, i) => ({ ...scalar, values: floats(`scalar-${i}`) })),
    isolines: meta.isolines.length ? splitLines(meta.isolines, floats('isoline-points')) : [],
    impact: meta.impact
      ? { positions: floats('impact-points'), axes: floats('impact-normals'), ...splitMoves(words('impact-moves')) }
      : null,
    tool: meta.tool
      ? {
          positions: floats('tool-tips'), axes: floats('tool-axes'), ...splitMoves(words('tool-moves')),
          feeds: floats('tool-feeds'), times: floats('tool-times'),
        }
      : null,
  };
}

/** The lines that lie one after the other in one array of coordinates. */
export function splitLines(lines, coordinates) {
  let start = 0;
  return lines.map(({ points, closed, level }) => {
    const line = { closed, level, positions: coordinates.subarray(3 * start, 3 * (start + points)) };
    start += points;
    return line;
  });
}

function splitMoves(words) {
  const n = words.length / 2;
  const kinds = new Uint8Array(n);
  const pieces = new Uint32Array(n);
  for (let i = 0; i < n; ++i) {
    kinds[i] = words[2 * i];
    pieces[i] = words[2 * i + 1];
  }
  return { kinds, pieces };
}
