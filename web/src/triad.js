// The small axes in the corner that say which way the part is turned.
const names = ['x', 'y', 'z'];
const reach = 26;

/** Ends of the unit axes on the screen from the columns of the camera's world matrix, the farthest first. */
export function axisEnds(elements) {
  return names
    .map((name, k) => ({ name, x: elements[k], y: -elements[4 + k], depth: elements[8 + k] }))
    .sort((a, b) => a.depth - b.depth);
}

export function drawTriad(svg, elements) {
  svg.innerHTML = axisEnds(elements)
    .map(({ name, x, y, depth }) => `<g class="${name}" opacity="${(0.72 + 0.28 * depth).toFixed(2)}">` +
      `<path d="M0 0L${(reach * x).toFixed(1)} ${(reach * y).toFixed(1)}"/>` +
      `<text x="${((reach + 9) * x).toFixed(1)}" y="${((reach + 9) * y + 3.5).toFixed(1)}">${name}</text></g>`)
    .join('');
}
