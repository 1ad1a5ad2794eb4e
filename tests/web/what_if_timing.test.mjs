// The page that calculates, while other things happen: a core that fails, answers that come late.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { startCore } from '../../web/core/module.mjs';
import { damped, model, near, published, report, still, withPage } from './support.mjs';

/** The core answers as it does, but `way` happens to what a map asks of it. */
const failing = (way) => `
  const { Blob: Original } = window;
  window.Blob = class extends Original {
    constructor(parts, options) {
      const worker = \`
        let own;
        Object.defineProperty(self, 'onmessage', { set(f) { own = f; } });
        addEventListener('message', (event) => {
          const { id, call } = event.data;
          if (call !== 'map') return own(event);
          ${way}
        });\`;
      super(options?.type === 'text/javascript' ? [worker, ...parts] : parts, options);
    }
  };`;

const refuses = "postMessage({ id, ok: false, text: 'refused on purpose', milliseconds: 0 });";
const breaks = "throw new Error('refused on purpose');";
const told = /^The page could not calculate: .*refused on purpose\. The results of the program/;

/** Those messages to the core for which `which` is true wait until letGo(); isHeld() resolves when one does. */
const holding = (which) => `{
  let held = [];
  let noted;
  const one = new Promise((resolve) => (noted = resolve));
  const post = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (message, ...more) {
    const { call, text } = message;
    if (!held || !(${which})) return post.call(this, message, ...more);
    held.push(() => post.call(this, message, ...more));
    noted();
  };
  window.isHeld = () => one;
  window.letGo = () => {
    const all = held;
    held = null;
    all.forEach((send) => send());
  };
}`;

for (const [name, way] of [
  ['refuses', refuses],
  ['breaks', breaks],
])
  test(`a core that ${name} is told in one message, and nothing waits for it`, async () => {
    // the map begins by itself: it waits until all sections have begun
    const launch = failing(way) + holding("call === 'map'");
    await withPage(report(published), { ...still, launch, expected: /refused on purpose/ }, async (page) => {
      const words = await page.evaluate(async () => {
        const { whatIf, scatter, workspace } = window.hydrapod;
        await Promise.all([whatIf.ready, scatter.ready, workspace.ready]);
        window.letGo();
        return workspace.complete().then(() => 'complete', (error) => error.message);
      });
      assert.match(words, /refused on purpose/);
      const message = page.locator('.core-failure');
      await message.waitFor();
      assert.equal(await message.count(), 1);
      assert.match(await message.textContent(), told);
    });
  });

test('a core that broke before a section began is told in that section', async () => {
  await withPage(report(published), { ...still, launch: failing(breaks), expected: /refused on purpose/, idle: true }, async (page) => {
    await page.locator('.core-failure').waitFor(); // of the map, which begins by itself
    const why = await page.evaluate(() => window.hydrapod.scatter.ready.catch((error) => error.message));
    assert.match(why, /refused on purpose/);
    assert.match(await page.locator('#scatter .problem', { hasText: 'The page' }).textContent(), told);
    assert.equal(await page.locator('.core-failure').count(), 1);
  });
});

test('what was calculated for another pose is not shown', async () => {
  // the calculation for the rest of the page, which follows that of the section
  const launch = holding("call === 'compute' && JSON.parse(text).points > 0");
  await withPage(report(model('heavy-platform.toml'), '--pose', 'neutral', '--pose', 'low'), { ...still, launch }, async (page) => {
    const names = await page.evaluate(async () => {
      const { whatIf, state } = window.hydrapod;
      await whatIf.ready;
      const names = [];
      state.listen((change) => change === 'numbers' && names.push(state.pose.pose.name));
      whatIf.drag('platform.mass', 9000);
      whatIf.keep();
      const shown = whatIf.shown();
      await window.isHeld();
      window.letGo();
      state.choosePose(1);
      await shown;
      await whatIf.shown();
      return names;
    });
    assert.deepEqual([...new Set(names)], ['low']);
  });
});

test('rows stay where they are while one is used, and get their order afterwards', async () => {
  // the effects of the parameters, which make the order, come when the test lets them
  const launch = `
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (message, ...more) {
      if (message.call === 'sensitivities') {
        const { onmessage } = this;
        this.onmessage = (event) => {
          if (event.data.id === message.id) window.answer = () => onmessage.call(this, event);
          else onmessage.call(this, event);
        };
      }
      return post.call(this, message, ...more);
    };`;
  await withPage(report(published), { ...still, launch }, async (page) => {
    await page.evaluate(() => window.hydrapod.whatIf.ready);
    await page.waitForFunction(() => window.answer);
    const rows = () => page.locator('[data-parameter]').evaluateAll((all) => all.map((row) => row.dataset.parameter));
    const before = await rows();
    const field = page.locator('[data-field="platform.mass"]');
    await field.focus();
    await field.selectText();
    await page.keyboard.type('9');
    await page.evaluate(() => window.answer());
    await page.keyboard.type('00');
    assert.deepEqual(await rows(), before);
    assert.deepEqual(await page.evaluate(() => window.hydrapod.whatIf.changed()), [], 'nothing was entered');
    await page.keyboard.press('Enter');
    await page.evaluate(() => window.hydrapod.whatIf.shown());
    assert.deepEqual(await page.evaluate(() => window.hydrapod.whatIf.changed()), [['platform.mass', 900]]);
    assert.deepEqual(await rows(), before);
    await page.locator('[data-control="parameter-search"]').focus();
    await page.waitForFunction((first) => document.querySelector('[data-parameter]').dataset.parameter !== first, before[0]);
    assert.notDeepEqual(await rows(), before);
    assert.ok((await page.locator('[data-parameter="platform.mass"] .sensitivity-bar').count()) === 1);
  });
});

test('a brief answer has numbers of the whole one', async () => {
  const { editable, poses } = JSON.parse(/id="data">([^<]*)</.exec(readFileSync(report(...damped), 'utf8'))[1]);
  const { core, call, give, taken } = await startCore();
  call('core_open', editable);
  const lines = 290;
  const computed = (more) => {
    const { pose } = JSON.parse(call('core_compute', { set: [['legs.rod.mass', 7.7]], pose: 0, ...more }));
    const { from_rad_s: from, to_rad_s: to } = poses[0].bode;
    give(Float64Array.from({ length: lines }, (_, k) => from * (to / from) ** (k / (lines - 1))));
    return [pose, taken(core.core_sweep())];
  };
  const [whole, all] = computed({ points: 0 });
  const [brief, direct] = computed({ brief: true });
  const picked = (modes) =>
    modes.map(({ number, frequency_hz, stable, platform_energy, rigid }) => ({
      number, frequency_hz, stable, platform_energy, ...(rigid ? { rigid: { mode: rigid.mode, mac: rigid.mac } } : {}),
    }));
  assert.deepEqual(brief, {
    pose: { name: whole.pose.name },
    answer: whole.answer,
    model: whole.model,
    modes: picked(whole.modes),
    rigid_modes: picked(whole.rigid_modes),
  });
  // the direct responses are a sum over modes, the whole ones are not
  assert.equal(direct.length, 24 * lines);
  for (let k = 0; k < 2 * lines; ++k)
    for (let d = 0; d < 6; ++d) {
      const [re, im] = all.subarray(72 * k + 14 * d, 72 * k + 14 * d + 2);
      const apart = Math.hypot(direct[12 * k + 2 * d] - re, direct[12 * k + 2 * d + 1] - im);
      near(apart / Math.hypot(re, im), 0, 1e-12, `line ${k} of both models, direction ${d}`);
    }
});
