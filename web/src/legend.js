// The key to the colours: a bar with ticks for the surface, and one for the path.
import { colourAt, palette, toHex } from './colour_map.js';
import { feedRange } from './path_lines.js';
import { COVER, LIFT, LINK } from './path.js';
import { formatNumber, formatTime, niceTicks, withUnit } from './scale.js';

/** CSS gradient of a table of RGBA bytes; every entry keeps its own place, so a hard edge stays hard. */
export function gradientOf(table) {
  const n = table.length / 4;
  const stops = [];
  for (let i = 0; i < n; i += 2) {
    stops.push(`rgb(${table[4 * i]},${table[4 * i + 1]},${table[4 * i + 2]}) ${((100 * (i + 0.5)) / n).toFixed(2)}%`);
  }
  return `linear-gradient(to right,${stops.join(',')})`;
}

/** Where on the scale a value stands, in per cent. */
export function placeOf(value, [least, greatest]) {
  return Math.min(100, Math.max(0, (100 * (value - least)) / (greatest - least)));
}

function element(parent, tag, className, text = '') {
  const node = document.createElement(tag);
  node.className = className;
  node.textContent = text;
  parent.append(node);
  return node;
}

export class SurfaceLegend {
  constructor(root) {
    this.root = root;
  }

  show(surface, index) {
    this.root.replaceChildren();
    this.needle = null;
    this.root.hidden = index < 0;
    if (index < 0) return;
    const { name, unit, limit, values } = surface.scalars[index];
    const range = surface.scales[index];
    this.range = range;
    element(this.root, 'div', 'name', unit ? `${capital(name)}, ${unit}` : capital(name));
    const bar = element(this.root, 'div', 'bar');
    bar.style.background = gradientOf(surface.tableOf(index));
    this.needle = element(bar, 'div', 'needle');
    this.needle.hidden = true;
    const ticks = element(this.root, 'div', 'ticks');
    for (const value of niceTicks(...range, 4)) {
      const tick = element(ticks, 'span', '', formatNumber(value, (range[1] - range[0]) / 100));
      const place = placeOf(value, range);
      // At the ends the text would leave the card.
      if (place < 5) tick.style.cssText = 'left:0;transform:none';
      else if (place > 95) tick.style.cssText = 'left:auto;right:0;transform:none';
      else tick.style.left = `${place}%`;
    }
    if (limit !== null && limit > range[0] && limit < range[1]) {
      const mark = element(bar, 'div', 'limit');
      mark.style.left = `${placeOf(limit, range)}%`;
      element(this.root, 'div', 'note', `limit ${withUnit(formatNumber(limit, (range[1] - range[0]) / 1000), unit)}`);
    }
    if (values.some((value) => !Number.isFinite(value))) {
      const note = element(this.root, 'div', 'note');
      element(note, 'i', 'swatch').style.background = palette.noValue;
      note.append('no value');
    }
  }

  /** Points at the value under the pointer. */
  point(value) {
    if (!this.needle) return;
    this.needle.hidden = !Number.isFinite(value);
    if (Number.isFinite(value)) this.needle.style.left = `${placeOf(value, this.range)}%`;
  }
}

const pathTitles = { length: 'Path, start to end', feed: 'Feed, mm/min', plain: 'Path' };

export function showPathLegend(root, path, what) {
  root.replaceChildren();
  element(root, 'div', 'name', pathTitles[what]);
  if (what !== 'plain') {
    const table = new Uint8Array(4 * 64);
    for (let i = 0; i < 64; ++i) colourAt('path', i / 63).forEach((c, k) => { table[4 * i + k] = Math.round(255 * c); });
    element(root, 'div', 'bar').style.background = gradientOf(table);
    const ticks = element(root, 'div', 'ticks ends');
    const ends = what === 'feed' ? feedRange(path) : [0, path.duration];
    for (const end of ends) element(ticks, 'span', '', what === 'feed' ? formatNumber(end, 1) : clockText(path, end));
  }
  const kinds = element(root, 'div', 'kinds');
  const used = new Set(path.kinds.slice(1));
  const swatches = { [COVER]: ['cover', toHex(colourAt('path', 0.4))], [LINK]: ['link', palette.link], [LIFT]: ['lift', palette.lift] };
  for (const [kind, [label, colour]] of Object.entries(swatches)) {
    if (!used.has(Number(kind))) continue;
    const item = element(kinds, 'span', '');
    const swatch = element(item, 'i', label === 'lift' ? 'stroke dashed' : 'stroke');
    swatch.style.color = colour;
    item.append(label);
  }
}

export function clockText(path, t) {
  return path.clockUnit === 's' ? formatTime(t) : `${formatNumber(t, path.duration / 1000)}\u202fmm`;
}

export function capital(text) {
  return text.slice(0, 1).toUpperCase() + text.slice(1);
}
