// Many drags: each gives the numbers of the command line, and nothing is kept of them.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';
import { model, near, random, report, still, withPage } from './support.mjs';

const { HYDRAPOD_PROGRAM } = process.env;
const heavy = model('heavy-platform.toml');

/** Frequencies by the program [rad/s]; null where it refuses the machine. */
function frequencies(words) {
  const { stdout } = spawnSync(HYDRAPOD_PROGRAM, ['modes', heavy, ...words, '--format', 'json'], { encoding: 'utf8', maxBuffer: 1 << 26 });
  return stdout.startsWith('{') ? JSON.parse(stdout).modes.map((mode) => mode.omega_rad_s) : null;
}

test('200 drags of sliders and of the pose show the numbers of the command line', async () => {
  await withPage(report(heavy), still, async (page) => {
    await page.evaluate(async () => {
      await window.hydrapod.whatIf.ready;
      await window.hydrapod.workspace.ready;
    });
    const values = await page.evaluate(() => window.hydrapod.whatIf.values());
    const paths = Object.keys(values).filter((path) => values[path] !== 0 && !/^(controller|sensors|supply|poses|leg\.)/.test(path));
    const next = random(2411);
    let compared = 0;
    for (let k = 0; k < 200; ++k) {
      const path = paths[Math.floor(next() * paths.length)];
      const value = values[path] * (0.85 + 0.3 * next());
      const z = -(0.2 + 0.2 * next());
      const x = 0.05 * next();
      const { omega, commanded } = await page.evaluate(
        async ([path, value, displaced]) => {
          const { whatIf, workspace, state } = window.hydrapod;
          whatIf.drag(path, value);
          workspace.displace(displaced);
          whatIf.keep();
          await whatIf.shown();
          return { omega: state.pose.modes.map((mode) => mode.omega_rad_s), commanded: whatIf.overrides(whatIf.changed()) };
        },
        [path, value, [x, 0, z, 0, 0, 0]],
      );
      const expected = frequencies(['--pose', `x=${1e3 * x} mm, z=${1e3 * z} mm`, ...commanded.flatMap((text) => ['--set', text])]);
      if (expected) {
        ++compared;
        expected.forEach((one, m) => near(omega[m], one, 1e-12 * one, `drag ${k}, ${path}=${value}, mode ${m + 1}`));
      }
      // twenty values at once would be no machine any more
      if (k % 4 === 3) await page.evaluate(() => window.hydrapod.whatIf.replace([]));
    }
    assert.ok(compared > 120, `${compared} of 200 machines can be`);
  });
});

test('memory stays over 1000 drags', async () => {
  await withPage(report(heavy), still, async (page) => {
    const devtools = await page.context().newCDPSession(page);
    await devtools.send('Performance.enable');
    const used = async () => {
      await devtools.send('HeapProfiler.collectGarbage');
      const { metrics } = await devtools.send('Performance.getMetrics');
      return Object.fromEntries(metrics.map(({ name, value }) => [name, value]));
    };
    const drag = (from, to) =>
      page.evaluate(
        async ([from, to]) => {
          const { whatIf, workspace } = window.hydrapod;
          await whatIf.ready;
          await workspace.ready;
          for (let k = from; k < to; ++k) {
            whatIf.drag('legs.guide_sleeve.stiffness', 1e6 * (1 + 0.3 * Math.sin(k)));
            workspace.displace([0.01 * Math.cos(k), 0, -0.25, 0, 0, 0]);
            await new Promise((resolve) => requestAnimationFrame(resolve));
          }
          whatIf.replace([]);
          workspace.displace(null);
          await whatIf.shown();
        },
        [from, to],
      );
    await drag(0, 200);
    const before = await used();
    await drag(200, 1200);
    const after = await used();
    assert.ok(after.JSHeapUsedSize < 1.1 * before.JSHeapUsedSize + 1e6, `${before.JSHeapUsedSize} → ${after.JSHeapUsedSize} bytes`);
    assert.ok(after.Nodes < 1.1 * before.Nodes + 200, `${before.Nodes} → ${after.Nodes} nodes`);
    assert.ok(after.JSEventListeners < 1.1 * before.JSEventListeners + 50, `${before.JSEventListeners} → ${after.JSEventListeners} listeners`);
  });
});
