/// With chambers that relax.

#include "elimination_kernel.hpp"

namespace hydrapod::response {

namespace {

struct RelaxingFrequencies : Frequencies {
  /// Per leg Σ κ λ/(iω + λ) over its chambers' arms, and their common s_y; null: it has none.
  std::array<Numbers, model::leg_count> relaxed;
  std::array<const dynamics::ModelVector*, model::leg_count> s_y{};

  RelaxingFrequencies(const ResponseModel& model, const Frequencies& f) : Frequencies(f) {
    relaxed.fill({Reals::Zero(), Reals::Zero()});
    for (const auto& arm : model.arms) {
      const Reals damper = arm.stiffness * arm.rate / (f.omega2 + arm.rate * arm.rate);
      relaxed[arm.leg] += {damper * arm.rate, -damper * f.omega};
      s_y[arm.leg] = &arm.s_y;
    }
  }
};

/// D less what the arms give back.
inline Numbers stiffness(const ResponseModel& model, const RelaxingFrequencies& f, int i, int j) {
  Numbers entry = stiffness(model, static_cast<const Frequencies&>(f), i, j);
  for (int leg = 0; leg < model::leg_count; ++leg) {
    if (f.s_y[leg] == nullptr) continue;
    const double product = (*f.s_y[leg])[i] * (*f.s_y[leg])[j];
    entry -= {product * f.relaxed[leg].re, product * f.relaxed[leg].im};
  }
  return entry;
}

}  // namespace

void eliminate_relaxing(const ResponseModel& model, std::span<const double> omega,
                        std::span<Matrix6c> out) {
  eliminate_lanes(model, omega, out,
                  [&](const Frequencies& f) { return RelaxingFrequencies(model, f); });
}

}  // namespace hydrapod::response
