/// Targets files: what is read, and what is said of those that cannot be.

#include "hydrapod/base/units.hpp"
#include "hydrapod/calibration/calibrate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <tuple>

#include "hydrapod/base/error.hpp"

namespace hydrapod::calibration {
namespace {

using namespace observation;

using base::two_pi;

TEST(Targets, AreReadFromToml) {
  const auto [targets, plan] = parse_targets(R"(title = "June"
frequency_unit = "Hz"
deviation = "0.5 %"
[[mode]]
frequency = 11.3
direction = "x"
damping = "3 %"
[[mode]]
frequency = "71 rad/s"
deviation = "0.02 Hz"
repeated = 2
pose = "raised"
weight = 4
shape = { x = 1, ry = "-5 deg" }
shape_against = "base"
[[free]]
path = ["platform.inertia.xx", "platform.inertia.yy"]
start = "30 kg m^2"
bounds = [10, 90]
prior = { value = 32, spread = "2 kg m^2" }
[[alternative]]
name = "axes"
[[alternative.choice]]
name = "transverse"
[[alternative.choice]]
name = "gimbal"
set = ["model.flexible_axes=gimbal"]
[fit]
starts = 3
loss = "cauchy"
)",
                                             "t.toml");
  EXPECT_EQ(targets.title, "June");
  ASSERT_EQ(targets.modes.size(), 3U);
  for (const auto& mode : targets.modes) EXPECT_TRUE(mode.damped);
  const auto undamped =
      parse_targets("frequencies = \"undamped\"\n[[mode]]\nfrequency = \"7.1 Hz\"\n", "t.toml");
  EXPECT_FALSE(undamped.targets.modes[0].damped);
  const auto& x = targets.modes[0];
  EXPECT_DOUBLE_EQ(x.omega, 11.3 * two_pi);
  EXPECT_DOUBLE_EQ(x.deviation, 0.005 * x.omega);
  EXPECT_EQ(x.direction, 0);
  EXPECT_DOUBLE_EQ(*x.damping, 0.03);
  const auto& raised = targets.modes[2];
  EXPECT_EQ(raised.name, "71 rad/s (2)");
  EXPECT_EQ(raised.pose, "raised");
  EXPECT_DOUBLE_EQ(raised.omega, 71.0);
  EXPECT_DOUBLE_EQ(raised.deviation, 0.02 * two_pi / 4.0);
  EXPECT_NEAR((*raised.shape)[4], -5.0 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_EQ(raised.shape_against, MotionAgainst::base);
  EXPECT_EQ(x.shape_against, MotionAgainst::ground);
  ASSERT_EQ(plan.free.size(), 1U);
  EXPECT_EQ(plan.free[0].paths.size(), 2U);
  EXPECT_EQ(plan.free[0].upper, Amount(90.0));
  EXPECT_EQ(plan.free[0].prior->spread, Amount("2 kg m^2"));
  EXPECT_EQ(plan.alternatives[0].choices[1].overrides[0], "model.flexible_axes=gimbal");
  EXPECT_EQ(plan.options.starts, 3);
  EXPECT_EQ(plan.options.loss, Loss::cauchy);
}

TEST(Targets, AreReadFromCsv) {
  const auto [targets, plan] = parse_targets(
      "# measured in June\n"
      "frequency [Hz],direction,deviation [Hz],damping [%],pose,x,ry,shape_against\r\n"
      "11.3,x,0.05,3.1,neutral,1,-0.2,base\r\n"
      "\"22.82\",z,,,raised,,,\r\n",
      "june.csv");
  ASSERT_EQ(targets.modes.size(), 2U);
  EXPECT_DOUBLE_EQ(targets.modes[0].omega, 11.3 * two_pi);
  EXPECT_DOUBLE_EQ(targets.modes[0].deviation, 0.05 * two_pi);
  EXPECT_DOUBLE_EQ(*targets.modes[0].damping, 0.031);
  EXPECT_DOUBLE_EQ((*targets.modes[0].shape)[4], -0.2);
  EXPECT_EQ(targets.modes[0].shape_against, MotionAgainst::base);
  EXPECT_FALSE(targets.modes[1].shape);
  EXPECT_EQ(targets.modes[1].pose, "raised");
  EXPECT_DOUBLE_EQ(targets.modes[1].deviation, default_deviation * 22.82 * two_pi);
  const auto semicolons =
      parse_targets("frequency [rad/s];deviation [%]\n71.5;0.2\n", "a.csv").targets;
  EXPECT_DOUBLE_EQ(semicolons.modes[0].omega, 71.5);
  EXPECT_DOUBLE_EQ(semicolons.modes[0].deviation, 0.002 * 71.5);
}

/// ω has one unit only, which its column need not say.
TEST(Targets, AreReadFromCsvWithAngularFrequencies) {
  const auto omega = parse_targets("omega,direction\n34.6,x\n5.51 Hz,y\n", "a.csv").targets;
  ASSERT_EQ(omega.modes.size(), 2U);
  EXPECT_DOUBLE_EQ(omega.modes[0].omega, 34.6);
  EXPECT_DOUBLE_EQ(omega.modes[1].omega, 5.51 * two_pi);
  EXPECT_DOUBLE_EQ(parse_targets("omega [Hz]\n5.51\n", "a.csv").targets.modes[0].omega,
                   5.51 * two_pi);
}

TEST(Targets, ATableOfModesIsRefusedOnceAndNamesItsJson) {
  try {
    parse_targets("mode,omega_rad_s,frequency_hz,label\n1,42.4,6.7,x\n2,42.7,6.8,y\n", "m.csv");
    FAIL() << "accepted";
  } catch (const base::InputError& error) {
    ASSERT_EQ(error.diagnostics().size(), 1U);
    EXPECT_NE(error.diagnostics()[0].message.find("give the JSON of the same command"),
              std::string::npos);
  }
}

/// Byte order mark, decimal commas, quoted separators, rows of nothing, an ending in capitals.
TEST(Targets, AreReadAsSpreadsheetsWriteThem) {
  const auto [targets, plan] = parse_targets(
      "\xEF\xBB\xBF"
      "frequency [Hz];direction;deviation [Hz];name\r\n"
      "4,125;x;0,05;\"first; in x\"\r\n7,5;y;;sway, yaw\r\n;;;\r\n",
      "JUNE.CSV");
  ASSERT_EQ(targets.modes.size(), 2U);
  EXPECT_DOUBLE_EQ(targets.modes[0].omega, 4.125 * two_pi);
  EXPECT_DOUBLE_EQ(targets.modes[0].deviation, 0.05 * two_pi);
  EXPECT_EQ(targets.modes[0].name, "first; in x");
  EXPECT_EQ(targets.modes[1].name, "sway, yaw");
  EXPECT_TRUE(targets.deviations_given);
  EXPECT_FALSE(
      parse_targets("frequency [Hz],deviation [Hz]\n4,\n", "a.csv").targets.deviations_given);
}

struct Wrong {
  const char* name;
  const char* file;
  const char* text;
  const char* message;  ///< file:line:column: error: key: …
};

class WrongTargets : public testing::TestWithParam<Wrong> {};

TEST_P(WrongTargets, AreRefusedWithPlaceAndAdvice) {
  const auto& wrong = GetParam();
  try {
    parse_targets(wrong.text, wrong.file);
    FAIL() << "accepted";
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.diagnostics().front().text(), wrong.message);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Toml, WrongTargets,
    testing::Values(
        Wrong{"NoUnit", "t.toml", "[[mode]]\nfrequency = 11.3\n",
              "t.toml:2:13: error: mode[0].frequency: is 11.3 without a unit; write \"11.3 Hz\" or "
              "\"11.3 rad/s\", or say `frequency_unit = \"Hz\"` at the top of the file"},
        Wrong{"Length", "t.toml", "[[mode]]\nfrequency = \"11.3 mm\"\n",
              "t.toml:2:13: error: mode[0].frequency: is \"11.3 mm\", expected a frequency such as "
              "\"11.3 Hz\" or \"71 rad/s\""},
        Wrong{
            "Negative", "t.toml", "[[mode]]\nfrequency = \"-3 Hz\"\n",
            "t.toml:2:13: error: mode[0].frequency: is the string \"-3 Hz\", expected a frequency "
            "above 0"},
        Wrong{
            "Direction", "t.toml", "[[mode]]\nfrequency = \"3 Hz\"\ndirection = \"roll\"\n",
            "t.toml:3:13: error: mode[0].direction: is the string \"roll\", expected one of x, y, "
            "z, rx, ry, rz"},
        Wrong{"Misspelt", "t.toml", "[[mode]]\nfrequency = \"3 Hz\"\ndevation = 1\n",
              "t.toml:3:1: error: mode[0].devation: unknown key; did you mean `deviation`?"},
        Wrong{
            "Empty", "t.toml", "title = \"x\"\n",
            "t.toml:1:1: error: mode: there is no target; write a table [[mode]] with `frequency` "
            "for each"},
        Wrong{"NotTables", "t.toml", "mode = 3\n",
              "t.toml:1:8: error: mode: expected tables, each begun with [[mode]]"},
        Wrong{"Repeated", "t.toml", "[[mode]]\nfrequency = \"3 Hz\"\nrepeated = 1.5\n",
              "t.toml:3:12: error: mode[0].repeated: expected the number of modes with this "
              "frequency, 1 to 30"},
        Wrong{
            "Damping", "t.toml", "[[mode]]\nfrequency = \"3 Hz\"\ndamping = 2\n",
            "t.toml:3:11: error: mode[0].damping: is 2, expected a damping ratio of at least 0 and "
            "below 1"},
        Wrong{"ShapeAgainstFloor", "t.toml",
              "[[mode]]\nfrequency = \"3 Hz\"\nshape = { x = 1 }\nshape_against = \"floor\"\n",
              "t.toml:4:17: error: mode[0].shape_against: is the string \"floor\", expected "
              "\"ground\" or \"base\""},
        Wrong{"AgainstWithoutShape", "t.toml",
              "[[mode]]\nfrequency = \"3 Hz\"\nshape_against = \"base\"\n",
              "t.toml:3:17: error: mode[0].shape_against: needs a `shape`"},
        Wrong{"Infinite", "t.toml", "[[mode]]\nfrequency = inf\n",
              "t.toml:2:13: error: mode[0].frequency: is inf without a unit; write \"inf Hz\" or "
              "\"inf rad/s\", or say `frequency_unit = \"Hz\"` at the top of the file"},
        Wrong{"InfiniteHertz", "t.toml", "frequency_unit = \"Hz\"\n[[mode]]\nfrequency = inf\n",
              "t.toml:3:13: error: mode[0].frequency: is inf Hz, expected 1e-06 to 1e+06 Hz"},
        Wrong{
            "InfiniteDeviation", "t.toml", "[[mode]]\nfrequency = \"3 Hz\"\ndeviation = inf\n",
            "t.toml:3:13: error: mode[0].deviation: is inf times the frequency, expected 1e-09 to "
            "1000"},
        Wrong{"PathOfNumbers", "t.toml", "[[mode]]\nfrequency = \"3 Hz\"\n[[free]]\npath = [3]\n",
              "t.toml:4:8: error: free[0].path: holds the number 3, expected paths such as "
              "\"legs.rod.mass\""},
        Wrong{"OneChoice", "t.toml",
              "[[mode]]\nfrequency = \"3 Hz\"\n[[alternative]]\nname = "
              "\"a\"\n[[alternative.choice]]\n"
              "name = \"b\"\n",
              "t.toml:3:1: error: alternative[0]: expected at least two tables "
              "[[alternative.choice]], each with `name` and `set`"},
        Wrong{"Syntax", "t.toml", "[[mode]\n",
              "t.toml:1:8: error: not valid TOML in table header: expected ']', saw '\\n'"}),
    [](const auto& info) { return info.param.name; });

/// All mistakes of a file are reported at once, poses too where the machine is known.
TEST(Targets, OfAPoseThatTheMachineLacksAreReportedWithTheOtherMistakes) {
  const std::vector<std::string> poses{"neutral", "low"};
  for (const auto& [file, text, at] :
       {std::tuple{"t.csv", "frequency [Hz],pose\n11.3,nowhere\n-3,low\n", "t.csv:2:6"},
        std::tuple{"t.toml",
                   "[[mode]]\nfrequency = \"11.3 Hz\"\npose = \"nowhere\"\n[[mode]]\nfrequency = "
                   "\"-3 Hz\"\npose = \"low\"\n",
                   "t.toml:3:8"}}) {
    try {
      std::ignore = parse_targets(text, file, poses);
      FAIL() << file;
    } catch (const base::InputError& error) {
      ASSERT_EQ(error.diagnostics().size(), 2U) << error.what();
      EXPECT_THAT(error.diagnostics()[0].text(), testing::StartsWith(at));
      EXPECT_THAT(
          error.diagnostics()[0].text(),
          testing::EndsWith("is \"nowhere\", expected a pose of the machine: neutral, low"));
    }
  }
}

/// A column without a unit is one mistake, however many rows it has.
TEST(Targets, AColumnWithoutAUnitIsSaidOnce) {
  try {
    std::ignore =
        parse_targets("frequency,damping,deviation\n11.3,3,0.1\n11.4,2,0.1\n22.8,5,0.1\n", "t.csv");
    FAIL() << "accepted";
  } catch (const base::InputError& error) {
    ASSERT_EQ(error.diagnostics().size(), 3U) << error.what();
    EXPECT_EQ(error.diagnostics()[0].key, "frequency");
    EXPECT_EQ(error.diagnostics()[1].key, "damping");
    EXPECT_EQ(error.diagnostics()[2].key, "deviation");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Csv, WrongTargets,
    testing::Values(
        Wrong{"NoUnit", "t.csv", "frequency,direction\n11.3,x\n",
              "t.csv:2:1: error: frequency: is 11.3 without a unit; title the column `frequency "
              "[Hz]`"},
        Wrong{"Column", "t.csv", "frequency [Hz],dirction\n11.3,x\n",
              "t.csv:1:16: error: dirction: unknown column; did you mean `direction`?"},
        Wrong{"BothFrequencies", "t.csv", "frequency [Hz],omega\n1.7,10.7\n",
              "t.csv:1:1: error: omega: there is a column `frequency` too; give one of the two"},
        Wrong{"NoFrequency", "t.csv", "omega,frequency [Hz],x,omega\n1.7,10.7\n",
              "t.csv:1:24: error: omega: this column is there twice"},
        Wrong{"TableOfModes", "t.csv", "mode,omega_rad_s,frequency_hz,damping_ratio,stable\n",
              "t.csv:1:1: error: is a table of `hydrapod modes`, which has neither shapes nor a "
              "pose; give the JSON of the same command (-o modes.json)"},
        Wrong{"Cells", "t.csv", "frequency [Hz],direction\n11.3\n",
              "t.csv:2:1: error: has 1 cell, expected 2 as in the title row"},
        Wrong{
            "Text", "t.csv", "frequency [Hz]\nfast\n",
            "t.csv:2:1: error: frequency: is \"fast\", expected a frequency such as \"11.3 Hz\" or "
            "\"71 rad/s\""},
        Wrong{"Empty", "t.csv", "\n\n",
              "t.csv: error: is empty, expected a title row such as `frequency [Hz],direction`"},
        Wrong{"NotANumber", "t.csv", "frequency [Hz],x\n11.3,nan\n",
              "t.csv:2:6: error: x: is nan, expected a finite number"},
        Wrong{"Damping", "t.csv", "frequency [Hz],damping [%]\n11.3,-5\n",
              "t.csv:2:1: error: damping: is -0.05, expected a damping ratio of at least 0 and "
              "below 1"},
        Wrong{"DampingInPercent", "t.csv", "frequency [Hz],damping\n11.3,3.1\n",
              "t.csv:2:6: error: damping: is 3.1, expected a damping ratio of at least 0 and below "
              "1; title the column `damping [%]` where it is in percent"},
        Wrong{"DampingDeviation", "t.csv", "frequency [Hz],damping_deviation\n11.3,0\n",
              "t.csv:2:6: error: damping_deviation: is 0, expected more than 0"},
        Wrong{"Negative", "t.csv", "frequency [Hz]\n-3\n",
              "t.csv:2:1: error: frequency: is -3, expected a frequency above 0"},
        Wrong{"Deviation", "t.csv", "frequency [Hz],deviation [%]\n11.3,-1\n",
              "t.csv:2:6: error: deviation: is -1, expected more than 0"},
        Wrong{"ShapeAgainst", "t.csv", "frequency [Hz],x,shape_against\n11.3,1,floor\n",
              "t.csv:2:8: error: shape_against: is \"floor\", expected ground or base"},
        Wrong{"Huge", "t.csv", "frequency [Hz]\n1e305\n",
              "t.csv:2:1: error: frequency: is 1e+305 Hz, expected 1e-06 to 1e+06 Hz"},
        Wrong{"Twice", "t.csv", "frequency [Hz],x,x\n1,2,3\n",
              "t.csv:1:18: error: x: this column is there twice"},
        Wrong{"NoRows", "t.csv", "frequency [Hz]\n",
              "t.csv: error: there is no mode below the title row"}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace hydrapod::calibration
