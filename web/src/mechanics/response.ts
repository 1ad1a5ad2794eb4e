// H(ω) = Φ_p (Ω² − ω² I + iω Γ − Σ λ/(iω + λ) g gᵀ)⁻¹ Φ_pᵀ at any frequency, see
// modal_response_json.hpp.

import type { Complex } from '../complex';
import type { ModalResponse } from '../document';

/** All 36 responses at one frequency: re, im of (output, input) at 2 (6 output + input). */
export type Matrix6 = Float64Array;

export const entry = (H: Matrix6, output: number, input: number): Complex => ({
  re: H[2 * (6 * output + input)],
  im: H[2 * (6 * output + input) + 1],
});

const isDiagonal = (damping: number[] | number[][]): damping is number[] =>
  typeof damping[0] === 'number';

/** H at ω [rad/s]. */
export function responseAt(model: ModalResponse, omega: number): Matrix6 {
  const { damping } = model;
  return isDiagonal(damping) && !model.relaxing
    ? modalSum(model, damping, omega)
    : coupled(model, damping, omega);
}

function modalSum(model: ModalResponse, damping: number[], omega: number): Matrix6 {
  const H = new Float64Array(72);
  model.omega2.forEach((omega2, k) => {
    const shape = model.platform_shapes[k];
    const a = omega2 - omega * omega;
    const b = omega * damping[k];
    const square = a * a + b * b;
    for (let output = 0; output < 6; ++output)
      for (let input = 0; input < 6; ++input) {
        const weight = shape[output] * shape[input];
        H[2 * (6 * output + input)] += (weight * a) / square;
        H[2 * (6 * output + input) + 1] -= (weight * b) / square;
      }
  });
  return H;
}

/** Takes Σ λ/(iω + λ) g gᵀ off. */
function relax(model: ModalResponse, omega: number, re: Float64Array, im: Float64Array): void {
  const n = model.omega2.length;
  const width = n + 6;
  for (const { rate_1_s: rate, shape } of model.relaxing ?? []) {
    const scale = rate / (rate * rate + omega * omega);
    for (let i = 0; i < n; ++i)
      for (let j = 0; j < n; ++j) {
        const product = shape[i] * shape[j] * scale;
        re[i * width + j] -= product * rate;
        im[i * width + j] += product * omega;
      }
  }
}

/** The modes' amplitudes Z from (Ω² − ω² I + iω Γ − …) Z = Φ_pᵀ, then H = Φ_p Z. */
function coupled(
  model: ModalResponse,
  damping: number[] | number[][],
  omega: number,
): Matrix6 {
  const n = model.omega2.length;
  const width = n + 6;
  const re = new Float64Array(n * width);
  const im = new Float64Array(n * width);
  for (let i = 0; i < n; ++i) {
    if (isDiagonal(damping)) im[i * width + i] = omega * damping[i];
    else for (let j = 0; j < n; ++j) im[i * width + j] = omega * damping[i][j];
    re[i * width + i] = model.omega2[i] - omega * omega;
    for (let input = 0; input < 6; ++input)
      re[i * width + n + input] = model.platform_shapes[i][input];
  }
  relax(model, omega, re, im);
  eliminate(re, im, n, width);
  substitute(re, im, n, width);
  const H = new Float64Array(72);
  for (let k = 0; k < n; ++k)
    for (let output = 0; output < 6; ++output)
      for (let input = 0; input < 6; ++input) {
        const weight = model.platform_shapes[k][output];
        H[2 * (6 * output + input)] += weight * re[k * width + n + input];
        H[2 * (6 * output + input) + 1] += weight * im[k * width + n + input];
      }
  return H;
}

/** Upper triangle with ones on the diagonal, by rows, with row pivoting. */
function eliminate(re: Float64Array, im: Float64Array, n: number, width: number): void {
  for (let column = 0; column < n; ++column) {
    swapRows(re, im, width, column, pivotRow(re, im, n, width, column));
    const p = column * width;
    const pr = re[p + column];
    const pi = im[p + column];
    const square = pr * pr + pi * pi;
    for (let j = column; j < width; ++j) {
      const a = re[p + j];
      const b = im[p + j];
      re[p + j] = (a * pr + b * pi) / square;
      im[p + j] = (b * pr - a * pi) / square;
    }
    for (let row = column + 1; row < n; ++row)
      subtractRow(re, im, width, row * width, p, column, column);
  }
}

/** Solutions into the last columns of an upper triangle with ones on its diagonal. */
function substitute(re: Float64Array, im: Float64Array, n: number, width: number): void {
  for (let column = n - 1; column > 0; --column)
    for (let row = 0; row < column; ++row)
      subtractRow(re, im, width, row * width, column * width, column, n);
}

/** Row at r −= its entry in `column` times the row at p, from column `first` on. */
function subtractRow(
  re: Float64Array,
  im: Float64Array,
  width: number,
  r: number,
  p: number,
  column: number,
  first: number,
): void {
  const fr = re[r + column];
  const fi = im[r + column];
  if (fr === 0 && fi === 0) return;
  for (let j = first; j < width; ++j) {
    re[r + j] -= fr * re[p + j] - fi * im[p + j];
    im[r + j] -= fr * im[p + j] + fi * re[p + j];
  }
}

function pivotRow(
  re: Float64Array,
  im: Float64Array,
  n: number,
  width: number,
  column: number,
): number {
  let best = column;
  let most = -1;
  for (let row = column; row < n; ++row) {
    const at = row * width + column;
    const size = re[at] ** 2 + im[at] ** 2;
    if (size > most) [best, most] = [row, size];
  }
  return best;
}

function swapRows(re: Float64Array, im: Float64Array, width: number, a: number, b: number): void {
  if (a === b) return;
  for (const part of [re, im])
    for (let j = 0; j < width; ++j) {
      const kept = part[a * width + j];
      part[a * width + j] = part[b * width + j];
      part[b * width + j] = kept;
    }
}

export const magnitude = (h: Complex): number => Math.hypot(h.re, h.im);

/** [°], −180 … 180 */
export const phase = (h: Complex): number => (Math.atan2(h.im, h.re) * 180) / Math.PI;

/** The number of the mode whose term in the modal sum of (output, input) is the largest at ω. */
export function leadingMode(
  model: ModalResponse,
  output: number,
  input: number,
  omega: number,
): number {
  let best = 0;
  let most = -1;
  model.omega2.forEach((omega2, k) => {
    const row = model.damping[k];
    const gamma = typeof row === 'number' ? row : row[k];
    const shape = model.platform_shapes[k];
    const size =
      Math.abs(shape[output] * shape[input]) / Math.hypot(omega2 - omega ** 2, gamma * omega);
    if (size > most) [best, most] = [k, size];
  });
  return model.mode[best];
}

/** Frequencies [rad/s] of a curve: `points` on a logarithmic axis, more around resonances. */
export function grid(models: ModalResponse[], from: number, to: number, points: number): number[] {
  const values: number[] = [];
  const step = Math.log(to / from) / (points - 1);
  for (let i = 0; i < points; ++i) values.push(i === points - 1 ? to : from * Math.exp(i * step));
  for (const model of models) model.omega2.forEach((_, k) => values.push(...around(model, k)));
  return values
    .filter((value) => value >= from && value <= to)
    .sort((a, b) => a - b)
    .filter((value, i, all) => i === 0 || value > all[i - 1] * (1 + 1e-9));
}

/** Points within a few half-power bandwidths of a mode. */
function around(model: ModalResponse, k: number): number[] {
  const omega2 = model.omega2[k];
  if (omega2 <= 0) return [];
  const omega = Math.sqrt(omega2);
  const row = model.damping[k];
  const gamma = typeof row === 'number' ? row : row[k];
  const half = Math.max(0.5 * gamma, 1e-6 * omega);
  const steps = [0.15, 0.35, 0.6, 1, 1.6, 2.6, 4.5, 8];
  const peak = gamma > 0 ? [omega] : []; // an undamped machine has no value at its frequencies
  return [...peak, ...steps.flatMap((s) => [omega - s * half, omega + s * half])];
}
