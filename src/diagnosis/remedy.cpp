#include "hydrapod/diagnosis/diagnose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::diagnosis {

namespace {

constexpr double nearly_rigid = 1e5;
constexpr double softest = 1e-3;

/// The worst of all poses and directions asked for.
struct Worst {
  double omega{std::numeric_limits<double>::infinity()};
  double drop{-std::numeric_limits<double>::infinity()};
  double shift{};  // largest, down or up
  double mac{};    ///< of the resonance with that drop
  std::string pose{}, direction{};
};

class Question {
 public:
  Question(const model::Machine& machine, const std::vector<model::NamedPose>& poses,
           dynamics::ModelKind kind, const RemedyGoal& goal)
      : machine_(machine), poses_(poses), kind_(kind), goal_(goal) {}

  Worst worst(double factor) const {
    auto machine = machine_;
    for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= factor;
    Worst worst;
    for (const auto& pose : poses_) {
      std::array<FirstResonance, 6> all;
      try {
        all = first_resonances(machine, pose.X_BP, kind_);
      } catch (const base::ComputationError&) {  // folded: no resonance at all
        return {0.0, 1.0, 1.0, 0.0, pose.name, ""};
      }
      for (const auto& found : all) {
        if (goal_.direction && found.main_direction != *goal_.direction) continue;
        const double shift = std::abs(found.drop());
        const bool worse = goal_.drop ? shift > worst.shift : found.omega < worst.omega;
        worst.omega = std::min(worst.omega, found.omega);
        if (found.drop() > worst.drop) worst.mac = found.mac;
        worst.drop = std::max(worst.drop, found.drop());
        worst.shift = std::max(worst.shift, shift);
        if (!worse) continue;
        worst.pose = pose.name;
        worst.direction = found.direction;
      }
    }
    return worst;
  }

  /// Modes of soft sleeves lie below those of the platform and push them up: a resonance above that
  /// of rigid legs has a part of its motion far below.
  [[nodiscard]] bool met(const Worst& worst) const {
    return goal_.drop ? worst.shift <= *goal_.drop : worst.omega >= *goal_.omega;
  }

  [[nodiscard]] RemedyPoint point(double factor) const {
    const auto at = worst(factor);
    const auto sleeves = sleeves_of(machine_);
    RemedyPoint point{factor, factor * sleeves.stiffest, at.omega, at.drop, at.mac};
    if (sleeves.softest) point.softest = factor * *sleeves.softest;
    return point;
  }

 private:
  const model::Machine& machine_;
  const std::vector<model::NamedPose>& poses_;
  dynamics::ModelKind kind_;
  const RemedyGoal& goal_;
};

/// Smallest factor in (low, high] that meets the goal; low does not, high does.
double bisect(const Question& question, double low, double high) {
  constexpr double precision = 1e-6;
  while (high / low > 1.0 + precision) {
    const double middle = std::sqrt(low * high);
    (question.met(question.worst(middle)) ? high : low) = middle;
  }
  return high;
}

/// Smallest factor from which on, up to `from`, the goal is met; `softest` where that is enough.
double smallest_factor(const Question& question, double from) {
  const double step = std::pow(10.0, -0.1);
  double high = from;
  while (high > softest) {
    const double low = high * step;
    if (!question.met(question.worst(low))) return bisect(question, low, high);
    high = low;
  }
  return softest;
}

std::vector<Change> changes(const model::Machine& machine,
                            const std::vector<model::NamedPose>& poses, dynamics::ModelKind kind,
                            double factor) {
  auto mended = machine;
  for (auto& leg : mended.legs) leg.guide_sleeve.stiffness *= factor;
  std::vector<Change> all;
  for (const auto& pose : poses) {
    try {
      const auto after = first_resonances(mended, pose.X_BP, kind);
      std::array<FirstResonance, 6> before{};
      try {
        before = first_resonances(machine, pose.X_BP, kind);
      } catch (const base::ComputationError&) {  // folded today
      }
      for (std::size_t r = 0; r < after.size(); ++r)
        all.push_back({pose.name, after[r].direction, after[r].omega_rigid, before[r].omega,
                       after[r].omega, before[r].mac, after[r].mac});
    } catch (const base::ComputationError&) {
      all.push_back({pose.name, ""});
    }
  }
  return all;
}

}  // namespace

SleeveRange sleeves_of(const model::Machine& machine) {
  constexpr double alike = 1e-6;
  const auto stiffness = [](const model::Leg& leg) { return leg.guide_sleeve.stiffness; };
  const auto [softest, stiffest] = std::ranges::minmax(machine.legs, {}, stiffness);
  SleeveRange range{.stiffest = stiffness(stiffest)};
  if (stiffness(softest) < (1.0 - alike) * range.stiffest) range.softest = stiffness(softest);
  return range;
}

Remedy find_remedy(const model::Machine& machine, const std::vector<model::NamedPose>& poses,
                   dynamics::ModelKind kind, const RemedyGoal& goal,
                   const numerics::Progress& progress) {
  if (goal.omega.has_value() == goal.drop.has_value())
    throw std::invalid_argument("remedy: give either a frequency or a largest drop");
  if (poses.empty()) throw std::invalid_argument("remedy: no pose is given");
  const Question question(machine, poses, kind, goal);
  const auto at = [&](double share) {
    if (progress && progress(share)) throw base::ComputationError("remedy: interrupted");
  };
  Remedy remedy{.today = question.point(1.0), .limit = question.point(nearly_rigid)};
  if (kind != dynamics::ModelKind::rigid && model::has_elastic_legs(machine)) {
    auto straight = machine;
    for (auto& leg : straight.legs) leg.bending = model::LegBending::rigid;
    remedy.limit_without_bending = Question(straight, poses, kind, goal).point(nearly_rigid);
  }
  constexpr int points = 41;
  constexpr double from = 0.1, to = 1000.0;
  for (int k = 0; k < points; ++k) {
    at(0.5 * k / points);
    remedy.curve.push_back(
        question.point(from * std::pow(to / from, static_cast<double>(k) / (points - 1))));
  }
  at(0.5);
  const auto rigid = question.worst(nearly_rigid);
  if (!question.met(rigid)) {
    remedy.status = RemedyStatus::out_of_reach;
    remedy.needed = remedy.limit;
    remedy.pose = rigid.pose;
    remedy.direction = rigid.direction;
    return remedy;
  }
  // sleeves between today's and rigid ones may do worse: their own modes pass the platform's
  const bool met = question.met(question.worst(1.0));
  const double factor = smallest_factor(question, met ? 1.0 : nearly_rigid);
  remedy.status = met ? RemedyStatus::met_already : RemedyStatus::found;
  remedy.needed = question.point(factor);
  const auto worst = question.worst(factor * (1.0 - 1e-6));
  remedy.pose = worst.pose;
  remedy.direction = worst.direction;
  at(0.9);
  remedy.changes = changes(machine, poses, kind, factor);
  return remedy;
}

std::vector<model::NamedPose> workspace_poses(const model::Machine& machine) {
  const auto& neutral = machine.neutral();
  std::vector<model::NamedPose> poses{{"neutral", neutral}};
  const auto l = kinematics::leg_lengths(machine, neutral);
  const auto sound = [&](const spatial::Vector6& displacement) {
    const auto findings =
        kinematics::check_pose(machine, spatial::displaced(neutral, displacement), "");
    return std::none_of(findings.begin(), findings.end(), [](const model::Finding& f) {
      return f.severity == base::Severity::error;
    });
  };
  for (int code = 0; code < 27; ++code) {
    const spatial::Vector3 way(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
    if (way.isZero(0.0)) continue;
    for (const bool rotation : {false, true}) {
      spatial::Vector6 full = spatial::Vector6::Zero();
      const double largest = rotation ? 0.8 : 0.8 * l.maxCoeff();
      (rotation ? full.tail<3>() : full.head<3>()) = largest * way.normalized();
      double inside = 0.0, outside = 1.0;
      for (int halving = 0; halving < 20; ++halving) {
        const double middle = 0.5 * (inside + outside);
        (sound(middle * full) ? inside : outside) = middle;
      }
      if (inside == 0.0) continue;
      for (const double part : {0.5, 1.0})
        poses.push_back(
            {fmt::format("{} ({:+.0f} {:+.0f} {:+.0f}), {:.0f} % of the way to a limit",
                         rotation ? "rotated" : "moved", way.x(), way.y(), way.z(), 100.0 * part),
             spatial::displaced(neutral, part * inside * full)});
    }
  }
  return poses;
}

}  // namespace hydrapod::diagnosis
