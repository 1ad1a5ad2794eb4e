/// Variances of functions of the fitted parameters, against sums over all pairs of lines as the
/// headers state them, one function at a time.

#include "identification/propagation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "exact/modal_system.hpp"
#include "identification/fit_covariance.hpp"
#include "identification/fixed_poles.hpp"

namespace hydrapod::identification {
namespace {

constexpr Index outputs = 9, inputs = 2, lines = 53;

/// Independent complex numbers.
class Draw {
 public:
  MatrixXcd operator()(Index rows, Index columns) {
    MatrixXcd A(rows, columns);
    for (auto& a : A.reshaped()) a = {normal_(random_), normal_(random_)};
    return A;
  }
  /// Hermitian and positive.
  MatrixXcd covariance(Index size) {
    const MatrixXcd A = (*this)(size, size);
    return A * A.adjoint() + 0.3 * MatrixXcd::Identity(size, size);
  }

 private:
  std::mt19937 random_{41};
  std::normal_distribution<double> normal_{};
};

/// Three modes of nine outputs. The noise of outputs, of inputs and of neighbouring lines goes
/// together.
class Propagated : public ::testing::Test {
 protected:
  Propagated() {
    std::vector<PoleEstimate> poles;
    test::ModalSystem modes;
    for (const double f : {4.3, 6.1, 9.7}) {
      test::ExactMode mode{.pole = std::polar(two_pi * f, 1.6),
                           .shape = draw_(outputs, 1),
                           .participation = draw_(inputs, 1)};
      Index largest = 0;
      mode.participation.cwiseAbs().maxCoeff(&largest);
      mode.participation /= Complex(mode.participation[largest]);
      poles.push_back({.pole = mode.pole, .shape = {}, .participation = mode.participation});
      modes.modes.push_back(mode);
    }
    for (Index k = 0; k < lines; ++k) {
      r_.frequency.push_back(2.9 + 0.17 * static_cast<double>(k));
      r_.H.push_back(modes.response(r_.frequency.back()));
      r_.noise.push_back(1e-7 * draw_.covariance(outputs));
      r_.input_factor.push_back(draw_.covariance(inputs));
      let_in_.D.push_back(1e-4 * draw_(outputs, inputs));
    }
    r_.outputs.resize(outputs);
    r_.inputs.resize(inputs);
    r_.line_covariance = {1.0, {0.31, 0.12}, {0.04, -0.03}};
    r_.leakage = {3.7, {1.0, -0.4, 0.07, 0.01}, {0.6, -0.3, 0.05, -0.02}};
    let_in_.share = MatrixXd::Constant(lines, outputs, 0.17) +
                    0.1 * draw_(lines, outputs).real().cwiseAbs().cwiseMin(3.0);
    system_.emplace(r_, FitOptions{});
    state_ = system_->solved(shared_parameters(poles, inputs));
    const Index shared = system_->shared_count(state_.shared.poles.size());
    for (const auto& normal : system_->normals(state_))
      X_.push_back(own_by_shared(normal.matrix, shared));
  }

  [[nodiscard]] Propagation propagation() const { return {*system_, r_, state_, X_, let_in_}; }

  /// f_oi in column o inputs + i, a row per line.
  [[nodiscard]] MatrixXcd changes(const VectorXd& v) const {
    const Parts d = system_->slopes(state_);
    const auto& c = state_.functions;
    const Index n = c.re.cols(), count = d.re.cols() / inputs;
    MatrixXcd f = MatrixXcd::Zero(lines, outputs * inputs);
    for (Index o = 0; o < outputs; ++o) {
      const MatrixXd T = system_->derivatives(state_, o);
      const VectorXd by_column =
          T.leftCols(v.size()) * v -
          T.rightCols(T.cols() - v.size()) * (X_[static_cast<std::size_t>(o)] * v);
      for (Index k = 0; k < lines; ++k) {
        VectorXcd plain = VectorXcd::Zero(inputs);
        for (Index i = 0; i < inputs; ++i) {
          for (Index a = 0; a < n; ++a)
            plain[i] += by_column[a * inputs + i] * Complex(c.re(k, a), c.im(k, a));
          for (Index a = 0; a < count; ++a)
            plain[i] +=
                by_column[n * inputs + a] * Complex(d.re(k, i * count + a), d.im(k, i * count + a));
        }
        f.row(k).segment(o * inputs, inputs) =
            (system_->whitening()[static_cast<std::size_t>(k)] * plain).transpose() /
            system_->deviation()(k, o);
      }
    }
    return f;
  }

  /// ½ Re Σ_kl a_(l−k) f_iᴴ(k) C(k) f_i(l).
  [[nodiscard]] double variance_of_noise(const MatrixXcd& f, bool alone) const {
    Complex sum = 0.0;
    for (Index k = 0; k < lines; ++k)
      for (Index l = 0; l < lines; ++l) {
        const auto apart = static_cast<std::size_t>(std::abs(l - k));
        if (apart >= r_.line_covariance.size() || (alone && apart > 0)) continue;
        const Complex a = l < k ? std::conj(r_.line_covariance[apart]) : r_.line_covariance[apart];
        for (Index o = 0; o < outputs; ++o)
          for (Index q = 0; q < outputs; ++q) {
            const Complex C =
                covariance(k, o, q) * std::sqrt((1.0 - share(k, o)) * (1.0 - share(k, q)));
            for (Index i = 0; i < inputs; ++i)
              sum += std::conj(f(k, o * inputs + i)) * C * a * f(l, q * inputs + i);
          }
      }
    return 0.5 * sum.real();
  }

  /// ½ Re Σ_kl (a z_ji*(k) z_ji(l) + b z_ji(k) z_ij(l)), z = Dᴴ f.
  [[nodiscard]] double variance_of_leakage(const MatrixXcd& f) const {
    std::vector<MatrixXcd> z;
    for (Index k = 0; k < lines; ++k) {
      z.emplace_back(MatrixXcd::Zero(inputs, inputs));
      for (Index o = 0; o < outputs; ++o)
        for (Index j = 0; j < inputs; ++j)
          for (Index i = 0; i < inputs; ++i)
            z.back()(j, i) += std::sqrt(factor(k)) / system_->deviation()(k, o) *
                              std::conj(let_in_.D[static_cast<std::size_t>(k)](o, j)) *
                              f(k, o * inputs + i);
    }
    double alone = 0.0, related = 0.0;
    for (Index k = 0; k < lines; ++k)
      for (Index l = 0; l < lines; ++l) {
        const auto apart = static_cast<std::size_t>(std::abs(l - k));
        if (apart >= r_.leakage.relation.size()) continue;
        const auto &one = z[static_cast<std::size_t>(k)], &other = z[static_cast<std::size_t>(l)];
        for (Index j = 0; j < inputs; ++j)
          for (Index i = 0; i < inputs; ++i) {
            alone +=
                r_.leakage.line_covariance[apart] * (std::conj(one(j, i)) * other(j, i)).real();
            related += r_.leakage.relation[apart] * (one(j, i) * other(i, j)).real();
          }
      }
    return 0.5 * std::max(alone + related, 0.05 * alone);
  }

  [[nodiscard]] double expected(const VectorXd& v) const {
    const MatrixXcd f = changes(v);
    const double together = variance_of_noise(f, false);
    return (together > 0.0 ? together : variance_of_noise(f, true)) + variance_of_leakage(f);
  }

  /// All functions at once, which goes by sums of all pairs of parameters, and few.
  void expect_as_stated(double tolerance) const {
    const Index shared = system_->shared_count(state_.shared.poles.size());
    const MatrixXd V = Draw()(shared, 40 * shared).real();
    const auto propagation = this->propagation();
    const VectorXd many = propagation.variances(V), few = propagation.variances(V.leftCols(5));
    for (Index v = 0; v < few.size(); ++v) {
      const double stated = expected(V.col(v));
      EXPECT_NEAR(few[v], stated, tolerance * stated);
      EXPECT_NEAR(many[v], stated, tolerance * stated);
    }
  }

  Draw draw_{};
  FrequencyResponses r_{};
  LeakageParts let_in_{};
  std::optional<FitSystem> system_{};
  FitState state_{};
  std::vector<MatrixXd> X_{};

 private:
  [[nodiscard]] double factor(Index k) const {
    return r_.input_factor[static_cast<std::size_t>(k)].diagonal().real().mean();
  }
  [[nodiscard]] Complex covariance(Index k, Index o, Index q) const {
    const auto& deviation = system_->deviation();
    return r_.noise[static_cast<std::size_t>(k)](o, q) * factor(k) /
           (deviation(k, o) * deviation(k, q));
  }
  [[nodiscard]] double share(Index k, Index o) const { return let_in_.share(k, o); }
};

constexpr double rounding = 1e-12;  // sums of some 10⁵ numbers of either sign

TEST_F(Propagated, VariancesAreThoseOfAllPairsOfLines) { expect_as_stated(rounding); }

/// A sum that lines in step would make negative is that of lines for themselves.
TEST_F(Propagated, ANegativeSumIsThatOfLinesForThemselves) {
  r_.line_covariance = {1.0, -6.0};
  expect_as_stated(rounding);
  const MatrixXd V = Draw()(X_[0].cols(), 5).real();
  int below_zero = 0;
  for (const auto& v : V.colwise()) below_zero += variance_of_noise(changes(v), false) < 0.0;
  EXPECT_GT(below_zero, 0);
}

/// Own parameters of one output.
TEST_F(Propagated, FactorsOfOneOutputAreThoseOfAllWithTheOthersZero) {
  const auto propagation = this->propagation();
  auto all = propagation.factors(Draw()(X_[0].cols(), 3).real());
  constexpr Index which = 4;
  const Propagation::Factors one{all[which]};
  for (Index o = 0; o < outputs; ++o)
    if (o != which) all[static_cast<std::size_t>(o)].setZero();
  const VectorXd alone = propagation.variances(one, which), among = propagation.variances(all);
  for (Index v = 0; v < alone.size(); ++v) EXPECT_NEAR(alone[v], among[v], rounding * among[v]);
}

}  // namespace
}  // namespace hydrapod::identification
