#include "stiffness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/dense.hpp"

namespace hydrapod::simulation {

namespace {

// Oil of machines is at 100 to 10,000 rad/s and valves are below 10,000 rad/s: a state fifty times
// faster is a wrong number in the file. It passes all the same where the run is short: a step takes
// 10 to 20 µs, so that 300,000 are three to six seconds.
constexpr double shortest_step = 2e-6;  // [s]
constexpr double most_steps_of_run = 3e5;

struct Fastest {
  double rate{};  ///< 1/step [1/s]
  std::string state{};
};

/// What is left of the change of the state for a method that has the spools in closed form. Nothing
/// acts on them, so that the other poles stay.
void take_out_spools(const Plant& plant, Eigen::MatrixXd& A) {
  if (plant.layout().spools < 0) return;
  const int first = plant.layout().spools - 1;  // the rotation has three numbers here
  A.middleRows(first, 2 * model::leg_count).setZero();
  A.middleCols(first, 2 * model::leg_count).setZero();
}

/// By the poles of the plant with this change of the state.
Fastest fastest_of(const Plant& plant, const Eigen::MatrixXd& A) {
  Eigen::VectorXd scales(A.rows());  // those of the rotation's four numbers are alike
  scales << plant.scales().head(3), plant.scales().tail(A.rows() - 3);
  const auto poles =
      numerics::eigen_pairs(scales.cwiseInverse().asDiagonal() * A * scales.asDiagonal());
  // The method's region of stability reaches to −3.3 along the real axis, and to ±1 i.
  constexpr double real_reach = 3.3;
  Fastest fastest;
  for (Eigen::Index k = 0; k < poles.values.size(); ++k) {
    const auto pole = poles.values[k];
    const double rate = std::max(std::abs(pole.imag()), -pole.real() / real_reach);
    if (!(rate > fastest.rate)) continue;
    Eigen::Index most = 0;
    poles.vectors.col(k).cwiseAbs().maxCoeff(&most);
    fastest = {rate, plant.tangent_names()[static_cast<std::size_t>(most)]};
  }
  return fastest;
}

/// Steps that are fixed have to be short enough for the waves in lines: else the run would end with
/// numbers that are not finite.
void require_short_steps(const Plant& plant, const Plant::Rest& rest, double step) {
  constexpr double most = 0.8;  // of a radian: waves keep their size
  Eigen::MatrixXd A = plant.linearise(rest.x, rest.input).A;
  take_out_spools(plant, A);
  const auto fastest = fastest_of(plant, A);
  if (step * fastest.rate <= most) return;
  throw base::ComputationError(fmt::format(
      "fixed steps of {:.3g} s are too long for a state that changes at {:.2g} 1/s (fastest: {}); "
      "expected at most {:.2g} s, another integrator or fewer `lines.{}`",
      step, fastest.rate, fastest.state, most / fastest.rate,
      plant.machine().hydraulics.lines.modes > 0.0 ? "modes" : "segments"));
}

}  // namespace

void require_passable(const Plant& plant, const Plant::Rest& rest, const IntegratorOptions& options,
                      double until) {
  if (options.method == Method::fixed && plant.layout().line_states > 0)
    return require_short_steps(plant, rest, options.fixed_step);
  const bool exponential = options.method == Method::exponential;
  if (options.method != Method::adaptive && options.method != Method::cvode_adams && !exponential)
    return;
  Fastest fastest;
  try {
    Eigen::MatrixXd A = plant.linearise(rest.x, rest.input).A;
    if (exponential) take_out_spools(plant, A);
    fastest = fastest_of(plant, A);
  } catch (const base::ComputationError&) {
    return;  // at the end of what legs can do there are no changes of the state; the run will tell
  }
  const double step = 1.0 / std::max(fastest.rate, 1e-300), steps = until / step;
  if (step >= shortest_step || steps <= most_steps_of_run) return;
  throw base::ComputationError(fmt::format(
      "the machine is too stiff to be simulated: a state that changes at {:.2g} 1/s takes steps of "
      "{:.2g} s, {:.2g} for {:.6g} s; expected are at most {:g} 1/s, or at most {:g} steps: a "
      "slower valve, a smaller bore, larger chambers or heavier parts (fastest: {})",
      fastest.rate, step, steps, until, 1.0 / shortest_step, most_steps_of_run, fastest.state));
}

}  // namespace hydrapod::simulation
