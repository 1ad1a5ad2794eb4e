/// Sizes that a user gives have bounds. What is beyond them is refused before the work, with the
/// number and what would be accepted; what is within them stays within time and memory.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <fstream>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using test::run_hydrapod;
using testing::HasSubstr;

const std::string machine = test::source_file("models/heavy-platform.toml").string();

/// Of all programs that this one has run [MB].
double largest_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

struct Case {
  std::vector<std::string> arguments{};
  std::string message{};  ///< a part of what is said
};

/// Seconds: refusing takes a few hundredths of one, and a step that is given up takes some.
void expect_refused(const Case& one, int exit_code, double seconds) {
  const test::TemporaryFolder folder;
  const auto begin = std::chrono::steady_clock::now();
  const auto result = run_hydrapod(one.arguments, {.folder = folder.path()});
  const double spent =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(result.exit_code, exit_code) << testing::PrintToString(one.arguments) << result.err;
  EXPECT_THAT(result.err, HasSubstr(one.message)) << testing::PrintToString(one.arguments);
  EXPECT_LT(spent, seconds) << testing::PrintToString(one.arguments);
}

std::vector<std::string> rig(const std::vector<std::string>& more) {
  std::vector<std::string> all{"rig", machine, "-o", "run.h5"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::vector<std::string> simulate(const std::vector<std::string>& more) {
  std::vector<std::string> all{"simulate", machine};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST(Budgets, WhatWouldTakeForEverIsRefusedBeforehand) {
  const std::vector<Case> cases{
      {rig({"--excite", "multisine all=0.01 mm, period=10000, to=1"}),
       "period is 10000, expected at most two million samples"},
      {rig({"--excite", "multisine all=0.01 mm, period=1000, to=100, crest=low"}),
       "expected none above the 10000th: take a shorter period, a lower band or crest=random"},
      {rig({"--excite", "multisine all=0.01 mm, period=1000.003, to=400"}),
       "a multiple of the prime number"},
      {rig({"--duration", "1e12"}), "expected at most 1e+09"},
      {rig({"--settling", "1e12", "--duration", "1"}), "expected at most 1e+09"},
      {rig({"--rate", "1e12", "--duration", "0.01"}), "expected at most 1e+09"},
      {simulate({"--until", "1e12"}),
       "1e+12 s are 1e+15 samples of the controller's 0.001 s, expected at most 1e+09, which are "
       "1e+06 s"},
      {simulate({"--until", "1", "--dt-output", "1e-12"}),
       "1 s are 1e+12 samples of the record's 1e-12 s, expected at most 1e+09"},
      {simulate({"--command", "file /dev/zero"}), "the line is longer than 16 MiB"},
  };
  for (const auto& one : cases) expect_refused(one, 2, 10.0);
  EXPECT_LT(largest_memory(), 300.0);
}

/// Machines so stiff that no integrator gets through them.
TEST(Budgets, StepsThatAreTooShortAreGivenUp) {
  const std::vector<Case> cases{
      {simulate({"--integrator", "fixed", "--step", "1e-12"}), "expected at most 20000"},
      {simulate({"--set", "legs.valve.natural_frequency=1e9 rad/s", "--integrator", "adaptive"}),
       "spool"},
      {simulate({"--set", "legs.valve.natural_frequency=1e9 rad/s", "--integrator", "adams"}),
       "expected are at most 500000 1/s, or at most 300000 steps"},
      {simulate({"--set", "legs.oil_spring.cylinder.bore=1e4 m"}), "fastest: "},
      {simulate({"--set", "legs.oil_spring.cylinder.bore=1000 m"}), "fastest: "},
      {rig({"--set", "legs.oil_spring.cylinder.bore=1000 m"}), "fastest: "},
      // at rest nothing touches the stops
      {simulate({"--set", "legs.end_stops.stiffness=1e17 N/m", "--set", "controller.gain=60",
                 "--command", "step z=117 mm", "--until", "0.6"}),
       "simulation stopped at 0.3"},
  };
  for (const auto& one : cases) expect_refused(one, 1, 30.0);
  EXPECT_LT(largest_memory(), 300.0);
}

/// A table on cylinders with a bore of a metre is a machine.
TEST(Budgets, LargeBoresPass) {
  const test::TemporaryFolder folder;
  const auto result =
      run_hydrapod({"simulate", machine, "--set", "legs.oil_spring.cylinder.bore=1 m", "--command",
                    "step z=0.1 mm", "--until", "0.05"},
                   {.folder = folder.path()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

/// A small file must not take the memory of the largest one that would be read.
TEST(Budgets, MemoryIsThatOfTheFile) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "modes.json", R"({"kind": "bode"})");
  const auto result =
      run_hydrapod({"diagnose", machine, "--measured", "modes.json"}, {.folder = folder.path()});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr("accepted here are"));
  EXPECT_LT(largest_memory(), 100.0);
}

/// As many rows as a trajectory may have are read; one more is refused.
TEST(Budgets, TrajectoriesHaveAMillionPoints) {
  const test::TemporaryFolder folder;
  std::ofstream file(folder / "motion.csv");
  file << "time [s], x [mm]\n";
  for (int k = 0; k <= 1'000'000; ++k) file << k << ",0\n";
  file.close();
  const auto result =
      run_hydrapod({"simulate", machine, "--command", "file motion.csv", "--until", "0.01"},
                   {.folder = folder.path()});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr("motion.csv:1000002:1: error: holds more than 1000000 points"));
  EXPECT_LT(largest_memory(), 300.0);
}

}  // namespace
}  // namespace hydrapod
