/// Planted faults are found from the modes they make; where there is none, none is named.

#include "hydrapod/diagnosis/diagnose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blind_series.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::diagnosis {
namespace {

using dynamics::ModelKind;
using test::BlindCase;
using testing::HasSubstr;

/// The machine as its owner believes it to be, with sleeves like steel.
const std::vector<std::string> stiff{"legs.guide_sleeve.stiffness=20 kN/mm"};

Diagnosis of(const std::vector<std::string>& fault, double noise = 1e-3,
             const std::vector<std::string>& poses = {"neutral"}) {
  return test::run_blind({.machine = "heavy-platform.toml",
                          .design = stiff,
                          .fault = fault,
                          .poses = poses,
                          .noise = noise})
      .diagnosis;
}

/// Is the hypothesis called so among those that the data cannot tell from the best?
bool named(const Diagnosis& d, const std::string& name) {
  return std::ranges::any_of(
      d.equivalent, [&](auto k) { return report::hypothesis_name(d, d.hypotheses[k]) == name; });
}

model::MachineFile stiff_file() {
  return test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")),
                            stiff);
}

observation::Targets measured(const std::vector<std::string>& fault) {
  auto overrides = stiff;
  overrides.insert(overrides.end(), fault.begin(), fault.end());
  test::Random random(97);
  return test::noisy_modes(
      test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")),
                         overrides)
          .machine,
      {"neutral"}, ModelKind::guide, {}, random);
}

Diagnosis diagnosis_of(const observation::Targets& targets) {
  const auto file = stiff_file();
  return diagnose(file, targets, ModelKind::guide, file.machine.poses);
}

/// The seals that the rigid-leg model has are beyond any measurement: their modes are no
/// prediction.
TEST(Diagnose, RigidSealsPredictNoMode) {
  const auto d = of({"legs.guide_sleeve.stiffness=0.84 kN/mm"});
  int rigid = 0;
  for (const auto& e : d.hypotheses) {
    if (!e.rigid) continue;
    ++rigid;
    for (const auto& wrong : e.wrong) EXPECT_LT(wrong.omega, base::two_pi * 200.0);
  }
  EXPECT_EQ(rigid, 1);
}

/// Modes of the nominal machine at another pose than they state: the pose is named, no part.
TEST(Diagnose, NamesThePoseAtWhichTheNominalMachineHasTheModes) {
  const auto file = stiff_file();
  test::Random random(41);
  auto targets = test::noisy_modes(file.machine, {"low"}, ModelKind::guide, {}, random);
  for (auto& mode : targets.modes) mode.pose = "neutral";
  const auto d = diagnose(file, targets, ModelKind::guide, file.machine.poses);
  EXPECT_EQ(d.nominal_at, std::vector<std::string>{"low"});
  EXPECT_THAT(report::note_words(d),
              testing::Contains("the measured modes are those of the nominal machine at pose low; "
                                "check the pose, which is stated as neutral"));
}

/// One frequency that the machine cannot have, and one mode that is written down twice.
TEST(Diagnose, NamesTheModeThatDoesNotBelongToTheOthers) {
  auto targets = measured({});
  targets.modes[1].omega *= 1.7;
  const auto d = diagnosis_of(targets);
  EXPECT_TRUE(d.equivalent.empty());
  EXPECT_EQ(d.odd_mode, 2);
  EXPECT_TRUE(d.nominal_at.empty());
  EXPECT_THAT(report::note_words(d),
              testing::Contains(HasSubstr("the nominal machine explains the measurement; check "
                                          "this mode")));
  auto twice = measured({});
  twice.modes.push_back(twice.modes.front());
  twice.modes[1].omega *= 1.3;
  EXPECT_THAT(report::note_words(diagnosis_of(twice)),
              testing::Contains(HasSubstr("is listed twice (modes 1 and ")));
  const auto good = diagnosis_of(measured({}));
  EXPECT_EQ(good.odd_mode, 0);
  EXPECT_TRUE(good.nominal_at.empty());
}

/// Seals made rigid: what is measured is the rigid machine.
TEST(Diagnose, BlamesNothingWhereNothingIsWrong) {
  const auto d =
      test::run_blind({.machine = "heavy-platform.toml", .design = stiff, .kind = ModelKind::rigid})
          .diagnosis;
  EXPECT_EQ(d.finding, Finding::nothing_to_blame);
  EXPECT_EQ(d.scatter, 1.0);
}

/// The frequency of rz asks for more moment of inertia about z than about x and y together, which
/// no body has.
TEST(Diagnose, ListsTheCausesThatWereNotTested) {
  const auto file =
      test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")));
  observation::Targets targets{.deviations_given = true};
  for (const auto& [hertz, direction] :
       {std::pair{6.112, 0}, std::pair{6.118, 1}, std::pair{7.371, 4}, std::pair{7.567, 3},
        std::pair{5.5, 5}, std::pair{8.940, 2}}) {
    const double omega = base::two_pi * hertz;
    targets.modes.push_back({.name = direction_name(direction),
                             .pose = "neutral",
                             .omega = omega,
                             .deviation = 1e-3 * omega,
                             .direction = direction});
  }
  const auto d = diagnose(file, targets, ModelKind::rigid, file.machine.poses);
  const auto name = [&](const Untested& one) {
    return report::hypothesis_name(d, {.causes = one.causes});
  };
  const auto is_inertia = [&](const Untested& one) { return name(one) == "platform inertia"; };
  EXPECT_EQ(test::find(d, "platform inertia"), nullptr);
  const auto inertia = std::ranges::find_if(d.untested, is_inertia);
  ASSERT_NE(inertia, d.untested.end());
  EXPECT_FALSE(inertia->error.empty());
  for (const auto& one : d.untested)  // nothing else is to be said of pairs with it
    EXPECT_TRUE(one.causes.size() == 1 ||
                std::ranges::count(one.causes, inertia->causes.front()) == 0)
        << name(one);
  EXPECT_THAT(report::note_words(d),
              testing::Contains(testing::AllOf(testing::StartsWith("not tested: platform inertia"),
                                               testing::EndsWith(": " + inertia->error))));
  EXPECT_THAT(report::summary({.diagnosis = d}),
              testing::Contains(testing::StartsWith("Not tested: platform inertia")));
  test::expect_round_trip_of({.diagnosis = d});
  for (const auto& one : diagnosis_of(measured({})).untested) ADD_FAILURE() << one.error;
}

/// A file that states its soft sleeves explains the drop by itself.
TEST(Diagnose, SaysThatAMachineIsAsStated) {
  const auto d =
      test::run_blind({.machine = "heavy-platform.toml", .design = {}, .poses = {"neutral"}})
          .diagnosis;
  EXPECT_EQ(d.finding, Finding::nominal);
}

TEST(Diagnose, FindsSoftGuideSleevesAndHowSoftTheyAre) {
  const auto d = of({"legs.guide_sleeve.stiffness=0.84 kN/mm"});
  ASSERT_EQ(d.finding, Finding::identified);
  EXPECT_EQ(report::hypothesis_name(d, d.best()), "guide sleeves of all legs");
  const auto& k_s = d.best().fit.parameters[0];
  EXPECT_NEAR(k_s.value, 0.84e6, 0.01e6);
  EXPECT_LE(k_s.interval_low, 0.84e6);
  EXPECT_GE(k_s.interval_high, 0.84e6);
  // the resonances in x come from the sleeves, and others are told why not
  EXPECT_GT(d.modes[0].guide_sleeves, 0.9);
  const auto* oil = test::find(d, "bulk modulus of the oil");
  ASSERT_NE(oil, nullptr);
  ASSERT_FALSE(oil->wrong.empty());
  const auto* mass = test::find(d, "payload (platform mass)");
  ASSERT_NE(mass, nullptr);
  EXPECT_THAT(report::contradiction_words(d, *mass), testing::Contains(HasSubstr("were measured")));
}

/// Guide sleeves and piston rings, each for its own resonance.
TEST(Diagnose, TellsWhichResonanceComesFromSleevesAndWhichFromRings) {
  const auto d = test::run_blind({.machine = "zhang-jiang-2021.toml",
                                  .fault = {"legs.piston_ring.stiffness=3 kN/mm"},
                                  .kind = ModelKind::full})
                     .diagnosis;
  ASSERT_EQ(d.finding, Finding::identified);
  EXPECT_EQ(report::hypothesis_name(d, d.best()), "piston rings of all legs");
  EXPECT_NEAR(d.best().fit.parameters[0].value, 3e6, 0.05e6);
  int of_sleeves = 0, of_rings = 0;
  for (const auto& mode : d.modes) {
    if (mode.guide_sleeves > 0.5) {
      ++of_sleeves;
      EXPECT_NEAR(mode.omega / (2.0 * std::numbers::pi), 8.3, 0.2);
    }
    if (mode.piston_rings > 0.5) {
      ++of_rings;
      EXPECT_NEAR(mode.omega / (2.0 * std::numbers::pi), 274.0, 3.0);
    }
  }
  EXPECT_GE(of_sleeves, 2);
  EXPECT_GE(of_rings, 2);
  EXPECT_THAT(report::summary({.diagnosis = d}),
              testing::Contains(HasSubstr("From the piston rings come")));
}

TEST(Diagnose, TellsWhatOilCannotExplain) {
  // pushed sideways the base lowers x and y alone; the oil that would do so lowers z as well
  const auto d = of({"base.mount.stiffness.x=80 kN/mm", "base.mount.stiffness.y=80 kN/mm"});
  EXPECT_TRUE(named(d, "lateral compliance of the base"));
  const auto* oil = test::find(d, "bulk modulus of the oil");
  ASSERT_NE(oil, nullptr);
  EXPECT_THAT(report::contradiction_words(d, *oil),
              testing::Contains(testing::MatchesRegex("predicts z at .* lower than measured")));
}

TEST(Diagnose, FindsTheOilAndSaysHowToTellItFromTheGimbals) {
  const auto d = of({"legs.oil_spring.cylinder.bulk_modulus=0.9 GPa"}, 5e-4);
  EXPECT_TRUE(named(d, "bulk modulus of the oil"));
  EXPECT_FALSE(named(d, "guide sleeves of all legs"));
  EXPECT_EQ(d.discriminators.size() + 1, d.equivalent.size());
  test::expect_round_trip_of({.diagnosis = d});
  // the rigid calculation is that of the owner, who does not know of his oil
  const auto machine = stiff_file().machine;
  const auto rigid =
      modal::normal_modes(linear_model(machine, machine.neutral(), ModelKind::rigid));
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(d.modes[k].omega_rigid, rigid.omega(static_cast<int>(k)), 1e-9);
    EXPECT_GT(d.modes[k].rigid_mac, 0.9);
  }
  const std::string drop = fmt::format("{:.0f} %", 100.0 * d.modes[0].drop());
  EXPECT_THAT(report::summary({.diagnosis = d}),
              testing::Contains(AllOf(HasSubstr("At pose neutral the "), HasSubstr("x and y"),
                                      HasSubstr(drop + " below the rigid-leg model"))));
}

/// The largest MAC of the platform's motions in the modes at the two frequencies.
double motion_alike(const model::Machine& a, double omega_a, const model::Machine& b,
                    double omega_b, const spatial::Pose& X_BP) {
  const auto linear_a = linear_model(a, X_BP, ModelKind::guide),
             linear_b = linear_model(b, X_BP, ModelKind::guide);
  const auto in_a = modal::normal_modes(linear_a), in_b = modal::normal_modes(linear_b);
  const auto& M = linear_a.platform_mass;
  double best = 0.0;
  for (int i = 0; i < in_a.shapes.cols(); ++i)
    for (int k = 0; k < in_b.shapes.cols(); ++k) {
      if (std::abs(in_a.omega(i) / omega_a - 1.0) > 1e-3) continue;
      if (std::abs(in_b.omega(k) / omega_b - 1.0) > 1e-3) continue;
      const spatial::Vector6 u = in_a.shapes.col(i).head<6>(), v = in_b.shapes.col(k).head<6>();
      const double product = u.dot(M * v);
      best = std::max(best, product * product / (u.dot(M * u) * v.dot(M * v)));
    }
  return best;
}

/// With seals as soft as these there are modes of seals and of the platform in every direction.
TEST(Diagnose, WhatToMeasureNextIsOneResonanceOfBothHypotheses) {
  const auto text = model::starter_machine_file();
  const std::string air = "legs.oil_spring.cylinder.air={fraction=0.0113, pressure=\"71 bar\"}";
  std::vector<std::string> stated{air}, fault{air, "legs.oil_spring.cylinder.air.fraction=0.049"};
  const auto file = test::machine_file(text, stated);
  test::Random random(11);
  const auto targets = test::noisy_modes(test::machine_file(text, fault).machine, {"neutral"},
                                         ModelKind::guide, {.frequency = 1e-3}, random);
  const auto d = diagnose(file, targets, ModelKind::guide, file.machine.poses);
  ASSERT_EQ(d.finding, Finding::undecided) << test::verdict(d);
  ASSERT_FALSE(d.discriminators.empty());
  for (const auto& x : d.discriminators)
    EXPECT_GT(motion_alike(machine_of(file, d.hypotheses[d.equivalent.front()]), x.omega_best,
                           machine_of(file, d.hypotheses[x.other]), x.omega_other,
                           find_pose(file.machine, x.pose)->X_BP),
              0.5)
        << x.omega_best << " and " << x.omega_other << " at " << x.pose;
  // each of the two frequencies is off by the error of the model
  const double error = DiagnoseOptions{}.frequency_error;
  constexpr double rounding = 1e-11;  // of two logarithms, over that error
  double most = 0.0;
  for (const auto& x : d.discriminators) {
    const double apart = std::abs(std::log(x.omega_best) - std::log(x.omega_other));
    EXPECT_NEAR(x.deviations, apart / std::hypot(error, error), rounding);
    most = std::max(most, x.deviations);
  }
  EXPECT_GT(most, 0.1);
}

TEST(Diagnose, FindsOneLeg) {
  EXPECT_TRUE(named(of({"leg.5.oil_spring.cylinder.bulk_modulus=0.7 GPa"}), "oil spring of leg 5"));
}

/// Alone platform mass and inertia explain most of it; its best pair leads to the one planted.
TEST(Diagnose, FindsAPairOfWhichNeitherExplainsMostAlone) {
  const BlindCase planted{
      .machine = "zhang-jiang-2021.toml",
      .fault = {"leg.2.oil_spring.stiffness=2.117 N/um", "leg.6.oil_spring.stiffness=2.311 N/um"},
      .repetition = 17};
  const auto file = test::machine_file(planted.text(), {});
  const auto targets = test::by_noise(planted, test::machine_file(planted.text(), planted.fault));
  const auto d = diagnose(file, targets, ModelKind::guide, file.machine.poses, {.strongest = 1});
  const auto single = std::ranges::find_if(d.hypotheses, [&](const auto& e) {
    return e.causes.size() == 1 && d.causes[e.causes.front()].in_pairs();
  });
  EXPECT_EQ(report::hypothesis_name(d, *single), "platform mass and inertia");
  EXPECT_EQ(report::hypothesis_name(d, d.hypotheses[d.equivalent.at(0)]),
            "oil spring of leg 2 and oil spring of leg 6");
}

TEST(Diagnose, DoesNotDependOnTheNumberOfThreads) {
  const auto file = stiff_file();
  const auto targets = measured({});
  DiagnoseOptions one, three;
  one.threads = 1;
  three.threads = 3;
  one.strongest = three.strongest = 1;
  const auto a = diagnose(file, targets, ModelKind::guide, file.machine.poses, one);
  const auto b = diagnose(file, targets, ModelKind::guide, file.machine.poses, three);
  ASSERT_EQ(a.hypotheses.size(), b.hypotheses.size());
  for (std::size_t k = 0; k < a.hypotheses.size(); ++k) {
    EXPECT_EQ(a.hypotheses[k].causes, b.hypotheses[k].causes);
    EXPECT_EQ(a.hypotheses[k].bic, b.hypotheses[k].bic);
  }
}

TEST(Diagnose, StopsWhenAskedToWithWhatThereIs) {
  const auto file = stiff_file();
  const auto d = diagnose(file, measured({}), ModelKind::guide, file.machine.poses, {},
                          [](double share) { return share > 0.05; });
  EXPECT_TRUE(d.interrupted);
  EXPECT_GT(d.hypotheses.size(), 1U);
  EXPECT_EQ(d.finding, Finding::interrupted);  // what is best so far may not be so in the end
  EXPECT_TRUE(d.equivalent.empty());
}

// Wrong use: no part may be blamed.

void expect_no_blame(const Diagnosis& d, const std::string& why) {
  EXPECT_EQ(d.finding, Finding::do_not_belong);
  EXPECT_TRUE(d.equivalent.empty());
  const auto reasons = report::reason_words(d);
  ASSERT_FALSE(reasons.empty());
  EXPECT_THAT(reasons.front(), HasSubstr(why));
  test::expect_round_trip_of({.diagnosis = d});
}

/// What a hypothesis predicts less what it is off by was measured.
TEST(Diagnose, ContradictionsArePredictedLessMeasured) {
  const auto targets = measured({"legs.guide_sleeve.stiffness=0.84 kN/mm"});
  const auto d = diagnosis_of(targets);
  int frequencies = 0;
  for (const auto& hypothesis : d.hypotheses)
    for (const auto& wrong : hypothesis.wrong) {
      if (wrong.kind != Contradiction::Kind::frequency) continue;
      ++frequencies;
      EXPECT_TRUE(std::ranges::any_of(targets.modes,
                                      [&](const auto& mode) {
                                        return std::abs(wrong.omega - wrong.difference -
                                                        mode.omega) < 1e-9 * mode.omega;
                                      }))
          << wrong.omega << " " << wrong.difference;
    }
  EXPECT_GT(frequencies, 0);
}

TEST(WrongUse, UnitsWrongByAThousandAreNamed) {
  for (const double factor : {1e3, 1e-3}) {
    auto targets = measured({});
    for (auto& mode : targets.modes) {
      mode.omega *= factor;
      mode.deviation *= factor;
    }
    expect_no_blame(diagnosis_of(targets), "a unit wrong by 1000");
  }
}

TEST(WrongUse, RadiansPerSecondTakenForHertzAreNamed) {
  auto targets = measured({});
  for (auto& mode : targets.modes) mode.omega *= 2.0 * std::numbers::pi;
  expect_no_blame(diagnosis_of(targets), "rad/s taken for Hz");
}

TEST(WrongUse, AnotherMachinesModesAreNotThisOnes) {
  test::Random random(5);
  const auto other = test::machine_file(test::random_machine_text(random, true));
  const auto targets = test::noisy_modes(other.machine, {"neutral"}, ModelKind::guide, {}, random);
  const auto d = diagnosis_of(targets);
  EXPECT_EQ(d.finding, Finding::do_not_belong);
  EXPECT_FALSE(report::reason_words(d).empty());
}

/// No pair of causes is these three.
TEST(WrongUse, ThreeFaultsAtOnceAreNotBlamedOnTwo) {
  const auto d = diagnosis_of(
      measured({"leg.2.oil_spring.cylinder.bulk_modulus=0.71 GPa",
                "leg.5.gimbal_stiffness=110 kN/mm", "legs.guide_sleeve.stiffness=1.9 kN/mm"}));
  EXPECT_EQ(d.finding, Finding::unexplained) << d.scatter << " " << test::verdict(d);
  EXPECT_TRUE(d.equivalent.empty());
  const auto reasons = report::reason_words(d);
  ASSERT_FALSE(reasons.empty());
  EXPECT_THAT(reasons.front(),
              HasSubstr("even the best hypothesis (" + report::hypothesis_name(d, d.best()) + ")"));
  EXPECT_THAT(reasons.back(), HasSubstr("more than two causes"));
}

TEST(WrongUse, ModesWithoutDirectionsProveNothing) {
  auto targets = measured({"legs.guide_sleeve.stiffness=0.84 kN/mm"});
  for (auto& mode : targets.modes) {
    mode.shape.reset();
    mode.direction.reset();
  }
  expect_no_blame(diagnosis_of(targets), "neither directions nor shapes");
}

TEST(WrongUse, TooFewModesProveNothing) {
  auto targets = measured({"legs.guide_sleeve.stiffness=0.84 kN/mm"});
  targets.modes.resize(3);
  expect_no_blame(diagnosis_of(targets), "only 3 modes");
}

/// Four numbers of the platform fit four frequencies, whatever they are.
TEST(Diagnose, BlamesNothingThatFitsAsManyNumbersAsThereAreValues) {
  observation::Targets few{.modes = {}};
  const auto file = stiff_file();
  const auto first = first_resonances(file.machine, file.machine.neutral(), ModelKind::guide);
  // a heavier platform with other inertia: neither oil nor mass alone does that
  const std::array drops{0.9301, 0.9305, 0.9331, 0.8817};
  for (const int direction : {0, 1, 2, 5})
    for (const auto& r : first)
      if (r.main_direction == direction) {
        const double omega = drops.at(few.modes.size()) * r.omega;
        few.modes.push_back({.name = direction_name(direction),
                             .omega = omega,
                             .deviation = 1.7e-3 * omega,
                             .direction = direction});
        break;
      }
  ASSERT_EQ(few.modes.size(), 4U);
  const auto d = diagnose(file, few, ModelKind::guide, file.machine.poses, {.strongest = 0});
  ASSERT_EQ(d.values, 4);
  const auto saturated = std::ranges::find(d.hypotheses, 4, &Hypothesis::parameters);
  ASSERT_NE(saturated, d.hypotheses.end());
  EXPECT_EQ(d.finding, Finding::cannot_tell) << test::verdict(d);
  EXPECT_TRUE(d.equivalent.empty());
  EXPECT_GT(d.scatter, 1.0) << "what fits everything says nothing about deviations";
  const auto words = report::summary({.diagnosis = d});
  EXPECT_THAT(words.front(), HasSubstr("The data cannot tell the cause: 4 measured values"));
  EXPECT_THAT(words, testing::Contains(HasSubstr(
                         "Platform mass and inertia fits 4 numbers to 4 measured values")));
  test::expect_round_trip_of({.diagnosis = d});
}

TEST(WrongUse, APoseThatTheMachineDoesNotHaveIsAnError) {
  auto targets = measured({});
  targets.modes[0].pose = "nowhere";
  EXPECT_THROW(diagnosis_of(targets), base::InputError);
}

TEST(Summary, NamesTheCauseWithItsNumber) {
  const auto d = of({"legs.guide_sleeve.stiffness=0.84 kN/mm"});
  const auto words = report::summary({.diagnosis = d});
  EXPECT_THAT(
      words.front(),
      HasSubstr("the stiffness of the guide sleeves of all legs differs from the nominal value"));
  EXPECT_THAT(words.front(), HasSubstr("(nominal 20 MN/m)"));
  EXPECT_THAT(words, testing::Contains(HasSubstr("below the rigid-leg model")));
  test::expect_round_trip_of({.diagnosis = d});
}

}  // namespace
}  // namespace hydrapod::diagnosis
