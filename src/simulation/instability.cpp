#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>

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

}  // namespace hydrapod::simulation
