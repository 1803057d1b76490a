// The slider that moves the tool along the path, and its playback.
import { colourAt, palette, toHex } from './colour_map.js';
import { clockText } from './legend.js';
import { kindNames, LIFT, LINK, moveAt } from './path.js';
import { formatNumber } from './scale.js';

/** Real-time factors worth offering: the whole path in about ten seconds to real time. */
export function speedsFor(path) {
  if (path.clockUnit !== 's') return [path.duration / 30];
  const speeds = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].filter((speed) => speed === 1 || path.duration / speed >= 8);
  return speeds;
}

/** The slowest that shows the whole path within 40 s. */
export function defaultSpeed(path) {
  const speeds = speedsFor(path);
  return speeds.find((speed) => path.duration / speed <= 40) ?? speeds[speeds.length - 1];
}

export class TimeBar {
  /** `onTime(t)` is called whenever the time changes. */
  constructor(root, path, onTime) {
    this.path = path;
    this.onTime = onTime;
    this.time = 0;
    this.find = (name) => root.querySelector(`[data-part="${name}"]`);
    this.slider = this.find('slider');
    this.slider.max = path.duration;
    this.slider.addEventListener('input', () => this.setTime(Number(this.slider.value)));
    this.play = this.find('play');
    this.play.addEventListener('click', () => this.toggle());
    this.fillSpeeds();
    new ResizeObserver(() => this.paintTrack()).observe(this.find('track'));
    root.hidden = false;
  }

  fillSpeeds() {
    this.speed = defaultSpeed(this.path);
    const select = this.find('speed');
    const speeds = speedsFor(this.path);
    select.hidden = speeds.length < 2;
    for (const speed of speeds) select.add(new Option(`${speed}×`, speed, false, speed === this.speed));
    select.addEventListener('change', () => { this.speed = Number(select.value); });
  }

  setTime(t) {
    this.time = Math.min(this.path.duration, Math.max(0, t));
    this.slider.value = this.time;
    this.slider.setAttribute('aria-valuetext', clockText(this.path, this.time));
    this.find('clock').textContent = `${clockText(this.path, this.time)} / ${clockText(this.path, this.path.duration)}`;
    this.onTime(this.time);
  }

  describe(pose, origin) {
    const [x, y, z] = pose.position.map((value, k) => formatNumber(value + origin[k], 0.01));
    const feed = pose.feed === null ? '' : `${formatNumber(pose.feed, 1)} mm/min`;
    const parts = [`x ${x}`, `y ${y}`, `z ${z}`, feed, `piece ${pose.piece + 1}`, kindNames[pose.kind]];
    this.find('pose').replaceChildren(...parts.filter(Boolean).map((text) => {
      const span = document.createElement('span');
      span.textContent = text;
      return span;
    }));
  }

  /** To the next (or an earlier) point of the path. */
  step(count) {
    const { clock, n } = this.path;
    const i = moveAt(clock, this.time);
    let at = Math.min(n - 1, Math.max(0, i + count + (count < 0 && clock[i] < this.time ? 1 : 0)));
    // Points at one time would hold the tool where it is.
    while (count > 0 && at < n - 1 && clock[at] <= this.time) ++at;
    this.setTime(clock[at]);
  }

  toggle() {
    this.playing = !this.playing;
    this.play.setAttribute('aria-pressed', String(this.playing));
    this.play.setAttribute('aria-label', this.playing ? 'Pause' : 'Play');
    if (!this.playing) return;
    if (this.time >= this.path.duration) this.setTime(0);
    let last = performance.now();
    const tick = (now) => {
      if (!this.playing) return;
      this.setTime(this.time + ((now - last) / 1000) * this.speed);
      last = now;
      if (this.time >= this.path.duration) this.toggle();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /** Under the slider: what the tool does at each moment. */
  paintTrack() {
    const canvas = this.find('track');
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.width = width;
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    const pen = canvas.getContext('2d');
    const total = this.path.lengths[this.path.n - 1] || 1;
    for (let x = 0; x < width; ++x) {
      const i = moveAt(this.path.clock, ((x + 0.5) / width) * this.path.duration);
      const kind = this.path.kinds[i + 1];
      pen.fillStyle = kind === LINK ? palette.link : kind === LIFT ? palette.lift : toHex(colourAt('path', this.path.lengths[i] / total));
      pen.globalAlpha = kind === LIFT ? 0.4 : 1;
      pen.fillRect(x, 0, 1, canvas.height);
    }
  }
}
