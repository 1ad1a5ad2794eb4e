#pragma once
/// Modes in SIMD lanes against the same modes one design at a time.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "hydrapod/modal/mode_table.hpp"
#include "study/lane_solve.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {

/// What was compared, and how far apart it was.
struct LaneComparison {
  int designs{}, alone{}, buckled{};
  double frequency{};       ///< largest relative difference of an ω
  double sum_of_mass{};     ///< largest difference of a direction's Σφ², relative
  int labels{};             ///< modes whose labels differ
  std::string different{};  ///< the first of them

  /// Frequencies to 1e-12 and everything else the same. Each design of `models` is solved in lanes
  /// beside the others.
  void add(const study::LaneKernels& kernels,
           const std::vector<std::unique_ptr<dynamics::LinearModel>>& models) {
    std::vector<const dynamics::LinearModel*> all;
    for (const auto& model : models) all.push_back(model.get());
    std::vector<modal::NormalModes> modes(all.size());
    const auto sound = std::make_unique<bool[]>(all.size());
    study::solve_in_lanes(kernels, all, modes, {sound.get(), all.size()});
    for (std::size_t k = 0; k < all.size(); ++k) {
      ++designs;
      if (sound[k])
        compare(*all[k], modes[k]);
      else
        ++alone;
    }
  }

 private:
  /// From mode k to the next one outside of its group, of the largest ω².
  static double distance(const modal::NormalModes& modes, int k) {
    double least = 1.0;
    for (int other = 0; other < modes.size(); ++other)
      if (modes.group[other] != modes.group[k])
        least = std::min(least, std::abs(modes.omega2[other] - modes.omega2[k]) /
                                    modes.omega2[modes.size() - 1]);
    return least;
  }

  void compare(const dynamics::LinearModel& model, const modal::NormalModes& found) {
    const auto expected = modal::normal_modes(model);
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_EQ(found.omega2[0] <= 0.0, expected.omega2[0] <= 0.0);
    if (expected.omega2[0] <= 0.0) {
      ++buckled;
      return;
    }
    for (int k = 0; k < found.size(); ++k)
      frequency = std::max(frequency, std::abs(found.omega(k) / expected.omega(k) - 1.0));
    for (int d = 0; d < 6; ++d)
      sum_of_mass = std::max(
          sum_of_mass,
          std::abs(found.shapes.row(d).squaredNorm() / expected.shapes.row(d).squaredNorm() - 1.0));
    const auto ours = modal::energy_shares(model, found.shapes),
               theirs = modal::energy_shares(model, expected.shapes);
    for (std::size_t k = 0; k < ours.size(); ++k) {
      const auto found_label = modal::mode_label(ours[k], true),
                 expected_label = modal::mode_label(theirs[k], true);
      if (found_label == expected_label) continue;
      const double next = distance(expected, static_cast<int>(k));
      if (++labels == 1)
        different = fmt::format("mode {}: '{}' instead of '{}', next ω² at {:.1e} of the largest",
                                k, found_label, expected_label, next);
    }
  }
};

/// The model of a machine that nobody would build, at its tilted pose; with `spread` instead one of
/// equal legs whose guide sleeves differ by that.
inline std::unique_ptr<dynamics::LinearModel> lane_model(Random& random, model::FlexibleAxes axes,
                                                         dynamics::ModelKind kind, Gravity gravity,
                                                         std::optional<double> spread = {}) {
  auto machine =
      spread ? symmetric_machine() : random_machine(random, {.axes = axes, .gravity = gravity});
  if (spread) {
    machine.flexible_axes = axes;
    for (auto& leg : machine.legs) {
      leg.guide_sleeve.stiffness *= 1.0 + *spread * random.uniform(-1.0, 1.0);
      leg.gimbal_axis = {0.0, 1.0, 0.0};
    }
  }
  return std::make_unique<dynamics::LinearModel>(
      dynamics::linear_model(machine, machine.poses.back().X_BP, kind));
}

}  // namespace hydrapod::test
