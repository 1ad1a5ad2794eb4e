// A simulated run of 100,000 samples, shared by the tests of its pictures.
import { readFileSync, writeFileSync } from 'node:fs';
import { published, random, report, temporary } from './support.mjs';

export const command = ['--command', 'sine z=4 mm, ry=1 deg, frequency=2 Hz, fade=0.2 s', '--until', '0.6'];

/** The report of the run with `count` samples: what it has, and noise between. `change` alters the run. */
function longRun(count, change = () => {}) {
  const text = readFileSync(report(published, ...command), 'utf8');
  const [, data] = text.match(/<script type="application\/json" id="data">([^]*?)<\/script>/);
  const document = JSON.parse(data);
  const { trace } = document.simulation;
  const old = trace.time_s;
  const noise = random(3);
  const longer = (values, size) =>
    Array.from({ length: count }, (_, k) => {
      const at = (k * (old.length - 1)) / (count - 1);
      const i = Math.min(old.length - 2, Math.floor(at));
      const value = values[i] + (at - i) * (values[i + 1] - values[i]);
      return Number((value + size * (noise() - 0.5)).toPrecision(7));
    });
  for (const [key, size] of [['command', 0], ['motion', 2e-5], ['piston_m', 2e-5], ['drive', 0.02], ['cap_pressure_Pa', 2e4], ['rod_pressure_Pa', 2e4]])
    trace[key] = trace[key].map((values) => longer(values, size));
  trace.time_s = longer(old, 0);
  trace.time_s = trace.time_s.map((_, k) => (60 * k) / (count - 1)); // a minute
  change(trace);
  const file = temporary(`long-${count}.html`);
  const embedded = JSON.stringify(document).replaceAll('<', '\\u003c');
  writeFileSync(file, text.replace(data, () => embedded));
  return file;
}

export const samples = 100_000;
export const peak = { at: 54_321, value: 0.02 }; // one sample [m]
let long;
export const longPage = () => (long ??= longRun(samples, (trace) => (trace.motion[2][peak.at] = peak.value)));
