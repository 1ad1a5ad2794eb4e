/// Causes: every machine has all of them, each changes the model, and each is a hypothesis that
/// holds the machine as stated.

#include "diagnosis/evidence.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "support/calibration_machine.hpp"
#include "support/run_program.hpp"

namespace hydrapod::diagnosis {
namespace {

using dynamics::ModelKind;

std::vector<std::string> texts() {
  std::vector<std::string> all;
  for (const char* name : {"zhang-jiang-2021.toml", "heavy-platform.toml"})
    all.push_back(test::read_text(test::source_file(std::string("models/") + name)));
  test::Random random(71);
  all.push_back(test::random_machine_text(random, true));
  return all;
}

Eigen::VectorXd omega2(const model::Machine& machine, ModelKind kind) {
  return modal::normal_modes(dynamics::linear_model(machine, machine.neutral(), kind)).omega2;
}

TEST(Suspects, OfEveryMachineCoverWhatCanBeWrong) {
  for (const auto& text : texts()) {
    std::set<Family> families;
    std::set<std::string> names;
    for (const auto& cause : causes_of(test::machine_file(text))) {
      families.insert(cause.family());
      const auto name = report::cause_name(cause);
      EXPECT_TRUE(names.insert(name).second) << name << " is there twice";
      EXPECT_FALSE(report::cause_statement(cause).empty());
      EXPECT_FALSE(cause.free.empty());
    }
    EXPECT_THAT(families, testing::UnorderedElementsAre(Family::guide_sleeves, Family::piston_rings,
                                                        Family::leg_axes, Family::platform,
                                                        Family::mass_center, Family::base,
                                                        Family::oil_lines, Family::payload_modes));
  }
}

/// Every free number is one of the file's with the cause's changes, starts within its bounds,
/// and moving it moves a mode.
TEST(Suspects, HaveNumbersThatMoveModes) {
  for (const auto& text : texts()) {
    const auto file = test::machine_file(text);
    for (const auto& cause : causes_of(file)) {
      auto with = file;
      model::assign(with.machine, cause.changes);
      const auto kind = cause.needs_rings() ? ModelKind::full : ModelKind::guide;
      const auto before = omega2(with.machine, kind);
      for (const auto& free : cause.free) {
        const double start = std::get<double>(*free.start), low = std::get<double>(*free.lower),
                     high = std::get<double>(*free.upper);
        EXPECT_LE(low, start) << report::cause_name(cause);
        EXPECT_GE(high, start) << report::cause_name(cause);
        const double moved = start == 0.0 ? 0.1 * high : 1.07 * start;
        std::vector<model::Assignment> assignments;
        for (const auto& path : free.paths) {
          const auto number = find_number(with, path);
          ASSERT_TRUE(number) << path;
          EXPECT_NEAR(number->value, start, 1e-9 * std::abs(start)) << path;
          assignments.push_back({number->id, moved});
        }
        const auto after = omega2(model::with(with.machine, assignments), kind);
        EXPECT_GT((after - before).cwiseQuotient(before).cwiseAbs().maxCoeff(), 1e-9)
            << report::cause_name(cause) << ' ' << free.paths.front();
      }
    }
  }
}

/// What a cause needs before it can be guilty changes the machine little: it begins innocent.
TEST(Suspects, BeginNearTheMachineAsStated) {
  for (const auto& text : texts()) {
    const auto file = test::machine_file(text);
    const auto stated = omega2(file.machine, ModelKind::guide);
    for (const auto& cause : causes_of(file)) {
      if (cause.changes.empty() || cause.needs_rings()) continue;
      const auto begun = omega2(model::with(file.machine, cause.changes), ModelKind::guide);
      // a payload that swings has modes of its own among the others: the lowest one is compared
      const auto count = begun.size() == stated.size() ? stated.size() : 1;
      EXPECT_LT((begun.head(count) - stated.head(count))
                    .cwiseQuotient(stated.head(count))
                    .cwiseAbs()
                    .maxCoeff(),
                0.1)
          << report::cause_name(cause);
    }
  }
}

/// A block of 2.3 m × 1.7 m × 0.9 m: its radii of gyration about its axes have the mean square
/// (a² + b² + c²)/18.
/// The value of leg 1 is not that of the others where leg 1 has one of its own.
TEST(Suspects, BeginAtTheValueOfTheLegsThatTheySet) {
  const auto text = test::read_text(test::source_file("models/heavy-platform.toml"));
  const auto start_of = [&](Cause::Kind kind, const std::vector<std::string>& values) {
    const auto all = causes_of(test::machine_file(text, values));
    const auto found = std::ranges::find_if(
        all, [&](const Cause& cause) { return cause.kind == kind && !cause.leg; });
    return std::get<double>(*found->free.front().start);
  };
  using Kind = Cause::Kind;
  EXPECT_DOUBLE_EQ(
      start_of(Kind::gimbals, {"legs.gimbal_stiffness=900 MN/m", "leg.1.gimbal_stiffness=2 GN/m"}),
      900e6);
  EXPECT_DOUBLE_EQ(start_of(Kind::sticking_seals,
                            {"legs.stick_stiffness=700 kN/m", "leg.1.stick_stiffness=900 kN/m"}),
                   700e3);
  EXPECT_DOUBLE_EQ(start_of(Kind::oil_lines, {"legs.added_axial_inertia=300 kg",
                                              "leg.1.added_axial_inertia=500 kg"}),
                   300.0);
  // without one the others begin at a usual value, which the model is given first
  const auto file = test::machine_file(text, {"leg.1.gimbal_stiffness=2 GN/m"});
  for (const auto& cause : causes_of(file)) {
    if (cause.kind != Kind::gimbals || cause.leg) continue;
    ASSERT_EQ(cause.changes.size(), 1U);
    const auto machine = model::with(file.machine, cause.changes);
    EXPECT_DOUBLE_EQ(machine.legs[0].gimbal_stiffness.value(), 2e9);
    EXPECT_DOUBLE_EQ(machine.legs[1].gimbal_stiffness.value(),
                     std::get<double>(*cause.free.front().start));
  }
}

TEST(Suspects, LookForTheMassCentreWithinARadiusOfGyration) {
  auto file = test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")));
  auto& platform = file.machine.platform;
  platform.mass = 7130.0;
  platform.inertia =
      platform.mass / 12.0 *
      spatial::Vector3(1.7 * 1.7 + 0.9 * 0.9, 2.3 * 2.3 + 0.9 * 0.9, 2.3 * 2.3 + 1.7 * 1.7)
          .asDiagonal()
          .toDenseMatrix();
  const double radius = std::sqrt((2.3 * 2.3 + 1.7 * 1.7 + 0.9 * 0.9) / 18.0);
  const auto causes = causes_of(file);
  const auto center = std::ranges::find(causes, Cause::Kind::mass_center, &Cause::kind);
  ASSERT_NE(center, causes.end());
  ASSERT_EQ(center->free.size(), 3U);
  for (int k = 0; k < 3; ++k) {
    const auto& free = center->free[static_cast<std::size_t>(k)];
    EXPECT_NEAR(std::get<double>(*free.lower), platform.mass_center[k] - radius, 1e-12);
    EXPECT_NEAR(std::get<double>(*free.upper), platform.mass_center[k] + radius, 1e-12);
  }
}

TEST(Suspects, AreTriedTogetherAcrossFamiliesAndForTwoLegs) {
  const Cause all{Cause::Kind::bulk_modulus};
  const Cause leg2{Cause::Kind::oil_springs, 1};
  const Cause leg5{Cause::Kind::oil_springs, 4};
  const Cause mass{Cause::Kind::payload};
  const Cause air{Cause::Kind::air};
  EXPECT_FALSE(can_be_together(all, leg2));
  EXPECT_TRUE(can_be_together(leg2, leg5));
  EXPECT_FALSE(can_be_together(leg2, leg2));
  EXPECT_TRUE(can_be_together(all, mass));
  EXPECT_FALSE(can_be_together(mass, air));
}

using report::amount_text;

TEST(Amounts, HaveTheDigitsThatTheirDeviationLeaves) {
  EXPECT_EQ(amount_text(839951.0, 256.0, "N/m"), "839.95 ± 0.26 kN/m");
  EXPECT_EQ(amount_text(1.2345e9, 0.0, "Pa"), "1.234 GPa");
  EXPECT_EQ(amount_text(2.3456e-12, 3.1e-14, "m^3/(s Pa)"), "(2.346 ± 0.031)e-12 m^3/(s Pa)");
  EXPECT_EQ(amount_text(-2.3e-12, 4.7e-11, "m^3/(s Pa)"), "(-0.2 ± 4.7)e-11 m^3/(s Pa)");
  EXPECT_EQ(amount_text(14200.0, 310.0, "kg"), "14200 ± 310 kg");
  EXPECT_EQ(amount_text(-0.1634, 0.0021, "m"), "-163.4 ± 2.1 mm");
  EXPECT_EQ(amount_text(0.0431, 0.0012, "1"), "0.0431 ± 0.0012");
  EXPECT_EQ(amount_text(0.0009, 0.0, "m^3"), "0.9 l");
  EXPECT_EQ(amount_text(5.0, std::numeric_limits<double>::infinity(), "kg"), "5 kg");
}

}  // namespace
}  // namespace hydrapod::diagnosis
