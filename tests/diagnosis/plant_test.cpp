/// Diagnoses of what the drives of the valves see: modes of mechanics, oil and valves.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "blind_series.hpp"
#include "hydrapod/observation/observation.hpp"

namespace hydrapod::diagnosis {
namespace {

using test::BlindCase;
using testing::HasSubstr;

/// As by_noise, of the plant.
observation::Targets by_plant(const BlindCase& test, const model::MachineFile& truth) {
  test::Random random(7919u * static_cast<std::uint64_t>(test.repetition) + 17u);
  return test::noisy_plant_modes(
      truth.machine, test.poses, test.kind,
      {.frequency = test.noise, .shape = std::min(0.05, 30.0 * test.noise)}, random);
}

observation::Targets taken_for_mechanics(const BlindCase& test, const model::MachineFile& truth) {
  auto targets = by_plant(test, truth);
  targets.observed = observation::Observed::mechanics;
  return targets;
}

/// Adds lines from 2 to 50 Hz with 1 % of noise; `of_line`: the response at s, whose real part is
/// `shift`.
void add_lines(double shift, const std::function<Eigen::MatrixXcd(std::complex<double>)>& of_line,
               test::Random& random, observation::ResponseTarget& all) {
  constexpr double noise = 0.01;
  for (double hertz = 2.0; hertz < 50.0; hertz *= 1.003) {
    const std::complex<double> s(shift, 2.0 * std::numbers::pi * hertz);
    Eigen::MatrixXcd H = of_line(s);
    for (auto& h : H.reshaped())
      h *= 1.0 + noise * std::complex<double>(test::normal(random), test::normal(random));
    all.s.push_back(s);
    all.H.push_back(H);
    all.deviation.emplace_back(Eigen::VectorXd::Constant(6, std::sqrt(2.0) * noise));
  }
}

observation::Observation observed_at(const BlindCase& test, const model::Machine& machine,
                                     const std::string& pose, observation::Observed observed) {
  const auto named = std::ranges::find(machine.poses, pose, &model::NamedPose::name);
  return observation::observe(machine, named->X_BP, test.kind, observed);
}

/// Modes and responses to the drives of the valves.
observation::Targets with_responses(const BlindCase& test, const model::MachineFile& truth) {
  auto targets = by_plant(test, truth);
  test::Random random(271u);
  for (const auto& name : test.poses) {
    const auto plant = observed_at(test, truth.machine, name, observation::Observed::plant);
    observation::ResponseTarget all{.pose = name, .inputs = spatial::Matrix6::Identity()};
    spatial::Matrix6 to_origin = spatial::Matrix6::Identity();
    to_origin.topRightCorner<3, 3>() =
        -spatial::skew(plant.mechanics.X_BP.p_BP - plant.mechanics.p_BC);
    add_lines(
        0.93,
        [&](auto s) -> Eigen::MatrixXcd {
          return to_origin * plant.response(s, observation::Entry::valves);
        },
        random, all);
    targets.responses.push_back(all);
  }
  return targets;
}

/// The knees' resonance lies 3 % above x and y and is damped ten times less: undamped modes are not
/// where the poles are.
const BlindCase soft_sleeves{.machine = "zhang-jiang-2021.toml",
                             .fault = {"legs.guide_sleeve.stiffness=0.12586 kN/mm"},
                             .planted = {"guide sleeves of all legs"}};

TEST(DiagnosePlant, TellsTheSleevesOfAllLegsThoughTheirKneeLiesBesideXAndY) {
  const auto result = test::run_blind(soft_sleeves, by_plant);
  EXPECT_TRUE(result.found) << test::verdict(result.diagnosis);
  EXPECT_FALSE(result.diagnosis.substitution.has_value());
  const auto* sleeves = test::find(result.diagnosis, "guide sleeves of all legs");
  ASSERT_NE(sleeves, nullptr);
  EXPECT_FALSE(sleeves->by_mechanics);
  EXPECT_NEAR(sleeves->fit.parameters[0].value, 0.12586e6, 0.01 * 0.12586e6);
  // what the file states, not where the last fit began
  const auto stated = test::machine_file(soft_sleeves.text(), {}).machine;
  EXPECT_DOUBLE_EQ(sleeves->fit.parameters[0].start, stated.legs[0].guide_sleeve.stiffness);
  // the same taken for modes of mechanics
  const auto other = test::run_blind(soft_sleeves, taken_for_mechanics);
  EXPECT_FALSE(other.first) << test::verdict(other.diagnosis);
}

/// Oil with 4 % of air gets stiffer under the load: as mechanics it is payload and oil at once.
TEST(DiagnosePlant, TellsAPayloadOnOilWithAir) {
  const auto result = test::run_blind({.machine = "heavy-platform.toml",
                                       .fault = {"platform.mass=15.31 t"},
                                       .planted = {"payload (platform mass)"},
                                       .poses = {"neutral"},
                                       .repetition = 4},
                                      by_plant);
  EXPECT_TRUE(result.found) << test::verdict(result.diagnosis);
}

/// A sound machine is not blamed for what the plant adds to mechanics.
TEST(DiagnosePlant, BlamesNothingInASoundMachine) {
  const auto result = test::run_blind({.machine = "zhang-jiang-2021.toml"}, by_plant);
  EXPECT_EQ(result.diagnosis.finding, Finding::nominal) << test::verdict(result.diagnosis);
  EXPECT_LT(result.diagnosis.nominal().misfit,
            2.0 * static_cast<double>(result.diagnosis.targets.modes.size()));
}

constexpr std::size_t few = 6;

/// The lowest ones, as a short record shows.
observation::Targets few_modes(const BlindCase& test, const model::MachineFile& truth) {
  auto targets = by_plant(test, truth);
  std::ranges::sort(targets.modes, {}, &observation::ModeTarget::omega);
  targets.modes.resize(few);
  return targets;
}

observation::Targets few_modes_with_responses(const BlindCase& test,
                                              const model::MachineFile& truth) {
  auto targets = few_modes(test, truth);
  targets.responses = with_responses(test, truth).responses;
  return targets;
}

/// Sleeves so soft that their dampers hold the rods: no resonance is lower than with rigid legs,
/// and by the modes of mechanics, which are undamped, only piston rings would move the others so.
TEST(DiagnosePlant, TellsSleevesThatTheirDampersHold) {
  const BlindCase held{.machine = "starter",
                       .fault = {"legs.guide_sleeve.stiffness=0.3 kN/mm"},
                       .planted = {"guide sleeves of all legs"}};
  const auto result = test::run_blind(held, few_modes_with_responses);
  EXPECT_TRUE(result.first) << test::verdict(result.diagnosis);
  const auto* sleeves = test::find(result.diagnosis, "guide sleeves of all legs");
  ASSERT_NE(sleeves, nullptr);
  const auto& stiffness = sleeves->fit.parameters[0];
  EXPECT_NEAR(stiffness.value, 0.3e6, 3.0 * stiffness.deviation);
}

/// Every cause alone.
Diagnosis without_pairs(const BlindCase& test, const test::Measure& measure,
                        DiagnoseOptions options = {}) {
  const auto design = test::machine_file(test.text(), test.design);
  auto overrides = test.design;
  overrides.insert(overrides.end(), test.fault.begin(), test.fault.end());
  const auto measured = measure(test, test::machine_file(test.text(), overrides));
  options.strongest = 0;
  return diagnose(design, measured, dynamics::ModelKind::guide, design.machine.poses, options);
}

bool among_best(const Diagnosis& d, const std::string& name) {
  return std::ranges::any_of(d.equivalent, [&](std::size_t k) {
    return report::hypothesis_name(d, d.hypotheses[k]) == name;
  });
}

/// Six modes whose shapes are not trusted do not tell the oil of leg 2 from that of leg 5, on the
/// other side of the machine; how the valves of the two move the platform between the resonances
/// does. (Gimbals are the same spring.)
TEST(DiagnosePlant, ResponsesTellTheLegThatFewModesDoNot) {
  const BlindCase one_leg{.machine = "zhang-jiang-2021.toml",
                          .fault = {"leg.2.oil_spring.stiffness=3.17e6"},
                          .planted = {"oil spring of leg 2"}};
  const auto modes = without_pairs(one_leg, few_modes, {.shape_error = 0.2});
  const auto all = without_pairs(one_leg, few_modes_with_responses, {.shape_error = 0.2});
  EXPECT_TRUE(among_best(modes, "oil spring of leg 5")) << test::verdict(modes);
  EXPECT_FALSE(among_best(all, "oil spring of leg 5")) << test::verdict(all);
  EXPECT_FALSE(among_best(all, "gimbals of leg 5")) << test::verdict(all);
  EXPECT_TRUE(among_best(all, "oil spring of leg 2")) << test::verdict(all);
  EXPECT_EQ(all.values, modes.values + 5 * static_cast<int>(few));
}

/// Sound with responses too; what they contradict is said of other hypotheses.
TEST(DiagnosePlant, SaysWhichResponseAnExplanationMisses) {
  const auto result = test::run_blind({.machine = "zhang-jiang-2021.toml"}, with_responses);
  const auto& d = result.diagnosis;
  EXPECT_EQ(d.finding, Finding::nominal) << test::verdict(d);
  ASSERT_EQ(d.targets.responses.size(), 1U);
  EXPECT_THAT(d.nominal().wrong, testing::IsEmpty());
  EXPECT_LT(d.nominal().misfit, 2.0 * static_cast<double>(d.targets.modes.size()));
  const auto soft = without_pairs({.machine = "heavy-platform.toml",
                                   .design = {"legs.guide_sleeve.stiffness=20 kN/mm"},
                                   .fault = {"leg.2.oil_spring.cylinder.bulk_modulus=0.31 GPa"}},
                                  with_responses);
  EXPECT_TRUE(among_best(soft, "oil spring of leg 2")) << test::verdict(soft);
  EXPECT_THAT(report::contradiction_words(soft, soft.best()),
              testing::Not(testing::Contains(HasSubstr("driven"))));
  EXPECT_THAT(report::contradiction_words(soft, soft.nominal()),
              testing::Contains(HasSubstr("Hz (MAC 0.")));
  test::expect_round_trip_of({.diagnosis = soft});
}

/// Modes of mechanics, and what a hammer with a force sensor makes of them.
observation::Targets hammered(const BlindCase& test, const model::MachineFile& truth) {
  auto targets = test::by_noise(test, truth);
  test::Random random(523u);
  for (const auto& name : test.poses) {
    const auto seen = observed_at(test, truth.machine, name, observation::Observed::mechanics);
    observation::ResponseTarget all{.pose = name,
                                    .point = truth.machine.platform.mass_center,
                                    .against = observation::MotionAgainst::ground,
                                    .entry = observation::Entry::forces,
                                    .inputs = spatial::Matrix6::Identity()};
    add_lines(
        0.0,
        [&](auto s) -> Eigen::MatrixXcd {
          return std::exp(-0.0007 * s) *  // filters delay
                 seen.response(s, observation::Entry::forces, observation::MotionAgainst::ground);
        },
        random, all);
    targets.responses.push_back(all);
  }
  return targets;
}

/// Mass and inertia 28 % less and springs 39 % stiffer have the same modes, and of the
/// two the oil has one number where the platform has four; a force moves the lighter platform more.
TEST(DiagnoseForces, TellALighterPlatformFromStifferOil) {
  const BlindCase lighter{.machine = "zhang-jiang-2021.toml",
                          .design = {"legs.guide_sleeve.stiffness=20 kN/mm"},
                          .fault = {"platform.mass=643.7 kg", "platform.inertia.xx=32.47",
                                    "platform.inertia.yy=32.47", "platform.inertia.zz=39.26"},
                          .planted = {"platform mass and inertia"}};
  const auto modes_alone = [](const BlindCase& test, const model::MachineFile& truth) {
    auto targets = hammered(test, truth);
    targets.responses.clear();
    return targets;
  };
  const auto modes = without_pairs(lighter, modes_alone);
  EXPECT_TRUE(among_best(modes, "oil springs of all legs")) << test::verdict(modes);
  const auto all = without_pairs(lighter, hammered);
  EXPECT_TRUE(among_best(all, "platform mass and inertia")) << test::verdict(all);
  EXPECT_FALSE(among_best(all, "oil springs of all legs")) << test::verdict(all);
  const auto* oil = test::find(all, "oil springs of all legs");
  ASSERT_NE(oil, nullptr);
  EXPECT_FALSE(oil->by_mechanics);
  EXPECT_THAT(report::contradiction_words(all, *oil),
              testing::Contains(HasSubstr("differs from the response to forces at")));
  test::expect_round_trip_of({.diagnosis = all});
}

TEST(DiagnosePlant, SaysWhyWhereThePlantCannotBeHad) {
  // legs along the machine's lower end of stroke cannot be held by a supply of 20 bar
  const auto file = test::machine_file(
      test::read_text(test::source_file("models/heavy-platform.toml")), {"supply.pressure=20 bar"});
  test::Random random(3);
  auto targets =
      test::noisy_modes(file.machine, {"neutral"}, dynamics::ModelKind::guide, {}, random);
  targets.observed = observation::Observed::plant;
  DiagnoseOptions options;
  options.strongest = 0;
  const auto d = diagnose(file, targets, dynamics::ModelKind::guide, file.machine.poses, options);
  const auto notes = report::note_words(d);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(notes[0], HasSubstr("compared with mechanics"));
  EXPECT_THAT(notes[0], HasSubstr("supply"));
  test::expect_round_trip_of({.diagnosis = d});
  EXPECT_EQ(d.finding, Finding::nominal);
}

}  // namespace
}  // namespace hydrapod::diagnosis
