// Everything in the scene, by layers that can be shown and hidden.
import { arrows, axisTicks, sign } from './path_marks.js';
import { isolineObject } from './isolines.js';
import { PathLines } from './path_lines.js';
import { poseAt } from './path.js';
import { Surface } from './surface.js';
import { ToolMarker } from './tool_marker.js';

export class Model {
  constructor(report, path, view) {
    this.path = path;
    this.view = view;
    this.surface = new Surface(report);
    view.scene.add(this.surface.group);
    this.layers = { edges: { label: 'Edges', key: 'e', shown: true, objects: [this.surface.edges] } };
    if (report.isolines.length) this.addIsolines(report.isolines, report.meta.isolines_name);
    if (path) this.addPath(report.meta.area);
  }

  addIsolines(isolines, label) {
    this.isolines = isolineObject(isolines);
    this.view.scene.add(this.isolines);
    // A path that follows the isolines would be drawn twice over.
    this.layers.isolines = { label, key: 'i', shown: !this.path, objects: [this.isolines] };
  }

  addPath(area) {
    const { path, view } = this;
    const size = view.radius;
    const spacing = Math.min(path.coverLength > 0 ? area / path.coverLength : Infinity, 0.2 * size);
    this.lines = new PathLines(path);
    this.arrows = arrows(path, Math.min(160, Math.max(12, (0.08 * path.coverLength) / spacing)), 0.55 * spacing, this.lines.forward);
    this.ticks = axisTicks(path, Math.min(1200, path.coverLength / spacing), Math.max(0.03 * size, 0.8 * spacing));
    this.start = sign('start');
    this.end = sign('end');
    this.tool = new ToolMarker(0.34 * size);
    view.scene.add(this.lines.group, this.arrows, this.ticks, this.start, this.end, this.tool.group);
    view.beforeDraw.push(() => this.adaptToZoom(spacing));
    this.layers.path = { label: 'Path', key: 'p', shown: true, objects: [this.lines.group, this.start, this.end] };
    this.layers.arrows = { label: 'Direction', key: 'd', shown: true, objects: [this.arrows] };
    this.layers.axes = { label: 'Tool axes', key: 'a', shown: false, objects: [this.ticks] };
    this.layers.tool = { label: 'Tool', key: 't', shown: true, objects: [this.tool.group] };
  }

  adaptToZoom(spacing) {
    const pixel = this.view.lengthOfPixel();
    this.lines.setWidth(spacing / pixel, pixel);
    // A sprite without attenuation keeps its size relative to the height of the picture.
    const scale = (22 / this.view.container.clientHeight) * 2 * Math.tan((this.view.camera.fov * Math.PI) / 360);
    for (const [mark, index] of [[this.start, 0], [this.end, this.path.n - 1]]) {
      mark.scale.setScalar(scale);
      // Stands in front of the surface by its own size, which would cut it in half otherwise.
      mark.position.fromArray(this.path.positions, 3 * index);
      const toCamera = this.view.camera.position.clone().sub(mark.position).normalize();
      mark.position.addScaledVector(toCamera, 14 * pixel);
    }
  }

  /** Moves the tool; the pose it takes is returned. At rest at the start the whole path shows. */
  setTime(t) {
    const pose = poseAt(this.path, t);
    this.tool.setPose(pose);
    this.lines.setNow(t > 0 ? t : null);
    return pose;
  }

  setTheme(dark) {
    this.surface.setInk(dark ? '#0b0d10' : '#2c3138');
  }
}
