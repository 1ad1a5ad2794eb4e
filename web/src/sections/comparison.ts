// Machines, records and lists of modes side by side: matched modes, their differences and whether these are
// significant, and overlaid responses.

import uPlot from 'uplot';
import { overlaidMagnitudes, overlaidPhases, type Overlay, type OverlayLine } from '../bode/overlay';
import { DiagramStack } from '../bode/stack';
import type { ComparedThing, SideBySide, TestedDifference } from '../document';
import { controlRow, how, html, select } from '../dom';
import { phaseCut, phaseLine } from '../bode/phase';
import { magnitude } from '../complex';
import { fixed, halfWidth95, withInterval } from '../numbers';
import { palette } from '../palette';
import type { State } from '../state';
import { numeric, scroller, tableHead } from '../table';
import type { Section } from './section';

export const comparison: Section = {
  id: 'comparison',
  title: 'Comparison',
  applies: (report) => (report.comparison?.comparisons.length ?? 0) > 0,
  render,
};

type Compared = SideBySide['comparisons'][number];

/** The first two: those of flexible and rigid legs. The others have contrast on light and on dark ground. */
function colour(thing: number): string {
  const { flexible, rigid } = palette();
  const all = [flexible, rigid, '#009e73', '#cc79a7', '#c79a00', '#8f7ee7'];
  return all[thing % all.length];
}

const letter = (thing: number): string => String.fromCharCode(65 + (thing % 26));

const verdictWords: Record<TestedDifference['verdict'], string> = {
  significant: 'significant',
  not_significant: 'not significant',
  calculated: 'calculated',
  cannot_say: 'cannot say',
};

/** "5.024 ± 0.012"; `otherwise`: decimals where no interval is known. */
function estimate(value: number, deviation: number | null, otherwise: number): string {
  if (deviation === null || !(deviation > 0)) return fixed(value, otherwise);
  return withInterval(value, halfWidth95 * deviation, otherwise).join(' ± ');
}

const signed = (value: number, deviation: number | null, otherwise: number): string =>
  `${value < 0 ? '−' : '+'}${estimate(Math.abs(value), deviation, otherwise)}`;

const scaled = (deviation: number | null, factor: number): number | null =>
  deviation === null ? null : deviation * factor;

function frequencyText(mode: ComparedThing['modes'][number]): string {
  return estimate(mode.frequency_hz, scaled(mode.omega_deviation_rad_s, 1 / (2 * Math.PI)), 3);
}

interface Difference {
  value: number;
  deviation: number | null;
  verdict: TestedDifference['verdict'];
}

/** A point with its 95 % interval beside zero; `reach`: what half the width stands for. */
function lane({ value, deviation, verdict }: Difference, reach: number): HTMLElement {
  const element = html('div', { class: 'lane', 'aria-hidden': 'true' });
  const place = (x: number) => 50 + 50 * Math.max(-1, Math.min(1, x / reach));
  const interval = html('i', { class: 'interval' });
  const [from, to] = [-1, 1].map((side) => place(value + side * halfWidth95 * (deviation ?? 0))) as [number, number];
  interval.style.left = `${from.toFixed(2)}%`;
  interval.style.width = `${(to - from).toFixed(2)}%`;
  const mark = html('i', { class: `difference ${verdict}` });
  mark.style.left = `${place(value).toFixed(2)}%`;
  element.append(html('i', { class: 'zero' }), interval, mark);
  return element;
}

interface Row {
  pair: Compared['pairs'][number];
  mode: ComparedThing['modes'][number];
  partner: ComparedThing['modes'][number];
  /** % */
  frequency: Difference;
  /** Percentage points. */
  damping: Difference;
}

function rowsOf(all: SideBySide, one: Compared): Row[] {
  const first = all.things[0];
  const second = all.things[one.thing - 1];
  return one.pairs.map((pair) => {
    const mode = first.modes[pair.first - 1];
    const percent = 100 / mode.omega_rad_s;
    const { omega_rad_s: omega, damping_ratio: damping } = pair;
    return {
      pair,
      mode,
      partner: second.modes[pair.second - 1],
      frequency: { value: percent * omega.difference, deviation: scaled(omega.deviation, percent), verdict: omega.verdict },
      damping: { value: 100 * damping.difference, deviation: scaled(damping.deviation, 100), verdict: damping.verdict },
    };
  });
}

/** All less than this are equal: the axis of their points has no range. */
const noDifference = 5e-4;

/** What holds all differences with their intervals. */
const reachOf = (differences: Difference[]): number =>
  1.1 * Math.max(noDifference, ...differences.map(({ value, deviation }) => Math.abs(value) + halfWidth95 * (deviation ?? 0)));

/** A difference as a number, as a point beside zero, and its verdict. */
const differenceCells = (difference: Difference, reach: number): HTMLElement[] => [
  numeric(signed(difference.value, difference.deviation, 2)),
  html('td', { class: 'lane-cell' }, lane(difference, reach)),
  html('td', { class: `verdict-word ${difference.verdict}` }, verdictWords[difference.verdict]),
];

function pairTable(all: SideBySide, one: Compared): HTMLElement {
  const b = letter(one.thing - 1);
  const rows = rowsOf(all, one);
  const [reach, dampingReach] = [reachOf(rows.map((r) => r.frequency)), reachOf(rows.map((r) => r.damping))];
  if (rows.length === 0) return html('p', {}, `No mode of A has a partner in ${b}.`);
  const range = (value: number, unit: string) =>
    value > 2 * noDifference ? `± ${fixed(value, value < 1 ? 3 : 1)} ${unit}` : 'no difference';
  return scroller(
    `Modes of A and ${b}`,
    html(
      'table',
      { class: 'side-by-side' },
      html('caption', {}, `${b} compared with A`),
      tableHead(
        ['A', 'numeric'],
        [b, 'numeric'],
        ['A, Hz', 'numeric'],
        [`${b}, Hz`, 'numeric'],
        ['MAC', 'numeric'],
        ['frequency, %', 'numeric'],
        [range(reach, '%'), 'lane-head'],
        ['difference'],
        ['damping, % points', 'numeric'],
        [range(dampingReach, '% points'), 'lane-head'],
        ['difference'],
        ['motion'],
      ),
      html(
        'tbody',
        {},
        ...rows.map(({ pair, mode, partner, frequency, damping }) =>
          html(
            'tr',
            {},
            html('th', { scope: 'row', class: 'numeric' }, pair.first),
            numeric(String(pair.second)),
            numeric(frequencyText(mode)),
            numeric(frequencyText(partner)),
            numeric(pair.mac === null ? '–' : fixed(pair.mac, 2)),
            ...differenceCells(frequency, reach),
            ...differenceCells(damping, dampingReach),
            html('td', { class: 'label' }, mode.label || partner.label),
          ),
        ),
      ),
    ),
  );
}

/** Modes without a partner, and what the verdicts mean. */
function notes(all: SideBySide, one: Compared): HTMLElement {
  const left = (numbers: number[], thing: number) =>
    numbers.map((number) => {
      const mode = all.things[thing].modes[number - 1];
      return `Only in ${letter(thing)}: mode ${number}, ${frequencyText(mode)} Hz${mode.label ? `, ${mode.label}` : ''}.`;
    });
  const words = new Set(one.pairs.flatMap((pair) => [pair.omega_rad_s.verdict, pair.damping_ratio.verdict]));
  const lines = [
    ...left(one.first_left, 0),
    ...left(one.second_left, one.thing - 1),
    `Hz: |λ| of damped modes. Shapes: ${one.shapes}.`,
    words.size > 0 && !words.has('significant') && !words.has('not_significant') ? 'No difference was tested for significance.' : '',
    words.has('significant') || words.has('not_significant') ? `Significant: ${all.test}; ± is half the 95 % interval.` : '',
    words.has('calculated') ? 'Calculated: both values are calculated and have no measurement uncertainty.' : '',
    words.has('cannot_say') ? 'Cannot say: the uncertainty of a measured value is not known.' : '',
  ].filter(Boolean);
  return html('ul', { class: 'note' }, ...lines.map((text) => html('li', {}, text)));
}

/** Names of responses that two things or more have, in the order of the first that has them. */
function sharedNames(all: SideBySide): string[] {
  const names = all.things.flatMap(({ responses }) => responses.map(({ name }) => name));
  return [...new Set(names)].filter((name) => names.indexOf(name) !== names.lastIndexOf(name));
}

class Responses {
  private readonly plots = new DiagramStack('comparison');
  private readonly legend = html('ul', { class: 'legend' });
  private name: string;
  readonly parts: HTMLElement[];

  constructor(
    private readonly all: SideBySide,
    names: string[],
  ) {
    this.name = names[0];
    this.parts = [
      html('h3', {}, 'Bode diagrams'),
      controlRow(select('Response', names, (k) => this.choose(names[k]), 'compared-response')),
      this.plots.element,
      this.legend,
      html('p', { class: 'note' }, how('Drag across a diagram to zoom, double-click for the whole range.')),
    ];
  }

  choose(name: string): void {
    this.name = name;
    this.draw();
  }

  /** The things that have the chosen response, with their lines on a common axis. */
  drawn(): { thing: number; unit: string; frequency_hz: number[]; magnitude: (number | null)[]; phase: (number | null | undefined)[] }[] {
    const having = this.all.things.flatMap((thing, number) => {
      const response = thing.responses.find(({ name }) => name === this.name);
      return response && response.frequency_hz.length > 0 ? [{ number, response }] : [];
    });
    if (having.length === 0) return [];
    const curves = having.map(({ response: { re, im } }) => re.map((value, k) => ({ re: value, im: im[k]! })));
    const cut = phaseCut(curves);
    const [frequency, ...values] = uPlot.join(
      having.map(({ response: { frequency_hz } }, k) => [frequency_hz, curves[k]!.map(magnitude), phaseLine(curves[k]!, cut)] as uPlot.AlignedData),
    );
    return having.map(({ number, response }, k) => ({
      thing: number,
      unit: response.unit,
      frequency_hz: [...frequency],
      magnitude: [...values[2 * k]].map((v) => (v !== null && v !== undefined && v > 0 ? v : null)),
      phase: [...values[2 * k + 1]],
    }));
  }

  draw(): void {
    const drawn = this.drawn();
    const [first] = drawn;
    if (!first) return;
    const line = (thing: number): Omit<OverlayLine, 'values'> => ({
      label: letter(thing),
      stroke: colour(thing),
      ...(thing === 0 ? {} : { dash: [7, 4] }),
    });
    const who = drawn.map(({ thing }) => letter(thing)).join(', ');
    const overlay = (quantity: string, lines: OverlayLine[]): Overlay => ({
      name: `${quantity} of ${this.name} over frequency: ${who}`,
      frequency_hz: first.frequency_hz,
      lines,
    });
    const magnitudes = drawn.map(({ thing, magnitude: values }) => ({ ...line(thing), values }));
    const phases = drawn.map(({ thing, phase: values }) => ({ ...line(thing), values }));
    this.plots.show([
      overlaidMagnitudes(overlay('Magnitude', magnitudes), first.unit),
      overlaidPhases(overlay('Phase', phases)),
    ]);
    this.legend.replaceChildren(
      ...drawn.map(({ thing }) => {
        const key = html('i', { class: 'line' });
        key.style.borderColor = colour(thing);
        if (thing > 0) key.style.borderTopStyle = 'dashed';
        return html('li', {}, key, `${letter(thing)}: ${this.all.things[thing].name}`);
      }),
    );
  }
}

function render(state: State, host: HTMLElement): void {
  const all = state.report.comparison as SideBySide;
  const names = sharedNames(all);
  host.append(
    html('ul', { class: 'findings first' }, ...all.comparisons.map(({ verdict }) => html('li', {}, verdict))),
    html(
      'dl',
      { class: 'things' },
      ...all.things.flatMap((thing, k) => [
        html('dt', {}, `${letter(k)}: ${thing.name}`),
        html('dd', {}, thing.description),
      ]),
    ),
    ...all.comparisons.flatMap((one) => [pairTable(all, one), notes(all, one)]),
  );
  if (names.length === 0) return;
  const responses = new Responses(all, names);
  host.append(...responses.parts);
  responses.draw();
  state.listen((change) => change === 'theme' && responses.draw());
  window.hydrapod.comparison = {
    choose: (name) => responses.choose(name),
    drawn: () => responses.drawn(),
  };
}
