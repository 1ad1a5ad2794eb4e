/// Commands as people write them, and trajectories from files.

#include "hydrapod/simulation/command_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "hydrapod/base/error.hpp"

namespace hydrapod::simulation {
namespace {

template <typename Spec>
Spec parsed(const std::string& text) {
  return std::get<Spec>(parse_command(text, 42).value());
}

template <typename Function>
std::string complaint(Function function) {
  try {
    function();
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}
std::string command_complaint(const std::string& text) {
  return complaint([&] { parse_command(text); });
}

TEST(CommandText, ReadsEveryKindWithUnits) {
  EXPECT_FALSE(parse_command("rest").has_value());
  const auto step = parsed<Step>("step z=5 mm, rx = 0.5 deg ,at=200 ms, rise=0.1");
  EXPECT_DOUBLE_EQ(step.size[2], 5e-3);
  EXPECT_DOUBLE_EQ(step.size[3], 0.5 * M_PI / 180.0);
  EXPECT_EQ(step.at, 0.2);
  EXPECT_EQ(step.rise, 0.1);
  const auto sine = parsed<Sine>("sine y=0.01, frequency=2 Hz");
  EXPECT_EQ(sine.amplitude[1], 0.01);
  EXPECT_EQ(sine.frequency, 2.0);
  EXPECT_EQ(sine.fade, 0.5);
  const auto sweep = parsed<Sweep>(" sweep rz=1 deg, from=0.5, to=30 Hz, spacing=linear");
  EXPECT_FALSE(sweep.logarithmic);
  EXPECT_EQ(sweep.to, 30.0);
  EXPECT_EQ(parsed<Noise>("noise x=1 mm").seed, 42U);
  EXPECT_EQ(parsed<Noise>("noise x=1 mm, seed=7").seed, 7U);
  EXPECT_EQ(parsed<Multisine>("multisine x=1 mm, period=4 s").period, 4.0);
}

TEST(CommandText, MistakesAreNamed) {
  EXPECT_EQ(
      command_complaint("stepp z=1"),
      "--command stepp z=1: error: 'stepp' is no command; did you mean 'step'? known are rest, "
      "step, sine, sweep, multisine, noise, file");
  EXPECT_EQ(
      command_complaint("step"),
      "--command step: error: moves nothing; give a size, for instance \"step z=5 mm\" (x, y, "
      "z, rx, ry, rz)");
  EXPECT_EQ(command_complaint("step z=5 kg"),
            "--command step z=5 kg: error: z: \"5 kg\" has the unit \"kg\" (a mass), expected a "
            "length such as \"m\"");
  EXPECT_EQ(command_complaint("step z=nan"),
            "--command step z=nan: error: z: \"nan\" is not a finite number");
  EXPECT_EQ(command_complaint("sine z=1 mm, frequencies=2"),
            "--command sine z=1 mm, frequencies=2: error: 'frequencies' is unknown; did you mean "
            "'frequency'?");
  EXPECT_EQ(command_complaint("sine z=1 mm, z=2 mm"),
            "--command sine z=1 mm, z=2 mm: error: z is given twice");
  EXPECT_EQ(command_complaint("noise z=1 mm, seed=-1"),
            "--command noise z=1 mm, seed=-1: error: seed is '-1', expected a whole number of 0 or "
            "more");
  EXPECT_EQ(command_complaint("sweep z=1 mm, spacing=octave"),
            "--command sweep z=1 mm, spacing=octave: error: spacing is 'octave', expected log or "
            "linear");
  EXPECT_EQ(command_complaint("file"),
            "--command file: error: names no file, expected \"file motion.csv\"");
  EXPECT_EQ(command_complaint("file /nowhere/motion.csv"),
            "/nowhere/motion.csv: error: cannot be opened: No such file or directory");
}

TEST(TrajectoryFile, ReadsColumnsInTheirUnits) {
  for (const std::string& text :
       {std::string("# a comment\n\ntime [ms], z [mm], rx (deg)\n0, 0, 0\n250, 5, 1.5\n"),
        std::string("\xEF\xBB\xBFt [ms];z [mm];rx [deg]\r\n0;0;0\r\n250;5;1.5\r\n"),
        std::string("time\tz\trx [deg]\n0\t0\t0\n0.25\t5e-3\t+1.5")}) {
    const auto trajectory = parse_trajectory(text, "m.csv");
    ASSERT_EQ(trajectory.times.size(), 2U);
    EXPECT_DOUBLE_EQ(trajectory.times[1], 0.25);
    EXPECT_DOUBLE_EQ(trajectory.points[1][2], 5e-3);
    EXPECT_DOUBLE_EQ(trajectory.points[1][3], 1.5 * M_PI / 180.0);
    EXPECT_EQ(trajectory.points[1][0], 0.0);
  }
}

std::string file_complaint(const std::string& text) {
  return complaint([&] { parse_trajectory(text, "m.csv"); });
}

TEST(TrajectoryFile, MistakesHaveTheirPlace) {
  const std::string head = "time [s], x [mm]\n";
  EXPECT_EQ(
      file_complaint(""),
      "m.csv: error: holds no header, expected a line such as \"time [s], x [mm], rz [deg]\"");
  EXPECT_EQ(file_complaint(head),
            "m.csv: error: holds no point, expected rows of numbers below the "
            "header");
  EXPECT_EQ(file_complaint("x [mm]\n1\n"),
            "m.csv:1:1: error: no column `time`, expected a header such as \"time [s], x [mm]\"\n"
            "m.csv:1:1: error: no column that moves, expected at least one of x, y, z, rx, ry, rz");
  EXPECT_EQ(file_complaint("time, heave [mm]\n0, 1\n"),
            "m.csv:1:7: error: unknown column 'heave'; known are time, x, y, z, rx, ry, rz");
  EXPECT_EQ(file_complaint("time, x [mm], x\n0, 1, 2\n"), "m.csv:1:15: error: x is there twice");
  EXPECT_EQ(file_complaint("time, x [deg]\n0, 1\n"),
            "m.csv:1:10: error: unit of x: \"1 deg\" has the unit \"deg\" (an angle), expected a "
            "length such as \"m\"");
  EXPECT_EQ(file_complaint("time, x [mm\n0, 1\n"), "m.csv:1:7: error: 'x [mm' lacks a ']'");
  EXPECT_EQ(file_complaint(head + "0, 1\n0.1, nan\n"),
            "m.csv:3:6: error: x is 'nan', expected a finite number");
  EXPECT_EQ(file_complaint(head + "0, inf\n"),
            "m.csv:2:4: error: x is 'inf', expected a finite number");
  EXPECT_EQ(file_complaint(head + "0, 1e999\n"),
            "m.csv:2:4: error: x is '1e999', expected a finite number");
  EXPECT_EQ(file_complaint(head + "0, \n"), "m.csv:2:4: error: x is '', expected a finite number");
  EXPECT_EQ(file_complaint(head + "0, 1 mm\n"),
            "m.csv:2:4: error: x is '1 mm', expected a finite number");
  EXPECT_EQ(file_complaint(head + "0, 1\n0.1\n"),
            "m.csv:3:1: error: 1 values, expected 2 as in the header");
  EXPECT_EQ(file_complaint(head + "0, 1\n0.1, 2, 3\n"),
            "m.csv:3:9: error: 3 values, expected 2 as in the header");
  EXPECT_EQ(file_complaint(head + "0, 1\n0.2, 2\n0.1, 3\n"),
            "m.csv:4:1: error: time is 0.1 s after 0.2 s, expected times that ascend");
}

TEST(TrajectoryFile, AllMistakesUpToTwentyAreSaid) {
  std::string text = "time, x\n";
  for (int k = 0; k < 100; ++k) text += "a, b\n";
  const std::string said = file_complaint(text);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 19);
}

TEST(TrajectoryFile, AFolderIsNone) {
  const auto folder = std::filesystem::temp_directory_path().string();
  EXPECT_EQ(complaint([&] { read_trajectory(folder); }),
            folder + ": error: is a directory, expected a CSV file with a trajectory");
}

}  // namespace
}  // namespace hydrapod::simulation
