// Check and capability on the page: the numbers of `hydrapod check`.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';
import { findings, json, model, published, report, still, withPage } from './support.mjs';

const heavy = model('heavy-platform.toml');

/** Text of the cells of the table of legs, by its titles. */
const legs = (page) =>
  page.locator('#check table').evaluate((table) => {
    const text = (row) => [...row.cells].map((cell) => cell.textContent.replaceAll('−', '-'));
    const [titles, ...rows] = [...table.rows].map(text);
    return rows.map((cells) => Object.fromEntries(titles.map((title, k) => [title, cells[k]])));
  });

test('each kind of limit has a colour of its own', async () => {
  await withPage(report(published), still, async (page) => {
    const fills = await page.evaluate(() =>
      ['oil', 'column', 'valve', 'pump', 'stroke', 'joint', 'motor', 'other'].map((family) => {
        const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
        const bar = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
        bar.setAttribute('class', `limit-${family}`);
        svg.append(bar);
        document.body.append(svg);
        return getComputedStyle(bar).fill;
      }),
    );
    assert.ok(!fills.includes('rgb(0, 0, 0)'), fills.join('; '));
    assert.equal(new Set(fills).size, fills.length);
  });
});

test('legs, verdict and limits are those of the command, at each pose', async () => {
  const poses = ['z=-260 mm', 'x=30 mm, z=-310 mm, rz=2 deg'];
  await withPage(report(heavy, ...poses.flatMap((pose) => ['--pose', pose])), still, async (page) => {
    for (const [number, pose] of poses.entries()) {
      await page.evaluate((k) => window.hydrapod.state.choosePose(k), number);
      const expected = json('check', heavy, '--pose', pose).poses[0];
      const shown = await legs(page);
      assert.equal(shown.length, 6);
      expected.legs.forEach((leg, i) => {
        assert.equal(shown[i]['length, mm'], (1e3 * leg.length_m).toFixed(1));
        assert.equal(shown[i]['force at rest, kN'], (1e-3 * leg.axial_force_N).toFixed(2));
        assert.equal(shown[i]['stroke left out, mm'], (1e3 * leg.extend_left_m).toFixed(1));
        assert.equal(shown[i]['oil can pull, kN'], (1e-3 * leg.largest_pull_N).toFixed(1));
      });
      const pictures = await page.locator('#check .ability svg').evaluateAll((all) => all.map((one) => one.getAttribute('aria-label')));
      const kilonewton = (reach) => String(Number((1e-3 * Math.abs(reach.value)).toPrecision(3)));
      const [x] = expected.capability.directions;
      assert.ok(pictures[0].includes(`x ${kilonewton(x.force[0])} and ${kilonewton(x.force[1])}`), pictures[0]);
    }
    assert.match(await page.locator('.check-verdict').innerText(), /^Sound at all 2 poses\.$/);
    assert.deepEqual(await findings(page), [], 'axe finds nothing');
  });
});

test('a machine that is not sound is not called sound', async () => {
  await withPage(report(heavy, '--set', 'platform.mass=80 t'), still, async (page) => {
    const words = ['check', heavy, '--set', 'platform.mass=80 t', '--pose', 'neutral', '--format', 'json'];
    const { status, stdout } = spawnSync(process.env.HYDRAPOD_PROGRAM, words, { encoding: 'utf8' });
    assert.notEqual(status, 0, 'it is not sound');
    const { warnings } = JSON.parse(stdout).poses[0];
    assert.match(await page.locator('.check-verdict.problem').innerText(), /^Not sound/);
    assert.deepEqual(await page.locator('.check-warnings li').allInnerTexts(), warnings);
  });
});
