// How many frames a second diagrams of long runs have.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { longPage, samples } from './long_run.mjs';
import { still, withPage } from './support.mjs';

/**
 * Frames a second while `each` is called before every one of them; the best of some seconds. Other work on the
 * machine does not count: a second is one of the clock, or one that the page's process works.
 */
async function framesPerSecond(page, each) {
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable');
  const worked = async () => (await session.send('Performance.getMetrics')).metrics.find(({ name }) => name === 'ProcessTime').value;
  let best = 0;
  for (let k = 0; k < 5 && best < 30; ++k) {
    const before = await worked();
    const [frames, seconds] = await page.evaluate(`(async () => {
      const begin = performance.now();
      let k = 0;
      for (; performance.now() - begin < 1500; ++k) {
        ${each}
        await new Promise((done) => requestAnimationFrame(done));
      }
      return [k, (performance.now() - begin) / 1000];
    })()`);
    best = Math.max(best, frames / Math.min(seconds, (await worked()) - before));
  }
  await session.detach();
  return best;
}

test('100,000 samples zoom, move and play at 30 frames a second', async () => {
  await withPage(longPage(), { ...still, viewport: { width: 1400, height: 1000 } }, async (page) => {
    await page.locator('#simulation .histories').scrollIntoViewIfNeeded();
    const zoom = await framesPerSecond(
      page,
      'const w = 30 * (1.02 + Math.cos(k / 20)); window.hydrapod.simulation.showPart(30 - w, 30 + w * Math.abs(Math.cos(k / 33)));',
    );
    assert.ok(zoom >= 30, `zoom: ${zoom.toFixed(1)} frames a second`);
    const move = await framesPerSecond(page, 'const t = (k / 4) % 40; window.hydrapod.simulation.showPart(t, t + 20);');
    assert.ok(move >= 30, `move: ${move.toFixed(1)} frames a second`);
    // a part that goes along with the time; the picture, which software draws here, is out of sight
    await page.evaluate(() => {
      window.hydrapod.simulation.setTime(0);
      window.hydrapod.simulation.showPart(0, 2);
      document.querySelector('[data-control="run"]').click();
    });
    const play = await framesPerSecond(page, '');
    const [from] = await page.evaluate(() => window.hydrapod.simulation.view());
    const time = await page.evaluate(() => window.hydrapod.simulation.time());
    assert.ok(time > 0 && from <= time && from > 0 === time > 2, `at ${time} s the part begins at ${from} s`);
    assert.ok(play >= 30, `play: ${play.toFixed(1)} frames a second`);
    console.log(`# ${samples} samples: zoom ${zoom.toFixed(0)}, move ${move.toFixed(0)}, play ${play.toFixed(0)} frames a second`);
  });
});

test('a machine that moves is drawn 30 times a second by software, and sharp when it stands', async () => {
  await withPage(longPage(), { ...still, viewport: { width: 1400, height: 1000 } }, async (page) => {
    const canvas = page.locator('#simulation canvas.machine');
    await canvas.scrollIntoViewIfNeeded();
    const pixels = () => canvas.evaluate((element) => [element.width, element.clientWidth]);
    const [sharp, width] = await pixels();
    assert.ok(sharp >= width, `${sharp} pixels for a width of ${width}`);
    await page.evaluate(() => {
      window.hydrapod.simulation.setTime(0);
      document.querySelector('[data-control="run"]').click();
    });
    // frames that were drawn, by the clock: the process that draws is not the page's
    let best = 0;
    for (let k = 0; k < 5 && best < 30; ++k)
      best = Math.max(
        best,
        await page.evaluate(async () => {
          const begin = performance.now();
          let frames = 0;
          for (; performance.now() - begin < 2000; ++frames) await new Promise((done) => requestAnimationFrame(done));
          return (1000 * frames) / (performance.now() - begin);
        }),
      );
    const [moving] = await pixels();
    assert.ok(best >= 30, `${best.toFixed(1)} frames a second at ${moving} of ${sharp} pixels`);
    await page.evaluate(() => document.querySelector('[data-control="run"]').click());
    await page.waitForFunction((wanted) => document.querySelector('#simulation canvas.machine').width === wanted, sharp);
    console.log(`# ${best.toFixed(0)} frames a second at ${moving} of ${sharp} pixels`);
  });
});
