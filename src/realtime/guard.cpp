#include "guard.hpp"

#include <fmt/format.h>

#include <cmath>

#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::realtime {

namespace {
constexpr double corner = 50.0;  // [Hz] of leg speeds and accelerations from lengths
}

Guard::Guard(const model::Machine& machine, const Pose& operating, const Limits& limits,
             double sample_time, std::size_t accelerometers)
    : machine_(machine),
      operating_(operating),
      limits_(limits),
      T_(sample_time),
      accelerometers_(accelerometers),
      rest_(kinematics::leg_lengths(machine, operating)) {
  speed_.assign(6, rig::LowPass::butterworth(2, corner, 1.0 / T_));
  acceleration_ = speed_;
}

std::string Guard::at_pose(const Sensors& sensors) const {
  Eigen::Index leg = 0;
  if (!sensors.length.allFinite()) return "there are no leg lengths among the sensors";
  const double apart = (sensors.length - rest_).cwiseAbs().maxCoeff(&leg);
  if (apart <= limits_.error) return {};
  return fmt::format(
      "leg {} is measured {:.6g} m long, and is {:.6g} m long at the pose: {:.3g} mm apart, "
      "expected at most {:.3g} mm (--limit error)",
      leg + 1, sensors.length[leg], rest_[leg], 1e3 * apart, 1e3 * limits_.error);
}

std::string Guard::commanded(const Vector6& displacement) const {
  const Vector6 wanted = kinematics::leg_lengths(
      machine_, simulation::command_at(operating_, {.value = displacement}).X_BP);
  Eigen::Index leg = 0;
  const double far = (wanted - rest_).cwiseAbs().maxCoeff(&leg);
  if (far <= limits_.length) return {};
  return fmt::format("leg {}: the excitation asks for {:.4g} mm, the limit is {:.4g} mm", leg + 1,
                     1e3 * far, 1e3 * limits_.length);
}

std::string Guard::judge(const Sensors& sensors, const Vector6& displacement) {
  const Vector6 wanted = kinematics::leg_lengths(
      machine_, simulation::command_at(operating_, {.value = displacement}).X_BP);
  std::string found;
  const auto check = [&](int leg, double value, double limit, const char* what, double scale,
                         const char* unit) {
    if (found.empty() && std::abs(value) > limit)
      found = fmt::format("leg {}: {} {:.4g} {}, the limit is {:.4g} {}", leg + 1, what,
                          scale * value, unit, scale * limit, unit);
  };
  for (int leg = 0; leg < 6; ++leg) {
    const double length = sensors.length[leg];
    if (!std::isfinite(length)) continue;  // a drop-out; the watchdog counts those that last
    const auto at = static_cast<std::size_t>(leg);
    const double speed = seen_ > 0 ? speed_[at]((length - last_length_[leg]) / T_) : 0.0;
    const double acceleration =
        seen_ > 1 ? acceleration_[at]((speed - last_speed_[leg]) / T_) : 0.0;
    last_length_[leg] = length;
    last_speed_[leg] = speed;
    check(leg, length - rest_[leg], limits_.length, "is displaced by", 1e3, "mm");
    check(leg, speed, limits_.velocity, "moves at", 1.0, "m/s");
    check(leg, acceleration, limits_.acceleration, "accelerates at", 1.0, "m/s²");
    check(leg, length - wanted[leg], limits_.error, "has a following error of", 1e3, "mm");
  }
  ++seen_;
  for (std::size_t a = 0; a < accelerometers_; ++a)
    if (found.empty() && std::abs(sensors.accelerometer[a]) > limits_.acceleration)
      found = fmt::format("accelerometer {} shows {:.4g} m/s², the limit is {:.4g} m/s²", a + 1,
                          sensors.accelerometer[a], limits_.acceleration);
  return found;
}

std::string Guard::see(const Sensors& sensors, const Vector6& displacement) {
  const std::string found = judge(sensors, displacement);
  const bool twice = passed_ && !found.empty();
  passed_ = !found.empty();
  return twice ? found : std::string{};
}

}  // namespace hydrapod::realtime
