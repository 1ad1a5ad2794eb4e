#include "matrix_roots.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "hydrapod/numerics/dense.hpp"
#include "line_matrix.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// Real roots have, after rounding, an imaginary part of this share at most.
constexpr double real_share = 1e-9;

/// Q and dQ/dw for as many w as are computed side by side.
class Polynomial {
 public:
  explicit Polynomial(const std::vector<MatrixXd>& A)
      : side_(A[0].rows()),
        degree_(static_cast<Index>(A.size())),
        coefficients_(degree_, side_ * side_) {
    for (Index k = 0; k < degree_; ++k)
      coefficients_.row(k) = A[static_cast<std::size_t>(k)].reshaped().transpose();
  }
  [[nodiscard]] Index side() const { return side_; }
  [[nodiscard]] Index degree() const { return degree_; }
  [[nodiscard]] Index roots() const { return degree_ * side_; }

  void at(const ComplexLines& w, LineMatrix& Q, LineMatrix& slope) const {
    const Index entries = side_ * side_;
    Index entry = 0;
    for (; entry + 2 <= entries; entry += 2) evaluate<2>(w, entry, Q, slope);
    if (entry < entries) evaluate<1>(w, entry, Q, slope);
  }

 private:
  /// Horner's scheme for some entries: products of one need not wait for those of the other.
  template <int count>
  void evaluate(const ComplexLines& w, Index entry, LineMatrix& Q, LineMatrix& slope) const {
    std::array<ComplexLines, count> value{}, derivative{};
    for (int e = 0; e < count; ++e)
      if ((entry + e) % (side_ + 1) == 0) value[static_cast<std::size_t>(e)].re += 1.0;
    const double* a = coefficients_.data() + degree_ * entry;
    for (Index k = 0; k < degree_; ++k)
      for (std::size_t e = 0; e < count; ++e) {
        ComplexLines next = value[e];
        add_product(derivative[e], w, next);
        derivative[e] = next;
        next = {};
        next.re += a[k + degree_ * static_cast<Index>(e)];
        add_product(value[e], w, next);
        value[e] = next;
      }
    for (int e = 0; e < count; ++e) {
      const Index i = (entry + e) % side_, j = (entry + e) / side_;
      Q(i, j) = value[static_cast<std::size_t>(e)];
      slope(i, j) = derivative[static_cast<std::size_t>(e)];
    }
  }

  Index side_, degree_;
  MatrixXd coefficients_;  // degree × entries
};

/// Roots that are computed side by side; beyond the last, it again.
ComplexLines gathered(const VectorXcd& roots, const std::vector<Index>& which, std::size_t first) {
  ComplexLines w;
  for (int k = 0; k < together; ++k) {
    const auto at = std::min(first + static_cast<std::size_t>(k), which.size() - 1);
    w.re[k] = roots[which[at]].real();
    w.im[k] = roots[which[at]].imag();
  }
  return w;
}

/// Σ 1/(w − w_j) over all other roots.
ComplexLines repulsion(const ComplexLines& w, const VectorXcd& roots) {
  constexpr double tiny = 1e-300;  // a root does not act on itself
  ComplexLines sum;
  for (const Complex& other : roots) {
    const SomeLines re = w.re - other.real(), im = w.im - other.imag();
    const SomeLines inverted = 1.0 / (re * re + im * im + tiny);
    sum.re += re * inverted;
    sum.im -= im * inverted;
  }
  return sum;
}

/// On the circle whose radius is the mean of the roots' (geometric); no two are conjugates, else
/// none could become real.
VectorXcd first_guess(const std::vector<MatrixXd>& A) {
  const auto count = static_cast<Index>(A.size()) * A[0].rows();
  const Eigen::PartialPivLU<MatrixXd> factors(A.back());
  const double logarithm = factors.matrixLU().diagonal().cwiseAbs().array().log().mean();
  const double radius = std::exp(std::clamp(logarithm / static_cast<double>(A.size()), -1.0, 1.0));
  VectorXcd guess(count);
  for (Index k = 0; k < count; ++k)
    guess[k] =
        std::polar(radius, two_pi * (static_cast<double>(k) + 0.3) / static_cast<double>(count));
  return guess;
}

/// One step of each of the roots that have not converged.
void improve(const Polynomial& polynomial, VectorXcd& roots, std::vector<Index>& open) {
  // Convergence is cubic: what is left after such a step is below rounding.
  constexpr double small_step = 1e-9;
  LineMatrix Q(polynomial.side(), polynomial.side()), slope = Q;
  std::vector<Index> still_open;
  for (std::size_t first = 0; first < open.size(); first += together) {
    const ComplexLines w = gathered(roots, open, first);
    polynomial.at(w, Q, slope);
    const LineMatrix inverted = inverse(Q);
    ComplexLines newton = repulsion(w, roots);  // tr(Q⁻¹ Q') − Σ
    newton = {-newton.re, -newton.im};
    for (Index i = 0; i < Q.rows(); ++i)
      for (Index j = 0; j < Q.cols(); ++j) add_product(inverted(i, j), slope(j, i), newton);
    for (std::size_t k = first; k < std::min(first + together, open.size()); ++k) {
      const auto own = static_cast<int>(k - first);
      const Complex step = 1.0 / Complex(newton.re[own], newton.im[own]);
      Complex& root = roots[open[k]];
      if (std::isfinite(std::abs(step)))
        root -= step;  // else Q is singular: that is the root
      else
        continue;
      if (!(std::abs(step) < small_step * std::abs(root))) still_open.push_back(open[k]);
    }
  }
  open = std::move(still_open);
}

/// Σ w and Σ w² are those of the coefficients: no root was found twice in place of another.
bool complete(const std::vector<MatrixXd>& A, const VectorXcd& roots) {
  constexpr double rounding = 1e-9;
  double squares = (A[0] * A[0]).trace();
  if (A.size() > 1) squares -= 2.0 * A[1].trace();
  const double size = roots.cwiseAbs().sum(), square_size = roots.cwiseAbs2().sum();
  return std::abs(roots.sum() + A[0].trace()) <= rounding * size &&
         std::abs(roots.array().square().sum() - squares) <= rounding * square_size;
}

bool below_axis(Complex w) { return w.imag() < -real_share * std::abs(w); }

MatrixRoot with_vectors(Complex w, const MatrixXcd& inverted, const MatrixXcd& slope,
                        Index degree) {
  MatrixRoot root{.value = w};
  Index row = 0, column = 0;
  inverted.rowwise().squaredNorm().maxCoeff(&row);
  inverted.colwise().squaredNorm().maxCoeff(&column);
  double length = 0.0;
  for (Index k = 0; k < degree; ++k) length += std::pow(std::abs(w), 2.0 * static_cast<double>(k));
  root.right = inverted.col(column).normalized() / std::sqrt(length);
  root.left = inverted.row(row).transpose().normalized();
  root.left /= (root.left.transpose() * slope * root.right).value();
  return root;
}

}  // namespace

std::optional<std::vector<MatrixRoot>> iterated_roots(const std::vector<MatrixXd>& A) {
  constexpr int most_steps = 60;
  const Polynomial polynomial(A);
  VectorXcd roots = first_guess(A);
  std::vector<Index> open(static_cast<std::size_t>(roots.size()));
  std::iota(open.begin(), open.end(), Index{0});
  for (int step = 0; step < most_steps && !open.empty(); ++step) improve(polynomial, roots, open);
  if (!open.empty() || !complete(A, roots)) return {};
  std::vector<Index> kept;
  for (Index r = 0; r < roots.size(); ++r)
    if (below_axis(roots[r])) kept.push_back(r);
  std::vector<MatrixRoot> found;
  LineMatrix Q(polynomial.side(), polynomial.side()), slope = Q;
  for (std::size_t first = 0; first < kept.size(); first += together) {
    ComplexLines w = gathered(roots, kept, first);
    w.re *= 1.0 + 4e-16;  // Q of the root itself may be singular in all digits
    polynomial.at(w, Q, slope);
    const LineMatrix inverted = inverse(Q);
    for (std::size_t k = first; k < std::min(first + together, kept.size()); ++k) {
      const auto own = static_cast<int>(k - first);
      found.push_back(
          with_vectors(roots[kept[k]], inverted.at(own), slope.at(own), polynomial.degree()));
      if (!found.back().right.allFinite() || !found.back().left.allFinite()) return {};
    }
  }
  return found;
}

std::vector<MatrixRoot> companion_roots(const std::vector<MatrixXd>& A) {
  const Index side = A[0].rows(), degree = static_cast<Index>(A.size()), size = side * degree;
  MatrixXd companion = MatrixXd::Zero(size, size);
  if (degree > 1) companion.topRightCorner(size - side, size - side).setIdentity();
  for (Index k = 0; k < degree; ++k)  // w^k has the coefficient A_{n−k}
    companion.block(size - side, k * side, side, side) =
        -A[static_cast<std::size_t>(degree - 1 - k)];
  const auto [values, vectors, converged] = numerics::eigen_pairs(companion);
  if (!converged) return {};
  const MatrixXcd left = numerics::inverse(vectors);
  std::vector<MatrixRoot> found;
  for (Index r = 0; r < size; ++r)
    if (values[r].imag() < 0.0)
      found.push_back({.value = values[r],
                       .right = vectors.col(r).head(side),
                       .left = left.row(r).tail(side).transpose()});
  return found;
}

}  // namespace hydrapod::identification
