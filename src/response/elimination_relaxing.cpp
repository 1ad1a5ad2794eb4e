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

/// One object for all lines: what stretches alike is found once.
struct RelaxingFrequencies : Frequencies {
  std::vector<Relaxed> relaxed{};

  explicit RelaxingFrequencies(const ResponseModel& model) : arms_(model.arms) {
    for (const auto& arm : arms_) {
      auto alike = std::ranges::find_if(
          relaxed, [&](const Relaxed& one) { return stretch_alike(*one.first, arm); });
      if (alike == relaxed.end()) alike = relaxed.insert(alike, {.first = &arm});
      part_of_.push_back(static_cast<std::size_t>(alike - relaxed.begin()));
    }
  }

  RelaxingFrequencies& at(const Frequencies& f) {
    static_cast<Frequencies&>(*this) = f;
    for (auto& one : relaxed) one.sum = {Reals::Zero(), Reals::Zero()};
    for (std::size_t j = 0; j < arms_.size(); ++j) {
      const auto& arm = arms_[j];
      const Reals damper = arm.stiffness * arm.rate / (f.omega2 + arm.rate * arm.rate);
      relaxed[part_of_[j]].sum += {damper * arm.rate, -damper * f.omega};
    }
    return *this;
  }

 private:
  std::span<const dynamics::RelaxingArm> arms_;
  std::vector<std::size_t> part_of_{};  ///< per arm its place in `relaxed`
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
  RelaxingFrequencies lines(model);
  eliminate_lanes(model, omega, out,
                  [&](const Frequencies& f) -> const RelaxingFrequencies& { return lines.at(f); });
}

}  // namespace hydrapod::response
