#include "candidate.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "amplitudes.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "variables.hpp"

namespace hydrapod::calibration {

namespace {
constexpr double outlier = 5.0;  ///< deviations

/// Uniform in [0, 1), the same with every standard library.
double uniform(std::mt19937_64& generator) {
  return static_cast<double>(generator() >> 11) * 0x1.0p-53;
}

/// Data residuals and their derivatives (rows of kinds that are data), and the others.
struct Linearised {
  State state{};
  Eigen::VectorXd data{};
  Eigen::MatrixXd J_data{};
  Eigen::MatrixXd J_prior{};
  int values{};  ///< that the data are
};

/// None where the machine, or one a little beside it, cannot be observed.
std::optional<Linearised> linearise(const Problem& problem, const Eigen::VectorXd& x) {
  Linearised result;
  if (!problem.evaluate(x, true, result.state)) return std::nullopt;
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  problem.residuals(x, result.state, r, &J);
  std::vector<int> data, priors;
  int row = 0;
  for (const auto& kind : problem.residuals()) {
    if (kind->is_data()) result.values += kind->values();
    for (int k = 0; k < kind->size(); ++k, ++row) {
      if (kind->is_data()) {
        data.push_back(row);
      } else if (kind->size() == 1) {
        priors.push_back(row);
      }
    }
  }
  result.data = r(data);
  result.J_data = J(data, Eigen::all);
  result.J_prior = J(priors, Eigen::all);
  return result;
}

bool at_bound(const Variable& variable, double x) {
  constexpr double near = 1e-6;
  return x - variable.x_lower() < near || variable.x_upper() - x < near;
}

double size_of(const Variable& variable, double value) {
  return variable.sign != 0 ? std::abs(value) : variable.scale;
}

/// Relative deviations when the data and the priors speak together.
Eigen::VectorXd joint_deviations(const Linearised& at, double scatter) {
  const auto n = at.J_data.cols();
  if (n == 0) return {};
  Eigen::MatrixXd A(at.J_data.rows() + at.J_prior.rows(), n);
  A << at.J_data / scatter, at.J_prior;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  constexpr double rounding = 1e-8, touched = 1e-10;
  const double none = rounding * svd.singularValues()[0];
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double sigma = k < svd.singularValues().size() ? svd.singularValues()[k] : 0.0;
    for (Eigen::Index j = 0; j < n; ++j) {
      const double share = std::pow(svd.matrixV()(j, k), 2);
      if (sigma > none) variance[j] += share / (sigma * sigma);
      if (sigma <= none && share > touched) variance[j] = infinite;
    }
  }
  // not Eigen's: with AVX-512 it makes NaN of infinity
  for (auto& value : variance) value = std::sqrt(value);
  return variance;
}

FittedParameter fitted(const Variable& variable, double x, double data, double joint,
                       double half_width) {
  const double value = x == variable.x(variable.start) ? variable.start : variable.value(x);
  FittedParameter p{.paths = variable.paths,
                    .unit = variable.unit,
                    .start = variable.start,
                    .lower = variable.lower,
                    .upper = variable.upper,
                    .stated = variable.stated,
                    .value = value,
                    .has_prior = variable.prior.has_value()};
  const double size = size_of(variable, value);
  p.deviation = joint * size;
  p.data_deviation = data * size;
  const double reach = half_width * joint;
  const double a = variable.sign != 0 ? value * std::exp(-reach) : value - reach * size;
  const double b = variable.sign != 0 ? value * std::exp(reach) : value + reach * size;
  p.interval_low = std::min(a, b);
  p.interval_high = std::max(a, b);
  p.verdict = at_bound(variable, x)                                      ? Verdict::at_bound
              : p.has_prior && p.data_deviation > variable.prior->spread ? Verdict::by_prior
              : joint <= free_above                                      ? Verdict::determined
                                                                         : Verdict::undetermined;
  return p;
}

/// How the observed modes meet target i.
FittedTarget met(const Problem& problem, const State& state, std::size_t i) {
  const auto& target = problem.targets().modes[i];
  const int p = problem.point_of(static_cast<int>(i));
  const auto& point = state.seen[static_cast<std::size_t>(p)];
  const int k = point.mode_of[i];
  const auto& mode = point.seen.modes[static_cast<std::size_t>(k)];
  FittedTarget fit{.mode = k, .omega = mode.omega()};
  if (problem.observes_plant())
    fit.mode = nearest_mode(point.seen.mechanics, modal::normal_modes(point.seen.mechanics), mode);
  const bool damped = problem.observes_plant() ||
                      state.points[static_cast<std::size_t>(p)].damped_mode(k) != nullptr;
  if (target.damping && damped) {
    fit.damping = mode.damping_ratio();
  } else if (target.damping) {
    const auto& undamped = state.points[static_cast<std::size_t>(p)];
    const dynamics::ModelVector phi = undamped.modes.shapes.col(k);
    const double omega = std::max(fit.omega, 1e-9);
    const double dampers =
        phi.dot(undamped.model.C * phi) + modal::relaxed_damping(undamped.model.arms, phi, omega);
    fit.damping = dampers / (2.0 * omega) + modal::modal_ratio(state.machine).value;
  }
  if (target.shape) {
    fit.shape_mac = shown_mac(point.seen, point.group_of(i), target);
  } else if (target.direction) {
    fit.mode_direction =
        observation::contradicted_direction(point.seen, k, point.group_of(i), *target.direction);
  }
  return fit;
}

void describe_targets(const Problem& problem, const State& state, Candidate& candidate) {
  candidate.targets.clear();
  candidate.worst = 0.0;
  const auto& targets = problem.targets().modes;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    auto fit = met(problem, state, i);
    fit.difference = (fit.omega - targets[i].omega) / targets[i].deviation;
    fit.outlier = candidate.robust && std::abs(fit.difference) > outlier * candidate.scatter;
    candidate.worst = std::max(candidate.worst, std::abs(fit.omega - targets[i].omega));
    candidate.targets.push_back(fit);
  }
}

void describe_responses(const Problem& problem, const State& state, Candidate& candidate) {
  candidate.responses.clear();
  const auto& all = problem.targets().responses;
  for (std::size_t t = 0; t < all.size(); ++t) {
    const int p = problem.point_of_response(static_cast<int>(t));
    const auto& seen = state.seen[static_cast<std::size_t>(p)].seen;
    for (std::size_t line = 0; line < all[t].s.size(); ++line) {
      const Eigen::MatrixXcd rest =
          response_rest(seen, all[t], line, problem.metric_of_response(static_cast<int>(t)));
      for (int input = 0; input < rest.cols(); ++input) {
        const double left = rest.col(input).norm();
        candidate.responses.push_back({t, line, input, left, left / all[t].deviation[line][input]});
      }
    }
  }
}

/// Rows of targets that count: those that are no outliers.
void drop_outliers(const Candidate& candidate, const Problem& problem, Linearised& at) {
  if (!candidate.robust) return;
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < candidate.targets.size(); ++i) {
    const auto& target = problem.targets().modes[i];
    if (candidate.targets[i].outlier) {
      at.J_data.row(row).setZero();
      at.data[row] = 0.0;
    }
    const int shape = problem.observes_plant() ? 12 : 6;
    row += 1 + (target.damping ? 1 : 0) + (target.shape ? shape : 0);
  }
}

void describe_parameters(const Problem& problem, const Solution& solution, Linearised& at,
                         Candidate& candidate) {
  std::vector<ParameterColumn> columns;
  for (int j = 0; j < problem.size(); ++j) {
    const auto& variable = problem.variables()[static_cast<std::size_t>(j)];
    const double value = variable.value(solution.x[j]);
    columns.push_back({variable.paths.front(), variable.unit, value, size_of(variable, value)});
  }
  const auto outliers = std::count_if(candidate.targets.begin(), candidate.targets.end(),
                                      [](const FittedTarget& t) { return t.outlier; });
  const int degrees = static_cast<int>(at.values - outliers) - numerical_rank(at.J_data);
  double half_width = numerics::normal_half_width;
  if (degrees > 0) {
    candidate.scatter = std::sqrt(at.data.squaredNorm() / degrees);
    if (problem.targets().deviations_given) {
      candidate.scatter = std::max(1.0, candidate.scatter);
    } else {
      half_width = numerics::student_half_width(degrees);
    }
  }
  // a perfect fit says little about how exact the data are
  constexpr double least = 1e-6;
  candidate.scatter = std::max(candidate.scatter, least);
  candidate.identifiability = identify_parameters(at.J_data, columns, candidate.scatter);
  const auto joint = joint_deviations(at, candidate.scatter);
  candidate.parameters.clear();
  for (int j = 0; j < problem.size(); ++j)
    candidate.parameters.push_back(fitted(problem.variables()[static_cast<std::size_t>(j)],
                                          solution.x[j], candidate.identifiability.deviations[j],
                                          joint[j], half_width));
}

const Solution* best_of(const std::vector<Solution>& solutions) {
  const Solution* best = nullptr;
  for (const auto& solution : solutions)
    if (solution.usable && (best == nullptr || solution.cost < best->cost)) best = &solution;
  return best;
}

/// Fills in the candidate from one solution.
void describe(const Problem& problem, const Solution& solution, Candidate& candidate) {
  auto linearised = linearise(problem, solution.x);
  candidate.fitted = linearised.has_value();
  if (!candidate.fitted) {
    candidate.problem = "the machine cannot be observed at the fitted values";
    return;
  }
  auto& at = *linearised;
  candidate.converged = solution.converged;
  describe_targets(problem, at.state, candidate);
  describe_responses(problem, at.state, candidate);
  drop_outliers(candidate, problem, at);
  candidate.misfit = at.data.squaredNorm();
  candidate.violated = violations(at.state.machine);
  describe_parameters(problem, solution, at, candidate);
}

/// What data and priors leave open ends wherever the search began at random. Such a parameter goes
/// back to its start, the value of the file, where that leaves the fit as good as it is. Whether
/// any did.
bool take_back(const Problem& problem, const Candidate& candidate, const SolverOptions& options,
               Solution& solution) {
  constexpr double unnoticed = 0.01;  // of a squared deviation
  const double limit = solution.cost + 0.5 * unnoticed * std::pow(candidate.scatter, 2);
  const Eigen::VectorXd start = problem.start();
  bool any = false;
  for (int j = 0; j < problem.size(); ++j) {
    const auto& p = candidate.parameters[static_cast<std::size_t>(j)];
    const double size = size_of(problem.variables()[static_cast<std::size_t>(j)], p.value);
    if (p.deviation <= free_above * size || solution.x[j] == start[j]) continue;
    Eigen::VectorXd x = solution.x;
    x[j] = start[j];
    const auto back = evaluated(problem, x, options);
    if (!back.usable || back.cost > limit) continue;
    solution.x = x;
    any = true;
  }
  return any;
}

/// Fills in the candidate from one solution, with what it does not determine as it was.
void describe_determined(const Problem& problem, Solution solution, const SolverOptions& options,
                         Candidate& candidate) {
  describe(problem, solution, candidate);
  if (!candidate.fitted || !take_back(problem, candidate, options, solution)) return;
  auto back = candidate;
  describe(problem, solution, back);
  if (back.fitted) candidate = std::move(back);
}

/// Parameters that look determined, but have another value in a solution that is as good.
void find_other_values(Combination& combination, const Solution& best) {
  auto& candidate = combination.candidate;
  const auto& variables = combination.problem->variables();
  const double as_good = 0.5 * numerics::chi_squared_quantile(0.95, 1);  // of ½ χ²
  constexpr double apart = 3.0;                                          // half intervals
  constexpr double tolerance = 1e-6;  // of the search, where the fit is perfect
  const double limit = best.cost + as_good * std::pow(candidate.scatter, 2) + tolerance;
  for (const auto& other : combination.solutions) {
    if (!other.usable || other.cost > limit) continue;
    for (std::size_t j = 0; j < candidate.parameters.size(); ++j) {
      auto& p = candidate.parameters[j];
      const double value = variables[j].value(other.x[static_cast<Eigen::Index>(j)]);
      const double reach = apart * std::max(p.interval_high - p.value,
                                            value < p.value ? p.value - p.interval_low : 0);
      constexpr double rounding = 1e-4;
      if (p.verdict != Verdict::determined ||
          std::abs(value - p.value) <= std::max(reach, rounding * std::abs(p.value)))
        continue;
      p.verdict = Verdict::ambiguous;
      p.other_value = value;
    }
  }
}

}  // namespace

Eigen::VectorXd start_of(const Problem& problem, std::uint64_t seed, int number) {
  Eigen::VectorXd x = problem.start();
  if (number == 0) return x;
  std::mt19937_64 generator(seed * 1000003 + static_cast<std::uint64_t>(number));
  const double reach = std::log(5.0);
  for (int j = 0; j < problem.size(); ++j) {
    const auto& variable = problem.variables()[static_cast<std::size_t>(j)];
    double low = variable.x_lower(), high = variable.x_upper();
    if (variable.sign != 0) {
      low = std::max(low, x[j] - reach);
      high = std::min(high, x[j] + reach);
    }
    x[j] = low + (high - low) * uniform(generator);
  }
  return x;
}

void conclude(Combination& combination) {
  auto& candidate = combination.candidate;
  const auto* best = best_of(combination.solutions);
  // an interrupted search leaves starts that were never tried
  candidate.starts = static_cast<int>(
      std::count_if(combination.solutions.begin(), combination.solutions.end(),
                    [](const Solution& solution) { return solution.x.size() > 0; }));
  if (best == nullptr) {
    if (candidate.starts == 0)
      candidate.problem = "interrupted before its first fit";
    else if (has_amplitudes(combination.problem->targets()))
      candidate.problem =
          "with none of the starting values the machine has modes, and balances at the amplitudes "
          "of the targets; `hydrapod modes --amplitude` shows where these end";
    else
      candidate.problem = "the machine has no modes with any of the starting values";
    return;
  }
  constexpr double same = 0.01;
  for (const auto& other : combination.solutions)
    candidate.starts_that_agree += other.usable && other.cost <= best->cost * (1.0 + same) + 1e-9;
  describe_determined(*combination.problem, *best, {}, candidate);
  if (!candidate.fitted) return;
  find_other_values(combination, *best);
}

model::MachineFile file_with_choices(const model::MachineFile& file, const Candidate& candidate) {
  if (candidate.overrides.empty()) return file;
  auto overrides = file.overrides;
  overrides.insert(overrides.end(), candidate.overrides.begin(), candidate.overrides.end());
  return model::parse_machine(file.text, "machine file", overrides, {});
}

bool fits_poorly(const Candidate& candidate) {
  constexpr double poor = 3.0;
  return candidate.fitted &&
         candidate.misfit > poor * poor * static_cast<double>(candidate.targets.size());
}

bool conclude_robust(Combination& combination, const FitOptions& options, bool force,
                     const std::function<bool()>& stop) {
  if (!combination.candidate.fitted) return false;
  const Problem& problem = *combination.problem;
  Solution best;
  for (const auto& from : combination.solutions) {
    if (!from.usable) continue;
    const auto tried = solve(
        problem, from.x, {.max_iterations = options.max_iterations, .cauchy = true, .stop = stop});
    if (tried.usable && (!best.usable || tried.cost < best.cost)) best = tried;
  }
  if (!best.usable) return false;
  Candidate robust = combination.candidate;
  robust.robust = true;
  robust.scatter = 1.0;
  describe_determined(problem, best, {.cauchy = true}, robust);
  const auto count = static_cast<long>(robust.targets.size());
  const auto far = std::count_if(robust.targets.begin(), robust.targets.end(),
                                 [](const FittedTarget& t) { return t.outlier; });
  const bool shows = far >= 1 && 4 * far <= count && !fits_poorly(robust);
  if (!shows && !force) return false;
  combination.candidate = std::move(robust);
  return shows;
}

void conclude_unbound(Combination& combination, const FitOptions& options,
                      const std::function<bool()>& stop) {
  const auto& held = *combination.problem;
  const auto variables = unbound(held.variables());
  const Problem problem(held.machine(), held.targets(), variables, held.kind(),
                        {.hold_to_physics = false});
  const auto* bounded = best_of(combination.solutions);
  if (bounded == nullptr) return;
  Solution best;
  for (const auto& from : combination.solutions) {
    if (!from.usable || stop()) continue;
    Eigen::VectorXd x(from.x.size());
    for (Eigen::Index j = 0; j < x.size(); ++j)
      x[j] = variables[static_cast<std::size_t>(j)].x(
          held.variables()[static_cast<std::size_t>(j)].value(from.x[j]));
    const auto solution =
        solve(problem, x, {.max_iterations = options.max_iterations, .stop = stop});
    if (solution.usable && (!best.usable || solution.cost < best.cost)) best = solution;
  }
  if (!best.usable) return;
  const auto at = linearise(problem, best.x);
  if (!at) return;
  Candidate described;
  describe_targets(problem, at->state, described);
  combination.candidate.unbound = Candidate::Unbound{
      at->data.squaredNorm(), described.worst, violations(at->state.machine), at->state.values};
}

}  // namespace hydrapod::calibration
