// What explains the path: arrows along it, its start and end, and the tool's axis.
import {
  BufferAttribute, BufferGeometry, CanvasTexture, DoubleSide, Float32BufferAttribute, InstancedMesh, LineBasicMaterial,
  LineSegments, Matrix4, MeshBasicMaterial, Sprite, SpriteMaterial, SRGBColorSpace, Vector3,
} from 'three';
import { stations } from './path.js';

/** Flat arrowheads on the covering moves, about `count` of them, `size` mm long. They stay in front of the lines, which
 * come `forward` (a shared uniform) themselves. */
export function arrows(path, count, size, forward) {
  const places = stations(path, path.lengths[path.n - 1] / count);
  const geometry = new BufferGeometry();
  // A swept arrowhead in the plane of x (ahead) and y, z up.
  geometry.setAttribute('position', new Float32BufferAttribute([0.6, 0, 0, -0.4, 0.42, 0, -0.18, 0, 0, 0.6, 0, 0, -0.18, 0, 0, -0.4, -0.42, 0], 3));
  const material = new MeshBasicMaterial({ color: '#17151f', side: DoubleSide });
  material.onBeforeCompile = (shader) => {
    shader.uniforms.forward = forward;
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nuniform float forward;')
      .replace('#include <project_vertex>', `#include <project_vertex>
        mvPosition.xyz *= max(0.45, 1.0 - 1.4 * forward / length(mvPosition.xyz));
        gl_Position = projectionMatrix * mvPosition;`);
  };
  const mesh = new InstancedMesh(geometry, material, places.length);
  const along = new Vector3();
  const up = new Vector3();
  const side = new Vector3();
  const at = new Vector3();
  places.forEach(({ index, fraction }, k) => {
    const a = new Vector3().fromArray(path.positions, 3 * index);
    const b = new Vector3().fromArray(path.positions, 3 * index + 3);
    along.subVectors(b, a).normalize();
    up.fromArray(path.axes, 3 * index + 3);
    side.crossVectors(up, along).normalize();
    up.crossVectors(along, side);
    at.lerpVectors(a, b, fraction).addScaledVector(up, 0.06 * size);
    mesh.setMatrixAt(k, new Matrix4().makeBasis(along, side, up).scale(new Vector3(size, size, size)).setPosition(at));
  });
  mesh.renderOrder = 3;
  return mesh;
}

/** A short line along the axis at about `count` points of the covering moves. */
export function axisTicks(path, count, length) {
  const ends = [];
  for (const { index: i } of stations(path, path.lengths[path.n - 1] / count)) {
    for (const reach of [0, length]) {
      for (let k = 0; k < 3; ++k) ends.push(path.positions[3 * i + 3 + k] + reach * path.axes[3 * i + 3 + k]);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(ends), 3));
  return new LineSegments(geometry, new LineBasicMaterial({ color: '#2b6cb0', transparent: true, opacity: 0.75 }));
}

/** A sign of constant size on the screen: a triangle in a disc for the start, a square for the end. */
export function sign(kind) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 96;
  const pen = canvas.getContext('2d');
  pen.beginPath();
  pen.arc(48, 48, 40, 0, 2 * Math.PI);
  pen.fillStyle = '#ffffff';
  pen.fill();
  pen.lineWidth = 8;
  pen.strokeStyle = '#17151f';
  pen.stroke();
  pen.fillStyle = kind === 'start' ? '#0f8f5f' : '#b3263a';
  pen.beginPath();
  if (kind === 'start') {
    pen.moveTo(37, 27);
    pen.lineTo(37, 69);
    pen.lineTo(72, 48);
  } else {
    pen.rect(32, 32, 32, 32);
  }
  pen.fill();
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({ map: texture, sizeAttenuation: false, alphaTest: 0.35 }));
  sprite.renderOrder = 5;
  return sprite;
}
