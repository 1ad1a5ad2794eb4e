/// `mpirun hydrapod montecarlo`.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "ranks.hpp"

namespace hydrapod {
namespace {

using testing::HasSubstr;

std::vector<std::string> study(const std::string& results, const std::string& samples,
                               const std::vector<std::string>& more = {}) {
  std::vector<std::string> all{
      "montecarlo", test::source_file("models/zhang-jiang-2021-transverse.toml").string(),
      "--set",      "environment.gravity=9.81",
      "--vary",     "legs.guide_sleeve.stiffness=uniform 200 .. 2000 N/mm per leg",
      "--samples",  samples,
      "--results",  results};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

struct Ranks : testing::Test {
  test::TemporaryFolder folder{};
  std::string whole = (folder / "whole.h5").string(), ranks = (folder / "ranks.h5").string();
  void SetUp() override {
    if (!test::has_mpi()) GTEST_SKIP() << "no MPI";
  }
};

TEST_F(Ranks, HaveTheResultOfAProgramAlone) {
  const auto alone = test::run_hydrapod(study(whole, "5000"));
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const auto team = test::run_program("mpirun", test::mpirun(3, study(ranks, "5000")));
  ASSERT_EQ(team.exit_code, 0) << team.err;
  EXPECT_EQ(test::read_text(ranks), test::read_text(whole));
  EXPECT_EQ(team.out, alone.out) << "one rank prints";
  EXPECT_THAT(team.err, HasSubstr("by 3 ranks"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

/// Ranks and whole jobs, killed at some moments; then other numbers of ranks, and none, go on.
TEST_F(Ranks, ThatAreKilledLoseNothingThatWasComputed) {
  const std::string samples = "60000";
  ASSERT_EQ(test::run_hydrapod(study(whole, samples)).exit_code, 0);
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> moment(0.3, 0.9);
  int killed = 0;
  for (int kill = 0; kill < 4; ++kill) {
    const auto arguments = kill == 0 ? study(ranks, samples) : study(ranks, samples, {"--resume"});
    killed +=
        test::killed_job(test::mpirun(2 + kill % 2, arguments), moment(random), kill - 1) ? 1 : 0;
  }
  EXPECT_GT(killed, 0);
  const auto last = test::run_hydrapod(study(ranks, samples, {"--resume", "--force"}));
  ASSERT_EQ(last.exit_code, 0) << last.err;
  EXPECT_EQ(test::read_text(ranks), test::read_text(whole));
}

TEST_F(Ranks, SayOnceWhatIsWrong) {
  const auto once = [](const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count == 1;
  };
  const auto more_than_work = test::run_program("mpirun", test::mpirun(3, study(ranks, "100")));
  EXPECT_NE(more_than_work.exit_code, 0);
  EXPECT_TRUE(once(more_than_work.err, "3 ranks: error: more ranks than work"))
      << more_than_work.err;
  const auto unknown =
      test::run_program("mpirun", test::mpirun(3, study(ranks, "1000", {"--want", "q >= 3 Hz"})));
  EXPECT_NE(unknown.exit_code, 0);
  EXPECT_TRUE(once(unknown.err, "unknown output 'q'")) << unknown.err;
  const auto shards =
      test::run_program("mpirun", test::mpirun(2, study(ranks, "1000", {"--shard", "1/2"})));
  EXPECT_TRUE(once(shards.err, "--shard: error")) << shards.err;
  const auto huge = test::run_program("mpirun", test::mpirun(2, study(ranks, "1000000000000")));
  EXPECT_TRUE(once(huge.err, "GB left")) << huge.err;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// Started by mpirun of an MPI that this program does not have.
TEST(Mpirun, OfAnotherMpiIsRefused) {
  const test::TemporaryFolder folder;
  const auto results = (folder / "run.h5").string();
  const auto other = test::run_hydrapod(study(results, "1000"), {.variables = {{"PMI_SIZE", "4"}}});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("--no-mpi"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  const auto alone =
      test::run_hydrapod(study(results, "1000", {"--no-mpi"}), {.variables = {{"PMI_SIZE", "4"}}});
  EXPECT_EQ(alone.exit_code, 0) << alone.err;
}

}  // namespace
}  // namespace hydrapod
