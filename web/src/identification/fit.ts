// The modal model with given poles and participations, fitted to measured responses by linear least
// squares over shapes and residual terms:
//
//     H_oi(ω) = Σ_r [φ_ro L_ri g(ω, λ_r) + conj.] + Σ_k C_k,oi (iω/scale)^k,   k = −2 … 1
//
// Every entry counts with one over its variance (mean over a few lines); where errors are not known,
// with one over the mean square of its row plus that row's median. The C++ fit (modal_model.hpp)
// moves λ and L as well; with its λ and L this gives its shapes.

import type { Complex } from '../complex';
import { PoleBasis, type PoleLines } from './basis';
import type { Measured, Taper } from './types';

export interface Pole {
  pole: Complex;
  participation: { re: number[]; im: number[] };
}

export interface Fit {
  /** By pole and output. */
  shapes: Complex[][];
  /** √(Σ|Ĥ − H|²/Σ|Ĥ|²), each output in proportion to its own size. */
  error: number;
  /** The model at the lines, as the window shows it. */
  synthesis(output: number, input: number): Complex[];
  /** The model itself at a frequency [Hz]. */
  at(output: number, input: number, frequency: number): Complex;
}

const terms = [-2, -1, 0, 1];
const two_pi = 2 * Math.PI;

/** Solves the symmetric positive definite N x = b, columns scaled to one. */
export function solveSymmetric(N: Float64Array, b: Float64Array): Float64Array {
  const n = b.length;
  const scale = new Float64Array(n);
  for (let i = 0; i < n; ++i) scale[i] = N[i * n + i] > 0 ? 1 / Math.sqrt(N[i * n + i]) : 0;
  const L = new Float64Array(n * n);
  const ridge = 1e-13;
  for (let i = 0; i < n; ++i)
    for (let j = 0; j <= i; ++j) {
      let sum = N[i * n + j] * scale[i] * scale[j] + (i === j ? ridge : 0);
      for (let k = 0; k < j; ++k) sum -= L[i * n + k] * L[j * n + k];
      L[i * n + j] = i === j ? Math.sqrt(Math.max(sum, ridge)) : sum / L[j * n + j];
    }
  const x = new Float64Array(n);
  for (let i = 0; i < n; ++i) {
    let sum = b[i] * scale[i];
    for (let k = 0; k < i; ++k) sum -= L[i * n + k] * x[k];
    x[i] = sum / L[i * n + i];
  }
  for (let i = n - 1; i >= 0; --i) {
    let sum = x[i];
    for (let k = i + 1; k < n; ++k) sum -= L[k * n + i] * x[k];
    x[i] = sum / L[i * n + i];
  }
  return x.map((value, i) => value * scale[i]);
}

const median = (values: number[]): number =>
  [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)] ?? 0;

export class Fitter {
  private readonly basis: PoleBasis;
  private readonly omegaScale: number;
  /** One over the variance, by output, input and line. */
  private readonly weight: Float64Array[][];
  private readonly size: number[];

  constructor(
    private readonly measured: Measured,
    taper: Taper | null,
    private readonly shift = 0,
  ) {
    const f = measured.frequency_hz;
    this.basis = new PoleBasis(f, taper, shift);
    this.omegaScale = two_pi * f[Math.floor(f.length / 2)] || 1;
    this.weight = measured.response.map((row) => this.rowWeights(row));
    this.size = measured.response.map((row) =>
      Math.sqrt(
        row.reduce((all, h) => h.re.reduce((s, re, k) => s + re * re + h.im[k] * h.im[k], all), 0),
      ),
    );
  }

  get lines(): number {
    return this.measured.frequency_hz.length;
  }

  fit(poles: Pole[]): Fit {
    const lines = poles.map((pole) => this.basis.at(pole.pole));
    const solutions = this.measured.response.map((_, o) => this.solve(poles, lines, o));
    const inputs = this.measured.response[0]?.length ?? 0;
    const value = (o: number, i: number, g: PoleLines[], k: number, omega: number): Complex => {
      let [re, im] = [0, 0];
      const x = solutions[o];
      poles.forEach((pole, r) => {
        const { u, v } = columnsOf(pole, g[r], i, k);
        re += x[2 * r] * u.re + x[2 * r + 1] * v.re;
        im += x[2 * r] * u.im + x[2 * r + 1] * v.im;
      });
      terms.forEach((power, t) => {
        const s = powerOf(this.shift / this.omegaScale, omega / this.omegaScale, power);
        const c = x[2 * poles.length + t * inputs + i];
        re += c * s.re;
        im += c * s.im;
      });
      return { re, im };
    };
    const synthesis = (o: number, i: number) =>
      this.measured.frequency_hz.map((f, k) => value(o, i, lines, k, two_pi * f));
    return {
      shapes: poles.map((_, r) =>
        solutions.map((x) => ({ re: x[2 * r], im: x[2 * r + 1] })),
      ),
      error: this.errorOf(synthesis),
      synthesis,
      at: (o, i, frequency) => {
        const alone = new PoleBasis([frequency], null, this.shift);
        const g = poles.map((pole) => alone.at(pole.pole));
        return value(o, i, g, 0, two_pi * frequency);
      },
    };
  }

  private rowWeights(row: Measured['response'][number]): Float64Array[] {
    const known = row.every((h) => h.deviation !== undefined);
    if (known) return row.map((h) => smoothedWeights(h.deviation as number[]));
    const square = this.measured.frequency_hz.map(
      (_, k) => row.reduce((sum, h) => sum + h.re[k] ** 2 + h.im[k] ** 2, 0) / row.length,
    );
    const floor = median(square) || 1e-300;
    const weight = Float64Array.from(square, (value) => 1 / (value + floor));
    return row.map(() => weight);
  }

  /** φ of all poles, then C by term and input, of one output. */
  private solve(poles: Pole[], lines: PoleLines[], o: number): Float64Array {
    const row = this.measured.response[o];
    const [R, p] = [poles.length, row.length];
    const n = 2 * R + terms.length * p;
    const N = new Float64Array(n * n);
    const b = new Float64Array(n);
    const used = 2 * R + terms.length;
    const [re, im] = [new Float64Array(used), new Float64Array(used)];
    const place = new Int32Array(used);
    for (let i = 0; i < p; ++i) {
      for (let c = 0; c < used; ++c) place[c] = c < 2 * R ? c : 2 * R + (c - 2 * R) * p + i;
      for (let k = 0; k < this.lines; ++k) {
        this.fill(poles, lines, i, k, re, im);
        const w = this.weight[o][i][k];
        for (let a = 0; a < used; ++a) {
          const [x, y] = [w * re[a], w * im[a]];
          b[place[a]] += x * row[i].re[k] + y * row[i].im[k];
          const base = place[a] * n;
          for (let c = 0; c <= a; ++c) N[base + place[c]] += x * re[c] + y * im[c];
        }
      }
    }
    return solveSymmetric(N, b);
  }

  /** The columns of one entry at a line: two per pole, then the residual terms. */
  private fill(
    poles: Pole[],
    lines: PoleLines[],
    i: number,
    k: number,
    re: Float64Array,
    im: Float64Array,
  ): void {
    poles.forEach((pole, r) => {
      const { u, v } = columnsOf(pole, lines[r], i, k);
      [re[2 * r], im[2 * r], re[2 * r + 1], im[2 * r + 1]] = [u.re, u.im, v.re, v.im];
    });
    terms.forEach((power, t) => {
      const omega = two_pi * this.measured.frequency_hz[k];
      const s = powerOf(this.shift / this.omegaScale, omega / this.omegaScale, power);
      [re[2 * poles.length + t], im[2 * poles.length + t]] = [s.re, s.im];
    });
  }

  private errorOf(synthesis: (o: number, i: number) => Complex[]): number {
    let [off, whole] = [0, 0];
    this.measured.response.forEach((row, o) => {
      const unit = this.size[o] > 0 ? 1 / this.size[o] ** 2 : 0;
      row.forEach((h, i) =>
        synthesis(o, i).forEach((model, k) => {
          off += unit * ((h.re[k] - model.re) ** 2 + (h.im[k] - model.im) ** 2);
          whole += unit * (h.re[k] ** 2 + h.im[k] ** 2);
        }),
      );
    });
    return whole > 0 ? Math.sqrt(off / whole) : 0;
  }
}

/** L g + L* g_c and i (L g − L* g_c): what Re φ and Im φ bring. */
function columnsOf(pole: Pole, g: PoleLines, i: number, k: number): { u: Complex; v: Complex } {
  const [a, b] = [pole.participation.re[i], pole.participation.im[i]];
  const x = { re: a * g.re[k] - b * g.im[k], im: a * g.im[k] + b * g.re[k] };
  const y = { re: a * g.re_c[k] + b * g.im_c[k], im: a * g.im_c[k] - b * g.re_c[k] };
  return {
    u: { re: x.re + y.re, im: x.im + y.im },
    v: { re: -(x.im - y.im), im: x.re - y.re },
  };
}

/** (i w)^power */
/** (a + iw) to the power −2 … 1. */
function powerOf(a: number, w: number, power: number): Complex {
  if (power === 0) return { re: 1, im: 0 };
  if (power === 1) return { re: a, im: w };
  const square = a * a + w * w;
  const inverse = { re: a / square, im: -w / square };
  if (power === -1) return inverse;
  return { re: inverse.re ** 2 - inverse.im ** 2, im: 2 * inverse.re * inverse.im };
}

function smoothedWeights(deviation: number[]): Float64Array {
  const reach = 4;
  const n = deviation.length;
  return Float64Array.from(deviation, (_, k) => {
    const [from, to] = [Math.max(0, k - reach), Math.min(n - 1, k + reach)];
    let sum = 0;
    for (let j = from; j <= to; ++j) sum += deviation[j] ** 2;
    return sum > 0 ? (to - from + 1) / sum : 0;
  });
}
