#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"

namespace hydrapod::simulation {

namespace {

/// The equilibrium is there, and its K is not positive definite: legs that buckle, or oil springs
/// that do not hold the load. Elastomers relax while the platform moves away.
bool is_at_unstable_rest(const model::Machine& machine, const Pose& X_BP, ModelKind kind) {
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  return Eigen::LLT<dynamics::ModelMatrix>(dynamics::slow_stiffness(model)).info() !=
         Eigen::Success;
}

/// "x=3 mm, ry=0.5 deg".
std::string displacement_text(const spatial::Vector6& value) {
  constexpr double degrees = 180.0 / std::numbers::pi, smallest = 1e-6;
  std::vector<std::string> parts;
  for (int d = 0; d < 6; ++d)
    if (std::abs(value[d]) > smallest)
      parts.push_back(fmt::format("{}={:.3g} {}", spatial::direction_names.at(d),
                                  value[d] * (d < 3 ? 1e3 : degrees), d < 3 ? "mm" : "deg"));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

std::string instability(const model::Machine& machine, const Pose& X_BP, ModelKind kind,
                        bool controlled, const control::ControllerParameters* controller) {
  SystemPoles poles;
  if (controlled) {
    poles = system_poles(linear_system(machine, X_BP, {.kind = kind, .controller = controller}));
    if (poles.sampled_stable) return {};
  }
  if (is_at_unstable_rest(machine, X_BP, kind))
    return "the machine does not stay at its pose: the static equilibrium is unstable under the "
           "present load; `hydrapod check` states the cause, and the load that the legs carry";
  if (!controlled) return {};
  const auto s = poles.sampled.front();
  if (!(s.imag() > 0.0))
    return "the closed loop is unstable: the machine does not stay at its pose";
  return fmt::format(
      "the closed loop is unstable: it oscillates at {:.3g} Hz with {:.2g} % damping without "
      "excitation, and a record shows this oscillation; a smaller controller.bandwidth or another "
      "feedback may help",
      std::abs(s) / base::two_pi, -100.0 * s.real() / std::abs(s));
}

std::string instability(const ClosedLoop& loop) {
  return instability(loop.plant().machine(), loop.operating(), loop.options().kind,
                     loop.options().actuators == Actuators::controlled, &loop.parameters());
}

std::string loss_of_rest(const ClosedLoop& loop, signals::Generator& signal, double until,
                         const KeepGoing& keep_going) {
  const auto& machine = loop.plant().machine();
  const auto kind = loop.options().kind;
  if (kind == ModelKind::rigid || machine.gravity.isZero(0.0)) return {};
  const auto falls = [&](const Pose& X_BP, bool controlled) {
    try {
      return !instability(machine, X_BP, kind, controlled, &loop.parameters()).empty();
    } catch (const base::ComputationError&) {  // no equilibrium at all
      return true;
    }
  };
  constexpr double interval = 0.01;  // [s] between two looks, longer where they would be too many
  constexpr long most_looks = 500;
  const double T = loop.parameters().sample_time;
  const long samples = std::lround(until / T),
             every = std::max({1L, std::lround(interval / T), samples / most_looks});
  std::string found;
  signal.restart();
  for (long k = 0; k <= samples && found.empty(); ++k) {
    const auto command = signal.next();
    if (k % every != 0) continue;
    if (keep_going && !keep_going(static_cast<double>(k) * T)) break;
    if (command.value.isZero(0.0)) continue;
    const auto X_BP = command_at(loop.operating(), command).X_BP;
    if (falls(X_BP, false) && falls(X_BP, true))
      found = fmt::format(
          "at {:.3g} s the command is {}, where the legs buckle: a platform that follows it "
          "does not stay there; `hydrapod check` of that pose states the load that "
          "the legs carry",
          static_cast<double>(k) * T, displacement_text(command.value));
  }
  signal.restart();
  return found;
}

}  // namespace hydrapod::simulation
