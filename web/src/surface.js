// The part: a shaded surface that looks its colour up in a table by a value at each vertex.
import {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, Group, LinearFilter, LineBasicMaterial,
  LineSegments, Mesh, MeshStandardMaterial, RGBAFormat, SRGBColorSpace, UnsignedByteType,
} from 'three';
import { colourTable, palette, sizeOfTable } from './colour_map.js';
import { cornerNormals, faceNormals, featureEdges, normalsInside } from './facets.js';
import { scaleOf } from './scale.js';

const creaseCosine = Math.cos((35 * Math.PI) / 180);
const noValue = -1e6;  // far below all values, which are kept in [-100, 100]: such a corner blanks its triangles

export class Surface {
  constructor({ mesh, scalars }) {
    this.triangles = mesh.triangles;
    this.scalars = scalars;
    this.scales = scalars.map(scaleOf);
    const { triangles: faces } = mesh.part ?? mesh;
    const normals = faceNormals(mesh.positions, faces);
    let shading = cornerNormals(mesh.positions, faces, normals, creaseCosine);
    if (mesh.part) shading = normalsInside(mesh, shading);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(atCorners(mesh.positions, mesh.triangles, 3), 3));
    geometry.setAttribute('normal', new BufferAttribute(shading, 3));
    this.value = new BufferAttribute(new Float32Array(mesh.triangles.length), 1);
    geometry.setAttribute('value', this.value);

    this.table = new DataTexture(colourTable('sequential'), sizeOfTable, 1, RGBAFormat, UnsignedByteType);
    this.table.colorSpace = SRGBColorSpace;
    this.table.minFilter = this.table.magFilter = LinearFilter;
    this.uniforms = { table: { value: this.table }, coloured: { value: 0 }, blank: { value: new Color(palette.noValue) } };
    const material = new MeshStandardMaterial({
      color: palette.plain, roughness: 0.62, metalness: 0, side: DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 1.5, polygonOffsetUnits: 4,
    });
    material.onBeforeCompile = (shader) => this.colourByTable(shader);

    this.edges = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity: 0.55 }));
    this.edges.geometry.setAttribute('position',
      new BufferAttribute(featureEdges(mesh.positions, faces, normals, creaseCosine), 3));
    this.group = new Group();
    this.group.add(new Mesh(geometry, material), this.edges);
  }

  colourByTable(shader) {
    Object.assign(shader.uniforms, this.uniforms);
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nattribute float value;\nvarying float vValue;')
      .replace('#include <begin_vertex>', '#include <begin_vertex>\nvValue = value;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>',
        '#include <common>\nuniform sampler2D table;\nuniform float coloured;\nuniform vec3 blank;\nvarying float vValue;')
      .replace('#include <color_fragment>', `#include <color_fragment>
        if (coloured > 0.5) diffuseColor.rgb = vValue < -200.0 ? blank : texture2D(table, vec2(clamp(vValue, 0.0, 1.0), 0.5)).rgb;
        if (!gl_FrontFacing) diffuseColor.rgb *= 0.72;`);
  }

  /** Colours by scalar `index`, or plainly for -1. */
  colourBy(index) {
    this.active = index;
    this.uniforms.coloured.value = index < 0 ? 0 : 1;
    if (index < 0) return;
    const { values } = this.scalars[index];
    const [least, greatest] = this.scales[index];
    for (let corner = 0; corner < this.triangles.length; ++corner) {
      const t = (values[this.triangles[corner]] - least) / (greatest - least);
      this.value.array[corner] = Number.isFinite(t) ? Math.min(100, Math.max(-100, t)) : noValue;
    }
    this.value.needsUpdate = true;
    this.table.image.data.set(this.tableOf(index));
    this.table.needsUpdate = true;
  }

  tableOf(index) {
    const { limit, diverging } = this.scalars[index];
    const [least, greatest] = this.scales[index];
    return colourTable(diverging ? 'diverging' : 'sequential', limit === null ? null : (limit - least) / (greatest - least));
  }

  setInk(colour) {
    this.edges.material.color.set(colour);
  }
}

function atCorners(values, triangles, size) {
  const out = new Float32Array(size * triangles.length);
  for (let corner = 0; corner < triangles.length; ++corner) {
    for (let k = 0; k < size; ++k) out[size * corner + k] = values[size * triangles[corner] + k];
  }
  return out;
}
