#pragma once
/// One seal of the plant that large amplitudes soften (docs/theory/elastomers.md, "Simulation").
///
///     s(w) = 1 − softening r/(1 + r),  r = w (w + ε)^(m − 1),  m = 0.6
///     P = (s − 1) k (δ − d_0) + s Σ κ (δ − ξ)          on the rod against δ, beside the spring k
///     ẇ = (2 |δ − d̄|²/A_s² − w)/τ,     d̄˙ = (δ − d̄)/τ,     ξ˙ = λ (δ − ξ)
///
/// r is (A/A_s)^1.2 with A² = A_s² w; ε keeps its slope finite where nothing moves. δ is the offset
/// at the seal. Where rod and case bend, P moves it: δ = d − g P with d the offset without P and
/// g = f/(1 + f k).

#include <cmath>

#include "plant_work.hpp"

namespace hydrapod::simulation {

struct Plant::SoftenedSeal {
  using Vector2 = dynamics::Vector2;
  static constexpr double small = 1e-4;  ///< ε: s is off by 4e-5 softening at most where A > A_s

  double square{}, left{1.0}, slope{};  ///< w, s, ds/dw
  Vector2 mean{Vector2::Zero()};        ///< d̄
  Vector2 force{Vector2::Zero()};       ///< P
  Vector2 offset{Vector2::Zero()};      ///< δ

  /// `free`: d; `eta` the states of the arms, `states` those of the softening.
  SoftenedSeal(const Softening& of, const dynamics::SealArms& arms, const Vector2& free,
               const double* eta, const double* states)
      : square(states[0]), mean(states[1], states[2]) {
    soften(of.share);
    double hardness = (left - 1.0) * of.stiffness;
    force = hardness * (free - of.rest);
    for (const auto& arm : arms) {
      force += left * arm.stiffness * (free - Vector2(eta[0], eta[1]));
      hardness += left * arm.stiffness;
      eta += 2;
    }
    force /= 1.0 + of.series * hardness;
    offset = free - of.series * force;
  }

  /// ẇ [1/s].
  [[nodiscard]] double square_rate(const Softening& of) const {
    const double a2 = of.amplitude * of.amplitude;
    return (2.0 * (offset - mean).squaredNorm() / a2 - square) / of.time;
  }

  /// d_0 is a direction of the leg's frame; the arms stand in the case.
  [[nodiscard]] double frame_moment(const Softening& of) const {
    return (1.0 - left) * of.stiffness * (of.rest[0] * offset[1] - of.rest[1] * offset[0]);
  }

  /// From what arms would store [J] and dissipate [W] without softening to what the seal does
  /// beside its spring k. What s loses is dissipated.
  void account(const Softening& of, double& stored, double& dissipated) const {
    const double whole = 0.5 * of.stiffness * (offset - of.rest).squaredNorm();
    dissipated = left * dissipated - slope * square_rate(of) * (whole + stored);
    stored = left * stored + (left - 1.0) * whole + 0.5 * of.series * force.squaredNorm();
  }

 private:
  void soften(double share) {
    if (!(square > 0.0)) return;  // an error of the integration
    constexpr double m = 0.5 * dynamics::softening_exponent;
    const double shifted = square + small, power = std::pow(shifted, m - 1.0);
    const double r = square * power, r_slope = power * (m * square + small) / shifted;
    left = 1.0 - share * r / (1.0 + r);
    slope = -share * r_slope / ((1.0 + r) * (1.0 + r));
  }
};

}  // namespace hydrapod::simulation
