/// The electric drives of all legs.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "drives.hpp"
#include "hydrapod/base/error.hpp"
#include "plant_work.hpp"

namespace hydrapod::simulation {

namespace {

/// Integral time times bandwidth: both poles of a free rotor are then at half the bandwidth.
constexpr double speed_integral_ratio = 4.0;

[[noreturn]] void refuse_without(const char* key, const char* what) {
  base::refuse(key, fmt::format("is missing, and a drive is simulated up to the {} of its motor; "
                                "expected this key, or locked motors (--actuators springs) or "
                                "free motors (modes --open-loop)",
                                what));
}

}  // namespace

SpeedLoop speed_loop(const model::Screw& screw) {
  const double bandwidth = screw.speed_bandwidth * base::two_pi;
  return {.bandwidth = bandwidth,
          .gain = bandwidth * screw.inertia,
          .integral_time = screw.speed_integral_time.value_or(speed_integral_ratio / bandwidth)};
}

double Drive::torque(double command, double rate, double integral) const {
  const double wanted = std::clamp(command, -1.0, 1.0) * speed_limit;
  return std::clamp(gain * (wanted - ratio * rate) + integral, -torque_limit, torque_limit);
}

double Drive::friction(double rate) const {
  return viscous * ratio * rate + coulomb * std::tanh(rate / smoothing);
}

Drive drive_of(const model::Leg& leg) {
  const auto& screw = leg.screw.value();
  if (!screw.torque_limit) refuse_without("legs.screw.torque_limit", "largest torque");
  if (!screw.speed_limit) refuse_without("legs.screw.speed_limit", "largest speed");
  const auto loop = speed_loop(screw);
  return {.ratio = screw.ratio(),
          .mass = screw.reflected_mass(),
          .viscous = screw.viscous_friction,
          .coulomb = screw.friction_torque,
          .smoothing = leg.hydraulics.friction.smoothing_velocity,
          .torque_limit = *screw.torque_limit,
          .speed_limit = *screw.speed_limit,
          .gain = loop.gain,
          .integral_rate = 1.0 / loop.integral_time};
}

void Plant::set_drives() {
  auto drives = std::make_shared<Drives>();
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine_.legs[i];
    auto& drive = drives->legs[i] = drive_of(leg);
    if (options_.friction != Friction::all) drive.coulomb = 0.0;
    if (options_.friction == Friction::none) drive.viscous = 0.0;
    if (!options_.speed_loops) drive.gain = drive.integral_rate = 0.0;
    const auto axial = hydraulics::axial_spring(leg, 0.0);
    springs_[i].stiffness = axial.stiffness;
    springs_[i].damping = axial.damping + machine_.damping.rayleigh_stiffness * axial.stiffness;
  }
  drives_ = std::move(drives);
}

/// Stretch of a leg's spring [m], s_n + F_0/k_j − s.
double Plant::screw_stretch(int i, double nut, double s) const {
  const auto& gimbals = gimbals_[static_cast<std::size_t>(i)];
  return nut + gimbals.compliance * gimbals.force - s;
}

/// Evaluates the drives and writes their rates; the axial forces on the pistons go into `axial`.
void Plant::drives_side(const double* x, const PlantInput& input, double* rate, Vector6& axial,
                        Work& work) const {
  for (int i = 0; i < model::leg_count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto& drive = drives_->legs[at];
    const auto& spring = springs_[at];
    const auto& motion = work.motion.legs[at];
    const double nut = x[layout_.nut(i)], nut_rate = x[layout_.nut(i) + 1];
    const double integral = x[layout_.nut(i) + 2];
    const double elastic = spring.stiffness * screw_stretch(i, nut, motion.s);
    auto& out = work.legs[at];
    out.nut = nut;
    out.motor_speed = drive.ratio * nut_rate;
    out.torque = drive.torque(input.command[i], nut_rate, integral);
    out.oil_force = elastic + spring.damping * (nut_rate - motion.s_rate);
    const double compliance = gimbals_[at].compliance;
    out.piston = motion.s + compliance * (elastic - gimbals_[at].force);
    out.piston_rate = motion.s_rate + compliance * spring.stiffness * (nut_rate - motion.s_rate);
    out.stop_force = hydraulics::stop_force(axes_[at].stops, motion.s, motion.s_rate);
    axial[i] = out.oil_force + out.stop_force;
    const double driving = drive.ratio * (out.torque - drive.friction(nut_rate));
    rate[layout_.nut(i)] = nut_rate;
    rate[layout_.nut(i) + 1] =
        (driving - out.oil_force) / drive.mass - machine_.damping.rayleigh_mass * nut_rate;
    rate[layout_.nut(i) + 2] = drive.integral_rate * (out.torque - integral);
  }
}

/// Energies and powers of motors and screws.
void Plant::drives_outputs(const double* x, const Work& work, PlantOutput& out) const {
  for (int i = 0; i < model::leg_count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto& drive = drives_->legs[at];
    const auto& spring = springs_[at];
    const auto& leg = work.legs[at];
    const auto& motion = work.motion.legs[at];
    const double nut_rate = x[layout_.nut(i) + 1], slip = nut_rate - motion.s_rate;
    const double stretch = screw_stretch(i, leg.nut, motion.s);
    out.oil_spring_energy += 0.5 * spring.stiffness * stretch * stretch;
    out.motor_energy += 0.5 * drive.mass * nut_rate * nut_rate;
    out.motor_power += leg.torque * leg.motor_speed;
    out.dissipation += spring.damping * slip * slip + drive.friction(nut_rate) * leg.motor_speed;
  }
}

/// Nuts and torques that hold the legs, into `rest`; motors stand still at the command 0.
void Plant::hold_by_drives(const dynamics::StaticEquilibrium& statics, const dynamics::Motion& now,
                           Rest& rest) const {
  for (int i = 0; i < model::leg_count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto& drive = drives_->legs[at];
    const double force = 0.0 - statics.legs[at].oil_force, torque = force / drive.ratio;
    if (std::abs(torque) > drive.torque_limit)
      throw base::ComputationError(fmt::format(
          "leg {}: the motor needs {:.4g} N m to hold the load at this pose, and "
          "legs.screw.torque_limit is {:.4g} N m; expected a larger motor, a smaller lead or less "
          "mass",
          i + 1, std::abs(torque), drive.torque_limit));
    rest.x[layout_.nut(i)] = force / springs_[at].stiffness - screw_stretch(i, 0.0, now.legs[at].s);
    rest.x[layout_.nut(i) + 2] = torque;
  }
}

Vector6 Plant::motor_torques(const double* x, const Vector6& command) const {
  Vector6 torques = Vector6::Zero();
  for (int i = 0; i < model::leg_count && layout_.nuts >= 0; ++i)
    torques[i] = drives_->legs[static_cast<std::size_t>(i)].torque(
        command[i], x[layout_.nut(i) + 1], x[layout_.nut(i) + 2]);
  return torques;
}

}  // namespace hydrapod::simulation
