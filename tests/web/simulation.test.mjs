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
} from './support.mjs';
import { command, longPage, peak, samples } from './long_run.mjs';

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

test('directions that hardly move do not fill their diagrams', async () => {
  await withKeptPage(report(published, ...command), still, async (page) => {
    const { spans, motion } = await page.evaluate(() => {
      const { simulation, report: document } = window.hydrapod;
      return { spans: [0, 1, 2, 3, 4, 5].map((k) => simulation.span(k)), motion: document.simulation.trace };
    });
    const most = Math.max(...[...motion.motion, ...motion.command].flat().map(Math.abs)); // m, rad
    spans.forEach(([low, high], k) => {
      const unit = k < 3 ? 1000 : 180 / Math.PI;
      assert.ok(high - low >= 0.0199 * most * unit, `${k}: ${low} … ${high}`);
      const all = [...motion.motion[k], ...motion.command[k]].map((value) => value * unit);
      assert.ok(low < Math.min(...all) && high > Math.max(...all), `the lines of ${k} are whole`);
    });
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
    await page.evaluate(() => document.getElementById('about').scrollIntoView());
    const unseen = await playThrough(page);
    assert.ok(unseen >= 1 && unseen <= 2, `${unseen} frames`);
  });
});

test('of 100,000 samples no peak is lost, and a part is drawn sample by sample', async () => {
  await withKeptPage(longPage(), still, async (page) => {
    const drawn = () => page.evaluate(() => window.hydrapod.simulation.data(2));
    const trace = await page.evaluate(() => {
      const { trace: t } = window.hydrapod.report.simulation;
      return { times: t.time_s, z: t.motion[2] };
    });
    const [times, , z] = await drawn();
    assert.ok(times.length < 3000, `${times.length} points are drawn of the whole run`);
    near(Math.max(...z), 1000 * peak.value, 1e-9, 'highest value');
    near(Math.min(...z), 1000 * Math.min(...trace.z), 1e-9, 'lowest value');
    const at = trace.times[peak.at];
    await page.evaluate((t) => window.hydrapod.simulation.showPart(t - 0.03, t + 0.03), at);
    const [part, , values] = await drawn();
    const begin = trace.times.indexOf(part[0]);
    assert.ok(begin > 0 && part.length >= 100, `${part.length} samples`);
    values.forEach((value, k) => near(value, 1000 * trace.z[begin + k], 1e-9, `sample ${begin + k}`));
    await page.evaluate(() => window.hydrapod.simulation.showPart(0, 60));
  });
});

test('a drag zooms all diagrams, a double click and the buttons bring the whole run back', async () => {
  await withKeptPage(longPage(), still, async (page) => {
    const view = () => page.evaluate(() => window.hydrapod.simulation.view());
    const plot = page.locator('#simulation .u-over').first();
    await plot.scrollIntoViewIfNeeded();
    const box = await plot.boundingBox();
    const y = box.y + box.height / 2;
    await page.mouse.move(box.x + 0.25 * box.width, y);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.5 * box.width, y, { steps: 5 });
    await page.mouse.up();
    const [from, to] = await view();
    near(from, 15, 0.5, 'begin of the part');
    near(to, 30, 0.5, 'end of the part');
    for (const k of [0, 6, 9]) {
      const [times] = await page.evaluate((n) => window.hydrapod.simulation.data(n), k);
      near(times[0], from, 0.1, `diagram ${k}`);
    }
    await page.mouse.dblclick(box.x + 0.5 * box.width, y);
    assert.deepEqual(await view(), [0, 60]);
    await page.locator('[data-control="time-in"]').focus();
    await page.keyboard.press('Enter');
    near((await view())[1] - (await view())[0], 30, 1e-9, 'half of it');
    await page.locator('[data-control="time-whole"]').click();
    assert.deepEqual(await view(), [0, 60]);
  });
});

test('a click shows the machine at this time, with a line there', async () => {
  await withKeptPage(longPage(), still, async (page) => {
    const plot = page.locator('#simulation .u-over').nth(2);
    await plot.scrollIntoViewIfNeeded();
    const box = await plot.boundingBox();
    await page.mouse.click(box.x + 0.75 * box.width, box.y + box.height / 2);
    near(await page.evaluate(() => window.hydrapod.simulation.time()), 45, 0.3, 'time');
    const lines = await page.locator('#simulation .playhead').evaluateAll((all) =>
      all.map((line) => (line.getBoundingClientRect().left - line.parentElement.getBoundingClientRect().left) / line.parentElement.clientWidth),
    );
    assert.equal(lines.length, 10);
    for (const place of lines) near(place, 0.75, 0.01, 'line');
  });
});

test('no finding of axe', async () => {
  await withKeptPage(report(published, ...command), still, async (page) => {
    assert.deepEqual(await findings(page), []);
  });
});
