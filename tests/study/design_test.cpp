/// Designs against brute force, bisection and differences of optima; their derivatives.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/study/design.hpp"
#include "support/random_machine.hpp"
#include "support/run_program.hpp"

namespace hydrapod::study {
namespace {

using dynamics::ModelKind;

model::MachineFile published(const std::string& gravity) {
  return model::read_machine_file(
      test::source_file("models/zhang-jiang-2021-transverse.toml").string(),
      {"environment.gravity=" + gravity}, kinematics::check_machine);
}

Input change(const model::MachineFile& file, const std::string& path, double from, double to) {
  const auto number = find_number(file, path);
  return {.name = path,
          .unit = number->unit,
          .distribution = {.shape = Shape::uniform, .a = from, .b = to},
          .id = number->id};
}

struct Asked {
  std::vector<std::string> want{};
  std::vector<std::pair<std::string, bool>> aims{};  ///< and whether to maximise
};

DesignProblem problem_of(const model::MachineFile& file, std::vector<Input> changes,
                         std::vector<model::NamedPose> poses, const Asked& asked) {
  DesignProblem problem{.machine = file.machine,
                        .kind = ModelKind::guide,
                        .poses = std::move(poses),
                        .changes = std::move(changes)};
  problem.outputs = design_outputs(problem);
  for (const auto& text : asked.want)
    problem.requirements.push_back(read_requirement(text, problem.outputs, text));
  for (const auto& [name, maximise] : asked.aims) {
    Aim aim{.text = name, .name = name, .maximise = maximise};
    for (std::size_t k = 0; k < problem.changes.size(); ++k)
      if (problem.changes[k].name == name) aim.change = static_cast<int>(k);
    for (std::size_t k = 0; k < problem.outputs.size(); ++k)
      if (problem.outputs[k].name == name) aim.output = static_cast<int>(k);
    EXPECT_TRUE(aim.change >= 0 || aim.output >= 0) << name;
    problem.aims.push_back(aim);
  }
  return problem;
}

model::NamedPose moved(const model::Machine& machine, double z, double x) {
  auto X_BP = machine.neutral();
  X_BP.p_BP += spatial::Vector3(x, 0.0, z);
  return {.name = fmt::format("x {} z {}", x, z), .X_BP = X_BP};
}

/// First resonance in direction d, from modes alone [Hz].
double first_resonance(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                       int d) {
  const auto modes = modal::normal_modes(dynamics::linear_model(machine, X_BP, kind));
  const double all = modes.shapes.row(d).squaredNorm();
  for (int k = 0; k < modes.size(); ++k)
    if (std::pow(modes.shapes(d, k), 2) >= 0.05 * all) return modes.omega(k) / base::two_pi;
  return std::numeric_limits<double>::quiet_NaN();
}

/// Softest seals for a band of frequencies at three poses under gravity, against 60 × 60 designs.
TEST(Design, IsNoWorseThanAnyDesignOfAGrid) {
  const auto file = published("9.81");
  const auto& machine = file.machine;
  const std::vector<model::NamedPose> poses{moved(machine, 0.0, 0.0), moved(machine, 0.03, 0.0),
                                            moved(machine, 0.0, 0.04)};
  constexpr double soft = 1.3e5, stiff = 2.3e6, light = 731.0, heavy = 1137.0;
  const auto problem = problem_of(file,
                                  {change(file, "legs.guide_sleeve.stiffness", soft, stiff),
                                   change(file, "platform.mass", light, heavy)},
                                  poses,
                                  {.want = {"x >= 6.1 Hz", "drop_x <= 4 %", "z <= 22.9 Hz"},
                                   .aims = {{"legs.guide_sleeve.stiffness", false}}});
  const auto found = design(problem, {.samples = 300, .starts = 3, .threads = 2});
  ASSERT_TRUE(found.best.feasible);
  EXPECT_FALSE(found.interrupted);
  const auto by_one_thread = design(problem, {.samples = 300, .starts = 3, .threads = 1});
  EXPECT_EQ(by_one_thread.best.values, found.best.values);

  // feasible by another way: modes of the machine itself
  const auto designed = machine_of(machine, problem.changes, found.best.values);
  constexpr double rounding = 1e-9;
  for (const auto& pose : poses)
    EXPECT_GE(first_resonance(designed, pose.X_BP, ModelKind::guide, 0), 6.1 * (1.0 - rounding));

  std::vector<int> columns;
  for (const auto& wanted : problem.requirements) columns.push_back(wanted.output);
  std::vector<DesignModel> models;
  for (const auto& pose : poses) models.emplace_back(problem, pose, columns);
  constexpr int steps = 60;
  const double ratio = std::pow(stiff / soft, 1.0 / steps);
  int feasible = 0;
  double best = 2.0 * stiff;
  std::vector<double> outputs(problem.outputs.size());
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= steps; ++j) {
      const std::vector<double> values{soft * std::pow(ratio, i),
                                       light + (heavy - light) * j / steps};
      bool met = true;
      for (auto& model : models) {
        model.outputs(values, outputs);
        met = met && outputs[0] == 0.0 && outputs[columns[0]] >= 6.1 &&
              outputs[columns[1]] <= 0.04 && outputs[columns[2]] <= 22.9;
      }
      if (!met) continue;
      ++feasible;
      best = std::min(best, values[0]);
    }
  ASSERT_GT(feasible, 20);
  ASSERT_LT(feasible, steps * steps * 9 / 10);
  EXPECT_LE(found.best.aims[0], best);
  EXPECT_GT(found.best.aims[0], best / ratio / ratio) << "better than believable";
}

/// One number, one frequency: the bound is a root, found by bisection over modes.
TEST(Design, EndsWhereTheRequirementIsMetExactly) {
  const auto file = published("0");
  const auto problem = problem_of(file, {change(file, "platform.mass", 613.0, 1409.0)},
                                  {moved(file.machine, 0.031, 0.017)},
                                  {.want = {"z >= 21.3 Hz"}, .aims = {{"platform.mass", true}}});
  const auto found = design(problem, {.samples = 64, .starts = 2});
  ASSERT_TRUE(found.best.feasible);
  double low = 613.0, high = 1409.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    auto machine = file.machine;
    machine.platform.mass = middle;
    (first_resonance(machine, problem.poses[0].X_BP, ModelKind::guide, 2) >= 21.3 ? low : high) =
        middle;
  }
  ASSERT_GT(low, 620.0);
  ASSERT_LT(low, 1400.0);
  constexpr double reserve_and_steps = 1e-7;
  EXPECT_NEAR(found.best.aims[0], low, reserve_and_steps * low);
  EXPECT_LE(found.best.aims[0], low * (1.0 + 1e-12));
  ASSERT_EQ(found.limits.size(), 1U);
  EXPECT_EQ(found.limits[0].kind, Limit::Kind::requirement);
}

/// The price of a requirement against the optimum of a requirement a little different.
TEST(Design, StatesThePriceOfARequirement) {
  const auto file = published("0");
  const auto optimum = [&](double bound) {
    const auto problem = problem_of(
        file,
        {change(file, "platform.mass", 413.0, 1409.0),
         change(file, "legs.oil_spring.stiffness", 2.8e6, 4.9e6)},
        {moved(file.machine, 0.0, 0.0), moved(file.machine, 0.05, 0.02)},
        {.want = {fmt::format("z >= {:.12g} Hz", bound)}, .aims = {{"platform.mass", true}}});
    return design(problem, {.samples = 100, .starts = 2});
  };
  const auto at = optimum(24.7);
  ASSERT_TRUE(at.best.feasible);
  if (at.best.aims[0] > 1408.0) FAIL() << "the requirement limits nothing";
  constexpr double step = 1e-3;
  const double slope =
      (optimum(24.7 + step).best.aims[0] - optimum(24.7 - step).best.aims[0]) / (2.0 * step);
  double price = 0.0;
  bool at_upper_bound = false;
  for (const auto& limit : at.limits) {
    if (limit.kind == Limit::Kind::requirement) price += limit.price.value();
    at_upper_bound = at_upper_bound || limit.kind == Limit::Kind::upper_bound;
  }
  EXPECT_TRUE(at_upper_bound) << "stiffer oil would carry more";
  EXPECT_NEAR(price, slope, 2e-3 * std::abs(slope));
}

/// Under gravity, softer seals shift the first resonance in rz from 18.1 Hz to a seal mode at 3.6
/// Hz at once, where the share of that mode exceeds 5 %. The design ends there; so does bisection.
TEST(Design, EndsAtAJumpAndSaysSo) {
  const auto file = published("9.81");
  const auto problem =
      problem_of(file, {change(file, "legs.guide_sleeve.stiffness", 1.23e5, 2.3e6)},
                 {moved(file.machine, 0.0, 0.0)},
                 {.want = {"rz >= 15 Hz"}, .aims = {{"legs.guide_sleeve.stiffness", false}}});
  const auto rz = [&](double stiffness) {
    auto machine = file.machine;
    for (auto& leg : machine.legs) leg.guide_sleeve.stiffness = stiffness;
    return first_resonance(machine, problem.poses[0].X_BP, ModelKind::guide, 5);
  };
  double low = 1.23e5, high = 2.3e6;
  ASSERT_LT(rz(low), 4.0);
  ASSERT_GT(rz(high), 17.0);
  for (int k = 0; k < 60; ++k) {
    const double middle = std::sqrt(low * high);
    (rz(middle) >= 15.0 ? high : low) = middle;
  }
  const auto found = design(problem, {.samples = 200, .starts = 3});
  ASSERT_TRUE(found.best.feasible);
  constexpr double finest = 1e-7;
  EXPECT_NEAR(found.best.aims[0], high, finest * high);
  EXPECT_GE(found.best.aims[0], high * (1.0 - 1e-9));
  ASSERT_EQ(found.limits.size(), 1U);
  EXPECT_EQ(found.limits[0].kind, Limit::Kind::jump);
  EXPECT_EQ(found.limits[0].requirement, 0);
  EXPECT_FALSE(found.limits[0].price.has_value());
  EXPECT_NEAR(found.limits[0].beyond, rz(low), 1e-2);
}

/// The distance of the machine from numbers at which it is zero: its least is there, and within a
/// circle about them the largest mass is at its rim. Where it is unknown no design may be.
TEST(Design, TakesOutputsOfOnesOwn) {
  const auto file = published("0");
  const auto changes = std::vector{change(file, "legs.guide_sleeve.stiffness", 2.3e5, 2.3e6),
                                   change(file, "platform.mass", 731.0, 1137.0)};
  constexpr double k_0 = 1.37e6, m_0 = 893.0, rim = 0.23;
  DesignProblem problem{.machine = file.machine,
                        .kind = ModelKind::guide,
                        .poses = {moved(file.machine, 0.0, 0.0), moved(file.machine, 0.02, 0.0)},
                        .changes = changes};
  std::atomic<int> calls = 0;
  const auto distance = [&](std::span<const double> values, const model::NamedPose& pose) {
    ++calls;
    if (values[1] > 1100.0) throw base::ComputationError("too heavy for the crane");
    const double off = pose.name == problem.poses[1].name ? 0.0 : 0.011;  // there it is less
    return std::hypot(values[0] / k_0 - 1.0, values[1] / m_0 - 1.0) - off;
  };
  problem.own = {{.column = {"mode of transport", "1", "distance"}, .of = distance},
                 {.column = {"not wanted", "1", ""}, .of = [](auto, const auto&) -> double {
                    throw std::logic_error("not asked for");
                  }}};
  problem.outputs = design_outputs(problem);
  EXPECT_EQ(problem.outputs[problem.outputs.size() - 2].name, "mode of transport");
  const int own = static_cast<int>(problem.outputs.size()) - 2;
  problem.aims = {{.text = "nearest", .name = "mode of transport", .output = own}};
  const auto nearest = design(problem, {.samples = 200, .starts = 2});
  ASSERT_TRUE(nearest.best.computed);
  EXPECT_NEAR(nearest.best.values[0], k_0, 1e-4 * k_0);
  EXPECT_NEAR(nearest.best.values[1], m_0, 1e-4 * m_0);
  EXPECT_GT(calls, 200);

  problem.requirements = {{.text = "within", .output = own, .bound = rim}};
  problem.aims = {{.text = "heaviest", .name = "platform.mass", .maximise = true, .change = 1}};
  const auto heaviest = design(problem, {.samples = 200, .starts = 2});
  ASSERT_TRUE(heaviest.best.feasible);
  EXPECT_NEAR(heaviest.best.values[1], m_0 * (1.0 + rim), 1e-4 * m_0);
  EXPECT_EQ(heaviest.best.pose[0], 1) << "the pose where it is farther";

  problem.own[0].column.name = "platform.mass";
  EXPECT_THROW(design_outputs(problem), base::InputError);
  problem.own[0].column.name = "drop_rz";
  EXPECT_THROW(design_outputs(problem), base::InputError);
}

TEST(Design, SaysHowFarWhatCannotBeMetCanCome) {
  const auto file = published("0");
  const auto problem = problem_of(
      file, {change(file, "platform.mass", 813.0, 1011.0)}, {moved(file.machine, 0.0, 0.0)},
      {.want = {"z >= 40 Hz", "drop <= 50 %"}, .aims = {{"platform.mass", true}}});
  const auto found = design(problem, {.samples = 64, .starts = 2});
  EXPECT_FALSE(found.best.feasible);
  ASSERT_EQ(found.reach.size(), 2U);
  auto lightest = file.machine;
  lightest.platform.mass = 813.0;
  EXPECT_FALSE(found.reach[0].enough);
  EXPECT_NEAR(found.reach[0].value,
              first_resonance(lightest, problem.poses[0].X_BP, ModelKind::guide, 2), 1e-9);
  EXPECT_TRUE(found.reach[1].enough);
  EXPECT_TRUE(found.front.empty());
  EXPECT_TRUE(found.limits.empty());
}

/// No design of a grid is better than the curve in both aims.
TEST(Design, TradeOffIsAFront) {
  const auto file = published("9.81");
  const auto problem = problem_of(file,
                                  {change(file, "legs.guide_sleeve.stiffness", 1.4e5, 2.3e6),
                                   change(file, "platform.mass", 751.0, 1103.0)},
                                  {moved(file.machine, 0.0, 0.0), moved(file.machine, 0.02, 0.03)},
                                  {.aims = {{"lowest", true}, {"platform.mass", true}}});
  const auto found = design(problem, {.samples = 200, .starts = 2, .front = 6});
  ASSERT_GE(found.front.size(), 5U);
  for (std::size_t k = 1; k < found.front.size(); ++k) {
    EXPECT_GT(found.front[k].aims[0], found.front[k - 1].aims[0]);
    EXPECT_LT(found.front[k].aims[1], found.front[k - 1].aims[1]);
  }
  const int lowest = problem.aims[0].output;
  std::vector<DesignModel> models;
  for (const auto& pose : problem.poses) models.emplace_back(problem, pose, std::vector{lowest});
  std::vector<double> outputs(problem.outputs.size());
  constexpr int steps = 30;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= steps; ++j) {
      const std::vector<double> values{1.4e5 * std::pow(2.3e6 / 1.4e5, i / double{steps}),
                                       751.0 + (1103.0 - 751.0) * j / steps};
      double hertz = 1e9;
      for (auto& model : models) {
        model.outputs(values, outputs);
        hertz = outputs[0] == 0.0 ? std::min(hertz, outputs[lowest]) : 0.0;
        if (hertz == 0.0) break;
      }
      for (const auto& point : found.front)
        EXPECT_FALSE(hertz > point.aims[0] * (1.0 + 1e-6) &&
                     values[1] > point.aims[1] * (1.0 + 1e-6))
            << hertz << " Hz with " << values[1] << " kg beats " << point.aims[0] << " Hz with "
            << point.aims[1] << " kg";
    }
}

/// Derivatives of modes against central differences of the outputs.
TEST(DesignModel, DerivativesAreThoseOfTheOutputs) {
  test::Random random(2117);
  int compared = 0;
  for (int machine = 0; machine < 12; ++machine) {
    model::MachineFile file;
    file.machine = test::random_machine(
        random, {.gravity = machine % 2 == 0 ? test::Gravity::none : test::Gravity::down});
    const auto& pose = file.machine.poses.back();
    const double mass = file.machine.platform.mass;
    const double seal = file.machine.legs[0].guide_sleeve.stiffness;
    auto problem = problem_of(file,
                              {change(file, "platform.mass", 0.5 * mass, 2.0 * mass),
                               change(file, "leg.1.guide_sleeve.stiffness", 0.5 * seal, 2 * seal)},
                              {pose}, {});
    std::vector<int> wanted;
    for (const char* name : {"lowest", "drop", "x", "rz", "drop_y", "mode3"})
      for (std::size_t k = 0; k < problem.outputs.size(); ++k)
        if (problem.outputs[k].name == name) wanted.push_back(static_cast<int>(k));
    ASSERT_EQ(wanted.size(), 6U);
    DesignModel model(problem, pose, wanted);
    const std::vector<double> values{mass, seal};
    const std::size_t width = problem.outputs.size();
    std::vector<double> outputs(width), above(width), below(width);
    model.outputs(values, outputs);
    if (outputs[0] != 0.0) continue;
    const auto derivatives = model.derivatives(values, outputs);
    for (std::size_t j = 0; j < 2; ++j) {
      auto moved = values;
      const double h = 1e-5 * values[j];
      moved[j] = values[j] + h;
      model.outputs(moved, above);
      moved[j] = values[j] - h;
      model.outputs(moved, below);
      for (std::size_t k = 0; k < wanted.size(); ++k) {
        const auto column = static_cast<std::size_t>(wanted[k]);
        if (!derivatives.of_mode[k]) continue;
        const double slope = (above[column] - below[column]) / (2.0 * h);
        // rounding of the frequencies over the step, and the third derivative
        const double scale = std::max(std::abs(outputs[column]), 1.0) / values[j];
        EXPECT_NEAR(
            derivatives.by_change(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j)),
            slope, 1e-5 * scale)
            << problem.outputs[column].name << " of machine " << machine;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 80);
}

}  // namespace
}  // namespace hydrapod::study
