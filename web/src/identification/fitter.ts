// Shapes and residual terms of given poles, fitted to the measured responses by the core (web/core/measured_fit.hpp):
// the fit of the library itself, with its poles and participations held.

import type { Complex } from '../complex';
import type { Core } from '../core/core';
import type { Identification, Pole } from './types';

export interface Fit {
  poles: Pole[];
  /** By pole and output. */
  shapes: Complex[][];
  /** √(Σ|Ĥ − H|²/Σ|Ĥ|²), each output in proportion to its own size. */
  error: number;
  /** The model at the measured lines, with the effect of the measurement window. */
  synthesis(output: number, input: number): Complex[];
}

/** What is no number in JSON is none here either. */
const plain = (values: readonly (number | null)[]): number[] => values.map((value) => value ?? Number.NaN);

/** `count` complex numbers from number `first` on. */
const complex = (numbers: Float64Array, first: number, count: number): Complex[] =>
  Array.from({ length: count }, (_, k) => ({ re: numbers[first + 2 * k], im: numbers[first + 2 * k + 1] }));

export class Fitter {
  private constructor(
    private readonly core: Core,
    private readonly outputs: number,
    private readonly inputs: number,
    private readonly lines: number,
  ) {}

  /** Hands the measured responses to the core. */
  static async start(core: Core, { responses, taper, residuals }: Identification): Promise<Fitter> {
    const { frequency_hz, response, shift_per_s, input_correlation } = responses;
    const entries = response.flat();
    const deviations = entries.every(({ deviation }) => deviation !== undefined);
    const correlation = deviations ? (input_correlation ?? []) : [];
    const numbers = [
      frequency_hz,
      ...entries.flatMap(({ re, im, deviation = [] }) => (deviations ? [re, im, deviation] : [re, im])),
      ...correlation.flatMap(({ re, im }) => [re, im]),
      taper?.values ?? [],
    ].flatMap(plain);
    const [outputs, inputs, lines] = [response.length, response[0]?.length ?? 0, frequency_hz.length];
    await core.measured(
      {
        outputs,
        inputs,
        lines,
        deviations,
        correlation: correlation.length > 0,
        shift: shift_per_s,
        residual_terms: residuals.terms.length,
        window: taper?.values.length ?? 0,
        duration: taper?.duration_s ?? 0,
      },
      Float64Array.from(numbers),
    );
    return new Fitter(core, outputs, inputs, lines);
  }

  async fit(poles: Pole[]): Promise<Fit> {
    const numbers = await this.core.fit(poles.map(({ pole, participation }) => ({ pole, participation })));
    const { outputs, inputs, lines } = this;
    const synthesis = 1 + 2 * poles.length * outputs;
    return {
      poles,
      error: numbers[0],
      shapes: poles.map((_, r) => complex(numbers, 1 + 2 * r * outputs, outputs)),
      synthesis: (o, i) => complex(numbers, synthesis + 2 * (o * inputs + i) * lines, lines),
    };
  }
}
