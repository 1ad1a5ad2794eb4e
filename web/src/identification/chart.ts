// The stabilisation chart: poles by frequency and model order, and the mode indicator.

import { html, onPrint, paper, svg } from '../dom';
import { fixed, hertz } from '../numbers';
import { palette } from '../palette';
import type { Choice } from './choice';
import type { Agreement, ChartPole, Identification } from './types';

const height = 420;
const margin = { left: 44, right: 46, top: 12, bottom: 42 };
const reach = 14; // px from a mark at which a click still means it

/** Colours that stand out on light and dark ground, and shapes besides. */
export const agreements: { agrees: Agreement; label: string; colour: () => string }[] = [
  { agrees: 'new', label: 'new', colour: () => palette().faint },
  { agrees: 'frequency', label: 'frequency agrees with the previous order', colour: () => palette().piston },
  { agrees: 'damping', label: 'and damping', colour: () => palette().rigid },
  { agrees: 'vector', label: 'and shape', colour: () => palette().flexible },
];

interface Mark {
  pole: ChartPole;
  order: number;
  x: number;
  y: number;
}

/** The outline of a mark around the origin. */
export function markPath(agrees: Agreement): string {
  if (agrees === 'new') return 'M-2.6 0a2.6 2.6 0 1 0 5.2 0a2.6 2.6 0 1 0-5.2 0';
  if (agrees === 'frequency') return 'M0-3.6L3.4 2.6L-3.4 2.6Z';
  if (agrees === 'damping') return 'M0-4L4 0L0 4L-4 0Z';
  return 'M-3.2 0a3.2 3.2 0 1 0 6.4 0a3.2 3.2 0 1 0-6.4 0';
}

/** Round numbers between two others, some eight of them. */
export function ticks(from: number, to: number, wanted = 8): number[] {
  const rough = (to - from) / wanted;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * decade).find((value) => value >= rough) ?? rough;
  const values: number[] = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to * (1 + 1e-12); ++k)
    values.push(k * step);
  return values;
}

export class Chart {
  /** A mark was clicked. */
  onSelect: (pole: ChartPole, order: number) => void = () => {};
  /** The mark whose shape is shown. */
  private selected: ChartPole | null = null;
  readonly element = html('div', { class: 'chart' });
  private readonly readout = html('p', { class: 'note how', 'aria-live': 'polite' });
  private marks: Mark[] = [];
  private picture: SVGSVGElement = svg('svg');
  private width = 0;
  private printed = false;

  constructor(
    private readonly data: Identification,
    private readonly choice: Choice,
  ) {
    new ResizeObserver(() => {
      if (this.room() !== this.width) this.draw();
    }).observe(this.element);
    onPrint((printed) => {
      this.printed = printed;
      this.draw();
    });
    this.element.append(this.picture, this.readout);
    this.tell(null);
  }

  /** Marks a pole as the one whose shape is shown; null: none. */
  select(pole: ChartPole | null): void {
    this.selected = pole;
    this.draw();
  }

  /** Marks as drawn, for tests: centre in px of the picture. */
  positions(): { order: number; frequency_hz: number; x: number; y: number }[] {
    return this.marks.map(({ pole, order, x, y }) => ({
      order,
      frequency_hz: pole.frequency_hz,
      x,
      y,
    }));
  }

  draw(): void {
    const colours = palette();
    this.width = this.room();
    this.picture = svg('svg', {
      width: this.width,
      height,
      viewBox: `0 0 ${this.width} ${height}`,
      role: 'img',
      'aria-label':
        `Stabilisation chart: poles of model orders up to ${this.highest} by frequency; the table ` +
        'below lists the selected poles and shows their shapes.',
      'data-control': 'chart',
    });
    this.axes(colours.grid, colours.faint);
    this.indicator(colours.ghost);
    this.chosenLines(colours.text);
    this.drawMarks(colours.text);
    this.picture.addEventListener('click', (event) => {
      const mark = this.near(event);
      if (mark) this.onSelect(mark.pole, mark.order);
    });
    this.picture.addEventListener('pointermove', (event) => this.tell(this.near(event)));
    this.element.replaceChildren(this.picture, this.readout);
  }

  private get highest(): number {
    return this.data.stabilisation[this.data.stabilisation.length - 1]?.order ?? 1;
  }

  private room(): number {
    if (this.printed) return paper;
    return Math.max(280, this.element.clientWidth || 900);
  }

  private x(frequency: number): number {
    const [from, to] = this.data.band_hz;
    return margin.left + ((this.width - margin.left - margin.right) * (frequency - from)) / (to - from);
  }

  private y(order: number): number {
    return height - margin.bottom - ((height - margin.top - margin.bottom) * order) / (this.highest + 2);
  }

  private text(x: number, y: number, anchor: string, fill: string, words: string): void {
    this.picture.append(svg('text', { x, y, 'text-anchor': anchor, fill, 'font-size': 12 }, words));
  }

  private axes(grid: string, faint: string): void {
    const bottom = height - margin.bottom;
    const right = this.width - margin.right;
    for (const f of ticks(...this.data.band_hz, this.width < 520 ? 5 : 9)) {
      const x = this.x(f);
      this.picture.append(svg('line', { x1: x, x2: x, y1: margin.top, y2: bottom, stroke: grid }));
      this.text(x, bottom + 16, 'middle', faint, String(Number(f.toPrecision(4))));
    }
    for (const order of ticks(0, this.highest, 8)) {
      const y = this.y(order);
      this.picture.append(svg('line', { x1: margin.left, x2: right, y1: y, y2: y, stroke: grid }));
      this.text(margin.left - 6, y + 4, 'end', faint, String(order));
    }
    this.text((margin.left + right) / 2, height - 6, 'middle', faint, 'frequency in Hz');
    const title = svg(
      'text',
      { 'text-anchor': 'middle', fill: faint, 'font-size': 12, transform: `translate(12 ${height / 2}) rotate(-90)` },
      'model order',
    );
    this.picture.append(title);
  }

  /** Singular values in dB, on an axis at the right. */
  private indicator(stroke: string): void {
    const { frequency_hz, values } = this.data.indicator;
    const dB = values.map((row) => row.map((v) => 20 * Math.log10(Math.max(v, 1e-300))));
    const all = dB.slice(0, 2).flat();
    const low = all.reduce((a, b) => Math.min(a, b), Infinity);
    const high = all.reduce((a, b) => Math.max(a, b), -Infinity);
    if (!(high > low)) return;
    const top = margin.top + 8;
    const bottom = height - margin.bottom - 4;
    const y = (value: number) => bottom - ((bottom - top) * (value - low)) / (high - low);
    // the smaller values are mostly noise: the curves may end at the lower edge
    const frame = svg('rect', { x: margin.left, y: margin.top, width: this.width - margin.left - margin.right, height: height - margin.top - margin.bottom });
    const curves = svg('g', { 'clip-path': 'url(#chart-frame)' });
    this.picture.append(svg('clipPath', { id: 'chart-frame' }, frame), curves);
    dB.forEach((row, s) => {
      const path = row
        .map((v, k) => `${k ? 'L' : 'M'}${this.x(frequency_hz[k]).toFixed(1)} ${y(v).toFixed(1)}`)
        .join('');
      curves.append(
        svg('path', { class: 'indicator', d: path, fill: 'none', stroke, 'stroke-width': s ? 0.8 : 1.4 }),
      );
    });
    const { faint } = palette();
    for (const value of ticks(low, high, 5))
      this.text(this.width - margin.right + 5, y(value) + 4, 'start', faint, fixed(value, 0));
    this.text(this.width - 4, height - 6, 'end', faint, 'dB');
  }

  private chosenLines(stroke: string): void {
    for (const pole of this.choice.active) {
      const x = this.x(pole.frequency_hz);
      this.picture.append(
        svg('line', {
          x1: x,
          x2: x,
          y1: margin.top,
          y2: height - margin.bottom,
          stroke,
          'stroke-width': 0.8,
          'stroke-dasharray': '2 3',
        }),
      );
    }
  }

  private drawMarks(ring: string): void {
    this.marks = [];
    const [from, to] = this.data.band_hz;
    const layer = svg('g');
    for (const { order, poles } of this.data.stabilisation)
      for (const pole of poles) {
        if (!pole.stable || pole.frequency_hz < from || pole.frequency_hz > to) continue;
        const mark = { pole, order, x: this.x(pole.frequency_hz), y: this.y(order) };
        this.marks.push(mark);
        const colour = agreements.find((a) => a.agrees === pole.agrees)?.colour() ?? ring;
        const on = this.choice.isOn(pole);
        layer.append(
          svg('path', {
            class: 'mark',
            'data-order': order,
            'data-agrees': pole.agrees,
            'data-on': String(on),
            d: markPath(pole.agrees),
            transform: `translate(${mark.x.toFixed(2)} ${mark.y.toFixed(2)})`,
            fill: pole.agrees === 'new' ? 'none' : colour,
            stroke: on ? ring : colour,
            'stroke-width': on ? 1.3 : 1,
          }),
        );
      }
    this.picture.append(layer);
    const chosen = this.marks.find(({ pole }) => pole === this.selected);
    if (chosen)
      this.picture.append(
        svg('circle', { class: 'selected', cx: chosen.x, cy: chosen.y, r: 8, fill: 'none', stroke: ring, 'stroke-width': 2 }),
      );
  }

  private near(event: MouseEvent): Mark | null {
    const box = this.picture.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    let best: Mark | null = null;
    let least = reach;
    for (const mark of this.marks) {
      const distance = Math.hypot(mark.x - x, mark.y - y);
      if (distance < least) [best, least] = [mark, distance];
    }
    return best;
  }

  private tell(mark: Mark | null): void {
    if (!mark) {
      this.readout.textContent = 'Click a pole to see the machine move in its shape.';
      return;
    }
    const { pole, order } = mark;
    const of = this.choice.of(pole);
    const what = of?.kind === 'mode' ? `, of mode ${of.number}` : of?.kind === 'heavy' ? ', heavily damped' : '';
    this.readout.textContent =
      `Order ${order}: ${hertz(pole.frequency_hz)} Hz, ${fixed(100 * pole.damping_ratio, 2)} % damping${what}`;
  }
}
