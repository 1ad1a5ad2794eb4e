#pragma once
/// Eigenvalues of a small symmetric matrix A of fixed size, with any matrix X carried along.
///
/// Householder's reflections make A tridiagonal, implicit QL with Wilkinson's shift makes it
/// diagonal (Golub & Van Loan, Matrix Computations, sections 8.3.1 and 8.3.3; EISPACK's tred2 and
/// imtql2). Every orthogonal step Q that turns A into Qᵀ A Q also turns X into X Q, so X = I ends
/// as the eigenvectors of A; who starts with an X for which A = Xᵀ K X and Xᵀ M X = I ends with the
/// modes of (K, M), without a further product.
///
/// Error: eigenvalues within a few epsilons of the largest one, as of any normwise stable method.
///
/// Why not Eigen's solver: at 18×18 it takes nearly twice as long. Its time goes into one chain of
/// dependent divisions and roots, shorter here, and into columns whose length no SIMD register
/// divides; here columns are filled up with zeros to whole registers.

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace hydrapod::modal {

/// Rows of a column of `size` numbers, filled up to whole 64-byte registers.
constexpr int padded(int size) { return (size + 7) / 8 * 8; }

template <int size>
using PaddedColumns = Eigen::Matrix<double, padded(size), size>;
template <int size>
using PaddedColumn = Eigen::Matrix<double, padded(size), 1>;

/// A and X on their way. Rows from `size` on are zero.
template <int size>
struct alignas(64) Pencil {
  PaddedColumns<size> A{PaddedColumns<size>::Zero()};  ///< symmetric, both triangles
  PaddedColumns<size> X{PaddedColumns<size>::Zero()};
  PaddedColumn<size> diagonal{};     ///< of the tridiagonal matrix; at the end the eigenvalues
  PaddedColumn<size> subdiagonal{};  ///< [k] stands between diagonal[k] and diagonal[k + 1]
};

/// aᵀ b. In halves of a register: gcc 12 warns of Eigen's sum over a whole one.
template <int rows>
double dot(const Eigen::Matrix<double, rows, 1>& a, const Eigen::Matrix<double, rows, 1>& b) {
  Eigen::Array4d even = Eigen::Array4d::Zero(), odd = Eigen::Array4d::Zero();
  for (int i = 0; i < rows; i += 8) {
    even += a.template segment<4>(i).array() * b.template segment<4>(i).array();
    odd += a.template segment<4>(i + 4).array() * b.template segment<4>(i + 4).array();
  }
  return (even + odd).sum();
}

/// A → tridiagonal, from the last column upwards.
template <int size>
void tridiagonalize(Pencil<size>& p) {
  using Column = PaddedColumn<size>;
  for (int k = size - 1; k > 1; --k) {
    p.diagonal[k] = p.A(k, k);
    Column v = p.A.col(k);  // its first k entries are reflected onto the last of them
    v.tail(padded(size) - k).setZero();
    const double last = v[k - 1];
    const double square = dot(v, v);
    p.subdiagonal[k - 1] = last;
    if (square == last * last) continue;  // nothing above the subdiagonal
    const double reflected = last > 0.0 ? -std::sqrt(square) : std::sqrt(square);
    p.subdiagonal[k - 1] = reflected;
    v[k - 1] -= reflected;
    const double beta = -1.0 / (reflected * v[k - 1]);  // H = I − β v vᵀ
    Column Av = Column::Zero(), Xv = Column::Zero();
    for (int j = 0; j < k; ++j) {
      Av += v[j] * p.A.col(j);
      Xv += v[j] * p.X.col(j);
    }
    Av *= beta;
    Xv *= beta;
    const Column w = Av - 0.5 * beta * dot(Av, v) * v;
    for (int j = 0; j < k; ++j) {
      p.A.col(j) -= v[j] * w + w[j] * v;
      p.X.col(j) -= v[j] * Xv;
    }
  }
  p.diagonal[1] = p.A(1, 1);
  p.diagonal[0] = p.A(0, 0);
  p.subdiagonal[0] = p.A(1, 0);
  p.subdiagonal[size - 1] = 0.0;
}

/// Columns (x, y) → (c x − s y, s x + c y).
template <int size>
void rotate_columns(PaddedColumns<size>& X, int first, double c, double s) {
  const PaddedColumn<size> x = X.col(first), y = X.col(first + 1);
  X.col(first) = c * x - s * y;
  X.col(first + 1) = s * x + c * y;
}

/// One QL sweep over the unreduced block first…last with the shift that its upper corner asks for.
template <int size>
void ql_sweep(Pencil<size>& p, int first, int last) {
  auto& d = p.diagonal;
  auto& e = p.subdiagonal;
  const double half = (d[first + 1] - d[first]) / (2.0 * e[first]);
  const double root = std::sqrt(half * half + 1.0);
  double g = d[last] - d[first] + e[first] / (half + (half > 0.0 ? root : -root));
  double s = 1.0, c = 1.0, shift = 0.0;
  for (int i = last - 1; i >= first; --i) {
    const double f = s * e[i], b = c * e[i];
    const double r = std::sqrt(f * f + g * g);
    e[i + 1] = r;
    if (r == 0.0) {  // the block has fallen apart below i
      d[i + 1] -= shift;
      e[last] = 0.0;
      return;
    }
    const double inverse = 1.0 / r;
    s = f * inverse;
    c = g * inverse;
    g = d[i + 1] - shift;
    const double t = (d[i] - g) * s + 2.0 * c * b;
    shift = s * t;
    d[i + 1] = g + shift;
    g = c * t - b;
    rotate_columns<size>(p.X, i, c, s);
  }
  d[first] -= shift;
  e[first] = g;
  e[last] = 0.0;
}

/// Index of the first negligible subdiagonal entry from `first` on, `size` − 1 if there is none.
/// Negligible against the geometric mean of its neighbours, as in LAPACK's dsteqr: low modes next
/// to high ones keep digits.
template <int size>
int end_of_block(const Pencil<size>& p, int first) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  constexpr double square = epsilon * epsilon, tiny = std::numeric_limits<double>::min();
  const auto negligible = [&](int k) {
    const double scale = std::abs(p.diagonal[k] * p.diagonal[k + 1]);
    return p.subdiagonal[k] * p.subdiagonal[k] <= square * scale + tiny;
  };
  int last = first;
  while (last < size - 1 && !negligible(last)) ++last;
  return last;
}

/// Makes A diagonal: p.diagonal holds the eigenvalues, p.X has followed. False when it does not
/// converge, which happens only when something is not finite.
template <int size>
[[nodiscard]] bool diagonalize(Pencil<size>& p) {
  constexpr int max_sweeps = 60;  // per eigenvalue; one or two are usual
  tridiagonalize(p);
  for (int first = 0; first < size; ++first) {
    int last = end_of_block(p, first);
    for (int sweep = 0; last != first; ++sweep, last = end_of_block(p, first)) {
      if (sweep == max_sweeps) return false;
      ql_sweep(p, first, last);
    }
  }
  return p.X.allFinite() && p.diagonal.template head<size>().allFinite();
}

}  // namespace hydrapod::modal
