// What the surface says under the pointer: the point and the values there.
import { BufferAttribute, BufferGeometry, DoubleSide, Raycaster, Triangle, Vector2, Vector3 } from 'three';
import { MeshBVH } from 'three-mesh-bvh';

export class Probe {
  constructor({ mesh, scalars }) {
    this.mesh = mesh;
    this.scalars = scalars;
    this.raycaster = new Raycaster();
  }

  /** The tree is built at the first question, so that the first picture does not wait for it. */
  tree() {
    if (!this.bvh) {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(this.mesh.positions, 3));
      geometry.setIndex(new BufferAttribute(this.mesh.triangles, 1));
      this.bvh = new MeshBVH(geometry, { indirect: true });
    }
    return this.bvh;
  }

  /** Null beside the part; x and y are in normalised device coordinates. */
  at(x, y, camera) {
    this.raycaster.setFromCamera(new Vector2(x, y), camera);
    const hit = this.tree().raycastFirst(this.raycaster.ray, DoubleSide);
    if (!hit) return null;
    const corners = [0, 1, 2].map((k) => this.mesh.triangles[3 * hit.faceIndex + k]);
    const [a, b, c] = corners.map((v) => new Vector3().fromArray(this.mesh.positions, 3 * v));
    const weights = Triangle.getBarycoord(hit.point, a, b, c, new Vector3());
    if (!weights) return null;
    return {
      point: hit.point.toArray(),
      face: this.mesh.part ? this.mesh.part.parents[hit.faceIndex] : hit.faceIndex,
      values: this.scalars.map(({ values }) => interpolate(values, corners, weights.toArray())),
    };
  }
}

/** The linear interpolant; what has no value at a corner that counts has none here. */
export function interpolate(values, corners, weights) {
  return corners.reduce((sum, v, k) => (weights[k] === 0 ? sum : sum + weights[k] * values[v]), 0);
}
