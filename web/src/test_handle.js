// window.isopath: what scripts that look at a report (tests, pictures for the documentation) may use.

export function connectTestHandle({ view, model, desk, timeBar, path, report, look, read, loadMs }) {
  const { origin } = report.meta;
  window.isopath = {
    loadMs,
    triangles: report.mesh.triangles.length / 3,
    colours: ['plain', ...report.scalars.map(({ name }) => name)],
    layers: Object.keys(model.layers),
    /** End of the clock: seconds, or mm where the path has no times; 0 without a path. */
    duration: path ? path.duration : 0,
    time: () => (timeBar ? timeBar.time : 0),
    setTime: (t) => timeBar?.setTime(t),
    /** The tool's tip in the part's coordinates, mm; null without a path. */
    toolPosition: () => (path ? model.tool.group.position.toArray().map((x, k) => x + origin[k]) : null),
    setColour: (name) => desk.setColour(name),
    setPathColour: (what) => desk.setPathColour(what),
    setLayer: (name, shown) => desk.setLayer(name, shown),
    /** 'fit', 'iso', 'top', 'bottom', 'front' or 'right'. */
    look,
    /** { point, face, values by name } at a place of the canvas in pixels, or null beside the part. */
    read: (x, y) => {
      const hit = read(x, y);
      if (!hit) return null;
      const values = Object.fromEntries(report.scalars.map(({ name }, i) => [name, hit.values[i]]));
      return { point: hit.point.map((value, k) => value + origin[k]), face: hit.face, values };
    },
    /** How far from the middle of the picture the path comes, 1 being its edge; 0 without a path. */
    pathReach: () => {
      const p = view.camera.position.clone();
      let reach = 0;
      for (let i = 0; i < (path?.n ?? 0); ++i) {
        p.fromArray(path.positions, 3 * i).project(view.camera);
        reach = Math.max(reach, Math.abs(p.x), Math.abs(p.y));
      }
      return reach;
    },
    /** Draws at once. */
    draw: () => view.draw(),
  };
}
