#include "line_matrix.hpp"

#include <algorithm>
#include <limits>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// Of every line. Eigen's root has no branch for negative numbers, and is exact for four.
inline void take_root(SomeLines& x) {
  for (int line = 0; line < together; line += 4) {
    Eigen::Array4d values;
    for (int k = 0; k < 4; ++k) values[k] = x[line + k];
    values = values.sqrt();
    for (int k = 0; k < 4; ++k) x[line + k] = values[k];
  }
}

inline double largest(const SomeLines& x) {
  double result = x[0];
  for (int line = 1; line < together; ++line) result = std::max(result, x[line]);
  return result;
}

/// Rows r and k of A from column `from` on change places in the lines where column k of row r is
/// larger.
void exchange_if_larger(LineMatrix& A, LineMatrix& B, Index k, Index r) {
  const ComplexLines &a = A(k, k), &b = A(r, k);
  const auto larger = b.re * b.re + b.im * b.im > a.re * a.re + a.im * a.im;
  const auto exchange = [&](SomeLines& x, SomeLines& y) {
    const SomeLines kept = x;
    x = larger ? y : kept;
    y = larger ? kept : y;
  };
  for (auto* M : {&A, &B})
    for (Index j = 0; j < M->cols(); ++j) {
      exchange((*M)(k, j).re, (*M)(r, j).re);
      exchange((*M)(k, j).im, (*M)(r, j).im);
    }
}

/// row −= factor × other
void subtract_row(LineMatrix& M, Index row, Index other, const ComplexLines& factor, Index from) {
  const ComplexLines minus{-factor.re, -factor.im};
  for (Index j = from; j < M.cols(); ++j) add_product(minus, M(other, j), M(row, j));
}

void scale_row(LineMatrix& M, Index row, const ComplexLines& factor, Index from) {
  for (Index j = from; j < M.cols(); ++j) {
    ComplexLines product;
    add_product(factor, M(row, j), product);
    M(row, j) = product;
  }
}

/// Makes columns i and j of A orthogonal; `cosine` becomes at least the square of the cosine of
/// the angle between them.
void rotate(LineMatrix& A, Index i, Index j, SomeLines& cosine) {
  constexpr double tiny = 1e-300;  // keeps columns that are orthogonal or zero from 0/0
  SomeLines alpha{}, beta{};
  ComplexLines product;  // a_iᴴ a_j
  for (Index k = 0; k < A.rows(); ++k) {
    const ComplexLines &a = A(k, i), &b = A(k, j);
    alpha += a.re * a.re;
    beta += b.re * b.re;
    alpha += a.im * a.im;
    beta += b.im * b.im;
    add_product_conjugate(b, a, product);
  }
  const SomeLines square = product.re * product.re + product.im * product.im;
  const SomeLines now = square / (alpha * beta + tiny);
  cosine = now > cosine ? now : cosine;
  SomeLines size = square;
  take_root(size);
  size += tiny;
  const ComplexLines phase{(product.re + tiny) / size, product.im / size};
  const SomeLines zeta = (beta - alpha) / (2.0 * size);
  SomeLines hypotenuse = 1.0 + zeta * zeta;
  take_root(hypotenuse);
  const SomeLines t = 1.0 / (zeta < 0.0 ? zeta - hypotenuse : zeta + hypotenuse);
  SomeLines c = 1.0 + t * t;
  take_root(c);
  c = 1.0 / c;
  const SomeLines s = c * t;
  for (Index k = 0; k < A.rows(); ++k) {
    ComplexLines &a = A(k, i), &b = A(k, j), turned;  // b e^(−iφ): its product with a is real
    add_product_conjugate(b, phase, turned);
    b.re = s * a.re + c * turned.re;
    b.im = s * a.im + c * turned.im;
    a.re = c * a.re - s * turned.re;
    a.im = c * a.im - s * turned.im;
  }
}

/// Σ_k of what `add`(i, j, k, sum) adds, for each element of a matrix with the rows of A.
template <class Add>
LineMatrix product(const LineMatrix& A, Index cols, const Add& add) {
  LineMatrix C(A.rows(), cols);
  for (Index j = 0; j < C.cols(); ++j)
    for (Index i = 0; i < C.rows(); ++i) {
      ComplexLines sum;
      for (Index k = 0; k < A.cols(); ++k) add(i, j, k, sum);
      C(i, j) = sum;
    }
  return C;
}

}  // namespace

MatrixXcd LineMatrix::at(int line) const {
  MatrixXcd M(rows_, cols_);
  for (Index k = 0; k < M.size(); ++k) {
    const auto& value = values_[static_cast<std::size_t>(k)];
    M.data()[k] = {value.re[line], value.im[line]};
  }
  return M;
}

void LineMatrix::set(int line, const MatrixXcd& M) {
  for (Index k = 0; k < M.size(); ++k) {
    auto& value = values_[static_cast<std::size_t>(k)];
    value.re[line] = M.data()[k].real();
    value.im[line] = M.data()[k].imag();
  }
}

LineMatrix times(const LineMatrix& A, const LineMatrix& B) {
  return product(A, B.cols(), [&](Index i, Index j, Index k, ComplexLines& sum) {
    add_product(A(i, k), B(k, j), sum);
  });
}

LineMatrix times_adjoint(const LineMatrix& A, const LineMatrix& B) {
  return product(A, B.rows(), [&](Index i, Index j, Index k, ComplexLines& sum) {
    add_product_conjugate(A(i, k), B(j, k), sum);
  });
}

LineMatrix adjoint(const LineMatrix& A) {
  LineMatrix B(A.cols(), A.rows());
  for (Index i = 0; i < A.rows(); ++i)
    for (Index j = 0; j < A.cols(); ++j) B(j, i) = {A(i, j).re, -A(i, j).im};
  return B;
}

LineMatrix inverse(LineMatrix A) {
  const Index n = A.rows();
  LineMatrix B(n, n);
  for (Index k = 0; k < n; ++k) B(k, k).re += 1.0;
  for (Index k = 0; k < n; ++k) {
    for (Index r = k + 1; r < n; ++r) exchange_if_larger(A, B, k, r);
    const ComplexLines& pivot = A(k, k);
    const SomeLines square = pivot.re * pivot.re + pivot.im * pivot.im;
    const ComplexLines inverted{pivot.re / square, -pivot.im / square};
    scale_row(A, k, inverted, k + 1);
    scale_row(B, k, inverted, 0);
    for (Index r = 0; r < n; ++r) {
      if (r == k) continue;
      const ComplexLines factor = A(r, k);
      subtract_row(A, r, k, factor, k + 1);
      subtract_row(B, r, k, factor, 0);
    }
  }
  return B;
}

LineMatrix explained_powers(LineMatrix S_rr, LineMatrix S_rs) {
  const Index p = S_rr.rows();
  LineMatrix powers(1, S_rs.cols());
  auto definite = SomeLines{} == SomeLines{};
  for (Index k = 0; k < p; ++k) {  // elimination by columns of L, of S_rs as well
    SomeLines pivot = S_rr(k, k).re;
    definite &= pivot > 0.0;
    pivot = pivot > 0.0 ? pivot : 1.0 + SomeLines{};
    for (Index j = 0; j < S_rs.cols(); ++j) {
      const ComplexLines& own = S_rs(k, j);
      powers(0, j).re += (own.re * own.re + own.im * own.im) / pivot;
    }
    for (Index i = k + 1; i < p; ++i) {
      const ComplexLines minus{-S_rr(i, k).re / pivot, -S_rr(i, k).im / pivot};
      for (Index j = k + 1; j <= i; ++j) add_product_conjugate(minus, S_rr(j, k), S_rr(i, j));
      for (Index j = 0; j < S_rs.cols(); ++j) add_product(minus, S_rs(k, j), S_rs(i, j));
    }
  }
  for (Index j = 0; j < powers.cols(); ++j)
    powers(0, j).re = definite ? powers(0, j).re : SomeLines{};
  return powers;
}

void condition(LineMatrix A, SomeLines& result) {
  constexpr int most_sweeps = 20;
  // Convergence is quadratic: after the sweep that began with such angles they are below rounding.
  constexpr double small_cosine = 1e-10;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    SomeLines cosine{};
    for (Index i = 0; i < A.cols(); ++i)
      for (Index j = i + 1; j < A.cols(); ++j) rotate(A, i, j, cosine);
    if (!(largest(cosine) > small_cosine)) break;
  }
  SomeLines least = std::numeric_limits<double>::max() - SomeLines{}, most{};
  for (Index j = 0; j < A.cols(); ++j) {
    SomeLines square{};
    for (Index k = 0; k < A.rows(); ++k) {
      square += A(k, j).re * A(k, j).re;
      square += A(k, j).im * A(k, j).im;
    }
    least = square < least ? square : least;
    most = square > most ? square : most;
  }
  result = most / least;
  take_root(result);
}

}  // namespace hydrapod::identification
