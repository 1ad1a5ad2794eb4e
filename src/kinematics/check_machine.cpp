#include "hydrapod/kinematics/legs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>

namespace hydrapod::kinematics {

namespace {

constexpr double degrees = 180.0 / std::numbers::pi;
using model::Finding;

/// Messages of one pose, filed under its key.
struct Findings {
  std::string key;
  std::vector<Finding> list{};
  void error(std::string message) {
    list.push_back({base::Severity::error, key, std::move(message)});
  }
};

/// The legs of which one thing is wrong, and how far the worst of them is off.
struct Failing {
  std::vector<int> numbers{};
  std::size_t worst{};  ///< place in `numbers`
  double most{};

  void add(int leg, double excess) {
    constexpr double rounding = 1e-9;  // legs that are off alike: the first one
    if (numbers.empty() || excess > (1.0 + rounding) * most) {
      worst = numbers.size();
      most = excess;
    }
    numbers.push_back(leg + 1);
  }
  [[nodiscard]] int index() const { return numbers[worst] - 1; }
  /// "; also leg 5", "; also legs 2 and 5", "; also all other legs".
  [[nodiscard]] std::string others() const {
    std::vector<int> rest = numbers;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(worst));
    if (rest.empty()) return {};
    if (rest.size() + 1 == model::leg_count) return "; also all other legs";
    const int last = rest.back();
    rest.pop_back();
    if (rest.empty()) return fmt::format("; also leg {}", last);
    return fmt::format("; also legs {} and {}", fmt::join(rest, ", "), last);
  }
};

/// Everything about lengths and joints at a pose.
struct LegsAtPose {
  const model::Machine& machine;
  Vector6 length{};
  std::array<JointAngles, model::leg_count> angles{};  ///< known where a joint has a limit

  [[nodiscard]] double piston(int i) const { return length[i] - machine.legs[i].rod.length; }
};

/// What a leg is off by; nothing where it is sound.
template <class Excess>
Failing failing(Excess excess) {
  Failing found;
  for (int i = 0; i < model::leg_count; ++i)
    if (const double much = excess(i); much > 0.0) found.add(i, much);
  return found;
}

/// A leg that is just as long as its rod is too short as well.
double missing_length(const LegsAtPose& at, int i) {
  const double missing = -at.piston(i);
  return missing == 0.0 ? std::numeric_limits<double>::min() : missing;
}

std::string short_leg(const LegsAtPose& at, int i) {
  return fmt::format("leg {} is {:.4g} m long, shorter than its rod of {:.4g} m", i + 1,
                     at.length[i], at.machine.legs[i].rod.length);
}

double beyond_stroke(const LegsAtPose& at, int i) {
  const auto& stroke = at.machine.legs[i].stroke;
  if (!stroke) return 0.0;
  return std::max(stroke->retracted - at.piston(i),
                  at.piston(i) - stroke->retracted - stroke->length);
}

std::string stroke_text(const LegsAtPose& at, int i) {
  const auto& stroke = *at.machine.legs[i].stroke;
  return fmt::format(
      "the piston of leg {} is {:.4g} m from its base joint, {:.3g} m {} its stroke from {:.4g} m "
      "to {:.4g} m",
      i + 1, at.piston(i), beyond_stroke(at, i),
      at.piston(i) < stroke.retracted ? "below" : "beyond", stroke.retracted,
      stroke.retracted + stroke.length);
}

/// Place of the piston of leg i where its rod ends at the platform joint of leg `other`; none where
/// that is out of its stroke.
std::optional<double> piston_at_joint(const model::Machine& machine, const Pose& X_BP, int i,
                                      int other) {
  const auto& leg = machine.legs[static_cast<std::size_t>(i)];
  const Vector3 joint =
      X_BP.R_BP * machine.legs[static_cast<std::size_t>(other)].platform_joint + X_BP.p_BP;
  const double piston = (joint - leg.base_joint).norm() - leg.rod.length;
  const bool reaches = piston > 0.0 && leg.stroke && piston >= leg.stroke->retracted &&
                       piston <= leg.stroke->retracted + leg.stroke->length;
  return reaches ? std::optional(piston) : std::nullopt;
}

/// Where some legs are too long by much, the joints of the platform may be numbered from another
/// leg on, or the other way round than those of the base. The order in which all legs reach, of
/// several that with the shortest legs; empty: there is none.
std::string numbering_advice(const LegsAtPose& at, const Pose& X_BP, const Failing& legs) {
  constexpr double much = 0.25;  // of the stroke
  const auto& stroke = at.machine.legs[static_cast<std::size_t>(legs.index())].stroke;
  if (!stroke || legs.most < much * stroke->length || at.piston(legs.index()) < stroke->retracted)
    return {};
  double shortest = std::numeric_limits<double>::infinity();
  std::vector<int> found;
  for (int k = 1; k < 2 * model::leg_count; ++k) {
    std::vector<int> order;
    double sum = 0.0;
    for (int i = 0; i < model::leg_count && std::ssize(order) == i; ++i) {
      const int other = (k < model::leg_count ? i + k : k - i) % model::leg_count;
      const auto piston = piston_at_joint(at.machine, X_BP, i, other);
      if (!piston) break;
      sum += *piston;
      order.push_back(other + 1);
    }
    if (std::ssize(order) < model::leg_count || sum >= shortest) continue;
    shortest = sum;
    found = order;
  }
  if (found.empty()) return {};
  return fmt::format(
      "; all legs reach where the platform joints are taken in the order {}: are base and platform "
      "numbered alike?",
      fmt::join(found, ", "));
}

/// The smallest number where the sleeve stands at an end of the rod: that is off as well.
double off_rod(const LegsAtPose& at, int i) {
  const auto& leg = at.machine.legs[i];
  const double l_mh = leg.guide_sleeve.position - at.piston(i);
  const double off = std::max(-l_mh, l_mh - leg.rod.length);
  return off == 0.0 ? std::numeric_limits<double>::min() : off;
}

std::string sleeve_text(const LegsAtPose& at, int i) {
  const auto& leg = at.machine.legs[i];
  return fmt::format(
      "the guide sleeve of leg {} stands {:.4g} m from its base joint; it must lie on the rod, "
      "between the piston at {:.4g} m and the platform joint at {:.4g} m",
      i + 1, leg.guide_sleeve.position, at.piston(i), at.length[i]);
}

/// One finding for all legs with the same cause. Where a leg is too short or too long, its sleeve
/// and its joints are off for the same cause.
void check_legs(const model::Machine& machine, const Pose& X_BP, Findings& findings) {
  LegsAtPose at{machine, leg_lengths(machine, X_BP)};
  if (has_joint_limits(machine)) at.angles = joint_angles(machine, X_BP);
  const auto add = [&](const Failing& legs, auto text, const std::string& advice = "") {
    if (legs.numbers.empty()) return false;
    findings.error(text(at, legs.index()) + legs.others() + advice);
    return true;
  };
  const bool too_short = add(failing([&](int i) { return missing_length(at, i); }), short_leg,
                             "; move the platform away from the base or shorten the rod");
  if (too_short) return;
  const auto off_stroke = failing([&](int i) { return beyond_stroke(at, i); });
  if (!off_stroke.numbers.empty()) {
    add(off_stroke, stroke_text, numbering_advice(at, X_BP, off_stroke));
    return;
  }
  add(failing([&](int i) { return machine.legs[i].strut ? 0.0 : off_rod(at, i); }), sleeve_text);
  const auto tilt = [&](const char* joint, auto limit, auto angle) {
    add(failing([&](int i) {
          const auto most = machine.legs[i].joint_limits.*limit;
          return most ? at.angles[i].*angle - *most : 0.0;
        }),
        [&](const LegsAtPose&, int i) {
          return fmt::format(
              "the {} joint of leg {} is tilted {:.3g}° from the neutral pose, limit {:.3g}°",
              joint, i + 1, at.angles[i].*angle * degrees,
              *(machine.legs[i].joint_limits.*limit) * degrees);
        });
  };
  const auto geometry = inverse_kinematics(machine, X_BP);
  const auto is_locked = [&](int i) {
    constexpr double lock = 1.0 - 1e-9;  // as leg_frame() has it
    const auto& leg = machine.legs[i];
    return machine.flexible_axes == model::FlexibleAxes::gimbal && !leg.strut &&
                   std::abs(leg.gimbal_axis.dot(geometry[static_cast<std::size_t>(i)].n)) > lock
               ? 1.0
               : 0.0;
  };
  add(
      failing(is_locked),
      [](const LegsAtPose&, int i) {
        return fmt::format("leg {} points along the first axis of its lower gimbal (gimbal lock)",
                           i + 1);
      },
      "; choose another legs.gimbal_axis, or model.flexible_axes = \"transverse\"");
  tilt("base", &model::JointLimits::base, &JointAngles::base_tilt);
  tilt("platform", &model::JointLimits::platform, &JointAngles::platform_tilt);
}

void check_singular(const model::Machine& machine, const Pose& X_BP, Findings& findings) {
  if (!is_singular(machine, X_BP)) return;
  const auto quality = pose_quality(machine, X_BP);
  constexpr double shown = 0.005;  // below this two decimals say 0.00, and must not say -0.00
  const Vector6 d =
      (quality.weakest_direction.array().abs() < shown).select(0.0, quality.weakest_direction);
  findings.error(fmt::format(
      "singular pose: the legs cannot resist the platform motion (x, y, z, rx, ry, rz) = ({:.2f}, "
      "{:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f}) [m, rad]; condition of the Jacobian {:.2g}, "
      "accepted below {:.0g}",
      d[0], d[1], d[2], d[3], d[4], d[5], quality.condition, singular_condition));
}

}  // namespace

std::vector<Finding> check_pose(const model::Machine& machine, const Pose& X_BP,
                                const std::string& key) {
  Findings findings{key};
  check_legs(machine, X_BP, findings);
  if (findings.list.empty()) check_singular(machine, X_BP, findings);
  return findings.list;
}

namespace {

bool any_error(const std::vector<Finding>& findings) {
  return std::ranges::any_of(findings,
                             [](const Finding& f) { return f.severity == base::Severity::error; });
}

/// "; did you mean 3 deg?" where the legs reach the pose with the numbers of its angles as degrees.
std::string guess_of_angles(const model::Machine& machine, const Pose& X_BP) {
  constexpr double little = 0.35;  // [rad]: nobody writes a fifth of a degree as 0.35
  auto rpy = spatial::rpy_from_rotation(X_BP.R_BP);
  const auto other_way = [](double angle) {
    return angle - std::copysign(std::numbers::pi, angle);
  };
  const spatial::Vector3 other{other_way(rpy[0]), -other_way(rpy[1]), other_way(rpy[2])};
  if (other.norm() < rpy.norm()) rpy = other;  // the same rotation, as it was written
  std::vector<std::string> meant;
  auto in_degrees = rpy;
  for (int k = 0; k < 3; ++k) {
    if (!(std::abs(rpy[k]) > little)) continue;
    // degrees are written with few digits, π/2 with many
    if (std::abs(100.0 * rpy[k] - std::round(100.0 * rpy[k])) > 1e-7) return {};
    meant.push_back(fmt::format("{:.6g} deg", rpy[k]));
    in_degrees[k] /= degrees;
  }
  if (meant.empty() ||
      !check_pose(machine, {spatial::rotation_from_rpy(in_degrees), X_BP.p_BP}, "").empty())
    return {};
  return fmt::format("; did you mean {}?", fmt::join(meant, ", "));
}

/// What validate() finds, or else what is wrong at the poses.
std::vector<Finding> validate_with_poses(const model::Machine& machine) {
  auto findings = model::validate(machine);
  if (any_error(findings)) return findings;
  for (const auto& pose : machine.poses) {
    auto found = check_pose(machine, pose.X_BP, "poses." + pose.name);
    if (!found.empty()) {
      const auto guess = guess_of_angles(machine, pose.X_BP);
      for (auto& finding : found) finding.message += guess;
    }
    std::ranges::move(found, std::back_inserter(findings));
  }
  return findings;
}

}  // namespace

std::vector<Finding> check_machine(const model::Machine& machine) {
  auto findings = validate_with_poses(machine);
  auto unusual = model::unusual_numbers(machine);
  if (unusual.findings.empty()) return findings;
  if (any_error(findings)) {  // the likely cause, and what would remain without it
    auto left = validate_with_poses(unusual.guessed);
    const auto is_refused = [&](const Finding& finding) {
      return std::ranges::any_of(left, [&](const Finding& other) {
        return other.severity == base::Severity::error && other.key == finding.key;
      });
    };
    // a number that is refused in any case: why, says more than what it may have been meant to be
    if (std::erase_if(unusual.findings, is_refused) == 0) {
      for (auto& finding : unusual.findings) finding.severity = base::Severity::error;
      findings = std::move(left);
    }
  }
  std::ranges::move(findings, std::back_inserter(unusual.findings));
  return unusual.findings;
}

}  // namespace hydrapod::kinematics
