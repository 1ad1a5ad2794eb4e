#include "whole_loop.hpp"

namespace hydrapod::identification {

std::vector<ExactPole> exact_poles(const model::Machine& machine,
                                   const test::RigExperiment& experiment) {
  std::vector<ExactPole> list;
  const auto system = simulation::linear_system(machine, experiment.X_BP,
                                                {.kind = experiment.kind, .closed = false});
  for (const auto& pole : simulation::system_poles(system).poles) {
    if (!pole.oscillates() || pole.damping_ratio > 0.3) continue;
    double platform = 0.0;
    for (int part = 0; part < 6; ++part) platform += pole.parts[static_cast<size_t>(part)];
    list.push_back({pole.omega / (2.0 * std::numbers::pi), pole.damping_ratio, platform});
  }
  std::ranges::sort(list, {}, &ExactPole::frequency);
  return list;
}

void expect_found(const Identification& found, const std::vector<ExactPole>& exact,
                  const Tolerance& tolerance) {
  std::vector<bool> taken(found.modes.size(), false);
  for (const auto& pole : exact) {
    if (pole.platform < tolerance.least_share || pole.frequency < found.from ||
        pole.frequency > found.to)
      continue;
    std::size_t best = found.modes.size();
    double least = tolerance.frequency;
    for (std::size_t r = 0; r < found.modes.size(); ++r) {
      const double f = found.modes[r].fit.omega() / (2.0 * std::numbers::pi);
      const double off = std::abs(f / pole.frequency - 1.0);
      if (!taken[r] && off < least) {
        least = off;
        best = r;
      }
    }
    ASSERT_LT(best, found.modes.size()) << "not found: " << pole.frequency << " Hz";
    taken[best] = true;
    EXPECT_NEAR(found.modes[best].fit.damping_ratio() / pole.damping, 1.0, tolerance.damping)
        << pole.frequency << " Hz";
  }
  for (const auto& mode : found.modes) {
    const double f = mode.fit.omega() / (2.0 * std::numbers::pi);
    EXPECT_TRUE(std::ranges::any_of(exact,
                                    [&](const ExactPole& pole) {
                                      return std::abs(f / pole.frequency - 1.0) <
                                             tolerance.frequency;
                                    }))
        << "no such mode: " << f << " Hz";
  }
}

}  // namespace hydrapod::identification
