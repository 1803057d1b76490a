// Puts the report together in the page.
import { readReport } from './data.js';
import { faceNormals } from './facets.js';
import { histogramSvg, escape } from './histogram.js';
import { Probe } from './hover.js';
import { connectKeys } from './keys.js';
import { Model } from './model.js';
import { capital, showPathLegend, SurfaceLegend } from './legend.js';
import { pathOf } from './path.js';
import { connectPointer } from './pointer.js';
import { TimeBar } from './time_bar.js';
import { connectTestHandle } from './test_handle.js';
import { drawTriad } from './triad.js';
import { directionFor, presets, View } from './view.js';

const byId = (id) => document.getElementById(id);

function addHistograms(histograms) {
  for (const histogram of histograms) {
    const section = document.createElement('section');
    section.innerHTML = `<h2>${escape(histogram.title)}${histogram.unit ? `, ${escape(histogram.unit)}` : ''}</h2>${histogramSvg(histogram)}`;
    byId('histograms').append(section);
  }
}

/** What a person can change, kept in step with the controls that show it. */
class Desk {
  constructor(view, model, path) {
    Object.assign(this, { view, model, path });
    this.legend = new SurfaceLegend(byId('surface-legend'));
    this.surfaceSelect = byId('surface-colour');
    this.surfaceSelect.add(new Option('Plain', 'plain'));
    for (const { name } of model.surface.scalars) this.surfaceSelect.add(new Option(capital(name), name));
    this.surfaceSelect.addEventListener('change', () => this.setColour(this.surfaceSelect.value));
    this.setColour(model.surface.scalars[0]?.name ?? 'plain');
    this.addPathSelect();
    this.addLayers();
  }

  addPathSelect() {
    const select = byId('path-colour');
    byId('path-colour-label').hidden = !this.path;
    if (!this.path) return;
    const ways = { length: 'Along its length', ...(this.path.feeds ? { feed: 'Feed' } : {}), plain: 'Plain' };
    for (const [value, label] of Object.entries(ways)) select.add(new Option(label, value));
    select.addEventListener('change', () => this.setPathColour(select.value));
    this.setPathColour('length');
    byId('path-legend').hidden = false;
  }

  addLayers() {
    this.boxes = {};
    for (const [name, layer] of Object.entries(this.model.layers)) {
      const label = document.createElement('label');
      const box = document.createElement('input');
      box.type = 'checkbox';
      box.addEventListener('change', () => this.setLayer(name, box.checked));
      label.append(box, layer.label);
      label.title = `Show or hide (${layer.key.toUpperCase()})`;
      byId('layers').append(label);
      this.boxes[name] = box;
      this.setLayer(name, layer.shown);
    }
  }

  setColour(name) {
    const index = this.model.surface.scalars.findIndex((scalar) => scalar.name === name);
    this.surfaceSelect.value = index < 0 ? 'plain' : name;
    this.model.surface.colourBy(index);
    this.legend.show(this.model.surface, index);
    this.view.invalidate();
  }

  setPathColour(what) {
    byId('path-colour').value = what;
    this.model.lines.colourBy(what);
    showPathLegend(byId('path-legend'), this.path, what);
    this.view.invalidate();
  }

  setLayer(name, shown) {
    this.boxes[name].checked = shown;
    for (const object of this.model.layers[name].objects) object.visible = shown;
    this.view.invalidate();
  }

  toggleLayer(name) {
    this.setLayer(name, !this.boxes[name].checked);
  }
}

function followSystemTheme(model, view) {
  const dark = window.matchMedia('(prefers-color-scheme: dark)');
  const apply = () => {
    model.setTheme(dark.matches);
    view.invalidate();
  };
  dark.addEventListener('change', apply);
  apply();
}

function start() {
  const started = performance.now();
  const report = readReport((id) => byId(id).textContent);
  addHistograms(report.meta.histograms);
  const view = new View(byId('stage'), report.mesh.positions);
  const path = pathOf(report);
  if (path) view.include(path.positions);
  const model = new Model(report, path, view);
  const desk = new Desk(view, model, path);
  followSystemTheme(model, view);
  let timeBar = null;
  timeBar = path
    ? new TimeBar(byId('timebar'), path, (t) => {
        timeBar?.describe(model.setTime(t), report.meta.origin);
        view.invalidate();
      })
    : null;
  timeBar?.setTime(0);
  view.beforeDraw.push(() => drawTriad(byId('triad'), view.camera.matrixWorld.elements));
  const front = directionFor(faceNormals(report.mesh.positions, report.mesh.triangles));
  const probe = new Probe(report);
  const read = connectPointer({ view, probe, report, desk, tip: byId('probe') });
  const insetsFromPage = () => {
    const height = (id) => byId(id).offsetHeight + (byId(id).offsetHeight ? 14 : 0);
    // The part may run under the legends a little: they are narrow, and it is what one came to see.
    view.setInsets({ top: 0.5 * height('toolbar'), bottom: height('timebar'), left: 0.45 * byId('legends').offsetWidth, right: 0 });
  };
  const fit = (direction) => {
    insetsFromPage();
    view.fit(direction);
  };
  const look = (name) => (name === 'fit' ? fit() : fit(name === 'iso' ? front : presets[name]));
  for (const button of document.querySelectorAll('[data-view]')) button.addEventListener('click', () => look(button.dataset.view));
  connectKeys({ timeBar, look, desk });
  look('iso');
  view.draw();
  connectTestHandle({ view, model, desk, timeBar, path, report, look, read, loadMs: performance.now() - started });
}

try {
  start();
} catch (error) {
  // The tables above are plain HTML and stay; only the picture is missing.
  const trouble = byId('trouble');
  trouble.hidden = false;
  trouble.textContent = `The picture cannot be drawn: ${error.message}`;
  document.body.classList.add('without-picture');
}
