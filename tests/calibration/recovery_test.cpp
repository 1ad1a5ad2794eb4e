/// Machines whose numbers are known come back from their own modes; what cannot come back is said.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/base/error.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "recovery.hpp"
#include "support/run_program.hpp"

namespace hydrapod::calibration {
namespace {

using namespace observation;

using dynamics::ModelKind;
using testing::Contains;
using testing::HasSubstr;

/// Ten machines, three seeds of noise each; the long test has a hundred seeds.
TEST(Recovery, IntervalsHoldTheTruthAsOftenAsTheyPromise) {
  test::Coverage coverage;
  for (std::uint64_t machine = 1; machine <= 10; ++machine)
    for (std::uint64_t noise = 1; noise <= 3; ++noise)
      test::recover(machine, noise, false, coverage);
  EXPECT_THAT(coverage.wrongly, testing::IsEmpty());
  ASSERT_GE(coverage.determined, 150);
  // the numbers of one fit err together: 30 fits are some 30 independent trials, and 0.95 of them
  // less three standard deviations is 0.83
  EXPECT_GE(coverage.held, 0.87 * coverage.determined)
      << coverage.held << " of " << coverage.determined;
  // squares of 30 independent trials at least: a mean of 1 with a deviation of no more than 0.26;
  // intervals that are half as wide again as they should be have 0.44
  EXPECT_NEAR(coverage.squares / coverage.determined, 1.0, 2.0 * 0.26);
}

/// The published machine with transverse axes, and labels where a mode has a direction.
model::MachineFile transverse_machine() {
  return test::machine_file(
      test::read_text(test::source_file("models/zhang-jiang-2021-transverse.toml")));
}

Targets targets_of(const model::MachineFile& file, ModelKind kind, bool labels) {
  Targets targets;
  targets.modes = test::modes_of(file, "neutral", kind);
  if (!labels)
    for (auto& mode : targets.modes) mode.direction.reset();
  return targets;
}

Candidate fit(const model::MachineFile& file, const Targets& targets,
              const std::vector<FreeParameter>& free, ModelKind kind, int starts) {
  Plan plan{.free = free};
  plan.options.starts = starts;
  return calibrate(file, targets, plan, kind).best();
}

/// At the start rz (184 rad/s) lies above z (143), in the targets below (112).
TEST(Recovery, ModesThatCrossOnTheWayKeepTheirNames) {
  const auto targets = targets_of(transverse_machine(), ModelKind::rigid, true);
  const auto start = test::machine_file(transverse_machine().text, {"platform.inertia.zz=17.3"});
  const auto best =
      fit(start, targets, test::free_paths({"platform.inertia.zz"}), ModelKind::rigid, 1);
  EXPECT_NEAR(best.parameters[0].value, 54.5344, 1e-6);
}

/// Elastomers make the damped frequencies others than the undamped ones, by up to a tenth here.
/// Targets with the damped frequencies, as `modes` prints them, give the planted ratio. Targets
/// with the undamped frequencies give another one.
TEST(Recovery, SealsThatAreElastomersComeBackFromTheirDampedModes) {
  test::Random random(77);
  const auto text = test::random_machine_text(random, false);
  const auto elastomer = [&](double ratio) {
    return test::machine_file(text,
                              {fmt::format("legs.guide_sleeve.elastomer.dynamic_ratio={}", ratio),
                               "legs.guide_sleeve.elastomer.loss_factor=0.43",
                               "legs.guide_sleeve.elastomer.frequency=6.3 Hz"});
  };
  const auto truth = elastomer(2.63);
  const auto table =
      modal::mode_table(truth.machine, truth.machine.neutral(), dynamics::ModelKind::guide);
  Targets damped, undamped;
  for (std::size_t k = 0; k < table.real.modes.size(); ++k) {
    const auto& mode = table.real.modes[k];
    Eigen::Index direction = 0;
    if (mode.energy.platform.maxCoeff(&direction) < 0.3 || mode.mode.damping_ratio > 0.5) continue;
    ModeTarget target{.name = mode.label,
                      .pose = "neutral",
                      .omega = mode.mode.omega,
                      .deviation = 1e-4 * mode.mode.omega};
    target.direction = static_cast<int>(direction);
    damped.modes.push_back(target);
    target.omega = table.real.normal.omega(static_cast<int>(k));
    undamped.modes.push_back(target);
  }
  ASSERT_GE(damped.modes.size(), 5U);
  const auto ratio = [&](const Targets& targets) {
    return fit(elastomer(2.1), targets,
               test::free_paths({"legs.guide_sleeve.elastomer.dynamic_ratio"}), ModelKind::guide, 3)
        .parameters[0]
        .value;
  };
  EXPECT_NEAR(ratio(damped), 2.63, 1e-5);
  EXPECT_GT(std::abs(ratio(undamped) - 2.63), 1e-3);
}

/// Dampers of the seals put |λ| of the lowest mode 0.13 % above the undamped frequency.
TEST(Recovery, DampedFrequenciesAsTheyAreListedGiveThePlantedBulkModulus) {
  const std::string path = "legs.oil_spring.cylinder.bulk_modulus";
  const auto text = test::read_text(test::source_file("models/heavy-platform.toml"));
  const auto truth = test::machine_file(text, {path + "=1.43e9"});
  const auto table =
      modal::mode_table(truth.machine, truth.machine.neutral(), dynamics::ModelKind::guide);
  Targets targets;
  for (const auto& mode : table.real.modes) {
    Eigen::Index direction = 0;
    if (mode.energy.platform.maxCoeff(&direction) < 0.3) continue;
    targets.modes.push_back({.name = mode.label,
                             .omega = mode.mode.omega,
                             .damped = true,
                             .deviation = 1e-4 * mode.mode.omega,
                             .direction = static_cast<int>(direction)});
  }
  ASSERT_GE(targets.modes.size(), 4U);
  const auto found = [&] {
    return fit(test::machine_file(text, {path + "=1.21e9"}), targets, test::free_paths({path}),
               ModelKind::guide, 1)
        .parameters[0]
        .value;
  };
  EXPECT_NEAR(found(), 1.43e9, 1e-7 * 1.43e9);
  for (auto& mode : targets.modes) mode.damped = false;
  EXPECT_GT(std::abs(found() - 1.43e9), 1e-3 * 1.43e9);
}

/// Without names the squares have a valley at the crossing; other starts find the way out of it.
TEST(Recovery, ModesWithoutNamesGetOutOfAWrongValley) {
  const auto targets = targets_of(transverse_machine(), ModelKind::rigid, false);
  const auto start = test::machine_file(transverse_machine().text, {"platform.inertia.zz=17.3"});
  const auto best =
      fit(start, targets, test::free_paths({"platform.inertia.zz"}), ModelKind::rigid, 8);
  EXPECT_NEAR(best.parameters[0].value, 54.5344, 1e-6);
}

/// x and y are one frequency at the start and two in the targets: one leg has softer oil.
TEST(Recovery, ARepeatedPairPartsTowardsItsTargets) {
  const auto truth =
      test::machine_file(transverse_machine().text, {"leg.2.oil_spring.stiffness=2.9e6"});
  const auto targets = targets_of(truth, ModelKind::guide, false);
  const auto best = fit(transverse_machine(), targets,
                        test::free_paths({"leg.2.oil_spring.stiffness"}), ModelKind::guide, 1);
  EXPECT_NEAR(best.parameters[0].value, 2.9e6, 1.0);
  EXPECT_EQ(best.parameters[0].verdict, Verdict::determined);
}

TEST(Recovery, ShapesAndDampingsAreMetToo) {
  const auto truth = test::machine_file(
      transverse_machine().text,
      {"platform.mass_center[0]=0.031", "legs.oil_spring.damping=4321", "damping.modal_ratio=0"});
  const auto model =
      dynamics::linear_model(truth.machine, truth.machine.neutral(), ModelKind::rigid);
  const auto modes = modal::normal_modes(model);
  Targets targets = targets_of(truth, ModelKind::rigid, true);
  for (int k = 0; k < 6; ++k) {
    targets.modes[k].shape = -3.7 * modes.shapes.col(k).head<6>();
    targets.modes[k].shape_deviation = 0.05;
    targets.modes[k].damping =
        modal::modal_damping_matrix(model, modes, 0.0)(k, k) / (2.0 * modes.omega(k));
    targets.modes[k].damping_deviation = 1e-3;
  }
  const auto start = test::machine_file(
      transverse_machine().text,
      {"platform.mass_center[0]=0.002", "legs.oil_spring.damping=900", "damping.modal_ratio=0"});
  std::vector<FreeParameter> free = test::free_paths({"legs.oil_spring.damping"});
  free.push_back({.paths = {"platform.mass_center[0]"}, .lower = "-0.1", .upper = "0.1"});
  const auto best = fit(start, targets, free, ModelKind::rigid, 1);
  EXPECT_NEAR(best.parameters[0].value, 4321.0, 1e-2);
  EXPECT_NEAR(best.parameters[1].value, 0.031, 1e-7);
  // of two repeated modes, not quite at right angles, a little is kept out (pairing.hpp)
  for (const auto& target : best.targets) EXPECT_NEAR(target.shape_mac, 1.0, 1e-5);
}

/// Damping ratios tell the leakage past the pistons where the linear models have chambers; without
/// them leakage is refused.
TEST(Recovery, OfLeakageByDampingRatios) {
  const auto text = transverse_machine().text;
  const auto truth = test::machine_file(
      text, {"damping.oil=chambers", "legs.leakage.internal=6.3e-12", "damping.modal_ratio=0"});
  const auto model =
      dynamics::linear_model(truth.machine, truth.machine.neutral(), ModelKind::rigid);
  const auto modes = modal::normal_modes(model);
  Targets targets = targets_of(truth, ModelKind::rigid, true);
  for (int k = 0; k < 6; ++k) {
    targets.modes[k].damping =
        modal::relaxed_damping(model.arms, modes.shapes.col(k), modes.omega(k)) /
        (2.0 * modes.omega(k));
    targets.modes[k].damping_deviation = 1e-4;
    EXPECT_GT(*targets.modes[k].damping, 1e-3);
  }
  const auto start = test::machine_file(
      text, {"damping.oil=chambers", "legs.leakage.internal=1.7e-12", "damping.modal_ratio=0"});
  const auto best =
      fit(start, targets, test::free_paths({"legs.leakage.internal"}), ModelKind::rigid, 1);
  EXPECT_NEAR(best.parameters[0].value, 6.3e-12, 1e-17);
  EXPECT_EQ(best.parameters[0].verdict, Verdict::determined);

  const auto viscous =
      test::machine_file(text, {"damping.oil=viscous", "legs.leakage.internal=1.7e-12"});
  EXPECT_THROW(
      fit(viscous, targets, test::free_paths({"legs.leakage.internal"}), ModelKind::rigid, 1),
      base::InputError);
}

/// Shapes of the platform frame's origin tell where the mass centre is, though it is not theirs.
TEST(Recovery, ShapesMayBeThoseOfAnyPoint) {
  const auto truth =
      test::machine_file(transverse_machine().text,
                         {"platform.mass_center[0]=0.031", "platform.mass_center[1]=-0.017"});
  const auto model =
      dynamics::linear_model(truth.machine, truth.machine.neutral(), ModelKind::rigid);
  const auto modes = modal::normal_modes(model);
  Targets targets = targets_of(truth, ModelKind::rigid, true);
  const spatial::Vector3 point(0.21, 0.11, -0.07);
  for (int k = 0; k < 6; ++k) {
    Vector6 shape = modes.shapes.col(k).head<6>();
    const spatial::Vector3 arm = model.X_BP * point - model.p_BC;
    shape.head<3>() += spatial::Vector3(shape.tail<3>()).cross(arm);
    targets.modes[k].shape = shape;
    targets.modes[k].shape_deviation = 0.02;
    targets.modes[k].shape_point = point;
    targets.modes[k].deviation = 0.05 * targets.modes[k].omega;  // the shapes decide
  }
  const auto start =
      test::machine_file(transverse_machine().text,
                         {"platform.mass_center[0]=0.002", "platform.mass_center[1]=0.003"});
  std::vector<FreeParameter> free{
      {.paths = {"platform.mass_center[0]"}, .lower = "-0.1", .upper = "0.1"},
      {.paths = {"platform.mass_center[1]"}, .lower = "-0.1", .upper = "0.1"}};
  const auto best = fit(start, targets, free, ModelKind::rigid, 1);
  EXPECT_NEAR(best.parameters[0].value, 0.031, 1e-4);
  EXPECT_NEAR(best.parameters[1].value, -0.017, 1e-4);
}

TEST(Recovery, AWrongTargetIsNamedAndLeftOut) {
  auto targets = targets_of(transverse_machine(), ModelKind::guide, true);
  targets.modes[14].omega *= 1.17;
  const auto start = test::machine_file(
      transverse_machine().text, {"legs.oil_spring.stiffness=5e6", "platform.inertia.xx=70",
                                  "platform.inertia.yy=70", "legs.guide_sleeve.stiffness=2e5"});
  const auto free = test::free_paths({"legs.oil_spring.stiffness", "platform.inertia.xx",
                                      "platform.inertia.yy", "legs.guide_sleeve.stiffness"});
  Plan plan{.free = free};
  const auto result = calibrate(start, targets, plan, ModelKind::guide);
  const auto& best = result.best();
  for (int k = 0; k < 18; ++k) EXPECT_EQ(best.targets[k].outlier, k == 14) << k;
  EXPECT_NEAR(best.parameters[0].value, 3.85353e6, 400.0);
  EXPECT_NEAR(best.parameters[3].value, 1.5732e5, 20.0);
  EXPECT_THAT(report::calibration_remarks(result, targets),
              Contains(HasSubstr("target neutral 15 does not fit the others")));
}

TEST(Recovery, FewerTargetsThanParametersLeaveDirectionsOpen) {
  Targets targets = targets_of(transverse_machine(), ModelKind::rigid, true);
  targets.modes.resize(2);
  const auto start =
      test::machine_file(transverse_machine().text, {"legs.oil_spring.stiffness=5e6"});
  const auto free =
      test::free_paths({"legs.oil_spring.stiffness", "platform.mass", "platform.inertia.zz"});
  Plan plan{.free = free};
  const auto result = calibrate(start, targets, plan, ModelKind::rigid);
  const auto& best = result.best();
  EXPECT_LT(best.misfit, 1e-8);
  EXPECT_EQ(best.identifiability.numerical_rank, 1);  // x and y are one and the same here
  for (const auto& p : best.parameters) EXPECT_EQ(p.verdict, Verdict::undetermined);
  EXPECT_THAT(report::calibration_remarks(result, targets),
              Contains(HasSubstr("3 parameters are free, but there are only 2 targets")));
}

/// Oil in the lines and the rod's mass both ride on the piston; z alone cannot tell them apart.
TEST(Recovery, OnlyASumIsDeterminedAndSaidToBe) {
  const auto file = test::machine_file(transverse_machine().text, {"legs.added_axial_inertia=1.3"});
  Targets targets = targets_of(file, ModelKind::rigid, true);
  std::erase_if(targets.modes, [](const ModeTarget& t) { return t.direction != 2; });
  ASSERT_EQ(targets.modes.size(), 1U);
  const auto start =
      test::machine_file(transverse_machine().text, {"legs.added_axial_inertia=2.6"});
  const auto best =
      fit(start, targets, test::free_paths({"legs.added_axial_inertia", "platform.mass"}),
          ModelKind::rigid, 1);
  ASSERT_EQ(best.identifiability.trades.size(), 1U);
  // Σ (n·z)² of six legs at 0.783/0.8734 kg of platform per kg on a piston
  const double share = 6.0 * std::pow(0.783 / 0.8734095285480141, 2);
  EXPECT_THAT(
      best.identifiability.trades[0].words,
      HasSubstr(fmt::format("only legs.added_axial_inertia + {:.3g} platform.mass is determined",
                            1.0 / share)));
}

TEST(Recovery, TargetsThatCannotBeMetAreSaidToBe) {
  Targets targets = targets_of(transverse_machine(), ModelKind::rigid, true);
  for (std::size_t k = 0; k < 6; ++k) targets.modes[k].omega *= k % 2 == 0 ? 1.4 : 0.7;
  Plan plan{.free = test::free_paths({"legs.oil_spring.stiffness"})};
  const auto result = calibrate(transverse_machine(), targets, plan, ModelKind::rigid);
  EXPECT_THAT(report::calibration_remarks(result, targets),
              Contains(testing::ContainsRegex(
                  "the targets cannot be met: target .* is .* Hz or .* σ from its mode")));
}

TEST(Recovery, APriorThatDecidesIsNamed) {
  const auto targets = targets_of(transverse_machine(), ModelKind::guide, true);
  auto free = test::free_paths({"legs.case.mass", "legs.case.transverse_inertia"});
  free[0].prior = PriorAmounts{"6.6 kg", "300 g"};
  Plan plan{.free = free};
  const auto result = calibrate(transverse_machine(), targets, plan, ModelKind::guide);
  const auto& mass = result.best().parameters[0];
  EXPECT_EQ(mass.verdict, Verdict::by_prior);
  EXPECT_NEAR(mass.value, 6.6, 0.01);
  EXPECT_NEAR(mass.deviation, 0.3, 0.003);
  EXPECT_THAT(report::calibration_remarks(result, targets),
              Contains(HasSubstr("legs.case.mass: determined by its prior, not by the data")));
}

TEST(Recovery, AProfileRisesAsTheLikelihoodSays) {
  const auto targets = targets_of(transverse_machine(), ModelKind::guide, true);
  Plan plan{.free = test::free_paths({"legs.oil_spring.stiffness", "legs.guide_sleeve.stiffness"})};
  const auto best = calibrate(transverse_machine(), targets, plan, ModelKind::guide).best();
  const auto curve = profile(transverse_machine(), targets, plan, ModelKind::guide, best, 0);
  const auto& p = best.parameters[0];
  // nearly a parabola here, so that the profile's interval is the linear one
  EXPECT_NEAR(curve.interval_low, p.interval_low, 0.01 * p.deviation);
  EXPECT_NEAR(curve.interval_high, p.interval_high, 0.01 * p.deviation);
}

/// Where the data tell their own scatter, the profile counts in it.
TEST(Recovery, AProfileCountsInTheScatterOfTheData) {
  auto targets = targets_of(transverse_machine(), ModelKind::guide, true);
  targets.deviations_given = false;
  test::Random random(59);
  for (auto& mode : targets.modes) {
    mode.deviation = observation::default_deviation * mode.omega;
    mode.omega *= 1.0 + 0.3 * observation::default_deviation * test::normal(random);
  }
  Plan plan{.free = test::free_paths({"legs.oil_spring.stiffness", "legs.guide_sleeve.stiffness"})};
  plan.options.loss = Loss::squares;
  const auto best = calibrate(transverse_machine(), targets, plan, ModelKind::guide).best();
  EXPECT_NEAR(best.scatter, 0.3, 0.15);
  const auto curve = profile(transverse_machine(), targets, plan, ModelKind::guide, best, 0);
  const auto& p = best.parameters[0];
  EXPECT_NEAR(curve.interval_low, p.value - 1.96 * p.deviation, 0.05 * p.deviation);
  EXPECT_NEAR(curve.interval_high, p.value + 1.96 * p.deviation, 0.05 * p.deviation);
}

/// With nothing else to fit, the profile is the misfit itself; a bound may be where it ends.
TEST(Recovery, TheOnlyParameterHasAProfileToo) {
  const auto targets = targets_of(transverse_machine(), ModelKind::rigid, true);
  Plan plan{.free = {{.paths = {"legs.oil_spring.stiffness"}, .lower = "3.9e6", .upper = "9e6"},
                     {.paths = {"platform.mass"}}}};
  plan.free[0].start = "5e6";
  auto best = calibrate(transverse_machine(), targets, plan, ModelKind::rigid).best();
  EXPECT_EQ(best.parameters[0].verdict, Verdict::at_bound);
  EXPECT_EQ(profile(transverse_machine(), targets, plan, ModelKind::rigid, best, 1).points.size(),
            21U);
  plan.free = {{.paths = {"legs.oil_spring.stiffness"}}};
  plan.free[0].prior = PriorAmounts{"3.86e6", "1e3"};
  best = calibrate(transverse_machine(), targets, plan, ModelKind::rigid).best();
  const auto curve = profile(transverse_machine(), targets, plan, ModelKind::rigid, best, 0);
  const auto& p = best.parameters[0];
  EXPECT_NEAR(curve.interval_low, p.interval_low, 0.02 * p.deviation);  // the prior is in both
  EXPECT_NEAR(curve.interval_high, p.interval_high, 0.02 * p.deviation);
}

/// Without names, nobody can say which of two frequencies is about x and which about y.
TEST(Recovery, SaysSoWhereTwoValuesMeetTheTargetsAlike) {
  const auto file = test::machine_file(transverse_machine().text, {"platform.inertia.yy=70"});
  Targets targets = targets_of(file, ModelKind::rigid, false);
  Plan plan{.free = test::free_paths({"platform.inertia.xx", "platform.inertia.yy"})};
  const auto result = calibrate(file, targets, plan, ModelKind::rigid);
  const auto& xx = result.best().parameters[0];
  ASSERT_EQ(xx.verdict, Verdict::ambiguous) << xx.value;  // rx and ry may change places
  EXPECT_NEAR(std::min(xx.value, *xx.other_value), 45.1022, 0.02);
  EXPECT_NEAR(std::max(xx.value, *xx.other_value), 70.0, 0.02);
}

/// A search that is stopped at once says so, and not that the machine has no modes.
TEST(Recovery, AnInterruptedSearchNamesWhatItDidNotTry) {
  const auto targets = targets_of(transverse_machine(), ModelKind::rigid, true);
  Plan plan{.free = test::free_paths({"legs.oil_spring.stiffness"})};
  plan.options.threads = 1;
  plan.alternatives = {{.name = "axes", .choices = {{"a", {}}, {"b", {}}}}};
  int calls = 0;
  const auto result = calibrate(transverse_machine(), targets, plan, ModelKind::rigid,
                                [&](double) { return ++calls > 3; });
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(result.candidates.back().problem, "interrupted before its first fit");
}

/// Threads share the work out as they come; the answer must not show it.
TEST(Recovery, DoesNotDependOnTheNumberOfThreads) {
  const auto targets = targets_of(transverse_machine(), ModelKind::guide, true);
  const auto start =
      test::machine_file(transverse_machine().text, {"legs.oil_spring.stiffness=5e6"});
  Plan plan{.free = test::free_paths({"legs.oil_spring.stiffness", "legs.case.mass"})};
  plan.options.threads = 1;
  const auto one = calibrate(start, targets, plan, ModelKind::guide);
  plan.options.threads = 3;
  const auto three = calibrate(start, targets, plan, ModelKind::guide);
  EXPECT_EQ(report::calibration_json(one, targets).dump(),
            report::calibration_json(three, targets).dump());
}

/// `change` on a plan, and what is said of it.
void expect_refused(const FreeParameter& free, const std::string& what) {
  Targets targets = targets_of(transverse_machine(), ModelKind::rigid, true);
  Plan plan{.free = {free}};
  try {
    calibrate(transverse_machine(), targets, plan, ModelKind::rigid);
    FAIL() << "accepted: " << what;
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.diagnostics().front().message, HasSubstr(what));
  }
}

TEST(Refusals, SayWhatIsWrongWithAParameter) {
  expect_refused({.paths = {"legs.rod.mas"}}, "did you mean `legs.rod.mass`?");
  expect_refused({.paths = {"legs.rod.mass"}, .lower = "5 kg", .upper = "2 kg"},
                 "the lowest value, 5, is not below the highest, 2 kg");
  expect_refused({.paths = {"legs.rod.mass"}, .lower = "5 kg", .upper = "9 kg"},
                 "starts at 1.62 kg, which is not within its bounds [5, 9]");
  expect_refused({.paths = {"legs.rod.mass"}, .start = "2 m"}, "start: ");
  expect_refused({.paths = {"legs.rod.mass", "legs.rod.length"}}, "cannot be tied to one value");
  expect_refused({.paths = {"legs.rod.mass", "legs.rod.mass"}}, "is free twice");
  expect_refused({.paths = {"platform.mass_center[0]"}}, "starts at 0");
  expect_refused({.paths = {"legs.rod.mass"}, .lower = "nan", .upper = "9 kg"},
                 "bounds: is nan, expected a finite number");
  expect_refused({.paths = {"legs.rod.mass"}, .prior = PriorAmounts{"2 kg", "0 kg"}},
                 "expected a spread above 0");
}

TEST(Refusals, NameAPoseOrAModelThatTheTargetsDoNotFit) {
  Targets targets = targets_of(transverse_machine(), ModelKind::rigid, true);
  Plan plan{.free = test::free_paths({"legs.rod.mass"})};
  const auto message_of = [&] {
    try {
      calibrate(transverse_machine(), targets, plan, ModelKind::rigid);
    } catch (const base::InputError& error) {
      return error.diagnostics().front().message;
    }
    return std::string{};
  };
  targets.modes[3].pose = "raised";
  EXPECT_THAT(message_of(), HasSubstr("the machine has no pose \"raised\""));
  targets = targets_of(transverse_machine(), ModelKind::guide, true);
  EXPECT_THAT(message_of(), HasSubstr("18 targets at pose \"neutral\", but the rigid model has 6"));
  targets.modes.clear();
  EXPECT_THAT(message_of(), HasSubstr("no targets"));
}

}  // namespace
}  // namespace hydrapod::calibration
