// What is printed: the machine and the pose that are shown, wherever the reader is and however wide the window.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { json, model, published, report, still, withPage } from './support.mjs';

const heavy = model('heavy-platform.toml');
const twoPoses = () => report(heavy, '--pose', 'neutral', '--pose', 'low');

const begin = async (page) => {
  await page.evaluate(() => dispatchEvent(new Event('beforeprint'))); // as a browser does before it prints
  await page.emulateMedia({ media: 'print' });
};
const end = async (page) => {
  await page.emulateMedia({ media: 'screen' });
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
};

const change = (page, ...values) =>
  page.evaluate(async (all) => {
    const { whatIf, bode, workspace } = window.hydrapod;
    await whatIf.ready;
    whatIf.replace(all);
    await whatIf.shown();
    await bode.ready;
    await workspace.ready;
    await workspace.complete();
  }, values);

const printed = (page, selector) => page.locator(selector).innerText();
const footer = (page) => page.evaluate(() => [...document.styleSheets[0].cssRules].at(-1).cssText);

/** Messages to the core can be held back: it never answers meanwhile. */
const holding = `
  const held = [];
  const post = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (...words) {
    const send = () => post.apply(this, words);
    if (window.hold) held.push(send);
    else send();
  };
  window.letGo = () => {
    window.hold = false;
    held.splice(0).forEach((send) => send());
  };
`;

test('the map is there without scrolling; what is not ready says so on paper', async () => {
  await withPage(twoPoses(), { ...still, launch: holding, idle: true }, async (page) => {
    await page.waitForFunction(() => document.querySelector('#workspace.calculated'));
    assert.equal(await page.evaluate(() => scrollY), 0);
    await page.evaluate(() => window.hydrapod.workspace.complete());
    await page.evaluate(() => {
      window.hold = true;
      window.hydrapod.state.choosePose(1);
    });
    await begin(page);
    const notYet = /was not calculated yet when this page was printed/;
    assert.match(await printed(page, '#bode'), notYet);
    assert.match(await printed(page, '#workspace'), notYet);
    assert.equal(await page.locator('#bode svg:visible, #workspace svg:visible').count(), 0, 'nothing of the pose before');
    assert.doesNotMatch(await printed(page, 'main'), /calculated …/);
    await page.evaluate(async () => {
      window.letGo();
      await window.hydrapod.bode.ready;
    });
    await page.waitForFunction(() => document.querySelector('#workspace.calculated'));
    assert.doesNotMatch(await printed(page, 'main'), notYet);
    assert.equal(await page.locator('#bode svg:visible').count(), 1);
    assert.ok(await page.locator('#workspace .heat-map').isVisible());
    await end(page);
  });
});

test('a print with changed values is one of the machine that is shown, and lists them', async () => {
  await withPage(twoPoses(), still, async (page) => {
    await change(page); // nothing; the map is there
    await begin(page);
    const before = await printed(page, '#report');
    const name = await footer(page);
    assert.doesNotMatch(before + name, /changed value/);
    await end(page);
    await change(page, ['platform.mass', 9000], ['legs.rod.mass', 50]);
    await begin(page);
    assert.match(await printed(page, '.top'), /Machine: nominal, with 2 changed values; pose neutral/);
    assert.match(await footer(page), /nominal, with 2 changed values · pose neutral · hydrapod/);
    assert.deepEqual(await page.locator('#answer .changes li:visible').allInnerTexts(), [
      'platform.mass 9 t (report: 14 t)',
      'legs.rod.mass 50 kg (report: 23 kg)',
    ]);
    for (const id of ['modes', 'workspace', 'bode'])
      assert.match(await printed(page, `#${id}-title`), /: pose neutral, with 2 changed values$/);
    assert.match(await printed(page, '#check-title'), /: pose neutral, the machine of the report, unchanged$/);
    assert.match(await printed(page, '#about-title'), /: the machine of the report, unchanged$/);
    const { modes } = json('modes', heavy, '--set', 'platform.mass=9000', '--set', 'legs.rod.mass=50');
    const captions = await page.locator('#pictures figcaption strong').allInnerTexts();
    assert.equal(await page.locator('#pictures h3').allInnerTexts().then(String), 'Pose neutral, with 2 changed values');
    assert.ok(captions.length >= 3);
    for (const caption of captions) {
      const [, number, hertz] = /^Mode (\d+): ([\d.]+) Hz/.exec(caption);
      assert.equal(hertz, modes[number - 1].frequency_hz.toFixed(3));
    }
    const texts = await page.locator('#bode figure text').allTextContents();
    assert.ok(texts.includes('Changed: platform.mass 9 t (report: 14 t); legs.rod.mass 50 kg (report: 23 kg)'), texts.join('|'));
    await end(page);
    await change(page);
    await begin(page);
    assert.equal(await printed(page, '#report'), before, 'of the report again');
    assert.equal(await footer(page), name);
    await end(page);
  });
});

test('a print of several poses names the pose, and has the lowest modes of all', async () => {
  await withPage(twoPoses(), still, async (page) => {
    await page.locator('[data-pose="1"]').click();
    await page.evaluate(() => window.hydrapod.bode.ready);
    assert.equal(await page.locator('.poses-table').isVisible(), false, 'the buttons are for the screen');
    await begin(page);
    for (const id of ['modes', 'check', 'bode', 'workspace']) assert.match(await printed(page, `#${id}-title`), /: pose low$/);
    assert.match(await printed(page, '#answer'), /At the pose low: Lowest mode/);
    assert.match(await printed(page, '.top'), /Machine: nominal; pose low\n/);
    assert.match(await footer(page), /nominal · pose low · hydrapod/);
    const rows = await page.locator('.poses-table tbody tr').allInnerTexts();
    const answers = await page.evaluate(() => window.hydrapod.report.poses.map(({ pose, answer }) => [pose.name, answer]));
    assert.deepEqual(
      rows.map((row) => row.split('\t').slice(0, 3)),
      answers.map(([name, { frequency_hz: hertz, directions }]) => [name, hertz.toFixed(3), directions]),
    );
    await end(page);
  });
});

test('one pose: no heading and no table names it', async () => {
  await withPage(report(published), still, async (page) => {
    await begin(page);
    assert.equal(await printed(page, '#modes-title'), 'Modes');
    assert.equal(await page.locator('.poses-table').count(), 0);
    assert.doesNotMatch(await printed(page, '.top') + (await footer(page)), /pose/);
    await end(page);
    await page.evaluate(async () => {
      const { whatIf, workspace } = window.hydrapod;
      await whatIf.ready;
      workspace.displace([0.02, 0, 0, 0, 0, 0]);
      await whatIf.shown();
    });
    await begin(page);
    assert.match(await printed(page, '.top'), /; pose x=20 mm\n/);
    assert.match(await footer(page), / · pose x=20 mm · hydrapod/);
    await end(page);
    assert.doesNotMatch(await printed(page, '.top'), /pose/, 'on the screen other parts say it');
  });
});

test('a print from a narrow window has tables and diagrams as wide as the paper', async () => {
  await withPage(twoPoses(), { ...still, viewport: { width: 360, height: 740 } }, async (page) => {
    await page.evaluate(() => window.hydrapod.workspace.ready.then(() => window.hydrapod.workspace.complete()));
    await page.waitForFunction(() => document.querySelector('#modes .stacked') !== null);
    const width = () => page.locator('.heat-map').evaluate((e) => e.viewBox.baseVal.width);
    const narrow = await width();
    assert.ok(narrow < 360, `${narrow} px`);
    await begin(page);
    await page.evaluate(() => (document.getElementById('report').style.width = '688px'));
    const rows = await page.locator('#modes tbody tr, .check-legs tbody tr').evaluateAll((all) => all.map((e) => getComputedStyle(e).display));
    assert.deepEqual([...new Set(rows)], ['table-row']);
    assert.equal(await width(), 680);
    await page.evaluate(() => (document.getElementById('report').style.width = ''));
    await end(page);
    assert.equal(await width(), narrow, 'afterwards as before');
  });
});

test('unstable modes have no frequency, also in pictures and where they are folded', async () => {
  const words = [heavy, '--set', 'legs.piston_ring.stiffness=2e6 N/m', '--modes', '1-8'];
  await withPage(report(...words), still, async (page) => {
    const modes = await page.evaluate(() => window.hydrapod.state.pose.modes);
    assert.ok(modes[0].stable === false && modes.some((mode) => !mode.stable && !mode.moves_platform));
    await begin(page);
    const captions = await page.locator('#pictures figcaption strong').allInnerTexts();
    captions.forEach((caption, k) => assert.ok(modes[k].stable || caption === `Mode ${k + 1}: unstable`, caption));
    const hidden = modes.filter((mode) => !mode.moves_platform);
    const lowest = Math.min(...hidden.filter((mode) => mode.stable).map((mode) => mode.frequency_hz));
    const fold = await printed(page, '#modes .fold');
    assert.ok(fold.endsWith(`, ${hidden.filter((mode) => !mode.stable).length} unstable`), fold);
    assert.ok(fold.includes(`from ${lowest.toFixed(lowest < 100 ? 3 : 2)} to`), fold);
    assert.doesNotMatch(await printed(page, '#modes'), /−100\.0 %/);
    await end(page);
  });
});

test('long names do not fill the foot of the page', async () => {
  const title = 'Hydraulic motion platform of the flight simulator in building 17, hall B, serial number HX-2026-00417/rev. C';
  await withPage(report(published, '--title', title, '--set', 'environment.gravity=9.81', '--set', 'platform.mass=900.125', '--set', 'legs.rod.mass=7.125'), still, async (page) => {
    const [, text] = /content: "(.*?)";/.exec(await footer(page));
    assert.ok(text.startsWith('Hydraulic motion platform of the flight') && text.length < 150, text);
    assert.match(text, /… · nominal, with .*… · hydrapod \d.* · \d{4}-\d\d-\d\d$/);
    await change(page, ['platform.mass', 900]);
    assert.match(await footer(page), / · nominal, with .*…, with 1 changed value · hydrapod/);
  });
});
