// Isolines as thin lines.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';

/** Ends of all segments of the lines, closed ones come round. */
export function segmentsOf(isolines) {
  let count = 0;
  for (const { positions, closed } of isolines) count += Math.max(0, positions.length / 3 - (closed ? 0 : 1));
  const ends = new Float32Array(6 * count);
  let at = 0;
  for (const { positions, closed } of isolines) {
    const n = positions.length / 3;
    for (let i = 0; i < (closed ? n : n - 1); ++i) {
      const j = (i + 1) % n;
      ends.set(positions.subarray(3 * i, 3 * i + 3), at);
      ends.set(positions.subarray(3 * j, 3 * j + 3), at + 3);
      at += 6;
    }
  }
  return ends;
}

export function isolineObject(isolines) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(segmentsOf(isolines), 3));
  return new LineSegments(geometry, new LineBasicMaterial({ color: '#26313b', transparent: true, opacity: 0.7 }));
}
