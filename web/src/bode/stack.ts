// Diagrams over one frequency axis, one below the other, that share their cursor.

import uPlot from 'uplot';
import { describeCanvas, html, onPrint, paper } from '../dom';
import { axisStyle, palette } from '../palette';
import { frequencyAxis } from './axes';

export interface Diagram {
  /** For screen readers. */
  name: string;
  label: string;
  height: number;
  /** Frequencies [Hz], then the values of each series. */
  data: uPlot.AlignedData;
  series: uPlot.Series[];
  bands?: uPlot.Band[];
  scale: uPlot.Scale;
  axis: uPlot.Axis;
}

/** Width of diagrams in `element` [px]. */
export const widthIn = (element: HTMLElement): number => Math.max(240, element.clientWidth || 600);

export function fitWidth(plots: uPlot[], width: number): void {
  for (const plot of plots) if (plot.width !== width) plot.setSize({ width, height: plot.height });
}

/** The diagrams in `element` have its width, or on paper that of the paper. */
export function followWidth(element: HTMLElement, plots: () => uPlot[]): void {
  let printed = false;
  const fit = () => fitWidth(plots(), printed ? paper : widthIn(element));
  new ResizeObserver(fit).observe(element);
  onPrint((now) => {
    printed = now;
    fit();
  });
}

export class DiagramStack {
  readonly element = html('div', { class: 'plots' });
  private plots: uPlot[] = [];

  /** `key`: diagrams of one key share their cursor. */
  constructor(private readonly key: string) {
    followWidth(this.element, () => this.plots);
  }

  show(diagrams: Diagram[]): void {
    for (const plot of this.plots) plot.destroy();
    this.plots = diagrams.map((diagram, k) => this.plot(diagram, k + 1 === diagrams.length));
  }

  private plot(diagram: Diagram, last: boolean): uPlot {
    const axis = axisStyle(palette());
    const f = diagram.data[0];
    const logarithmic = f.length > 1 && f[0] > 0 && f[f.length - 1] > 20 * f[0];
    const plot = new uPlot(
      {
        width: widthIn(this.element),
        height: diagram.height + (last ? 22 : 0),
        padding: [8, 12, 0, 0],
        legend: { show: false },
        cursor: { y: false, sync: { key: this.key }, drag: { x: true, y: false } },
        scales: {
          x: { time: false, distr: logarithmic ? 3 : 1, range: (_, min, max) => [min, max] },
          y: diagram.scale,
        },
        axes: [
          { ...axis, size: last ? 44 : 24, ...frequencyAxis(logarithmic, last) },
          { ...axis, size: 66, label: diagram.label, labelSize: 18, ...diagram.axis },
        ],
        series: diagram.series,
        ...(diagram.bands ? { bands: diagram.bands } : {}),
      },
      diagram.data,
      this.element,
    );
    describeCanvas(plot.root, diagram.name);
    return plot;
  }
}
