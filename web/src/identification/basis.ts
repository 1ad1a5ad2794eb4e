// What a pole contributes to a response at each line: g(ω, λ) and g(ω, λ*), as
// src/identification/pole_basis.hpp has it. Under a window of length T
//
//     g = (1 − e^(λT))/(s − λ) + ∫_0^T (ρ(τ) − 1) e^((λ − s)τ) dτ,   else g = 1/(s − λ), s = a + iω
//
// with the shift a of the responses.

import type { Complex } from '../complex';
import { fourier } from './fourier';
import type { Taper } from './types';

export interface PoleLines {
  re: Float64Array;
  im: Float64Array;
  /** of the conjugate pole */
  re_c: Float64Array;
  im_c: Float64Array;
}

const two_pi = 2 * Math.PI;

/** (a + ib)/(i(ω − y) − x): one pole x + iy at ω. */
function quotient(a: number, b: number, x: number, y: number, omega: number): Complex {
  const [p, q] = [-x, omega - y];
  const square = p * p + q * q;
  return { re: (a * p + b * q) / square, im: (b * p - a * q) / square };
}

export class PoleBasis {
  private readonly line: number[] | null;

  constructor(
    private readonly frequency: number[],
    private readonly taper: Taper | null,
    private readonly shift = 0,
  ) {
    this.line = taper ? frequency.map((f) => Math.round(f * taper.duration_s)) : null;
    const uneven = frequency.some(
      (f, k) => Math.abs(f * (taper?.duration_s ?? 0) - (this.line?.[k] ?? 0)) > 1e-6,
    );
    if (uneven) this.line = null;
  }

  at(pole: Complex): PoleLines {
    const count = this.frequency.length;
    const lines: PoleLines = {
      re: new Float64Array(count),
      im: new Float64Array(count),
      re_c: new Float64Array(count),
      im_c: new Float64Array(count),
    };
    const T = this.line && this.taper ? this.taper.duration_s : 0;
    const decay = T > 0 ? Math.exp(pole.re * T) : 0;
    const end = { re: decay * Math.cos(pole.im * T), im: decay * Math.sin(pole.im * T) };
    this.frequency.forEach((f, k) => {
      const omega = two_pi * f;
      const g = quotient(1 - end.re, -end.im, pole.re - this.shift, pole.im, omega);
      const c = quotient(1 - end.re, end.im, pole.re - this.shift, -pole.im, omega);
      [lines.re[k], lines.im[k], lines.re_c[k], lines.im_c[k]] = [g.re, g.im, c.re, c.im];
    });
    if (T > 0) this.addWindow(pole, end, lines);
    return lines;
  }

  private addWindow(pole: Complex, end: Complex, lines: PoleLines): void {
    const { values, duration_s } = this.taper as Taper;
    const n = values.length;
    const dt = duration_s / n;
    const [re, im] = [new Float64Array(n), new Float64Array(n)];
    for (let t = 0; t < n; ++t) {
      const size = dt * values[t] * Math.exp(pole.re * t * dt);
      re[t] = size * Math.cos(pole.im * t * dt);
      im[t] = size * Math.sin(pole.im * t * dt);
    }
    re[0] -= 0.5 * dt * end.re; // the last point of the trapezoidal rule
    im[0] -= 0.5 * dt * end.im;
    fourier(re, im);
    (this.line as number[]).forEach((m, k) => {
      const mirrored = (n - (m % n)) % n;
      lines.re[k] += re[m % n];
      lines.im[k] += im[m % n];
      lines.re_c[k] += re[mirrored];
      lines.im_c[k] -= im[mirrored];
    });
  }
}
