// How long a recalculation takes while a value is dragged, from values to JSON and 2000 Bode lines, and the fit of poles
// to 2000 lines of measured responses, 6 × 6:
//
//     node web/core/bench.mjs REPORT.html [COUNT]
//
// REPORT: written by `hydrapod report`. Prints the median and the 99th percentile in milliseconds, of the
// whole and of its parts.
import { readFileSync } from 'node:fs';
import { startCore } from './module.mjs';

const [file, count = '1000'] = process.argv.slice(2);
if (!file) throw new Error('usage: node web/core/bench.mjs REPORT.html [COUNT]');
const document = JSON.parse(/id="data">([^<]*)</.exec(readFileSync(file, 'utf8'))[1]);
const { core, call, give, taken } = await startCore();

const lines = 2000;
function sweep(omega) {
  give(omega);
  return taken(core.core_sweep());
}

call('core_open', document.editable);
const { from_rad_s: from, to_rad_s: to } = document.poses[0].bode;
const omega = Float64Array.from({ length: lines }, (_, k) => from * (to / from) ** (k / (lines - 1)));
const own = JSON.parse(call('core_compute', { set: [], pose: 0, points: 600 }));
const stiffness = document.editable.numbers['legs.guide_sleeve.stiffness'][0][0];
const times = { modes: [], parse: [], sweep: [], all: [] };
const cpu = process.cpuUsage();
for (let k = 0; k < Number(count); ++k) {
  const begin = performance.now();
  const set = [['legs.guide_sleeve.stiffness', stiffness * (1 + 1e-4 * k)]];
  const text = call('core_compute', { set, pose: 0, brief: true });
  const computed = performance.now();
  JSON.parse(text);
  const parsed = performance.now();
  sweep(omega);
  const end = performance.now();
  times.modes.push(computed - begin);
  times.parse.push(parsed - computed);
  times.sweep.push(end - parsed);
  times.all.push(end - begin);
}
const used = process.cpuUsage(cpu);
const each = (used.user + used.system) / 1000 / Number(count);
console.log(`${own.pose.modes.length} modes, ${lines} Bode lines with flexible and with rigid legs, ms:`);
for (const [name, list] of Object.entries(times)) {
  list.sort((a, b) => a - b);
  const at = (share) => list[Math.min(list.length - 1, Math.floor(share * list.length))].toFixed(2);
  console.log(`${name.padEnd(6)} median ${at(0.5)}  p99 ${at(0.99)}`);
}
// where other programs want the processor too, this is what counts
console.log(`processor time of one recalculation: ${each.toFixed(2)} ms`);

/** Fits of `poles` poles; errors of responses `known`, `correlated` between inputs, or not known; a window or none. */
function fits(poles, errors, window) {
  const deviations = errors !== 'not known';
  const correlation = errors === 'correlated';
  const frequency = Array.from({ length: lines }, (_, k) => 2 + k / 16);
  const entry = () => Array.from({ length: (deviations ? 3 : 2) * lines }, () => 1 + Math.random());
  const numbers = [frequency, ...Array.from({ length: 36 }, entry), Array(correlation ? 30 * lines : 0).fill(0.1), Array.from({ length: window }, (_, k) => -k / window)];
  give(Float64Array.from(numbers.flat()));
  const begin = performance.now();
  call('core_measured', { outputs: 6, inputs: 6, lines, deviations, correlation, shift: 0, residual_terms: 4, window, duration: 16 });
  const handed = performance.now() - begin;
  const some = () => Array.from({ length: 6 }, () => Math.random() - 0.5);
  const list = Array.from({ length: poles }, (_, k) => ({
    pole: { re: -1 - k, im: 2 * Math.PI * (5 + 100 * k / poles) },
    participation: { re: some(), im: some() },
  }));
  const all = [];
  for (let k = 0; k < 21; ++k) {
    const from = performance.now();
    list[k % poles].pole.im += 1; // the reader changes one of them
    taken(Number(call('core_fit', { poles: list })));
    all.push(performance.now() - from);
  }
  const [first] = all;
  all.sort((a, b) => a - b);
  const what = `${poles} poles, errors ${errors}, ${window ? `window of ${window} values` : 'no window'}`;
  console.log(`${what}: responses handed over in ${handed.toFixed(1)} ms, first fit ${first.toFixed(1)} ms, median ${all[10].toFixed(1)} ms`);
}

for (const poles of [6, 12, 30]) for (const errors of ['not known', 'known', 'correlated']) for (const window of [0, 16384]) fits(poles, errors, window);
