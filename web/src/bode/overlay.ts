// Curves over frequency, one over the other: magnitudes, and phases below them.

import type uPlot from 'uplot';
import { magnitudeAxis, phaseAxis } from './axes';
import { phaseScale } from './phase';
import type { Diagram } from './stack';

export interface OverlayLine {
  label: string;
  stroke: string;
  width?: number;
  dash?: number[];
  /** At the frequencies of the diagram; null: none; undefined: others have a value there. */
  values: (number | null | undefined)[];
}

export interface Overlay {
  /** For screen readers. */
  name: string;
  frequency_hz: number[];
  lines: OverlayLine[];
}

/** A curve of points without a line, as of what was measured. */
export const asPoints = (colour: string): Partial<uPlot.Series> => ({
  paths: () => null,
  points: { show: true, size: 2.5, fill: colour },
});

const dataOf = ({ frequency_hz, lines }: Overlay): uPlot.AlignedData =>
  [frequency_hz, ...lines.map(({ values }) => values)] as uPlot.AlignedData;

const seriesOf = ({ label, stroke, width = 1.6, dash }: OverlayLine): uPlot.Series => ({
  label,
  stroke,
  width,
  points: { show: false },
  ...(dash ? { dash } : {}),
});

export function overlaidMagnitudes(overlay: Overlay, unit: string): Diagram {
  return {
    name: overlay.name,
    label: unit,
    height: 280,
    data: dataOf(overlay),
    series: [{}, ...overlay.lines.map((line) => ({ ...seriesOf(line), spanGaps: true }))],
    scale: { distr: 3 },
    axis: magnitudeAxis,
  };
}

export function overlaidPhases(overlay: Overlay): Diagram {
  return {
    name: overlay.name,
    label: 'phase',
    height: 150,
    data: dataOf(overlay),
    series: [{}, ...overlay.lines.map(seriesOf)],
    scale: phaseScale,
    axis: phaseAxis,
  };
}
