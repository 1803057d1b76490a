// The keyboard.
const views = { f: 'fit', 1: 'iso', 2: 'top', 3: 'front', 4: 'right' };

export function connectKeys({ timeBar, look, desk }) {
  window.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === 'SELECT') return;
    const key = event.key.toLowerCase();
    if (act(key, event)) event.preventDefault();
  });

  function act(key, event) {
    if (views[key]) return done(() => look(views[key]));
    const layer = Object.entries(desk.model.layers).find(([, { key: own }]) => own === key);
    if (layer) return done(() => desk.toggleLayer(layer[0]));
    if (!timeBar) return false;
    if (key === ' ' && !(event.target instanceof HTMLInputElement && event.target.type === 'checkbox')) return done(() => timeBar.toggle());
    if (key === 'arrowright') return done(() => timeBar.step(event.shiftKey ? 10 : 1));
    if (key === 'arrowleft') return done(() => timeBar.step(event.shiftKey ? -10 : -1));
    if (key === 'home') return done(() => timeBar.setTime(0));
    if (key === 'end') return done(() => timeBar.setTime(timeBar.path.duration));
    return false;
  }

  function done(action) {
    action();
    return true;
  }
}
