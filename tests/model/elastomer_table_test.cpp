/// Seals whose stiffness and loss stand in the file over frequency: as Maxwell arms, and as a table
/// of measured values to which arms are fitted.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "sound_machine.hpp"

namespace hydrapod::model {
namespace {

using Complex = std::complex<double>;
using testing::HasSubstr;

/// k(iω)/k, written down once more.
Complex relative_stiffness(const MaxwellArms& arms, double hertz) {
  const Complex s(0.0, 2.0 * std::numbers::pi * hertz);
  Complex sum = 1.0;
  for (int j = 0; j < 3; ++j) sum += arms.strength[j] * s / (s + 1.0 / arms.time[j]);
  return sum;
}

std::string row(double hertz, const Complex& k) {
  return fmt::format("[{:.12g}, {:.12g}, {:.12g}]", hertz, k.real(), k.imag() / k.real());
}

std::string table(const std::vector<std::string>& rows) {
  return fmt::format("legs.guide_sleeve.elastomer={{ table = [{}] }}", fmt::join(rows, ", "));
}

MachineFile with_override(const std::string& override) {
  return parse_machine(sound_machine_file, "m.toml", {override});
}

const MaxwellArms& arms_of(const MachineFile& file) {
  return *file.machine.legs[1].guide_sleeve.elastomer.value().arms;
}

TEST(ElastomerTable, OfThreeArmsGivesThemBack) {
  const MaxwellArms exact{.strength = {0.37, 0.23, 0.41}, .time = {0.0017, 0.19, 0.023}};
  std::vector<std::string> rows;
  for (double hertz = 0.13; hertz < 300.0; hertz *= 1.7)
    rows.push_back(row(hertz, relative_stiffness(exact, hertz)));
  const auto file = with_override(table(rows));
  EXPECT_TRUE(file.warnings.empty());
  for (double hertz = 0.05; hertz < 900.0; hertz *= 1.31) {
    const Complex wanted = relative_stiffness(exact, hertz);
    EXPECT_LT(std::abs(relative_stiffness(arms_of(file), hertz) - wanted), 1e-4 * std::abs(wanted))
        << hertz;
  }
}

/// A material whose stiffness grows by a power of the frequency, as rubbers do, is none of arms.
TEST(ElastomerTable, OfAPowerLawIsMetWithinTwoPercentOverTwoDecades) {
  std::vector<std::string> rows;
  const auto power_law = [](double hertz) {
    return 1.0 + 0.21 * std::pow(Complex(0.0, hertz / 3.1), 0.31);
  };
  for (double hertz = 0.5; hertz < 51.0; hertz *= 1.29)
    rows.push_back(row(hertz, power_law(hertz)));
  const auto file = with_override(table(rows));
  EXPECT_TRUE(file.warnings.empty());
  for (double hertz = 0.5; hertz < 50.0; hertz *= 1.1)
    EXPECT_LT(std::abs(relative_stiffness(arms_of(file), hertz) - power_law(hertz)),
              0.02 * std::abs(power_law(hertz)))
        << hertz;
}

TEST(ElastomerTable, ThatArmsCannotMeetIsToldByHowMuch) {
  // the loss of a passive arm comes with a growth of the stiffness that these rows do not have
  const auto file = with_override(table({"[1, 1.1, 0.4]", "[10, 1.12, 0.5]", "[100, 1.13, 0.4]"}));
  ASSERT_EQ(file.warnings.size(), 1U);
  EXPECT_EQ(file.warnings[0].key, "legs.guide_sleeve.elastomer.table");
  EXPECT_THAT(file.warnings[0].message, HasSubstr("three arms miss the stiffness by "));
  double worst = 0.0;
  for (const auto& [hertz, k] : {std::pair{1.0, Complex(1.1, 0.44)},
                                 {10.0, Complex(1.12, 0.56)},
                                 {100.0, Complex(1.13, 0.452)}})
    worst = std::max(worst, std::abs(relative_stiffness(arms_of(file), hertz) - k) / std::abs(k));
  EXPECT_THAT(file.warnings[0].message, HasSubstr(fmt::format(" by {:.2g} % at ", 100.0 * worst)));
}

TEST(ElastomerArms, AreReadForAllLegsAndForOne) {
  const auto file = with_override(
      "legs.guide_sleeve.elastomer={ arms = { strength = [0.2, 0.1, 0.3], time = [\"0.2 s\", \"20 "
      "ms\", 2e-3] } }");
  EXPECT_EQ(arms_of(file).strength, Vector3(0.2, 0.1, 0.3));
  EXPECT_LT((arms_of(file).time - Vector3(0.2, 0.02, 0.002)).norm(), 1e-15);
}

/// As a calibration of the arms leaves it.
TEST(ElastomerArms, CountBesideATable) {
  const auto file = with_override(
      "legs.guide_sleeve.elastomer={ table = [[1, 1.2, 0.1], [9, 1.5, 0.2]], arms = { strength = "
      "[0.2, 0.1, 0.3], time = [0.2, 0.02, 2e-3] } }");
  EXPECT_EQ(arms_of(file).strength, Vector3(0.2, 0.1, 0.3));
  ASSERT_EQ(file.warnings.size(), 1U);
  EXPECT_EQ(file.warnings[0].key, "legs.guide_sleeve.elastomer.table");
  EXPECT_EQ(file.warnings[0].message, "has no effect beside `arms`");
}

TEST(ElastomerArms, WrongOnesAreRefused) {
  const auto message = [](const std::string& inside) -> std::string {
    try {
      with_override(fmt::format("legs.guide_sleeve.elastomer={{ {} }}", inside));
    } catch (const base::InputError& error) {
      EXPECT_EQ(error.diagnostics().size(), 1U) << error.what();
      return error.what();
    }
    return "";
  };
  const std::string arms = "arms = { strength = [0.2, 0.1, 0.3], time = [0.2, 0.02, 2e-3] }";
  const std::string numbers = "dynamic_ratio = 1.7, loss_factor = 0.13, frequency = 11";
  EXPECT_THAT(message("softening = 0.2"),
              HasSubstr("legs.guide_sleeve.elastomer: expected `dynamic_ratio`, `loss_factor` and "
                        "`frequency`, or `arms`, or a `table` of measured values"));
  EXPECT_THAT(message("dynamic_ratio = 1.7, loss_factor = 0.13"), HasSubstr("`frequency`, or"));
  EXPECT_THAT(message(arms + ", " + numbers), HasSubstr("expected one of both"));
  EXPECT_THAT(message("table = [[1, 1.2, 0.1], [9, 1.5, 0.2]], " + numbers),
              HasSubstr("expected one of both"));
  EXPECT_THAT(
      message("table = [[1, 1.2, 0.1]]"),
      HasSubstr("expected 2 to 1000 rows of [frequency in Hz, dynamic_ratio, loss_factor]"));
  EXPECT_THAT(message("table = [[1, 1.2, 0.1], [9, 1.5]]"),
              HasSubstr("elastomer.table[1]: is an array of 2, expected [frequency in Hz, "
                        "dynamic_ratio, loss_factor]"));
  EXPECT_THAT(message("table = [[1, 1.2, 0.1], [9, 0.5, 0.2]]"),
              HasSubstr("elastomer.table[1][1]: expected more than 1"));
  EXPECT_THAT(message("table = [[0, 1.2, 0.1], [9, 1.5, 0.2]]"),
              HasSubstr("elastomer.table[0][0]: is no frequency from 1e-6 Hz to 1e6 Hz"));
  EXPECT_THAT(message("arms = { strength = [0, 0, 0], time = [0.2, 0.02, 2e-3] }"),
              HasSubstr("arms.strength: is 0 for all arms, expected one above 0"));
  for (const std::string number : {"0", "-0.3"})
    EXPECT_THAT(message(numbers + ", softening = 0.3, softening_time = " + number),
                HasSubstr("elastomer.softening_time: is " + number + " s, expected more than 0"));
  EXPECT_THAT(message(numbers + ", softening = 0.3, softening_time = \"0.3 m\""),
              HasSubstr("has the unit \"m\" (a length)"));
  EXPECT_THAT(message("arms = { strength = [0.2, 0.1, 0.3] }"),
              HasSubstr("elastomer.arms.time: required value (an array of 3 numbers in s) is "
                        "missing"));
}

}  // namespace
}  // namespace hydrapod::model
