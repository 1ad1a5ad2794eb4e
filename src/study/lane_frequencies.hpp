#pragma once
/// Undamped frequencies of several designs at once, without their shapes. Private to the kernels.

#include "lane_assembly.hpp"
#include "lane_eigen.hpp"

namespace hydrapod::study {

namespace {

/// Eigenvalues of tridiagonal matrices whose largest entries are about 1, in d: QL without square
/// roots (Pal, Walker and Kahan; B. N. Parlett, The Symmetric Eigenvalue Problem, 1998, section
/// 8.15), on the squares of e. Sweeps begin at the last row in every lane, so that a lane does not
/// depend on those beside it. Lanes that do not converge become NaN.
///
/// A rotation has p = γ²/c and b = e², and gives with r = p + b, i = 1/(p r)
///
///     c = p² i,   s = b p i,   γ' = c (α − σ) − s γ,   p' = γ'²/c = γ'² r² i
///
/// with one division. |γ| is kept above `floor`, whose square is far below rounding.
template <class V, int size>
HYDRAPOD_APART void ql_without_roots(V (&d)[size], V (&e)[size]) {
  constexpr int max_sweeps = 60;
  constexpr double unit = rounding_unit * rounding_unit, tiny = 0x1p-200, floor = 0x1p-100;
  const V zero{};
  for (V& one : e) one = one * one;
  for (int first = 0; first + 1 < size; ++first)
    for (int sweep = 0;; ++sweep) {
      const auto open = ~(e[first] <= unit * size_of(V(d[first] * d[first + 1])) + tiny);
      if (!any(open)) break;
      if (sweep == max_sweeps) {
        d[first] = select(open, zero / zero, d[first]);
        e[first] = select(open, zero, e[first]);
        break;
      }
      const V side = root(e[first]);
      const V half = (d[first + 1] - d[first]) / (2.0 * side);
      const V length = root(V(half * half + 1.0));
      const V shift = d[first] - side / (half + select(half > 0.0, length, -length));
      V gamma = d[size - 1] - shift;
      gamma = select(size_of(gamma) > floor, gamma, zero + floor);
      V p = gamma * gamma, s = zero;
      for (int i = size - 2; i >= first; --i) {
        const V b = e[i], alpha = d[i];
        const V r = p + b, inverse = 1.0 / (p * r), square_of_r = r * r;
        if (i < size - 2) e[i + 1] = select(open, s * r, e[i + 1]);
        const V part = b * p, turned = p * p * (alpha - shift) - part * gamma;
        V next = turned * inverse;
        const auto small = size_of(next) <= floor;
        const V scaled = square_of_r * inverse;
        s = part * inverse;
        p = select(small, (floor * floor) * scaled,
                   (turned * square_of_r) * (inverse * inverse) * next);
        next = select(small, zero + floor, next);
        d[i + 1] = select(open, gamma + (alpha - next), d[i + 1]);
        gamma = next;
      }
      e[first] = select(open, s * p, e[first]);
      d[first] = select(open, gamma + shift, d[first]);
    }
}

/// By a network, in lanes; NaN stay in their lane.
template <class V, int size>
HYDRAPOD_INLINE void sort_lanes(V (&d)[size]) {
  for (int i = 1; i < size; ++i)
    for (int j = i; j > 0; --j) {
      const V low = d[j - 1], high = d[j];
      const auto right = low <= high;
      d[j - 1] = select(right, low, high);
      d[j] = select(right, high, low);
    }
}

/// ω² from that of the reduced matrix A; what must hold for sums of eigenvalues, Σλ = tr A and
/// Σλ² = ‖A‖², is the residual.
template <class V, int flexible>
void frequencies_of_lanes(const LaneTask& task) {
  constexpr int size = modes_of(flexible);
  const auto& machine = *reinterpret_cast<const MachineNumbers<V>*>(task.machines);
  auto& model = *reinterpret_cast<ModelNumbers<V, flexible>*>(task.models);
  auto& out = *reinterpret_cast<FrequencyNumbers<V, flexible>*>(task.outputs);
  const V failed = assemble<V, flexible>(machine, *task.options, model.M, model.K);
  LanePencil<V, size> p;
  reduce_lanes<V, flexible, false>(model.M, model.K, p);
  V trace{}, diagonal{}, beside{};
  for (int i = 0; i < size; ++i) {
    trace += p.A[i][i];
    diagonal += p.A[i][i] * p.A[i][i];
    for (int j = 0; j < i; ++j) beside += p.A[i][j] * p.A[i][j];
  }
  const V square = diagonal + 2.0 * beside, norm = root(square), scale = 1.0 / norm;
  tridiagonalize_lanes<V, size, false>(p);
  V sum{}, sum_of_squares{};
  for (int k = 0; k < size; ++k) {
    p.d[k] = p.d[k] * scale;
    p.e[k] = p.e[k] * scale;
  }
  ql_without_roots<V, size>(p.d, p.e);
  for (int k = 0; k < size; ++k) {
    sum += p.d[k];
    sum_of_squares += p.d[k] * p.d[k];
  }
  out.residual = larger(size_of(V(sum - trace * scale)), size_of(V(sum_of_squares - 1.0))) +
                 failed + 0.0 * (sum + trace);
  for (int k = 0; k < size; ++k) out.omega2[k] = p.d[k] * norm;
  sort_lanes<V, size>(out.omega2);
}

}  // namespace

}  // namespace hydrapod::study
