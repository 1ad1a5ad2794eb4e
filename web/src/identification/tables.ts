// Tables of measured modes: the poles in use, their MAC, and the comparison with a model.

import type { Complex } from '../complex';
import { button, html, unseen } from '../dom';
import { fixed, hertz, signedPercent, withInterval } from '../numbers';
import { palette } from '../palette';
import { numeric, scroller, tableHead } from '../table';
import type { Choice, ChosenPole } from './choice';
import type { Fit } from './fitter';
import type { Comparison, Identification } from './types';

const percent = (ratio: number, digits = 2) => `${fixed(100 * ratio, digits)} %`;

/** A damping ratio in % with half of its 95 % interval. That of a real pole is exactly 100 %. */
function dampingText(ratio: number, half: number): [value: string, half: string] {
  if (Math.abs(ratio - 1) < 1e-9) return ['100 %', '–'];
  const [value, interval] = withInterval(100 * ratio, 100 * half, 2);
  return [`${value} %`, `${interval} %`];
}

/** The outputs that move most, in one unit as they are, else each in proportion to the size of its own
 * responses; of poles that the reader has chosen. */
function moving(data: Identification, shape: Complex[]): string {
  const { unit } = data.outputs[0];
  const inOneUnit = unit !== '' && data.outputs.every((channel) => channel.unit === unit);
  const shares = data.outputs.map((channel, o) => {
    const size = inOneUnit
      ? 1
      : Math.sqrt(
          data.responses.response[o].reduce(
            (all, h) => h.re.reduce((sum, re, k) => sum + re * re + h.im[k] * h.im[k], all),
            0,
          ),
        );
    const motion = shape[o];
    return { name: channel.name, motion, share: size > 0 ? Math.hypot(motion.re, motion.im) / size : 0 };
  });
  const ordered = shares.sort((a, b) => b.share - a.share);
  const largest = ordered[0].share || 1;
  const opposite = (a: Complex, b: Complex) => a.re * b.re + a.im * b.im < 0;
  return ordered
    .slice(0, 4)
    .filter((s) => s.share >= 0.2 * largest)
    .map(
      (s) => `${opposite(s.motion, ordered[0].motion) ? '−' : ''}${s.name} ${fixed(s.share / largest, 2)}`,
    )
    .join(', ');
}

function nameOf(pole: ChosenPole): string {
  if (pole.kind === 'mode') return `${pole.number}`;
  return pole.kind === 'heavy' ? 'heavily damped' : `by hand, order ${pole.number}`;
}

/** The table of poles; with `switches` its boxes switch them. */
export class PoleTable {
  /** The shape of a pole is wanted. */
  onShow: (pole: ChosenPole) => void = () => {};
  readonly element: HTMLElement;
  private readonly body = html('tbody');
  /** What moves, by pole. */
  private motions: HTMLElement[] = [];

  constructor(
    private readonly data: Identification,
    private readonly choice: Choice,
    private readonly switches: boolean,
  ) {
    const caption = switches ? 'Identified modes; the boxes switch poles on and off' : 'Identified modes';
    const table = html(
      'table',
      { class: 'modes identified' },
      html('caption', { class: 'unseen' }, caption),
      tableHead(
        ['mode'],
        ['Hz', 'numeric'],
        ['±', 'numeric'],
        ['damping', 'numeric'],
        ['±', 'numeric'],
        ['motion'],
        ['MPC', 'numeric'],
        ['MPD', 'numeric'],
        ['quality', 'numeric'],
        ['in 3D'],
      ),
      this.body,
    );
    this.element = scroller('Table of identified modes', table);
  }

  /** `fit`: the last one there was. */
  show(fit: Fit | null): void {
    const focused = (document.activeElement as HTMLElement | null)?.dataset ?? {};
    this.motions = this.choice.poles.map(() => html('td', { class: 'label' }));
    this.body.replaceChildren(...this.choice.poles.map((pole, k) => this.row(pole, k)));
    this.showMotions(fit);
    for (const name of ['pole', 'shape'])
      if (focused[name] !== undefined)
        this.body.querySelector<HTMLElement>(`[data-${name}="${focused[name]}"]`)?.focus();
  }

  /** The rows remain, and with them what the reader is about to press. */
  showMotions(fit: Fit | null): void {
    this.choice.poles.forEach((pole, k) => (this.motions[k].textContent = this.motion(pole, fit)));
  }

  /** As identified, until the reader changes the poles. */
  private motion(pole: ChosenPole, fit: Fit | null): string {
    if (!pole.on) return 'switched off';
    if (pole.kind === 'mode' && this.choice.untouched) return this.data.modes[pole.number - 1].motion;
    const shape = fit?.shapes[fit.poles.indexOf(pole)];
    return shape ? moving(this.data, shape) : '–';
  }

  private name(pole: ChosenPole, index: number): HTMLElement | string {
    if (!this.switches) return nameOf(pole);
    const box = html('input', { type: 'checkbox', checked: pole.on, 'data-pole': index });
    box.addEventListener('change', () => this.choice.set(pole, box.checked));
    return html('label', { class: 'check' }, box, nameOf(pole));
  }

  private row(pole: ChosenPole, index: number): HTMLElement {
    const fitted =
      pole.kind === 'mode'
        ? this.data.modes[pole.number - 1]
        : pole.kind === 'heavy'
          ? this.data.heavily_damped[pole.number - 1]
          : null;
    const mode = pole.kind === 'mode' ? this.data.modes[pole.number - 1] : null;
    const frequency = fitted && withInterval(pole.frequency_hz, fitted.frequency_95_hz, 3);
    const damping = fitted && dampingText(pole.damping_ratio, fitted.damping_95);
    return html(
      'tr',
      { class: pole.on ? null : 'off' },
      html('th', { scope: 'row' }, this.name(pole, index)),
      numeric(frequency ? frequency[0] : hertz(pole.frequency_hz)),
      numeric(frequency ? frequency[1] : '–'),
      numeric(damping ? damping[0] : percent(pole.damping_ratio)),
      numeric(damping ? damping[1] : '–'),
      this.motions[index],
      numeric(mode ? fixed(mode.mpc, 3) : '–'),
      numeric(mode ? `${fixed((180 / Math.PI) * mode.mpd_rad, 1)}°` : '–'),
      numeric(mode ? fixed(mode.quality, 2) : '–'),
      html(
        'td',
        {},
        button('Show', () => this.onShow(pole), {
          'data-shape': index,
          'aria-label': `Show the shape of the pole at ${hertz(pole.frequency_hz)} Hz`,
        }),
      ),
    );
  }
}

/** The MAC matrix as a table whose cells are shaded. */
export function macTable(data: Identification): HTMLElement {
  const cell = (value: number) => {
    const td = html('td', { class: 'mac-cell' }, value >= 0.05 ? fixed(value, 2) : unseen(fixed(value, 2)));
    td.style.background = `${palette().flexible}${Math.round(110 * value)
      .toString(16)
      .padStart(2, '0')}`;
    return td;
  };
  const names = data.modes.map((mode, k) => `${k + 1}: ${hertz(mode.frequency_hz)} Hz`);
  const table = html(
    'table',
    { class: 'mac' },
    html('caption', {}, 'MAC between the shapes, 0 to 1'),
    html(
      'thead',
      {},
      html(
        'tr',
        {},
        html('th', { scope: 'col' }, 'mode'),
        ...names.map((_, k) => html('th', { scope: 'col' }, k + 1)),
      ),
    ),
    html(
      'tbody',
      {},
      ...data.mac.map((row, r) =>
        html('tr', {}, html('th', { scope: 'row' }, names[r]), ...row.map(cell)),
      ),
    ),
  );
  return scroller('MAC matrix', table);
}

/** One line per mode, and one for all local seal modes. */
function notMeasured(comparison: Comparison): string[] {
  const unfelt = 'local seal mode';
  const lines = comparison.not_measured
    .filter((m) => m.reason !== unfelt)
    .map(
      (m) =>
        `Not measured: ${hertz(m.frequency_hz)} Hz, ${percent(m.damping_ratio)}, ${m.label}: ${m.reason}.`,
    );
  const quiet = comparison.not_measured.filter((m) => m.reason === unfelt);
  if (quiet.length > 0)
    lines.push(
      `Not measured, local seal modes: ${quiet.map((m) => hertz(m.frequency_hz)).join(', ')} Hz.`,
    );
  return lines;
}

export function comparisonTable(data: Identification, comparison: Comparison): HTMLElement {
  const rows = comparison.pairs.map((pair) => {
    const mode = data.modes[pair.mode - 1];
    return html(
      'tr',
      {},
      html('th', { scope: 'row', class: 'numeric' }, pair.mode),
      numeric(hertz(mode.frequency_hz)),
      numeric(hertz(pair.model.frequency_hz)),
      numeric(signedPercent(pair.frequency_difference_percent)),
      numeric(percent(mode.damping_ratio)),
      numeric(percent(pair.model.damping_ratio)),
      numeric(signedPercent(pair.damping_difference_percent)),
      numeric(pair.mac === null ? '–' : fixed(pair.mac, 3)),
      html('td', { class: 'label' }, pair.model.label),
    );
  });
  const table = html(
    'table',
    { class: 'modes compared' },
    html('caption', { class: 'unseen' }, 'Measured modes and modes of the model'),
    tableHead(
      ['mode', 'numeric'],
      ['Hz', 'numeric'],
      ['model Hz', 'numeric'],
      ['difference', 'numeric'],
      ['damping', 'numeric'],
      ['model', 'numeric'],
      ['difference', 'numeric'],
      ['MAC', 'numeric'],
      ['mode of the model'],
    ),
    html('tbody', {}, ...rows),
  );
  const left = [
    ...comparison.not_in_model.map(
      (r) => `Not in the model: mode ${r}, ${hertz(data.modes[r - 1].frequency_hz)} Hz.`,
    ),
    ...notMeasured(comparison),
  ];
  return html(
    'div',
    {},
    html('h3', {}, 'Comparison with the model'),
    html('p', { class: 'note' }, comparison.heading),
    scroller('Measured and model modes', table),
    left.length > 0 ? html('ul', { class: 'note' }, ...left.map((text) => html('li', {}, text))) : null,
  );
}
