// The card beside the pointer with the values under it.
import { capital } from './legend.js';
import { formatNumber, withUnit } from './scale.js';

export function connectPointer({ view, probe, report, desk, tip }) {
  const canvas = view.renderer.domElement;
  let pending = 0;
  let last = null;

  /** What lies at a place of the canvas, in pixels from its top left. */
  function read(x, y) {
    view.camera.updateMatrixWorld();
    return probe.at((2 * x) / canvas.clientWidth - 1, 1 - (2 * y) / canvas.clientHeight, view.camera);
  }

  function show() {
    pending = 0;
    const hit = last && read(last.x, last.y);
    tip.hidden = !hit;
    const active = desk.model.surface.active;
    desk.legend.point(hit && active >= 0 ? hit.values[active] : NaN);
    if (!hit) return;
    tip.replaceChildren(...linesFor(hit, active));
    const { x, y } = last;
    tip.style.left = `${Math.min(x + 16, canvas.clientWidth - tip.offsetWidth - 8)}px`;
    tip.style.top = `${Math.min(y + 18, canvas.clientHeight - tip.offsetHeight - 8)}px`;
  }

  function linesFor(hit, active) {
    const rows = report.scalars.map(({ name, unit }, i) => {
      const [least, greatest] = desk.model.surface.scales[i];
      return row(capital(name), withUnit(formatNumber(hit.values[i], (greatest - least) / 2000), unit), i === active ? 'active' : '');
    });
    const [x, y, z] = hit.point.map((value, k) => formatNumber(value + report.meta.origin[k], 0.01));
    return [...rows, row('', `${x}, ${y}, ${z}`, 'place')];
  }

  canvas.addEventListener('pointermove', (event) => {
    // Reading while turning the part would only flicker.
    last = event.buttons ? null : { x: event.offsetX, y: event.offsetY };
    pending ||= requestAnimationFrame(show);
  });
  canvas.addEventListener('pointerleave', () => {
    last = null;
    pending ||= requestAnimationFrame(show);
  });
  return read;
}

function row(label, value, className) {
  const node = document.createElement('div');
  node.className = className;
  const name = document.createElement('span');
  name.textContent = label;
  const number = document.createElement('b');
  number.textContent = value;
  node.append(name, number);
  return node;
}
