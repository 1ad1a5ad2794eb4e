#pragma once
/// The eigensolver of several designs at once: for each lane the algorithm of symmetric_eigen.hpp
/// and normal_modes.cpp (reduction by blocks, Householder, implicit QL, Rayleigh quotients).
/// Private to the kernels.
///
/// Residual of a design: the largest over its modes of
///
///     ‖D^-½ (K φ − ω² M φ)‖ / ω²_max,   D = diag M,   and   |φᵀ M φ − 1|

#include "lane_numbers.hpp"
#include "lane_vector.hpp"

namespace hydrapod::study {

namespace {

/// L⁻ᵀ of the lower triangle in A = L Lᵀ; upper triangular. Not finite where A is not positive
/// definite.
template <class V, int size>
HYDRAPOD_INLINE void inverse_root(V (&A)[size][size], V (&P)[size][size]) {
  V inverse[size];
  for (int j = 0; j < size; ++j) {
    V sum = A[j][j];
    for (int k = 0; k < j; ++k) sum -= A[j][k] * A[j][k];
    inverse[j] = 1.0 / root(sum);
    for (int i = j + 1; i < size; ++i) {
      V entry = A[i][j];
      for (int k = 0; k < j; ++k) entry -= A[i][k] * A[j][k];
      A[i][j] = entry * inverse[j];
    }
  }
  for (int j = 0; j < size; ++j) {  // column j of L⁻¹ is row j of P
    P[j][j] = inverse[j];
    for (int i = j + 1; i < size; ++i) {
      V sum = A[i][j] * P[j][j];
      for (int k = j + 1; k < i; ++k) sum += A[i][k] * P[j][k];
      P[j][i] = -sum * inverse[i];
      P[i][j] = V{};
    }
  }
}

template <class V, int size>
struct LanePencil {
  V A[size][size];  ///< lower triangle
  V (*X)[size]{};   ///< [column][row]; only with shapes
  V d[size], e[size];
};

/// reduce() of normal_modes.cpp.
template <class V, int flexible, bool shapes = true>
HYDRAPOD_APART void reduce_lanes(const BlockMatrix<V, flexible>& M,
                                 const BlockMatrix<V, flexible>& K,
                                 LanePencil<V, platform_rows + leg_number * flexible>& p) {
  constexpr int n = flexible == 0 ? 1 : flexible;  // no arrays without elements
  constexpr int size = platform_rows + leg_number * flexible;
  V G[leg_number][n][6], P[leg_number][n][n];
  V M_platform[6][6], T[6][6], forces[6][6];
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) M_platform[i][j] = M.rr(i, j);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) {
      p.A[i][j] = V{};
      if constexpr (shapes) p.X[i][j] = V{};
    }
  if constexpr (flexible > 0)
    for (int leg = 0; leg < leg_number; ++leg) {
      V block[n][n], half[n][6];
      for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) block[i][j] = M.ff(leg, i, j);
      inverse_root<V, n>(block, P[leg]);
      for (int i = 0; i < n; ++i)  // Pᵀ M_fr
        for (int j = 0; j < 6; ++j) {
          V sum = P[leg][0][i] * M.fr(leg, 0, j);
          for (int k = 1; k <= i; ++k) sum += P[leg][k][i] * M.fr(leg, k, j);
          half[i][j] = sum;
        }
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < 6; ++j) {
          V sum = P[leg][i][i] * half[i][j];
          for (int k = i + 1; k < n; ++k) sum += P[leg][i][k] * half[k][j];
          G[leg][i][j] = sum;
        }
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j <= i; ++j)
          for (int k = 0; k < n; ++k) M_platform[i][j] -= half[k][i] * half[k][j];
    }
  inverse_root<V, 6>(M_platform, T);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      V sum = K.rr(i, 0) * T[0][j];
      for (int k = 1; k <= j; ++k) sum += K.rr(i, k) * T[k][j];
      forces[i][j] = sum;
      if constexpr (shapes) p.X[j][i] = T[i][j];
    }
  if constexpr (flexible > 0)
    for (int leg = 0; leg < leg_number; ++leg) {
      const int at = 6 + n * leg;
      V follow[n][6], leg_forces[n][6];
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < 6; ++j) {
          V sum = G[leg][i][0] * T[0][j], force = K.fr(leg, i, 0) * T[0][j];
          for (int k = 1; k <= j; ++k) {
            sum += G[leg][i][k] * T[k][j];
            force += K.fr(leg, i, k) * T[k][j];
          }
          follow[i][j] = -sum;
          leg_forces[i][j] = force;
          if constexpr (shapes) p.X[j][at + i] = -sum;
        }
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < 6; ++j)
          for (int k = 0; k < n; ++k) leg_forces[i][j] += K.ff(leg, i, k) * follow[k][j];
      for (int i = 0; i < n; ++i)  // Pᵀ (K_fr T + K_ff follow)
        for (int j = 0; j < 6; ++j) {
          V sum = P[leg][0][i] * leg_forces[0][j];
          for (int k = 1; k <= i; ++k) sum += P[leg][k][i] * leg_forces[k][j];
          p.A[at + i][j] = sum;
        }
      for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) {
          V sum{};
          for (int k = 0; k <= i; ++k)
            for (int l = 0; l <= j; ++l) sum += P[leg][k][i] * K.ff(leg, k, l) * P[leg][l][j];
          p.A[at + i][at + j] = sum;
        }
      if constexpr (shapes)
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j) p.X[at + j][at + i] = P[leg][i][j];
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j <= i; ++j)
          for (int k = 0; k < n; ++k) p.A[i][j] += follow[k][i] * leg_forces[k][j];
        for (int j = 0; j < 6; ++j)
          for (int k = 0; k < n; ++k) forces[i][j] += K.fr(leg, k, i) * follow[k][j];
      }
    }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j)
      for (int k = 0; k <= i; ++k) p.A[i][j] += T[k][i] * forces[k][j];
}

/// Rows that are worked on together, so that their chains overlap and still stand in registers.
template <class V>
constexpr int rows_together = 6;
template <class V, class M>
constexpr int rows_together<Two<V, M>> = 3;

/// Calls `use` with the rows 0 … k − 1: one, where their number is odd, then two and two, which
/// share what they read.
template <int number>
struct Rows {};
template <class Use>
HYDRAPOD_INLINE void in_pairs(int k, const Use& use) {
  if (k % 2 == 1) use(Rows<1>{}, 0);
  for (int i = k % 2; i < k; i += 2) use(Rows<2>{}, i);
}

/// w = A v of the first k rows.
template <class V, int size>
HYDRAPOD_INLINE void times_reflected(const LanePencil<V, size>& p, const V* v, int k,
                                     V (&w)[size]) {
  in_pairs(k, [&]<int rows>(Rows<rows>, int i) {
    V sum[rows];
    for (V& one : sum) one = V{};
    for (int j = 0; j < i; ++j) {
      V of_column = w[j];
      for (int r = 0; r < rows; ++r) {
        sum[r] += p.A[i + r][j] * v[j];
        of_column += p.A[i + r][j] * v[i + r];
      }
      w[j] = of_column;
    }
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < rows; ++c)
        sum[r] += (r >= c ? p.A[i + r][i + c] : p.A[i + c][i + r]) * v[i + c];
      w[i + r] = sum[r];
    }
  });
}

/// X (1 − β v vᵀ), v with k entries.
template <class V, int size>
HYDRAPOD_INLINE void reflect_rows(LanePencil<V, size>& p, const V* v, const V& beta, int k) {
  constexpr int together = rows_together<V>;
  static_assert(size % together == 0);
  for (int row = 0; row < size; row += together) {
    V sum[together];
    for (V& one : sum) one = V{};
    for (int j = 0; j < k; ++j)
      for (int r = 0; r < together; ++r) sum[r] += p.X[j][row + r] * v[j];
    for (V& one : sum) one = beta * one;
    for (int j = 0; j < k; ++j)
      for (int r = 0; r < together; ++r) p.X[j][row + r] -= sum[r] * v[j];
  }
}

/// tridiagonalize() of symmetric_eigen.hpp on the lower triangle.
template <class V, int size, bool shapes = true>
HYDRAPOD_APART void tridiagonalize_lanes(LanePencil<V, size>& p) {
  for (int k = size - 1; k > 1; --k) {
    p.d[k] = p.A[k][k];
    V* v = p.A[k];  // its first k entries are reflected onto the last of them
    V square{};
    for (int j = 0; j < k; ++j) square += v[j] * v[j];
    const V last = v[k - 1];
    const auto nothing = square == last * last;
    const V length = root(square);
    const V reflected = select(last > 0.0, -length, length);
    p.e[k - 1] = select(nothing, last, reflected);
    v[k - 1] = last - reflected;
    const V beta = select(nothing, V{}, -1.0 / (reflected * v[k - 1]));
    V w[size], projection{};
    times_reflected<V, size>(p, v, k, w);
    for (int i = 0; i < k; ++i) projection += w[i] * v[i];
    const V half = 0.5 * beta * beta * projection;
    for (int i = 0; i < k; ++i) w[i] = beta * w[i] - half * v[i];
    in_pairs(k, [&]<int rows>(Rows<rows>, int i) {
      for (int j = 0; j < i + rows; ++j)  // beyond the diagonal nothing is read
        for (int r = 0; r < rows; ++r) p.A[i + r][j] -= v[i + r] * w[j] + w[i + r] * v[j];
    });
    if constexpr (shapes) reflect_rows<V, size>(p, v, beta, k);
  }
  p.d[1] = p.A[1][1];
  p.d[0] = p.A[0][0];
  p.e[0] = p.A[1][0];
  p.e[size - 1] = V{};
}

/// The rotations of a sweep on all rows of X: columns (x, y) at i, i + 1 → (c x − s y, s x + c y),
/// from the last to the first. They are made while the next sweep is computed, whose roots and
/// divisions leave the processor idle.
template <class V, int size>
class LaneSweep {
 public:
  explicit LaneSweep(LanePencil<V, size>& p) : p_(p) {}
  V c[size], s[size];

  /// Columns first … last.
  void begin(int first, int last) {
    first_ = first;
    at_ = last - 1;
    part_ = 0;
    for (int row = 0; row < size; ++row) y_[row] = p_.X[last][row];
  }
  /// A third of the rows by three rotations: as much as one more rotation takes.
  HYDRAPOD_INLINE void turn() {
    if (at_ - together + 1 < first_) return;
    turn_rows<together, size / together>(part_ * (size / together));
    if (++part_ < together) return;
    part_ = 0;
    at_ -= together;
  }
  void finish() {
    while (part_ > 0) turn();
    for (; at_ - together + 1 >= first_; at_ -= together) turn_rows<together, size>(0);
    for (; at_ >= first_; --at_) turn_rows<1, size>(0);
    if (first_ < 0) return;
    for (int row = 0; row < size; ++row) p_.X[first_][row] = y_[row];
    first_ = -1;
    at_ = -2;
  }

 private:
  static constexpr int together = 3;

  template <int count, int rows>
  HYDRAPOD_INLINE void turn_rows(int from) {
    V cosine[count], sine[count];  // in registers
    for (int i = 0; i < count; ++i) {
      cosine[i] = c[at_ - i];
      sine[i] = s[at_ - i];
    }
    for (int row = from; row < from + rows; ++row) {
      V y = y_[row];
      for (int i = 0; i < count; ++i) {
        V& lower = p_.X[at_ - i + 1][row];
        const V x = p_.X[at_ - i][row];
        lower = sine[i] * x + cosine[i] * y;
        y = cosine[i] * x - sine[i] * y;
      }
      y_[row] = y;
    }
  }

  LanePencil<V, size>& p_;
  V y_[size];
  int first_{-1}, at_{-2}, part_{};
};

/// diagonalize() of symmetric_eigen.hpp after tridiagonalize(). Each lane has its own block; where
/// a lane has none, nothing happens to it. Lanes that do not converge become NaN.
template <class V, int size>
HYDRAPOD_APART void ql_lanes(LanePencil<V, size>& p) {
  constexpr int max_sweeps = 60;
  constexpr double square = rounding_unit * rounding_unit, tiny = 0x1p-1022;
  const V one = V{} + 1.0, zero = V{};
  LaneSweep<V, size> sweeps[2] = {LaneSweep<V, size>(p), LaneSweep<V, size>(p)};
  int now = 0;  // the other one is of the sweep before
  for (int first = 0; first + 1 < size; ++first)
    for (int sweep = 0;; ++sweep) {
      V last = zero + static_cast<double>(size - 1);  // whole numbers
      V end = p.d[size - 1];
      for (int k = size - 2; k >= first; --k) {
        const auto negligible = p.e[k] * p.e[k] <= square * size_of(V(p.d[k] * p.d[k + 1])) + tiny;
        last = select(negligible, zero + static_cast<double>(k), last);
        end = select(negligible, p.d[k], end);
      }
      const auto open = last != static_cast<double>(first);
      if (!any(open)) break;
      if (sweep == max_sweeps) {
        p.d[first] = select(open, zero / zero, p.d[first]);
        p.e[first] = select(open, zero, p.e[first]);
        break;
      }
      const int top = static_cast<int>(largest_of(last));

      const V half = (p.d[first + 1] - p.d[first]) / (2.0 * p.e[first]);
      const V length = root(V(half * half + 1.0));
      V g = end - p.d[first] + p.e[first] / (half + select(half > 0.0, length, -length));
      V s = one, c = one, shift = zero;
      auto going = open;
      for (int i = top - 1; i >= first; --i) {
        const auto on = going & (last > static_cast<double>(i));
        const V f = s * p.e[i], b = c * p.e[i];
        const V square_of_r = f * f + g * g, r = root(square_of_r);
        const auto apart = on & (square_of_r == 0.0);  // the block has fallen apart below i
        const V upper = p.d[i + 1];
        const V inverse = r * (1.0 / square_of_r);  // root and division at once
        const auto is_end = last == static_cast<double>(i + 1);
        p.e[i + 1] = select(on, select(is_end, zero, r), p.e[i + 1]);
        const auto turns = on & ~apart;
        s = select(turns, f * inverse, s);
        c = select(turns, g * inverse, c);
        const V rest = upper - shift;
        const V t = (p.d[i] - rest) * s + 2.0 * c * b;
        p.d[i + 1] = select(turns, rest + s * t, select(apart, rest, upper));
        shift = select(turns, s * t, shift);
        g = select(turns, c * t - b, g);
        going = going & ~apart;
        sweeps[now].c[i] = select(turns, c, one);
        sweeps[now].s[i] = select(turns, s, zero);
        sweeps[1 - now].turn();
      }
      p.d[first] = select(going, p.d[first] - shift, p.d[first]);
      p.e[first] = select(going, g, p.e[first]);
      sweeps[1 - now].finish();
      sweeps[now].begin(first, top);
      now = 1 - now;
    }
  sweeps[1 - now].finish();
}

/// A times two shapes at once, which share what is read of A.
template <class V, int flexible>
HYDRAPOD_INLINE void times_shapes(const BlockMatrix<V, flexible>& A, const V* phi, const V* psi,
                                  V* A_phi, V* A_psi) {
  V phi_r[6], psi_r[6], of_phi[6], of_psi[6];  // the platform's rows, in registers
  for (int i = 0; i < 6; ++i) {
    phi_r[i] = phi[i];
    psi_r[i] = psi[i];
  }
  for (int i = 0; i < 6; ++i) {
    of_phi[i] = A.rr(i, 0) * phi_r[0];
    of_psi[i] = A.rr(i, 0) * psi_r[0];
    for (int j = 1; j < 6; ++j) {
      of_phi[i] += A.rr(i, j) * phi_r[j];
      of_psi[i] += A.rr(i, j) * psi_r[j];
    }
  }
  for (int leg = 0; leg < leg_number; ++leg)
    for (int i = 0; i < flexible; ++i) {
      const int at = 6 + leg * flexible;
      V sum_phi{}, sum_psi{};
      for (int j = 0; j < flexible; ++j) {
        sum_phi += A.ff(leg, i, j) * phi[at + j];
        sum_psi += A.ff(leg, i, j) * psi[at + j];
      }
      const V own_phi = phi[at + i], own_psi = psi[at + i];
      for (int j = 0; j < 6; ++j) {
        const V entry = A.fr(leg, i, j);
        sum_phi += entry * phi_r[j];
        sum_psi += entry * psi_r[j];
        of_phi[j] += entry * own_phi;
        of_psi[j] += entry * own_psi;
      }
      A_phi[at + i] = sum_phi;
      A_psi[at + i] = sum_psi;
    }
  for (int i = 0; i < 6; ++i) {
    A_phi[i] = of_phi[i];
    A_psi[i] = of_psi[i];
  }
}

/// The modes and, per mode, M φ. Returns the residual; NaN where a lane failed.
template <class V, int flexible>
HYDRAPOD_APART V modes_of_lanes(const BlockMatrix<V, flexible>& M,
                                const BlockMatrix<V, flexible>& K, ModeNumbers<V, flexible>& modes,
                                V (&momentum)[modes_of(flexible)][modes_of(flexible)]) {
  constexpr int size = modes_of(flexible);
  LanePencil<V, size> p;
  p.X = modes.shapes;
  reduce_lanes<V, flexible>(M, K, p);
  tridiagonalize_lanes<V, size>(p);
  ql_lanes<V, size>(p);

  V per_mass[size], worst{}, largest{}, not_one{};
  for (int i = 0; i < 6; ++i) per_mass[i] = 1.0 / M.rr(i, i);
  for (int leg = 0; leg < leg_number; ++leg)
    for (int i = 0; i < flexible; ++i) per_mass[6 + leg * flexible + i] = 1.0 / M.ff(leg, i, i);
  V bad{}, forces[2][size];  // bad: NaN, once it is
  for (int k = 0; k < size; ++k) {
    const V* phi = modes.shapes[k];
    if (k % 2 == 0) {
      times_shapes<V, flexible>(K, phi, modes.shapes[k + 1], forces[0], forces[1]);
      times_shapes<V, flexible>(M, phi, modes.shapes[k + 1], momentum[k], momentum[k + 1]);
    }
    const V* force = forces[k % 2];
    V stiffness{}, mass{}, residual{};
    for (int i = 0; i < size; ++i) {
      stiffness += phi[i] * force[i];
      mass += phi[i] * momentum[k][i];
    }
    for (int i = 0; i < size; ++i) {
      const V left = force[i] - stiffness * momentum[k][i];
      residual += left * left * per_mass[i];
    }
    modes.omega2[k] = stiffness;
    bad += 0.0 * (residual + p.d[k]);
    not_one = larger(size_of(V(mass - 1.0)), not_one);
    worst = larger(residual, worst);
    largest = larger(size_of(stiffness), largest);
  }
  const V relative = root(worst) / select(largest > 0.0, largest, V{} + 1.0);
  return larger(relative, not_one) + bad;
}

}  // namespace

}  // namespace hydrapod::study
