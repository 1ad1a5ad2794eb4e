// A field as crisp cells with contours, a scale, and a cross that is dragged.

import { map, mapStatus } from '../core/core';
import { directions } from '../document';
import { html, onNewWidth, onPrint, paper, svg } from '../dom';
import { keepInPlace } from '../in_place';
import { significant } from '../numbers';
import { contour, niceLevels } from './contour';
import { finest, type Field } from './field';
import { displacementText, unitOf, type Quantity } from './quantities';

const height = 420;
const [narrowest, widest] = [280, 900];
const inside = { left: 58, right: 78, top: 12, bottom: 44 };

/** As the pictures of `hydrapod map`. */
const stops: [number, [number, number, number]][] = [
  [0, [13, 8, 135]],
  [0.35, [156, 23, 158]],
  [0.7, [237, 121, 83]],
  [1, [240, 249, 33]],
];

export function colour(share: number): string {
  const at = Math.min(1, Math.max(0, share));
  const k = Math.max(1, stops.findIndex(([stop]) => at <= stop));
  const [[from, a], [to, b]] = [stops[k - 1]!, stops[k]!];
  const mix = (c: number) => Math.round(a[c]! + ((b[c]! - a[c]!) * (at - from)) / (to - from));
  return `rgb(${mix(0)},${mix(1)},${mix(2)})`;
}

/**
 * Range of the scale: all values, without the 3 % at an end that would take a third of it. Next to
 * buckling frequencies go to zero, and the rest of the map would have one colour.
 */
export function scaleOf(values: number[]): Scale {
  const sorted = [...values].sort((a, b) => a - b);
  const at = (share: number) => sorted[Math.round(share * (sorted.length - 1))] ?? Number.NaN;
  const [least, most, low, high] = [at(0), at(1), at(0.03), at(0.97)];
  const far = (end: number, inner: number) => Math.abs(end - inner) > (most - least) / 3;
  const [from, to] = [far(least, low) ? low : least, far(most, high) ? high : most];
  return { from, to, cutBelow: from > least, cutAbove: to < most };
}

interface Scale {
  from: number;
  to: number;
  cutBelow: boolean;
  cutAbove: boolean;
}

const plain = (value: number): string => significant(value, 4);

export class HeatMap {
  private readonly cells = svg('g', { class: 'cells' });
  private readonly axes = svg('g', { class: 'axes' });
  private readonly cross = svg('g', { class: 'cross' });
  private readonly picture = svg('svg', { class: 'heat-map', role: 'img', 'aria-label': 'Map of the workspace, not yet calculated' }, this.cells, this.axes, this.cross);
  private readonly reasons = html('ul', { class: 'legend' });
  readonly element = html('div', { class: 'heat-map-box' }, this.picture, this.reasons);
  private width = widest;
  private printed = false;
  private field: Field | null = null;
  private marked: readonly number[] | null = null;
  private shown: [field: Field, quantity: Quantity, title: string] | null = null;

  /** `moved` gets displacements in the two directions [m, rad]; `done` ends a drag. */
  constructor(moved: (across: number, up: number) => void, done: () => void) {
    let box = new DOMRect(); // where the picture stays while it is dragged
    const move = (event: PointerEvent) => {
      if (!this.field) return;
      const [x, y] = [event.clientX - box.left, event.clientY - box.top].map((d) => (d * this.width) / box.width) as [number, number];
      moved(this.value(this.field.across, (x - inside.left) / this.plotWidth), this.value(this.field.up, (height - inside.bottom - y) / this.plotHeight));
    };
    this.picture.addEventListener('pointerdown', (event) => {
      this.picture.setPointerCapture(event.pointerId);
      event.preventDefault();
      box = this.picture.getBoundingClientRect();
      keepInPlace(this.picture, document.querySelectorAll('main > section'));
      move(event);
    });
    this.picture.addEventListener('pointermove', (event) => this.picture.hasPointerCapture(event.pointerId) && move(event));
    onNewWidth(this.picture, () => this.redraw());
    onPrint((printed) => {
      this.printed = printed;
      this.redraw();
    });
    this.picture.addEventListener('pointerup', done);
    this.picture.addEventListener('pointercancel', done);
  }

  /** For another width. */
  private redraw(): void {
    if (!this.shown) return;
    this.show(...this.shown);
    if (this.marked) this.mark(this.marked);
  }

  private get plotWidth(): number {
    return this.width - inside.left - inside.right;
  }

  private get plotHeight(): number {
    return height - inside.top - inside.bottom;
  }

  private value(direction: number, share: number): number {
    return this.field!.at(direction, Math.min(1, Math.max(0, share)), 2);
  }

  private share(direction: number, value: number): number {
    const [from, to] = this.field!.ranges[direction]!;
    return to > from ? (value - from) / (to - from) : 0.5;
  }

  private x = (value: number): number => inside.left + this.plotWidth * this.share(this.field!.across, value);
  private y = (value: number): number => height - inside.bottom - this.plotHeight * this.share(this.field!.up, value);

  show(field: Field, quantity: Quantity, title: string): void {
    this.field = field;
    this.shown = [field, quantity, title];
    this.width = this.printed ? paper : Math.min(widest, Math.max(narrowest, this.element.clientWidth || widest));
    this.picture.setAttribute('viewBox', `0 0 ${this.width} ${height}`);
    this.picture.setAttribute('aria-label', title);
    const { count } = field;
    const values: number[][] = [];
    const statuses = new Set<number>();
    for (let j = 0; j < count; ++j)
      values.push(
        Array.from({ length: count }, (_, i) => {
          const row = field.row(i, j);
          if (row[map.status] !== 0) statuses.add(row[map.status] as number);
          return row[map.status] === 0 ? quantity.of(row) : Number.NaN;
        }),
      );
    const scale = scaleOf(values.flat().filter(Number.isFinite));
    this.drawCells(values, scale);
    this.drawAxes(values, scale, quantity);
    this.reasons.replaceChildren(
      ...[...statuses].sort().map((status) => html('li', {}, html('i', { class: `status status-${status}` }), mapStatus[status] ?? '')),
    );
  }

  /** Cells are as large as their points are apart; those of the edge are cut by the frame. */
  private drawCells(values: number[][], { from, to }: Scale): void {
    const field = this.field as Field;
    const count = values.length;
    const [w, h] = [this.plotWidth / (count - 1), this.plotHeight / (count - 1)];
    const [right, bottom] = [inside.left + this.plotWidth, height - inside.bottom];
    const rects = values.flatMap((line, j) =>
      line.map((value, i) => {
        const [x0, y0] = [inside.left + (i - 0.5) * w, bottom - (j + 0.5) * h];
        const [x, y] = [Math.max(inside.left, x0), Math.max(inside.top, y0)];
        const place = { x, y, width: Math.min(right, x0 + w) - x, height: Math.min(bottom, y0 + h) - y };
        return Number.isFinite(value)
          ? svg('rect', { ...place, fill: colour(to > from ? (value - from) / (to - from) : 0.5) })
          : svg('rect', { ...place, class: `status-${field.row(i, j)[map.status]}` });
      }),
    );
    this.cells.replaceChildren(...rects);
  }

  private drawAxes(values: number[][], scale: Scale, quantity: Quantity): void {
    const field = this.field as Field;
    const parts: SVGElement[] = [];
    const [right, bottom] = [inside.left + this.plotWidth, height - inside.bottom];
    const levels = niceLevels(scale.from, scale.to);
    const place = ([i, j]: [number, number]) =>
      `${(inside.left + (this.plotWidth * i) / (values.length - 1)).toFixed(1)},${(bottom - (this.plotHeight * j) / (values.length - 1)).toFixed(1)}`;
    const path = levels.flatMap((level) => contour(values, level).map(([a, b]) => `M${place(a)}L${place(b)}`)).join('');
    parts.push(svg('path', { class: 'contour', d: path }));
    for (const [direction, horizontal] of [[field.across, true], [field.up, false]] as const) {
      const [unit, size] = unitOf(direction);
      const [from, to] = field.ranges[direction]!;
      for (const tick of niceLevels(from / size, to / size)) {
        const at = horizontal ? this.x(tick * size) : this.y(tick * size);
        parts.push(
          horizontal
            ? svg('text', { x: at, y: bottom + 16, 'text-anchor': 'middle' }, plain(tick))
            : svg('text', { x: inside.left - 6, y: at + 4, 'text-anchor': 'end' }, plain(tick)),
        );
      }
      const name = `${directions[direction]} in ${unit}`;
      const middle = (inside.top + bottom) / 2;
      parts.push(
        horizontal
          ? svg('text', { x: (inside.left + right) / 2, y: height - 8, 'text-anchor': 'middle' }, name)
          : svg('text', { x: 13, y: middle, 'text-anchor': 'middle', transform: `rotate(-90 13 ${middle})` }, name),
      );
    }
    parts.push(svg('rect', { class: 'frame', x: inside.left, y: inside.top, width: this.plotWidth, height: this.plotHeight }));
    if (Number.isFinite(scale.from)) parts.push(...this.drawScale(scale, levels, quantity));
    this.axes.replaceChildren(...parts);
  }

  private drawScale({ from, to, cutBelow, cutAbove }: Scale, levels: number[], quantity: Quantity): SVGElement[] {
    const steps = 40;
    const x = this.width - inside.right + 16;
    const y = (share: number) => height - inside.bottom - this.plotHeight * share;
    const bars = Array.from({ length: steps }, (_, k) =>
      svg('rect', { x, width: 14, y: y((k + 1) / steps), height: this.plotHeight / steps + 0.5, fill: colour((k + 0.5) / steps) }),
    );
    const shares = levels.map((level) => (to > from ? (level - from) / (to - from) : 0.5));
    const hidden = (share: number) => (cutBelow && share < 0.04) || (cutAbove && share > 0.96);
    const marks = levels.flatMap((level, k) =>
      hidden(shares[k]!) ? [] : [svg('text', { x: x + 18, y: y(shares[k]!) + 4 }, plain(level))],
    );
    const cuts = [
      ...(cutBelow ? [svg('text', { x: x + 16, y: y(0) + 4 }, '◂ less')] : []),
      ...(cutAbove ? [svg('text', { x: x + 16, y: y(1) + 8 }, '◂ more')] : []),
    ];
    return [...bars, ...marks, ...cuts, svg('text', { x, y: height - inside.bottom + 16 }, quantity.unit)];
  }

  /** `displaced`: of all directions [m, rad]. */
  mark(displaced: readonly number[]): void {
    this.marked = displaced;
    const { field } = this;
    if (!field || field.count === 0) return;
    const [x, y] = [this.x(displaced[field.across]!), this.y(displaced[field.up]!)];
    const [right, bottom] = [inside.left + this.plotWidth, height - inside.bottom];
    const lines = (kind: string) => [
      svg('line', { class: kind, x1: x, x2: x, y1: inside.top, y2: bottom }),
      svg('line', { class: kind, x1: inside.left, x2: right, y1: y, y2: y }),
    ];
    this.cross.replaceChildren(...lines('halo'), ...lines('hair'), svg('circle', { cx: x, cy: y, r: 7 }));
  }

  /** Where the quantity is least, of the level that is shown. */
  least(quantity: Quantity): { value: number; displaced: [number, number]; text: string } | null {
    const { field } = this;
    if (!field) return null;
    let best: { value: number; displaced: [number, number] } | null = null;
    for (let j = 0; j < field.count; ++j)
      for (let i = 0; i < field.count; ++i) {
        const row = field.row(i, j);
        const value = row[map.status] === 0 ? quantity.of(row) : Number.NaN;
        if (Number.isFinite(value) && (!best || value < best.value))
          best = { value, displaced: [field.at(field.across, i, field.count), field.at(field.up, j, field.count)] };
      }
    if (!best) return null;
    const [across, up] = best.displaced;
    const text = `${plain(best.value)} ${quantity.unit} at ${directions[field.across]} ${displacementText(field.across, across)}, ${directions[field.up]} ${displacementText(field.up, up)}`;
    return { ...best, text: field.count < finest ? `${text} so far` : text };
  }
}
