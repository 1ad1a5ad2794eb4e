// The pictures of the report in docs/pictures:
//
//     node web/screenshots.mjs PROGRAM FOLDER
//
// PROGRAM: hydrapod, built; FOLDER: the one with node_modules (build/<preset>/web of a build with
// tests). Chromium is looked for at /usr/bin/chromium, or where CHROMIUM says.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const [program, modules] = process.argv.slice(2).map((path) => resolve(path));
if (!modules) throw new Error('usage: node web/screenshots.mjs PROGRAM FOLDER_WITH_NODE_MODULES');
const root = join(dirname(fileURLToPath(import.meta.url)), '..');
const { chromium } = createRequire(join(modules, 'package.json'))('playwright-core');

const pictures = [
  { name: 'published', model: 'zhang-jiang-2021.toml', words: [], mode: 1, amplitude: 14 },
  { name: 'heavy', model: 'heavy-platform.toml', words: [], mode: 1, amplitude: 20 },
];

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
  for (const { name, model, words, mode, amplitude } of pictures) {
    const machine = join('models', model);
    if (!existsSync(join(root, machine))) continue;
    const report = join(folder, `${name}.html`);
    execFileSync(program, ['report', machine, '--theme', 'light', '-o', report, ...words], {
      cwd: root,
    });
    const page = await browser.newPage({ viewport: { width: 1400, height: 1000 } });
    await page.goto(pathToFileURL(report).href);
    await page.waitForFunction(() => window.hydrapod.scene.frames() > 0);
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
