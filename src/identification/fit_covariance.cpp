#include "fit_covariance.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "hydrapod/numerics/dense.hpp"
#include "leakage.hpp"
#include "line_weights.hpp"
#include "propagation.hpp"

namespace hydrapod::identification {

namespace {

/// Derivatives of each output by its own parameters.
std::vector<MatrixXd> own_derivatives(const FitSystem& system, const FitState& state) {
  const Index shared = system.shared_count(state.shared.poles.size());
  std::vector<MatrixXd> own;
  for (Index o = 0; o < system.outputs(); ++o) {
    const MatrixXd T = system.derivatives(state, o);
    own.emplace_back(T.rightCols(T.cols() - shared));
  }
  return own;
}

/// Errors of the shape of one mode of half spectra. Only its ratios mean anything: deviations are
/// √E|δφ_o − φ_o/φ_m δφ_m|², m the largest.
class ShapeErrors {
 public:
  ShapeErrors(const FitSystem& system, const FitState& state, const Propagation& propagation,
              const std::vector<MatrixXd>& X, const std::vector<MatrixXd>& own_inverse,
              const MatrixXd& N_inverse)
      : propagation_(propagation),
        X_(X),
        own_inverse_(own_inverse),
        N_inverse_(N_inverse),
        own_(own_derivatives(system, state)) {}

  /// |φ_o|²/E|δφ_o|², the best of the outputs that move most in proportion to their `sizes`.
  /// Entries err together, so that their sum is no measure.
  [[nodiscard]] double significance(const VectorXcd& shape, const VectorXd& sizes,
                                    Index mode) const {
    constexpr int tried = 3;
    VectorXd share = shape.cwiseAbs().cwiseQuotient(sizes);
    double best = 0.0;
    for (Index k = 0; k < std::min<Index>(tried, share.size()); ++k) {
      Index o = 0;
      share.maxCoeff(&o);
      share[o] = -1.0;
      const double variance = propagation_.variances(part(o, 2 * mode))[0] +
                              propagation_.variances(part(o, 2 * mode + 1))[0];
      best = std::max(best, std::norm(shape[o]) / std::max(variance, 1e-300));
    }
    return best;
  }

  [[nodiscard]] VectorXd deviations(const VectorXcd& shape, Index mode) const {
    Index largest = 0;
    shape.cwiseAbs().maxCoeff(&largest);
    const auto re_m = part(largest, 2 * mode), im_m = part(largest, 2 * mode + 1);
    VectorXd deviation = VectorXd::Zero(shape.size());
    for (Index o = 0; o < shape.size(); ++o) {
      if (o == largest) continue;
      const Complex s = shape[o] / shape[largest];
      auto re = part(o, 2 * mode), im = part(o, 2 * mode + 1);
      for (std::size_t k = 0; k < re.size(); ++k) {
        re[k] += s.imag() * im_m[k] - s.real() * re_m[k];
        im[k] -= s.real() * im_m[k] + s.imag() * re_m[k];
      }
      deviation[o] = std::sqrt(propagation_.variances(re)[0] + propagation_.variances(im)[0]);
    }
    return deviation;
  }

 private:
  /// Of own parameter `at` of output o.
  [[nodiscard]] Propagation::Factors part(Index o, Index at) const {
    const auto k = static_cast<std::size_t>(o);
    const VectorXd by_shared = N_inverse_ * X_[k].row(at).transpose();
    auto factors = propagation_.factors(-by_shared);
    factors[k] += own_[k] * own_inverse_[k].col(at);
    return factors;
  }

  const Propagation& propagation_;
  const std::vector<MatrixXd>&X_, &own_inverse_;
  const MatrixXd& N_inverse_;
  std::vector<MatrixXd> own_;  // derivatives by own parameters
};

/// Derivatives of ω and of ζ by Re λ and Im λ.
std::pair<Eigen::Vector2d, Eigen::Vector2d> frequency_and_damping(Complex l) {
  const double w = std::abs(l);
  // ζ = −Re/|λ|
  return {{l.real() / w, l.imag() / w},
          {-std::pow(l.imag(), 2) / std::pow(w, 3), l.real() * l.imag() / std::pow(w, 3)}};
}

void add_pole_deviations(const Propagation& propagation, const MatrixXd& N_inverse, double scale,
                         ModalModel& model) {
  const auto modes = std::ssize(model.modes);
  const Index numbers = N_inverse.cols() / modes;
  MatrixXd V(N_inverse.rows(), 2 * modes);
  for (Index r = 0; r < modes; ++r) {
    const auto [omega, zeta] = frequency_and_damping(model.modes[static_cast<size_t>(r)].pole);
    const auto pole = N_inverse.middleCols<2>(r * numbers);
    V.col(2 * r) = pole * omega;
    V.col(2 * r + 1) = pole * zeta;
  }
  const VectorXd variances = propagation.variances(V);
  for (Index r = 0; r < modes; ++r) {
    auto& mode = model.modes[static_cast<size_t>(r)];
    mode.omega_deviation = std::sqrt(scale * variances[2 * r]);
    mode.damping_deviation = std::sqrt(scale * variances[2 * r + 1]);
  }
}

/// What errors of the shared parameters do to Re φ and Im φ of each mode: a column per output.
MatrixXd of_shapes_by_poles(const Propagation& propagation, const MatrixXd& N_inverse,
                            const std::vector<MatrixXd>& X, Index modes) {
  const auto outputs = std::ssize(X);
  MatrixXd V(N_inverse.rows(), 2 * modes * outputs);
  for (Index o = 0; o < outputs; ++o)
    V.middleCols(2 * modes * o, 2 * modes) =
        numerics::times(N_inverse, X[static_cast<size_t>(o)].topRows(2 * modes).transpose());
  return propagation.variances(V).reshaped(2 * modes, outputs);
}

}  // namespace

MatrixXd own_by_shared(const MatrixXd& normal, Index shared) {
  const Index own = normal.rows() - shared;
  const MatrixXd N = normal.bottomRightCorner(own, own), B = normal.bottomLeftCorner(own, shared);
  return numerics::solve_positive(N, B);
}

double lines_in_step(const FrequencyResponses& responses) {
  double count = 1.0;
  for (std::size_t d = 1; d < responses.line_covariance.size(); ++d)
    count += 2.0 * responses.line_covariance[d].real();
  return count;
}

MatrixXcd modelled(const ModalModel& model, const std::vector<PoleLines>& lines, Index line,
                   const FrequencyResponses& responses) {
  const double omega = two_pi * responses.frequency[static_cast<size_t>(line)];
  const Complex s = Complex(responses.shift, omega) / model.omega_scale;
  MatrixXcd H = MatrixXcd::Zero(responses.H[0].rows(), responses.H[0].cols());
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    const MatrixXcd A = model.modes[r].shape * model.modes[r].participation.transpose();
    H += lines[r].g[line] * A + lines[r].g_conjugate[line] * A.conjugate();
  }
  int power = lowest_residual_power;
  for (const auto& C : model.residuals) H += std::pow(s, power++) * C;
  return H;
}

void add_deviations(const FitSystem& system, const FrequencyResponses& responses,
                    const FitState& state, const FitOptions& options, double misfit,
                    ModalModel& model) {
  const Deviations asked = options.deviations;
  const Index modes = state.shared.poles.size(), shared = system.shared_count(modes);
  MatrixXd N = MatrixXd::Zero(shared, shared);
  std::vector<MatrixXd> X, own_inverse;
  for (const auto& normal : system.normals(state)) {
    const Index own = normal.matrix.rows() - shared;
    X.push_back(own_by_shared(normal.matrix, shared));
    if (asked == Deviations::all || responses.whole)
      own_inverse.push_back(numerics::inverse_positive(normal.matrix.bottomRightCorner(own, own)));
    N += normal.matrix.topLeftCorner(shared, shared) -
         numerics::times(normal.matrix.topRightCorner(shared, own), X.back());
  }
  const double scale = responses.has_errors() ? std::max(1.0, misfit) : misfit;
  const MatrixXd N_inverse = numerics::inverse_positive(N);
  const auto let_in = leakage_parts(responses, model, options);
  const Propagation propagation(system, responses, state, X, let_in);
  add_pole_deviations(propagation, N_inverse, scale, model);
  if (responses.whole) {
    const ShapeErrors errors(system, state, propagation, X, own_inverse, N_inverse);
    const VectorXd sizes = row_sizes(responses);
    for (Index r = 0; r < modes; ++r) {
      auto& mode = model.modes[static_cast<size_t>(r)];
      mode.significance = errors.significance(mode.shape, sizes, r) / scale;
      if (asked == Deviations::all)
        mode.shape_deviation = std::sqrt(scale) * errors.deviations(mode.shape, r);
    }
  } else if (asked == Deviations::all) {
    MatrixXd variances = of_shapes_by_poles(propagation, N_inverse, X, modes);
    const auto own = let_in.D.empty() ? std::vector<MatrixXd>() : own_derivatives(system, state);
    for (Index o = 0; o < system.outputs(); ++o) {
      const auto at = static_cast<size_t>(o);
      const MatrixXd of_own = own_inverse[at].leftCols(2 * modes);
      variances.col(o) += let_in.D.empty()
                              ? VectorXd(0.5 * lines_in_step(responses) * of_own.diagonal())
                              : propagation.variances({numerics::times(own[at], of_own)}, o);
    }
    for (Index r = 0; r < modes; ++r)
      model.modes[static_cast<size_t>(r)].shape_deviation =
          (scale * variances.middleRows<2>(2 * r).colwise().sum()).cwiseSqrt().transpose();
  }
}

}  // namespace hydrapod::identification
