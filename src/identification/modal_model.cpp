#include "hydrapod/identification/identify.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "fit_covariance.hpp"
#include "fixed_poles.hpp"
#include "trial_fit.hpp"

namespace hydrapod::identification {

namespace {

/// Normal equations of the shared parameters, own ones eliminated.
FitSystem::Normal reduced_normal(const FitSystem& system, const FitState& state) {
  const Index shared = system.shared_count(state.shared.poles.size());
  FitSystem::Normal sum{MatrixXd::Zero(shared, shared), VectorXd::Zero(shared)};
  for (const auto& normal : system.normals(state)) {
    const MatrixXd X = own_by_shared(normal.matrix, shared);
    const Index own = normal.matrix.rows() - shared;
    sum.matrix +=
        normal.matrix.topLeftCorner(shared, shared) - normal.matrix.topRightCorner(shared, own) * X;
    sum.gradient += normal.gradient.head(shared) - X.transpose() * normal.gradient.tail(own);
  }
  return sum;
}

bool is_sound(const SharedParameters& shared) {
  return shared.participations.allFinite() && (shared.poles.array().real() < 0.0).all() &&
         (shared.poles.array().imag() > 0.0).all();
}

/// One accepted step; false when none is found.
bool improve(const FitSystem& system, FitState& state, double& damping) {
  const auto normal = reduced_normal(system, state);
  const VectorXd scale = normal.matrix.diagonal().cwiseMax(1e-300);
  for (int attempt = 0; attempt < 8; ++attempt, damping *= 10.0) {
    MatrixXd N = normal.matrix;
    N.diagonal() += damping * scale;
    auto shared = state.shared;
    shared.step(N.ldlt().solve(normal.gradient));
    if (!is_sound(shared)) continue;
    FitState trial = system.solved(std::move(shared));
    if (!(trial.cost < state.cost)) continue;
    state = std::move(trial);
    damping = std::max(damping / 10.0, 1e-10);
    return true;
  }
  return false;
}

/// Mean of |residual|²/variance, less the parameters.
double misfit_of(const FitSystem& system, const FitState& state) {
  const Index modes = state.shared.poles.size();
  const double numbers = static_cast<double>(system.lines()) * system.numbers_per_line();
  const double parameters = 0.5 * static_cast<double>(system.shared_count(modes) +
                                                      system.outputs() * system.own_count(modes));
  return state.cost / std::max(1.0, numbers - parameters);
}

/// FittedMode::significance of all modes.
VectorXd significances(const FitSystem& system, const FitState& state,
                       const FrequencyResponses& responses) {
  const double count = 2.0 * static_cast<double>(system.outputs() + system.inputs());
  const double misfit = misfit_of(system, state);
  const double unit = responses.has_errors() ? std::max(1.0, misfit) : std::max(misfit, 1e-300);
  return state.mode_power / count / unit;
}

/// Sees that modes which are tried are not worth going on.
class Prospect {
 public:
  Prospect(const Worth& worth, VectorXd significance)
      : worth_(worth), last_(std::move(significance)), growth_{} {}

  /// Now, without another iteration.
  [[nodiscard]] bool failed() const { return falls_short(VectorXd::Zero(last_.size())); }

  /// Also with all the iterations that are left.
  [[nodiscard]] bool fails(VectorXd significance, int iterations_left) {
    growth_[static_cast<size_t>(seen_++) % growth_.size()] = significance - last_;
    last_ = std::move(significance);
    if (seen_ < static_cast<int>(growth_.size())) return false;
    VectorXd fastest = VectorXd::Zero(last_.size());
    for (const auto& growth : growth_) fastest = fastest.cwiseMax(growth);
    return falls_short(worth_.patience * iterations_left * fastest);
  }

 private:
  [[nodiscard]] bool falls_short(const VectorXd& to_come) const {
    const auto tried = last_.size() - static_cast<Index>(worth_.first);
    return ((last_ + to_come).tail(tried).array() < worth_.least_significance).any();
  }

  const Worth& worth_;
  VectorXd last_;
  std::array<VectorXd, 3> growth_;
  int seen_{};
};

/// `worth`: may be none.
std::optional<ModalModel> fitted(const FrequencyResponses& responses,
                                 const std::vector<PoleEstimate>& start, const FitOptions& options,
                                 const Worth* worth) {
  if (start.empty()) throw std::invalid_argument("a modal model needs at least one pole");
  const FitSystem system(responses, options);
  FitState state = system.solved(shared_parameters(start, system.inputs()));
  std::optional<Prospect> prospect;
  if (worth != nullptr) prospect.emplace(*worth, significances(system, state, responses));
  double damping = 1e-4;
  int iterations = 0;
  bool converged = false;
  for (; iterations < options.max_iterations; ++iterations) {
    const double before = state.cost;
    converged =
        !improve(system, state, damping) || before - state.cost <= options.tolerance * before;
    if (prospect && prospect->fails(significances(system, state, responses),
                                    options.max_iterations - iterations - 1))
      return {};
    if (converged) break;
  }
  if (prospect && prospect->failed()) return {};
  ModalModel model = model_of(system, responses, state);
  model.iterations = iterations;
  model.converged = converged;
  const double misfit = misfit_of(system, state);
  if (responses.has_errors()) model.misfit = misfit;
  const VectorXd significance = significances(system, state, responses);
  for (Index r = 0; r < significance.size(); ++r)
    model.modes[static_cast<size_t>(r)].significance = significance[r];
  if (options.deviations != Deviations::none)
    add_deviations(system, responses, state, options, misfit, model);
  return model;
}

}  // namespace

ModalModel fit_modes(const FrequencyResponses& responses, const std::vector<PoleEstimate>& start,
                     const FitOptions& options) {
  return *fitted(responses, start, options, nullptr);
}

std::optional<ModalModel> fit_if_worth(const FrequencyResponses& responses,
                                       const std::vector<PoleEstimate>& start,
                                       const FitOptions& options, const Worth& worth) {
  return fitted(responses, start, options, &worth);
}

MatrixXcd synthesised(const ModalModel& model, double frequency, double shift) {
  const Complex s(shift, two_pi * frequency);
  MatrixXcd H = MatrixXcd::Zero(model.residuals[0].rows(), model.residuals[0].cols());
  for (const auto& mode : model.modes) {
    const MatrixXcd A = mode.shape * mode.participation.transpose();
    H += A / (s - mode.pole) + A.conjugate() / (s - std::conj(mode.pole));
  }
  int power = lowest_residual_power;
  for (const auto& C : model.residuals) H += std::pow(s / model.omega_scale, power++) * C;
  return H;
}

std::vector<MatrixXcd> on_imaginary_axis(const FrequencyResponses& responses,
                                         const Identification& found) {
  std::vector<MatrixXcd> H(responses.H.begin(), responses.H.end());
  auto poles = found.model;  // residual terms hold in the band of the fit alone
  for (auto& C : poles.residuals) C.setZero();
  for (std::size_t k = 0; k < responses.lines(); ++k) {
    const double f = responses.frequency[k];
    const auto& model = f >= found.from && f <= found.to ? found.model : poles;
    H[k] += synthesised(model, f) - synthesised(model, f, responses.shift);
  }
  return H;
}

}  // namespace hydrapod::identification
