#pragma once
/// What a machine can do from rest at a pose, direction by direction, and which limit ends it.
///
/// J is the legs' Jacobian about the mass centre C, M the inertia of the rigid model there, f_0 the
/// oil forces at rest, e a unit motion along or about one axis of the base. Oil pushes with at most
/// F_push, the cap side at supply pressure and the rod side at return pressure, and pulls with at
/// most F_pull; as a column the leg bears P (dynamics::column_strength). For each direction and
/// sign the largest λ such that every leg stays within its limits:
///
///     force         f_0 + J⁻ᵀ e λ            between −F_pull and min(F_push, P)
///     acceleration  f_0 + J⁻ᵀ M e λ          the same: from rest, before oil flows
///     velocity      J e λ                    between the speeds with the valve open one way and
///                                            the other under f_0 and the seals' friction; flow of
///                                            the pump, held for long
///     jerk          J⁻ᵀ M e λ                between the rates of the oil's force with the valve
///                                            wholly open, from the pressures at rest
///     excursion     pose moved by λ          strokes, joint limits, singular poses
///
/// Forces are those on the surroundings, held at the pose. The spool's own time, seals that give
/// way and Coulomb friction of a platform that breaks away are not in these limits.
///
/// Combined: the share of the limits that is there in all six directions at once, whatever their
/// signs.
///
/// Loop gain: the machine's position loop without integral and damping feedback begins to grow at a
/// gain near 2 ζ_j ω_j of the least damped mode of the oil (Merritt, Hydraulic Control Systems,
/// 1967, ch. 8), ζ_j being that of valves, leakage and friction. Here it is the gain at which a
/// pole of the linear loop (linear_system.hpp), its delay and compensation included, reaches the
/// imaginary axis.

#include <array>
#include <optional>
#include <vector>

#include "hydrapod/dynamics/statics.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::simulation {

enum class Ability { force, velocity, acceleration, jerk, excursion };
inline constexpr int ability_count = 5;
/// "force", ….
const char* name(Ability ability);

enum class Limit {
  push,            ///< oil force of a leg
  pull,            ///< the same
  column,          ///< a rod buckles
  extending,       ///< valve of a leg wholly open
  retracting,      ///< the same
  pump,            ///< flow of the pump
  stroke_out,      ///< a piston reaches the end of its stroke
  stroke_in,       ///< the same
  base_joint,      ///< tilt of a leg's joint
  platform_joint,  ///< the same
  singular,        ///< the legs do not hold the platform
  range,           ///< none as far as was looked: half a turn, four times the size of the machine
  torque,          ///< of the motor of an electric cylinder
  motor_speed      ///< the same
};
inline constexpr int limit_count = 14;
/// "push", …; one word of the JSON each.
const char* name(Limit limit);

/// How far it goes, and what ends it.
struct Reach {
  double value{};  ///< N, N m, m/s, rad/s, m/s², rad/s², m/s³, rad/s³, m, rad; 0 or more
  Limit limit{};
  int leg{-1};  ///< 0…5; −1: of no single leg
};

/// What one leg can do at the pose.
struct LegAbility {
  double force{};         ///< f_0 [N], of oil or screw on the piston, + pushes the leg out
  double push{}, pull{};  ///< F_push, F_pull [N]
  std::optional<dynamics::ColumnStrength> column{};
  double extending{}, retracting{};          ///< speeds [m/s]
  double force_rate_out{}, force_rate_in{};  ///< of the oil [N/s]
};

struct Capability {
  std::array<LegAbility, model::leg_count> legs{};
  /// By Ability, direction x…rz and sign: 0 along the axis, 1 against it.
  std::array<std::array<std::array<Reach, 2>, 6>, ability_count> reach{};
  std::array<double, ability_count - 1> combined{};  ///< of all but the excursion
  [[nodiscard]] const Reach& of(Ability ability, int direction, int sign) const {
    return reach.at(static_cast<std::size_t>(ability))
        .at(static_cast<std::size_t>(direction))
        .at(static_cast<std::size_t>(sign));
  }
  /// [1/s]; none: no mode of the oil oscillates, or the pistons stand beyond assumed stops.
  std::optional<double> gain_limit{};
};

/// Of the model `kind` at the pose. Nothing where the machine does not stand there: no equilibrium,
/// a supply that cannot hold the load, a rod that buckles. Without `with_gain` it has no gain
/// limit, which takes most of the time. Of electric cylinders none where a motor has no torque
/// limit or no speed limit; their jerk is infinite. Throws base::InputError for struts.
std::optional<Capability> capability(const model::Machine& machine, const spatial::Pose& X_BP,
                                     dynamics::ModelKind kind, bool with_gain = true);

/// Steady speed [m/s] of a piston with the valve wholly open, + extending, while the oil pushes
/// with `force` [N] and carries the seals' friction.
double open_valve_speed(const hydraulics::ServoAxis& axis, const model::Supply& supply,
                        double force, bool extending);

}  // namespace hydrapod::simulation
