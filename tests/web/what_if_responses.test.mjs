// While a value is dragged the core sums direct responses over modes: they are those of the command line with the
// same --set, at every line.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { startCore } from '../../web/core/module.mjs';
import { damped, json, model, published, random, report } from './support.mjs';

const lines = 2000;
const directions = ['x', 'y', 'z', 'rx', 'ry', 'rz'];
const set = (...texts) => texts.flatMap((text) => ['--set', text]);
/**
 * Of H_dd. Without dampers both sum over undamped modes, which the eigensolver knows to some epsilons of the largest
 * ω²: on a resonance that is 5 ε ω_n²/ω_1²/2ζ (tests/response/frequency_response_test.cpp).
 */
const [limit, limitOfUndamped] = [1e-12, 1e-9];
const machines = [
  { name: 'modal ratios alone, 30 modes', most: limitOfUndamped, words: [published, ...set('environment.gravity=9.81', 'legs.piston_ring.stiffness=2e6 N/m')] },
  { name: 'dampers and modal ratios, 30 modes', words: damped },
  { name: 'dampers alone, 30 modes', words: [...damped, ...set('damping.modal_ratio=0')] },
  { name: 'rings that are damped, too', words: [...damped, ...set('legs.piston_ring.damping=15 N s/m')] },
  { name: 'equal legs, modes that repeat', words: [model('zhang-jiang-2021-transverse.toml'), ...set('legs.guide_sleeve.damping=60 N s/m', 'legs.oil_spring.damping=4000 N s/m')] },
  { name: 'seals that creep back', words: [...damped, ...set('legs.guide_sleeve.damping=30 kN s/m')] },
  { name: 'heavy', words: [model('heavy-platform.toml')] },
];
const paths = ['legs.guide_sleeve.stiffness', 'platform.mass', 'legs.rod.mass', 'legs.oil_spring.stiffness'];

for (const { name, words, most = limit } of machines)
  test(`direct responses are those of the command line: ${name}`, async () => {
    const { editable, poses } = JSON.parse(/id="data">([^<]*)</.exec(readFileSync(report(...words), 'utf8'))[1]);
    const { core, call, give, taken } = await startCore();
    call('core_open', editable);
    const { from_rad_s: from, to_rad_s: to } = poses[0].bode;
    const next = random(77);
    let worst = 0;
    for (let k = 0; k < 4; ++k) {
      const path = paths[k];
      const before = editable.numbers[path]?.[0][0];
      const changes = before ? [[path, before * (0.95 + 0.1 * next())]] : [];
      const theirs = json('bode', ...words, '--model', editable.model, ...set(...changes.map(([path, value]) => `${path}=${value}`)),
        '--from', String(from / (2 * Math.PI)), '--to', String(to / (2 * Math.PI)), '--points', String(lines));
      assert.ok(JSON.parse(call('core_compute', { set: changes, pose: 0, brief: true })).pose, path);
      give(Float64Array.from(theirs.omega_rad_s));
      const mine = taken(core.core_sweep());
      assert.equal(mine.length, 24 * lines);
      [theirs.response, theirs.rigid_response].forEach((response, side) => {
        for (let line = 0; line < lines; ++line)
          directions.forEach((direction, d) => {
            const { re, im } = response[direction][direction];
            const at = 12 * (side * lines + line) + 2 * d;
            const apart = Math.hypot(mine[at] - re[line], mine[at + 1] - im[line]) / Math.hypot(re[line], im[line]);
            assert.ok(apart <= most, `${changes}: ${side ? 'rigid' : 'flexible'}, ${direction} at ${theirs.omega_rad_s[line]} rad/s: ${apart}`);
            worst = Math.max(worst, apart);
          });
      });
    }
    console.log(`# ${name}: ${worst.toExponential(1)}`);
  });
