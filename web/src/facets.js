// What shading needs of a triangle mesh: normals that keep sharp edges sharp, and the edges worth drawing.

/** Normal of each triangle with twice its area as length. */
export function faceNormals(positions, triangles) {
  const normals = new Float32Array(triangles.length);
  for (let f = 0; f < triangles.length; f += 3) {
    const a = 3 * triangles[f];
    const b = 3 * triangles[f + 1];
    const c = 3 * triangles[f + 2];
    const ux = positions[b] - positions[a];
    const uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a];
    const vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    normals[f] = uy * vz - uz * vy;
    normals[f + 1] = uz * vx - ux * vz;
    normals[f + 2] = ux * vy - uy * vx;
  }
  return normals;
}

/** For each vertex, the triangles around it: those of vertex v are faces[starts[v]] to faces[starts[v + 1] - 1]. */
function facesAround(nVertices, triangles) {
  const starts = new Uint32Array(nVertices + 1);
  for (const v of triangles) ++starts[v + 1];
  for (let v = 0; v < nVertices; ++v) starts[v + 1] += starts[v];
  const next = starts.slice(0, nVertices);
  const faces = new Uint32Array(triangles.length);
  triangles.forEach((v, corner) => { faces[next[v]++] = Math.floor(corner / 3); });
  return { starts, faces };
}

/** Unit normal at each corner of each triangle: the area-weighted mean of the triangles around the vertex that turn
 * away from this one by less than the crease angle. */
export function cornerNormals(positions, triangles, normals, creaseCosine) {
  const { starts, faces } = facesAround(positions.length / 3, triangles);
  const lengths = new Float32Array(triangles.length / 3);
  for (let f = 0; f < lengths.length; ++f) lengths[f] = Math.hypot(normals[3 * f], normals[3 * f + 1], normals[3 * f + 2]);
  const out = new Float32Array(3 * triangles.length);
  for (let corner = 0; corner < triangles.length; ++corner) {
    const f = Math.floor(corner / 3);
    const nx = normals[3 * f];
    const ny = normals[3 * f + 1];
    const nz = normals[3 * f + 2];
    let x = 0;
    let y = 0;
    let z = 0;
    const v = triangles[corner];
    for (let k = starts[v]; k < starts[v + 1]; ++k) {
      const g = faces[k];
      const dot = nx * normals[3 * g] + ny * normals[3 * g + 1] + nz * normals[3 * g + 2];
      if (g !== f && dot < creaseCosine * lengths[f] * lengths[g]) continue;
      x += normals[3 * g];
      y += normals[3 * g + 1];
      z += normals[3 * g + 2];
    }
    const norm = Math.hypot(x, y, z) || 1;
    out[3 * corner] = x / norm;
    out[3 * corner + 1] = y / norm;
    out[3 * corner + 2] = z / norm;
  }
  return out;
}

/** Corner normals of a finer mesh: those of the part's triangles (`normals`, by corner), spread linearly inside them. */
export function normalsInside({ positions, triangles, part }, normals) {
  const out = new Float32Array(3 * triangles.length);
  for (let corner = 0; corner < triangles.length; ++corner) {
    const parent = 3 * part.parents[Math.floor(corner / 3)];
    const weights = weightsIn(positions, part.triangles.subarray(parent, parent + 3), triangles[corner]);
    const n = [0, 1, 2].map((k) => weights.reduce((sum, weight, i) => sum + weight * normals[3 * (parent + i) + k], 0));
    const norm = Math.hypot(...n) || 1;
    for (let k = 0; k < 3; ++k) out[3 * corner + k] = n[k] / norm;
  }
  return out;
}

/** Barycentric coordinates of vertex v in the triangle of three others; a triangle without area gives its first. */
function weightsIn(positions, [a, b, c], v) {
  const from = (p, q) => [0, 1, 2].map((k) => positions[3 * q + k] - positions[3 * p + k]);
  const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
  const [u, w, p] = [from(a, b), from(a, c), from(a, v)];
  const [uu, uw, ww, pu, pw] = [dot(u, u), dot(u, w), dot(w, w), dot(p, u), dot(p, w)];
  const scale = uu * ww - uw * uw;
  if (!(scale > 1e-12 * uu * ww)) return [1, 0, 0];
  const s = (ww * pu - uw * pw) / scale;
  const t = (uu * pw - uw * pu) / scale;
  return [1 - s - t, s, t];
}

/** End points of the boundary edges and of the edges that turn by more than the crease angle: [ax, ay, az, bx, ...]. */
export function featureEdges(positions, triangles, normals, creaseCosine) {
  const nVertices = positions.length / 3;
  const open = new Map();  // edges seen once, with their triangle
  const pairs = [];
  for (let corner = 0; corner < triangles.length; ++corner) {
    const f = Math.floor(corner / 3);
    const a = triangles[corner];
    const b = triangles[corner % 3 === 2 ? corner - 2 : corner + 1];
    const key = Math.min(a, b) * nVertices + Math.max(a, b);
    const g = open.get(key);
    if (g === undefined) {
      open.set(key, f);
      continue;
    }
    open.delete(key);
    const dot = normals[3 * f] * normals[3 * g] + normals[3 * f + 1] * normals[3 * g + 1] + normals[3 * f + 2] * normals[3 * g + 2];
    const size = Math.hypot(normals[3 * f], normals[3 * f + 1], normals[3 * f + 2]) *
      Math.hypot(normals[3 * g], normals[3 * g + 1], normals[3 * g + 2]);
    if (dot < creaseCosine * size) pairs.push(a, b);
  }
  for (const key of open.keys()) pairs.push(Math.floor(key / nVertices), key % nVertices);
  const out = new Float32Array(3 * pairs.length);
  pairs.forEach((v, i) => out.set(positions.subarray(3 * v, 3 * v + 3), 3 * i));
  return out;
}
