// Bode diagrams: values against the command line's, chooser, zoom, peaks, downloads.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import {
  damped,
  json,
  model,
  near,
  nearComplex,
  published,
  report,
  still,
  withKeptPage,
  withPage,
} from './support.mjs';

const directions = ['x', 'y', 'z', 'rx', 'ry', 'rz'];
/** The two ways to a value differ by rounding, times what a lightly damped resonance makes of it. */
const tolerance = 1e-9;

/** The response as `hydrapod bode` computes it at the frequencies of the page's grid. */
function reference(machine, bode, points) {
  const hertz = (omega) => `${omega / (2 * Math.PI)} Hz`;
  return json(
    'bode',
    ...machine,
    '--points',
    String(points),
    '--from',
    hertz(bode.from_rad_s),
    '--to',
    hertz(bode.to_rad_s),
  );
}

for (const [name, machine] of [
  ['real modes', [published]],
  ['complex modes', damped],
  ['no damping but dampers', [...damped.slice(0, -2), '--set', 'damping.modal_ratio=0']],
])
  test(`cursor values equal those of the command line: ${name}`, async () => {
    const points = 40;
    await withPage(report(...machine, '--points', String(points)), still, async (page) => {
      const pose = await page.evaluate(() => window.hydrapod.report.poses[0]);
      const expected = reference(machine, pose.bode, points);
      for (const [output, input] of [
        [0, 0],
        [1, 1],
        [5, 5],
        [0, 4],
        [4, 0],
        [2, 2],
      ]) {
        const { re, im } = expected.response[directions[output]][directions[input]];
        const diagonal = expected.response[directions[output]][directions[output]];
        const cursors = await page.evaluate(
          ([o, n, frequencies]) => {
            const { bode } = window.hydrapod;
            bode.choose(o, n);
            return frequencies.map((at) => {
              bode.setCursor(at);
              return bode.cursor();
            });
          },
          [output, input, expected.frequency_hz],
        );
        for (let i = 0; i < points; i += 3) {
          const f = expected.frequency_hz[i];
          const cursor = cursors[i];
          near(cursor.frequency_hz, f, 1e-12 * f, 'frequency');
          // couplings are small differences of large terms
          const scale =
            output === input ? 0 : tolerance * Math.hypot(diagonal.re[i], diagonal.im[i]);
          const value = { re: re[i], im: im[i] };
          if (Math.hypot(re[i], im[i]) > 1e6 * scale)
            nearComplex(
              cursor.flexible,
              value,
              tolerance,
              `${name}: H(${output}, ${input}) at ${f} Hz`,
            );
        }
      }
    });
  });

test('pointing at the diagram and moving the slider move the cursor', async () => {
  await withKeptPage(report(published), still, async (page) => {
    const over = page.locator('.u-over').first();
    await over.scrollIntoViewIfNeeded();
    const box = await over.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForFunction(() => window.hydrapod.bode.cursor() !== null);
    const [from, to] = await page.evaluate(() => window.hydrapod.bode.band());
    const middle = await page.evaluate(() => window.hydrapod.bode.cursor().frequency_hz);
    near(Math.log(middle / Math.sqrt(from * to)), 0, 0.02, 'middle of the band');
    await page.locator('[data-control="cursor"]').fill('1000');
    near(
      await page.evaluate(() => window.hydrapod.bode.cursor().frequency_hz),
      to,
      1e-6 * to,
      'end of the band',
    );
    await page.mouse.move(0, 0); // off the diagram
  });
});

test('the cursor’s row shows magnitude and phase', async () => {
  await withKeptPage(report(published), still, async (page) => {
    const cursor = await page.evaluate(() => {
      window.hydrapod.bode.choose(0, 0);
      window.hydrapod.bode.setCursor(7.4);
      return window.hydrapod.bode.cursor();
    });
    const text = await page.locator('.readout').innerText();
    const size = Math.hypot(cursor.flexible.re, cursor.flexible.im);
    const [mantissa] = size.toExponential(5).split('e');
    const degrees = (Math.atan2(cursor.flexible.im, cursor.flexible.re) * 180) / Math.PI;
    assert.ok(text.includes(mantissa), `${text} has ${mantissa}`);
    assert.ok(text.includes(`${degrees.toFixed(2).replace('-', '−')}°`), `${text} has ${degrees}`);
    assert.match(text, /m\/N/);
  });
});

test('dragging zooms, with the curve computed anew; reset shows the whole band', async () => {
  await withKeptPage(report(published), still, async (page) => {
    const band = () => page.evaluate(() => window.hydrapod.bode.band());
    const whole = await band();
    const over = page.locator('.u-over').first();
    await over.scrollIntoViewIfNeeded();
    const box = await over.boundingBox();
    await page.mouse.move(box.x + 0.3 * box.width, box.y + 50);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.5 * box.width, box.y + 60, { steps: 5 });
    await page.mouse.up();
    const zoomed = await band();
    const at = (share) => whole[0] * (whole[1] / whole[0]) ** share;
    near(zoomed[0] / at(0.3), 1, 0.02, 'from');
    near(zoomed[1] / at(0.5), 1, 0.02, 'to');
    const ends = await page.evaluate(async ([from, to]) => {
      const { bode } = window.hydrapod;
      await bode.ready;
      return [from / 2, 2 * to].map((at) => {
        bode.setCursor(at);
        return bode.cursor().frequency_hz;
      });
    }, zoomed);
    ends.forEach((end, k) => near(end / zoomed[k], 1, 1e-12, 'end of the curve'));
    await page.click('[data-control="zoom-reset"]');
    assert.deepEqual(await band(), whole);
    await page.click('[data-control="zoom-in"]');
    const nearer = await band();
    assert.ok(nearer[1] / nearer[0] < whole[1] / whole[0]);
    await page.click('[data-control="zoom-out"]');
    const farther = await band();
    assert.ok(farther[1] / farther[0] > nearer[1] / nearer[0]);
    await page.click('[data-control="zoom-reset"]');
    assert.deepEqual(await band(), whole);
  });
});

test('the 6×6 chooser: all pairs, by mouse and by arrow keys', async () => {
  await withKeptPage(report(published), still, async (page) => {
    assert.equal(await page.locator('.chooser button').count(), 36);
    await page.click('[data-pair="2,2"]');
    assert.match(await page.locator('#bode-pair').innerText(), /z per force z/);
    await page.locator('[data-pair="2,2"]').press('ArrowDown');
    assert.match(await page.locator('#bode-pair').innerText(), /rx per force z/);
    assert.match(await page.locator('#bode .note').last().innerText(), /not coupled/);
    await page.locator('[data-pair="3,2"]').press('ArrowRight');
    assert.equal(await page.locator('[data-pair="3,3"]').getAttribute('aria-pressed'), 'true');
    assert.equal(await page.locator('.chooser button[tabindex="0"]').count(), 1);
  });
});

test('peaks carry their mode: those that the command line lists', async () => {
  const { peaks } = json('bode', published);
  await withKeptPage(report(published), still, async (page) => {
    await page.click('[data-pair="0,0"]');
    const text = await page.locator('.bode-choice .note').innerText();
    for (const peak of peaks.filter((p) => p.direction === 'x' && p.own))
      assert.ok(text.includes(`(mode ${peak.mode})`), `${text} has mode ${peak.mode}`);
  });
});

/**
 * A peak is that of a mode near it, within three bandwidths of this mode and 1 %; where there is none, that of the
 * nearest one.
 */
function isBehind(modes, number, peak) {
  const off = (mode) => Math.abs(mode.frequency_hz - peak);
  const shown = 1e-4 * peak + 1e-3; // frequencies as shown have three decimals, damped ones are a little lower
  const near = modes.filter((mode) => off(mode) <= 6 * mode.damping_ratio * mode.frequency_hz + 0.01 * peak + shown);
  const own = modes[number - 1];
  if (near.length > 0) return near.includes(own);
  return off(own) <= Math.min(...modes.map(off)) + shown;
}

for (const name of ['zhang-jiang-2021.toml', 'zhang-jiang-2021-transverse.toml'])
  test(`peaks between all different directions carry the mode at their frequency: ${name}`, async () => {
    await withKeptPage(report(model(name)), still, async (page) => {
      const { modes, rigid_modes } = await page.evaluate(() => window.hydrapod.report.poses[0]);
      const [atMode, all] = [new Set(), { flexible: 0, rigid: 0 }];
      for (let output = 0; output < 6; ++output)
        for (let input = 0; input < 6; ++input) {
          if (input === output) continue;
          await page.click(`[data-pair="${output},${input}"]`);
          const [flexible, rigid] = (await page.locator('.bode-choice .note').innerText()).split('rigid');
          for (const [legs, text, of] of [['flexible', flexible, modes], ['rigid', rigid, rigid_modes]])
            for (const [, hertz, number] of text.matchAll(/([\d.]+) Hz \(mode (\d+)\)/g)) {
              assert.ok(isBehind(of, Number(number), Number(hertz)), `${legs}, ${output} per ${input}: ${hertz} Hz, mode ${number}`);
              if (Math.abs(of[number - 1].frequency_hz / hertz - 1) < 0.005) atMode.add(`${legs} ${number}`);
              ++all[legs];
            }
        }
      assert.ok(all.flexible >= 4 && all.rigid >= 4, JSON.stringify(all));
      assert.ok(atMode.size >= 4, [...atMode].join(', '));
    });
  });

async function saved(page, control) {
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.click(`[data-control="${control}"]`),
  ]);
  return { name: download.suggestedFilename(), content: readFileSync(await download.path()) };
}

test('downloads: SVG, PNG, CSV and JSON', async () => {
  await withPage(report(model('zhang-jiang-2021-transverse.toml')), still, async (page) => {
    await page.click('[data-pair="0,0"]');
    const svg = await saved(page, 'svg');
    assert.equal(svg.name, 'bode-x-x.svg');
    const text = svg.content.toString();
    assert.match(text, /<svg[^>]* xmlns="http:\/\/www.w3.org\/2000\/svg"/);
    const sound = await page.evaluate((source) => {
      const parsed = new DOMParser().parseFromString(source, 'image/svg+xml');
      return {
        error: parsed.querySelector('parsererror') !== null,
        curves: parsed.querySelectorAll('path').length,
      };
    }, text);
    assert.deepEqual(sound, { error: false, curves: 4 });

    const png = await saved(page, 'png');
    assert.equal(png.name, 'bode-x-x.png');
    assert.equal(png.content.subarray(1, 4).toString(), 'PNG');
    assert.ok(png.content.readUInt32BE(16) >= 1600, 'wide enough for a paper');

    const csv = await saved(page, 'csv');
    assert.equal(csv.name, 'bode-x-x.csv');
    const [head, ...rows] = csv.content
      .toString()
      .trim()
      .split('\n')
      .map((line) => line.split(','));
    assert.deepEqual(head.slice(0, 4), [
      'frequency_hz',
      'omega_rad_s',
      'flexible_re',
      'flexible_im',
    ]);
    assert.ok(
      rows.length >= 600 &&
        rows.every(
          (row) => row.length === head.length && row.every((v) => Number.isFinite(Number(v))),
        ),
    );
    const row = rows[123].map(Number);
    const cursor = await page.evaluate((f) => {
      window.hydrapod.bode.setCursor(f);
      return window.hydrapod.bode.cursor();
    }, row[0]);
    assert.deepEqual([cursor.flexible.re, cursor.flexible.im], [row[2], row[3]]);
    near(row[4], Math.hypot(row[2], row[3]), 1e-15 * row[4], 'magnitude');

    const data = await saved(page, 'json');
    assert.deepEqual(
      JSON.parse(data.content),
      await page.evaluate(() => JSON.parse(JSON.stringify(window.hydrapod.report))),
    );
  });
});

test('the CSV file says of which pose and of which changed values it is', async () => {
  const heavy = model('heavy-platform.toml');
  await withPage(report(heavy, '--pose', 'neutral', '--pose', 'low'), still, async (page) => {
    const comments = async () => {
      const lines = (await saved(page, 'csv')).content.toString().split('\n');
      const first = lines.findIndex((line) => !line.startsWith('#'));
      assert.match(lines[first], /^frequency_hz,/);
      return lines.slice(0, first);
    };
    assert.deepEqual(await comments(), ['# pose neutral']);
    await page.locator('[data-pose="1"]').click();
    await page.evaluate(() => window.hydrapod.bode.ready);
    await page.evaluate(async () => {
      const { bode, whatIf } = window.hydrapod;
      await whatIf.ready;
      whatIf.replace([['platform.mass', 9000], ['legs.rod.mass', 50]]);
      await whatIf.shown();
      await bode.ready;
    });
    assert.deepEqual(await comments(), ['# pose low', '# platform.mass 9 t (report: 14 t)', '# legs.rod.mass 50 kg (report: 23 kg)']);
  });
});

test('a machine without stable modes has no curves, and none of another machine stay', async () => {
  const words = [model('heavy-platform.toml')];
  await withPage(report(...words), still, async (page) => {
    await page.evaluate(() => window.hydrapod.whatIf.ready);
    const type = async (text) => {
      const field = page.locator('[data-field="platform.mass"]');
      await field.fill(text);
      await field.press('Enter');
      await page.waitForFunction((mass) => window.hydrapod.state.values.some(([, value]) => value === mass), 1000 * Number(text));
      await page.evaluate(async () => {
        await window.hydrapod.whatIf.shown();
        await window.hydrapod.bode.ready;
      });
    };
    await type('100000'); // t
    assert.equal(await page.evaluate(() => window.hydrapod.state.pose.bode), undefined);
    assert.match(await page.locator('#bode').innerText(), /There is no stable response/);
    assert.equal(await page.locator('#bode :is(.uplot, figure, .readout)').count(), 0);
    await page.evaluate(() => window.hydrapod.bode.choose(2, 2));
    await page.emulateMedia({ colorScheme: 'dark' });
    assert.equal(await page.locator('#bode :is(.uplot, figure, .readout)').count(), 0);
    await page.emulateMedia({ colorScheme: 'light' });
    await type('16'); // stands
    assert.match(await page.locator('#bode').innerText(), /z per force z/);
    assert.doesNotMatch(await page.locator('#bode').innerText(), /There is no stable response|unstable/);
    await type('100'); // some modes are unstable
    assert.match(await page.locator('#bode').innerText(), /The machine is unstable at this pose/);
  });
});
