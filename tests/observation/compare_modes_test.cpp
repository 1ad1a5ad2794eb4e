/// Who is who among measured and model modes, on measurements made from models.

#include <gmock/gmock.h>

#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "support/run_program.hpp"

namespace hydrapod::observation {
namespace {

using base::two_pi;
using dynamics::ModelKind;
constexpr double nearly = 1e-3;  // the published coordinates are symmetric to their last digit

model::Machine machine_of(const std::string& file, const std::vector<std::string>& overrides = {}) {
  return model::read_machine_file(test::source_file("models/" + file), overrides).machine;
}

/// The six directions of the platform.
std::vector<data::Channel> platform_channels() {
  std::vector<data::Channel> channels;
  for (int d = 0; d < 6; ++d) {
    const auto direction = static_cast<data::Direction>(d + 1);
    channels.push_back({.name = std::string(data::direction_text(direction)),
                        .unit = d < 3 ? "m" : "rad",
                        .direction = direction,
                        .role = data::Role::response});
  }
  return channels;
}

ComparisonFrame frame_of(const model::Machine& machine) {
  return {machine, machine.neutral(), kinematics::mass_center(machine, machine.neutral())};
}

/// What an ideal measurement of `modes` in `channels` gives; `turn` is the phase of the shapes.
data::ModalResults measured(const std::vector<ObservedMode>& modes,
                            const std::vector<data::Channel>& channels,
                            const ComparisonFrame& frame,
                            std::complex<double> turn = std::polar(3.7, 1.1)) {
  data::ModalResults found{.outputs = channels};
  found.from = 0.1;
  found.to = 100.0;
  const Eigen::MatrixXcd map = output_map(channels, frame).cast<std::complex<double>>();
  for (const auto& mode : modes)
    found.modes.push_back({.pole = mode.pole, .shape = turn * (map * mode.motion())});
  return found;
}

std::vector<ObservedMode> model_modes(const model::Machine& machine, ModelKind kind,
                                      Observed observed = Observed::mechanics) {
  return observe(machine, machine.neutral(), kind, observed).modes;
}

bool felt(const ObservedMode& mode, const ComparisonFrame& frame) {
  const auto root = platform_metric(frame.machine, frame.X_BP, frame.machine.platform.mass_center);
  return (root * mode.motion()).squaredNorm() >= modal::local_mode_energy;
}

TEST(CompareModes, AModelIsLikeItself) {
  const auto machine = machine_of("heavy-platform.toml");
  const auto frame = frame_of(machine);
  for (const auto source : {Observed::mechanics, Observed::plant, Observed::system}) {
    auto model = model_modes(machine, ModelKind::guide, source);
    std::vector<ObservedMode> seen;
    for (const auto& mode : model)
      if (felt(mode, frame) && mode.damping_ratio() < 0.3) seen.push_back(mode);
    ASSERT_GE(seen.size(), 6U) << name(source);
    const auto c = compare_modes(measured(seen, platform_channels(), frame), model, frame);
    ASSERT_EQ(c.pairs.size(), seen.size()) << name(source);
    EXPECT_TRUE(c.measured_left.empty());
    for (const auto& pair : c.pairs) {
      EXPECT_NEAR(pair.frequency_difference, 0.0, 1e-12);
      EXPECT_NEAR(pair.damping_difference, 0.0, 1e-12);
      EXPECT_NEAR(pair.mac.value(), 1.0, 1e-9);
    }
  }
}

TEST(CompareModes, StifferOilIsSeenAsSuch) {
  // rigid legs: ω goes with the root of the oil springs' stiffness, shapes stay
  const auto soft = machine_of("zhang-jiang-2021.toml");
  const auto frame = frame_of(soft);
  auto stiff = soft;
  for (auto& leg : stiff.legs) {
    ASSERT_TRUE(leg.oil_spring.stiffness.has_value());
    *leg.oil_spring.stiffness *= 1.21;
  }
  const auto true_modes = model_modes(soft, ModelKind::rigid);
  const auto c = compare_modes(measured(true_modes, platform_channels(), frame),
                               model_modes(stiff, ModelKind::rigid), frame);
  ASSERT_EQ(c.pairs.size(), 6U);
  for (const auto& pair : c.pairs) {
    EXPECT_NEAR(pair.frequency_difference, 1.0 / 1.1 - 1.0, 1e-9);
    EXPECT_GT(pair.mac.value(), 1.0 - 1e-9);
  }
}

TEST(CompareModes, OfRepeatedModesAnyMixIsRight) {
  const auto machine = machine_of("zhang-jiang-2021.toml");
  const auto frame = frame_of(machine);
  const auto model = model_modes(machine, ModelKind::rigid);
  auto mixed = model;
  const auto first = std::adjacent_find(mixed.begin(), mixed.end(), [](auto& a, auto& b) {
    return std::abs(a.pole - b.pole) < nearly * std::abs(a.pole);
  });
  ASSERT_NE(first, mixed.end());
  const Eigen::VectorXcd a = first->shape, b = (first + 1)->shape;
  first->shape = 0.8 * a + 0.6 * b;
  (first + 1)->shape = 0.6 * a - 0.8 * b;
  const auto c = compare_modes(measured(mixed, platform_channels(), frame), model, frame);
  ASSERT_EQ(c.pairs.size(), model.size());
  for (const auto& pair : c.pairs) EXPECT_NEAR(pair.mac.value(), 1.0, 1e-9);
  const auto r = first - mixed.begin();
  EXPECT_LT(c.mac(r, r), 0.8);  // single shapes are not alike, and the matrix says so
}

TEST(CompareModes, WhatHasNoPartnerIsSaid) {
  const auto machine = machine_of("zhang-jiang-2021.toml");
  const auto frame = frame_of(machine);
  const auto model = model_modes(machine, ModelKind::guide);
  std::vector<ObservedMode> seen;
  for (const auto& mode : model)
    if (felt(mode, frame)) seen.push_back(mode);
  const auto lost = seen.back();
  seen.pop_back();
  ObservedMode strange = seen.front();
  strange.pole = std::complex<double>(-0.5, two_pi * 90.0);
  seen.push_back(strange);
  const auto c = compare_modes(measured(seen, platform_channels(), frame), model, frame);
  EXPECT_THAT(c.measured_left, testing::ElementsAre(static_cast<int>(seen.size()) - 1));
  int not_found = 0, not_felt = 0;
  for (const auto& left : c.model_left) {
    const auto& mode = c.model[static_cast<std::size_t>(left.model)];
    if (left.reason == Unpaired::not_found) {
      EXPECT_EQ(mode.pole, lost.pole);
      ++not_found;
    } else {
      EXPECT_EQ(left.reason, Unpaired::not_felt);
      EXPECT_FALSE(felt(mode, frame));
      ++not_felt;
    }
  }
  EXPECT_EQ(not_found, 1);
  EXPECT_GT(not_felt, 0);  // seals alone
}

/// The model is 12 % off: what it puts a little outside of the measured band is measured all the
/// same.
TEST(CompareModes, ModesJustOutsideTheBandHavePartners) {
  const auto machine = machine_of("zhang-jiang-2021.toml");
  const auto frame = frame_of(machine);
  const auto model = model_modes(machine, ModelKind::rigid);
  for (const double factor : {1.12, 1.0 / 1.12}) {
    auto found = measured(model, platform_channels(), frame);
    for (auto& mode : found.modes) mode.pole *= factor;
    found.from = 0.99 * factor * model.front().omega() / two_pi;
    found.to = 1.01 * factor * model.back().omega() / two_pi;
    EXPECT_EQ(compare_modes(found, model, frame).pairs.size(), model.size()) << factor;
  }
}

TEST(CompareModes, ShapesDecideWhereFrequenciesMislead) {
  // the rigid model's z mode moved to where its rz mode is: frequency alone would pair them
  const auto machine = machine_of("zhang-jiang-2021.toml");
  const auto frame = frame_of(machine);
  const auto model = model_modes(machine, ModelKind::rigid);
  auto swapped = model;
  std::vector<std::size_t> single;  // z and rz are not repeated
  for (std::size_t k = 0; k < model.size(); ++k) {
    const bool lonely = std::ranges::count_if(model, [&](const auto& m) {
                          return std::abs(m.pole - model[k].pole) < nearly * m.omega();
                        }) == 1;
    if (lonely) single.push_back(k);
  }
  ASSERT_EQ(single.size(), 2U);
  const double apart = std::log(model[single[1]].omega() / model[single[0]].omega());  // 25 % or so
  ASSERT_LT(apart, 0.35);
  std::swap(swapped[single[0]].shape, swapped[single[1]].shape);
  const auto c = compare_modes(measured(swapped, platform_channels(), frame), model, frame);
  ASSERT_EQ(c.pairs.size(), model.size());
  for (const auto& pair : c.pairs) EXPECT_NEAR(pair.mac.value(), 1.0, 1e-9);
  EXPECT_EQ(c.pairs[single[0]].model, static_cast<int>(single[1]));
  EXPECT_NEAR(c.pairs[single[0]].frequency_difference, std::exp(-apart) - 1.0, 1e-9);
}

TEST(CompareModes, WithoutDirectionsFrequenciesPair) {
  const auto machine = machine_of("heavy-platform.toml");
  const auto frame = frame_of(machine);
  const auto model = model_modes(machine, ModelKind::rigid);
  auto found = measured(model, platform_channels(), frame);
  for (auto& channel : found.outputs) channel.direction = data::Direction::none;
  const auto c = compare_modes(found, model, frame);
  ASSERT_EQ(c.pairs.size(), 6U);
  for (const auto& pair : c.pairs) {
    EXPECT_EQ(pair.measured, pair.model);
    EXPECT_FALSE(pair.mac.has_value());
  }
  EXPECT_TRUE(c.outputs.empty());
}

TEST(OutputMap, IsTheDerivativeOfWhatSensorsShow) {
  const auto machine = machine_of("heavy-platform.toml");
  const auto frame_pose = spatial::displaced(
      machine.neutral(), (spatial::Vector6() << 0.031, -0.02, 0.05, 0.04, -0.03, 0.07).finished());
  const spatial::Vector3 p_PQ(0.21, -0.34, 0.17);
  const ComparisonFrame frame{machine, frame_pose, frame_pose * p_PQ};
  auto channels = platform_channels();
  channels[1].direction = data::Direction::minus_y;
  for (int leg = 1; leg <= 6; ++leg)
    channels.push_back({.name = "l", .unit = "m", .direction = data::leg_direction(leg)});
  channels.push_back({.name = "p", .unit = "Pa", .direction = data::leg_direction(2)});
  const auto map = output_map(channels, frame);
  EXPECT_TRUE(std::isnan(map(12, 0)));
  const spatial::Vector3 p_BC = kinematics::mass_center(machine, frame_pose);
  constexpr double step = 1e-6;
  for (int d = 0; d < 6; ++d) {
    // the motion is that of the mass centre: P's origin goes with it
    const auto moved = [&](double h) {
      const spatial::Vector3 w =
          d < 3 ? spatial::Vector3::Zero() : spatial::Vector3(h * spatial::Vector3::Unit(d - 3));
      const spatial::Matrix3 R = spatial::rotation_from_vector(w);
      spatial::Pose X = frame_pose;
      X.R_BP = R * frame_pose.R_BP;
      X.p_BP = p_BC + R * (frame_pose.p_BP - p_BC);
      if (d < 3) X.p_BP[d] += h;
      return X;
    };
    const spatial::Vector3 point = (moved(step) * p_PQ - moved(-step) * p_PQ) / (2.0 * step);
    const spatial::Vector6 length = (kinematics::leg_lengths(machine, moved(step)) -
                                     kinematics::leg_lengths(machine, moved(-step))) /
                                    (2.0 * step);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(map(i, d), (i == 1 ? -1 : 1) * point[i], 1e-9);
    for (int i = 3; i < 6; ++i) EXPECT_EQ(map(i, d), i == d ? 1.0 : 0.0);
    for (int leg = 0; leg < 6; ++leg) EXPECT_NEAR(map(6 + leg, d), length[leg], 1e-8);
  }
}

TEST(OutputMap, DirectionsOfSeveralPointsAreNotThePlatforms) {
  const auto frame = frame_of(machine_of("heavy-platform.toml"));
  auto channels = platform_channels();
  channels[0].point = 4;
  EXPECT_TRUE(output_map(channels, frame).array().isNaN().all());
}

}  // namespace
}  // namespace hydrapod::observation
