// The fit of the identification itself, from its poles, shapes and residual terms.

import type { Complex } from '../complex';
import type { Fit } from './fitter';
import type { FittedPole, Identification, Pole, Vector } from './types';

/**
 * Modes of a short record are fitted to its spectra (src/identification/record_fit.hpp). The document does not
 * have them: its responses are those of a parametric model of the record. A fit to these is another one.
 */
export const isOfWholeRecord = ({ findings = [] }: Identification): boolean =>
  findings.some(({ kind }) => kind === 'short_record');

export const whyNoRefit =
  'Poles cannot be switched: the modes were fitted to the spectra of the whole record, which the report does not contain.';

const element = ({ re, im }: Vector, k: number): Complex => ({ re: re[k], im: im[k] });

const product = (a: Complex, b: Complex): Complex => ({ re: a.re * b.re - a.im * b.im, im: a.re * b.im + a.im * b.re });

/** A/(s − λ) + Ā/(s − λ̄) of the residue A. */
function resonance(A: Complex, pole: Complex, s: Complex): Complex {
  const sum = { re: 0, im: 0 };
  for (const sign of [1, -1]) {
    const [p, q] = [s.re - pole.re, s.im - sign * pole.im];
    const square = p * p + q * q;
    sum.re += (A.re * p + sign * A.im * q) / square;
    sum.im += (sign * A.im * p - A.re * q) / square;
  }
  return sum;
}

/** Σ C_k (s/scale)^k from k = −2 on. */
function residual(terms: number[], s: Complex): Complex {
  const square = s.re * s.re + s.im * s.im;
  const inverse = { re: s.re / square, im: -s.im / square };
  let power = product(inverse, inverse);
  const sum = { re: 0, im: 0 };
  for (const C of terms) {
    sum.re += C * power.re;
    sum.im += C * power.im;
    power = product(power, s);
  }
  return sum;
}

/** `poles`: those of the identification, modes first. */
export function programFit(data: Identification, poles: Pole[]): Fit {
  const fitted: FittedPole[] = [...data.modes, ...data.heavily_damped];
  const { omega_scale_rad_s: scale, terms } = data.residuals;
  const { frequency_hz, shift_per_s } = data.responses;
  const at = (o: number, i: number, s: Complex): Complex => {
    const sum = residual(terms.map((C) => C[o][i]), { re: s.re / scale, im: s.im / scale });
    for (const { pole, shape, participation } of fitted) {
      const part = resonance(product(element(shape, o), element(participation, i)), pole, s);
      sum.re += part.re;
      sum.im += part.im;
    }
    return sum;
  };
  return {
    poles,
    shapes: fitted.map(({ shape }) => shape.re.map((_, o) => element(shape, o))),
    error: data.fit_error,
    synthesis: (o, i) => frequency_hz.map((f) => at(o, i, { re: shift_per_s, im: 2 * Math.PI * f })),
  };
}
