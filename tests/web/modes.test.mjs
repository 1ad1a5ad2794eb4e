// The mode table: numbers, sorting, folding, repeated modes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { damped, json, model, near, published, report, still, withKeptPage, withPage } from './support.mjs';

const numbersShown = (page) =>
  page.$$eval('#modes [data-row]', (rows) => rows.map((row) => Number(row.dataset.row)));

test('shows what the command line prints', async () => {
  const { modes } = json('modes', published);
  await withKeptPage(report(published), still, async (page) => {
    assert.deepEqual(
      await page.evaluate(() => window.hydrapod.report.poses[0].modes),
      modes,
      'the report holds the JSON of `hydrapod modes`',
    );
    for (const mode of modes.filter((m) => m.moves_platform)) {
      const row = page.locator(`[data-row="${mode.number}"]`);
      near(
        Number(await row.locator('.col-frequency').innerText()),
        mode.frequency_hz,
        5.1e-4,
        'frequency',
      );
      const text = await row.locator('.col-motion').textContent();
      assert.ok(text.includes(mode.label), `${text} has the label`);
      const moving = Math.round(100 * mode.platform_energy[0]);
      if (moving > 1) assert.ok(text.includes(`x ${moving} %`), `${text} names the share of x`);
    }
  });
});

test('the answer stands at the top: words and four numbers', async () => {
  const text = json('modes', published);
  await withKeptPage(report(published), still, async (page) => {
    const answer = await page.locator('#answer').innerText();
    const lowest = text.modes.find((mode) => mode.moves_platform);
    for (const part of [
      lowest.frequency_hz.toFixed(3),
      (lowest.rigid.omega_rad_s / (2 * Math.PI)).toFixed(3),
      Math.abs(lowest.rigid.shift_percent).toFixed(2),
      `${Math.round(100 * lowest.strain_energy.oil)} %`,
    ])
      assert.ok(answer.includes(part), `${answer} has ${part}`);
    assert.match(answer, /Lowest mode with platform motion: 7\.445 Hz in x/);
  });
});

test('local seal modes are collapsed into one row', async () => {
  await withKeptPage(report(published), still, async (page) => {
    const modes = await page.evaluate(() => window.hydrapod.report.poses[0].modes);
    const felt = modes.filter((mode) => mode.moves_platform).map((mode) => mode.number);
    assert.ok(felt.length < modes.length);
    assert.deepEqual(await numbersShown(page), felt);
    const fold = page.locator('[data-control="fold"]');
    assert.match(
      await fold.innerText(),
      new RegExp(`${modes.length - felt.length} local seal modes`),
    );
    assert.equal(await fold.getAttribute('aria-expanded'), 'false');
    await fold.click();
    assert.equal((await numbersShown(page)).length, modes.length);
    assert.equal(await fold.getAttribute('aria-expanded'), 'true');
    await fold.click();
    assert.deepEqual(await numbersShown(page), felt);
  });
});

test('sorts by every column, both ways, and tells it', async () => {
  await withKeptPage(report(published), still, async (page) => {
    const initial = await numbersShown(page);
    assert.deepEqual(
      initial,
      [...initial].sort((a, b) => a - b),
    );
    const keys = await page.$$eval('[data-sort]', (heads) =>
      heads.map((head) => head.dataset.sort),
    );
    assert.deepEqual(keys, [
      'number',
      'frequency',
      'omega',
      'damping',
      'motion',
      'energy',
      'rigid',
      'shift',
      'mac',
    ]);
    const modes = await page.evaluate(() => window.hydrapod.report.poses[0].modes);
    const of = (number) => modes.find((mode) => mode.number === number);
    const key = {
      mac: (m) => m.rigid?.mac ?? -1,
      frequency: (m) => m.omega_rad_s,
      energy: (m) => m.strain_energy.oil,
    };
    for (const [name, value] of Object.entries(key))
      for (const [order, sign] of [
        ['ascending', 1],
        ['descending', -1],
      ]) {
        await page.click(`[data-sort="${name}"]`);
        const shown = (await numbersShown(page)).map((number) => sign * value(of(number)));
        assert.deepEqual(
          shown,
          [...shown].sort((a, b) => a - b),
          `${name}, ${order}`,
        );
        const head = page.locator('th', { has: page.locator(`[data-sort="${name}"]`) });
        assert.equal(await head.getAttribute('aria-sort'), order);
      }
  });
});

test('repeated pairs are shown as such', async () => {
  await withPage(report(model('zhang-jiang-2021-transverse.toml')), still, async (page) => {
    const modes = await page.evaluate(() => window.hydrapod.report.poses[0].modes);
    const [first, second] = modes;
    assert.equal(first.group, second.group, 'x and y repeat');
    assert.match(await page.locator('[data-row="1"] th').textContent(), /repeats with 2/);
    await page.click('[data-mode="1"]');
    assert.match(await page.locator('.caption').innerText(), /Repeats with mode 2/);
  });
});

test('bars are as long as the shares', async () => {
  await withPage(report(...damped), still, async (page) => {
    const modes = await page.evaluate(() => window.hydrapod.report.poses[0].modes);
    for (const mode of modes.filter((m) => m.moves_platform)) {
      const widths = await page.$$eval(`[data-row="${mode.number}"] .col-energy rect`, (bars) =>
        Object.fromEntries(
          bars.map((bar) => [bar.getAttribute('class'), Number(bar.getAttribute('width'))]),
        ),
      );
      near(widths['part-oil'] ?? 0, 100 * mode.strain_energy.oil, 0.21, 'oil');
      near(widths['part-sleeve'] ?? 0, 100 * mode.strain_energy.guide_sleeve, 0.21, 'sleeve');
      near(widths['part-ring'] ?? 0, 100 * mode.strain_energy.piston_ring, 0.21, 'ring');
    }
  });
});

test('poses can be switched', async () => {
  await withPage(report(published, '--pose', 'neutral', '--pose', 'z=-40 mm'), still, async (page) => {
    const [neutral, lower] = await page.evaluate(() => window.hydrapod.report.poses);
    const shown = async () =>
      Number(await page.locator('[data-row="1"] .col-frequency').innerText());
    near(await shown(), neutral.modes[0].frequency_hz, 5.1e-4, 'neutral');
    await page.click('[data-pose="1"]');
    near(await shown(), lower.modes[0].frequency_hz, 5.1e-4, 'lower');
    assert.notEqual(
      neutral.modes[0].frequency_hz.toFixed(3),
      lower.modes[0].frequency_hz.toFixed(3),
    );
    const joint = await page.evaluate(() => {
      document.querySelector('[data-control="amplitude"]').value = 0;
      document.querySelector('[data-control="amplitude"]').dispatchEvent(new Event('input'));
      window.hydrapod.scene.setPhase(0);
      return window.hydrapod.scene.jointPositions(3).joint;
    });
    lower.geometry.legs[2].platform_joint_m.forEach((x, k) => near(joint[k], x, 1e-9, 'joint'));
  });
});
