/// The job scripts of examples/cluster, as their schedulers call them.

#include <gtest/gtest.h>

#include "ranks.hpp"

namespace hydrapod {
namespace {

struct Cluster : testing::Test {
  test::TemporaryFolder folder{};
  std::string whole{};
  void SetUp() override {
    test::write_text(
        folder / "study.toml",
        "machine = \"" + test::source_file("models/zhang-jiang-2021-transverse.toml").string() +
            "\"\nsamples = 700\nseed = 7\n[vary]\n\"platform.mass\" = \"normal ± 1 %\"\n");
    const auto run = test::run_hydrapod({"montecarlo", "study.toml", "--results", "whole.h5"},
                                        {.folder = folder.path()});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    whole = test::read_text(folder / "whole.h5");
  }
  using Variables = std::vector<std::pair<std::string, std::string>>;
  void script(const std::string& name, Variables variables) {
    variables.emplace_back("HYDRAPOD", test::hydrapod_program().string());
    const auto run =
        test::run_program("bash", {test::source_file("examples/cluster/" + name).string()},
                          {.folder = folder.path(), .variables = variables});
    EXPECT_EQ(run.exit_code, 0) << name << ": " << run.err;
  }
};

TEST_F(Cluster, SlurmArrayIsJoinedToTheWhole) {
  for (const char* part : {"2", "1", "3"})
    script("slurm-array.sh",
           {{"SLURM_ARRAY_TASK_ID", part}, {"PARTS", "3"}, {"SLURM_CPUS_PER_TASK", "1"}});
  script("slurm-array.sh", {{"JOIN", "1"}, {"PARTS", "3"}});
  EXPECT_EQ(test::read_text(folder / "run.h5"), whole);
}

/// Parts without work too: 700 rows are 11 chunks.
TEST_F(Cluster, HyperQueueIsJoinedToTheWhole) {
  for (int part = 1; part <= 13; ++part)
    script("hyperqueue.sh", {{"HQ_TASK_ID", std::to_string(part)}, {"PARTS", "13"}});
  const auto joined = test::run_hydrapod(
      {"montecarlo", "study.toml", "--results", "run.h5", "--shard", "13", "--join"},
      {.folder = folder.path()});
  EXPECT_EQ(joined.exit_code, 0) << joined.err;
  EXPECT_EQ(test::read_text(folder / "run.h5"), whole);
}

TEST_F(Cluster, MpiHasTheSameResult) {
  if (!test::has_mpi()) GTEST_SKIP() << "no MPI";
  script("mpi.sh", {{"OMPI_ALLOW_RUN_AS_ROOT", "1"},
                    {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"},
                    {"OMPI_MCA_rmaps_base_oversubscribe", "1"}});
  EXPECT_EQ(test::read_text(folder / "run.h5"), whole);
}

/// The study file beside the scripts is one that runs.
TEST(ClusterStudy, IsSound) {
  const test::TemporaryFolder folder;
  const auto run =
      test::run_hydrapod({"montecarlo", test::source_file("examples/cluster/study.toml").string(),
                          "--samples", "100", "--results", (folder / "run.h5").string()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

}  // namespace
}  // namespace hydrapod
