// One measured response with its 95 % band and the fit, and the coherence of its output.

import type uPlot from 'uplot';
import { magnitudeAxis, phaseAxis } from '../bode/axes';
import { asPoints } from '../bode/overlay';
import { phaseCut, phaseLine, phaseScale, withinTurn } from '../bode/phase';
import { DiagramStack, type Diagram } from '../bode/stack';
import { magnitude, phase, type Complex } from '../complex';
import { palette, type Palette } from '../palette';
import type { Identification } from './types';

/** "m/N", "rad/(N m)" */
function unitText(output: string, input: string): string {
  if (input === '' || input === '1') return output;
  return `${output}/${/[ /]/.test(input) ? `(${input})` : input}`;
}

const nameOf = (quantity: string): string => `${quantity} of the measured response over frequency`;

export class ResponsePlots {
  private readonly stack = new DiagramStack('measured');
  readonly element = this.stack.element;

  constructor(private readonly data: Identification) {}

  show(output: number, input: number, fit: Complex[] | null): void {
    const diagrams = [this.magnitudes(output, input, fit), this.phases(output, input, fit)];
    const coherence = this.data.responses.multiple_coherence?.[output];
    if (coherence) diagrams.push(this.coherence(coherence));
    this.stack.show(diagrams);
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
      name: nameOf('Magnitude'),
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
      axis: magnitudeAxis,
    };
  }

  private phases(output: number, input: number, fit: Complex[] | null): Diagram {
    const H = this.measured(output, input);
    const cut = phaseCut(fit ? [H, fit] : [H]);
    const { measured, fit: fitted } = this.lines(palette());
    return {
      name: nameOf('Phase'),
      label: 'phase',
      height: 160,
      data: [
        this.frequency,
        H.map((h) => withinTurn(phase(h), cut)),
        fit ? phaseLine(fit, cut) : H.map(() => null),
      ] as uPlot.AlignedData,
      series: [{}, { ...measured, ...asPoints(palette().flexible) }, fitted],
      scale: phaseScale,
      axis: phaseAxis,
    };
  }

  private coherence(values: number[]): Diagram {
    return {
      name: nameOf('Coherence'),
      label: 'coherence',
      height: 140,
      data: [this.frequency, values],
      series: [{}, this.lines(palette()).measured],
      scale: { distr: 1, range: [0, 1.02] },
      axis: { splits: () => [0, 0.5, 1] },
    };
  }
}
