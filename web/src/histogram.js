// A histogram as an SVG text.
import { formatNumber, niceTicks, withUnit } from './scale.js';

const width = 312;
const height = 132;
const left = 4;
const right = 8;
const top = 22;
const bottom = 22;

/** Drops the empty bins behind everything that is worth showing. */
export function shownBins({ shares, marks, limit, bin_width: binWidth }) {
  let last = shares.length;
  while (last > 1 && shares[last - 1] === 0) --last;
  const furthest = Math.max(0, ...marks.map((mark) => mark.value), limit ?? 0);
  return Math.min(Math.max(last, Math.ceil(furthest / binWidth) + 1), Math.max(shares.length, Math.ceil(furthest / binWidth) + 1));
}

/** Where things stand: bars as {x, y, width, height, fault, from, to, share}, ticks and marks as {x, ...}. */
export function layout(histogram) {
  const { shares, marks, limit, bin_width: binWidth } = histogram;
  const bins = shownBins(histogram);
  const greatest = Math.max(...shares, 1e-12);
  const scale = (width - left - right) / (bins * binWidth);
  const x = (value) => left + value * scale;
  const bars = shares.slice(0, bins).map((share, i) => {
    const size = (share / greatest) * (height - top - bottom);
    return {
      x: x(i * binWidth), y: height - bottom - size, width: binWidth * scale, height: size, share,
      from: i * binWidth, to: (i + 1) * binWidth, fault: limit !== null && i * binWidth >= limit - 1e-9 * binWidth,
    };
  });
  const end = bins * binWidth;
  return {
    bars,
    ticks: niceTicks(0, end, 5).map((value) => ({ x: x(value), text: formatNumber(value, end / 100) })),
    marks: marks.map((mark) => ({ x: x(Math.min(mark.value, end)), label: mark.label })),
  };
}

export function histogramSvg(histogram) {
  const { bars, ticks, marks } = layout(histogram);
  const base = height - bottom;
  const parts = [`<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="${escape(histogram.title)}">`];
  for (const bar of bars) {
    const range = `${formatNumber(bar.from, bar.to / 1000)} to ${withUnit(formatNumber(bar.to, bar.to / 1000), histogram.unit)}`;
    const share = `${formatNumber(100 * bar.share, 0.01)} % of the area`;
    const shown = bar.share > 0 ? Math.max(bar.height, 1) : 0;
    parts.push(`<g><title>${escape(`${range}: ${share}`)}</title>` +
      `<rect class="hit" x="${bar.x}" y="${top}" width="${bar.width}" height="${base - top}"/>` +
      `<rect class="${bar.fault ? 'bar fault' : 'bar'}" x="${bar.x + 0.5}" y="${base - shown}" width="${Math.max(0.5, bar.width - 1)}" height="${shown}" rx="1"/></g>`);
  }
  parts.push(`<path class="axis" d="M${left} ${base + 0.5}H${width - right}"/>`);
  for (const tick of ticks) parts.push(`<text class="tick" x="${Math.max(tick.x, left + 3)}" y="${base + 15}">${tick.text}</text>`);
  for (const mark of spread(marks)) {
    parts.push(`<path class="mark" d="M${mark.x} ${top - 4}V${base}"/>`,
      `<text class="mark" x="${mark.at}" y="${top - 9}" text-anchor="${mark.anchor}">${escape(mark.label)}</text>`);
  }
  return parts.join('') + '</svg>';
}

/** Labels of marks that stand close are pushed to either side of their lines. */
function spread(marks) {
  const sorted = [...marks].sort((a, b) => a.x - b.x);
  return sorted.map((mark, i) => {
    const crowdedRight = sorted[i + 1] && sorted[i + 1].x - mark.x < 60;
    const crowdedLeft = i > 0 && mark.x - sorted[i - 1].x < 60;
    let anchor = 'middle';
    if (mark.x > width - 40 || (crowdedRight && !crowdedLeft)) anchor = 'end';
    else if (mark.x < 40 || crowdedLeft) anchor = 'start';
    return { ...mark, anchor, at: mark.x + (anchor === 'end' ? 2 : anchor === 'start' ? -2 : 0) };
  });
}

export function escape(text) {
  return text.replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c]);
}
