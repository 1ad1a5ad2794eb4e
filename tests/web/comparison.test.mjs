// A comparison on the page: numbers against the command line's JSON, intervals and responses as drawn.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { hydrapod, isAccessible, json, near, published, report, responses, still, temporary, withKeptPage, withPage } from './support.mjs';

const hostile = '<img src=x onerror=alert(1)>';

/** What `hydrapod compare` finds, and a report with it. */
function compared(name, ...words) {
  const file = temporary(`${name}.json`);
  hydrapod('compare', ...words, '-o', file);
  return { file, result: JSON.parse(readFileSync(file, 'utf8')), page: () => report(published, '--compare', file) };
}

const machines = compared('machines', published, '--set', 'legs.oil_spring.stiffness=3.4e6 N/m');

const noise = { damping: 0.013, deviation: [2e-8, 2e-8, 1e-8, 3e-8, 3e-8, 2e-8] };
const rigid = (...words) => json('modes', published, '--model', 'rigid', ...words).modes;
const measurements = compared(
  'measurements',
  responses('before.json', rigid(), noise),
  responses('after.json', rigid('--set', 'legs.oil_spring.stiffness=3.4e6 N/m'), noise),
);

/** "5.024 ± 0.012": value and interval end at the same decimal place, and the value is right to its last digit. */
function nearShown(text, expected, what) {
  const [value, half] = text.replaceAll('−', '-').split(' ± ');
  const decimals = (number) => number.split('.')[1]?.length ?? 0;
  if (half !== undefined) assert.equal(decimals(value), decimals(half), `${what}: ${text}`);
  near(Number(value), expected, 0.51 * 10 ** -decimals(value), what);
}

const rowsOf = (page) =>
  page.locator('#comparison .side-by-side tbody tr').evaluateAll((rows) =>
    rows.map((row) => {
      const [lane] = row.querySelectorAll('.lane');
      const [interval, mark] = ['interval', 'difference'].map((kind) => lane.querySelector(`.${kind}`));
      return {
        cells: [...row.querySelectorAll('th, td')].map((cell) => cell.textContent),
        mark: Number.parseFloat(mark.style.left),
        interval: [interval.style.left, interval.style.width].map(Number.parseFloat),
      };
    }),
  );

test('matched modes, MAC, differences with uncertainty and significance are those of hydrapod compare', async () => {
  for (const { result, page: make } of [machines, measurements])
    await withKeptPage(make(), still, async (page) => {
      const [one] = result.comparisons;
      const [a, b] = [result.things[0].modes, result.things[1].modes];
      const rows = await rowsOf(page);
      assert.equal(rows.length, one.pairs.length);
      assert.ok(rows.length >= 6);
      one.pairs.forEach((pair, k) => {
        const { cells, mark, interval } = rows[k];
        const mode = a[pair.first - 1];
        assert.equal(cells[0], String(pair.first));
        assert.equal(cells[1], String(pair.second));
        nearShown(cells[2], mode.frequency_hz, 'A, Hz');
        nearShown(cells[3], b[pair.second - 1].frequency_hz, 'B, Hz');
        near(Number(cells[4]), pair.mac, 6e-3, 'MAC');
        const percent = (100 * pair.omega_rad_s.difference) / mode.omega_rad_s;
        nearShown(cells[5], percent, 'difference');
        const { deviation, verdict } = pair.omega_rad_s;
        if (deviation === null) assert.ok(!cells[5].includes('±'));
        else {
          const half = (1.96 * 100 * deviation) / mode.omega_rad_s;
          near(Number(cells[5].split('± ')[1]), half, 0.06 * half, 'half the interval');
          near(interval[0] + interval[1] / 2, mark, 0.02, 'the mark in its interval');
        }
        assert.equal(cells[7], verdict.replace('_', ' '));
        assert.equal(cells[10], pair.damping_ratio.verdict.replace('_', ' '));
        assert.equal(mark < 50, percent < 0, 'left of zero where B is lower');
      });
      const text = await page.locator('#comparison').textContent();
      assert.ok(text.includes(one.shapes));
      for (const thing of result.things) assert.ok(text.includes(thing.description));
    });
});

test('the verdict is the last line of hydrapod compare', async () => {
  const words = hydrapod('compare', published, '--set', 'legs.oil_spring.stiffness=3.4e6 N/m').trim().split('\n').at(-1);
  await withKeptPage(machines.page(), still, async (page) => {
    assert.equal(await page.locator('#comparison .findings li').textContent(), words);
  });
});

test('of calculated values no difference was tested, and both say so', async () => {
  const equal = compared('equal', published, '--set', 'legs.oil_spring.damping=1 N s/m');
  for (const { page: make } of [machines, equal])
    await withKeptPage(make(), still, async (page) => {
      assert.match(await page.locator('#comparison .findings li').textContent(), /no difference was tested, because no measurement uncertainty is known/);
      assert.match(await page.locator('#comparison').textContent(), /No difference was tested for significance\./);
    });
  await withKeptPage(equal.page(), still, async (page) => {
    const head = await page.locator('#comparison .side-by-side .lane-head').first().textContent();
    assert.equal(head, 'no difference', 'the frequencies are equal');
  });
  await withKeptPage(measurements.page(), still, async (page) => {
    assert.doesNotMatch(await page.locator('#comparison').textContent(), /was tested/);
  });
});

test('softer oil makes measured frequencies differ significantly', () => {
  const verdicts = measurements.result.comparisons[0].pairs.map((pair) => pair.omega_rad_s.verdict);
  assert.ok(verdicts.every((verdict) => verdict === 'significant'), verdicts.join());
});

test('Bode diagrams lie one over the other, line by line those of the JSON', async () => {
  for (const { result, page: make } of [machines, measurements])
    await withKeptPage(make(), still, async (page) => {
      const names = await page.locator('[data-control="compared-response"] option').allTextContents();
      assert.ok(names.length >= 6);
      await page.selectOption('[data-control="compared-response"]', { index: 2 });
      assert.equal(await page.locator('#comparison .uplot').count(), 2);
      const drawn = await page.evaluate(() => window.hydrapod.comparison.drawn());
      assert.deepEqual(drawn.map(({ thing }) => thing), [0, 1]);
      for (const { thing, frequency_hz, magnitude, phase } of drawn) {
        const response = result.things[thing].responses.find(({ name }) => name === names[2]);
        let lines = 0;
        frequency_hz.forEach((f, k) => {
          if (magnitude[k] === null) return;
          const at = response.frequency_hz.findIndex((g) => Math.abs(g - f) < 1e-5 * f);
          const [re, im] = [response.re[at], response.im[at]];
          near(magnitude[k], Math.hypot(re, im), 1e-5 * Math.hypot(re, im), `magnitude at ${f} Hz`);
          if (typeof phase[k] !== 'number') return; // on both sides of the cut
          near(Math.cos((Math.PI * phase[k]) / 180), re / Math.hypot(re, im), 1e-4, `phase at ${f} Hz`);
          ++lines;
        });
        assert.ok(lines > 200, `${lines} lines`);
        const steps = phase.slice(1).map((value, k) => Math.abs(value - phase[k])).filter(Number.isFinite);
        assert.ok(Math.max(...steps) < 136, `a line over ${Math.max(...steps)}°`);
      }
    });
});

test('modes without a partner are named', async () => {
  const { result, page: make } = compared('partial', published, responses('few.json', rigid().slice(0, 4), noise));
  const [one] = result.comparisons;
  assert.ok(one.first_left.length > 0);
  await withPage(make(), still, async (page) => {
    const text = await page.locator('#comparison').textContent();
    for (const number of one.first_left) assert.ok(text.includes(`Only in A: mode ${number},`), `mode ${number}`);
  });
});

test('names are text, whatever they hold', async () => {
  const document = structuredClone(machines.result);
  document.things[1].name = document.things[1].modes[0].label = hostile;
  const file = temporary('hostile-comparison.json');
  writeFileSync(file, JSON.stringify(document));
  await withPage(report(published, '--compare', file), still, async (page) => {
    assert.equal(await page.locator('#comparison img').count(), 0);
    assert.ok((await page.locator('#comparison').textContent()).includes(hostile));
  });
});

test('a file that is no comparison is refused by name', () => {
  const file = temporary('modes.json');
  hydrapod('modes', published, '-o', file);
  const refused = (text) => {
    const broken = temporary('broken.json');
    writeFileSync(broken, text);
    const { status, stderr } = spawnSync(process.env.HYDRAPOD_PROGRAM, ['report', published, '--compare', broken, '-o', temporary('never.html')], { encoding: 'utf8' });
    assert.notEqual(status, 0);
    assert.match(stderr, /broken\.json/);
  };
  refused(readFileSync(file, 'utf8'));
  refused('{"kind": "comparison", "things": []}');
  refused('not JSON');
});

for (const [name, options] of [['wide', {}], ['on a phone', { viewport: { width: 360, height: 740 } }]])
  test(`no finding of axe, nothing overflows, tables go by keyboard: ${name}`, async () => {
    await withKeptPage(measurements.page(), { ...still, ...options }, async (page) => {
      await isAccessible(page);
      await page.locator('#comparison .scroller').first().focus();
      assert.ok(await page.evaluate(() => document.activeElement.classList.contains('scroller')));
    });
  });
