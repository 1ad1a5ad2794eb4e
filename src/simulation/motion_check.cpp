#include "hydrapod/simulation/closed_loop.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::simulation {

namespace {

constexpr double degrees = 180.0 / std::numbers::pi;
constexpr double quality_interval = 0.01;  // [s] between two looks at conditioning

/// The largest excess of its kind so far.
struct Worst {
  double excess{};
  double time{};
  double value{};
  void see(double new_excess, double new_time, double new_value) {
    if (new_excess > excess) *this = {new_excess, new_time, new_value};
  }
};

struct LegFindings {
  Worst low{}, high{};              ///< stroke [m]
  Worst base{}, platform{};         ///< joint tilt [rad]
  Worst extending{}, retracting{};  ///< speed over what the valve gives [m/s]
};

class MotionCheck {
 public:
  MotionCheck(const Plant& plant, const control::ControllerParameters& parameters)
      : plant_(plant), machine_(plant.machine()) {
    for (size_t i = 0; i < model::leg_count; ++i)
      speeds_[i] = control::full_drive_speeds(parameters.axes[i], parameters.axes[i].load);
    has_joint_limits_ = kinematics::has_joint_limits(machine_);
  }

  void see(double time, const control::Command& command) {
    const auto legs = kinematics::inverse_kinematics(machine_, command.X_BP);
    const spatial::Matrix6 J = kinematics::leg_jacobian(legs, command.X_BP.p_BP);
    see_side(time, J.determinant());
    const Vector6 rates = J * command.velocity;
    for (int i = 0; i < model::leg_count; ++i) {
      auto& found = legs_[static_cast<size_t>(i)];
      const auto& stops = plant_.axis(i).stops;
      const double s =
          legs[static_cast<size_t>(i)].length - machine_.legs[static_cast<size_t>(i)].rod.length;
      found.low.see(stops.low - s, time, s);
      found.high.see(s - stops.high, time, s);
      const auto& speed = speeds_[static_cast<size_t>(i)];
      found.extending.see(rates[i] - speed.extending, time, rates[i]);
      found.retracting.see(-rates[i] - speed.retracting, time, -rates[i]);
    }
    if (has_joint_limits_) see_joints(time, command.X_BP);
  }

  void see_quality(double time, const Pose& X_BP) {
    const double condition = kinematics::pose_condition(machine_, X_BP);
    singular_.see(condition - kinematics::singular_condition, time, condition);
  }

  [[nodiscard]] std::vector<MotionFinding> findings() {
    for (size_t i = 0; i < model::leg_count; ++i) report_leg(static_cast<int>(i));
    if (singular_.excess > 0.0)
      add(base::Severity::error,
          fmt::format("the commanded motion passes a singular pose at {:.4g} s: condition of the "
                      "Jacobian {:.2g}, accepted below {:.0g}",
                      singular_.time, singular_.value, kinematics::singular_condition));
    else if (passed_at_)
      add(base::Severity::error,
          fmt::format("the commanded motion passes a singular pose at {:.4g} s: the determinant of "
                      "the Jacobian changes its sign",
                      *passed_at_));
    return std::move(findings_);
  }

 private:
  /// A motion may be past a singular pose from one sample to the next.
  void see_side(double time, double determinant) {
    if (side_ * determinant < 0.0 && !passed_at_) passed_at_ = time;
    side_ = determinant;
  }

  void see_joints(double time, const Pose& X_BP) {
    const auto angles = kinematics::joint_angles(machine_, X_BP);
    for (size_t i = 0; i < model::leg_count; ++i) {
      const auto& limits = machine_.legs[i].joint_limits;
      const auto see = [&](Worst& worst, const std::optional<double>& limit, double tilt) {
        if (limit) worst.see(tilt - *limit, time, tilt);
      };
      see(legs_[i].base, limits.base, angles[i].base_tilt);
      see(legs_[i].platform, limits.platform, angles[i].platform_tilt);
    }
  }

  void add(base::Severity severity, std::string message) {
    findings_.push_back({severity, std::move(message)});
  }

  void report_leg(int i) {
    const auto& leg = legs_[static_cast<size_t>(i)];
    const auto& stops = plant_.axis(i).stops;
    const auto stroke = [&](const Worst& worst, const char* side) {
      if (worst.excess <= 0.0) return;
      add(base::Severity::error,
          fmt::format("leg {} needs {:.3g} mm more stroke than it has {} at {:.4g} s: piston at "
                      "{:.4g} m from its base joint, stroke {:.4g} m to {:.4g} m",
                      i + 1, 1e3 * worst.excess, side, worst.time, worst.value, stops.low,
                      stops.high));
    };
    stroke(leg.low, "retracting");
    stroke(leg.high, "extending");
    const auto joint = [&](const Worst& worst, const char* name) {
      if (worst.excess <= 0.0) return;
      add(base::Severity::error,
          fmt::format("the {} joint of leg {} must tilt {:.3g}° at {:.4g} s, {:.2g}° beyond its "
                      "limit",
                      name, i + 1, degrees * worst.value, worst.time, degrees * worst.excess));
    };
    joint(leg.base, "base");
    joint(leg.platform, "platform");
    const bool drives = plant_.layout().nuts >= 0;
    const auto speed = [&](const Worst& worst, const char* verb) {
      if (worst.excess <= 0.0) return;
      add(base::Severity::warning,
          fmt::format("leg {} must {} at {:.3g} m/s at {:.4g} s, its {} gives {:.3g} m/s{}", i + 1,
                      verb, worst.value, worst.time, drives ? "motor" : "valve",
                      worst.value - worst.excess, drives ? "" : " under the load at rest"));
    };
    speed(leg.extending, "extend");
    speed(leg.retracting, "retract");
  }

  const Plant& plant_;
  const model::Machine& machine_;
  std::array<control::AxisSpeeds, model::leg_count> speeds_{};
  bool has_joint_limits_{};
  std::array<LegFindings, model::leg_count> legs_{};
  Worst singular_{};
  double side_{};  ///< determinant of the last Jacobian
  std::optional<double> passed_at_{};
  std::vector<MotionFinding> findings_{};
};

}  // namespace

std::vector<MotionFinding> check_motion(const Plant& plant,
                                        const control::ControllerParameters& parameters,
                                        const Pose& operating, signals::Generator& signal,
                                        double until, const KeepGoing& keep_going) {
  MotionCheck check(plant, parameters);
  const double T = parameters.sample_time;
  const long samples = static_cast<long>(std::floor(until / T + 1e-6));
  const long interval = std::max(1L, std::lround(quality_interval / T));
  signal.restart();
  for (long k = 0; k <= samples; ++k) {
    const double time = T * static_cast<double>(k);
    const auto command = command_at(operating, signal.next());
    check.see(time, command);
    if (k % interval != 0) continue;
    check.see_quality(time, command.X_BP);
    if (keep_going && !keep_going(time)) break;
  }
  signal.restart();
  return check.findings();
}

std::string leaves_workspace(const model::Machine& machine, const Pose& X_BP) {
  if (kinematics::is_singular(machine, X_BP))
    return fmt::format("the platform has reached a singular pose: condition of the Jacobian {:.2g}",
                       kinematics::pose_quality(machine, X_BP).condition);
  if (!kinematics::has_joint_limits(machine)) return {};
  const auto angles = kinematics::joint_angles(machine, X_BP);
  for (size_t i = 0; i < model::leg_count; ++i) {
    const auto& limits = machine.legs[i].joint_limits;
    const auto beyond = [&](const std::optional<double>& limit, double tilt, const char* name) {
      if (!limit || tilt <= *limit) return std::string{};
      return fmt::format("the {} joint of leg {} is tilted {:.3g}°, beyond its limit of {:.3g}°",
                         name, i + 1, degrees * tilt, degrees * *limit);
    };
    const auto base = beyond(limits.base, angles[i].base_tilt, "base");
    if (!base.empty()) return base;
    const auto platform = beyond(limits.platform, angles[i].platform_tilt, "platform");
    if (!platform.empty()) return platform;
  }
  return {};
}

}  // namespace hydrapod::simulation
