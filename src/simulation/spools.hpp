#pragma once
/// The spools of all valves in closed form. Private to the integrators.
///
/// While its command u is held, a spool moves by itself (hydraulics::spool_acceleration):
///
///     ẍ = 2ζω [ sat(ω (u − x) / 2ζ) − ẋ ],     |sat| ≤ L
///
/// With e = x − u, β² = ω²(1 − ζ²) and e_L = 2ζL/ω this is, piece by piece,
///
///     |e| ≤ e_L:  (e; ẋ) = exp(−ζωt) [ C + ζω S, S; −ω² S, C − ζω S ] (e_0; ẋ_0)
///                 C = cos βt, S = sin βt / β (cosh and sinh for ζ > 1)
///     |e| ≥ e_L:  ẋ = ±L + (ẋ_0 ∓ L) exp(−2ζωt),  e its integral
///
/// Most of the plant changes more slowly than spools do, and nothing acts on them: a method that
/// knows their way needs steps for the rest alone. Errors are of rounding.

#include <array>

#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

struct SpoolMotion {
  double x{};     ///< of the travel
  double rate{};  ///< [1/s]
};

/// [e; ẋ] at a time per [e; ẋ] at 0, within the limit of the rate.
template <class Scalar>
struct SpoolTransition {
  Scalar e_e{}, e_rate{}, rate_e{}, rate_rate{};
};

class SpoolLaw {
 public:
  explicit SpoolLaw(const hydraulics::Valve& valve);
  bool operator==(const SpoolLaw&) const = default;
  /// The limit of the rate left out.
  [[nodiscard]] SpoolTransition<double> transition(double time) const;
  /// After `time` [s] with the command `u`.
  [[nodiscard]] SpoolMotion after(SpoolMotion from, double u, double time) const;
  /// Whether a spool that is `e` from its command may come to the limit of its rate.
  [[nodiscard]] bool may_be_limited(double e, double rate) const;

 private:
  [[nodiscard]] SpoolMotion within(SpoolMotion from, double u, double time) const;
  [[nodiscard]] SpoolMotion limited(SpoolMotion from, double toward, double time) const;
  [[nodiscard]] double turning(double e, double rate) const;
  [[nodiscard]] double lasts_within(SpoolMotion from, double u, double time) const;
  [[nodiscard]] double lasts_limited(SpoolMotion from, double u, double time) const;

  double omega_, zeta_, limit_;
  double e_limit_;  ///< e_L
};

/// Those of all legs during one step.
class Spools {
 public:
  static constexpr std::size_t most_shares = 8;

  /// They will be asked for at the `shares` of each step, which must not fall.
  Spools(const Plant& plant, std::vector<double> shares);

  /// A step of length `step` [s] begins at the state `x`.
  void begin(const double* x, const Vector6& command, double step);
  /// Writes the spools at share number `k` into the state `x`.
  void place(std::size_t k, double* x) const;

 private:
  void set_transitions(double step);

  int first_;  ///< place of the spools in the state, −1 without hydraulics
  std::vector<double> shares_;
  std::vector<SpoolLaw> laws_{};
  numerics::Lanes stiffness_{}, damping_{};  ///< ω², 2ζω
  double step_{};
  std::array<SpoolTransition<numerics::Lanes>, most_shares> transitions_{};
  std::array<numerics::Lanes, most_shares> position_{}, rate_{};
};

}  // namespace hydrapod::simulation
