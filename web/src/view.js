// Renderer, camera and lights. Draws only when something has changed.
import { DirectionalLight, HemisphereLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

const iso = new Vector3(0.62, -0.95, 0.72).normalize();
// Not quite along the z axis, where the camera would have no upright.
export const presets = {
  iso,
  top: new Vector3(0, -1e-4, 1),
  front: new Vector3(0, -1, 0),
  right: new Vector3(1, 0, 0),
  bottom: new Vector3(0, -1e-4, -1),
};

export class View {
  constructor(container, positions) {
    this.container = container;
    this.clouds = [positions];  // what Fit brings into sight
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, powerPreference: 'high-performance' });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    container.prepend(this.renderer.domElement);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(28, 1, 1, 1000);
    this.camera.up.set(0, 0, 1);
    this.scene.add(this.camera);
    this.light();
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    Object.assign(this.controls, { enableDamping: true, dampingFactor: 0.16, zoomToCursor: true, rotateSpeed: 0.9 });
    this.controls.addEventListener('change', () => this.invalidate());
    this.beforeDraw = [];
    this.insets = { left: 0, right: 0, top: 0, bottom: 0 };
    this.radius = Math.max(1e-6, radiusOf(positions));
    this.reach = this.radius;
    new ResizeObserver(() => this.resize()).observe(container);
    this.resize();
  }

  /** Keeps more than the part in sight: a nozzle's path runs well above it. */
  include(positions) {
    this.clouds.push(positions);
    this.reach = Math.max(this.reach, radiusOf(positions));
  }

  /** A headlight from over the left shoulder models the surface from wherever one looks; the sky fills the rest. */
  light() {
    const key = new DirectionalLight('#fffaf3', 2.9);
    key.position.set(-1.2, 0.9, 0.75);
    const rim = new DirectionalLight('#dfe9ff', 0.5);
    rim.position.set(0.9, -0.2, 0.5);
    this.camera.add(key, rim, key.target, rim.target);
    key.target.position.set(0, 0, -1);
    rim.target.position.set(0, 0, -1);
    const sky = new HemisphereLight('#ffffff', '#a3a09b', 0.85);
    sky.position.set(0, 0, 1);
    this.scene.add(sky);
  }

  resize() {
    const width = Math.max(1, this.container.clientWidth);
    const height = Math.max(1, this.container.clientHeight);
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.centre();
    this.invalidate();
  }

  /** Sets how many pixels at each side are covered by controls. */
  setInsets(insets) {
    this.insets = insets;
    this.centre();
  }

  /** Moves the optical centre to the middle of what is free. */
  centre() {
    const { clientWidth: width, clientHeight: height } = this.container;
    const { left, right, top, bottom } = this.insets;
    this.camera.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
  }

  invalidate() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      this.draw();
    });
  }

  draw() {
    this.controls.update();
    const distance = this.camera.position.length();
    this.camera.near = Math.max(distance - 1.6 * this.reach, 0.004 * Math.max(this.radius, distance));
    this.camera.far = distance + 2.5 * this.reach;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    for (const update of this.beforeDraw) update();
    this.renderer.render(this.scene, this.camera);
  }

  /** Length in mm that a pixel shows at the target. */
  lengthOfPixel() {
    const distance = this.camera.position.distanceTo(this.controls.target);
    return (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360)) / this.container.clientHeight;
  }

  /** Sees the whole part and its path from a direction, by default the present one. */
  fit(direction = this.camera.position.clone().sub(this.controls.target)) {
    const toCamera = direction.clone().normalize();
    const right = new Vector3().crossVectors(this.camera.up, toCamera).normalize();
    const up = new Vector3().crossVectors(toCamera, right);
    const box = extents(this.clouds, [right, up, toCamera]);
    const target = new Vector3();
    [right, up, toCamera].forEach((axis, k) => target.addScaledVector(axis, (box[k][0] + box[k][1]) / 2));
    const { left, right: rightInset, top, bottom } = this.insets;
    const slope = (0.94 * Math.tan((this.camera.fov * Math.PI) / 360)) / this.container.clientHeight;
    const slopeUp = slope * Math.max(0.3 * this.container.clientHeight, this.container.clientHeight - top - bottom);
    const slopeRight = slope * Math.max(0.3 * this.container.clientWidth, this.container.clientWidth - left - rightInset);
    let distance = 0;
    const p = new Vector3();
    for (const positions of this.clouds) {
      const step = 3 * Math.max(1, Math.floor(positions.length / 3 / 20000));
      for (let i = 0; i < positions.length; i += step) {
        p.fromArray(positions, i).sub(target);
        const reach = Math.max(Math.abs(p.dot(right)) / slopeRight, Math.abs(p.dot(up)) / slopeUp);
        distance = Math.max(distance, reach + p.dot(toCamera));
      }
    }
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(toCamera, Math.max(distance, 1e-3 * this.radius));
    this.controls.minDistance = 0.002 * this.radius;
    this.controls.maxDistance = 40 * this.radius;
    this.invalidate();
  }
}

/** From where an open surface shows its front: half-way between its mean normal and the usual view. */
export function directionFor(normals) {
  const mean = new Vector3();
  let size = 0;
  const n = new Vector3();
  for (let f = 0; f < normals.length; f += 3) {
    n.fromArray(normals, f);
    mean.add(n);
    size += n.length();
  }
  if (mean.length() < 0.3 * size) return iso.clone();
  return mean.normalize().multiplyScalar(0.75).add(iso).normalize();
}

function radiusOf(positions) {
  let squared = 0;
  for (let i = 0; i < positions.length; i += 3) {
    squared = Math.max(squared, positions[i] ** 2 + positions[i + 1] ** 2 + positions[i + 2] ** 2);
  }
  return Math.sqrt(squared);
}

function extents(clouds, axes) {
  const box = axes.map(() => [Infinity, -Infinity]);
  const p = new Vector3();
  for (const positions of clouds) {
    for (let i = 0; i < positions.length; i += 3) {
      p.fromArray(positions, i);
      axes.forEach((axis, k) => {
        const x = p.dot(axis);
        if (x < box[k][0]) box[k][0] = x;
        if (x > box[k][1]) box[k][1] = x;
      });
    }
  }
  return box;
}
