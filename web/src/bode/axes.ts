// The axes of diagrams over frequency.

import type uPlot from 'uplot';
import { significant, tick } from '../numbers';
import { logTicks, magnitudeTicks } from './picture';

/** Shows every tick. */
const all = (_: uPlot, splits: number[]): number[] => splits;

/** `last`: of the lowest diagram, which has the title. */
export function frequencyAxis(logarithmic: boolean, last: boolean): uPlot.Axis {
  return {
    ...(last ? { label: 'frequency in Hz' } : {}),
    ...(logarithmic
      ? {
          splits: (plot) => logTicks(plot.scales['x']!.min!, plot.scales['x']!.max!, plot.width < 520),
          filter: all,
          values: (_, splits) => splits.map((value) => significant(value, 3)),
        }
      : {}),
  };
}

export const magnitudeAxis: uPlot.Axis = {
  splits: (plot) => magnitudeTicks(plot.scales['y']!.min!, plot.scales['y']!.max!),
  filter: all,
  values: (_, splits) => splits.map(tick),
};

export const phaseAxis: uPlot.Axis = {
  splits: () => [-180, -90, 0, 90, 180],
  values: (_, splits) => splits.map((value) => `${value}°`.replace('-', '−')),
};

export const phaseScale: uPlot.Scale = { distr: 1, range: [-185, 185] };
