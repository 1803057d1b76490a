// The path as thick lines with a dark casing, like roads on a map: covering moves by colour, links in their own, lifts
// thin and dashed. Moves that lie ahead of the tool are dimmed while it runs.
import { Color, Group, InstancedBufferAttribute, InstancedInterleavedBuffer, InterleavedBufferAttribute } from 'three';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
import { colourAt, fromHex, palette } from './colour_map.js';
import { finiteRange } from './scale.js';
import { COVER, LIFT, LINK } from './path.js';

const allAhead = 1e30;  // "now" when the tool is not under way: nothing is dimmed

export class PathLines {
  constructor(path) {
    this.path = path;
    this.now = { value: allAhead };
    // Lines face the screen while the surface slopes, so they come forward along the line of sight, by this many mm.
    this.forward = { value: 0 };
    this.dim = { value: new Color('#d9d7d1') };
    this.group = new Group();
    this.covers = new Strand(path, COVER);
    this.links = new Strand(path, LINK);
    this.lifts = new Strand(path, LIFT);
    this.lines = this.covers.geometry ? this.addCased(this.covers, { vertexColors: true }) : null;
    this.linkLines = this.links.geometry ? this.addCased(this.links, { color: palette.link }) : null;
    if (this.lifts.geometry) this.addLifts();
    this.colourBy('length');
  }

  addCased(strand, parameters) {
    const casing = this.line(strand, { color: '#1b1a24', depthWrite: false }, 1);
    const core = this.line(strand, parameters, 2);
    return { casing, core };
  }

  addLifts() {
    // Light dashes on a dark line: seen before the part and beside it, in the light and in the dark.
    this.line(this.lifts, { color: '#3a3f47', linewidth: 2, depthWrite: false }, 1);
    this.liftLine = this.line(this.lifts, { color: '#ffffff', linewidth: 1.1, dashed: true }, 2);
    this.liftLine.computeLineDistances();
  }

  line(strand, parameters, order) {
    const material = new LineMaterial(parameters);
    material.onBeforeCompile = (shader) => adapt(shader, { now: this.now, dim: this.dim, forward: this.forward });
    const line = new LineSegments2(strand.geometry, material);
    line.renderOrder = order;
    this.group.add(line);
    return line;
  }

  /** 'length', 'feed' or 'plain'. */
  colourBy(what) {
    this.what = what;
    if (!this.covers.geometry) return;
    this.covers.setColours(shadeOf(this.path, what));
  }

  /** Width in pixels from how far apart the passes look: lines must not run together. */
  setWidth(spacingInPixels, lengthOfPixel) {
    const width = Math.min(3, Math.max(0.9, 0.3 * spacingInPixels));
    for (const lines of [this.lines, this.linkLines]) {
      if (!lines) continue;
      lines.core.material.linewidth = width;
      lines.casing.material.linewidth = width + Math.min(1.6, 0.55 * width);
      lines.casing.visible = width > 1.2;
    }
    this.forward.value = 6 * lengthOfPixel;
    if (this.liftLine) {
      this.liftLine.material.dashSize = 5 * lengthOfPixel;
      this.liftLine.material.gapSize = 4 * lengthOfPixel;
    }
  }

  /** Dims what lies after clock time `t`; null dims nothing. */
  setNow(t) {
    this.now.value = t ?? allAhead;
  }
}

/** The moves of one kind as line segments with the clock at their ends. */
class Strand {
  constructor(path, kind) {
    this.moves = [];
    for (let i = 0; i + 1 < path.n; ++i) {
      // A segment of no length has no direction to be drawn along.
      if (path.kinds[i + 1] === kind && path.lengths[i + 1] > path.lengths[i]) this.moves.push(i);
    }
    if (!this.moves.length) return;
    const ends = new Float32Array(6 * this.moves.length);
    const axes = new Float32Array(6 * this.moves.length);
    const clock = new Float32Array(2 * this.moves.length);
    this.moves.forEach((i, k) => {
      ends.set(path.positions.subarray(3 * i, 3 * i + 6), 6 * k);
      axes.set(path.axes.subarray(3 * i, 3 * i + 6), 6 * k);
      clock[2 * k] = path.clock[i];
      clock[2 * k + 1] = path.clock[i + 1];
    });
    this.geometry = new LineSegmentsGeometry().setPositions(ends);
    this.geometry.setAttribute('instanceClock', new InstancedBufferAttribute(clock, 2));
    const pairs = new InstancedInterleavedBuffer(axes, 6, 1);
    this.geometry.setAttribute('axisStart', new InterleavedBufferAttribute(pairs, 3, 0));
    this.geometry.setAttribute('axisEnd', new InterleavedBufferAttribute(pairs, 3, 3));
  }

  setColours(shade) {
    const colours = new Float32Array(6 * this.moves.length);
    const colour = new Color();
    this.moves.forEach((i, k) => {
      for (const end of [0, 1]) {
        colour.setRGB(...shade(i, end), 'srgb').toArray(colours, 6 * k + 3 * end);
      }
    });
    this.geometry.setColors(colours);
  }
}

/** The colour at an end of move i. */
function shadeOf(path, what) {
  const table = Array.from({ length: 256 }, (_, i) => colourAt('path', i / 255));
  const at = (t) => table[Math.round(255 * Math.min(1, Math.max(0, t)))];
  if (what === 'plain') return () => fromHex('#3a2f6b');
  if (what === 'feed') {
    const [least, greatest] = feedRange(path);
    return (i) => at((path.feeds[i + 1] - least) / (greatest - least || 1));
  }
  const total = path.lengths[path.n - 1] || 1;
  return (i, end) => at(path.lengths[i + end] / total);
}

/** Least and greatest feed of the covering moves. */
export function feedRange(path) {
  return finiteRange(path.feeds.filter((feed, i) => i > 0 && path.kinds[i] === COVER));
}

/** Teaches three's line shader to dim what lies ahead and to come forward: the farther, the more the surface (across the
 * tool's axis) slopes away from the eye, where it would cut the flat line in half. */
function adapt(shader, uniforms) {
  Object.assign(shader.uniforms, uniforms);
  const come = (end, axis) => `${end}.xyz *= max(0.5, 1.0 - forward * ahead(${axis}, ${end}.xyz) / length(${end}.xyz));`;
  shader.vertexShader = shader.vertexShader
    .replace('void main() {', 'attribute vec2 instanceClock;\nattribute vec3 axisStart;\nattribute vec3 axisEnd;\nuniform float forward;\nvarying float vClock;\n' +
      'float ahead(vec3 axis, vec3 place) {\n  return 0.4 + 0.6 / max(0.12, abs(dot(normalize(normalMatrix * axis), normalize(place))));\n}\n' +
      'void main() {\nvClock = position.y < 0.5 ? instanceClock.x : instanceClock.y;')
    .replace('vec4 end = modelViewMatrix * vec4( instanceEnd, 1.0 );', `$&\n${come('start', 'axisStart')}\n${come('end', 'axisEnd')}`);
  shader.fragmentShader = shader.fragmentShader
    .replace('void main() {', 'uniform float now;\nuniform vec3 dim;\nvarying float vClock;\nvoid main() {')
    .replace('#include <color_fragment>', '#include <color_fragment>\nif (vClock > now) diffuseColor.rgb = mix(diffuseColor.rgb, dim, 0.78);');
}
