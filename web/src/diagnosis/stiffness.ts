// The drop or the lowest resonance as a function of the stiffness of the guide sleeves, with the goal.

import { magnitudeTicks } from '../bode/ticks';
import type { Remedy } from '../document';
import { html, onNewWidth, onPrint, paper, svg } from '../dom';
import { plain, significant, tick } from '../numbers';
import { niceLevels } from '../workspace/contour';

const height = 300;
const [narrowest, widest] = [280, 720];
const inside = { left: 64, right: 16, top: 16, bottom: 46 };
/** Of a label of the axis of stiffness with its distance to the next [px]. */
const labelWidth = 52;

type Point = Remedy['present'];

/** From the stiff end to buckling; `buckles`: below the first of them. */
function stable({ curve }: Remedy): { points: Point[]; buckles: boolean } {
  let first = curve.length;
  while (first > 0 && (curve[first - 1]?.frequency_hz ?? 0) > 0) --first;
  return { points: curve.slice(first), buckles: first > 0 };
}

/** What the marks of the picture mean. */
export function stiffnessWords(remedy: Remedy, machine: string): string {
  const required = {
    found: 'Filled: required.',
    met_already: 'The present stiffness meets the goal.',
    out_of_reach: 'No stiffness of the curve meets the goal.',
  }[remedy.status];
  const below = stable(remedy).buckles ? ' The legs buckle below the first stiffness of the curve.' : '';
  return `Open circle: ${machine} machine. ${required} Dashed: goal.${below}`;
}

/** Stiffness on a logarithmic axis, and above it the drop [%] or the frequency [Hz]. */
function axesOf(remedy: Remedy, width: number) {
  const isDrop = remedy.goal.drop !== undefined;
  const y = (p: Point) => (isDrop ? 100 * p.drop : p.frequency_hz);
  const { points } = stable(remedy);
  const goal = isDrop ? 100 * (remedy.goal.drop ?? 0) : (remedy.goal.frequency_hz ?? 0);
  const x0 = points[0]?.stiffness_N_m ?? 1;
  const x1 = points[points.length - 1]?.stiffness_N_m ?? 10;
  const all = [...points.map(y), goal];
  const [y0, y1] = [Math.min(0, ...all), Math.max(...all) * 1.05];
  const [right, bottom] = [width - inside.right, height - inside.bottom];
  const px = (stiffness: number) => inside.left + (Math.log(stiffness / x0) / Math.log(x1 / x0)) * (right - inside.left);
  const py = (value: number) => bottom - ((value - y0) / (y1 - y0)) * (bottom - inside.top);
  return { isDrop, points, goal, x0, x1, y0, y1, y, px, py, right, bottom };
}

type Axes = ReturnType<typeof axesOf>;

function grid({ isDrop, x0, x1, y0, y1, px, py, right, bottom }: Axes): SVGElement[] {
  const parts: SVGElement[] = [];
  const ticks = magnitudeTicks(x0, x1).filter((stiffness) => px(stiffness) <= right - 8);
  const every = Math.ceil((ticks.length * labelWidth) / (right - inside.left));
  for (const stiffness of ticks.filter((_, k) => k % every === 0)) {
    const x = px(stiffness);
    parts.push(
      svg('line', { x1: x, x2: x, y1: inside.top, y2: bottom, class: 'grid' }),
      svg('text', { x, y: bottom + 16, 'text-anchor': 'middle' }, tick(stiffness)),
    );
  }
  for (const value of niceLevels(y0, y1)) {
    const y = py(value);
    parts.push(
      svg('line', { x1: inside.left, x2: right, y1: y, y2: y, class: 'grid' }),
      svg('text', { x: inside.left - 6, y: y + 4, 'text-anchor': 'end' }, significant(value, 4)),
    );
  }
  const middle = { 'text-anchor': 'middle' };
  parts.push(
    svg('text', { x: (inside.left + right) / 2, y: height - 8, ...middle }, 'stiffness of the guide sleeves, N/m'),
    svg('text', { x: 14, y: height / 2, ...middle, transform: `rotate(-90 14 ${height / 2})` }, isDrop ? 'largest drop, %' : 'lowest resonance, Hz'),
  );
  return parts;
}

/** With the value of the computed machine and the required one. */
function curve(remedy: Remedy, machine: string, width: number): SVGSVGElement {
  const axes = axesOf(remedy, width);
  const { isDrop, points, goal, y, px, py, right } = axes;
  const path = points
    .map((p, k) => `${k === 0 ? 'M' : 'L'}${px(p.stiffness_N_m).toFixed(2)} ${py(y(p)).toFixed(2)}`)
    .join('');
  const stiffness = (p: Point) =>
    `${p.softest_N_m === undefined ? '' : `${plain(p.softest_N_m)} to `}${plain(p.stiffness_N_m)} N/m`;
  const label = `${remedy.goal.words}: ${machine} ${stiffness(remedy.present)}, required ${stiffness(remedy.required)}`;
  const mark = (p: Point, r: number, kind: string, name: string) =>
    svg('circle', { cx: px(p.stiffness_N_m), cy: py(y(p)), r, class: kind, 'data-mark': name });
  return svg(
    'svg',
    {
      viewBox: `0 0 ${width} ${height}`,
      width,
      height,
      role: 'img',
      'aria-label': `${isDrop ? 'Largest drop' : 'Lowest resonance'} as a function of the stiffness of the guide sleeves; ${label}`,
      class: 'stiffness',
    },
    ...grid(axes),
    svg('line', { x1: inside.left, x2: right, y1: py(goal), y2: py(goal), class: 'wanted' }),
    svg('path', { d: path, class: 'line' }),
    mark(remedy.present, 6, 'nominal', 'present'),
    remedy.status === 'found' && mark(remedy.required, 5, 'required', 'required'),
  );
}

/** As wide as it stands in the page, so that its text keeps its size. */
export class StiffnessPicture {
  readonly element = html('figure', {});
  private printed = false;

  constructor(
    private readonly remedy: Remedy,
    private readonly machine: string,
  ) {
    this.draw();
    onNewWidth(this.element, () => this.draw());
    onPrint((printed) => {
      this.printed = printed;
      this.draw();
    });
  }

  private room(): number {
    if (this.printed) return paper;
    return Math.min(widest, Math.max(narrowest, this.element.clientWidth || widest));
  }

  private draw(): void {
    this.element.replaceChildren(curve(this.remedy, this.machine, this.room()));
  }
}
