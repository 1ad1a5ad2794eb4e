/// Twenty kills of ranks and of whole jobs.

#include <gtest/gtest.h>

#include <random>

#include "ranks.hpp"

namespace hydrapod {
namespace {

TEST(RanksLong, TwentyKillsLeaveTheResultAsItIs) {
  if (!test::has_mpi()) GTEST_SKIP() << "no MPI";
  const test::TemporaryFolder folder;
  const auto whole = (folder / "whole.h5").string(), ranks = (folder / "ranks.h5").string();
  const auto study = [](const std::string& results) {
    return std::vector<std::string>{
        "montecarlo", test::source_file("models/zhang-jiang-2021-transverse.toml").string(),
        "--set",      "environment.gravity=9.81",
        "--vary",     "legs.guide_sleeve.stiffness=uniform 200 .. 2000 N/mm per leg",
        "--samples",  "400000",
        "--results",  results};
  };
  ASSERT_EQ(test::run_hydrapod(study(whole), {.timeout = 300.0}).exit_code, 0);
  std::mt19937_64 random(23);
  std::uniform_real_distribution<double> moment(0.1, 1.2);
  int killed = 0;
  for (int kill = 0; kill < 20; ++kill) {
    auto arguments = study(ranks);
    arguments.emplace_back("--force");
    if (kill > 0) arguments.emplace_back("--resume");
    const int ranks_now = 2 + static_cast<int>(random() % 4);
    const int which = static_cast<int>(random() % 5) - 1;
    killed += test::killed_job(test::mpirun(ranks_now, arguments), moment(random), which) ? 1 : 0;
  }
  EXPECT_GE(killed, 10);
  auto last = study(ranks);
  last.insert(last.end(), {"--resume", "--force"});
  const auto end = test::run_program("mpirun", test::mpirun(3, last), {.timeout = 300.0});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(test::read_text(ranks), test::read_text(whole));
}

}  // namespace
}  // namespace hydrapod
