/// With chambers and seals that relax.

#include "elimination_kernel.hpp"

namespace hydrapod::response {

namespace {

/// Arms that stretch alike: Σ κ λ/(iω + λ) over them, and their common s_y.
struct Relaxed {
  const dynamics::RelaxingArm* first{};
  Numbers sum{Reals::Zero(), Reals::Zero()};
};

bool stretch_alike(const dynamics::RelaxingArm& a, const dynamics::RelaxingArm& b) {
  return a.leg == b.leg && a.what == b.what && a.axis == b.axis;
}

struct RelaxingFrequencies : Frequencies {
  std::vector<Relaxed> relaxed{};

  RelaxingFrequencies(const ResponseModel& model, const Frequencies& f) : Frequencies(f) {
    for (const auto& arm : model.arms) {
      const Reals damper = arm.stiffness * arm.rate / (f.omega2 + arm.rate * arm.rate);
      auto alike = std::ranges::find_if(
          relaxed, [&](const Relaxed& one) { return stretch_alike(*one.first, arm); });
      if (alike == relaxed.end()) alike = relaxed.insert(alike, {.first = &arm});
      alike->sum += {damper * arm.rate, -damper * f.omega};
    }
  }
};

/// D less what the arms give back.
inline Numbers stiffness(const ResponseModel& model, const RelaxingFrequencies& f, int i, int j) {
  Numbers entry = stiffness(model, static_cast<const Frequencies&>(f), i, j);
  for (const auto& one : f.relaxed) {
    const double product = one.first->s_y[i] * one.first->s_y[j];
    entry -= {product * one.sum.re, product * one.sum.im};
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
