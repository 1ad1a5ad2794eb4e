/// Where a diagnosis predicts the next measurement: as the tasks compute the hypothesis's machine.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using observation::Observed;

const std::string machine = source_file("models/heavy-platform.toml").string();

/// The six resonances of a soft oil at the neutral pose that move the platform most, by their
/// directions.
observation::Targets soft_oil(const std::vector<std::string>& overrides, Observed observed) {
  auto truth = overrides;
  truth.emplace_back("legs.oil_spring.cylinder.bulk_modulus=0.7317 GPa");
  const auto of = tasks::read_machine({.file = machine, .overrides = truth});
  auto seen = observation::visible_resonances(
      observation::observe(of.file.machine, of.pose.X_BP, of.kind, observed));
  std::ranges::sort(seen, std::greater{}, &observation::Resonance::strength);
  observation::Targets targets{.observed = observed};
  for (const auto& one : seen) {
    const bool there = std::ranges::any_of(
        targets.modes, [&](const auto& mode) { return mode.direction == one.direction; });
    if (!there)
      targets.modes.push_back({.name = spatial::direction_name(one.direction),
                               .omega = one.omega,
                               .deviation = 3.1e-4 * one.omega,
                               .direction = one.direction});
  }
  return targets;
}

/// Frequencies [rad/s] that the tasks compute of a machine.
std::vector<double> frequencies(const tasks::Machine& of, Observed observed) {
  std::vector<double> all;
  if (observed == Observed::mechanics)
    for (const auto& mode : tasks::modes(of).real.modes) all.push_back(mode.mode.omega);
  else
    for (const auto& pole : tasks::system(of, {.closed = false}).poles.poles)
      all.push_back(pole.omega);
  return all;
}

class NextMeasurement : public testing::TestWithParam<Observed> {};

/// Of the plant: the file's air is compressed to what the chambers never have.
TEST_P(NextMeasurement, IsPredictedAsTheTasksComputeTheHypothesis) {
  const auto observed = GetParam();
  const std::vector<std::string> design{
      "legs.oil_spring.cylinder.air={fraction=0.0137, pressure=\"13.7 bar\"}"};
  const auto stated = tasks::read_machine({.file = machine, .overrides = design});
  const auto d = diagnosis::diagnose(stated.file, soft_oil(design, observed), stated.kind,
                                     {*find_pose(stated.file.machine, "low")}, {.strongest = 0});
  ASSERT_EQ(d.finding, diagnosis::Finding::undecided);
  ASSERT_FALSE(d.substitution);
  bool air = false;
  for (const auto& x : d.discriminators) {
    const auto expect = [&](std::size_t number, double predicted) {
      const auto& e = d.hypotheses[number];
      auto of = stated;
      of.file = diagnosis::file_of(stated.file, e);
      of.pose = *find_pose(of.file.machine, x.pose);
      of.kind = e.kind;
      double nearest = 1.0;
      for (const double omega : frequencies(of, observed))
        nearest = std::min(nearest, std::abs(omega / predicted - 1.0));
      EXPECT_LT(nearest, 1e-4) << report::hypothesis_name(d, e) << " at " << x.pose;
    };
    ASSERT_FALSE(d.hypotheses[x.other].by_mechanics);
    expect(d.equivalent.front(), x.omega_best);
    expect(x.other, x.omega_other);
  }
  for (const auto k : d.equivalent) {
    const auto& e = d.hypotheses[k];
    if (report::hypothesis_name(d, e) != "entrained air in all legs") continue;
    air = true;
    // what it is compressed to stands beside it: of mechanics the file's, of the plant its
    // chambers'
    ASSERT_TRUE(e.air_pressure);
    if (observed == Observed::mechanics)
      EXPECT_EQ(*e.air_pressure, 13.7e5);
    else
      EXPECT_NEAR(*e.air_pressure, 40e5, 8e5);
    EXPECT_THAT(
        report::parameter_words(e).front(),
        testing::HasSubstr(fmt::format(" at {:.3g} bar chamber pressure", *e.air_pressure / 1e5)));
    const auto lowest =
        *std::ranges::min_element(d.targets.modes, {}, &observation::ModeTarget::omega);
    // and mechanics then says what the plant does
    auto of = stated;
    of.file = diagnosis::file_of(stated.file, e);
    EXPECT_NEAR(tasks::modes(of).real.modes[0].mode.omega / lowest.omega, 1.0, 0.05);
  }
  EXPECT_TRUE(air);
  EXPECT_FALSE(d.discriminators.empty());
}

/// Seals as stiff as at the frequency of each resonance, not as for quick motions.
TEST(NextMeasurementOfElastomers, IsThatOfTheModes) {
  const auto of = tasks::read_machine(
      {.file = machine,
       .overrides = {
           R"(legs.guide_sleeve.elastomer={dynamic_ratio=1.6, loss_factor=0.17, frequency="8.3 Hz"})"}});
  const auto resonances = observation::visible_resonances(of.file.machine, of.pose.X_BP, of.kind);
  ASSERT_GE(resonances.size(), 6U);
  const auto listed = frequencies(of, Observed::mechanics);
  for (const auto& one : resonances) {
    double nearest = 1.0;
    for (const double omega : listed)
      nearest = std::min(nearest, std::abs(omega / one.omega - 1.0));
    EXPECT_LT(nearest, 1e-3) << spatial::direction_name(one.direction);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, NextMeasurement, testing::Values(Observed::mechanics, Observed::plant),
                         [](const auto& info) { return observation::name(info.param); });

}  // namespace
}  // namespace hydrapod::test
