// How long a recalculation takes, from values to JSON and 2000 Bode lines:
//
//     node web/core/bench.mjs REPORT.html [COUNT]
//
// REPORT: written by `hydrapod report`. Runs the module of that page in node: the same engine (V8) as in
// Chromium, without a browser around it. Prints the median and the 99th percentile in milliseconds, of the
// whole and of its parts.
import { readFileSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';

const [file, count = '1000'] = process.argv.slice(2);
if (!file) throw new Error('usage: node web/core/bench.mjs REPORT.html [COUNT]');
const page = readFileSync(file, 'utf8');
const block = (id) => new RegExp(`id="${id}">([^<]*)<`).exec(page)[1];
const document = JSON.parse(block('data'));
const nothing = () => 0;
const { instance } = await WebAssembly.instantiate(gunzipSync(Buffer.from(block('core'), 'base64')), {
  env: { emscripten_notify_memory_growth: nothing },
  wasi_snapshot_preview1: {
    proc_exit: nothing,
    environ_sizes_get: nothing,
    environ_get: nothing,
    fd_write: nothing,
    fd_close: nothing,
    fd_seek: nothing,
  },
});
const core = instance.exports;
core._initialize();

function call(name, value) {
  const bytes = new TextEncoder().encode(JSON.stringify(value));
  new Uint8Array(core.memory.buffer, core.core_room(bytes.length), bytes.length).set(bytes);
  const refused = core[name]() !== 0;
  const text = new TextDecoder().decode(
    new Uint8Array(core.memory.buffer, core.core_answer(), core.core_answer_size()),
  );
  if (refused) throw new Error(text);
  return text;
}

const lines = 2000;
function sweep(from, to) {
  const at = core.core_lines(lines);
  const omega = new Float64Array(core.memory.buffer, at, lines);
  for (let k = 0; k < lines; ++k) omega[k] = from * (to / from) ** (k / (lines - 1));
  const values = core.core_sweep();
  return new Float64Array(core.memory.buffer, core.core_numbers(), values).slice();
}

call('core_open', document.editable);
const bode = document.poses[0].bode;
const own = JSON.parse(call('core_compute', { set: [], pose: 0, points: 600 }));
const stiffness = document.editable.numbers['legs.guide_sleeve.stiffness'][0][0];
const times = { modes: [], parse: [], sweep: [], all: [] };
const cpu = process.cpuUsage();
for (let k = 0; k < Number(count); ++k) {
  const begin = performance.now();
  const set = [['legs.guide_sleeve.stiffness', stiffness * (1 + 1e-4 * k)]];
  const text = call('core_compute', { set, pose: 0, points: 0 });
  const computed = performance.now();
  JSON.parse(text);
  const parsed = performance.now();
  sweep(bode.from_rad_s, bode.to_rad_s);
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
