// The map of the workspace and the machine at the pose of its cross: numbers of the command line.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { findings, json, model, near, open, published, report, rowsOf, sameRow, still, withPage } from './support.mjs';

const heavy = model('heavy-platform.toml');

/** The finest map of the page. */
const mapped = (page) =>
  page.evaluate(async () => {
    const { workspace } = window.hydrapod;
    await workspace.ready;
    await workspace.complete();
    return { rows: workspace.rows(), command: workspace.command() };
  });

/** Every number of every pose; `across` and `up` are the names of the directions. */
function sameMap({ rows, command }, across, up) {
  const expected = new Map(rowsOf(command).map((row) => [`${row[across].toPrecision(9)} ${row[up].toPrecision(9)}`, row]));
  assert.equal(rows.length, expected.size, command);
  let computed = 0;
  for (const { across: a, up: u, row } of rows) {
    const theirs = expected.get(`${a.toPrecision(9)} ${u.toPrecision(9)}`);
    assert.ok(theirs, `the program has ${across} ${a}, ${up} ${u}`);
    if (row[0] === 0) ++computed;
    sameRow(row, theirs, `${across} ${a}, ${up} ${u}`);
  }
  return computed;
}

test('an angle below the last decimal is shown, one of rounding is zero', async () => {
  await withPage(report(published), still, async (page) => {
    await page.evaluate(() => window.hydrapod.workspace.ready);
    const output = page.locator('#workspace .workspace-poses output').nth(4);
    for (const [degrees, text] of [[0.0012, '0.0012 deg'], [-0.004, '−0.004 deg'], [1e-15, '0.00 deg'], [0.25, '0.25 deg']]) {
      await page.evaluate((angle) => window.hydrapod.workspace.displace([0, 0, 0, 0, angle, 0]), (degrees * Math.PI) / 180);
      assert.equal(await output.textContent(), text);
    }
  });
});

test('the map has the numbers of its command, out of reach alike', async () => {
  await withPage(report(heavy), still, async (page) => {
    const found = await mapped(page);
    const computed = sameMap(found, 'pose.x', 'pose.z');
    assert.ok(computed > 300 && computed < found.rows.length, `${computed} of ${found.rows.length} poses`);
  });
});

test('a drop is said together with what the mode holds of the motion and how high its peak is', async () => {
  await withPage(report(published, '--set', 'environment.gravity=9.81'), still, async (page) => {
    await mapped(page);
    const row = rowsOf(`hydrapod map ${published} --set environment.gravity=9.81 --over "x=-1:1:3 mm" --over "z=-1:1:3 mm"`)[4]; // the middle
    assert.deepEqual([row['pose.x'], row['pose.z']], [0, 0]);
    const drop = (of, motion) =>
      `, drop ${(100 * row[`drop${of}`]).toFixed(2)} % (${(100 * row[`share${of}`]).toFixed(0)} % of the motion${motion}, peak ${row[`peak${of}`].toFixed(2)} times as high)`;
    const words = page.locator('.workspace-words');
    assert.ok((await words.innerText()).includes(drop('', ' with rigid legs')), await words.innerText());
    await page.locator('[data-control="map-value"]').selectOption({ label: 'Drop of the first resonance in x' });
    const first = `; first resonance in x ${row.x.toFixed(3)} Hz${drop('_x', ' in x')}`;
    await page.waitForFunction((text) => document.querySelector('.workspace-words').innerText.includes(text), first);
    assert.ok(row.drop_x > 0.3 && row.share_x < 0.2, `${row.drop_x} ${row.share_x}`); // the paper's third
  });
});

test('of another slice, with changed values', async () => {
  await withPage(report(heavy, '--model', 'rigid'), still, async (page) => {
    await page.evaluate(async () => {
      const { whatIf, workspace } = window.hydrapod;
      await whatIf.ready;
      await workspace.ready;
      whatIf.replace([['platform.mass', 12345.6]]);
      await whatIf.shown();
      workspace.displace([0, 0.017, -0.05, 0, 0, 0]);
      await whatIf.shown();
    });
    await page.locator('[data-control="map-up"]').selectOption({ label: 'rz' });
    const found = await mapped(page);
    assert.match(found.command, /--pose 'y=17 mm, z=-50 mm'/);
    assert.match(found.command, /platform.mass=12345.6/);
    sameMap(found, 'pose.x', 'pose.rz');
  });
});

test('the whole page shows the machine where the cross is, and the address keeps it', async () => {
  const file = report(heavy);
  await withPage(file, still, async (page) => {
    await page.evaluate(async () => {
      const { whatIf, workspace } = window.hydrapod;
      await workspace.ready;
      workspace.displace([0.0123, 0, -0.021, 0, 0.013, 0]);
      await whatIf.ready;
      await whatIf.shown();
    });
    const { name, omega, hash } = await page.evaluate(() => {
      const { pose } = window.hydrapod.state;
      return { name: pose.pose.name, omega: pose.modes.map((mode) => mode.omega_rad_s), hash: location.hash };
    });
    const expected = json('modes', heavy, '--pose', 'x=12.3 mm, z=-21 mm, ry=0.013 rad').modes;
    assert.equal(omega.length, expected.length);
    expected.forEach((mode, k) => near(omega[k], mode.omega_rad_s, 1e-12 * mode.omega_rad_s, `mode ${k + 1} at ${name}`));
    assert.match(await page.locator('#answer').innerText(), /At the pose x=12\.3 mm, z=-21 mm, ry=0\.013 rad/);
    const again = await open(file);
    await again.evaluate((hash) => (location.hash = hash), hash);
    await again.waitForFunction((name) => window.hydrapod.state.pose.pose.name === name, name);
    await again.evaluate(() => window.hydrapod.workspace.ready);
    await again.locator('[data-control="pose-reset"]').click();
    await again.waitForFunction(() => !window.hydrapod.state.isWhatIf && location.hash === '');
    await again.close();
  });
});

/** Where an element stands once nothing above it grows any more: ten frames at one place. */
const rested = (page, selector) =>
  page.evaluate(async (selector) => {
    const box = () => document.querySelector(selector).getBoundingClientRect();
    for (let last = box(), still = 0; still < 10; ) {
      await new Promise(requestAnimationFrame);
      const now = box();
      still = now.x === last.x && now.y === last.y && now.width === last.width ? still + 1 : 0;
      last = now;
    }
    const { x, y, width, height } = box();
    return { x, y, width, height };
  }, selector);

test('the cross is dragged with the mouse, sliders by keys', async () => {
  await withPage(report(heavy), still, async (page) => {
    await mapped(page);
    const picture = page.locator('.heat-map');
    await page.evaluate(async () => {
      await window.hydrapod.whatIf.ready;
      await window.hydrapod.whatIf.shown();
    });
    await picture.scrollIntoViewIfNeeded();
    const box = await rested(page, '.heat-map');
    const size = await page.evaluate(() => {
      const { width, height } = document.querySelector('.heat-map').viewBox.baseVal;
      return { width, height };
    });
    const at = (x, y) => [box.x + (x * box.width) / size.width, box.y + (y * box.height) / size.height];
    await page.mouse.move(...at(size.width / 2, 200));
    await page.mouse.down();
    const end = at(size.width / 2 + 40, 180);
    await page.mouse.move(...end, { steps: 5 });
    await page.mouse.up();
    await page.evaluate(() => window.hydrapod.whatIf.shown());
    // sections above become longer or shorter with the pose; the picture stays under the pointer
    const isBack = (y) => Math.abs(document.querySelector('.heat-map').getBoundingClientRect().y - y) < 1;
    await page.waitForFunction(isBack, box.y);
    await page.evaluate(() => (document.querySelector('#mechanism').style.paddingTop = '357px'));
    await page.waitForFunction(isBack, box.y);
    const { position } = await page.evaluate(() => ({ position: window.hydrapod.state.displaced }));
    const circle = await page.locator('.heat-map circle').evaluate((c) => [c.cx.baseVal.value, c.cy.baseVal.value]);
    near(circle[0], size.width / 2 + 40, 1, 'the cross');
    near(circle[1], 180, 1, 'the cross');
    const slider = page.locator('[data-control="pose-x"]');
    near(Number(await slider.inputValue()), position[0], 1e-3, 'the slider of x');
    const ry = page.locator('[data-control="pose-ry"]');
    await ry.focus();
    await page.keyboard.press('ArrowRight');
    await page.evaluate(() => window.hydrapod.whatIf.shown());
    assert.ok((await page.evaluate(() => window.hydrapod.state.displaced))[4] > 0);
    await page.locator('[data-control="go-to-least"]').click();
    assert.deepEqual(await findings(page), [], 'axe finds nothing');
  });
});

test('a pose out of reach is said, and the page keeps what a machine can have', async () => {
  await withPage(report(heavy), still, async (page) => {
    await mapped(page);
    const before = await page.evaluate(() => window.hydrapod.state.pose.modes.map((mode) => mode.omega_rad_s));
    await page.evaluate(async () => {
      window.hydrapod.workspace.displace([0, 0, 3, 0, 0, 0]);
      await window.hydrapod.whatIf.ready;
      await window.hydrapod.whatIf.shown();
    });
    assert.match(await page.locator('.workspace-words').innerText(), /z=3000 mm: out of reach/);
    assert.match(await page.locator('.what-if-state').innerText(), /^Not computed/);
    assert.deepEqual(await page.evaluate(() => window.hydrapod.state.pose.modes.map((mode) => mode.omega_rad_s)), before);
  });
});
