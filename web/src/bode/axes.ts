// The axes of diagrams over frequency.

import type uPlot from 'uplot';
import { tick } from '../numbers';
import { phaseText, phaseTicks } from './phase';
import { labelled, magnitudeTicks, tickText } from './ticks';

/** Shows every tick. */
const all = (_: uPlot, splits: number[]): number[] => splits;

/** `last`: of the lowest diagram, which has the title. */
export function frequencyAxis(logarithmic: boolean, last: boolean): uPlot.Axis {
  return {
    ...(last ? { label: 'frequency in Hz' } : {}),
    ...(logarithmic
      ? {
          splits: (plot) => {
            const { min, max } = plot.scales['x']!;
            const left = plot.bbox.left / devicePixelRatio;
            return labelled(min!, max!, (value) => left + plot.valToPos(value, 'x'), plot.width);
          },
          filter: all,
          values: (_, splits) => splits.map(tickText),
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
  splits: (plot) => phaseTicks(plot.scales['y']!.min!, plot.scales['y']!.max!),
  filter: all,
  values: (_, splits) => splits.map(phaseText),
};
