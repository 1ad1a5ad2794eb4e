/// Signals as people write them, and trajectories from files.

#include "hydrapod/signals/signals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "hydrapod/base/error.hpp"

namespace hydrapod::signals {
namespace {

Signal parsed(const std::string& text, const TextPlace& place = {}) {
  return read_signals({text}, place).at(0);
}
template <typename T>
T form(const std::string& text, const TextPlace& place = {}) {
  return std::get<T>(parsed(text, place).form);
}
const TextPlace excite{.argument = "--excite", .excitation = true};

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
  return complaint([&] { read_signals({text}, {}); });
}

TEST(SignalText, ReadsEveryKindWithUnits) {
  EXPECT_TRUE(read_signals({"rest"}, {}).empty());
  const auto step = parsed("step z=5 mm, rx = 0.5 deg ,at=200 ms, rise=0.1");
  EXPECT_DOUBLE_EQ(step.size[2], 5e-3);
  EXPECT_DOUBLE_EQ(step.size[3], 0.5 * M_PI / 180.0);
  EXPECT_EQ(std::get<Step>(step.form).at, 0.2);
  EXPECT_EQ(std::get<Step>(step.form).rise, 0.1);
  const auto sine = parsed("sine y=0.01, frequency=2 Hz");
  EXPECT_EQ(sine.size[1], 0.01);
  EXPECT_EQ(std::get<Sine>(sine.form).frequency, 2.0);
  EXPECT_EQ(sine.fade, 0.5);
  const auto sweep = form<Sweep>(" sweep rz=1 deg, from=0.5, to=30 Hz, spacing=linear");
  EXPECT_FALSE(sweep.logarithmic);
  EXPECT_EQ(sweep.to, 30.0);
  EXPECT_EQ(parsed("noise x=1 mm").seed, std::nullopt);
  EXPECT_EQ(parsed("noise x=1 mm, seed=7").seed, 7U);
  EXPECT_EQ(form<Multisine>("multisine x=1 mm, period=4 s").period, 4.0);
  const auto multisine =
      parsed("multisine z=2 mm, ry=0.1 deg, from=1, to=20 Hz, period=4 s, crest=low, experiment=3");
  EXPECT_EQ(multisine.size[2], 2e-3);
  EXPECT_NEAR(multisine.size[4], 0.1 * M_PI / 180.0, 1e-18);
  EXPECT_EQ(std::get<Multisine>(multisine.form).experiment, 3);
  EXPECT_TRUE(std::get<Multisine>(multisine.form).low_crest);
  const auto white = parsed("white, all=0.1 mm, z=2e-4,");
  EXPECT_EQ(white.size[5], 1e-4);
  EXPECT_EQ(white.size[2], 2e-4);
}

/// What only one of `simulate` and `rig` had, both have; levels and turns have the defaults of the
/// place, units those of the entry.
TEST(SignalText, IsOneGrammarWithTheDefaultsOfThePlace) {
  for (const auto& text :
       {"rest", "step all=1 mm", "sine z=1 mm, level=rms", "sweep z=1 mm, turns=2", "chirp z=1 mm",
        "multisine z=-1 mm, slope=-6, fade=1", "white z=0", "noise z=1 mm, seed=3",
        "binary z=1 mm, period=3"})
    for (const auto& place : {TextPlace{}, excite}) EXPECT_NO_THROW(read_signals({text}, place));
  EXPECT_FALSE(form<Sweep>("sweep z=1 mm").rms);
  EXPECT_EQ(form<Sweep>("sweep z=1 mm").turns, 0);
  EXPECT_TRUE(form<Sweep>("sweep z=1 mm", excite).rms);
  EXPECT_EQ(form<Sweep>("sweep z=1 mm", excite).turns, 1);
  EXPECT_EQ(form<Chirp>("chirp z=1 mm", excite).turns, 10);
  EXPECT_FALSE(form<Sine>("sine z=1 mm, level=amplitude", excite).rms);
  auto drive = excite;
  drive.units = drive_units;
  EXPECT_EQ(parsed("binary z=2 %", drive).size[2], 0.02);
  auto wrench = excite;
  wrench.units = wrench_units;
  EXPECT_EQ(parsed("white x=2 kN, rx=3 N m", wrench).size[0], 2000.0);
}

/// What a signal is written as is read as the same signal.
TEST(SignalText, IsWrittenAsItIsRead) {
  EXPECT_EQ(signal_text(parsed("step z=2 mm")), "step z=2 mm, at=0.1 s, rise=0 s");
  EXPECT_EQ(signal_text(parsed("white x=0.1 mm, rx=0.1 mrad, ry=0.5 deg, seed=3")),
            "white x=0.1 mm, rx=0.1 mrad, ry=0.5 deg, fade=0.5 s, seed=3");
  for (const std::string& text :
       {std::string("step rx=1.25 deg, at=0.3 s, rise=0.125 s"),
        std::string("sine x=10 mm, y=-7 mm, frequency=1.5 Hz, level=amplitude, fade=0 s"),
        std::string("sweep z=2 mm, from=0.5 Hz, to=30 Hz, duration=4 s, spacing=log, turns=3, "
                    "level=rms, fade=0.5 s"),
        std::string("chirp z=2 mm, from=0 Hz, to=30 Hz, period=4 s, turns=0, level=amplitude, "
                    "fade=0.5 s"),
        std::string("multisine z=2 mm, from=0.5 Hz, to=20 Hz, period=10 s, slope=-3, crest=low, "
                    "experiment=6, fade=0.5 s, seed=18446744073709551615"),
        std::string("white all=0, fade=0.5 s"),
        std::string("noise x=1 mm, from=0 Hz, to=20 Hz, slope=0, fade=0.5 s, seed=2"),
        std::string("binary rz=3 mrad, to=20 Hz, period=10 s, fade=0.5 s")})
    for (const auto& place : {TextPlace{}, excite})
      EXPECT_EQ(signal_text(parsed(text, place)), text);
}

TEST(SignalText, MistakesAreNamed) {
  EXPECT_EQ(
      command_complaint("stepp z=1"),
      "--command stepp z=1: error: unknown signal 'stepp'; did you mean 'step'? accepted are rest, "
      "step, sine, sweep, chirp, multisine, white, noise, binary, file");
  EXPECT_EQ(complaint([] { read_signals({"multsine z=1 mm"}, excite); }).substr(0, 74),
            "--excite multsine z=1 mm: error: unknown signal 'multsine'; did you mean '");
  EXPECT_EQ(command_complaint("step"),
            "--command step: error: no size is given; for instance \"z=1 mm\", or all=0.0001");
  EXPECT_EQ(command_complaint("step z=5 kg"),
            "--command step z=5 kg: error: z: \"5 kg\" has the unit \"kg\" (a mass), expected a "
            "length such as \"m\"");
  EXPECT_EQ(command_complaint("step z=nan"),
            "--command step z=nan: error: z: \"nan\" is not a finite number");
  EXPECT_EQ(command_complaint("sine z=1 mm, frequencies=2"),
            "--command sine z=1 mm, frequencies=2: error: unknown key 'frequencies'; did you mean "
            "'frequency'? accepted are all, x, y, z, rx, ry, rz, frequency, level, fade");
  EXPECT_EQ(command_complaint("noise z=1 mm, too=20"),
            "--command noise z=1 mm, too=20: error: unknown key 'too'; did you mean 'to'? accepted "
            "are all, x, y, z, rx, ry, rz, from, to, slope, fade, seed");
  EXPECT_EQ(command_complaint("white q=1 mm"),
            "--command white q=1 mm: error: unknown key 'q'; accepted are all, x, y, z, rx, ry, "
            "rz, fade, seed");
  EXPECT_EQ(command_complaint("white z"),
            "--command white z: error: 'z' is no key=value, for instance \"z=1 mm\"");
  EXPECT_EQ(command_complaint("sine z=1 mm, z=2 mm"),
            "--command sine z=1 mm, z=2 mm: error: z is given twice");
  EXPECT_EQ(command_complaint("noise z=1 mm, seed=-1"),
            "--command noise z=1 mm, seed=-1: error: seed is '-1', expected a whole number of 0 or "
            "more");
  EXPECT_EQ(command_complaint("multisine z=1 mm, experiment=7"),
            "--command multisine z=1 mm, experiment=7: error: experiment is 7, expected a whole "
            "number from 1 to 6");
  EXPECT_EQ(command_complaint("sweep z=1 mm, spacing=octave"),
            "--command sweep z=1 mm, spacing=octave: error: spacing is 'octave', expected log or "
            "linear");
  EXPECT_EQ(command_complaint("sine z=1 mm, frequency=600"),
            "--command sine z=1 mm, frequency=600: error: sine: frequency is 600, expected more "
            "than 0 and less than 500 Hz, half the sample rate");
  EXPECT_EQ(command_complaint("rest z=1"), "--command rest z=1: error: rest has no keys");
  EXPECT_EQ(command_complaint("file"),
            "--command file: error: names no file, expected \"file motion.csv\"");
  EXPECT_EQ(command_complaint("file /nowhere/motion.csv"),
            "/nowhere/motion.csv: error: cannot read the file: No such file or directory");
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
  EXPECT_EQ(
      file_complaint("x [mm]\n1\n"),
      "m.csv:1:1: error: no column `time`, expected a header such as \"time [s], x "
      "[mm]\"\nm.csv:1:1: error: no motion column, expected at least one of x, y, z, rx, ry, rz");
  EXPECT_EQ(file_complaint("time, heave [mm]\n0, 1\n"),
            "m.csv:1:7: error: unknown column 'heave'; known are time, x, y, z, rx, ry, rz");
  EXPECT_EQ(file_complaint("time, x [mm], x\n0, 1, 2\n"), "m.csv:1:15: error: x is given twice");
  EXPECT_EQ(file_complaint("time, x [deg]\n0, 1\n"),
            "m.csv:1:10: error: unit of x: \"1 deg\" has the unit \"deg\" (an angle), expected a "
            "length such as \"m\"");
  EXPECT_EQ(file_complaint("time, x [mm\n0, 1\n"),
            "m.csv:1:7: error: unknown column 'x [mm'; known are time, x, y, z, rx, ry, rz");
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
}  // namespace hydrapod::signals
