// Bundles the viewer: node build.mjs [FOLDER], web/dist unless told otherwise.
import { copyFile, mkdir } from 'node:fs/promises';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const source = join(dirname(fileURLToPath(import.meta.url)), 'src');
const target = resolve(process.argv[2] ?? join(source, '../dist'));

await mkdir(target, { recursive: true });
await build({
  entryPoints: { viewer: join(source, 'main.js') },
  outdir: target,
  bundle: true,
  format: 'iife',
  minify: true,
  charset: 'ascii',
  target: 'es2020',
  legalComments: 'eof',
  logLevel: 'warning',
});
await build({ entryPoints: [join(source, 'viewer.css')], outdir: target, minify: true, logLevel: 'warning' });
await copyFile(join(source, 'report.html'), join(target, 'report.html'));
