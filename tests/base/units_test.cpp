/// Quantities as people write them.

#include "hydrapod/base/units.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace hydrapod::base {
namespace {

/// UDUNITS-2 multiplies a prefix up to three times ("cm^3"): a few roundings.
constexpr double tolerance = 4.0 * std::numeric_limits<double>::epsilon();
constexpr double degree = std::numbers::pi / 180.0;

struct Written {
  std::string text;
  std::string unit;
  double value;
};

class Quantities : public testing::TestWithParam<Written> {};

TEST_P(Quantities, AreReadIntoSi) {
  const auto& [text, unit, value] = GetParam();
  const auto result = read_quantity(text, unit);
  EXPECT_TRUE(result.ok()) << result.problem;
  EXPECT_NEAR(result.value, value, tolerance * std::abs(value)) << text;
}

INSTANTIATE_TEST_SUITE_P(
    All, Quantities,
    testing::Values(
        Written{"700 MPa", "Pa", 7e8}, Written{"0.17 m", "m", 0.17}, Written{"170mm", "m", 0.17},
        Written{" 170  mm ", "m", 0.17}, Written{"-3 mm", "m", -3e-3}, Written{"+3 mm", "m", 3e-3},
        Written{"12 deg", "rad", 12 * degree}, Written{"12°", "rad", 12 * degree},
        Written{"0.2 rad", "rad", 0.2}, Written{"2 %", "1", 0.02}, Written{"0.02", "1", 0.02},
        Written{"20 cm^3", "m^3", 20e-6}, Written{"20 cm3", "m^3", 20e-6},
        Written{"20 cm**3", "m^3", 20e-6}, Written{"2 l", "m^3", 2e-3},
        Written{"9.81 m/s^2", "m/s^2", 9.81}, Written{"9.81 m s-2", "m/s^2", 9.81},
        Written{"500 N s/m", "N s/m", 500.0}, Written{"0.5 N·s/mm", "N s/m", 500.0},
        Written{"3 kg·m²", "kg m^2", 3.0}, Written{"5 kN/mm", "N/m", 5e6},
        Written{"1 t", "kg", 1000.0}, Written{"100 bar", "Pa", 1e7}, Written{"4 1/s", "1/s", 4.0},
        Written{"5 Hz", "1/s", 5.0}, Written{"60 rpm", "rad/s", 2 * std::numbers::pi},
        Written{"5 N mm", "N m", 5e-3}, Written{"1e3 mm", "m", 1.0}, Written{"7 kg", "g", 7000.0},
        Written{"3 µm", "m", 3e-6}, Written{"1 in", "m", 0.0254}, Written{"0 m", "m", 0.0},
        // no-break space, as typeset text has it
        Written{"5\xC2\xA0mm", "m", 5e-3}));

struct Wrong {
  std::string text;
  std::string unit;
  std::string problem;
};

class WrongQuantities : public testing::TestWithParam<Wrong> {};

TEST_P(WrongQuantities, SayWhatIsExpected) {
  const auto& [text, unit, problem] = GetParam();
  const auto result = read_quantity(text, unit);
  EXPECT_EQ(result.problem, problem);
  EXPECT_TRUE(std::isnan(result.value));
}

INSTANTIATE_TEST_SUITE_P(
    All, WrongQuantities,
    testing::Values(
        Wrong{"3 kg", "m", R"("3 kg" has the unit "kg" (a mass), expected a length such as "m")"},
        Wrong{"3 V", "kg", R"("3 V" has the unit "V" (a voltage), expected a mass such as "kg")"},
        Wrong{
            "3 m^7", "m",
            "\"3 m^7\" has the unit \"m^7\" (a quantity in m^7), expected a length such as \"m\""},
        // a factor of two pi lies between them
        Wrong{"3 Hz", "rad/s",
              "\"3 Hz\" has the unit \"Hz\" (a frequency), expected an angular speed such as "
              "\"rad/s\""},
        Wrong{"2 %", "rad",
              R"("2 %" has the unit "%" (a pure number), expected an angle such as "rad")"},
        Wrong{"12 deg", "1",
              "\"12 deg\" has the unit \"deg\" (an angle), expected a pure number such as \"0.02\" "
              "or \"2 %\""},
        Wrong{"0.3", "m", R"("0.3" has no unit, expected a length such as "0.5 m")"},
        Wrong{"m", "m", R"("m" does not start with a number, expected a length such as "0.5 m")"},
        Wrong{"+-3 m", "m",
              R"("+-3 m" does not start with a number, expected a length such as "0.5 m")"},
        Wrong{"", "m", R"(is an empty string, expected a length such as "0.5 m")"},
        Wrong{" ", "1", R"(is an empty string, expected a pure number such as "0.02" or "2 %")"},
        Wrong{"0,5 m", "m", R"("0,5 m" has a decimal comma, expected a decimal point)"},
        Wrong{"nan m", "m", R"("nan m" is not a finite number)"},
        Wrong{"inf m", "m", R"("inf m" is not a finite number)"},
        Wrong{"1e999 m", "m", R"("1e999 m" is out of the range of numbers)"},
        Wrong{"1e308 km", "m", R"("1e308 km" is out of the range of numbers)"},
        Wrong{"1e-323 nm", "m", R"("1e-323 nm" is out of the range of numbers)"},
        Wrong{
            "3 furlongs!", "m",
            "\"3 furlongs!\" has the unknown unit \"furlongs!\", expected a length such as \"m\""},
        Wrong{"3 Mpa", "Pa",
              "\"3 Mpa\" has the unknown unit \"Mpa\", expected a pressure such as \"Pa\"; did you "
              "mean \"MPa\"?"},
        Wrong{"3 Ns/m", "N s/m",
              "\"3 Ns/m\" has the unknown unit \"Ns/m\", expected a viscous damping such as \"N "
              "s/m\"; did you mean \"N s/m\"?"},
        Wrong{"0x10 m", "m",
              R"("0x10 m" has the unknown unit "x10 m", expected a length such as "m")"},
        Wrong{"20 degC", "K",
              "\"20 degC\" has the unit \"degC\", which has a zero of its own, expected a "
              "temperature such as \"K\""},
        Wrong{"3 lg(re mW)", "W",
              "\"3 lg(re mW)\" has the unit \"lg(re mW)\", which has a logarithmic scale, expected "
              "a power such as \"W\""},
        // what UDUNITS-2 itself would accept
        Wrong{"3 m 5", "m", R"("3 m 5" has the unknown unit "m 5", expected a length such as "m")"},
        Wrong{"3 m @ 5", "m",
              R"("3 m @ 5" has the unknown unit "m @ 5", expected a length such as "m")"},
        Wrong{"3 s since 2020-01-01", "s",
              "\"3 s since 2020-01-01\" has the unknown unit \"s since 2020-01-01\", expected a "
              "time such as \"s\""},
        Wrong{"3 m\xff", "m", R"("3 m?" has the unknown unit "m?", expected a length such as "m")"},
        Wrong{"3 " + std::string(300, 'm'), "m",
              "\"3 " + std::string(58, 'm') + "...\" has the unknown unit \"" +
                  std::string(60, 'm') + "...\", expected a length such as \"m\""}));

TEST(Units, QuantityThrowsTheProblem) {
  EXPECT_EQ(quantity("2 m", "m"), 2.0);
  EXPECT_THROW(quantity("2 kg", "m"), std::invalid_argument);
}

TEST(Units, TheExpectedUnitMustBeOne) {
  EXPECT_THROW(read_quantity("2 m", "no unit"), std::invalid_argument);
  EXPECT_THROW(dimension_name("degC"), std::invalid_argument);
}

TEST(Units, DimensionsHaveNames) {
  EXPECT_EQ(dimension_name("m"), "a length");
  EXPECT_EQ(dimension_name("mm"), "a length");
  EXPECT_EQ(dimension_name("J"), "a torque");
  EXPECT_EQ(dimension_name("mol"), "a quantity in mol");
}

TEST(Units, MayBeReadFromSeveralThreads) {
  std::vector<std::thread> threads;
  std::vector<double> sums(4, 0.0);
  for (double& sum : sums) {
    threads.emplace_back([&sum] {
      for (int i = 0; i < 200; ++i) sum += quantity("1 km", "m") + quantity("1 kN/mm", "N/m");
    });
  }
  for (auto& thread : threads) thread.join();
  for (const double sum : sums) EXPECT_EQ(sum, 200 * (1e3 + 1e6));
}

}  // namespace
}  // namespace hydrapod::base
