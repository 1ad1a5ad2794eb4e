// Two linked uPlot diagrams: magnitude and phase over a logarithmic frequency axis.

import uPlot from 'uplot';
import { describeCanvas, html } from '../dom';
import { magnitude, type Complex } from '../complex';
import { axisStyle, type Palette } from '../palette';
import { frequencyAxis, magnitudeAxis, phaseAxis } from './axes';
import { unitOf, type Curves, type Mark } from './curves';
import { clusters } from './picture';
import { phaseCut, phaseLine, phaseScale } from './phase';
import { followWidth, widthIn } from './stack';

export interface PlotEvents {
  cursor(index: number | null): void;
  /** A band [Hz] was dragged open. */
  zoom(from: number, to: number): void;
  reset(): void;
}

const left = 74;

export class BodePlot {
  readonly element = html('div', { class: 'plots' });
  private plots: uPlot[] = [];
  private curves: Curves | null = null;
  /** The cursor follows the pointer; else it was put where it is. */
  private pointed = false;

  constructor(private readonly events: PlotEvents) {
    followWidth(this.element, () => this.plots);
    this.element.addEventListener('pointermove', () => (this.pointed = true), { capture: true });
  }

  /** Draws anew: curves, band and colours. */
  show(curves: Curves, colours: Palette): void {
    this.curves = curves;
    for (const plot of this.plots) plot.destroy();
    const size = widthIn(this.element);
    const x = curves.frequency;
    const shown = [...(curves.flexible ? [curves.flexible] : []), curves.rigid];
    const of = (values: (H: Complex[]) => (number | null)[]) => [x, ...shown.map(values)] as uPlot.AlignedData;
    const positive = (H: Complex[]) => H.map((h) => magnitude(h) || null);
    const cut = phaseCut(shown);
    this.plots = [
      new uPlot(this.options('magnitude', size, colours), of(positive), this.element),
      new uPlot(this.options('phase', size, colours), of((H) => phaseLine(H, cut)), this.element),
    ];
    ['Magnitude', 'Phase'].forEach((name, k) =>
      describeCanvas(this.plots[k].root, `${name} over frequency; the values under the cursor stand in the table below.`),
    );
  }

  /** Moves the cursor to point `index` of the curves. */
  setCursor(index: number): void {
    const f = this.curves?.frequency[index];
    if (f === undefined) return;
    this.pointed = false;
    const { plots } = this;
    // a plot made just now has its axes after the pending tasks
    queueMicrotask(() => {
      if (plots !== this.plots) return;
      for (const plot of plots) plot.setCursor({ left: plot.valToPos(f, 'x'), top: 10 }, false);
    });
  }

  private options(kind: 'magnitude' | 'phase', width: number, colours: Palette): uPlot.Options {
    const curves = this.curves as Curves;
    const axis = axisStyle(colours);
    const line = (label: string, stroke: string, dash?: number[]) => ({
      label,
      stroke,
      width: dash ? 1.5 : 2,
      points: { show: false },
      ...(dash ? { dash } : {}),
    });
    const isMagnitude = kind === 'magnitude';
    return {
      width,
      height: isMagnitude ? 320 : 190,
      padding: [isMagnitude ? 18 : 8, 12, 0, 0],
      legend: { show: false },
      cursor: {
        drag: { x: true, y: false, setScale: false },
        sync: { key: 'bode', setSeries: false },
        y: false,
        focus: { prox: -1 },
        bind: { dblclick: () => () => (this.events.reset(), null) },
      },
      scales: {
        x: { distr: 3, time: false, range: (_, min, max) => [min, max] },
        y: isMagnitude
          ? { distr: 3, range: (_, min, max) => [min / 1.3, max * 1.6] }
          : phaseScale,
      },
      axes: [
        {
          ...axis,
          size: isMagnitude ? 26 : 44,
          ...frequencyAxis(true, !isMagnitude),
        },
        {
          ...axis,
          size: left - 8,
          label: isMagnitude ? unitOf(curves.pair) : 'phase',
          labelSize: 18,
          ...(isMagnitude ? magnitudeAxis : phaseAxis),
        },
      ],
      series: [
        {},
        ...(curves.flexible ? [line('flexible legs', colours.flexible)] : []),
        line('rigid legs', colours.rigid, [6, 4]),
      ],
      hooks: {
        setCursor: [(plot) => this.pointed && this.events.cursor(plot.cursor.idx ?? null)],
        setSelect: [(plot) => this.selected(plot)],
        draw: isMagnitude ? [(plot) => this.drawMarks(plot, colours)] : [],
      },
    };
  }

  private selected(plot: uPlot): void {
    const { left: from, width } = plot.select;
    if (width < 4) return;
    this.events.zoom(plot.posToVal(from, 'x'), plot.posToVal(from + width, 'x'));
  }

  private drawMarks(plot: uPlot, colours: Palette): void {
    const { ctx } = plot;
    const at = (mark: Mark) =>
      [plot.valToPos(mark.frequency, 'x', true), plot.valToPos(mark.magnitude, 'y', true)] as const;
    const ratio = devicePixelRatio;
    ctx.save();
    ctx.lineWidth = 1.4 * ratio;
    const ring = (mark: Mark, fill: boolean) => {
      const [x, y] = at(mark);
      ctx.beginPath();
      ctx.arc(x, y, 3.2 * ratio, 0, 2 * Math.PI);
      if (fill) ctx.fill();
      ctx.stroke();
    };
    ctx.strokeStyle = colours.rigid;
    for (const mark of this.curves!.rigidMarks) ring(mark, false);
    ctx.strokeStyle = ctx.fillStyle = colours.flexible;
    for (const mark of this.curves!.marks) ring(mark, true);
    ctx.font = `600 ${12 * ratio}px system-ui, sans-serif`;
    ctx.textAlign = 'center';
    for (const { mark, text } of clusters(this.curves!.marks, (m) => at(m)[0], 16 * ratio)) {
      const [x, y] = at(mark);
      ctx.fillText(text, x, y - 7 * ratio);
    }
    ctx.restore();
  }
}
