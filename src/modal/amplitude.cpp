/// The branches of the harmonic balance over the amplitude: docs/theory/amplitude.md.

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "hydrapod/base/error.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "swinging.hpp"

namespace hydrapod::modal {

namespace {

/// (q/|q|, ω) with ω over some ω_0, or a change of it.
using Vector = Eigen::VectorXd;

/// A point of a branch.
struct Point {
  ModelVector q{};  ///< motion in the coordinates of the linear modes
  double omega{};
  Vector direction{};  ///< of the branch, a unit vector in (q/|q|, ω/ω) of this point
  /// Of the step to here: how far it is from an arc between the directions at both ends, over its
  /// length. Small, of the order of the length squared; larger where it leads to another branch.
  double kink{};
};

/// (K(q, ω) − ω²) q = 0, the harmonic balance of one mode: a curve in (q, ω), whose next point is
/// found by a step along it, then by Newton's method in the plane across it (Keller, in:
/// Applications of Bifurcation Theory, 1977).
class Balance {
 public:
  Balance(const Swinging& swinging, const AmplitudeOptions& options)
      : swinging_(swinging), options_(options), shapes_(shapes_to_begin_with(swinging)) {}

  /// The motion most like the mode of the linear model, where springs do not depend on the
  /// amplitude: at a very small or a very large one. `way`: up (1) or down (-1) from there. Empty
  /// where there is no balance.
  [[nodiscard]] std::optional<Point> begin(int mode, double amplitude, double way) const {
    Point point{.q = shapes_.col(mode), .omega = swinging_.modes().omega(mode)};
    constexpr int most = 100;
    for (int k = 0; k < most; ++k) {
      point.q *= amplitude / swinging_.amplitude(point.q);
      const ModelMatrix K = swinging_.at(point.q, point.omega).K;
      point.q = most_like(point.q, K);
      const double omega2 = point.q.dot(K * point.q) / point.q.squaredNorm();
      if (!(omega2 > 0.0)) return std::nullopt;
      const double before = std::exchange(point.omega, std::sqrt(omega2));
      if (std::abs(point.omega - before) <= options_.tolerance * point.omega) break;
    }
    point.q *= amplitude / swinging_.amplitude(point.q);
    point.direction = Vector::Zero(point.q.size() + 1);
    point.direction.head(point.q.size()) = way * point.q.normalized();
    return next(point, 0.0);
  }

  /// A step of this length along the direction of `from`. Empty where Newton's method does not
  /// end.
  [[nodiscard]] std::optional<Point> next(const Point& from, double length) const {
    const Eigen::Index n = from.q.size();
    const double size = from.q.norm(), rate = from.omega;
    Vector u(n + 1), left(n + 1);
    u << from.q / size, 1.0;
    u += length * from.direction;
    const Vector plane = u;
    Eigen::MatrixXd A(n + 1, n + 1);
    A.row(n) = from.direction;
    for (int k = 0; k < options_.most_iterations && u[n] > 0.0; ++k) {
      left << balance_residual(swinging_, u, size, rate, A), from.direction.dot(u - plane);
      const Vector step = solution_of_balance(A, left);
      u -= step;
      if (!(std::abs(step[n]) <= options_.tolerance * u[n] &&
            step.head(n).norm() <= std::sqrt(options_.tolerance) * u.head(n).norm()))
        continue;
      Point point{.q = size * u.head(n), .omega = rate * u[n]};
      balance_residual(swinging_, u, size, rate, A);
      point.direction = solution_of_balance(A, Vector::Unit(n + 1, n)).normalized();
      if (length > 0.0)
        point.kink = ((u - plane) / length - 0.5 * (point.direction - from.direction)).norm();
      point.direction.head(n) /= u.head(n).norm();
      point.direction[n] /= u[n];
      point.direction.normalize();
      return point;
    }
    return std::nullopt;
  }

  /// Change of the amplitude along the branch [m per q].
  [[nodiscard]] double slope(const Point& at) const {
    return swinging_.amplitude_gradient(at.q).dot(at.direction.head(at.q.size()));
  }

 private:
  const Swinging& swinging_;
  const AmplitudeOptions& options_;
  ModelMatrix shapes_{};
};

/// Tells how much of the branches is known, a part of 1 for each; throws where it is asked to stop.
class Told {
 public:
  explicit Told(const numerics::Progress& progress) : progress_(progress) {}

  /// The next branch makes the share `from` … `to`.
  void begin(double from, double to) {
    from_ = from;
    to_ = to;
  }
  /// `share` of the branch is known.
  void at(double share) {
    share_ = std::max(share_, from_ + (to_ - from_) * std::clamp(share, 0.0, 1.0));
    if (progress_ && progress_(share_)) throw base::ComputationError("interrupted");
  }
  void again() { at(0.0); }

 private:
  const numerics::Progress& progress_;
  double from_{}, to_{}, share_{};
};

/// Follows the branch of one mode and notes its points at the amplitudes.
class Follower {
 public:
  Follower(const Swinging& swinging, const AmplitudeOptions& options,
           std::span<const double> amplitudes, AmplitudeCurve& curve, Told& told)
      : swinging_(swinging),
        options_(options),
        balance_(swinging, options),
        amplitudes_(amplitudes),
        curve_(curve),
        told_(told) {
    for (const double amplitude : amplitudes) curve.points.push_back({.amplitude = amplitude});
  }

  /// From the balance of the curve's mode at `start`, up (`way` 1) or down (-1).
  void follow(double start, double way) {
    auto at = balance_.begin(curve_.mode, start, way);
    if (!at) {
      curve_.end = BranchEnd::stopped;
      return;
    }
    curve_.omega = at->omega;
    const double last =
        way > 0.0 ? options_.beyond * amplitudes_.back() : amplitudes_.front() / options_.beyond;
    double length = options_.longest_step;
    for (int k = 0; k < options_.most_steps; ++k) {
      told_.at(std::log(swinging_.amplitude(at->q) / start) / std::log(last / start));
      auto next = step(*at, length);
      if (!next) return end(*at, BranchEnd::stopped);
      if (platform_excess(*next) < 0.0) return end_at_local(*at, length);
      note_between(*at, length, *next);
      constexpr double longer = 1.5;  // where the last step was taken
      length = std::min(longer * length, options_.longest_step);
      at = std::move(next);
      const double amplitude = swinging_.amplitude(at->q);
      const bool grows = balance_.slope(*at) > 0.0;
      if (grows ? amplitude > options_.beyond * amplitudes_.back()
                : amplitude * options_.beyond < amplitudes_.front())
        return end(*at, grows == (way > 0.0) ? BranchEnd::beyond : BranchEnd::turned);
    }
    end(*at, BranchEnd::most_steps);
  }

 private:
  /// The step along the branch; `length` becomes shorter where needed.
  std::optional<Point> step(const Point& from, double& length) const {
    for (; length >= options_.shortest_step; length *= 0.5)
      if (auto to = balance_.next(from, length);
          to && to->direction.dot(from.direction) >= options_.least_cosine &&
          to->kink <= options_.largest_kink)
        return to;
    return std::nullopt;
  }

  /// The point of the branch between `from` and a step `length` at which `value` changes its sign.
  template <class Value>
  std::optional<std::pair<double, Point>> between(const Point& from, double low, double high,
                                                  const Value& value) const {
    std::optional<Point> found;
    const auto at = [&](double length) {
      found = balance_.next(from, length);
      return found ? value(*found) : 0.0;
    };
    const double at_low = at(low), at_high = at(high);
    if (at_low == 0.0 || at_high == 0.0 || (at_low > 0.0) == (at_high > 0.0)) return std::nullopt;
    constexpr int digits = 40;  // of 53 bits
    std::uintmax_t most = 60;
    const auto ends = boost::math::tools::toms748_solve(
        at, low, high, at_low, at_high, boost::math::tools::eps_tolerance<double>(digits), most);
    const double length = 0.5 * (ends.first + ends.second);
    found = balance_.next(from, length);
    if (!found) return std::nullopt;
    return std::pair(length, *found);
  }

  /// What the step from `from` to `to` passes: a turn of the amplitude, and amplitudes asked for.
  void note_between(const Point& from, double length, const Point& to) {
    const bool grows = balance_.slope(from) > 0.0;
    if (grows == (balance_.slope(to) > 0.0)) return note_amplitudes(from, 0.0, from, length, to);
    const auto turn =
        between(from, 0.0, length, [&](const Point& at) { return balance_.slope(at); });
    if (!turn) return note_amplitudes(from, 0.0, from, length, to);
    note_amplitudes(from, 0.0, from, turn->first, turn->second);
    curve_.turning.push_back(described(turn->second));
    ++turns_;
    note_amplitudes(from, turn->first, turn->second, length, to);
  }

  /// The amplitudes between a step `low` and a step `high` along `from`.
  void note_amplitudes(const Point& from, double low, const Point& at_low, double high,
                       const Point& at_high) {
    const double first = swinging_.amplitude(at_low.q), last = swinging_.amplitude(at_high.q);
    const auto note = [&](std::size_t k) {
      const double wanted = amplitudes_[k];
      if (!(std::min(first, last) < wanted && wanted <= std::max(first, last))) return;
      told_.again();
      const auto found = between(
          from, low, high, [&](const Point& at) { return swinging_.amplitude(at.q) - wanted; });
      auto point = described(found ? found->second : at_high);
      if (!found && std::abs(last - wanted) > 1e-9 * wanted) return;
      point.amplitude = wanted;
      (curve_.points[k].converged ? curve_.further.emplace_back() : curve_.points[k]) =
          std::move(point);
    };
    for (std::size_t k = 0; k < amplitudes_.size(); ++k)
      note(last > first ? k : amplitudes_.size() - 1 - k);
  }

  [[nodiscard]] double platform_excess(const Point& at) const {
    return swinging_.platform_share(at.q) - options_.least_platform;
  }

  /// The platform has its least share within the step from `from`, or before it.
  void end_at_local(const Point& from, double length) {
    const auto last =
        between(from, 0.0, length, [&](const Point& at) { return platform_excess(at); });
    if (last) note_between(from, last->first, last->second);
    end(last ? last->second : from, BranchEnd::local);
  }

  ModeAtAmplitude described(const Point& at) const {
    auto point = swinging_.described(at.q, at.omega);
    point.mac = std::pow(at.q[curve_.mode], 2) / at.q.squaredNorm();
    point.turns = turns_;
    return point;
  }

  void end(const Point& at, BranchEnd why) {
    curve_.end = why;
    curve_.last = described(at);
  }

  const Swinging& swinging_;
  const AmplitudeOptions& options_;
  Balance balance_;
  std::span<const double> amplitudes_;
  AmplitudeCurve& curve_;
  Told& told_;
  int turns_{};
};

std::vector<const ModeAtAmplitude*> solutions(const AmplitudeCurve& curve) {
  std::vector<const ModeAtAmplitude*> found;
  for (const auto& point : curve.points)
    if (point.converged) found.push_back(&point);
  for (const auto& point : curve.further) found.push_back(&point);
  return found;
}

/// Whether all solutions of `one`, of which it has some, are on `other`.
bool is_part_of(const ModelMatrix& M, const AmplitudeCurve& one, const AmplitudeCurve& other) {
  constexpr double same_omega = 1e-7, same_shape = 0.999;  // far more than balances differ
  const auto points = solutions(one);
  auto others = solutions(other);
  std::ranges::stable_sort(others, {}, &ModeAtAmplitude::amplitude);
  return !points.empty() && std::ranges::all_of(points, [&](const auto* a) {
    const auto beside =
        std::ranges::equal_range(others, a->amplitude, {}, &ModeAtAmplitude::amplitude);
    return std::ranges::any_of(beside, [&](const auto* b) {
      return std::abs(a->omega - b->omega) < same_omega * b->omega &&
             std::abs(a->shape.dot(M * b->shape)) > same_shape;
    });
  });
}

/// Two linear modes may begin on one branch, and long swings may lead to that of small motions:
/// it stays where it has more, or where it is more like the mode.
void leave_out_repeated(const ModelMatrix& M, std::vector<AmplitudeCurve>& curves) {
  const auto likeness = [](const AmplitudeCurve& curve) {
    const auto points = solutions(curve);
    return std::pair(points.size(), points.empty() ? 0.0 : points.front()->mac);
  };
  for (std::size_t k = curves.size(); k-- > 0;) {
    const auto& one = curves[k];
    const bool useless = one.from_long_swings && solutions(one).empty();
    const bool repeated = std::ranges::any_of(curves, [&](const AmplitudeCurve& other) {
      return &other != &one && likeness(one) <= likeness(other) && is_part_of(M, one, other);
    });
    if (useless || repeated) curves.erase(curves.begin() + static_cast<std::ptrdiff_t>(k));
  }
}

}  // namespace

std::vector<AmplitudeCurve> modes_at_amplitudes(const model::Machine& machine,
                                                const spatial::Pose& X_BP, dynamics::ModelKind kind,
                                                std::span<const double> amplitudes,
                                                const AmplitudeOptions& options,
                                                const numerics::Progress& progress) {
  if (amplitudes.empty() || !(amplitudes.front() > 0.0) ||
      std::ranges::adjacent_find(amplitudes, std::greater_equal{}) != amplitudes.end())
    throw std::invalid_argument("amplitudes must be above 0 and ascend");
  const Swinging swinging(machine, X_BP, kind);
  const auto& modes = swinging.modes();
  const auto shares = energy_shares(swinging.linear(), modes.shapes);
  constexpr double small = 1e-3, long_swings = 1e5;  // of the first and the last amplitude
  constexpr double first_part = 0.7;  // of the work; how many begin at long swings is not yet known
  std::vector<AmplitudeCurve> curves;
  Told told(progress);
  const auto add = [&](AmplitudeCurve curve, double start, double way) {
    Follower(swinging, options, amplitudes, curve, told).follow(start, way);
    curves.push_back(std::move(curve));
  };
  for (int k = 0; k < modes.size(); ++k) {
    const auto& energy = shares[static_cast<std::size_t>(k)];
    if (energy.platform.sum() < options.least_platform || !(modes.omega2[k] > 0.0)) continue;
    AmplitudeCurve curve{.mode = k};
    energy.platform.maxCoeff(&curve.direction);
    told.begin(first_part * k / modes.size(), first_part * (k + 1) / modes.size());
    add(curve, small * amplitudes.front(), 1.0);
  }
  const std::size_t count = curves.size();
  for (std::size_t k = 0; k < count; ++k) {
    if (curves[k].end == BranchEnd::beyond) continue;
    const double part = (1.0 - first_part) / static_cast<double>(count);
    told.begin(first_part + part * static_cast<double>(k),
               first_part + part * static_cast<double>(k + 1));
    add({.mode = curves[k].mode, .direction = curves[k].direction, .from_long_swings = true},
        long_swings * amplitudes.back(), -1.0);
  }
  leave_out_repeated(swinging.linear().M, curves);
  return curves;
}

}  // namespace hydrapod::modal
