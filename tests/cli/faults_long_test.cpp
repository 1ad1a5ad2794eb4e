/// Every write, fsync, rename and opening fails once and for good, and memory at 300 places; 200
/// kills; 50 pairs of commands that write the same file.

#include <algorithm>
#include <cstdio>
#include <thread>

#include "faults.hpp"

namespace hydrapod::test {
namespace {

class FaultsLong : public testing::TestWithParam<WritingCommand> {};

TEST_P(FaultsLong, WhereAnyCallFailsNothingIsLost) {
  if (failing_calls().empty()) GTEST_SKIP() << "a sanitizer's own calls would fail";
  FaultyRuns runs(GetParam());
  for (const bool once : {false, true}) {
    for (const char* calls : {"write", "fsync", "rename", "open", "truncate"})
      for (long number = runs.count(calls); number > 0; --number) runs.fail(calls, number, once);
    const long all = runs.count("memory"), step = std::max(1L, all / 150);
    for (long number = 1; number <= all; number += step) runs.fail("memory", number, once);
  }
}

TEST_P(FaultsLong, KilledAtAnyMomentNothingIsLost) {
  FaultyRuns runs(GetParam());
  const double seconds = runs.seconds();
  int done = 0;
  constexpr int kills = 20;
  for (int k = 0; k < kills; ++k) done += runs.kill_after(1.1 * seconds * (k + 0.5) / kills);
  std::printf("%d kills, %d came too late\n", kills, done);
}

INSTANTIATE_TEST_SUITE_P(Commands, FaultsLong, testing::ValuesIn(writing_commands()), command_name);

/// One of them wins, and its record is whole.
TEST(CrossingWritersLong, LeaveOneWholeRecord) {
  const TemporaryFolder folder;
  write_text(folder / "m.toml", model::starter_machine_file());
  const auto rig = [&](int seed, const std::string& out) {
    return run_hydrapod({"rig", "m.toml", "--model", "rigid", "--duration", "0.5", "--seed",
                         std::to_string(seed), "-o", out},
                        {.folder = folder.path()});
  };
  for (int pair = 0; pair < 50; ++pair) {
    const std::string ending = std::vector<std::string>{"h5", "mat", "csv", "uff", "rpc"}[pair % 5],
                      out = "x." + ending;
    RunResult first, second;
    std::thread other([&] { first = rig(2 * pair + 1, out); });
    second = rig(2 * pair + 2, out);
    other.join();
    EXPECT_EQ((first.exit_code == 0) + (second.exit_code == 0), 1) << first.err << second.err;
    const int seed = 2 * pair + (first.exit_code == 0 ? 1 : 2);
    EXPECT_EQ(rig(seed, "y." + ending).exit_code, 0);
    EXPECT_TRUE(data::read_record((folder / out).string()).record.samples ==
                data::read_record((folder / ("y." + ending)).string()).record.samples);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      if (entry.path().filename() != "m.toml") std::filesystem::remove(entry.path());
  }
}

}  // namespace
}  // namespace hydrapod::test
