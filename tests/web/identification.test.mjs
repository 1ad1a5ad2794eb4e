// Identified modes on the page: the chart against the JSON, the page's fit against that of the
// program, switching poles by hand.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { test } from 'node:test';
import {
  findings,
  json,
  near,
  nearComplex,
  published,
  report,
  still,
  temporary,
  withKeptPage,
  withPage,
} from './support.mjs';

const phone = { ...still, viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true };
const hostile = '<img src=x onerror=alert(1)>"\'`${}';
const damping = 0.013;
const deviation = [2e-9, 2e-9, 1e-9, 3e-9, 3e-9, 2e-9];

/** Normally distributed numbers, the same ones every time. */
function normals(seed) {
  let state = seed;
  const uniform = () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state + 0.5) / 2 ** 32;
  };
  return () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

/** Responses of the published machine with rigid legs, as a measurement with known noise. */
function measurement(name, names = {}, more = {}) {
  const { modes } = json('modes', published, '--model', 'rigid');
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

const file = measurement('frf.json');
const page_of = () => report(published, '--model', 'rigid', '--measured', file);
const found = json('identify', file, '--machine', published, '--model', 'rigid');
const near_line = (list, value) =>
  list.reduce((best, f, k) => (Math.abs(f - value) < Math.abs(list[best] - value) ? k : best), 0);

test('six modes are found and paired with the machine', () => {
  assert.equal(found.modes.length, 6);
  assert.equal(found.comparison.pairs.length, 6);
});

test('the marks of the chart stand where the JSON has the poles', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const marks = await page.evaluate(() => window.hydrapod.identification.marks());
    const [from, to] = found.band_hz;
    const poles = found.stabilisation.flatMap(({ order, poles: all }) =>
      all
        .filter((p) => p.stable && p.frequency_hz >= from && p.frequency_hz <= to)
        .map((p) => ({ order, ...p })),
    );
    assert.ok(poles.length > 100);
    assert.equal(marks.length, poles.length);
    // two of them fix the axes; all others must then be on their places
    const far = (key) => [poles.reduce((a, b) => (a[key] < b[key] ? a : b)), poles.reduce((a, b) => (a[key] > b[key] ? a : b))].map((p) => poles.indexOf(p));
    const line = (key, axis) => {
      const [a, b] = far(key);
      const slope = (marks[b][axis] - marks[a][axis]) / (poles[b][key] - poles[a][key]);
      return (value) => marks[a][axis] + slope * (value - poles[a][key]);
    };
    const [x, y] = [line('frequency_hz', 'x'), line('order', 'y')];
    poles.forEach((pole, k) => {
      near(marks[k].x, x(pole.frequency_hz), 1e-6, `x of pole ${k}`);
      near(marks[k].y, y(pole.order), 1e-6, `y of pole ${k}`);
    });
    const drawn = await page.$$eval('#identification .mark', (all) =>
      all.map((m) => [m.dataset.order, m.dataset.agrees, m.dataset.on, m.getAttribute('transform')]),
    );
    poles.forEach((pole, k) => {
      assert.equal(drawn[k][0], String(pole.order));
      assert.equal(drawn[k][1], pole.agrees);
      assert.equal(drawn[k][2], String(pole.cluster !== null));
      const [px, py] = drawn[k][3].match(/-?[\d.]+/g).map(Number);
      near(px, marks[k].x, 0.006, 'drawn x');
      near(py, marks[k].y, 0.006, 'drawn y');
    });
    assert.ok((await page.locator('#identification .indicator').count()) === 6);
  });
});

/** H of the modes that the program found, from its JSON. */
function synthesised(o, i, f) {
  const omega = 2 * Math.PI * f;
  let [re, im] = [0, 0];
  for (const mode of [...found.modes, ...found.heavily_damped]) {
    const a = mode.shape.re[o] * mode.participation.re[i] - mode.shape.im[o] * mode.participation.im[i];
    const b = mode.shape.re[o] * mode.participation.im[i] + mode.shape.im[o] * mode.participation.re[i];
    for (const sign of [1, -1]) {
      const [p, q] = [-mode.pole.re, omega - sign * mode.pole.im];
      const square = p * p + q * q;
      re += (a * p + sign * b * q) / square;
      im += (sign * b * p - a * q) / square;
    }
  }
  const w = omega / found.residuals.omega_scale_rad_s;
  const c = found.residuals.terms.map((C) => C[o][i]);
  return { re: re - c[0] / w ** 2 + c[2], im: im - c[1] / w + c[3] * w };
}

test('the fit on the page is that of the program', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    for (const [o, i] of [[0, 0], [2, 2], [0, 4], [5, 5]])
      for (const mode of found.modes) {
        const peak = synthesised(o, i, mode.frequency_hz);
        const largest = Math.max(...found.modes.map((m) => {
          const h = synthesised(o, i, m.frequency_hz);
          return Math.hypot(h.re, h.im);
        }));
        if (Math.hypot(peak.re, peak.im) < 0.1 * largest) continue;
        const here = await page.evaluate(
          ([out, inp, f]) => window.hydrapod.identification.responseAt(out, inp, f),
          [o, i, mode.frequency_hz],
        );
        nearComplex(here, peak, 2e-3, `(${o}, ${i}) at ${mode.frequency_hz} Hz`);
      }
    const shapes = await page.evaluate(() => window.hydrapod.identification.shapes());
    found.modes.forEach((mode, r) => {
      const size = Math.hypot(...mode.shape.re, ...mode.shape.im);
      mode.shape.re.forEach((re, o) => {
        const off = Math.hypot(shapes[r][o].re - re, shapes[r][o].im - mode.shape.im[o]);
        assert.ok(off < 5e-3 * size, `shape ${r + 1}, output ${o}: off by ${off / size}`);
      });
    });
    near(await page.evaluate(() => window.hydrapod.identification.error()), found.fit_error, 0.01 * found.fit_error, 'error');
  });
});

/** ρ of a Hann window: Σ w_t w_(t + τ)/Σ w². */
function hannTaper(length) {
  const w = Array.from({ length }, (_, t) => 0.5 - 0.5 * Math.cos((2 * Math.PI * t) / length));
  const square = w.reduce((sum, v) => sum + v * v, 0);
  return w.map((_, lag) => {
    let sum = 0;
    for (let t = 0; t + lag < length; ++t) sum += w[t] * w[t + lag];
    return sum / square;
  });
}

test('so it is through the window of the measurement', async () => {
  // the data are those without a window: then neither fit is good, and both must be bad alike
  const windowed = measurement('windowed.json', {}, { sample_rate_hz: 128, taper: hannTaper(2048) });
  const expected = json('identify', windowed);
  assert.ok(expected.fit_error > 2 * found.fit_error);
  await withPage(report(published, '--measured', windowed), still, async (page) => {
    const error = await page.evaluate(() => window.hydrapod.identification.error());
    near(error, expected.fit_error, 0.02 * expected.fit_error, 'error');
    const shapes = await page.evaluate(() => window.hydrapod.identification.shapes());
    expected.modes.forEach((mode, r) => {
      const size = Math.hypot(...mode.shape.re, ...mode.shape.im);
      mode.shape.re.forEach((re, o) => {
        const off = Math.hypot(shapes[r][o].re - re, shapes[r][o].im - mode.shape.im[o]);
        assert.ok(off < 0.01 * size, `shape ${r + 1}, output ${o}: off by ${off / size}`);
      });
    });
  });
});

test('and beside the imaginary axis', async () => {
  const shifted = measurement('shifted.json', {}, { shift_per_s: 0.9 });
  const expected = json('identify', shifted);
  assert.equal(expected.modes.length, found.modes.length);
  expected.modes.forEach((mode, r) =>
    near(mode.damping_ratio, found.modes[r].damping_ratio, 0.05 * damping, `damping ${r + 1}`),
  );
  await withPage(report(published, '--measured', shifted), still, async (page) => {
    const error = await page.evaluate(() => window.hydrapod.identification.error());
    near(error, expected.fit_error, 0.01 * expected.fit_error, 'error');
  });
});

test('switching a mode off takes it out of fit and table, and on again brings it back', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const error = () => page.evaluate(() => window.hydrapod.identification.error());
    const before = await error();
    const box = page.locator('#identification [data-pole="2"]');
    await box.uncheck();
    const without = await error();
    assert.ok(without > 5 * before, `${without} against ${before}`);
    const row = page.locator('#identification .identified tbody tr').nth(2);
    assert.match(await row.textContent(), /switched off/);
    const chosen = await page.evaluate(() => window.hydrapod.identification.chosen().length);
    assert.equal(chosen, found.modes.length + found.heavily_damped.length - 1);
    assert.match(await page.locator('#identification').textContent(), /5 poles switched on/);
    await box.check();
    near(await error(), before, 1e-12, 'as before');
  });
});

test('a click on a mark switches its mode; a pole can be added by hand, by keyboard too', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const chosen = () => page.evaluate(() => window.hydrapod.identification.chosen().length);
    const all = await chosen();
    const chart = page.locator('#identification [data-control="chart"]');
    const click = async (mark) => {
      await chart.scrollIntoViewIfNeeded();
      const box = await chart.boundingBox();
      await page.mouse.click(box.x + mark.x, box.y + mark.y);
    };
    const marks = await page.evaluate(() => window.hydrapod.identification.marks());
    // the mark of a mode's highest order, one that stands alone
    const mode = found.modes.find((m) => found.modes.every((n) => n === m || Math.abs(n.frequency_hz - m.frequency_hz) > 1));
    const order = Math.max(...marks.map((m) => m.order));
    const mark = marks
      .filter((m) => m.order === order)
      .sort((a, b) => Math.abs(a.frequency_hz - mode.frequency_hz) - Math.abs(b.frequency_hz - mode.frequency_hz))[0];
    await click(mark);
    assert.equal(await chosen(), all - 1);
    await click(mark);
    assert.equal(await chosen(), all);
    // by hand: a pole that belongs to no mode
    const loose = found.stabilisation
      .flatMap(({ order: n, poles }) => poles.map((p) => ({ n, ...p })))
      .find((p) => p.cluster === null && p.stable && p.frequency_hz > found.band_hz[0]);
    await page.selectOption('[data-control="hand-order"]', String(loose.n));
    await page.fill('[data-control="hand-frequency"]', String(loose.frequency_hz));
    await page.locator('[data-control="hand-switch"]').focus();
    await page.keyboard.press('Enter');
    assert.equal(await chosen(), all + 1);
    const last = page.locator('#identification .identified tbody tr').last();
    assert.match(await last.textContent(), new RegExp(`by hand, order ${loose.n}`));
    assert.ok((await page.evaluate(() => window.hydrapod.identification.error())) <= found.fit_error * 1.01);
    await page.click('[data-control="as-found"]');
    assert.equal(await chosen(), all);
  });
});

test('tables: modes with their intervals, MAC, comparison', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const rows = await page.$$eval('#identification .identified tbody tr', (all) =>
      all.map((row) => [...row.querySelectorAll('td')].map((td) => td.textContent)),
    );
    const motions = await page.evaluate(() =>
      window.hydrapod.report.identification.modes.map((mode) => mode.motion),
    );
    found.modes.forEach((mode, r) => {
      assert.equal(rows[r][4], motions[r]);
      near(Number(rows[r][0]), mode.frequency_hz, 6e-4, 'Hz');
      near(Number(rows[r][1]), mode.frequency_95_hz, 0.051 * mode.frequency_95_hz, '± Hz');
      near(Number.parseFloat(rows[r][2]), 100 * mode.damping_ratio, 6e-3, 'damping');
    });
    const compared = await page.$$eval('#identification .compared tbody tr', (all) =>
      all.map((row) => [...row.querySelectorAll('th, td')].map((cell) => cell.textContent)),
    );
    assert.equal(compared.length, 6);
    found.comparison.pairs.forEach((pair, k) => {
      assert.equal(compared[k][0], String(pair.mode));
      near(Number(compared[k][7]), pair.mac, 6e-4, 'MAC');
      near(Number(compared[k][2]), pair.model.frequency_hz, 6e-4, 'model');
    });
    const mac = await page.$$eval('#identification .mac tbody td', (all) => all.map((td) => Number(td.textContent)));
    found.mac.flat().forEach((value, k) => near(mac[k], value, 6e-3, `MAC ${k}`));
    await page.selectOption('[data-control="measured-output"]', { index: 4 });
    await page.selectOption('[data-control="measured-input"]', { index: 4 });
    assert.equal(await page.locator('#identification .uplot').count(), 2);
  });
});

test('names of channels are text, whatever they hold', async () => {
  const bad = measurement('hostile.json', { outputs: [hostile], inputs: [hostile] });
  await withPage(report(published, '--model', 'rigid', '--measured', bad), still, async (page) => {
    assert.equal(await page.locator('#identification img').count(), 0);
    assert.ok((await page.locator('#identification').textContent()).includes(hostile));
    const option = page.locator('[data-control="measured-output"] option').first();
    assert.equal(await option.textContent(), hostile);
  });
});

for (const theme of ['light', 'dark'])
  test(`no finding of axe, ${theme}; nothing overflows on a phone`, async () => {
    for (const options of [still, phone])
      await withKeptPage(page_of(), options, async (page) => {
        await page.emulateMedia({ colorScheme: theme });
        assert.deepEqual(await findings(page), []);
        const { scroll, client } = await page.evaluate(() => ({
          scroll: document.documentElement.scrollWidth,
          client: document.documentElement.clientWidth,
        }));
        assert.ok(scroll <= client, `${scroll} > ${client}`);
      });
  });

test('no section without a measurement', async () => {
  await withPage(report(published), still, async (page) => {
    assert.equal(await page.locator('#identification').count(), 0);
  });
});
