// What the tests of the pages share: reports made by the program, and a browser to open them in.
//
// Environment, set by CMake: HYDRAPOD_PROGRAM, HYDRAPOD_SOURCE (the repository), HYDRAPOD_WEB (the
// folder with node_modules), HYDRAPOD_CHROMIUM.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { delimiter, dirname, join } from 'node:path';
import { after, before } from 'node:test';
import { pathToFileURL } from 'node:url';

const { HYDRAPOD_PROGRAM, HYDRAPOD_SOURCE, HYDRAPOD_WEB, HYDRAPOD_CHROMIUM } = process.env;
assert.ok(
  HYDRAPOD_PROGRAM && HYDRAPOD_SOURCE && HYDRAPOD_WEB,
  'started by ctest, which says where things are',
);

const require = createRequire(join(HYDRAPOD_WEB, 'package.json'));
const { chromium } = require('playwright-core');
export const moduleText = (name) => readFileSync(require.resolve(name), 'utf8');

/** How long anything may take on a machine with other work to do [ms]. */
const patience = 120000;

const folder = mkdtempSync(join(tmpdir(), 'hydrapod-web-'));
let browser;

before(async () => {
  browser = await chromium.launch({
    executablePath: HYDRAPOD_CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    timeout: patience,
    args: [
      '--no-sandbox',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      // SwiftShader for WebGL only: with all of the page drawn by it, a page costs twice as much
      '--disable-gpu-compositing',
      '--disable-gpu-rasterization',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  });
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

export const model = (name) => join(HYDRAPOD_SOURCE, 'models', name);
export const published = model('zhang-jiang-2021.toml');
export const temporary = (name) => join(folder, name);

// Results of two runs can be compared.
process.env.SOURCE_DATE_EPOCH ??= '1700000001';

/** Runs the program; its standard output. */
export function hydrapod(...words) {
  return execFileSync(HYDRAPOD_PROGRAM, words, {
    encoding: 'utf8',
    maxBuffer: 1 << 28,
    stdio: ['ignore', 'pipe', 'pipe'],
  });
}

export const json = (...words) => JSON.parse(hydrapod(...words, '--format', 'json'));

/** Numbers in (0, 1), the same in every run. */
export function random(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state + 0.5) / 2 ** 32;
  };
}

let runs = 0;
/** Rows of a study by column, of a command as a page shows it, run by a shell; NaN: no value. */
export function rowsOf(command) {
  const place = temporary(`study-${++runs}`);
  mkdirSync(place);
  const { status, stderr } = spawnSync('sh', ['-c', `${command} --csv rows.csv --results rows.h5`], {
    cwd: place,
    encoding: 'utf8',
    env: { ...process.env, PATH: `${dirname(HYDRAPOD_PROGRAM)}${delimiter}${process.env.PATH}` },
  });
  assert.equal(status, 0, stderr);
  const text = readFileSync(join(place, 'rows.csv'), 'utf8').trim();
  const [head, ...lines] = text.split('\n').filter((line) => !line.startsWith('#'));
  const names = head.split(',').map((name) => name.replace(/ \[.*/, ''));
  return lines.map((line) => Object.fromEntries(line.split(',').map((cell, k) => [names[k], cell === '' ? NaN : Number(cell)])));
}

/** What the core of the page has of a row of such a study, in its order (web/core/core.hpp). */
const columns = ['status', 'lowest', 'direction', 'drop', 'x', 'y', 'z', 'rx', 'ry', 'rz', 'drop_x', 'drop_y', 'drop_z', 'drop_rx', 'drop_ry', 'drop_rz', 'stroke',
  'share', 'peak', 'share_x', 'share_y', 'share_z', 'share_rx', 'share_ry', 'share_rz', 'peak_x', 'peak_y', 'peak_z', 'peak_rx', 'peak_ry', 'peak_rz'];

/**
 * A machine that does not stand: rounding decides whether Newton finds no equilibrium (3) or one that is
 * buckled (4).
 */
const one = (value, name) => (name === 'status' && value === 3 ? 4 : value);

export function sameRow(mine, theirs, what) {
  columns.forEach((name, k) => {
    if (!(name in theirs)) return; // the machine has no such output: no stroke, no drop of rigid legs
    const [a, b] = [one(mine[k] ?? NaN, name), one(theirs[name], name)];
    if (Number.isNaN(a) || Number.isNaN(b)) return assert.equal(Number.isNaN(a), Number.isNaN(b), `${name} of ${what}: ${a}, ${b}`);
    // drops are differences of numbers that are nearly equal, strokes of lengths
    near(a, b, 1e-9 * Math.max(1, Math.abs(b)), `${name} of ${what}`);
  });
}

let reports = 0;
const made = new Map();
/** Makes a report, once for the same words, and returns where it is. */
export function report(...words) {
  const key = JSON.stringify(words);
  if (!made.has(key)) {
    const file = temporary(`report-${++reports}.html`);
    hydrapod('report', ...words, '-o', file);
    made.set(key, file);
  }
  return made.get(key);
}

/** A copy of a machine file with other text in it. */
export function changed(file, ...replacements) {
  let text = readFileSync(file, 'utf8');
  for (const [from, to] of replacements) {
    assert.ok(text.includes(from), `${file} has ${from}`);
    text = text.replace(from, () => to);
  }
  const copy = temporary(`machine-${++reports}.toml`);
  writeFileSync(copy, text);
  return copy;
}

/** Normally distributed numbers, the same ones every time. */
function normals(seed) {
  const uniform = random(seed);
  return () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

/**
 * A file of responses to forces and moments, the sum of `modes` with one damping ratio, as a measurement with known
 * noise.
 */
export function responses(name, modes, { damping, deviation, names = {}, more = {} }) {
  const frequency = Array.from({ length: 577 }, (_, k) => 2 + 0.0625 * k);
  const normal = normals(7);
  const shift = more.shift_per_s ?? 0;
  const directions = ['x', 'y', 'z', 'rx', 'ry', 'rz'];
  const response = directions.map((_, o) =>
    directions.map((__, i) => {
      const [re, im] = [[], []];
      for (const f of frequency) {
        const omega = 2 * Math.PI * f;
        let [a, b] = [0, 0];
        for (const mode of modes) {
          const decay = damping * mode.omega_rad_s + shift; // s = shift + iω
          const [p, q] = [
            mode.omega_rad_s ** 2 + (2 * decay - shift) * shift - omega ** 2,
            2 * decay * omega,
          ];
          const weight = (mode.shape[o] * mode.shape[i]) / (p * p + q * q);
          a += weight * p;
          b -= weight * q;
        }
        re.push(a + deviation[o] * Math.SQRT1_2 * normal());
        im.push(b + deviation[o] * Math.SQRT1_2 * normal());
      }
      return { re, im };
    }),
  );
  const zero = frequency.map(() => 0);
  const diagonal = (size) =>
    directions.map((_, o) =>
      directions.map((__, p) => ({ re: frequency.map(() => (o === p ? size(o) : 0)), im: zero })),
    );
  const file = temporary(name);
  writeFileSync(
    file,
    JSON.stringify({
      kind: 'frf',
      inputs: directions.map((d, k) => ({ name: names.inputs?.[k] ?? `F${d}`, unit: k < 3 ? 'N' : 'N m', direction: d })),
      outputs: directions.map((d, k) => ({ name: names.outputs?.[k] ?? d, unit: k < 3 ? 'm' : 'rad', direction: d })),
      estimator: 'h1',
      averages: 40,
      degrees_of_freedom: 34,
      frequency_hz: frequency,
      response,
      noise: diagonal((o) => deviation[o] ** 2),
      input_factor: diagonal(() => 1),
      line_covariance: [1],
      ...more,
    }),
  );
  return file;
}

/** ρ of a Hann window: Σ w_t w_(t + τ)/Σ w². */
export function hannTaper(length) {
  const w = Array.from({ length }, (_, t) => 0.5 - 0.5 * Math.cos((2 * Math.PI * t) / length));
  const square = w.reduce((sum, v) => sum + v * v, 0);
  return w.map((_, lag) => {
    let sum = 0;
    for (let t = 0; t + lag < length; ++t) sum += w[t] * w[t + lag];
    return sum / square;
  });
}

/** For responses(): errors of inputs that are neighbours have a part in common. */
export const correlated = {
  input_factor: [0, 1, 2, 3, 4, 5].map((i) =>
    [0, 1, 2, 3, 4, 5].map((j) => ({
      re: Array(577).fill(i === j ? 1 + 0.1 * i : Math.abs(i - j) === 1 ? 0.35 : 0),
      im: Array(577).fill(Math.abs(i - j) === 1 ? 0.2 * (j - i) : 0),
    })),
  ),
};

/** The published machine with piston rings and dampers: 30 modes, complex. */
export const damped = [
  published,
  '--set',
  'environment.gravity=9.81',
  '--set',
  'legs.piston_ring.stiffness=2e6 N/m',
  '--set',
  'legs.guide_sleeve.damping=60 N s/m',
  '--set',
  'legs.oil_spring.damping=4000 N s/m',
  '--set',
  'damping.modal_ratio=0.003',
];

/** One for all pages with the same options: they share nothing but the disk, and a context takes time. */
const contexts = new Map();
async function contextOf(options) {
  const key = JSON.stringify(options);
  if (!contexts.has(key))
    contexts.set(
      key,
      await browser.newContext({ viewport: { width: 1400, height: 1000 }, ...options }),
    );
  return contexts.get(key);
}

/** Opens a report from disk. What it logs as an error and every request that leaves it are collected. */
export const open = (file, options = {}) => {
  const address = pathToFileURL(file).href;
  return openAt(address, (url) => url === address, options);
};

/**
 * The same of an address; `own` tells which requests the page may make. Of the options, `launch` is a script that runs
 * before those of the page; `expected` matches the errors that the test causes, whenever they come; with `idle` the
 * page also begins by itself what it calculates when it has nothing else to do: a second or more for each page.
 */
export async function openAt(address, own, options = {}) {
  const { launch, expected, idle, ...context } = options;
  const page = await (await contextOf(context)).newPage();
  page.setDefaultTimeout(patience);
  page.problems = [];
  const note = (text) => {
    if (!expected?.test(text)) page.problems.push(text);
  };
  page.on('console', (message) => message.type() === 'error' && note(message.text()));
  page.on('pageerror', (error) => note(String(error)));
  page.on('request', (request) => {
    const url = request.url();
    if (!own(url) && !/^(data|blob):/.test(url)) note(`request to ${url}`);
  });
  if (!idle) await page.addInitScript('window.requestIdleCallback = () => 0;');
  if (launch) await page.addInitScript(launch);
  await page.goto(address);
  await page.waitForFunction(
    () => window.hydrapod?.scene === undefined || window.hydrapod.scene.frames() > 0,
  );
  await page.evaluate(async () => {
    await window.hydrapod?.bode?.ready;
    await window.hydrapod?.identification?.ready;
  });
  return page;
}

export async function close(page) {
  assert.deepEqual(page.problems, [], 'no error on the console, no request');
  await page.close();
}

/** Opens, tests, closes; nothing may have gone wrong on the page. */
export async function withPage(file, options, body) {
  const page = await open(file, options);
  try {
    await body(page);
  } catch (error) {
    if (page.problems.length > 0) error.message += `\non the page: ${page.problems.join('\n')}`;
    await page.close();
    throw error;
  }
  await close(page);
}

/** The pages that withKeptPage left open. */
const kept = new Map();

/**
 * As withPage, on a page that stays open for later tests: to open a page takes longer than most tests. Who
 * changes a page puts it back, or stands last of those on it.
 */
export async function withKeptPage(file, options, body) {
  const key = JSON.stringify([file, options]);
  if (!kept.has(key)) kept.set(key, await open(file, options));
  const page = kept.get(key);
  try {
    await body(page);
    assert.deepEqual(page.problems, [], 'no error on the console, no request');
  } catch (error) {
    if (page.problems.length > 0) error.message += `\non the page: ${page.problems.join('\n')}`;
    kept.delete(key);
    await page.close();
    throw error;
  }
}

/** For tests that are not about the moving machine: it stands still, as somebody may ask of all pages. */
export const still = { reducedMotion: 'reduce' };

/** axe's findings on the page as it stands; `rules`: only those of these. */
export async function findings(page, rules = null) {
  if (!(await page.evaluate(() => window.axe))) await page.evaluate(moduleText('axe-core'));
  const { violations } = await page.evaluate(
    (rules) => window.axe.run(document, { resultTypes: ['violations'], ...(rules ? { runOnly: rules } : {}) }),
    rules,
  );
  return violations.map(
    (v) =>
      `${v.id}: ${v.help}: ${v.nodes
        .map((n) => `${n.target.join(' ')} ${n.html}`)
        .slice(0, 5)
        .join('; ')}`,
  );
}

/**
 * axe's findings in the light and in the dark: what the colours do not change is looked at once. And the page is not
 * wider than its window.
 */
export async function isAccessible(page) {
  await page.emulateMedia({ colorScheme: 'dark' });
  assert.deepEqual(await findings(page, ['color-contrast']), [], 'dark');
  await page.emulateMedia({ colorScheme: 'light' });
  assert.deepEqual(await findings(page), [], 'light');
  assert.ok((await overflow(page)) <= 0, 'nothing overflows');
}

/** By how much the page is wider than its window [px]. */
export const overflow = (page) =>
  page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);

export const near = (actual, expected, tolerance, what) =>
  assert.ok(
    Math.abs(actual - expected) <= tolerance,
    `${what}: ${actual} is not ${expected} within ${tolerance}`,
  );

/** |actual − expected| ≤ tolerance |expected|, of complex numbers. */
export const nearComplex = (actual, expected, tolerance, what) => {
  const distance = Math.hypot(actual.re - expected.re, actual.im - expected.im);
  const size = Math.hypot(expected.re, expected.im);
  assert.ok(distance <= tolerance * size, `${what}: off by ${distance / size}`);
};
