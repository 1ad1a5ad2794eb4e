// Identified modes on the page: the chart against the JSON, the page's fit against that of the
// program, switching poles by hand.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import {
  correlated,
  hannTaper,
  hydrapod,
  isAccessible,
  json,
  near,
  published,
  report,
  responses,
  still,
  temporary,
  withKeptPage,
  withPage,
} from './support.mjs';

const phone = { ...still, viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true };
const hostile = '<img src=x onerror=alert(1)>"\'`${}';
const damping = 0.013;
const deviation = [2e-9, 2e-9, 1e-9, 3e-9, 3e-9, 2e-9];

/** Responses of the published machine with rigid legs, as a measurement with known noise. */
const measurement = (name, names = {}, more = {}) =>
  responses(name, json('modes', published, '--model', 'rigid').modes, { damping, deviation, names, more });

const file = measurement('frf.json');
const page_of = () => report(published, '--model', 'rigid', '--measured', file);
const found = json('identify', file, '--machine', published, '--model', 'rigid');

test('six modes are found and paired with the machine', () => {
  assert.equal(found.modes.length, 6);
  assert.equal(found.comparison.pairs.length, 6);
});

test('the top of the page says what was identified', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const text = await page.locator('#answer .verdict').textContent();
    const [least, most] = [Math.min, Math.max].map((of) => of(...found.modes.map((mode) => mode.frequency_hz)).toFixed(3));
    assert.ok(text.startsWith(`Measured: 6 modes, ${least} to ${most} Hz; 6 with a partner in the model`), text);
    const calculated = await page.locator('#answer .words:not(.verdict)').textContent();
    assert.match(calculated, /^Calculated for this machine: Lowest mode/);
  });
});

test('curves of the mode indicator end at the edge of the chart', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const clip = await page.locator('.chart g[clip-path]').getAttribute('clip-path');
    assert.equal(clip, 'url(#chart-frame)');
    assert.equal(await page.locator('.chart g[clip-path] path.indicator').count(), found.indicator.values.length);
  });
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
function synthesised(o, i, f, of = found) {
  const omega = 2 * Math.PI * f;
  let [re, im] = [0, 0];
  for (const mode of [...of.modes, ...of.heavily_damped]) {
    const a = mode.shape.re[o] * mode.participation.re[i] - mode.shape.im[o] * mode.participation.im[i];
    const b = mode.shape.re[o] * mode.participation.im[i] + mode.shape.im[o] * mode.participation.re[i];
    for (const sign of [1, -1]) {
      const [p, q] = [-mode.pole.re, omega - sign * mode.pole.im];
      const square = p * p + q * q;
      re += (a * p + sign * b * q) / square;
      im += (sign * b * p - a * q) / square;
    }
  }
  const w = omega / of.residuals.omega_scale_rad_s;
  of.residuals.terms.forEach((C, n) => {
    // (iw)^(n − 2)
    const size = C[o][i] * w ** (n - 2);
    const turn = (((n - 2) % 4) + 4) % 4;
    if (turn % 2 === 0) re += turn === 0 ? size : -size;
    else im += turn === 1 ? size : -size;
  });
  return { re, im };
}

/** The page has numbers of the measured responses to seven digits, and poles to all. */
const same = 1e-6;

const error = (page) => page.evaluate(() => window.hydrapod.identification.error());

/** Until the core has fitted what was chosen last. */
const settled = (page) => page.evaluate(() => window.hydrapod.identification.ready);

/** The shapes of the page's fit are those of modes and heavily damped poles. */
async function nearShapes(page, { modes, heavily_damped }) {
  const shapes = await page.evaluate(() => window.hydrapod.identification.shapes());
  [...modes, ...heavily_damped].forEach(({ shape }, r) => {
    const size = Math.hypot(...shape.re, ...shape.im);
    shape.re.forEach((re, o) => {
      const off = Math.hypot(shapes[r][o].re - re, shapes[r][o].im - shape.im[o]);
      assert.ok(off < same * size, `shape ${r + 1}, output ${o}: off by ${off / size}`);
    });
  });
}

test('the fit on the page is that of the program', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const { frequency_hz } = await page.evaluate(() => window.hydrapod.report.identification.responses);
    for (const [o, i] of [[0, 0], [2, 2], [0, 4], [5, 5]]) {
      const drawn = await page.evaluate(([out, inp]) => window.hydrapod.identification.fitted(out, inp), [o, i]);
      assert.equal(drawn.length, frequency_hz.length);
      const expected = frequency_hz.map((f) => synthesised(o, i, f));
      const largest = Math.max(...expected.map((h) => Math.hypot(h.re, h.im)));
      expected.forEach((h, k) => {
        const off = Math.hypot(drawn[k].re - h.re, drawn[k].im - h.im);
        assert.ok(off < same * largest, `(${o}, ${i}) at ${frequency_hz[k]} Hz: off by ${off / largest}`);
      });
    }
    await nearShapes(page, found);
    near(await error(page), found.fit_error, same * found.fit_error, 'error');
  });
});

test('so it is through the window of the measurement', async () => {
  // the data are those without a window: then neither fit is good, and both must be bad alike
  const windowed = measurement('windowed.json', {}, { sample_rate_hz: 128, taper: hannTaper(2048) });
  const expected = json('identify', windowed);
  assert.ok(expected.fit_error > 2 * found.fit_error);
  await withPage(report(published, '--measured', windowed), still, async (page) => {
    near(await error(page), expected.fit_error, same * expected.fit_error, 'error');
    await nearShapes(page, expected);
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
    near(await error(page), expected.fit_error, same * expected.fit_error, 'error');
    await nearShapes(page, expected);
  });
});

test('and where the errors of inputs are correlated', async () => {
  const together = measurement('together.json', {}, correlated);
  const expected = json('identify', together);
  await withPage(report(published, '--measured', together), still, async (page) => {
    near(await error(page), expected.fit_error, same * expected.fit_error, 'error');
    await nearShapes(page, expected);
  });
});

test('switching a mode off takes it out of fit and table, and on again brings it back', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const before = await error(page);
    const box = page.locator('#identification [data-pole="2"]');
    await box.uncheck();
    await settled(page);
    const without = await error(page);
    assert.ok(without > 5 * before, `${without} against ${before}`);
    const row = page.locator('#identification .identified tbody tr').nth(2);
    assert.match(await row.textContent(), /switched off/);
    const chosen = await page.evaluate(() => window.hydrapod.identification.chosen().length);
    assert.equal(chosen, found.modes.length + found.heavily_damped.length - 1);
    assert.match(await page.locator('#identification').textContent(), /5 poles switched on/);
    await box.check();
    await settled(page);
    near(await error(page), before, 1e-12, 'as before');
  });
});

test('without any pole only the residual terms are left', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const boxes = page.locator('#identification [data-pole]');
    for (let k = 0; k < (await boxes.count()); ++k) await boxes.nth(k).uncheck();
    await settled(page);
    assert.match(await page.locator('#identification').textContent(), /0 poles switched on: error/);
    const left = await error(page);
    assert.ok(left > 0.3 && left < 1, `${left}`);
    assert.deepEqual(await page.evaluate(() => window.hydrapod.identification.shapes()), []);
    await page.click('[data-control="as-found"]');
    await settled(page);
  });
});

test('many choices in a row: the last one is shown, whatever the core still computes', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const before = await error(page);
    const after = await page.evaluate(async () => {
      const box = (k) => document.querySelector(`#identification [data-pole="${k}"]`);
      const { identification } = window.hydrapod;
      for (let k = 0; k < 24; ++k) {
        box(k % 6).click();
        if (k % 5 === 0) await new Promise((resolve) => setTimeout(resolve, 3)); // some fits begin
      }
      await identification.ready;
      const all = identification.error();
      box(1).click();
      box(4).click();
      box(1).click();
      await identification.ready;
      return { all, error: identification.error(), shapes: identification.shapes().length };
    });
    near(after.all, before, 1e-12, 'each was switched an even number of times');
    assert.equal(after.shapes, found.modes.length + found.heavily_damped.length - 1);
    const row = page.locator('#identification .identified tbody tr').nth(4);
    assert.match(await row.textContent(), /switched off/);
    await page.locator('#identification [data-pole="4"]').check();
    await settled(page);
    // and a pole whose shape the core must find, and at once a mode whose shape is known: the mode remains
    const caption = await page.evaluate(async () => {
      document.querySelector('[data-control="hand-show"]').click();
      document.querySelector('#identification [data-shape="0"]').click();
      await window.hydrapod.identification.ready;
      return document.querySelector('.moving-shape .caption').textContent;
    });
    assert.match(caption, /^Mode 1:/);
  });
});

test('a browser without WebAssembly shows why there is no fit, and all that the program found', async () => {
  const launch = () => {
    const { Blob: Original } = window;
    window.Blob = class extends Original {
      constructor(parts, options) {
        super(options?.type === 'text/javascript' ? ['delete self.WebAssembly;', ...parts] : parts, options);
      }
    };
  };
  await withPage(page_of(), { ...still, launch }, async (page) => {
    assert.match(await page.locator('#identification').textContent(), /The page could not calculate: /);
    assert.ok((await page.evaluate(() => window.hydrapod.identification.marks().length)) > 100);
    const motions = await page.$$eval('#identification .identified tbody tr', (rows) =>
      rows.map((row) => row.querySelectorAll('td')[4].textContent),
    );
    assert.deepEqual(
      motions.slice(0, found.modes.length),
      await page.evaluate(() => window.hydrapod.report.identification.modes.map(({ motion }) => motion)),
    );
    await page.locator('#identification [data-pole="1"]').uncheck();
    await settled(page);
    assert.match(await page.locator('#identification').textContent(), /The page could not calculate: /);
    await pressByHand(page, 'hand-show');
    await settled(page);
    assert.match(await page.locator('.moving-shape .caption').textContent(), /The page could not calculate: /);
    await page.locator('#identification [data-shape="0"]').click();
    assert.match(await page.locator('.moving-shape .caption').textContent(), /^Mode 1:/);
  });
});

/** Clicks a mark of the chart. */
async function clickMark(page, mark) {
  const chart = page.locator('#identification [data-control="chart"]');
  await chart.scrollIntoViewIfNeeded();
  const box = await chart.boundingBox();
  await page.mouse.click(box.x + mark.x, box.y + mark.y);
}

/** The mark of the highest order of a mode that stands alone. */
async function loneMark(page) {
  const marks = await page.evaluate(() => window.hydrapod.identification.marks());
  const mode = found.modes.find((m) => found.modes.every((n) => n === m || Math.abs(n.frequency_hz - m.frequency_hz) > 1));
  const order = Math.max(...marks.map((m) => m.order));
  const off = (m) => Math.abs(m.frequency_hz - mode.frequency_hz);
  return { mode, mark: marks.filter((m) => m.order === order).sort((a, b) => off(a) - off(b))[0] };
}

/**
 * Chooses a pole that belongs to no mode by its order and frequency, and presses a button beside them by
 * keyboard; the order.
 */
async function pressByHand(page, control) {
  const loose = found.stabilisation
    .flatMap(({ order, poles }) => poles.map((p) => ({ order, ...p })))
    .find((p) => p.cluster === null && p.stable && p.frequency_hz > found.band_hz[0]);
  await page.selectOption('[data-control="hand-order"]', String(loose.order));
  await page.fill('[data-control="hand-frequency"]', String(loose.frequency_hz));
  await page.locator(`[data-control="${control}"]`).focus();
  await page.keyboard.press('Enter');
  return loose.order;
}

/** Complex displacements of the platform's joints, all legs in one list, of a motion of the mass centre. */
function jointMotion({ re, im }, geometry) {
  const center = geometry.platform.mass_center_m;
  const of = (m) =>
    geometry.legs.flatMap(({ platform_joint_m: p }) => {
      const [x, y, z] = p.map((v, i) => v - center[i]);
      return [m[0] + m[4] * z - m[5] * y, m[1] + m[5] * x - m[3] * z, m[2] + m[3] * y - m[4] * x];
    });
  const [a, b] = [of(re), of(im)];
  return a.map((v, k) => ({ re: v, im: b[k] }));
}

/** |aᴴ b|²/(aᴴa bᴴb) */
function likeness(a, b) {
  let [re, im, aa, bb] = [0, 0, 0, 0];
  a.forEach((x, k) => {
    re += x.re * b[k].re + x.im * b[k].im;
    im += x.re * b[k].im - x.im * b[k].re;
    aa += x.re ** 2 + x.im ** 2;
    bb += b[k].re ** 2 + b[k].im ** 2;
  });
  return (re * re + im * im) / (aa * bb);
}

/** Displacements of the joints as drawn: at phase 0 the real part, at −90° the imaginary one. */
async function drawnMotion(page, side) {
  const geometry = await page.evaluate(() => window.hydrapod.report.poses[0].geometry);
  const rest = geometry.legs.flatMap((leg) => leg.platform_joint_m);
  const at = (phase) =>
    page.evaluate(
      ([p, s]) => {
        const { shape } = window.hydrapod.identification;
        shape.setPhase(p);
        return [1, 2, 3, 4, 5, 6].flatMap((leg) => shape.jointPositions(leg, s)?.joint ?? []);
      },
      [phase, side],
    );
  const [real, imaginary] = [await at(0), await at(-Math.PI / 2)];
  return { geometry, motion: real.map((v, k) => ({ re: v - rest[k], im: imaginary[k] - rest[k] })) };
}

test('a click on a pole moves the machine in its measured shape, beside the mode of the model', async () => {
  await withPage(page_of(), {}, async (page) => {
    const { mode, mark } = await loneMark(page);
    await clickMark(page, mark);
    const frames = () => page.evaluate(() => window.hydrapod.identification.shape.frames());
    const before = await frames();
    await page.waitForFunction((n) => window.hydrapod.identification.shape.frames() > n + 5, before);
    assert.ok(await page.evaluate(() => window.hydrapod.identification.shape.motion().playing));
    assert.equal(await page.locator('#identification circle.selected').count(), 1);
    const number = found.modes.indexOf(mode) + 1;
    assert.match(await page.locator('.moving-shape .viewport-heads').textContent(), new RegExp(`Measured mode ${number},`));
    const { geometry, motion } = await drawnMotion(page, 'measured');
    const expected = jointMotion(mode.displacement_shape, geometry);
    near(likeness(motion, expected), 1, 1e-6, 'the drawn shape and that of the JSON');
    const size = Math.max(...geometry.legs.map((leg) => leg.length_m));
    const most = Math.max(...[0, 1, 2, 3, 4, 5].map((k) => Math.hypot(...motion.slice(3 * k, 3 * k + 3).flatMap((v) => [v.re, v.im]))));
    near(most, 0.12 * size, 0.02 * size, 'amplitude');
  });
});

test('the mode of the model moves beside it, with the motion that the JSON has', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const { mode, mark } = await loneMark(page);
    await clickMark(page, mark);
    assert.equal(await page.evaluate(() => window.hydrapod.identification.shape.motion().playing), false);
    const pair = await page.evaluate(
      (n) => window.hydrapod.report.identification.comparison.pairs.find((p) => p.mode === n),
      found.modes.indexOf(mode) + 1,
    );
    const model = await drawnMotion(page, 'model');
    near(likeness(model.motion, jointMotion(pair.model.motion, model.geometry)), 1, 1e-6, 'the shape of the model');
    const measured = await drawnMotion(page, 'measured');
    assert.ok(likeness(model.motion, measured.motion) > 0.9);
    const together = model.motion.reduce((sum, v, k) => sum + v.re * measured.motion[k].re, 0);
    assert.ok(together > 0, 'both move the same way');
  });
});

test('the table and the keyboard show shapes; a pole of no mode has that of the fit', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    await page.locator('#identification [data-shape="1"]').focus();
    await page.keyboard.press('Enter');
    const first = await drawnMotion(page, 'measured');
    near(likeness(first.motion, jointMotion(found.modes[1].displacement_shape, first.geometry)), 1, 1e-6, 'mode 2');
    await pressByHand(page, 'hand-show');
    await settled(page);
    assert.match(await page.locator('.moving-shape .caption').textContent(), /belongs to no mode/);
    const shown = await drawnMotion(page, 'measured');
    await page.locator('[data-control="selected-switch"]').click(); // now it is in the fit
    await settled(page);
    const shape = await page.evaluate(() => window.hydrapod.identification.shapes().at(-1));
    const fitted = { re: shape.map((v) => v.re), im: shape.map((v) => v.im) };
    near(likeness(shown.motion, jointMotion(fitted, shown.geometry)), 1, 1e-6, 'the shape of the fit');
    assert.equal(await page.locator('[data-control="selected-switch"]').textContent(), 'Switch off');
    await page.click('[data-control="as-found"]');
    await settled(page);
  });
});

test('the shape that is shown is that of the last fit', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const pair = found.comparison.pairs[0];
    const own = found.modes[pair.mode - 1];
    await page.locator(`#identification [data-shape="${pair.mode - 1}"]`).click();
    const identified = await drawnMotion(page, 'measured');
    near(likeness(identified.motion, jointMotion(own.displacement_shape, identified.geometry)), 1, 1e-6, 'as identified');
    for (const [k] of found.modes.entries()) if (k !== pair.mode - 1) await page.locator(`#identification [data-pole="${k}"]`).uncheck();
    await settled(page);
    assert.match(await page.locator('.moving-shape .caption').textContent(), /^Mode \d+: damping ratio .* that of the fit/);
    const [shape] = await page.evaluate(() => window.hydrapod.identification.shapes());
    const fitted = { re: shape.map((v) => v.re), im: shape.map((v) => v.im) };
    const shown = await drawnMotion(page, 'measured');
    near(likeness(shown.motion, jointMotion(fitted, shown.geometry)), 1, 1e-9, 'of the fit');
    assert.ok(likeness(shown.motion, identified.motion) < 1 - 1e-6, 'which is another one');
    await page.click('[data-control="as-found"]');
    await settled(page);
    const again = await drawnMotion(page, 'measured');
    near(likeness(again.motion, identified.motion), 1, 1e-9, 'after Reset that of the identification');
  });
});

test('outputs without directions of the platform have no picture, and a note', async () => {
  const file = measurement('sensors.json', {}, {});
  const text = JSON.parse(readFileSync(file, 'utf8'));
  for (const output of text.outputs) delete output.direction;
  writeFileSync(file, JSON.stringify(text));
  await withPage(report(published, '--model', 'rigid', '--measured', file), still, async (page) => {
    await page.locator('#identification [data-shape="0"]').click();
    assert.match(await page.locator('.moving-shape .caption').textContent(), /not directions of the platform/);
    assert.ok(await page.locator('.moving-shape .stage').isHidden());
    const button = page.locator('[data-control="selected-switch"]');
    assert.ok(await button.isVisible(), 'the pole can be switched all the same');
    await button.click();
    assert.equal(await button.textContent(), 'Switch on');
    await settled(page);
  });
});

test('the button below the shape switches its mode; a pole can be added by hand, by keyboard too', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const chosen = () => page.evaluate(() => window.hydrapod.identification.chosen().length);
    const all = await chosen();
    const { mark } = await loneMark(page);
    await clickMark(page, mark);
    assert.equal(await chosen(), all, 'a click alone switches nothing');
    const button = page.locator('[data-control="selected-switch"]');
    await button.click();
    assert.equal(await chosen(), all - 1);
    await button.click();
    assert.equal(await chosen(), all);
    // by hand: a pole that belongs to no mode
    const order = await pressByHand(page, 'hand-switch');
    assert.equal(await chosen(), all + 1);
    const last = page.locator('#identification .identified tbody tr').last();
    assert.match(await last.textContent(), new RegExp(`by hand, order ${order}`));
    await settled(page);
    assert.ok((await error(page)) <= found.fit_error * (1 + same));
    await page.click('[data-control="as-found"]');
    assert.equal(await chosen(), all);
  });
});

test('Reset takes out the poles that were added, and Switch off afterwards leaves the identified ones in the list', async () => {
  await withKeptPage(page_of(), still, async (page) => {
    const chosen = () => page.evaluate(() => window.hydrapod.identification.chosen());
    const identified = await chosen();
    const rows = page.locator('#identification .identified tbody tr');
    const button = page.locator('[data-control="selected-switch"]');
    await pressByHand(page, 'hand-switch');
    assert.equal(await rows.count(), identified.length + 1);
    await rows.last().locator('[data-shape]').click(); // the added pole is the one whose shape is shown
    await page.click('[data-control="as-found"]');
    assert.deepEqual(await chosen(), identified);
    assert.equal(await button.textContent(), 'Add to the fit');
    await button.click();
    assert.equal((await chosen()).length, identified.length + 1);
    assert.equal(await button.textContent(), 'Switch off');
    await button.click();
    assert.deepEqual(await chosen(), identified, 'no identified pole was taken out');
    assert.equal(await rows.count(), identified.length);
    await page.locator('#identification [data-shape="0"]').click();
    await button.click();
    assert.equal((await chosen()).length, identified.length - 1);
    await page.click('[data-control="as-found"]');
    assert.deepEqual(await chosen(), identified, 'a mode that was switched off is on again');
    await settled(page);
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
      const decimals = rows[r][1].split('.')[1].length;
      assert.equal(rows[r][0].split('.')[1].length, decimals, `${rows[r][0]} and ${rows[r][1]} end at the same place`);
      near(Number(rows[r][0]), mode.frequency_hz, 0.51 * 10 ** -decimals, 'Hz');
      near(Number(rows[r][1]), mode.frequency_95_hz, 0.051 * mode.frequency_95_hz, '± Hz');
      const digits = /\.(\d+) %/.exec(rows[r][3])[1].length;
      assert.equal(/\.(\d+) %/.exec(rows[r][2])[1].length, digits, `${rows[r][2]} and ${rows[r][3]}`);
      near(Number.parseFloat(rows[r][2]), 100 * mode.damping_ratio, 0.51 * 10 ** -digits, 'damping');
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

for (const [name, options] of [['wide', still], ['on a phone', phone]])
  test(`no finding of axe, nothing overflows: ${name}`, async () => {
    await withKeptPage(page_of(), options, isAccessible);
  });

test('a short record, identified as a whole: the fit of the program, and why the page makes no other', async () => {
  const record = temporary('short.h5');
  hydrapod('rig', published, '--entry', 'wrench', '--excite', 'noise all=200, to=60', '--duration', '10 s', '-o', record);
  const whole = json('identify', record, '--machine', published);
  assert.ok(whole.findings.some(({ kind }) => kind === 'short_record'), 'identified as a whole');
  assert.ok(whole.modes.length > 0);
  await withPage(report(published, '--measured', record), still, async (page) => {
    await settled(page);
    const text = await page.locator('#identification').textContent();
    assert.match(text, /Poles cannot be switched: the modes were fitted to the spectra of the whole record/);
    for (const control of ['[data-pole]', '[data-control="as-found"]', '[data-control="hand-switch"]', '[data-control="selected-switch"]'])
      assert.equal(await page.locator(`#identification ${control}`).count(), 0, control);
    near(await error(page), whole.fit_error, 1e-12, 'error');
    const { frequency_hz } = await page.evaluate(() => window.hydrapod.report.identification.responses);
    for (const [o, i] of [[0, 0], [2, 2], [0, 4]]) {
      const drawn = await page.evaluate(([out, inp]) => window.hydrapod.identification.fitted(out, inp), [o, i]);
      const expected = frequency_hz.map((f) => synthesised(o, i, f, whole));
      const largest = Math.max(...expected.map((h) => Math.hypot(h.re, h.im)));
      expected.forEach((h, k) => near(Math.hypot(drawn[k].re - h.re, drawn[k].im - h.im), 0, 1e-9 * largest, `(${o}, ${i}) at ${frequency_hz[k]} Hz`));
    }
    await page.locator('#identification [data-shape="0"]').click();
    assert.match(await page.locator('.moving-shape .caption').textContent(), /^Mode 1:/);
  });
});

/** Errors that are stated twenty times too small: the modes do not explain the responses. */
test('a warning of the identification is framed, as large as the text, and named', async () => {
  const lacking = responses('lacking.json', json('modes', published, '--model', 'rigid').modes, { damping, deviation });
  const frf = JSON.parse(readFileSync(lacking, 'utf8'));
  for (const { re } of frf.noise.flat()) re.forEach((value, k) => (re[k] = value / 400));
  writeFileSync(lacking, JSON.stringify(frf));
  const { warnings } = json('identify', lacking);
  assert.ok(warnings.length > 0, 'the program warns');
  await withPage(report(published, '--model', 'rigid', '--measured', lacking), still, async (page) => {
    const shown = page.locator('.warning');
    assert.deepEqual(await shown.allTextContents(), warnings.map((text) => `Warning: ${text}`));
    for (const colorScheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme });
      const style = await shown.first().evaluate((e) => {
        const { borderTopWidth, fontSize, color } = getComputedStyle(e);
        const { fontSize: own, color: text } = getComputedStyle(document.body);
        return { borderTopWidth, size: [fontSize, own], colour: [color, text] };
      });
      assert.equal(style.borderTopWidth, '2px');
      assert.equal(...style.size);
      assert.equal(...style.colour);
    }
    await isAccessible(page);
  });
});
