// Scatter on the page: the samples of `hydrapod montecarlo`, number by number.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { findings, model, report, rowsOf, sameRow, still, withPage } from './support.mjs';

const heavy = model('heavy-platform.toml');

async function sameSamples(page, vary) {
  const { rows, command } = await page.evaluate(async (vary) => {
    const { scatter } = window.hydrapod;
    await scatter.ready;
    if (vary) scatter.vary(vary);
    await scatter.complete();
    return { rows: scatter.rows(), command: scatter.command() };
  }, vary);
  const expected = rowsOf(command);
  assert.equal(rows.length, expected.length, command);
  rows.forEach((row, k) => sameRow(row, expected[k], `sample ${k}`));
  return { rows, command };
}

test('the samples are those of the command: shared and per leg, with changed values, at another pose', async () => {
  await withPage(report(heavy), still, async (page) => {
    const { command } = await sameSamples(page, null);
    assert.equal(command.match(/--vary/g).length, 3, 'those with the largest effect');
    await page.evaluate(async () => {
      const { whatIf, workspace } = window.hydrapod;
      await whatIf.ready;
      whatIf.replace([['platform.mass', 13579]]);
      workspace.displace([0.02, 0, -0.3, 0, 0, 0]);
      await whatIf.shown();
    });
    const other = await sameSamples(page, [['legs.guide_sleeve.stiffness', 0.12, true], ['platform.mass', 0.03, false]]);
    assert.match(other.command, /--pose 'x=20 mm, z=-300 mm'/);
    assert.match(other.command, /per leg/);
    assert.deepEqual(await findings(page), [], 'axe finds nothing');
  });
});

test('the requirement counts samples without a value as missed', async () => {
  await withPage(report(heavy), still, async (page) => {
    // at the neutral pose softer sleeves buckle
    const { rows } = await sameSamples(page, [['legs.guide_sleeve.stiffness', 0.1, false]]);
    assert.ok(rows.some((row) => row[0] === 4), 'some buckle');
    await page.locator('[data-control="scatter-bound"]').fill('4,05');
    await page.locator('[data-control="scatter-bound"]').press('Enter');
    const missed = rows.filter((row) => !(row[0] === 0 && row[1] >= 4.05)).length;
    await page.getByText(`${missed} of 1000 samples miss the requirement`).waitFor();
    // a parameter that is none, a deviation that is none
    await page.locator('[data-control="scatter-path"]').fill('legs.nothing');
    await page.locator('[data-control="scatter-path"]').press('Enter');
    await page.getByText('legs.nothing: not a parameter').waitFor();
    const deviation = page.locator('[data-deviation="legs.guide_sleeve.stiffness"]');
    await deviation.fill('-3');
    await deviation.press('Enter');
    assert.equal(await deviation.getAttribute('aria-invalid'), 'true');
    await deviation.fill('30');
    await deviation.press('Enter');
    await page.getByText('which the machine cannot have').waitFor();
  });
});

test('a machine without modes has no command, and says why', async () => {
  await withPage(report(heavy, '--set', 'platform.mass=80 t'), still, async (page) => {
    const words = await page.evaluate(async () => {
      const { scatter, workspace } = window.hydrapod;
      await scatter.ready;
      scatter.vary([['platform.mass', 0.02, false]]);
      await scatter.complete();
      await workspace.ready;
      await workspace.complete();
      return [...document.querySelectorAll('#scatter .what-if-command, #workspace .what-if-command')].map((one) => one.textContent);
    });
    assert.equal(words.length, 2);
    for (const text of words) assert.match(text, /^No command has (these samples|this map): .*buckled/);
  });
});
