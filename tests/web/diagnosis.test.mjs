// The diagnosis: numbers against the command line's JSON, the mode of the identified cause in motion, the stiffness.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import {
  findings,
  isAccessible,
  json,
  model,
  near,
  published,
  report,
  responses,
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

test('numbers of hypotheses have the units of the machine file', async () => {
  await withKeptPage(page_, still, async (page) => {
    const note = await page.locator('#diagnosis .ranking li .note').first().textContent();
    assert.match(note, /^legs\.guide_sleeve\.stiffness = 0\.84\d* ± [\d.]+ kN\/mm/);
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
        .filter((t) => /^10[⁰¹²³⁴⁵⁶⁷⁸⁹]+$/.test(t.textContent))
        .map((t) => [
          Number([...t.textContent.slice(2)].map((digit) => '⁰¹²³⁴⁵⁶⁷⁸⁹'.indexOf(digit)).join('')),
          Number(t.getAttribute('x')),
        ]),
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

test('the axial part of the legs has the name of its kind', async () => {
  const text = readFileSync(page_, 'utf8').replaceAll('"strain_energy":{', '"strain_energy":{"axial":"screws",');
  const file = temporary('screws.html');
  writeFileSync(file, text);
  await withPage(file, still, async (page) => {
    const bars = await page.locator('#diagnosis .diagnosed .bar').evaluateAll((all) => all.map((bar) => bar.title));
    const modes = await page.evaluate(() => window.hydrapod.report.diagnosis.measured_modes);
    assert.equal(bars.length, modes.length);
    bars.forEach((words, k) => {
      const { oil, axial, ...others } = modes[k].strain_energy;
      near(oil + Object.values(others).reduce((a, b) => a + b, 0), 1, 1e-9, 'all shares');
      assert.equal(words.includes('screws'), oil >= 0.005, words);
      assert.ok(!words.includes('oil'), words);
    });
  });
});

/** What the table of predictions shows, and where the marks of its lanes stand [%]. */
const predictions = (page) =>
  page.locator('#diagnosis .predictions tbody tr').evaluateAll((rows) =>
    rows.map((row) => {
      const mark = (kind) => Number.parseFloat(row.querySelector(`.lane .${kind}`)?.style.left);
      return {
        text: row.querySelectorAll('td')[1].textContent,
        measured: mark('measured'),
        predicted: mark('predicted'),
        nominal: mark('nominal'),
      };
    }),
  );

test('a hypothesis that is chosen has its resonances marked beside the measured ones', async () => {
  const expected = json('diagnose', heavy, ...stiff, '--measured', modes);
  await withKeptPage(page_, still, async (page) => {
    for (const number of [1, 0]) {
      const button = page.locator(`#diagnosis [data-hypothesis="${number}"]`);
      await button.focus();
      await page.keyboard.press('Enter');
      assert.equal(await button.getAttribute('aria-pressed'), 'true');
      assert.equal(await page.locator('#diagnosis [data-hypothesis][aria-pressed="true"]').count(), 1);
      const { name, targets } = expected.hypotheses[number];
      assert.ok((await page.locator('.prediction-title').textContent()).includes(name));
      const rows = await predictions(page);
      assert.equal(rows.length, expected.measured_modes.length);
      // two measured modes fix the axis of the lanes
      const all = expected.measured_modes.map((mode) => mode.frequency_hz);
      const [a, b] = [all.indexOf(Math.min(...all)), all.indexOf(Math.max(...all))];
      const place = (f) => rows[a].measured + ((rows[b].measured - rows[a].measured) * (f - all[a])) / (all[b] - all[a]);
      rows.forEach((row, k) => {
        near(Number(row.text), targets[k].frequency_hz, 6e-3, `mode ${k}`);
        near(row.predicted, place(targets[k].frequency_hz), 0.1, `mark ${k}`);
        near(row.nominal, place(expected.measured_modes[k].nominal_hz), 0.1, `nominal ${k}`);
      });
    }
    assert.equal(await page.locator('#diagnosis .prediction .uplot').count(), 0, 'no response was measured');
  });
});

/** The published machine with softer oil, as responses to forces. */
const soft = ['--set', 'legs.oil_spring.stiffness=3.4e6 N/m'];
const measuredResponses = responses('soft-oil.json', json('modes', published, ...soft).modes, {
  damping: 0.002,
  deviation: [2e-8, 2e-8, 1e-8, 3e-8, 3e-8, 2e-8],
});
const responsePage = () => report(published, '--diagnose', measuredResponses);

test('measured responses have the prediction of every hypothesis over them', async () => {
  await withKeptPage(responsePage(), still, async (page) => {
    const found = await page.evaluate(() => window.hydrapod.report.diagnosis);
    const [overlay] = found.responses;
    assert.equal(overlay.entry, 'forces');
    assert.ok(overlay.direct && !overlay.scaled);
    assert.ok(overlay.frequency_hz.length > 100);
    assert.equal(overlay.curves.length, 6);
    const cause = found.hypotheses.findIndex((e) => e.causes.length === 1 && e.causes[0].code === 'oil_springs' && e.causes[0].leg === null);
    assert.ok(found.hypotheses[cause].equally_good);
    await page.evaluate(() => window.hydrapod.diagnosis.choose(0, 2));
    assert.equal(await page.locator('#diagnosis .prediction .uplot').count(), 1);
    assert.match(await page.locator('.prediction-title').textContent(), /: motion in z$/);
    await page.emulateMedia({ media: 'print' });
    const style = await page.locator('#diagnosis .prediction .uplot').evaluate((plot) => getComputedStyle(plot).breakInside);
    assert.equal(style, 'avoid', 'no diagram is cut by the end of a page');
    await page.emulateMedia({ media: 'screen' });
    const drawn = (number) =>
      page.evaluate((k) => {
        window.hydrapod.diagnosis.show(k);
        return window.hydrapod.diagnosis.drawn();
      }, number);
    const off = ({ measured, predicted }) =>
      Math.sqrt(measured.reduce((sum, v, k) => sum + Math.log(v / predicted[k]) ** 2, 0) / measured.length);
    const best = await drawn(cause);
    const nominal = found.hypotheses.findIndex((e) => e.causes.length === 0 && !e.rigid_legs);
    const stated = await drawn(nominal);
    assert.deepEqual(stated.predicted, stated.nominal);
    assert.ok(off(best) < 0.25 * off(stated), `${off(best)} against ${off(stated)}`);
  });
});

test('the prediction of the best hypothesis is what the core of the page computes of its machine', async () => {
  await withKeptPage(responsePage(), still, async (page) => {
    const overlay = await page.evaluate(() => window.hydrapod.report.diagnosis.responses[0]);
    const numbers = await page.evaluate(async (hertz) => {
      const { whatIf } = window.hydrapod;
      await whatIf.ready;
      const computed = await whatIf.compute([], Float64Array.from(hertz, (f) => 2 * Math.PI * f));
      return Array.from(computed.responses);
    }, overlay.frequency_hz);
    const at = overlay.hypotheses.indexOf(0);
    for (const d of [0, 2, 5])
      overlay.curves[d].predicted[at].forEach((value, k) => {
        const place = 72 * k + 14 * d; // (d, d) of the line: re, im
        const size = Math.hypot(numbers[place], numbers[place + 1]);
        near(value, size, 2e-4 * size, `${overlay.curves[d].direction} at ${overlay.frequency_hz[k]} Hz`);
      });
  });
});

for (const [name, options] of [['wide', {}], ['on a phone', { viewport: { width: 360, height: 740 } }]])
  test(`predictions have no finding of axe, nothing overflows: ${name}`, async () => {
    await withKeptPage(responsePage(), { ...still, ...options }, isAccessible);
  });

test('on paper a diagnosis has the usual pictures beside that of the mode it shows first; --modes has its own', async () => {
  for (const [words, only] of [[[], null], [['--modes', '2'], '2']])
    await withPage(report(heavy, ...stiff, '--diagnose', modes, ...words), still, async (page) => {
      const first = await page.evaluate(() => window.hydrapod.state.mode.number);
      const captions = await page.locator('#pictures figcaption strong').allTextContents();
      const numbers = captions.map((caption) => /^Mode (\d+)/.exec(caption)[1]);
      if (only) assert.deepEqual(numbers, [only]);
      else assert.ok(numbers.length >= 4 && numbers.length <= 6 && numbers.includes(String(first)), `${numbers}`);
    });
});
