// The simulated run: histories and the moving machine against the command line's JSON.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
  findings,
  json,
  near,
  published,
  report,
  still,
  withKeptPage,
  withPage,
} from './support.mjs';

const command = ['--command', 'sine z=4 mm, ry=1 deg, frequency=2 Hz, fade=0.2 s', '--until', '0.6'];

/** R = Rz Ry Rx about the platform's origin, written out here on its own. */
function jointAt(leg, platform, d) {
  const [rx, ry, rz] = d.slice(3);
  const rotate = (p) => {
    const x = [p[0], p[1] * Math.cos(rx) - p[2] * Math.sin(rx), p[1] * Math.sin(rx) + p[2] * Math.cos(rx)];
    const y = [x[0] * Math.cos(ry) + x[2] * Math.sin(ry), x[1], -x[0] * Math.sin(ry) + x[2] * Math.cos(ry)];
    return [y[0] * Math.cos(rz) - y[1] * Math.sin(rz), y[0] * Math.sin(rz) + y[1] * Math.cos(rz), y[2]];
  };
  const arm = leg.platform_joint_m.map((v, i) => v - platform.origin_m[i]);
  return rotate(arm).map((v, i) => v + platform.origin_m[i] + d[i]);
}

test('the machine stands where the run has it, piston and all', async () => {
  await withKeptPage(report(published, ...command), still, async (page) => {
    const run = await page.evaluate(() => window.hydrapod.report.simulation);
    const { trace, geometry } = run;
    for (const time of [0, 0.137, 0.31, 0.55]) {
      const k = Math.round((time - trace.time_s[0]) / (trace.time_s[1] - trace.time_s[0]));
      const d = trace.motion.map((values) => values[k]);
      for (const number of [1, 4]) {
        const drawn = await page.evaluate(
          ([t, leg]) => {
            window.hydrapod.simulation.setTime(t);
            return window.hydrapod.simulation.jointPositions(leg);
          },
          [time, number],
        );
        const leg = geometry.legs[number - 1];
        const joint = jointAt(leg, geometry.platform, d);
        joint.forEach((value, i) => near(drawn.joint[i], value, 1e-6, `joint ${number} at ${time} s`));
        // without gravity and at this speed the legs hardly bend: the simulated piston is there too
        const along = Math.hypot(...drawn.piston.map((v, i) => v - drawn.base[i]));
        near(along, trace.piston_m[number - 1][k], 2e-5, `piston ${number} at ${time} s`);
      }
    }
  });
});

test('the run is that of hydrapod simulate', async () => {
  const expected = json('simulate', published, ...command);
  await withKeptPage(report(published, ...command), still, async (page) => {
    const run = await page.evaluate(() => window.hydrapod.report.simulation);
    assert.deepEqual(run.commands, expected.commands);
    const last = (trace) => trace.motion.map((values) => values.at(-1));
    last(run.trace).forEach((value, i) => near(value, last(expected.trace)[i], 1e-12, `end ${i}`));
    assert.equal(await page.locator('#simulation .uplot').count(), 10);
  });
});

test('it plays to its end, and the slider shows a moment', async () => {
  await withKeptPage(report(published, ...command), still, async (page) => {
    const play = page.locator('[data-control="run"]');
    await play.click();
    await page.waitForFunction(() => window.hydrapod.simulation.time() > 0.59, null, {
      timeout: 20000,
    });
    await page.waitForFunction(
      () => document.querySelector('[data-control="run"]').textContent === 'Play',
    );
    const slider = page.locator('[data-control="run-time"]');
    await slider.fill('100');
    const shown = await page.evaluate(() => window.hydrapod.simulation.time());
    const wanted = await page.evaluate(() => window.hydrapod.report.simulation.trace.time_s[100]);
    assert.equal(shown, wanted);
  });
});

/** Plays the run from its beginning to its end; the frames that it drew. */
const playThrough = (page) =>
  page.evaluate(async () => {
    const { simulation } = window.hydrapod;
    const frame = () => new Promise((done) => requestAnimationFrame(done));
    const play = document.querySelector('[data-control="run"]');
    const last = window.hydrapod.report.simulation.trace.time_s.at(-1);
    simulation.setTime(0);
    for (let i = 0; i < 3; ++i) await frame(); // it is seen where the page stands now
    const before = simulation.frames();
    play.click();
    while (play.textContent !== 'Play' || simulation.time() < last) await frame();
    for (let i = 0; i < 3; ++i) await frame();
    return simulation.frames() - before;
  });

test('out of sight it goes on without pictures but the last one', async () => {
  await withKeptPage(report(published, ...command), still, async (page) => {
    await page.evaluate(() => document.getElementById('simulation').scrollIntoView());
    const seen = await playThrough(page);
    assert.ok(seen >= 6, `${seen} frames, 0.1 s of the run each at most`);
    await page.evaluate(() => document.getElementById('mechanism').scrollIntoView());
    const unseen = await playThrough(page);
    assert.ok(unseen >= 1 && unseen <= 2, `${unseen} frames`);
  });
});

test('no finding of axe, and no section without a run', async () => {
  await withKeptPage(report(published, ...command), still, async (page) => {
    assert.deepEqual(await findings(page), []);
  });
  await withPage(report(published), still, async (page) => {
    assert.equal(await page.locator('#simulation').count(), 0);
  });
});
