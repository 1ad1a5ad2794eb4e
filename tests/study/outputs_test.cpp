/// Outputs that are computed where they are asked for, the worst over poses, the reach of a map.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/simulation/capability.hpp"
#include "hydrapod/study/design.hpp"
#include "support/run_program.hpp"

namespace hydrapod::study {
namespace {

using testing::HasSubstr;

model::Machine shipped(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return model::read_machine_file(test::source_file("models/" + name).string(), overrides,
                                  kinematics::check_machine)
      .machine;
}

/// The heavy machine, on seals that bear it wherever these tests go.
model::Machine on_stiff_seals() {
  auto machine = shipped("heavy-platform.toml");
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= 21.0;
  return machine;
}

std::vector<Input> displacements(const std::vector<std::string>& names) {
  std::vector<Input> inputs;
  for (const auto& name : names)
    inputs.push_back({.name = name, .unit = name.starts_with('r') ? "rad" : "m"});
  return inputs;
}

std::size_t at(const Problem& problem, const std::string& name) {
  const auto found = std::ranges::find(problem.outputs, name, &Column::name);
  EXPECT_NE(found, problem.outputs.end()) << name;
  return static_cast<std::size_t>(found - problem.outputs.begin());
}

std::vector<double> row_of(const Problem& problem, const std::vector<double>& inputs) {
  std::vector<double> outputs(problem.outputs.size());
  problem.model()(inputs, outputs);
  return outputs;
}

/// By virtual work: K = Σ k (∂l/∂q)(∂l/∂q)ᵀ, with differences of the legs' lengths.
TEST(ExtraOutputs, StiffnessOfRigidLegsIsThatOfTheirOil) {
  const auto machine = shipped("heavy-platform.toml", {"environment.gravity=0"});
  const auto X_BP = machine.neutral();
  const auto problem = machine_problem(machine, displacements({"x", "ry"}),
                                       {.kind = dynamics::ModelKind::rigid,
                                        .X_BP = X_BP,
                                        .also = {"stiffness_x", "stiffness_z", "stiffness_ry"},
                                        .poses = true});
  spatial::Pose moved = X_BP;
  moved.p_BP.x() += 0.037;
  moved.R_BP = spatial::rotation_from_rpy({0.0, 0.021, 0.0}) * moved.R_BP;
  const auto displaced = [&](int d, double h) {
    spatial::Vector3 turn = spatial::Vector3::Zero();
    spatial::Pose pose = moved;
    const spatial::Vector3 p_BC = moved.p_BP + moved.R_BP * machine.platform.mass_center;
    if (d < 3)
      pose.p_BP[d] += h;
    else {
      turn[d - 3] = h;
      const spatial::Matrix3 R = spatial::rotation_from_rpy(turn);
      pose.R_BP = R * moved.R_BP;
      pose.p_BP = p_BC + R * (moved.p_BP - p_BC);
    }
    return kinematics::leg_lengths(machine, pose);
  };
  constexpr double h = 1e-6;
  spatial::Matrix6 slope;
  for (int d = 0; d < 6; ++d) slope.col(d) = (displaced(d, h) - displaced(d, -h)) / (2.0 * h);
  const auto lengths = kinematics::leg_lengths(machine, moved);
  spatial::Matrix6 K = spatial::Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    const auto& leg = machine.legs[static_cast<std::size_t>(i)];
    const double k = hydraulics::axial_spring(leg, lengths[i] - leg.rod.length).stiffness;
    K += k * slope.row(i).transpose() * slope.row(i);
  }
  const spatial::Matrix6 compliance = K.inverse();
  const auto row = row_of(problem, {0.037, 0.021});
  ASSERT_EQ(row[0], 0.0);
  for (const auto& [name, d] :
       {std::pair{"stiffness_x", 0}, {"stiffness_z", 2}, {"stiffness_ry", 4}})
    EXPECT_NEAR(row[at(problem, name)] * compliance(d, d), 1.0, 1e-7) << name;
}

/// Seals that creep hold with their slow stiffness, whatever that of fast motion is.
TEST(ExtraOutputs, StiffnessIsThatOfSealsThatHaveRelaxed) {
  const auto plain = shipped("zhang-jiang-2021-transverse.toml", {"environment.gravity=9.81"});
  auto creeping = plain;
  for (auto& leg : creeping.legs)
    leg.guide_sleeve.elastomer =
        model::Elastomer{.dynamic_ratio = 2.17, .loss_factor = 0.23, .frequency = 6.3};
  const auto stiffness = [&](const model::Machine& machine) {
    const auto problem = machine_problem(machine, displacements({"y", "z"}),
                                         {.kind = dynamics::ModelKind::guide,
                                          .X_BP = machine.neutral(),
                                          .also = {"stiffness_y"},
                                          .poses = true});
    return row_of(problem, {0.013, -0.021})[at(problem, "stiffness_y")];
  };
  EXPECT_NEAR(stiffness(creeping) / stiffness(plain), 1.0, 1e-9);
}

/// Near the load that buckles them, legs on soft seals hold less across than stiff ones would.
TEST(ExtraOutputs, StiffnessFallsTowardsBuckling) {
  const auto stiffness = [](const model::Machine& machine) {
    const auto problem = machine_problem(machine, displacements({"x", "y"}),
                                         {.kind = dynamics::ModelKind::guide,
                                          .X_BP = machine.neutral(),
                                          .also = {"stiffness_x"},
                                          .poses = true});
    return row_of(problem, {0.0, 0.0})[at(problem, "stiffness_x")];
  };
  EXPECT_LT(stiffness(shipped("heavy-platform.toml")), 0.8 * stiffness(on_stiff_seals()));
}

TEST(ExtraOutputs, AreThoseOfCapabilityAndOfDesigns) {
  const auto machine = shipped("heavy-platform.toml");
  const auto kind = dynamics::ModelKind::guide;
  const auto problem = machine_problem(machine, displacements({"x", "z"}),
                                       {.kind = kind,
                                        .X_BP = machine.neutral(),
                                        .also = {"acceleration_y", "sag", "buckling", "unknown"},
                                        .poses = true});
  const auto row = row_of(problem, {0.0, 0.0});
  const auto found = simulation::capability(machine, machine.neutral(), kind, false);
  ASSERT_TRUE(found.has_value());
  const auto of = [&](int sense) {
    return found->of(simulation::Ability::acceleration, 1, sense).value;
  };
  EXPECT_EQ(row[at(problem, "acceleration_y")], std::min(of(0), of(1)));
  EXPECT_NEAR(row[at(problem, "sag")], 3.42e-3, 5e-6);  // as `hydrapod check` prints it
  EXPECT_EQ(problem.outputs.back().name, "acceleration_y");
  const auto beyond = row_of(problem, {3.0, 0.0});
  EXPECT_EQ(beyond[0], static_cast<double>(Status::out_of_reach));
  for (const char* name : {"acceleration_y", "sag", "buckling"})
    EXPECT_TRUE(std::isnan(beyond[at(problem, name)])) << name;
}

/// In lanes, alone and under another pose's rows: the same bits.
TEST(ExtraOutputs, AreTheSameInBatches) {
  const auto machine = on_stiff_seals();
  const auto problem = machine_problem(machine, displacements({"x", "rz"}),
                                       {.kind = dynamics::ModelKind::guide,
                                        .X_BP = machine.neutral(),
                                        .also = {"stiffness_x", "oil_force"},
                                        .poses = true});
  std::vector<std::vector<double>> inputs, outputs;
  std::vector<Row> rows;
  for (int k = 0; k < 13; ++k) {
    inputs.push_back({0.011 * (k - 6), 0.017 * (k % 5)});
    outputs.emplace_back(problem.outputs.size());
  }
  for (std::size_t k = 0; k < inputs.size(); ++k) rows.push_back({inputs[k], outputs[k]});
  problem.batch()(rows);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const auto alone = row_of(problem, inputs[k]);
    for (const char* name : {"stiffness_x", "oil_force"}) {
      EXPECT_TRUE(std::isfinite(alone[at(problem, name)]));
      EXPECT_EQ(outputs[k][at(problem, name)], alone[at(problem, name)]);
    }
  }
}

/// Against every pose, one by one.
TEST(WorstOver, IsTheWorstOfAllCombinations) {
  const auto machine = on_stiff_seals();
  auto inputs = displacements({"x", "z", "rx", "rz"});
  inputs[2].distribution = {.shape = Shape::values, .list = {-0.031, 0.0, 0.043}};
  inputs[3].distribution = {.shape = Shape::values, .list = {-0.05, 0.02}};
  const auto all = machine_problem(machine, inputs,
                                   {.kind = dynamics::ModelKind::guide,
                                    .X_BP = machine.neutral(),
                                    .also = {"sag", "stiffness_x"},
                                    .poses = true});
  const auto worst = worst_over(all, 2);
  ASSERT_EQ(worst.inputs.size(), 2U);
  ASSERT_EQ(worst.outputs.size(), all.outputs.size());
  for (const double x : {-0.02, 0.013}) {
    const auto row = row_of(worst, {x, 0.007});
    ASSERT_EQ(row[0], 0.0);
    double lowest = 1e9, drop = -1e9, share = 0.0, sag = 0.0, stroke = 1e9;
    std::vector<double> of_lowest;
    for (const double rx : inputs[2].distribution.list)
      for (const double rz : inputs[3].distribution.list) {
        const auto one = row_of(all, {x, 0.007, rx, rz});
        if (one[at(all, "lowest")] < lowest) of_lowest = {x, 0.007, rx, rz};
        if (one[at(all, "drop")] > drop) share = one[at(all, "share")];
        lowest = std::min(lowest, one[at(all, "lowest")]);
        drop = std::max(drop, one[at(all, "drop")]);
        sag = std::max(sag, one[at(all, "sag")]);
        stroke = std::min(stroke, one[at(all, "stroke")]);
      }
    constexpr double rounding = 1e-9;  // in lanes, and alone
    EXPECT_NEAR(row[at(worst, "lowest")], lowest, rounding * lowest);
    EXPECT_NEAR(row[at(worst, "drop")], drop, rounding);
    EXPECT_NEAR(row[at(worst, "share")], share, rounding);
    EXPECT_EQ(row[at(worst, "sag")], sag);
    EXPECT_EQ(row[at(worst, "stroke")], stroke);
    const auto place =
        worst_row(worst, std::vector{x, 0.007}, static_cast<int>(at(worst, "lowest")));
    ASSERT_TRUE(place.has_value());
    EXPECT_EQ(std::vector(place->begin(), place->begin() + 4), of_lowest);
    EXPECT_EQ((*place)[4 + at(all, "lowest")], row[at(worst, "lowest")]);
  }
  EXPECT_FALSE(worst_row(all, std::vector{0.0, 0.0, 0.0, 0.0}, 1).has_value());
}

/// One of them out of reach: the pose is none of the workspace; what stroke it lacks is there.
TEST(WorstOver, HasNoValueWhereAPoseIsOutOfReach) {
  const auto machine = shipped("heavy-platform.toml");
  auto inputs = displacements({"x", "z"});
  inputs[1].distribution = {.shape = Shape::values, .list = {0.0, 2.1}};
  const auto all = machine_problem(
      machine, inputs,
      {.kind = dynamics::ModelKind::guide, .X_BP = machine.neutral(), .poses = true});
  ASSERT_EQ(row_of(all, {0.01, 0.0})[0], 0.0);
  const auto row = row_of(worst_over(all, 1), {0.01});
  EXPECT_EQ(row[0], static_cast<double>(Status::out_of_reach));
  EXPECT_TRUE(std::isnan(row[at(all, "lowest")]));
  EXPECT_EQ(row[at(all, "stroke")], row_of(all, {0.01, 2.1})[at(all, "stroke")]);
}

/// A paraboloid with its extremes off the grid, in lanes of nothing: the search comes within a
/// thousandth of a step.
TEST(WorstBetween, IsFoundOffTheGrid) {
  Problem problem{.inputs = displacements({"x", "y"}), .outputs = {{"bowl", "1", ""}}};
  problem.inputs[0].distribution.list = {-0.7, -0.4, -0.1, 0.3, 0.6};
  problem.inputs[1].distribution.list = {-1.0, -0.2, 0.1, 0.9};
  problem.batch = []() -> BatchModel {
    return [](std::span<const Row> rows) {
      for (const auto& row : rows)
        row.outputs[0] = 5.0 + std::pow(row.inputs[0] - 0.137, 2) +
                         2.3 * std::pow(row.inputs[1] + 0.061, 2) +
                         0.8 * (row.inputs[0] - 0.137) * (row.inputs[1] + 0.061);
      return std::size_t{0};
    };
  };
  const auto row_value = [&](double x, double y) {
    const std::vector inputs{x, y};
    std::vector<double> outputs(1);
    const Row row{inputs, outputs};
    problem.batch()({&row, 1});
    return outputs[0];
  };
  const auto least = worst_between(problem, std::vector{0.3, -0.2}, row_value(0.3, -0.2), 0);
  ASSERT_TRUE(least.has_value());
  EXPECT_NEAR(least->inputs[0], 0.137, 1e-3);
  EXPECT_NEAR(least->inputs[1], -0.061, 1e-3);
  EXPECT_NEAR(least->value, 5.0, 1e-6);
  problem.outputs[0].worse = Worse::more;  // the largest value is at a corner of the grid
  EXPECT_FALSE(
      worst_between(problem, std::vector{-0.7, -1.0}, row_value(-0.7, -1.0), 0).has_value());
}

/// A disc: its area lies between the cells that are whole in it and those that are in part.
TEST(Reach, EnclosesAKnownArea) {
  const double radius = 0.73;
  Problem problem{.inputs = displacements({"x", "y"}),
                  .outputs = {{"status", "1", ""}},
                  .model =
                      [=] {
                        return [=](std::span<const double> x, std::span<double> y) {
                          y[0] = std::hypot(x[0] - 0.1, x[1]) <= radius
                                     ? 0.0
                                     : static_cast<double>(Status::out_of_reach);
                        };
                      },
                  .status = 0};
  constexpr int count = 201;
  const double length[] = {2.4, 1.9};
  for (std::size_t k = 0; k < 2; ++k) {
    auto& d = problem.inputs[k].distribution;
    d.shape = Shape::values;
    for (int i = 0; i < count; ++i) d.list.push_back(length[k] * (i / (count - 1.0) - 0.5));
  }
  const Plan plan{
      .design = Design::grid, .samples = std::uint64_t{count} * count, .counts = {count, count}};
  const auto path = (std::filesystem::temp_directory_path() / "hydrapod-reach.rows").string();
  run(problem, plan, {.spool = path, .threads = 1});
  const auto reach = summarise(Spool({path}), problem, plan, {}, {.reached = true}).reached;
  std::filesystem::remove(path);
  ASSERT_TRUE(reach.has_value());
  const double area = std::numbers::pi * radius * radius;
  EXPECT_LT(reach->least, area);
  EXPECT_GT(reach->most, area);
  EXPECT_GT(reach->least, 0.97 * area);
  EXPECT_LT(reach->most, 1.03 * area);
  EXPECT_NEAR(reach->whole, length[0] * length[1], 1e-11);  // a sum of 40 000 cells
  EXPECT_EQ(reach->unit, "m^2");
}

}  // namespace
}  // namespace hydrapod::study
