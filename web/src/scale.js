// The range of a scalar, its ticks, and how numbers are written.

/** Least and greatest finite value; [0, 1] when there is none. */
export function finiteRange(values) {
  let least = Infinity;
  let greatest = -Infinity;
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    if (value < least) least = value;
    if (value > greatest) greatest = value;
  }
  return least <= greatest ? [least, greatest] : [0, 1];
}

/** The value that a share `q` of the finite values does not exceed in size. */
export function sizeQuantile(values, q) {
  const sizes = Float64Array.from(values.filter((value) => Number.isFinite(value)), Math.abs).sort();
  return sizes.length ? sizes[Math.min(sizes.length - 1, Math.floor(q * sizes.length))] : 1;
}

/** The ends of a scalar's colour scale. A few extreme curvatures must not flatten the rest, so 98 % of the values
 * span a scale about zero. */
export function scaleOf(scalar) {
  let [least, greatest] = finiteRange(scalar.values);
  if (scalar.diverging) {
    greatest = sizeQuantile(scalar.values, 0.98);
    least = -greatest;
  }
  least = scalar.least ?? least;
  greatest = scalar.greatest ?? greatest;
  if (!(greatest > least)) greatest = least + Math.max(1e-6, 1e-6 * Math.abs(least));
  return [least, greatest];
}

/** Round values inside [least, greatest], about `count` of them. */
export function niceTicks(least, greatest, count = 5) {
  const raw = (greatest - least) / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((m) => m * power).find((s) => s >= raw * (1 - 1e-9));
  const ticks = [];
  for (let k = Math.ceil(least / step - 1e-9); k * step <= greatest + 1e-9 * step; ++k) ticks.push(k * step + 0);
  return ticks;
}

/** A number with the digits that a difference of `resolution` needs, and no more. */
export function formatNumber(value, resolution = Math.abs(value) / 1000) {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const digits = resolution > 0 ? Math.ceil(-Math.log10(resolution) - 1e-9) : 3;
  if (digits > 7 || Math.abs(value) >= 1e9) return value.toPrecision(3);
  const text = value.toFixed(Math.max(0, digits));
  const short = text.includes('.') ? text.replace(/\.?0+$/, '') : text;
  return (short === '-0' ? '0' : short).replace('-', '\u2212');
}

export function withUnit(text, unit) {
  return unit ? `${text}\u202f${unit}` : text;
}

/** Seconds as 0:07.3 or 1:02:07. */
export function formatTime(seconds) {
  const tenths = Math.round(10 * Math.max(0, seconds));
  const hours = Math.floor(tenths / 36000);
  const minutes = Math.floor(tenths / 600) % 60;
  const rest = (tenths % 600) / 10;
  if (hours > 0) return `${hours}:${String(minutes).padStart(2, '0')}:${String(Math.floor(rest)).padStart(2, '0')}`;
  return `${minutes}:${rest.toFixed(1).padStart(4, '0')}`;
}
