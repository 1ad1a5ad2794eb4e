#pragma once
/// Designs in SIMD lanes against the same designs computed one at a time.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "study/lane_designs.hpp"
#include "study/lane_machine.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {

/// A machine at its last pose.
struct LaneDesign {
  model::Machine machine{};
  dynamics::ModelKind kind{};

  [[nodiscard]] const spatial::Pose& X_BP() const { return machine.poses.back().X_BP; }
  [[nodiscard]] study::MachineNumbers<double> numbers() const {
    return study::lane_numbers(machine, X_BP(), nullptr, nullptr);
  }
};

/// Lanes for designs like this one.
inline study::LaneDesigns lanes_for(const study::LaneKernels& kernels, const LaneDesign& design) {
  return {kernels, design.kind, study::lane_options(design.machine, 0.05), dynamics::ModelMatrix()};
}

/// What was compared, and how far apart it was.
struct LaneComparison {
  int designs{}, alone{}, buckled{}, impossible{};
  double mass{}, stiffness{};  ///< largest difference of an entry, of the roots of its diagonals
  double frequency{};          ///< largest relative difference of an ω, of the rigid model too
  double without_shapes{};     ///< the same where frequencies are computed alone
  int left{};                  ///< designs that had none without shapes
  double sum_of_mass{};        ///< largest difference of a direction's Σφ², relative
  int labels{};                ///< modes whose labels differ
  std::string different{};     ///< the first of them

  /// Designs with the same axes, all with gravity or all without; each in lanes beside the others.
  void add(const study::LaneKernels& kernels, std::span<const LaneDesign> all) {
    auto lanes = lanes_for(kernels, all.front());
    for (std::size_t first = 0; first < all.size(); first += lanes.lanes()) {
      const auto now = all.subspan(first, std::min<std::size_t>(lanes.lanes(), all.size() - first));
      for (std::size_t k = 0; k < now.size(); ++k) lanes.put(static_cast<int>(k), now[k].numbers());
      lanes.solve(static_cast<int>(now.size()));
      for (std::size_t k = 0; k < now.size(); ++k) compare(now[k], lanes, static_cast<int>(k));
      lanes.solve_frequencies(static_cast<int>(now.size()));
      for (std::size_t k = 0; k < now.size(); ++k)
        compare_without_shapes(now[k], lanes, static_cast<int>(k));
    }
  }

 private:
  using Models = std::array<dynamics::LinearModel, 2>;

  static std::optional<Models> alone_models(const LaneDesign& design) {
    try {
      return Models{
          dynamics::linear_model(design.machine, design.X_BP(), design.kind),
          dynamics::linear_model(design.machine, design.X_BP(), dynamics::ModelKind::rigid)};
    } catch (const base::ComputationError&) {
      return {};
    }
  }

  /// From mode k to the next one outside of its group, of the largest ω².
  static double distance(const modal::NormalModes& modes, int k) {
    double least = 1.0;
    for (int other = 0; other < modes.size(); ++other)
      if (modes.group[other] != modes.group[k])
        least = std::min(least, std::abs(modes.omega2[other] - modes.omega2[k]) /
                                    modes.omega2[modes.size() - 1]);
    return least;
  }

  static double difference(const dynamics::ModelMatrix& found,
                           const dynamics::ModelMatrix& expected) {
    const dynamics::ModelVector scale = expected.diagonal().cwiseAbs().cwiseSqrt();
    return ((found - expected).array() / (scale * scale.transpose()).array()).abs().maxCoeff();
  }

  void compare(const LaneDesign& design, const study::LaneDesigns& lanes, int lane) {
    ++designs;
    const auto models = alone_models(design);
    impossible += models ? 0 : 1;
    if (!lanes.sound(lane)) {
      ++alone;
      return;
    }
    ASSERT_TRUE(models) << "an equilibrium that one at a time does not find";
    const auto& [model, rigid_model] = *models;
    const auto expected = modal::normal_modes(model);
    EXPECT_EQ(lanes.outputs(lane).least <= 0.0, expected.omega2[0] <= 0.0);
    if (expected.omega2[0] <= 0.0) {
      ++buckled;
      return;
    }
    mass = std::max(mass, difference(lanes.mass(lane), model.M));
    stiffness = std::max(stiffness, difference(lanes.stiffness(lane), model.K));
    compare_frequencies(lanes.rigid_modes(lane), modal::normal_modes(rigid_model));
    const auto found = lanes.modes(lane);
    compare_frequencies(found, expected);
    compare_shapes(model, found, expected);
  }

  void compare_without_shapes(const LaneDesign& design, const study::LaneDesigns& lanes, int lane) {
    std::array<double, study::most_modes> omega2{};
    if (!lanes.frequencies(lane, omega2.data())) {
      ++left;
      return;
    }
    const auto models = alone_models(design);
    ASSERT_TRUE(models) << "an equilibrium that one at a time does not find";
    const auto expected = modal::normal_modes(models->front());
    if (expected.omega2[0] > 0.0)
      for (int k = 0; k < expected.size(); ++k)
        without_shapes = std::max(
            without_shapes,
            std::abs(std::sqrt(omega2[static_cast<std::size_t>(k)] / expected.omega2[k]) - 1.0));
    EXPECT_EQ(omega2[0] <= 0.0, expected.omega2[0] <= 0.0);
  }

  void compare_frequencies(const modal::NormalModes& found, const modal::NormalModes& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (int k = 0; k < found.size(); ++k)
      frequency = std::max(frequency, std::abs(found.omega(k) / expected.omega(k) - 1.0));
  }

  void compare_shapes(const dynamics::LinearModel& model, const modal::NormalModes& found,
                      const modal::NormalModes& expected) {
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

/// A machine that nobody would build, at its tilted pose; with `spread` instead one of equal legs
/// whose guide sleeves differ by that.
inline LaneDesign lane_design(Random& random, model::FlexibleAxes axes, dynamics::ModelKind kind,
                              Gravity gravity, std::optional<double> spread = {}) {
  if (!spread) return {random_machine(random, {.axes = axes, .gravity = gravity}), kind};
  auto machine = symmetric_machine(gravity == Gravity::none ? 0.0 : model::standard_gravity);
  machine.flexible_axes = axes;
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.stiffness *= 1.0 + *spread * random.uniform(-1.0, 1.0);
    leg.gimbal_axis = {0.0, 1.0, 0.0};
  }
  return {std::move(machine), kind};
}

}  // namespace hydrapod::test
