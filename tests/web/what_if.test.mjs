// The page that calculates: its core gives the numbers of the command line with the same `--set`.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import {
  damped,
  findings,
  json,
  model,
  near,
  published,
  random,
  report,
  still,
  withKeptPage,
  withPage,
} from './support.mjs';

const { HYDRAPOD_PROGRAM } = process.env;
const two_pi = 2 * Math.PI;

const overrides = (set) => set.flatMap(([path, value]) => ['--set', `${path}=${value}`]);

/** As the page would write them: arrays as a whole. */
const overridesOf = async (page, set) => {
  const texts = await page.evaluate((set) => window.hydrapod.whatIf.overrides(set), set);
  return texts.flatMap((text) => ['--set', text]);
};

/** The program's JSON, or what it said instead. */
function asked(words) {
  const { stdout, stderr } = spawnSync(HYDRAPOD_PROGRAM, [...words, '--format', 'json'], {
    encoding: 'utf8',
    maxBuffer: 1 << 28,
  });
  return stdout.startsWith('{') ? JSON.parse(stdout) : stderr;
}

const compute = (page, set, omega) =>
  page.evaluate(
    async ([set, omega]) => {
      await window.hydrapod.whatIf.ready;
      const result = await window.hydrapod.whatIf.compute(set, omega && Float64Array.from(omega));
      return { ...result, responses: result.responses && [...result.responses] };
    },
    [set, omega],
  );

/** Of the larger of the two, and of 1 for shares. */
const limit = 1e-12;
const close = (actual, expected, scale, what) =>
  near(actual, expected, limit * Math.max(Math.abs(expected), scale), what);

/** Modes closer than this share of their frequency are judged together, see energyLimit. */
const together = 1e-3;

/** Sums over modes that stand together, by the frequencies of `expected`. */
function perCluster(expected, modes, value) {
  const sums = [];
  expected.forEach(({ omega_rad_s: omega }, k) => {
    const apart = k === 0 || omega - expected[k - 1].omega_rad_s > together * omega;
    if (apart) sums.push(0);
    sums[sums.length - 1] += value(modes[k]);
  });
  return sums;
}

function sameModes(actual, expected, what) {
  assert.equal(actual.length, expected.length, what);
  const shares = (mode) => [
    ...mode.platform_energy,
    ...mode.leg_energy,
    mode.strain_energy.oil,
    mode.strain_energy.guide_sleeve,
    mode.strain_energy.piston_ring,
  ];
  expected.forEach((mode, k) => {
    close(actual[k].omega_rad_s, mode.omega_rad_s, 0, `${what}: frequency of mode ${k + 1}`);
    near(actual[k].damping_ratio, mode.damping_ratio, limit, `${what}: damping of mode ${k + 1}`);
    assert.equal(actual[k].stable, mode.stable);
  });
  const most = expected.some((mode) => mode.shape_imaginary) ? complexEnergyLimit : energyLimit;
  for (let part = 0; part < 15; ++part) {
    const of = (modes) => perCluster(expected, modes, (mode) => shares(mode)[part]);
    const [mine, theirs] = [of(actual), of(expected)];
    theirs.forEach((sum, k) => near(mine[k], sum, most, `${what}: energy ${part} of cluster ${k}`));
  }
}

/**
 * Shapes are good to the limit over the distance of their modes, as a share of the frequency. Complex ones
 * come from [0 I; −Ω² −Γ], whose rounding is that of its norm, about 1e7 times the distance of two seal
 * modes here.
 */
const energyLimit = limit / together;
const complexEnergyLimit = 100 * energyLimit;

/** One to three random numbers of the machine, changed by up to a fifth. */
function draws(paths, values, count, seed) {
  const next = random(seed);
  const list = [];
  while (list.length < count) {
    const set = new Map();
    const many = 1 + Math.floor(3 * next());
    while (set.size < many) {
      const path = paths[Math.floor(next() * paths.length)];
      if (values[path] !== 0) set.set(path, values[path] * (0.8 + 0.4 * next()));
    }
    list.push([...set]);
  }
  return list;
}

const machines = [
  { name: 'published', words: [published], count: 20 },
  { name: 'damped, 30 modes', words: damped, count: 20 },
  { name: 'heavy', words: [model('heavy-platform.toml')], count: 20 },
];

for (const { name, words, count } of machines)
  test(`random values: the numbers of the command line, ${name}`, async () => {
    await withKeptPage(report(...words), still, async (page) => {
      const values = await page.evaluate(async () => {
        await window.hydrapod.whatIf.ready;
        return window.hydrapod.whatIf.values();
      });
      const paths = Object.keys(values).filter((path) => !/^(controller|sensors|supply)/.test(path));
      assert.ok(paths.length > 100);
      const kind = await page.evaluate(() => window.hydrapod.report.editable.model);
      let computed = 0;
      for (const set of draws(paths, values, count, 24)) {
        const what = set.map(([path, value]) => `${path}=${value}`).join(' ');
        const mine = await compute(page, set);
        const theirs = asked([
          'modes',
          ...words,
          '--model',
          kind,
          ...(await overridesOf(page, set)),
        ]);
        const errors = mine.findings.filter((finding) => finding.error);
        if (typeof theirs === 'string') {
          assert.ok(errors.length > 0 || mine.problem, `${what}: refused by the program: ${theirs}`);
          for (const { message } of errors) assert.ok(theirs.includes(message), `${message} in ${theirs}`);
          continue;
        }
        assert.deepEqual(errors, [], `${what}: computed by the program`);
        sameModes(mine.pose.modes, theirs.modes, what);
        sameModes(mine.pose.rigid_modes, theirs.rigid_modes, `${what}, rigid`);
        ++computed;
      }
      assert.ok(computed >= count / 2, `${computed} of ${count} can be computed`);
    });
  });

test('responses are those of the command line', async () => {
  await withKeptPage(report(...damped), still, async (page) => {
    const set = [
      ['legs.guide_sleeve.stiffness', 2.31e5],
      ['platform.mass', 917.3],
    ];
    const theirs = asked(['bode', ...damped, ...overrides(set), '--from', '4', '--to', '40', '--points', '53']);
    const mine = await compute(page, set, theirs.omega_rad_s);
    assert.equal(mine.responses.length, 144 * 53);
    const names = ['x', 'y', 'z', 'rx', 'ry', 'rz'];
    [theirs.response, theirs.rigid_response].forEach((response, side) => {
      for (let line = 0; line < 53; ++line) {
        const scale = (o, i) =>
          Math.hypot(response[names[o]][names[i]].re[line], response[names[o]][names[i]].im[line]);
        for (let o = 0; o < 6; ++o)
          for (let i = 0; i < 6; ++i) {
            const at = side * 72 * 53 + 72 * line + 2 * (6 * o + i);
            const { re, im } = response[names[o]][names[i]];
            // uncoupled directions hold rounding of the coupled ones
            const size = Math.sqrt(scale(o, o) * scale(i, i));
            near(mine.responses[at], re[line], limit * size, `re ${o} ${i} line ${line}`);
            near(mine.responses[at + 1], im[line], limit * size, `im ${o} ${i} line ${line}`);
          }
      }
    });
  });
});

test('without a change the core computes the machine of the report', async () => {
  await withKeptPage(report(published), still, async (page) => {
    const { pose } = await compute(page, []);
    const stated = await page.evaluate(() => window.hydrapod.report.poses[0]);
    sameModes(pose.modes, stated.modes, 'no change');
    assert.deepEqual(pose.coordinates, stated.coordinates);
    assert.deepEqual(pose.pose, stated.pose);
  });
});

test('a slider changes the whole page; undo, redo, reset, address', async () => {
  const file = report(published);
  await withPage(file, still, async (page) => {
    await page.evaluate(() => window.hydrapod.whatIf.ready);
    const slider = page.locator('[data-slider="platform.mass"]');
    const answer = () => page.locator('#answer').innerText();
    const before = await answer();
    await slider.fill('700');
    await page.evaluate(() => window.hydrapod.whatIf.shown());
    const [[path, value]] = await page.evaluate(() => window.hydrapod.whatIf.changed());
    assert.equal(path, 'platform.mass');
    near(value, 894 / 10 * 100 ** 0.7, 1e-9, 'logarithmic from a tenth to ten times');
    const theirs = asked(['modes', published, '--set', `platform.mass=${value}`]);
    const shown = await page.evaluate(() => window.hydrapod.state.pose.modes[0].omega_rad_s);
    close(shown, theirs.modes[0].omega_rad_s, 0, 'mode 1');
    assert.ok((await answer()).includes(`${(shown / two_pi).toFixed(3)} Hz`));
    assert.match(await answer(), /changed values below, not the machine of this report/);
    const command = await page.evaluate(() => window.hydrapod.whatIf.command());
    assert.ok(command.endsWith(`--set platform.mass=${value}`), command);
    const hash = await page.evaluate(() => location.hash);
    assert.equal(decodeURIComponent(hash), `#set=platform.mass=${value}`);

    await page.keyboard.press('Control+z');
    await page.evaluate(() => window.hydrapod.whatIf.shown());
    assert.equal(await answer(), before);
    assert.deepEqual(await page.evaluate(() => window.hydrapod.whatIf.changed()), []);
    assert.equal(await page.evaluate(() => location.hash), '');
    await page.keyboard.press('Control+Shift+z');
    await page.evaluate(() => window.hydrapod.whatIf.shown());
    assert.deepEqual(await page.evaluate(() => window.hydrapod.whatIf.changed()), [[path, value]]);

    // a drag is one step of undo, however many values it has on its way
    await page.evaluate(() => {
      const { whatIf } = window.hydrapod;
      for (let k = 0; k < 9; ++k) whatIf.drag('legs.rod.mass', 2 + 0.1 * k);
      whatIf.keep();
    });
    await page.locator('[data-control="undo"]').click();
    assert.deepEqual(await page.evaluate(() => window.hydrapod.whatIf.changed()), [[path, value]]);
    await page.locator('[data-control="reset-all"]').click();
    await page.evaluate(() => window.hydrapod.whatIf.shown());
    assert.equal(await answer(), before);

    // the address leads to the same machine
    await page.evaluate((fragment) => (location.hash = fragment), hash);
    await page.waitForFunction(() => window.hydrapod.whatIf.changed().length === 1);
    await page.evaluate(() => window.hydrapod.whatIf.shown());
    assert.equal(
      await page.evaluate(() => window.hydrapod.state.pose.modes[0].omega_rad_s),
      shown,
    );
  });
});

test('a value is typed with a unit; an unknown one and an impossible one are refused in words', async () => {
  await withKeptPage(report(published), still, async (page) => {
    await page.evaluate(() => window.hydrapod.whatIf.ready);
    await page.locator('[data-control="parameter-search"]').fill('guide sleeve stiffness');
    const field = page.locator('[data-field="legs.guide_sleeve.stiffness"]');
    const row = page.locator('[data-parameter="legs.guide_sleeve.stiffness"]');
    await field.fill('0.25 kN/mm');
    await field.press('Enter');
    const changed = () => page.evaluate(() => window.hydrapod.whatIf.shown().then(() => window.hydrapod.whatIf.changed()));
    assert.deepEqual(await changed(), [['legs.guide_sleeve.stiffness', 250000]]);
    await field.fill('3 furlong');
    await field.press('Enter');
    assert.match(await row.innerText(), /unknown unit “furlong”; accepted: .*N\/mm/);
    assert.equal(await field.getAttribute('aria-invalid'), 'true');
    await field.fill('stiff');
    await field.press('Enter');
    assert.match(await row.innerText(), /“stiff” is not a number/);
    await field.fill('-1');
    await field.press('Enter');
    assert.deepEqual(await changed(), [['legs.guide_sleeve.stiffness', 250000]], 'the machine stays as it was');
    const said = asked(['modes', published, '--set', 'legs.guide_sleeve.stiffness=-1']);
    const { findings } = await compute(page, [['legs.guide_sleeve.stiffness', -1]]);
    assert.ok(said.includes(findings[0].message), `${findings[0].message} in ${said}`);
    assert.ok((await row.innerText()).includes(findings[0].message));
    assert.equal(await field.getAttribute('aria-invalid'), 'true');
    // what was refused is no step: one undo leads to the machine of the report, one redo back
    await page.locator('[data-control="undo"]').click();
    assert.deepEqual(await changed(), []);
    assert.ok(await page.locator('[data-control="undo"]').isDisabled());
    await page.locator('[data-control="redo"]').click();
    assert.deepEqual(await changed(), [['legs.guide_sleeve.stiffness', 250000]]);
    assert.ok(await page.locator('[data-control="redo"]').isDisabled());
    // an address may hold such a value
    await page.evaluate(() => window.hydrapod.whatIf.replace([['legs.guide_sleeve.stiffness', -1]]));
    await page.evaluate(() => window.hydrapod.whatIf.shown());
    assert.match(await page.locator('.what-if-state').innerText(), /^Not computed: legs\.guide_sleeve\.stiffness/);
    assert.match(await page.locator('.what-if-results').innerText(), /–/, 'no numbers of such a machine');
    await page.locator('[data-control="reset-all"]').click();
    await page.locator('[data-control="parameter-search"]').fill('');
  });
});

test('the page holds what it needs: no request, scripts of its own alone, at most 2 MB', async () => {
  const file = report(published);
  const text = readFileSync(file, 'utf8');
  assert.ok(Buffer.byteLength(text) <= 2e6, `${Buffer.byteLength(text)} bytes`);
  assert.ok(text.includes('#define LAMBERT') && !/#define (STANDARD|PHONG|TOON)/.test(text), 'shaders of its materials');
  const policy = /http-equiv="Content-Security-Policy" content="([^"]*)"/.exec(text)[1];
  assert.match(policy, /default-src 'none'/);
  assert.match(policy, /worker-src blob:/);
  assert.match(policy, /script-src 'sha256-[^']+' 'wasm-unsafe-eval'/);
  assert.ok(!policy.includes("'unsafe-eval'") && !policy.includes('unsafe-inline'));
  await withKeptPage(file, still, async (page) => {
    await page.evaluate(() => window.hydrapod.whatIf.ready.then(() => window.hydrapod.whatIf.shown()));
    assert.equal(await page.evaluate(() => location.href), pathToFileURL(file).href);
    assert.deepEqual(await findings(page), [], 'axe finds nothing');
  });
});

test('a displaced pose moves with the neutral one, as on the command line', async () => {
  const pose = 'z=20 mm, ry=4 deg';
  await withPage(report(published, '--pose', pose), still, async (page) => {
    const set = [['poses.neutral.position[2]', 0.79]];
    const mine = await compute(page, set);
    const theirs = json('modes', published, '--pose', pose, ...overrides(set));
    sameModes(mine.pose.modes, theirs.modes, pose);
  });
});

test('of a machine whose legs buckle there are no frequencies, and the load that must come off', async () => {
  await withKeptPage(report(model('heavy-platform.toml')), still, async (page) => {
    await page.evaluate(async () => {
      const { whatIf } = window.hydrapod;
      await whatIf.ready;
      whatIf.drag('legs.guide_sleeve.stiffness', 6e5);
      whatIf.keep();
      await whatIf.shown();
    });
    const { poses } = asked([
      'check',
      model('heavy-platform.toml'),
      '--set',
      'legs.guide_sleeve.stiffness=6e5',
    ]);
    const { payload_kg: payload } = poses[0].buckling;
    assert.ok(payload < 0, `${payload} kg: it buckles`);
    const words = await page.locator('.what-if-outcome').innerText();
    assert.ok(words.includes(`B: buckled: ${(-payload).toFixed(0)} kg must come off`), words);
    assert.match(words, /unstable\s+–/);
    assert.equal(await page.locator('.curve-now').count(), 0);
    assert.equal(await page.locator('.curve-before').count(), 1);
    await page.evaluate(() => {
      window.hydrapod.whatIf.replace([]);
      return window.hydrapod.whatIf.shown();
    });
  });
});

test('A and B are exchanged with their poses', async () => {
  await withKeptPage(report(model('heavy-platform.toml')), still, async (page) => {
    await page.evaluate(async () => {
      const { whatIf, workspace } = window.hydrapod;
      await whatIf.ready;
      workspace.displace([0, 0, -0.1, 0, 0, 0]);
      await whatIf.shown();
    });
    const words = () => page.locator('.what-if-results tbody tr').evaluateAll((rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
    const swap = async () => {
      await page.locator('[data-control="swap"]').click();
      await page.evaluate(() => window.hydrapod.whatIf.shown());
    };
    const [first, displaced] = [await words(), await page.evaluate(() => window.hydrapod.state.displaced)];
    await swap();
    assert.equal(await page.evaluate(() => window.hydrapod.state.displaced), null);
    const swapped = await words();
    // Hz with flexible legs of B and of A, by direction
    const hertz = (rows, column) => Object.fromEntries(rows.map((row) => [row[0], row[column]]));
    assert.deepEqual(hertz(swapped, 2), hertz(first, 5));
    assert.deepEqual(hertz(swapped, 5), hertz(first, 2));
    assert.notDeepEqual(hertz(swapped, 2), hertz(swapped, 5));
    await swap();
    assert.deepEqual(await page.evaluate(() => window.hydrapod.state.displaced), displaced);
    assert.deepEqual(await words(), first);
    await page.evaluate(() => {
      window.hydrapod.workspace.displace(null);
      return window.hydrapod.whatIf.shown();
    });
  });
});

for (const [locale, text, value] of [
  ['de-DE', '0,9 t', 900],
  ['de-DE', '0.9 t', 900],
  ['de-DE', '1.234,5', null],
  ['en-US', '0,9 t', null],
  ['en-US', '1,234', null],
])
  test(`a field with “${text}” in ${locale}: ${value ?? 'refused'}`, async () => {
    await withKeptPage(report(published), { ...still, locale }, async (page) => {
      await page.evaluate(async () => {
        await window.hydrapod.whatIf.ready;
        window.hydrapod.whatIf.replace([]);
      });
      const field = page.locator('[data-field="platform.mass"]');
      await field.fill(text);
      await field.press('Enter');
      await page.evaluate(() => window.hydrapod.whatIf.shown());
      const changed = await page.evaluate(() => window.hydrapod.whatIf.changed());
      assert.deepEqual(changed, value === null ? [] : [['platform.mass', value]]);
      assert.equal(await field.getAttribute('aria-invalid'), String(value === null));
    });
  });
