// One measured response with its 95 % band and the fit, and the coherence of its output.

import uPlot from 'uplot';
import { html } from '../dom';
import type { Complex } from '../complex';
import { magnitude, phase } from '../mechanics/response';
import { tick } from '../numbers';
import { axisStyle, palette, type Palette } from '../palette';
import { logTicks, magnitudeTicks } from '../bode/picture';
import type { Identification } from './types';

interface Diagram {
  name: string;
  label: string;
  height: number;
  data: uPlot.AlignedData;
  series: uPlot.Series[];
  bands?: uPlot.Band[];
  scale: uPlot.Scale;
  axis: Partial<uPlot.Axis>;
}

/** Phases [°], none where they jump by a turn: the line breaks there. */
const unbroken = (phases: (number | null)[]): (number | null)[] =>
  phases.map((value, k) => {
    const before = phases[k - 1];
    return value !== null && before !== null && k > 0 && Math.abs(value - (before as number)) > 180
      ? null
      : value;
  });

/** "m/N", "rad/(N m)" */
function unitText(output: string, input: string): string {
  if (input === '' || input === '1') return output;
  return `${output}/${/[ /]/.test(input) ? `(${input})` : input}`;
}

export class ResponsePlots {
  readonly element = html('div', { class: 'plots' });
  private plots: uPlot[] = [];

  constructor(private readonly data: Identification) {
    new ResizeObserver(() => {
      for (const plot of this.plots)
        if (plot.width !== this.width()) plot.setSize({ width: this.width(), height: plot.height });
    }).observe(this.element);
  }

  show(output: number, input: number, fit: Complex[] | null): void {
    for (const plot of this.plots) plot.destroy();
    const diagrams = [this.magnitudes(output, input, fit), this.phases(output, input, fit)];
    const coherence = this.data.responses.multiple_coherence?.[output];
    if (coherence) diagrams.push(this.coherence(coherence));
    this.plots = diagrams.map((diagram, k) => this.plot(diagram, k + 1 === diagrams.length));
  }

  private width(): number {
    return Math.max(240, this.element.clientWidth || 600);
  }

  private get frequency(): number[] {
    return this.data.responses.frequency_hz;
  }

  private measured(output: number, input: number): Complex[] {
    const h = this.data.responses.response[output][input];
    return h.re.map((re, k) => ({ re, im: h.im[k] }));
  }

  private lines(colours: Palette): { measured: uPlot.Series; fit: uPlot.Series } {
    const points = { show: false };
    return {
      measured: { label: 'measured', stroke: colours.flexible, width: 1.5, points },
      fit: { label: 'fit', stroke: colours.rigid, width: 1.8, dash: [6, 4], points },
    };
  }

  private magnitudes(output: number, input: number, fit: Complex[] | null): Diagram {
    const { response, radius_95 } = this.data.responses;
    const H = this.measured(output, input).map(magnitude);
    const deviation = response[output][input].deviation;
    const radius = H.map((_, k) => (deviation && radius_95 ? radius_95 * deviation[k] : 0));
    const positive = (value: number) => (value > 0 ? value : null);
    const { measured, fit: fitted } = this.lines(palette());
    const edge = { stroke: 'transparent', width: 0, points: { show: false } };
    const unit = unitText(this.data.outputs[output].unit, this.data.inputs[input].unit);
    return {
      name: 'Magnitude',
      label: unit,
      height: 300,
      data: [
        this.frequency,
        H.map((v, k) => positive(v + radius[k])),
        H.map((v, k) => positive(Math.max(v - radius[k], v / 10))),
        H.map(positive),
        fit ? fit.map((h) => positive(magnitude(h))) : H.map(() => null),
      ] as uPlot.AlignedData,
      series: [{}, edge, edge, measured, fitted],
      bands: [{ series: [1, 2], fill: `${palette().flexible}33` }],
      scale: { distr: 3 },
      axis: {
        splits: (plot) => magnitudeTicks(plot.scales['y']!.min!, plot.scales['y']!.max!),
        filter: (_, splits) => splits,
        values: (_, splits) => splits.map(tick),
      },
    };
  }

  private phases(output: number, input: number, fit: Complex[] | null): Diagram {
    const H = this.measured(output, input);
    const { measured, fit: fitted } = this.lines(palette());
    return {
      name: 'Phase',
      label: 'phase',
      height: 160,
      data: [
        this.frequency,
        H.map(phase),
        fit ? unbroken(fit.map(phase)) : H.map(() => null),
      ] as uPlot.AlignedData,
      // points: a phase that jumps between ±180° would draw a thicket of lines
      series: [
        {},
        { ...measured, paths: () => null, points: { show: true, size: 2.5, fill: palette().flexible } },
        fitted,
      ],
      scale: { distr: 1, range: [-185, 185] },
      axis: {
        splits: () => [-180, -90, 0, 90, 180],
        values: (_, splits) => splits.map((v) => `${v}°`.replace('-', '−')),
      },
    };
  }

  private coherence(values: number[]): Diagram {
    return {
      name: 'Coherence',
      label: 'coherence',
      height: 140,
      data: [this.frequency, values],
      series: [{}, this.lines(palette()).measured],
      scale: { distr: 1, range: [0, 1.02] },
      axis: { splits: () => [0, 0.5, 1] },
    };
  }

  private plot(diagram: Diagram, last: boolean): uPlot {
    const colours = palette();
    const axis = axisStyle(colours);
    const f = this.frequency;
    const logarithmic = f[f.length - 1] > 20 * f[0] && f[0] > 0;
    const plot = new uPlot(
      {
        width: this.width(),
        height: diagram.height + (last ? 22 : 0),
        padding: [8, 12, 0, 0],
        legend: { show: false },
        cursor: { y: false, sync: { key: 'measured' }, drag: { x: true, y: false } },
        scales: {
          x: { time: false, distr: logarithmic ? 3 : 1, range: (_, min, max) => [min, max] },
          y: diagram.scale,
        },
        axes: [
          {
            ...axis,
            size: last ? 44 : 24,
            ...(last ? { label: 'frequency in Hz' } : {}),
            ...(logarithmic
              ? {
                  splits: (p: uPlot) =>
                    logTicks(p.scales['x']!.min!, p.scales['x']!.max!, p.width < 520),
                  filter: (_: uPlot, splits: number[]) => splits,
                  values: (_: uPlot, splits: number[]) =>
                    splits.map((v) => String(Number(v.toPrecision(3)))),
                }
              : {}),
          },
          { ...axis, size: 66, label: diagram.label, labelSize: 18, ...diagram.axis },
        ],
        series: diagram.series,
        ...(diagram.bands ? { bands: diagram.bands } : {}),
      },
      diagram.data,
      this.element,
    );
    const canvas = plot.root.querySelector('canvas');
    canvas?.setAttribute('role', 'img');
    canvas?.setAttribute('aria-label', `${diagram.name} of the measured response over frequency`);
    return plot;
  }
}
