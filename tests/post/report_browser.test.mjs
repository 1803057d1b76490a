// The report as a browser sees it. ISOPATH_REPORT_SAMPLE names the program that writes one from formulas.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { launchBrowser } from '../../tools/browser.mjs';

const sample = process.env.ISOPATH_REPORT_SAMPLE;
let folder;
let browser;
let page;
const requests = [];
const complaints = [];

async function open(file) {
  const opened = await browser.newPage({ viewport: { width: 900, height: 560 } });
  opened.on('request', (request) => requests.push(request.url()));
  opened.on('pageerror', (error) => complaints.push(error.message));
  opened.on('console', (message) => ['error', 'warning'].includes(message.type()) && complaints.push(message.text()));
  await opened.goto(pathToFileURL(file).href);
  assert.ok(await opened.evaluate(() => Boolean(window.isopath)), 'the viewer has started');
  return opened;
}

before(async () => {
  assert.ok(sample, 'ISOPATH_REPORT_SAMPLE is not set');
  folder = mkdtempSync(join(tmpdir(), 'isopath-report-'));
  execFileSync(sample, [join(folder, 'report.html'), '30']);
  browser = await launchBrowser();
  page = await open(join(folder, 'report.html'));
});

after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, { recursive: true });
});

/** The canvas after drawing once more: its bytes as RGBA, every fourth pixel of every fourth row. */
async function pixels() {
  return page.evaluate(() => {
    window.isopath.draw();  // what WebGL has drawn can be read until the browser shows it
    const source = document.querySelector('#stage > canvas');
    const copy = document.createElement('canvas');
    copy.width = Math.floor(source.width / 4);
    copy.height = Math.floor(source.height / 4);
    const pen = copy.getContext('2d');
    pen.imageSmoothingEnabled = false;
    pen.drawImage(source, 0, 0, copy.width, copy.height);
    return Array.from(new Uint32Array(pen.getImageData(0, 0, copy.width, copy.height).data.buffer));
  });
}

/** Share of the pixels that differ. */
function difference(a, b) {
  return a.filter((value, i) => value !== b[i]).length / a.length;
}

test('the picture is drawn', async () => {
  const picture = await pixels();
  assert.ok(new Set(picture).size > 500, 'few colours');
  const drawn = picture.filter((pixel) => pixel >>> 24 !== 0).length / picture.length;
  assert.ok(drawn > 0.2 && drawn < 0.95, `the part takes ${drawn} of the canvas`);
});

test('tables, warnings and histogram are there as text', async () => {
  const text = await page.innerText('aside');
  for (const expected of ['Wavy disc <sample>', 'spiral & 4 mm', 'Covered', '97.4', 'Twice the distance to the nearest pass',
    'The gap is wider than the spacing on 2.6']) {
    assert.ok(text.includes(expected), `no "${expected}"`);
  }
  assert.ok((await page.locator('#histograms rect.bar').count()) > 20);
  assert.equal(await page.locator('#histograms text.mark').textContent(), 'spacing');
});

test('the slider moves the tool along the spiral', async () => {
  const positions = await page.evaluate(() => [0, 0.25, 1].map((share) => {
    const slider = document.querySelector('[data-part="slider"]');
    slider.value = share * window.isopath.duration;
    slider.dispatchEvent(new Event('input'));
    return window.isopath.toolPosition();
  }));
  // The disc's middle is at (100, -40); the spiral begins half a spacing of 4 inside radius 60 and ends near the middle.
  const radii = positions.map(([x, y]) => Math.hypot(x - 100, y + 40));
  assert.ok(Math.abs(radii[0] - 58) < 1e-3, `starts at radius ${radii[0]}`);
  assert.ok(radii[1] < radii[0] - 4 && radii[2] < 0.5, `${radii}`);
  for (const [x, y, z] of positions) {
    const height = 7 * Math.sin((x - 100) / 15) * Math.cos((y + 40) / 19);
    assert.ok(Math.abs(z - height) < 0.01, 'the tip is on the surface');
  }
  const clock = await page.locator('[data-part="clock"]').textContent();
  assert.equal(...clock.split(' / '));
  await page.evaluate(() => window.isopath.setTime(0));
});

test('space plays and pauses, arrows step', async () => {
  await page.keyboard.press('Space');
  // Not by waitForFunction, which the page's own security policy forbids.
  while ((await page.evaluate(() => window.isopath.time())) === 0) await page.waitForTimeout(50);
  await page.keyboard.press('Space');
  const stopped = await page.evaluate(() => window.isopath.time());
  await page.waitForTimeout(200);
  assert.equal(await page.evaluate(() => window.isopath.time()), stopped);
  await page.keyboard.press('ArrowRight');
  assert.ok((await page.evaluate(() => window.isopath.time())) > stopped);
  await page.keyboard.press('Home');
  assert.equal(await page.evaluate(() => window.isopath.time()), 0);
});

test('colour by another value changes the picture and the legend', async () => {
  const before = await pixels();
  await page.selectOption('#surface-colour', 'gap');
  assert.ok(difference(before, await pixels()) > 0.1);
  const legend = await page.innerText('#surface-legend');
  assert.ok(legend.includes('Gap, mm') && legend.includes('limit 4.08') && legend.includes('no value'), legend);
  await page.selectOption('#surface-colour', 'plain');
  assert.ok(await page.locator('#surface-legend').isHidden());
  await page.selectOption('#surface-colour', 'distance');
  assert.ok(difference(before, await pixels()) < 0.002);
});

test('layers can be shown and hidden', async () => {
  const before = await pixels();
  for (const layer of await page.evaluate(() => window.isopath.layers)) {
    await page.evaluate((name) => window.isopath.setLayer(name, true), layer);
    const shown = await pixels();
    await page.evaluate((name) => window.isopath.setLayer(name, false), layer);
    assert.ok(difference(shown, await pixels()) > 1e-4, `${layer} shows nothing`);
    const shownAtFirst = !['isolines', 'axes'].includes(layer);
    await page.evaluate(([name, value]) => window.isopath.setLayer(name, value), [layer, shownAtFirst]);
  }
  assert.ok(difference(before, await pixels()) < 0.002);
});

test('the value under the pointer is the function there', async () => {
  await page.evaluate(() => { window.isopath.look('top'); window.isopath.draw(); });
  const { width, height } = await page.locator('#stage > canvas').boundingBox();
  let read = 0;
  for (let i = 1; i < 10; ++i) {
    const hit = await page.evaluate(([x, y]) => window.isopath.read(x, y), [(i * width) / 10, 0.45 * height]);
    if (!hit) continue;
    ++read;
    const [x, y, z] = [hit.point[0] - 100, hit.point[1] + 40, hit.point[2]];
    // A cone over the plane, interpolated on triangles with edges of 2: the error is at most that of a chord.
    assert.ok(Math.abs(hit.values.distance - (60 - Math.hypot(x, y))) < 0.6, `distance ${hit.values.distance} at ${x}, ${y}`);
    assert.ok(Math.abs(z - 7 * Math.sin(x / 15) * Math.cos(y / 19)) < 0.1);
  }
  assert.ok(read >= 4, 'the pointer met the part');
  await page.mouse.move(0.5 * width, 0.45 * height);
  await page.waitForSelector('#probe:not([hidden])');
  assert.match(await page.innerText('#probe'), /Distance\s*[\d.]+\s*mm/);
});

test('a drag turns the part and Fit keeps it in sight', async () => {
  const before = await pixels();
  await page.mouse.move(300, 260);
  await page.mouse.down();
  await page.mouse.move(360, 300, { steps: 4 });
  await page.mouse.up();
  assert.ok(difference(before, await pixels()) > 0.05);
  await page.keyboard.press('f');
  const picture = await pixels();
  assert.ok(picture.filter((pixel) => pixel >>> 24 !== 0).length > 0.15 * picture.length);
});

test('Fit keeps a path in sight that runs far above the part', async () => {
  const file = join(folder, 'spray.html');
  execFileSync(sample, [file, '10', '150']);
  const spray = await open(file);
  for (const view of ['iso', 'front', 'top', 'fit']) {
    const reach = await spray.evaluate((name) => { window.isopath.look(name); window.isopath.draw(); return window.isopath.pathReach(); }, view);
    assert.ok(reach > 0.3 && reach <= 1, `${view}: the path comes to ${reach} of the way to the edge`);
  }
  await spray.close();
});

test('dark follows the system', async () => {
  const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await paper();
  await page.emulateMedia({ colorScheme: 'dark' });
  assert.notEqual(await paper(), light);
  await page.emulateMedia({ colorScheme: 'light' });
});

test('200,000 triangles load and turn', async () => {
  const file = join(folder, 'large.html');
  execFileSync(sample, [file, '183']);
  const large = await open(file);
  const { triangles, loadMs } = await large.evaluate(() => window.isopath);
  assert.ok(triangles > 200000);
  // A software renderer on a busy machine: a bound that only a quadratic step would break.
  assert.ok(loadMs < 30000, `${loadMs} ms`);
  assert.ok(await large.evaluate(() => window.isopath.read(290, 290)?.values.distance > 0));
  await large.close();
});

test('nothing was asked of the network, and nothing was complained about', () => {
  assert.deepEqual(requests.filter((url) => !url.startsWith('file:') && !url.startsWith('data:') && !url.startsWith('blob:')), []);
  assert.equal(requests.filter((url) => url.startsWith('file:')).length, 3, 'one file each');
  assert.deepEqual(complaints, []);
});
