/// `hydrapod montecarlo`, `sweep` and `map` as they are called.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "hydrapod/base/text.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string machine = test::source_file("models/zhang-jiang-2021-transverse.toml").string();

std::vector<std::string> montecarlo(const std::vector<std::string>& more) {
  std::vector<std::string> all{"montecarlo", machine, "--vary",
                               "legs.guide_sleeve.stiffness=normal ± 7 % per leg"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// The columns of a CSV of rows by their titles; cells without a number are NaN.
std::map<std::string, std::vector<double>> columns_of_rows(const std::string& path) {
  std::map<std::string, std::vector<double>> columns;
  std::vector<std::string> titles;
  for (const auto& line : base::split(test::read_text(path), "\n")) {
    if (line.empty() || line.starts_with('#')) continue;
    const auto cells = base::split(line, ",");
    if (titles.empty()) {
      titles = cells;
      continue;
    }
    for (std::size_t k = 0; k < titles.size(); ++k)
      columns[titles[k]].push_back(k < cells.size() && !cells[k].empty() ? std::stod(cells[k])
                                                                         : std::nan(""));
  }
  return columns;
}

/// Killed at random moments, and resumed until it is complete.
TEST(Studies, ThatWereKilledEndBitForBitAsUndisturbedOnes) {
  const test::TemporaryFolder folder;
  const auto whole = (folder / "whole.h5").string(), cut = (folder / "cut.h5").string();
  const auto undisturbed =
      test::run_hydrapod(montecarlo({"--samples", "30000", "--results", whole}));
  ASSERT_EQ(undisturbed.exit_code, 0) << undisturbed.err;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> moment(0.03, 0.4);
  for (int kill = 0; kill < 20; ++kill) {
    std::vector<std::string> arguments{"-s", "KILL", fmt::format("{:.3f}", moment(random)),
                                       test::hydrapod_program().string()};
    for (const auto& one : montecarlo({"--samples", "30000", "--results", cut, "--resume"}))
      arguments.push_back(one);
    if (test::run_program("timeout", arguments).exit_code == 0) break;
  }
  const auto last =
      test::run_hydrapod(montecarlo({"--samples", "30000", "--results", cut, "--resume"}));
  ASSERT_EQ(last.exit_code, 0) << last.err;
  EXPECT_EQ(test::read_text(cut), test::read_text(whole));
  EXPECT_EQ(last.out, undisturbed.out);
}

TEST(Studies, InPartsAreJoinedToTheWhole) {
  const test::TemporaryFolder folder;
  const auto whole = (folder / "whole.h5").string(), parts = (folder / "parts.h5").string();
  ASSERT_EQ(test::run_hydrapod(montecarlo({"--samples", "1500", "--results", whole})).exit_code, 0);
  for (const char* part : {"1/3", "2/3", "3/3"})
    ASSERT_EQ(
        test::run_hydrapod(montecarlo({"--samples", "1500", "--results", parts, "--shard", part}))
            .exit_code,
        0);
  const auto joined = test::run_hydrapod(
      montecarlo({"--samples", "1500", "--results", parts, "--shard", "3", "--join"}));
  ASSERT_EQ(joined.exit_code, 0) << joined.err;
  EXPECT_NE(joined.out.find("\nfrequencies are those of undamped modes\n1500 rows"),
            std::string::npos)
      << joined.out;
  EXPECT_EQ(test::read_text(parts), test::read_text(whole));
}

/// Rows may have taken hours. Those of the name that nobody gave are those of the last study.
TEST(Studies, RowsOfANamedFileAreReplacedByForceAlone) {
  const test::TemporaryFolder folder;
  const auto rows = (folder / "rows.h5").string();
  ASSERT_EQ(test::run_hydrapod(montecarlo({"--samples", "37", "--results", rows})).exit_code, 0);
  const auto before = test::read_text(rows);
  const auto again = test::run_hydrapod(montecarlo({"--samples", "53", "--results", rows}));
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_EQ(again.err, rows +
                           ": error: a file exists there and was left as it is; choose another "
                           "name, or --force to replace it\n");
  EXPECT_EQ(test::read_text(rows), before);
  const auto forced =
      test::run_hydrapod(montecarlo({"--samples", "53", "--results", rows, "--force"}));
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_NE(test::read_text(rows), before);
  for (int k = 0; k < 2; ++k) {
    const auto unnamed =
        test::run_hydrapod(montecarlo({"--samples", "37"}), {.folder = folder.path()});
    EXPECT_EQ(unnamed.exit_code, 0) << unnamed.err;
  }
}

TEST(Studies, BeyondTheDiskAreRefusedBeforeTheWorkBegins) {
  const test::TemporaryFolder folder;
  const auto run = test::run_hydrapod(
      montecarlo({"--samples", "1000000000000", "--results", (folder / "run.h5").string()}));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("days"));
  EXPECT_THAT(run.err, HasSubstr("GB left"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Studies, ComeFromAFile) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "study.toml", fmt::format(R"(machine = "{}"
samples = 300
want = ["x >= 7.4 Hz"]
[vary]
"legs.guide_sleeve.stiffness" = "normal ± 7 % per leg"
)",
                                                      machine));
  const auto run = test::run_hydrapod({"montecarlo", (folder / "study.toml").string(), "--results",
                                       (folder / "run.h5").string(), "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["rows"], 300);
  EXPECT_EQ(json["inputs"].size(), 6U);
  EXPECT_EQ(json["requirements"][0]["samples"], 300);

  // the command line counts before the file
  const auto fewer =
      test::run_hydrapod({"montecarlo", (folder / "study.toml").string(), "--samples", "70",
                          "--results", (folder / "fewer.h5").string(), "--format", "json"});
  ASSERT_EQ(fewer.exit_code, 0) << fewer.err;
  EXPECT_EQ(nlohmann::json::parse(fewer.out)["rows"], 70);

  test::write_text(folder / "wrong.toml",
                   "machine = \"m.toml\"\nsampels = 300\n[vary]\nmass = 3\n");
  const auto wrong = test::run_hydrapod({"montecarlo", (folder / "wrong.toml").string()});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("wrong.toml:2:1"));
  EXPECT_THAT(wrong.err, HasSubstr("did you mean `samples`"));
  EXPECT_THAT(wrong.err, HasSubstr("wrong.toml:4:8"));
}

TEST(Studies, NumbersOfThePoseMoveThePlatform) {
  const test::TemporaryFolder folder;
  const auto csv_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{"sweep",     machine,
                                 "--over",    "poses.neutral.position[2]=0.64, 0.66 m",
                                 "--csv",     (folder / "sweep.csv").string(),
                                 "--results", (folder / "sweep.h5").string(),
                                 "--force"};
    all.insert(all.end(), more.begin(), more.end());
    return test::run_hydrapod(all);
  };
  const auto sweep = csv_of({});
  ASSERT_EQ(sweep.exit_code, 0) << sweep.err;
  auto lines = base::split(test::read_text(folder / "sweep.csv"), "\n");
  std::erase_if(lines, [](std::string_view line) { return line.starts_with("#"); });
  ASSERT_GE(lines.size(), 3U);
  for (std::size_t row : {1U, 2U}) {
    const auto cells = base::split(lines[row], ",");
    const auto modes = test::run_hydrapod({"modes", machine, "--set",
                                           "poses.neutral.position[2]=" + std::string(cells[0]),
                                           "--format", "csv"});
    ASSERT_EQ(modes.exit_code, 0) << modes.err;
    EXPECT_THAT(modes.out, HasSubstr(std::string(cells[2]).substr(0, 6))) << modes.out;
  }
  EXPECT_NE(base::split(lines[1], ",")[2], base::split(lines[2], ",")[2]);
  const auto elsewhere = csv_of({"--pose", "x=1 mm"});
  EXPECT_EQ(elsewhere.exit_code, 2);
  EXPECT_THAT(elsewhere.err, HasSubstr("poses.neutral.position[2]: error: has no effect at pose "
                                       "x=1 mm; expected is a number of that pose, or --pose "
                                       "neutral"));
}

/// What cannot be shown is refused before rows are computed and written.
TEST(Studies, WhatIsAskedOfTheResultsIsLookedAtFirst) {
  const test::TemporaryFolder folder;
  const auto complaint = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"--results", "s.h5"});
    const auto run = test::run_hydrapod(words, {.folder = folder.path()});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder / "s.h5"));
    return run.err;
  };
  const std::string over = "platform.mass=800:1000:3 kg";
  EXPECT_EQ(complaint({"sweep", machine, "--over", over, "--plot", "s.svg"}),
            "--plot s.svg: error: a heat map needs a grid over exactly two inputs\n");
  EXPECT_EQ(complaint({"sweep", machine, "--over", over, "--samples", "20"}),
            "--samples 20: error: a grid has one row per point, here 3; leave it out\n");
  EXPECT_EQ(complaint({"sweep", machine, "--over", over, "--value", "x"}),
            "--value x: error: is what --plot shows; add --plot FILE\n");
  EXPECT_THAT(complaint({"map", machine, "--over", "x=-2:2:3 mm", "--over", "y=-2:2:3 mm",
                         "--value", "first", "--plot", "s.svg"}),
              HasSubstr("--value first: error: unknown output; accepted are status, lowest,"));
  EXPECT_EQ(complaint({"montecarlo", machine, "--vary", "platform.mass=normal ± 1 %", "--worst",
                       "w.toml"}),
            "--worst w.toml: error: which sample is worst follows from the first --want\n");
  for (const auto& [bound, why] : {std::pair{"mac >= 1.2", "it is at most 1"},
                                   {"share_x <= -0.1", "it is at least 0"},
                                   {"condition <= 0.7", "a condition is at least 1"},
                                   {"drop >= 120 %", "a drop is at most 100 %"}})
    EXPECT_EQ(complaint({"sweep", machine, "--over", over, "--want", bound}),
              fmt::format("--want \"{}\": error: no machine meets that; {}\n", bound, why));
}

/// Poses out of reach have no frequencies. They miss what is wanted, and none of them is the worst.
TEST(Studies, TheWorstRowHasAValue) {
  const test::TemporaryFolder folder;
  const auto map =
      test::run_hydrapod({"map", machine, "--over", "x=-2:2:3 m", "--over", "y=0:4:2 mm", "--want",
                          "lowest >= 4 Hz", "--results", (folder / "map.h5").string()});
  ASSERT_EQ(map.exit_code, 0) << map.err;
  EXPECT_THAT(map.out, testing::ContainsRegex("worst for lowest >= 4 Hz: row [23], lowest = "));
  EXPECT_THAT(map.out, testing::Not(HasSubstr("nan")));
}

/// The pose of the lowest mode and others, without a requirement: the numbers are those of the
/// rows.
TEST(Studies, MapsNameTheirWorstPoses) {
  const test::TemporaryFolder folder;
  const auto heavy = test::source_file("models/heavy-platform.toml").string();
  const auto map = test::run_hydrapod(
      {"map", heavy, "--pose", "low", "--over", "x=-60:60:4 mm", "--over", "rz=-2:3:3 deg", "--csv",
       (folder / "map.csv").string(), "--results", (folder / "map.h5").string()});
  ASSERT_EQ(map.exit_code, 0) << map.err;
  const auto rows = columns_of_rows(folder / "map.csv");
  for (const auto& [words, column, most] : {std::tuple{"lowest frequency", "lowest [Hz]", false},
                                            {"largest drop", "drop [1]", true},
                                            {"largest condition", "condition [1]", true},
                                            {"least stroke left", "stroke [m]", false}}) {
    const auto& values = rows.at(column);
    const auto at = most ? std::ranges::max_element(values) : std::ranges::min_element(values);
    const auto row = at - values.begin();
    EXPECT_THAT(map.out, HasSubstr(column == std::string_view("drop [1]")
                                       ? fmt::format("{}: {:.3g} % to", words, 100.0 * *at)
                                       : fmt::format("{}: {:.4g}", words, *at)));
    EXPECT_THAT(map.out, HasSubstr(fmt::format(
                             "x = {:.5g} m, rz = {:.5g} rad (row {})",
                             rows.at("pose.x [m]")[static_cast<std::size_t>(row)],
                             rows.at("pose.rz [rad]")[static_cast<std::size_t>(row)], row)))
        << words;
  }
}

/// Rows of the grid that was asked for are rows of the refined one.
TEST(Studies, MapsAreRefinedWhereModesCross) {
  const test::TemporaryFolder folder;
  const auto rows_with = [&](const std::vector<std::string>& more, const std::string& name) {
    std::vector<std::string> all{"map",       machine,
                                 "--over",    "x=-60:60:5 mm",
                                 "--over",    "z=-50:30:4 mm",
                                 "--csv",     (folder / (name + ".csv")).string(),
                                 "--results", (folder / (name + ".h5")).string()};
    all.insert(all.end(), more.begin(), more.end());
    const auto run = test::run_hydrapod(all);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return std::pair(run.err, columns_of_rows(folder / (name + ".csv")));
  };
  const auto [none, coarse] = rows_with({}, "coarse");
  const auto [said, fine] = rows_with({"--refine", "2"}, "fine");
  EXPECT_THAT(none, Not(HasSubstr("cross")));
  EXPECT_THAT(said,
              testing::ContainsRegex("values became [0-9]+, between which modes cross or veer"));
  const auto count = coarse.at("lowest [Hz]").size();
  ASSERT_EQ(count, 20U);
  EXPECT_GT(fine.at("lowest [Hz]").size(), count);
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t same = 0;
    while (fine.at("pose.x [m]").at(same) != coarse.at("pose.x [m]")[k] ||
           fine.at("pose.z [m]")[same] != coarse.at("pose.z [m]")[k])
      ++same;
    for (const auto& [name, values] : coarse)
      if (!std::isnan(values[k])) EXPECT_EQ(fine.at(name)[same], values[k]) << name;
  }
  const auto wrong = test::run_hydrapod({"sweep", machine, "--over", "platform.mass=700:900 kg",
                                         "--design", "sobol", "--refine", "1"});
  EXPECT_EQ(wrong.err, "--refine 1: error: halves intervals of a grid; leave --design out\n");
}

/// Every pose of the map is the worst of three inclinations: as maps of each of them say.
TEST(Studies, MapsOverTheWorstOfFurtherDirections) {
  const test::TemporaryFolder folder;
  const std::vector<std::string> map{"map",           machine,  "--over",
                                     "x=-20:20:3 mm", "--over", "z=0, 30 mm"};
  const auto rows_with = [&](const std::vector<std::string>& more, const std::string& name) {
    auto all = map;
    all.insert(all.end(), more.begin(), more.end());
    all.insert(all.end(), {"--csv", (folder / (name + ".csv")).string(), "--results",
                           (folder / (name + ".h5")).string()});
    const auto run = test::run_hydrapod(all);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return std::pair(run.out, columns_of_rows(folder / (name + ".csv")));
  };
  const auto [text, worst] =
      rows_with({"--worst-over", "rx=-2, 0, 3 deg", "--also", "stiffness"}, "worst");
  const auto [all_text, all] =
      rows_with({"--over", "rx=-2, 0, 3 deg", "--also", "stiffness_x", "--also", "sag"}, "all");
  ASSERT_EQ(worst.at("lowest [Hz]").size(), 6U);
  ASSERT_EQ(all.at("lowest [Hz]").size(), 18U);
  EXPECT_EQ(worst.count("stiffness_rz [N m/rad]"), 1U);
  EXPECT_EQ(all.count("stiffness_y [N/m]"), 0U);
  EXPECT_EQ(all.count("sag [m]"), 1U);
  for (std::size_t k = 0; k < 6; ++k) {
    const auto of = [&](const char* name, bool most) {
      const auto from = all.at(name).begin() + static_cast<std::ptrdiff_t>(3 * k);
      return most ? *std::max_element(from, from + 3) : *std::min_element(from, from + 3);
    };
    constexpr double rounding = 1e-9;
    EXPECT_NEAR(worst.at("lowest [Hz]")[k], of("lowest [Hz]", false), rounding);
    EXPECT_NEAR(worst.at("drop [1]")[k], of("drop [1]", true), rounding);
    EXPECT_NEAR(worst.at("stiffness_x [N/m]")[k] / of("stiffness_x [N/m]", false), 1.0, rounding);
  }
  const auto& lowest = all.at("lowest [Hz]");
  const auto least = static_cast<std::size_t>(std::ranges::min_element(lowest) - lowest.begin());
  EXPECT_THAT(text, HasSubstr(fmt::format("lowest frequency: {:.4g} Hz at x = {:.5g} m, z = {:.5g} "
                                          "m, rx = {:.5g} rad (row {})",
                                          lowest[least], all.at("pose.x [m]")[least],
                                          all.at("pose.z [m]")[least],
                                          all.at("pose.rx [rad]")[least], least / 3)));
  EXPECT_THAT(text, HasSubstr("reached: all of 0.0012 m^2"));
  EXPECT_THAT(all_text, HasSubstr("reached: all of 0.0001047 m^2 rad"));
}

TEST(Studies, SayWhatIsWrongWithWhatTheyAreAskedFor) {
  const test::TemporaryFolder folder;
  const auto fails = [&](const std::vector<std::string>& more, const char* why) {
    std::vector<std::string> all{"map",           machine,     "--over",
                                 "x=-20:20:3 mm", "--results", (folder / "s.h5").string()};
    all.insert(all.end(), more.begin(), more.end());
    const auto run = test::run_hydrapod(all);
    EXPECT_EQ(run.exit_code, 2) << why;
    EXPECT_THAT(run.err, HasSubstr(why));
    EXPECT_FALSE(std::filesystem::exists(folder / "s.h5"));
  };
  fails({"--worst-over", "x=-1:1:3 mm"}, "is varied twice");
  fails({"--worst-over", "rx=-1:1 deg"}, "expected from:to:count");
  fails({"--worst-over", "rx=-1:1:101 deg", "--worst-over", "ry=-1:1:1001 deg"}, "at most 100000");
  fails({"--worst-over", "rx=0:1:2 deg", "--want", "x <= 20 Hz"}, "is the least of all poses");
  fails({"--worst-over", "rx=0:1:2 deg", "--want", "drop >= 2 %"}, "is the largest of all poses");
  fails({"--worst-over", "rx=0:1:2 deg", "--want", "share >= 2 %"}, "with the worst drop");
  fails({"--also", "stifness"}, "unknown output 'stifness'");
  fails({"--also", "power"}, "supply.pump_flow");
  fails({"--want", "stiffness_q >= 3 kN/mm"}, "did you mean 'stiffness_");
  fails({"--until", "2"}, "add --command");
  const auto sixth = test::run_hydrapod(
      {"montecarlo", machine, "--vary", "legs.rod.mass=normal ± 2 % per leg correlated -0.5"});
  EXPECT_THAT(sixth.err, HasSubstr("six numbers can have -0.2 with each other at the least"));
  fails({"--command", "step z=9 m"}, "more stroke than it has");
}

/// As `simulate` of the same machine.
TEST(Studies, EverySampleMakesAMotion) {
  const test::TemporaryFolder folder;
  const auto heavy = test::source_file("models/heavy-platform.toml").string();
  const std::vector<std::string> motion{"--command", "step z=1 mm, at=0.1", "--until", "6"};
  std::vector<std::string> sweep{"sweep",     heavy,
                                 "--over",    "platform.mass=13200, 15100 kg",
                                 "--csv",     (folder / "s.csv").string(),
                                 "--results", (folder / "s.h5").string(),
                                 "--want",    "settling_z <= 4.2 s"};
  sweep.insert(sweep.end(), motion.begin(), motion.end());
  const auto run = test::run_hydrapod(sweep);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto rows = columns_of_rows(folder / "s.csv");
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<std::string> simulate{
        "simulate", heavy,
        "--set",    fmt::format("platform.mass={}", rows.at("platform.mass [kg]")[k]),
        "--format", "json"};
    simulate.insert(simulate.end(), motion.begin(), motion.end());
    const auto one = test::run_hydrapod(simulate);
    ASSERT_EQ(one.exit_code, 0) << one.err;
    const auto json = nlohmann::json::parse(one.out);
    const auto& z = json.at("directions").at(2);
    EXPECT_EQ(rows.at("rms_error_z [m]")[k], z.at("rms_error").get<double>());
    EXPECT_EQ(rows.at("peak_motion_z [m]")[k], z.at("peak_motion").get<double>());
    EXPECT_EQ(rows.at("settling_z [s]")[k], z.at("settling_time_s").get<double>());
  }
  EXPECT_NE(rows.at("rms_error_z [m]")[0], rows.at("rms_error_z [m]")[1]);
  // the same from a file, whose motion the command line may shorten
  test::write_text(folder / "m.toml", fmt::format("machine = \"{}\"\nsamples = 2\n"
                                                  "command = [\"step z=1 mm, at=0.1\"]\nuntil = 4\n"
                                                  "[vary]\n\"platform.mass\" = \"normal ± 1 %\"\n",
                                                  heavy));
  const auto from_file = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{"montecarlo", (folder / "m.toml").string(), "--results",
                                 (folder / "m.h5").string(), "--force"};
    all.insert(all.end(), more.begin(), more.end());
    return test::run_hydrapod(all);
  };
  const auto whole = from_file({});
  EXPECT_THAT(whole.out, testing::AllOf(HasSubstr("motion: step z=1 mm, at=0.1; until 4 s"),
                                        HasSubstr("settling_z "), Not(HasSubstr("motions have"))))
      << whole.err;
  // within the band at the end, on the way through it
  EXPECT_THAT(from_file({"--until", "0.4"}).out,
              HasSubstr("2 of 2 motions have not settled in z at their end"));
  EXPECT_EQ(rows.count("settling_x [s]"), 0U);
}

TEST(Studies, OfCorrelatedNumbersComeFromAFileToo) {
  const test::TemporaryFolder folder;
  const auto text = fmt::format(
      "machine = \"{}\"\nsamples = 3000\nalso = [\"sag\"]\n"
      "correlate = [\"platform.mass, legs.rod.mass = -0.7\"]\n[vary]\n"
      "\"platform.mass\" = \"normal ± 2 %\"\n\"legs.rod.mass\" = \"normal ± 5 %\"\n"
      "\"legs.guide_sleeve.stiffness\" = \"normal ± 3 % per leg correlated 0.6\"\n",
      machine);
  test::write_text(folder / "study.toml", text);
  const auto run =
      test::run_hydrapod({"montecarlo", (folder / "study.toml").string(), "--csv",
                          (folder / "s.csv").string(), "--results", (folder / "s.h5").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto rows = columns_of_rows(folder / "s.csv");
  const auto correlation = [&](const std::string& a, const std::string& b) {
    const auto &x = rows.at(a), &y = rows.at(b);
    double mx = 0.0, my = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      mx += x[k] / static_cast<double>(x.size());
      my += y[k] / static_cast<double>(x.size());
    }
    for (std::size_t k = 0; k < x.size(); ++k) {
      xx += (x[k] - mx) * (x[k] - mx);
      yy += (y[k] - my) * (y[k] - my);
      xy += (x[k] - mx) * (y[k] - my);
    }
    return xy / std::sqrt(xx * yy);
  };
  constexpr double four_deviations = 4.0 / 54.8;  // 1/√3000, at most
  EXPECT_NEAR(correlation("platform.mass [kg]", "legs.rod.mass [kg]"), -0.7, four_deviations);
  EXPECT_NEAR(
      correlation("leg.1.guide_sleeve.stiffness [N/m]", "leg.5.guide_sleeve.stiffness [N/m]"), 0.6,
      four_deviations);
  EXPECT_NEAR(correlation("platform.mass [kg]", "leg.5.guide_sleeve.stiffness [N/m]"), 0.0,
              four_deviations);
  EXPECT_EQ(rows.count("sag [m]"), 1U);
}

/// A table that cannot be written costs neither the results nor a file that nobody names.
TEST(Studies, ResultsAreWrittenBeforeTheTable) {
  const test::TemporaryFolder folder;
  const auto run = test::run_hydrapod({"montecarlo", machine, "--vary",
                                       "platform.mass=normal ± 1 %", "--samples", "900", "--csv",
                                       "/dev/full", "--results", (folder / "s.h5").string()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("/dev/full"));
  EXPECT_TRUE(std::filesystem::exists(folder / "s.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder / "s.h5.rows"));
}

TEST(Studies, SweepAndMapGoThroughTheirGrids) {
  const test::TemporaryFolder folder;
  const auto sweep = test::run_hydrapod(
      {"sweep", machine, "--over", "legs.guide_sleeve.stiffness=1:4:4 kN/mm", "--csv",
       (folder / "sweep.csv").string(), "--results", (folder / "sweep.h5").string()});
  ASSERT_EQ(sweep.exit_code, 0) << sweep.err;
  const auto followed = [&](int modes) {
    return test::run_hydrapod(
        {"sweep", machine, "--over", "legs.guide_sleeve.stiffness=1:4:4 kN/mm", "--modes",
         fmt::format("{}", modes), "--results", (folder / fmt::format("{}.h5", modes)).string()});
  };
  EXPECT_EQ(followed(dynamics::max_dof).exit_code, 0);
  EXPECT_EQ(followed(dynamics::max_dof + 1).exit_code, 2);
  const auto csv = test::read_text(folder / "sweep.csv");
  EXPECT_THAT(csv, HasSubstr("legs.guide_sleeve.stiffness [N/m],status [1],lowest [Hz]"));
  EXPECT_EQ(std::ranges::count(csv, '\n') - std::ranges::count(csv, '#'), 5);
  EXPECT_THAT(csv, HasSubstr("\n2000000,0,"));
  const auto map =
      test::run_hydrapod({"map", machine, "--over", "x=-20:20:5 mm", "--over", "rz=-4:4:3 deg",
                          "--want", "lowest >= 7.4 Hz", "--results", (folder / "map.h5").string(),
                          "--csv", (folder / "map.csv").string()});
  ASSERT_EQ(map.exit_code, 0) << map.err;
  EXPECT_THAT(map.out, HasSubstr("15 rows"));
  const auto table = test::read_text(folder / "map.csv");
  EXPECT_THAT(table, testing::StartsWith("# hydrapod study: "));
  EXPECT_THAT(table, HasSubstr("\npose.x [m],pose.rz [rad],status [1],lowest [Hz]"));
  EXPECT_THAT(map.out, HasSubstr("worst for lowest >= 7.4 Hz: row"));
}

}  // namespace
}  // namespace hydrapod
