// The pictures of the report in docs/pictures, or, to be looked at, all kinds of reports at all sizes:
//
//     node web/screenshots.mjs PROGRAM FOLDER
//     node web/screenshots.mjs PROGRAM FOLDER --all OUTPUT_FOLDER
//
// PROGRAM: hydrapod, built; FOLDER: the one with node_modules (build/<preset>/web of a build with
// tests). Chromium is looked for at /usr/bin/chromium, or where CHROMIUM says.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, rmSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const [program, modules] = process.argv.slice(2, 4).map((path) => resolve(path));
const all = process.argv[4] === '--all' ? process.argv[5] : undefined;
if (!modules || (process.argv[4] && !all))
  throw new Error('usage: node web/screenshots.mjs PROGRAM FOLDER_WITH_NODE_MODULES [--all OUTPUT_FOLDER]');
const root = join(dirname(fileURLToPath(import.meta.url)), '..');
const { chromium } = createRequire(join(modules, 'package.json'))('playwright-core');

const pictures = [
  { name: 'published', model: 'zhang-jiang-2021.toml', words: [], mode: 1, amplitude: 14 },
  { name: 'heavy', model: 'heavy-platform.toml', words: [], mode: 1, amplitude: 20 },
];

/** Kinds of reports with all sections and their combinations; `record` and `comparison` are made by the program. */
const kinds = (record, comparison) => [
  { name: 'model', words: ['models/heavy-platform.toml', '--pose', 'neutral', '--pose', 'low'] },
  { name: 'motion', words: ['models/zhang-jiang-2021.toml', '--command', 'step z=5 mm', '--until', '1.5'] },
  { name: 'measured', words: ['models/zhang-jiang-2021.toml', '--measured', record] },
  { name: 'diagnosed', words: ['models/zhang-jiang-2021.toml', '--diagnose', record] },
  { name: 'compared', words: ['models/zhang-jiang-2021.toml', '--compare', comparison] },
  { name: 'everything', words: ['models/zhang-jiang-2021.toml', '--command', 'step z=5 mm', '--measured', record, '--diagnose', record, '--compare', comparison] },
];
const widths = [360, 768, 1400, 2560, 3840];
/** Chromium repeats the top of pictures that are much taller [px]. */
const most = 4000;

/** Sections that calculate have done so. */
const calculated = (page) =>
  page.evaluate(async () => {
    const { bode, whatIf, workspace, scatter } = window.hydrapod;
    for (const part of [bode, whatIf, workspace, scatter]) await part?.ready;
    await workspace?.complete();
    await scatter?.complete();
  });

async function takeAll(output) {
  mkdirSync(output, { recursive: true });
  const run = (...words) => execFileSync(program, words, { cwd: root, stdio: 'ignore' });
  const record = join(folder, 'run.h5');
  run('rig', 'models/zhang-jiang-2021.toml', '--entry', 'wrench', '--excite', 'noise all=200, to=60', '--duration', '60 s', '-o', record);
  const comparison = join(folder, 'comparison.json');
  run('compare', 'models/zhang-jiang-2021.toml', record, '-o', comparison);
  for (const { name, words } of kinds(record, comparison)) {
    const report = join(folder, `${name}.html`);
    run('report', ...words, '-o', report);
    for (const width of widths)
      for (const colorScheme of ['light', 'dark']) {
        const page = await browser.newPage({ viewport: { width, height: most }, colorScheme, reducedMotion: 'reduce' });
        await page.goto(pathToFileURL(report).href);
        await calculated(page);
        await page.waitForTimeout(500); // fonts and the last frame
        const tall = await page.evaluate(() => document.documentElement.scrollHeight);
        for (let k = 0; k * most < tall; ++k) {
          await page.evaluate((y) => scrollTo({ top: y, behavior: 'instant' }), k * most);
          await page.waitForTimeout(200);
          await page.screenshot({ path: join(output, `${name}-${width}-${colorScheme}-${k + 1}.png`) });
        }
        if (width === 1400 && colorScheme === 'light') await page.pdf({ path: join(output, `${name}.pdf`), format: 'A4' });
        await page.close();
      }
    console.log(`${name}: pictures of ${widths.length} widths, light and dark, and a PDF in ${output}`);
  }
}

const folder = mkdtempSync(join(tmpdir(), 'hydrapod-pictures-'));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: [
    '--no-sandbox',
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
    '--no-first-run',
  ],
});
try {
  if (all) await takeAll(resolve(all));
  for (const { name, model, words, mode, amplitude } of all ? [] : pictures) {
    const machine = join('models', model);
    if (!existsSync(join(root, machine))) continue;
    const report = join(folder, `${name}.html`);
    execFileSync(program, ['report', machine, '--theme', 'light', '-o', report, ...words], {
      cwd: root,
    });
    const page = await browser.newPage({ viewport: { width: 1400, height: 1000 } });
    await page.goto(pathToFileURL(report).href);
    await page.waitForFunction(() => window.hydrapod.scene.frames() > 0);
    await calculated(page);
    await page.locator('[data-control="amplitude"]').fill(String(amplitude));
    await page.evaluate((number) => {
      document.activeElement.blur();
      window.hydrapod.state.chooseMode(number);
      window.hydrapod.scene.setPhase(0);
    }, mode);
    await page.waitForTimeout(1000); // fonts and the last frame
    const picture = join(root, 'docs', 'pictures', `report-${name}.png`);
    const { y, height } = await page.locator('#bode').boundingBox();
    await page.screenshot({
      path: picture,
      fullPage: true,
      clip: { x: 0, y: 0, width: 1400, height: y + height + 14 },
    });
    console.log(`${picture}: ${Math.round(statSync(picture).size / 1000)} kB`);
    await page.close();
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
