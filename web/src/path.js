// The path that is drawn and played: the tool's where there is one, otherwise the impact curve's.

export const COVER = 0;
export const LINK = 1;
export const LIFT = 2;
export const kindNames = ['cover', 'link', 'lift'];

/** Arc length up to each point. */
export function arcLengths(positions) {
  const n = positions.length / 3;
  const lengths = new Float64Array(n);
  for (let i = 1; i < n; ++i) {
    const a = 3 * (i - 1);
    lengths[i] = lengths[i - 1] +
      Math.hypot(positions[a + 3] - positions[a], positions[a + 4] - positions[a + 1], positions[a + 5] - positions[a + 2]);
  }
  return lengths;
}

/** Null when there is nothing to draw. The clock is time in seconds, or arc length in mm where no time is known. */
export function pathOf({ tool, impact }) {
  const source = tool ?? impact;
  if (!source || source.positions.length < 6) return null;
  const lengths = arcLengths(source.positions);
  const n = lengths.length;
  const timed = Boolean(source.times) && source.times[n - 1] > 0;
  const clock = timed ? source.times : lengths;
  return {
    n,
    positions: source.positions,
    axes: source.axes,
    kinds: source.kinds,
    pieces: source.pieces,
    feeds: source.feeds ?? null,
    lengths,
    clock,
    clockUnit: timed ? 's' : 'mm',
    duration: clock[n - 1],
    coverLength: lengthOfKind(lengths, source.kinds, COVER),
  };
}

/** A move's kind is that of the point it arrives at. */
export function lengthOfKind(lengths, kinds, kind) {
  let sum = 0;
  for (let i = 1; i < lengths.length; ++i) if (kinds[i] === kind) sum += lengths[i] - lengths[i - 1];
  return sum;
}

/** Index of the point that the move under way at time `t` leaves from, 0 to n - 2. */
export function moveAt(clock, t) {
  let low = 0;
  let high = clock.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (clock[middle] <= t) low = middle;
    else high = middle;
  }
  return low;
}

/** Where the tool is at time `t`, and how it stands. */
export function poseAt(path, t) {
  const i = moveAt(path.clock, t);
  const step = path.clock[i + 1] - path.clock[i];
  const f = step > 0 ? Math.min(1, Math.max(0, (t - path.clock[i]) / step)) : 1;
  const mix = (values) => [0, 1, 2].map((k) => (1 - f) * values[3 * i + k] + f * values[3 * i + 3 + k]);
  const axis = mix(path.axes);
  const norm = Math.hypot(...axis);
  return {
    position: mix(path.positions),
    // Two opposite axes have no middle: keep the first.
    axis: norm > 1e-6 ? axis.map((x) => x / norm) : [0, 1, 2].map((k) => path.axes[3 * i + k]),
    kind: path.kinds[i + 1],
    piece: path.pieces[i + 1],
    feed: path.feeds ? path.feeds[i + 1] : null,
    length: path.lengths[i] + f * (path.lengths[i + 1] - path.lengths[i]),
    index: i,
  };
}

/** Positions along the covering moves at a fixed distance of arc length: [{index, fraction}]. */
export function stations(path, distance) {
  const places = [];
  let next = distance / 2;
  for (let i = 0; i + 1 < path.n; ++i) {
    const step = path.lengths[i + 1] - path.lengths[i];
    while (next <= path.lengths[i + 1] && step > 0) {
      if (path.kinds[i + 1] === COVER) places.push({ index: i, fraction: (next - path.lengths[i]) / step });
      next += distance;
    }
  }
  return places;
}
