// The diagnosis: numbers against the command line's JSON, the mode of the identified cause in motion, the stiffness.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { test } from 'node:test';
import {
  findings,
  json,
  model,
  near,
  report,
  still,
  temporary,
  withKeptPage,
  withPage,
} from './support.mjs';

const heavy = model('heavy-platform.toml');
const stiff = ['--set', 'legs.guide_sleeve.stiffness=20 kN/mm'];

/** What the soft machine shows, as a list of modes. */
function measured() {
  const path = temporary('measured.csv');
  const felt = json('modes', heavy).modes.filter(
    (mode) => mode.platform_energy.reduce((a, b) => a + b, 0) > 0.004,
  );
  const rows = felt.map((mode) =>
    [mode.frequency_hz, 1e-3 * mode.frequency_hz, ...(mode.shape.re ?? mode.shape).slice(0, 6)].join(),
  );
  writeFileSync(path, ['frequency [Hz],deviation [Hz],x,y,z,rx,ry,rz', ...rows].join('\n') + '\n');
  return path;
}

const modes = measured();
const page_ = report(heavy, ...stiff, '--diagnose', modes);

test('the header and the facts say which machine the page shows', async () => {
  const state = /best hypothesis of the diagnosis: .*guide sleeve/;
  await withKeptPage(page_, still, async (page) => {
    assert.match(await page.locator('header.top').textContent(), state);
    assert.match(await page.locator('#about').textContent(), state);
  });
});

test('no finding of axe', async () => {
  await withKeptPage(page_, still, async (page) => {
    assert.deepEqual(await findings(page), []);
  });
});

test('the section says what hydrapod diagnose says', async () => {
  const expected = json('diagnose', heavy, ...stiff, '--measured', modes);
  await withKeptPage(page_, still, async (page) => {
    const shown = await page.evaluate(() => window.hydrapod.report.diagnosis);
    assert.deepEqual(shown.summary, expected.summary);
    assert.equal(shown.finding, 'cause identified');
    near(shown.hypotheses[0].parameters[0].value, 0.84e6, 2e3, 'stiffness');
    const lines = await page.locator('#diagnosis .findings li').allTextContents();
    assert.deepEqual(lines, expected.summary);
    assert.equal(
      await page.locator('#diagnosis table.diagnosed tbody tr').count(),
      expected.measured_modes.length,
    );
    const ranked = await page.locator('#diagnosis .ranking li strong').allTextContents();
    assert.equal(ranked[0], 'guide sleeves of all legs');
    assert.ok(ranked.includes('rigid-leg model'));
    const widths = await page
      .locator('#diagnosis .ranking .bar')
      .evaluateAll((bars) => bars.map((bar) => bar.getBoundingClientRect().width));
    const worse = expected.hypotheses.slice(0, 12).map((e) => e.bic_above_best);
    worse.slice(1).forEach((value, k) => {
      if (value > worse[k] * 1.05) assert.ok(widths[k + 1] > widths[k], `bar ${k + 1}`);
    });
  });
});

test("the present and the required stiffness stand on the curve", async () => {
  await withKeptPage(page_, still, async (page) => {
    const { remedy } = await page.evaluate(() => window.hydrapod.report.diagnosis);
    const at = async (mark) => {
      const circle = page.locator(`#diagnosis [data-mark="${mark}"]`);
      return [Number(await circle.getAttribute('cx')), Number(await circle.getAttribute('cy'))];
    };
    const [present, required] = [await at('present'), await at('required')];
    // one decade is as wide everywhere: from the labels of the axis
    const ticks = await page.locator('#diagnosis .stiffness text[text-anchor="middle"]').evaluateAll((all) =>
      all
        .filter((t) => /^1e\d+$/.test(t.textContent))
        .map((t) => [Number(t.textContent.slice(2)), Number(t.getAttribute('x'))]),
    );
    const decade = (ticks.at(-1)[1] - ticks[0][1]) / (ticks.at(-1)[0] - ticks[0][0]);
    near(required[0] - present[0], decade * Math.log10(remedy.required.factor), 0.05, 'distance');
    assert.ok(required[1] > present[1], 'a smaller drop lies lower');
  });
});

test('the page opens in the mode of the identified cause, and a measured mode can be chosen', async () => {
  await withKeptPage(page_, still, async (page) => {
    const { report: document } = await page.evaluate(() => ({ report: window.hydrapod.report }));
    const first = document.modes_to_picture?.[0] ?? document.pictured?.[0];
    const buttons = page.locator('[data-control="show-mode"]');
    const count = await buttons.count();
    assert.equal(count, document.diagnosis.measured_modes.length);
    await buttons.nth(count - 1).click();
    const drawn = await page.evaluate(() => {
      window.hydrapod.scene.setPhase(0);
      return window.hydrapod.scene.jointPositions(1);
    });
    await buttons.nth(0).click();
    const other = await page.evaluate(() => {
      window.hydrapod.scene.setPhase(0);
      return window.hydrapod.scene.jointPositions(1);
    });
    assert.ok(
      Math.hypot(...drawn.joint.map((v, i) => v - other.joint[i])) > 1e-3,
      'another mode moves the joint elsewhere',
    );
    assert.ok(first === undefined || first > 0);
  });
});

test('no section without a diagnosis', async () => {
  await withPage(report(heavy), still, async (page) => {
    assert.equal(await page.locator('#diagnosis').count(), 0);
  });
});
