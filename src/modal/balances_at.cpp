/// Balances at given amplitudes without the branches that lead there: docs/theory/amplitude.md.

#include <algorithm>
#include <cmath>
#include <optional>

#include "swinging.hpp"

namespace hydrapod::modal {

namespace {

/// A balance, or what may become one.
struct Motion {
  ModelVector q{};
  double omega{};
};

double mac(const ModelVector& a, const ModelVector& b) {
  return std::pow(a.dot(b), 2) / (a.squaredNorm() * b.squaredNorm());
}

class Balancing {
 public:
  explicit Balancing(const Swinging& swinging) : swinging_(swinging) {}

  /// As balances_at() of one start. From the shape itself where the balance is like it, else from
  /// small motions on.
  [[nodiscard]] ModeAtAmplitude at(double amplitude, const ModelVector& start) const {
    constexpr double alike = 0.9;
    auto found = solved(amplitude, {start * (amplitude / swinging_.amplitude(start)),
                                    rayleigh(start, swinging_.modes().omega2.asDiagonal())});
    if (!found || mac(found->q, start) < alike) found = from_small_motions(amplitude, start);
    if (!found) return {.amplitude = amplitude};
    auto point = swinging_.described(found->q, found->omega);
    point.amplitude = amplitude;
    point.mac = mac(found->q, start);
    return point;
  }

 private:
  static double rayleigh(const ModelVector& q, const ModelMatrix& K) {
    return std::sqrt(std::max(q.dot(K * q) / q.squaredNorm(), 0.0));
  }

  /// Newton's method for (K(q, ω) − ω²) q = 0 and the amplitude of q.
  [[nodiscard]] std::optional<Motion> solved(double amplitude, Motion at) const {
    constexpr int most = 25;
    constexpr double same_omega = 1e-11, same_motion = 1e-8;  // it converges quadratically
    const Eigen::Index n = at.q.size();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + 1, n + 1);
    Eigen::VectorXd u(n + 1), left(n + 1);
    for (int k = 0; k < most && at.omega > 0.0; ++k) {
      const auto& [q, omega] = at;
      const double size = q.norm();
      u << q / size, 1.0;
      A.row(n).head(n) = swinging_.amplitude_gradient(q) * (size / amplitude);
      left << balance_residual(swinging_, u, size, omega, A),
          swinging_.amplitude(q) / amplitude - 1.0;
      const Eigen::VectorXd step = solution_of_balance(A, left);
      if (!step.allFinite()) return std::nullopt;
      at = {q - size * step.head(n), omega * (1.0 - step[n])};
      if (std::abs(step[n]) <= same_omega && step.head(n).norm() <= same_motion) return at;
    }
    return std::nullopt;
  }

  /// A motion so small that springs hardly change with it: it gives them, and the mode of these
  /// that is most like it the next motion.
  [[nodiscard]] Motion small_motion(double amplitude, ModelVector q) const {
    constexpr int most = 30;
    double omega = rayleigh(q, swinging_.modes().omega2.asDiagonal());
    for (int k = 0; k < most; ++k) {
      q *= amplitude / swinging_.amplitude(q);
      const ModelMatrix K = swinging_.at(q, omega).K;
      q = most_like(q, K);
      omega = rayleigh(q, K);
    }
    return {q * (amplitude / swinging_.amplitude(q)), omega};
  }

  /// In steps of the amplitude, which become shorter where the motion changes much.
  [[nodiscard]] std::optional<Motion> from_small_motions(double amplitude,
                                                         const ModelVector& start) const {
    constexpr double small = 1e-3, longest = 4.0, shortest = 1.01, alike = 0.8;
    double now = small * amplitude, factor = longest;
    auto at = solved(now, small_motion(now, start));
    while (at && now < amplitude) {
      const double next = std::min(now * factor, amplitude);
      auto found = solved(next, {at->q * (next / now), at->omega});
      if (found && mac(found->q, at->q) >= alike) {
        at = std::move(found);
        now = next;
        factor = std::min(factor * factor, longest);
      } else if ((factor = std::sqrt(factor)) < shortest) {
        return std::nullopt;
      }
    }
    return at;
  }

  const Swinging& swinging_;
};

}  // namespace

std::vector<ModeAtAmplitude> balances_at(const model::Machine& machine, const spatial::Pose& X_BP,
                                         dynamics::ModelKind kind,
                                         std::span<const SwingStart> starts) {
  const Swinging swinging(machine, X_BP, kind);
  const auto& M = swinging.linear().M;
  std::vector<ModeAtAmplitude> found;
  for (const auto& [amplitude, shape] : starts)
    found.push_back(
        Balancing(swinging).at(amplitude, swinging.modes().shapes.transpose() * (M * shape)));
  return found;
}

}  // namespace hydrapod::modal
