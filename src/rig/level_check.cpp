/// Is there room for the excitation, and does the machine stand still without it? Judged before the
/// run.

#include <fmt/format.h>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/rig/rig.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::rig {

namespace {

constexpr double mm = 1e-3;

struct Peaks {
  Vector6 direction{Vector6::Zero()};  ///< of each signal
  Vector6 leg{Vector6::Zero()};        ///< of all together
  Vector6 leg_rate{Vector6::Zero()};
  Vector6 leg_force{Vector6::Zero()};
};

/// Leg forces per acceleration of the demanded pose: the platform alone, without the legs' masses.
spatial::Matrix6 force_matrix(const model::Machine& machine, const spatial::Pose& pose,
                              const spatial::Matrix6& J) {
  const spatial::Vector3 r = pose.R_BP * machine.platform.mass_center;
  spatial::Matrix6 to_C = spatial::Matrix6::Identity();
  to_C.topRightCorner<3, 3>() = -spatial::skew(r);
  spatial::Matrix6 M = spatial::Matrix6::Zero();
  M.topLeftCorner<3, 3>() = machine.platform.mass * spatial::Matrix3::Identity();
  M.bottomRightCorner<3, 3>() = pose.R_BP * machine.platform.inertia * pose.R_BP.transpose();
  return J.transpose().partialPivLu().solve(to_C.transpose() * M * to_C);
}

double checked_seconds(const RigOptions& options) {
  return std::min(options.settling + options.duration, longest_checked);
}

Peaks peaks_of(const RigOptions& options, double sample_time, const spatial::Matrix6& J,
               const spatial::Matrix6& forces = spatial::Matrix6::Zero()) {
  signals::Generator signals(options.signals, 1.0 / sample_time, options.seed);
  const double seconds = checked_seconds(options);
  Peaks peaks;
  Vector6 last_rate = Vector6::Zero();
  for (long k = 0; k < std::lround(seconds / sample_time); ++k) {
    const signals::Sample sample = signals.next();
    peaks.direction = peaks.direction.cwiseMax(sample.value.cwiseAbs());
    peaks.leg = peaks.leg.cwiseMax((J * sample.value).cwiseAbs());
    peaks.leg_rate = peaks.leg_rate.cwiseMax((J * sample.rate).cwiseAbs());
    const Vector6 acceleration = (sample.rate - last_rate) / sample_time;
    if (k > 0) peaks.leg_force = peaks.leg_force.cwiseMax((forces * acceleration).cwiseAbs());
    last_rate = sample.rate;
  }
  return peaks;
}

/// Stroke left on the nearer side of each leg; infinite for a leg without stops.
Vector6 room_left(const simulation::Plant& plant, const spatial::Pose& pose) {
  const auto legs = kinematics::inverse_kinematics(plant.machine(), pose);
  Vector6 room = Vector6::Constant(std::numeric_limits<double>::infinity());
  for (int k = 0; k < model::leg_count; ++k) {
    const hydraulics::Stops& stops = plant.axis(k).stops;
    if (!(stops.high > stops.low)) continue;
    const auto at = static_cast<std::size_t>(k);
    const double piston = legs[at].length - plant.machine().legs[at].rod.length;
    room[k] = std::min(piston - stops.low, stops.high - piston);
  }
  return room;
}

void judge_strokes(const Peaks& peaks, const spatial::Matrix6& J, const Vector6& room,
                   std::vector<LevelFinding>& findings) {
  bool one_alone = false;
  for (int i = 0; i < 6; ++i) {
    const Vector6 needs = peaks.direction[i] * J.col(i).cwiseAbs();
    Eigen::Index leg = 0;
    if (!((needs - room).maxCoeff(&leg) > 0.0)) continue;
    one_alone = true;
    findings.push_back({base::Severity::error,
                        fmt::format("{} at this level needs {:.3g} mm of stroke in leg {}, {:.3g} "
                                    "mm left",
                                    spatial::direction_name(i), needs[leg] / mm, leg + 1,
                                    std::max(room[leg], 0.0) / mm)});
  }
  Eigen::Index leg = 0;
  if (!one_alone && (peaks.leg - room).maxCoeff(&leg) > 0.0)
    findings.push_back(
        {base::Severity::error,
         fmt::format("all directions together need {:.3g} mm of stroke in leg {}, {:.3g} mm left",
                     peaks.leg[leg] / mm, leg + 1, std::max(room[leg], 0.0) / mm)});
}

void judge_speeds(const Peaks& peaks, const control::ControllerParameters& parameters,
                  std::vector<LevelFinding>& findings) {
  Eigen::Index worst = 0;
  Vector6 available;
  for (int k = 0; k < model::leg_count; ++k) {
    const auto& axis = parameters.axes[static_cast<std::size_t>(k)];
    const auto speeds = control::full_drive_speeds(axis, axis.load);
    available[k] = std::min(speeds.extending, speeds.retracting);
  }
  const bool electric = parameters.axes[0].full_speed > 0.0;
  if ((peaks.leg_rate - available).maxCoeff(&worst) > 0.0)
    findings.push_back(
        {base::Severity::warning,
         fmt::format("this level needs {:.3g} m/s in leg {}, and the {}: the drive will be at its "
                     "limit",
                     peaks.leg_rate[worst], worst + 1,
                     electric ? fmt::format("motor gives {:.3g} m/s", available[worst])
                              : fmt::format("valve gives {:.3g} m/s at the supply's pressure",
                                            available[worst]))});
}

/// What the supply can push and pull at standstill, less the load at rest.
void judge_pressures(const Peaks& peaks, const control::ControllerParameters& parameters,
                     std::vector<LevelFinding>& findings) {
  Vector6 available;
  for (int k = 0; k < model::leg_count; ++k) {
    const auto& axis = parameters.axes[static_cast<std::size_t>(k)];
    const double push =
        axis.supply_pressure * axis.piston_area - axis.return_pressure * axis.annulus_area;
    const double pull =
        axis.supply_pressure * axis.annulus_area - axis.return_pressure * axis.piston_area;
    available[k] = std::min(push - axis.load, pull + axis.load);
  }
  Eigen::Index worst = 0;
  if ((peaks.leg_force - available).maxCoeff(&worst) > 0.0)
    findings.push_back(
        {base::Severity::warning,
         fmt::format("this level needs {:.3g} kN in leg {} for the platform alone, and the supply "
                     "pressure gives {:.3g} kN in addition to the load: the motion will not follow",
                     peaks.leg_force[worst] / 1e3, worst + 1, available[worst] / 1e3)});
}

/// What the motors' torques leave beside the load at rest and friction. `peaks` contains the
/// rotors.
void judge_torques(const Peaks& peaks, const model::Machine& machine,
                   const control::ControllerParameters& parameters,
                   std::vector<LevelFinding>& findings) {
  Vector6 needed, available;
  for (int k = 0; k < model::leg_count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const auto& screw = *machine.legs[at].screw;
    needed[k] = peaks.leg_force[k] / screw.ratio();
    available[k] = *screw.torque_limit - screw.friction_torque -
                   std::abs(parameters.axes[at].load) / screw.ratio();
  }
  Eigen::Index worst = 0;
  if ((needed - available).maxCoeff(&worst) > 0.0)
    findings.push_back(
        {base::Severity::warning,
         fmt::format(
             "this level needs {:.3g} N m of the motor of leg {} for rotor and platform, and "
             "its limit leaves {:.3g} N m in addition to the load: the motion will not follow",
             needed[worst], worst + 1, available[worst])});
}

/// Along the legs, of the rotors that turn with them [kg]; 0 without.
Vector6 rotor_masses(const model::Machine& machine) {
  Vector6 masses = Vector6::Zero();
  for (int k = 0; k < model::leg_count; ++k)
    if (const auto& screw = machine.legs[static_cast<std::size_t>(k)].screw)
      masses[k] = screw->reflected_mass();
  return masses;
}

/// A machine whose legs buckle on the way has no modes that a record could show. Of levels that do
/// not fit anyway nothing is said.
void judge_rest(const simulation::ClosedLoop& loop, const RigOptions& options,
                std::vector<LevelFinding>& findings) {
  const bool fits = std::ranges::none_of(
      findings, [](const auto& one) { return one.severity == base::Severity::error; });
  if (!fits || !simulation::instability(loop).empty()) return;
  signals::Generator signal(options.signals, 1.0 / loop.parameters().sample_time, options.seed);
  auto lost = simulation::loss_of_rest(loop, signal, checked_seconds(options));
  if (!lost.empty()) findings.push_back({base::Severity::warning, std::move(lost)});
}

}  // namespace

std::vector<LevelFinding> check_levels(const simulation::ClosedLoop& loop,
                                       const RigOptions& options) {
  std::vector<LevelFinding> findings;
  // What oscillates by itself is never seen at rest, and its modes are not what a record shows.
  if (auto why = simulation::instability(loop); !why.empty())
    findings.push_back({base::Severity::warning, std::move(why), true});
  if (options.entry == Entry::wrench) return findings;  // what it moves, the run shows
  const spatial::Pose& pose = loop.operating();
  const spatial::Matrix6 J = excitation_jacobian(loop.plant().machine(), pose);
  const double sample_time = loop.parameters().sample_time;
  if (options.entry == Entry::drive) {
    const Peaks peaks = peaks_of(options, sample_time, drive_shares(J));
    Eigen::Index leg = 0;
    if (peaks.leg.maxCoeff(&leg) > 1.0)
      findings.push_back({base::Severity::warning,
                          fmt::format("this level drives leg {} to {:.0f} % of full drive: it will "
                                      "be at its limit",
                                      leg + 1, 100.0 * peaks.leg[leg])});
    return findings;
  }
  const auto& machine = loop.plant().machine();
  const bool screws = model::leg_type(machine) == model::LegType::screw;
  spatial::Matrix6 forces = force_matrix(machine, pose, J);
  if (screws) forces += rotor_masses(machine).asDiagonal() * J;
  const Peaks peaks = peaks_of(options, sample_time, J, forces);
  judge_strokes(peaks, J, room_left(loop.plant(), pose), findings);
  judge_speeds(peaks, loop.parameters(), findings);
  if (screws)
    judge_torques(peaks, machine, loop.parameters(), findings);
  else
    judge_pressures(peaks, loop.parameters(), findings);
  judge_rest(loop, options, findings);
  return findings;
}

}  // namespace hydrapod::rig
