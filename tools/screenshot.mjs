#!/usr/bin/env node
// A picture of a report:
//   node tools/screenshot.mjs report.html out.png [--size 1440x900] [--view iso] [--color gap] [--path length]
//     [--time 0.6] [--show isolines,axes] [--hide tool] [--only-part] [--dark] [--scale 1]
// --view is iso, top, bottom, front, right; --time is a share of the whole; --only-part leaves out all controls.
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';
import { launchBrowser } from './browser.mjs';

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    size: { type: 'string', default: '1440x900' }, view: { type: 'string', default: 'iso' },
    color: { type: 'string' }, path: { type: 'string' }, time: { type: 'string' },
    show: { type: 'string', default: '' }, hide: { type: 'string', default: '' },
    'only-part': { type: 'boolean', default: false }, dark: { type: 'boolean', default: false },
    scale: { type: 'string', default: '1' },
  },
});
const [report, out] = positionals;
if (!report || !out || positionals.length > 2) {
  console.error('usage: node tools/screenshot.mjs report.html out.png [options]');
  process.exit(2);
}

const [width, height] = values.size.split('x').map(Number);
const browser = await launchBrowser();
try {
  const page = await browser.newPage({
    viewport: { width, height }, deviceScaleFactor: Number(values.scale), colorScheme: values.dark ? 'dark' : 'light',
  });
  await page.goto(pathToFileURL(resolve(report)).href);
  if (values['only-part']) {
    await page.addStyleTag({ content: 'aside, .card, #triad { display: none !important } body { display: block !important } #stage { height: 100vh !important }' });
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  }
  const names = (list) => list.split(',').filter(Boolean);
  await page.evaluate(({ color, path, time, show, hide, view }) => {
    const handle = window.isopath;
    if (color && !handle.colours.includes(color)) throw new Error(`no colour "${color}": there are ${handle.colours.join(', ')}`);
    for (const name of [...show, ...hide]) {
      if (!handle.layers.includes(name)) throw new Error(`no layer "${name}": there are ${handle.layers.join(', ')}`);
    }
    if (color) handle.setColour(color);
    if (path) handle.setPathColour(path);
    if (time !== undefined) handle.setTime(Number(time) * handle.duration);
    for (const name of show) handle.setLayer(name, true);
    for (const name of hide) handle.setLayer(name, false);
    handle.look(view);
    handle.draw();
  }, { ...values, show: names(values.show), hide: names(values.hide) });
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  await page.screenshot({ path: out });
} finally {
  await browser.close();
}
