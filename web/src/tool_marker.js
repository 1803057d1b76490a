// The tool as a slender body of revolution whose tip stands at the origin and whose axis is z.
import { CylinderGeometry, Group, Mesh, MeshStandardMaterial, Quaternion, Vector3 } from 'three';

const zAxis = new Vector3(0, 0, 1);

function turned(radiusLow, radiusHigh, low, high, material) {
  const geometry = new CylinderGeometry(radiusHigh, radiusLow, high - low, 40).rotateX(Math.PI / 2).translate(0, 0, (low + high) / 2);
  return new Mesh(geometry, material);
}

export class ToolMarker {
  /** `length` in mm from the tip to the end of the holder. */
  constructor(length) {
    const steel = new MeshStandardMaterial({ color: '#aab1b9', roughness: 0.4, metalness: 0 });
    const dark = new MeshStandardMaterial({ color: '#6a727d', roughness: 0.5, metalness: 0 });
    const accent = new MeshStandardMaterial({ color: '#e2762b', roughness: 0.45, metalness: 0 });
    this.group = new Group();
    this.group.add(
      turned(0.0008 * length, 0.04 * length, 0, 0.16 * length, accent),
      turned(0.04 * length, 0.04 * length, 0.16 * length, 0.56 * length, steel),
      turned(0.055 * length, 0.1 * length, 0.56 * length, 0.64 * length, dark),
      turned(0.1 * length, 0.1 * length, 0.64 * length, length, dark),
      turned(0.103 * length, 0.103 * length, 0.7 * length, 0.725 * length, accent),
    );
  }

  setPose({ position, axis }) {
    this.group.position.fromArray(position);
    this.group.quaternion.copy(new Quaternion().setFromUnitVectors(zAxis, new Vector3().fromArray(axis)));
  }
}
