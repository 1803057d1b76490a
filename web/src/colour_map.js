// Colour scales, mixed in OKLab (Björn Ottosson, 2020) so that equal steps look equal.

export const palette = {
  noValue: '#b4b1aa',
  plain: '#d5d5d1',
  link: '#0f9f7c',
  lift: '#7d8288',
};

const ramps = {
  // Light and muted: the path is drawn over it.
  sequential: ['#f4efe2', '#d3e0d6', '#9cc4c4', '#6497b3', '#44689a', '#36407c'],
  diverging: ['#2f5f9e', '#7fa6cc', '#d5dfe6', '#f1ece4', '#ecc9b4', '#d3866d', '#a63a3f'],
  fault: ['#f0a63c', '#d9442f', '#97162c'],
  path: ['#30187a', '#6d23a0', '#b02c93', '#e0486b', '#f5843d'],
};

export const sizeOfTable = 256;

function linear(c) {
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
}

function gamma(c) {
  return c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
}

export function fromHex(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}

export function toHex(rgb) {
  return '#' + rgb.map((c) => Math.round(255 * Math.min(1, Math.max(0, c))).toString(16).padStart(2, '0')).join('');
}

export function toOklab(rgb) {
  const [r, g, b] = rgb.map(linear);
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

export function fromOklab([L, a, b]) {
  const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (L - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ].map((c) => Math.min(1, Math.max(0, gamma(Math.max(0, c)))));
}

/** sRGB colour, 0 to 1, at `t` in [0, 1] of a named ramp. */
export function colourAt(name, t) {
  const stops = ramps[name];
  const x = Math.min(1, Math.max(0, t)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(x));
  const from = toOklab(fromHex(stops[i]));
  const to = toOklab(fromHex(stops[i + 1]));
  return fromOklab(from.map((c, k) => c + (x - i) * (to[k] - c)));
}

/**
 * Table of RGBA bytes over [0, 1]. `limit` in (0, 1), where given, ends the good values: above it the colours are
 * those of faults, with a hard edge so that the eye finds it.
 */
export function colourTable(name, limit = null) {
  const table = new Uint8Array(4 * sizeOfTable);
  for (let i = 0; i < sizeOfTable; ++i) {
    const t = (i + 0.5) / sizeOfTable;
    let rgb;
    if (limit === null || limit >= 1) rgb = colourAt(name, limit === null ? t : t / limit);
    else if (t <= limit) rgb = colourAt(name, (0.55 * t) / limit);
    else rgb = colourAt('fault', (t - limit) / (1 - limit));
    rgb.forEach((c, k) => { table[4 * i + k] = Math.round(255 * c); });
    table[4 * i + 3] = 255;
  }
  return table;
}
