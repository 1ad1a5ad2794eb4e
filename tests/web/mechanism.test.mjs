// The moving machine: what is drawn is what the mode shape says.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { damped, model, near, published, report, still, withKeptPage, withPage } from './support.mjs';

const tolerance = 1e-6; // [m]

/**
 * Points of leg i moved by `amplitude` times the coordinates `y`, the flexible ones times `tilt`: the document
 * has the points and their motion (tests/dynamics/drawn_leg_test.cpp compares them with exact kinematics).
 */
function expectedPoints(pose, leg, i, y, tilt, amplitude) {
  const c = pose.geometry.platform.mass_center_m;
  const a = leg.platform_joint_m;
  const r = a.map((x, k) => x - c[k]);
  const [w0, w1, w2] = y.slice(3, 6);
  const turn = [w1 * r[2] - w2 * r[1], w2 * r[0] - w0 * r[2], w0 * r[1] - w1 * r[0]];
  const joint = turn.map((x, k) => x + y[k]);
  const perLeg = (y.length - 6) / 6;
  const motion = [...joint, ...y.slice(6 + i * perLeg, 6 + (i + 1) * perLeg).map((x) => tilt * x)];
  const moved = ({ at_m: at, motion: rows }) => {
    rows.forEach((row) => assert.equal(row.length, motion.length));
    return at.map((x, k) => x + amplitude * rows[k].reduce((sum, value, n) => sum + value * motion[n], 0));
  };
  const { sleeve, piston, rod_at_sleeve: rod } = perLeg > 0 ? leg.bent : leg.straight;
  return {
    base: leg.base_joint_m,
    sleeve: moved(sleeve),
    piston: moved(piston),
    rodAtSleeve: moved(rod),
    joint: a.map((x, k) => x + amplitude * joint[k]),
  };
}

/** y(θ) = Re[(r + i m) e^{iθ}] */
const atPhase = (mode, phase) =>
  mode.shape.map(
    (x, k) => Math.cos(phase) * x - Math.sin(phase) * (mode.shape_imaginary?.[k] ?? 0),
  );

async function drawn(page, side) {
  return page.evaluate((which) => {
    const { scene } = window.hydrapod;
    return {
      motion: scene.motion(),
      legs: [1, 2, 3, 4, 5, 6].map((leg) => scene.jointPositions(leg, which)),
    };
  }, side);
}

/** What is drawn in each of the modes at a phase, of both sides. */
const drawnModes = (page, modes, phase) =>
  page.evaluate(
    ([numbers, at]) => {
      const { scene, state } = window.hydrapod;
      return numbers.map((number) => {
        state.chooseMode(number);
        scene.setPhase(at);
        const legs = (side) => [1, 2, 3, 4, 5, 6].map((leg) => scene.jointPositions(leg, side));
        return { motion: scene.motion(), legs: legs('flexible'), rigidLegs: legs('rigid') };
      });
    },
    [modes.map((mode) => mode.number), phase],
  );

function compare(points, expected, what) {
  for (const [key, value] of Object.entries(expected))
    value.forEach((x, k) => near(points[key][k], x, tolerance, `${what}, ${key}[${k}]`));
}

/** Compares both sides at a phase with the document's shapes, for each of the modes. */
async function checkModes(page, pose, modes, phase) {
  const pictures = await drawnModes(page, modes, phase);
  assert.equal(pictures.length, modes.length);
  modes.forEach((mode, k) => checkPicture(pose, mode, phase, pictures[k]));
}

function checkPicture(pose, mode, phase, { motion, legs, rigidLegs }) {
  const y = atPhase(mode, phase);
  const counterpart = mode.rigid && pose.rigid_modes[mode.rigid.mode - 1];
  const z = counterpart ? atPhase(counterpart, phase) : [0, 0, 0, 0, 0, 0];
  pose.geometry.legs.forEach((leg, i) => {
    const bent = expectedPoints(pose, leg, i, y, motion.tilt, motion.amplitude);
    compare(legs[i], bent, `mode ${mode.number}, leg ${i + 1}`);
    const straight = expectedPoints(pose, leg, i, z, 1, motion.rigidAmplitude);
    compare(rigidLegs[i], straight, `rigid beside mode ${mode.number}, leg ${i + 1}`);
  });
}

/** For numbers read back from the drawing: with few pixels. */
const coarse = { ...still, deviceScaleFactor: 0.25 };

for (const [name, words] of [
  ['published machine', [published]],
  ['30 complex modes under gravity', damped],
  ['heavy machine at another pose', [model('heavy-platform.toml'), '--pose', 'pitched']],
  ['lower and tilted, gimbal axes', [...damped, '--pose', 'z=-25 mm, rx=3 deg, y=20 mm']],
]) {
  test(`${name}: every point of every leg is where the shape puts it`, async () => {
    await withKeptPage(report(...words), coarse, async (page) => {
      const pose = await page.evaluate(() => window.hydrapod.report.poses[0]);
      await checkModes(page, pose, pose.modes, 0.7);
    });
  });
}

test('complex modes move with their phases', async () => {
  await withKeptPage(report(...damped), coarse, async (page) => {
    const mode = await page.evaluate(() =>
      window.hydrapod.report.poses[0].modes.find((m) =>
        m.shape_imaginary?.some((x) => Math.abs(x) > 1e-3),
      ),
    );
    assert.ok(mode, 'the dampers make some mode complex');
    const pose = await page.evaluate(() => window.hydrapod.report.poses[0]);
    for (const phase of [0, Math.PI / 2, 2.5]) await checkModes(page, pose, [mode], phase);
  });
});

test('choosing a mode in the table changes what is drawn, and frames differ', async () => {
  await withPage(report(published), {}, async (page) => {
    await page.evaluate(() => window.hydrapod.scene.setPhase(0));
    const before = (await drawn(page, 'flexible')).legs;
    await page.click('[data-mode="16"]');
    await page.waitForFunction(() => window.hydrapod.state.mode.number === 16);
    await page.evaluate(() => window.hydrapod.scene.setPhase(0));
    const behind = (await drawn(page, 'flexible')).legs;
    assert.notDeepEqual(before, behind);

    await page.click('[data-control="play"]');
    const canvas = page.locator('canvas.machine');
    const first = await canvas.screenshot();
    const { phase } = await page.evaluate(() => window.hydrapod.scene.motion());
    await page.waitForFunction(
      (p) => Math.abs(window.hydrapod.scene.motion().phase - p) > 0.5,
      phase,
    );
    const second = await canvas.screenshot();
    assert.ok(!first.equals(second), 'the picture moves');

    await page.click('[data-control="play"]');
    const frames = await page.evaluate(() => window.hydrapod.scene.frames());
    await page.waitForTimeout(300);
    const later = await page.evaluate(() => window.hydrapod.scene.frames());
    assert.ok(later - frames <= 1, 'paused');
  });
});

test('what stands still is drawn once: not when it is scrolled to, again when it has another size', async () => {
  await withPage(report(published), still, async (page) => {
    const framesAfter = (change) =>
      page.evaluate(async (id) => {
        document.getElementById(id)?.scrollIntoView();
        for (let i = 0; i < 5; ++i) await new Promise((done) => requestAnimationFrame(done));
        return window.hydrapod.scene.frames();
      }, change);
    assert.equal(await framesAfter(''), 1);
    assert.equal(await framesAfter('about'), 1);
    assert.equal(await framesAfter('mechanism'), 1);
    await page.setViewportSize({ width: 1100, height: 1000 });
    await page.waitForFunction(() => window.hydrapod.scene.frames() > 1);
    const resized = await framesAfter('mechanism');
    await page.evaluate(() => window.hydrapod.state.chooseMode(2));
    assert.equal(await framesAfter('mechanism'), resized + 1);
    await page.evaluate(() => window.hydrapod.state.chooseMode(1));
    await page.evaluate(() => window.hydrapod.scene.setPhase(1));
    const changed = await framesAfter('mechanism');
    assert.ok(changed > resized + 1 && changed <= resized + 3, 'at most one frame for each change');
  });
});

test('sliders, reset, view buttons and leg numbers', async () => {
  await withPage(report(published), {}, async (page) => {
    const slide = (name, value) => page.locator(`[data-control="${name}"]`).fill(String(value));
    const motion = () => page.evaluate(() => window.hydrapod.scene.motion());
    const usual = await motion();
    await slide('amplitude', 24);
    near((await motion()).amplitude, 2 * usual.amplitude, 1e-12 * usual.amplitude, 'amplitude');
    await slide('tilt', 4);
    assert.equal((await motion()).tilt, 4);
    const pose = await page.evaluate(() => window.hydrapod.report.poses[0]);
    await checkModes(page, pose, [pose.modes[0]], 0.3);

    await slide('speed', 2);
    await page.click('[data-control="reset"]');
    const again = await motion();
    near(again.amplitude, usual.amplitude, 1e-12 * usual.amplitude, 'amplitude after reset');
    assert.equal(again.tilt, 1);
    assert.equal(again.playing, true);

    await page.evaluate(() => window.hydrapod.scene.setPhase(0));
    const canvas = page.locator('canvas.machine');
    const straightOn = await canvas.screenshot();
    await page.click('[aria-label="Turn left"]');
    await page.waitForTimeout(200);
    const turned = await canvas.screenshot();
    assert.ok(!straightOn.equals(turned), 'the view turns');
    await page.uncheck('[data-control="labels"]');
    await page.waitForTimeout(200);
    assert.ok(!turned.equals(await canvas.screenshot()), 'the numbers go');
  });
});

test('the picture turns when it is dragged', async () => {
  await withKeptPage(report(published), still, async (page) => {
    await page.evaluate(() => window.hydrapod.scene.setPhase(0));
    const canvas = page.locator('canvas.machine');
    const before = await canvas.screenshot();
    const box = await canvas.boundingBox();
    await page.mouse.move(box.x + 100, box.y + 150);
    await page.mouse.down();
    await page.mouse.move(box.x + 180, box.y + 150, { steps: 4 });
    await page.mouse.up();
    await page.waitForTimeout(200);
    assert.ok(!before.equals(await canvas.screenshot()));
  });
});

test('a rigid model stands alone', async () => {
  await withPage(report(published, '--model', 'rigid'), still, async (page) => {
    assert.equal(await page.locator('.viewport-head').count(), 1);
    assert.equal(await page.locator('.col-mac').count(), 0);
  });
});

test('without WebGL the machine is drawn flat, and says so', async () => {
  const launch = () => {
    const original = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind.startsWith('webgl') ? null : original.call(this, kind, ...rest);
    };
  };
  await withPage(report(published), { ...still, launch }, async (page) => {
    assert.equal(await page.evaluate(() => window.hydrapod.scene.kind), 'svg');
    assert.match(await page.locator('#mechanism').innerText(), /no WebGL/);
    assert.equal(await page.locator('.machine.flat svg').count(), 2);
    const pose = await page.evaluate(() => window.hydrapod.report.poses[0]);
    await checkModes(page, pose, [pose.modes[0]], 1);
  });
});
