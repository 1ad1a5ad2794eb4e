// What came of it: A, the machine one compares with, beside B, the machine with the values shown.

import { labelled, tickText } from '../bode/ticks';
import type { Brief, Buckling } from '../core/core';
import { directions, type BriefMode, type BriefPose } from '../document';
import { html, onNewWidth, svg } from '../dom';
import { fixed, hertz, signedPercent, tick } from '../numbers';

const two_pi = 2 * Math.PI;

/** Where most of a rigid mode is found in the flexible model. */
interface Line {
  direction: string;
  rigid: number;
  main: BriefMode | null;
}

const strongest = (energy: number[]): string =>
  directions[energy.indexOf(Math.max(...energy))] as string;

function lines(pose: BriefPose): Line[] {
  return pose.rigid_modes.map((rigid) => {
    const holding = pose.modes.filter((mode) => mode.rigid?.mode === rigid.number);
    const most = (best: BriefMode | null, mode: BriefMode) =>
      !best || mode.rigid!.mac > best.rigid!.mac ? mode : best;
    return {
      direction: strongest(rigid.platform_energy),
      rigid: rigid.frequency_hz,
      main: pose.model === 'rigid' ? rigid : holding.reduce(most, null),
    };
  });
}

/** [Hz]; nothing where there is no such mode, or it is unstable. */
const frequencyOf = (mode: BriefMode | null | undefined): number | undefined =>
  mode?.stable ? mode.frequency_hz : undefined;

const frequencyText = (mode: BriefMode | null | undefined): string =>
  mode ? (mode.stable ? hertz(mode.frequency_hz) : 'unstable') : '–';

/** Likeness of the flexible mode and the rigid one: how much of that motion the shift is about. */
const macText = (mode: BriefMode | null | undefined): string =>
  mode?.stable && mode.rigid ? fixed(mode.rigid.mac, 2) : '–';

const cell = (text: string, kind = 'numeric') => html('td', { class: kind }, text);

const changeText = (now: number | undefined, before: number | undefined): string =>
  now !== undefined && before ? signedPercent(100 * (now / before - 1)) : '–';

/** Rows of B's rigid modes; A's are those of the same direction and place. */
export function resultTable(a: BriefPose | null, b: BriefPose | null): HTMLElement {
  const flexible = (b ?? a)?.model !== 'rigid';
  const head = ['Direction', 'Rigid legs, Hz', ...(flexible ? ['Flexible legs, Hz', 'MAC', 'Shift by the seals'] : []), 'A, Hz', 'B − A'];
  const rows = (b ?? a) ? lines((b ?? a) as BriefPose) : [];
  const before = a ? lines(a) : [];
  const twin = (line: Line, k: number): Line | undefined => {
    const place = rows.slice(0, k).filter((other) => other.direction === line.direction).length;
    return before.filter((other) => other.direction === line.direction)[place];
  };
  return html(
    'table',
    { class: 'what-if-results' },
    html('caption', { class: 'unseen' }, 'Frequencies with the values shown (B) beside those of A'),
    html('thead', {}, html('tr', {}, ...head.map((text, k) => html('th', { scope: 'col', class: k > 0 ? 'numeric' : '' }, text)))),
    html(
      'tbody',
      {},
      ...rows.map((line, k) => {
        const now = b ? line.main : null;
        const then = twin(line, k)?.main;
        return html(
          'tr',
          {},
          html('th', { scope: 'row' }, line.direction),
          cell(b ? (flexible ? hertz(line.rigid) : frequencyText(now)) : '–'),
          ...(flexible ? [cell(frequencyText(now)), cell(macText(now)), cell(changeText(frequencyOf(now), line.rigid))] : []),
          cell(frequencyText(then)),
          cell(changeText(frequencyOf(now), frequencyOf(then))),
        );
      }),
    ),
  );
}

export const bucklingText = (found: Buckling | null): string => {
  if (!found) return '…';
  if (found.status === 'none') return 'no buckling (up to 100 times the mass, or no gravity)';
  const payload = Math.abs(found.payload_kg ?? 0);
  const mass = `${fixed(payload, payload < 100 ? 1 : 0)} kg`;
  return found.status === 'found'
    ? `legs buckle at ${mass} more payload`
    : `buckled: ${mass} must come off`;
};

/** |H| over frequency of one direction, of a sweep as the core gives it; none where the legs buckle. */
export function magnitudes(
  computed: Brief,
  lineCount: number,
  direction: number,
  rigid = false,
): number[] {
  const values = computed.responses;
  const stable = rigid || computed.pose?.answer?.stable !== false;
  if (!values || values.length === 0 || !stable) return [];
  const begin = (rigid ? 12 * lineCount : 0) + 2 * direction;
  return Array.from({ length: lineCount }, (_, k) => Math.hypot(values[begin + 12 * k]!, values[begin + 12 * k + 1]!));
}

export interface Curve {
  kind: 'now' | 'before' | 'rigid';
  omega: Float64Array;
  size: number[];
}

const height = 260;
const [narrowest, widest] = [280, 900];
const inside = { left: 62, right: 12, top: 10, bottom: 36 };

/** A small Bode diagram that is drawn 60 times a second. */
export class SmallBode {
  readonly element = svg('svg', { class: 'small-bode', role: 'img', 'aria-label': 'Bode diagram' });
  /** As wide as it stands in the page, so that its text keeps its size. */
  private width = widest;
  private drawn: [curves: Curve[], title: string, unit: string] = [[], '', ''];

  constructor() {
    onNewWidth(this.element, () => this.show(...this.drawn));
  }

  show(curves: Curve[], title: string, unit: string): void {
    this.drawn = [curves, title, unit];
    this.width = Math.min(widest, Math.max(narrowest, this.element.clientWidth || widest));
    const { width } = this;
    this.element.setAttribute('viewBox', `0 0 ${width} ${height}`);
    const drawn = curves.filter((curve) => curve.size.length > 0);
    this.element.setAttribute('aria-label', `${title}; the table beside it has the frequencies`);
    const sizes = drawn.flatMap((curve) => curve.size.filter((value) => value > 0 && Number.isFinite(value)));
    const all = drawn.flatMap((curve) => [curve.omega[0]!, curve.omega[curve.omega.length - 1]!]);
    if (sizes.length === 0) {
      this.element.replaceChildren();
      return;
    }
    const [low, high] = [sizes.reduce((a, b) => Math.min(a, b)) / 1.3, sizes.reduce((a, b) => Math.max(a, b)) * 1.6];
    const [from, to] = [Math.min(...all), Math.max(...all)];
    const x = (omega: number) =>
      inside.left + ((width - inside.left - inside.right) * Math.log(omega / from)) / Math.log(to / from);
    const y = (value: number) =>
      height - inside.bottom - ((height - inside.top - inside.bottom) * Math.log(value / low)) / Math.log(high / low);
    const path = ({ omega, size }: Curve) =>
      size
        .map((value, k) =>
          value > 0 && Number.isFinite(value) ? `${x(omega[k]!).toFixed(1)},${y(value).toFixed(1)}` : '',
        )
        .filter(Boolean)
        .join(' ');
    this.element.replaceChildren(
      ...this.axes(x, y, [from, to], [low, high], unit),
      ...drawn.map((curve) => svg('polyline', { points: path(curve), class: `curve curve-${curve.kind}` })),
    );
  }

  private axes(
    x: (omega: number) => number,
    y: (value: number) => number,
    [from, to]: [number, number],
    [low, high]: [number, number],
    unit: string,
  ): SVGElement[] {
    const parts: SVGElement[] = [];
    const { width } = this;
    const bottom = height - inside.bottom;
    for (const hz of labelled(from / two_pi, to / two_pi, (value) => x(two_pi * value), width)) {
      const at = x(two_pi * hz);
      parts.push(
        svg('line', { x1: at, x2: at, y1: inside.top, y2: bottom, class: 'grid' }),
        svg('text', { x: at, y: bottom + 14, 'text-anchor': 'middle' }, tickText(hz)),
      );
    }
    for (let e = Math.ceil(Math.log10(low)); e <= Math.log10(high); ++e) {
      const at = y(10 ** e);
      parts.push(
        svg('line', { x1: inside.left, x2: width - inside.right, y1: at, y2: at, class: 'grid' }),
        svg('text', { x: inside.left - 6, y: at + 4, 'text-anchor': 'end' }, tick(10 ** e)),
      );
    }
    parts.push(
      svg('text', { x: width / 2, y: height - 4, 'text-anchor': 'middle' }, 'frequency in Hz'),
      svg(
        'text',
        { x: 12, y: height / 2, 'text-anchor': 'middle', transform: `rotate(-90 12 ${height / 2})` },
        unit,
      ),
    );
    return parts;
  }
}
