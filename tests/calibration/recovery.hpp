#pragma once
/// Synthetic calibrations: machines with known numbers, their modes with noise, what comes back.

#include <cmath>
#include <string>
#include <vector>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "support/calibration_machine.hpp"

namespace hydrapod::test {

/// How often a parameter's interval held the truth.
struct Coverage {
  int determined{}, held{};
  int undetermined{};
  double squares{};  ///< of errors over their deviations, of what is determined
  /// Parameters that the data cannot know, called determined all the same.
  std::vector<std::string> wrongly{};
};

/// What is free in every machine. The case's mass and inertia can be traded for each other without
/// any mode noticing, so that neither can ever be known.
inline const std::vector<std::string> recovered_paths{"platform.mass",
                                                      "platform.inertia.xx",
                                                      "platform.inertia.yy",
                                                      "platform.inertia.zz",
                                                      "platform.mass_center[2]",
                                                      "legs.guide_sleeve.stiffness",
                                                      "legs.oil_spring.stiffness",
                                                      "legs.case.mass",
                                                      "legs.case.transverse_inertia"};
inline const std::vector<std::string> unknowable{"legs.case.mass", "legs.case.transverse_inertia"};

/// One machine, its modes at two poses with `noise` (relative), fitted from starting values that
/// are off by up to half.
inline void recover(std::uint64_t machine_seed, std::uint64_t noise_seed, bool gravity,
                    Coverage& coverage) {
  constexpr double noise = 1e-3;
  Random machine_random(machine_seed), random(noise_seed * 7919 + machine_seed);
  const auto truth = machine_file(random_machine_text(machine_random, gravity));
  observation::Targets targets;
  for (const char* pose : {"neutral", "shifted"})
    for (auto& mode : modes_of(truth, pose, dynamics::ModelKind::guide, noise)) {
      mode.omega *= 1.0 + noise * normal(random);
      targets.modes.push_back(mode);
    }
  calibration::Plan plan{.free = free_paths(recovered_paths)};
  plan.options.starts = 6;
  plan.options.threads = 1;
  for (auto& free : plan.free) {
    const double value = find_number(truth, free.paths.front())->value;
    free.start = value * random.uniform(0.7, 1.5);
    free.lower = value > 0.0 ? value / 8.0 : value * 8.0;
    free.upper = value > 0.0 ? value * 8.0 : value / 8.0;
  }
  const auto result =
      calibration::calibrate(truth, targets, plan, dynamics::ModelKind::guide).best();
  for (const auto& p : result.parameters) {
    const std::string& path = p.paths.front();
    if (p.verdict != calibration::Verdict::determined) {
      ++coverage.undetermined;
      continue;
    }
    if (std::find(unknowable.begin(), unknowable.end(), path) != unknowable.end()) {
      coverage.wrongly.push_back(fmt::format("{} of machine {}", path, machine_seed));
      continue;
    }
    const double value = find_number(truth, path)->value;
    ++coverage.determined;
    coverage.held += p.interval_low <= value && value <= p.interval_high;
    coverage.squares += std::pow((p.value - value) / p.deviation, 2);
  }
}

}  // namespace hydrapod::test
