/// A sample of tests/cli/faults_long_test.cpp, which has every call.

#include "faults.hpp"

namespace hydrapod::test {
namespace {

class Faults : public testing::TestWithParam<WritingCommand> {};

TEST_P(Faults, WhereACallFailsNothingIsLost) {
  if (failing_calls().empty()) GTEST_SKIP() << "a sanitizer's own calls would fail";
  FaultyRuns runs(GetParam());
  for (const char* calls : {"write", "fsync", "rename", "open"}) {
    const long all = runs.count(calls);
    EXPECT_GE(all, 1) << calls;
    runs.fail(calls, 1, false);
    if (all > 1) runs.fail(calls, all, false);
  }
  const long all = runs.count("memory");
  EXPECT_GE(all, 1000);
  for (const double share : {0.5, 0.97})
    runs.fail("memory", static_cast<long>(share * static_cast<double>(all)), share < 0.6);
}

TEST_P(Faults, KilledNothingIsLost) {
  FaultyRuns runs(GetParam());
  const double seconds = runs.seconds();
  for (const double share : {0.5, 0.95}) runs.kill_after(share * seconds);
}

INSTANTIATE_TEST_SUITE_P(Commands, Faults, testing::ValuesIn(writing_commands()), command_name);

}  // namespace
}  // namespace hydrapod::test
