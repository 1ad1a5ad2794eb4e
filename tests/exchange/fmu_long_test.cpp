/// Ten seconds of an FMU against the plant that it holds; its sources, compiled from the FMU alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "exchange/fmu_subject.hpp"

namespace hydrapod::test {
namespace {

class FmuLong : public testing::TestWithParam<Case> {};

/// Mechanics alone have no oil springs: nothing brings the platform back, and ten seconds of noise
/// take it out of its workspace.
TEST_P(FmuLong, FollowsThePlantOverTenSecondsOfNoise) {
  expect_same_motion(Subject(GetParam()), 10000);
}

TEST_P(FmuLong, FollowsThePlantInModelExchangeOverTenSecondsOfNoise) {
  expect_same_motion_in_model_exchange(Subject(GetParam()), 10000);
}

INSTANTIATE_TEST_SUITE_P(
    Plant, FmuLong, testing::Values(Case{FmuVersion::fmi2, true}, Case{FmuVersion::fmi3, true}),
    [](const auto& of) {
      return std::string(of.param.version == FmuVersion::fmi2 ? "Fmi2" : "Fmi3");
    });

/// As documentation/index.html of the FMU says, all files one after the other.
std::string compiled(const Unpacked& fmu) {
  const std::string root = fmu.folder() + "/sources", object = fmu.folder() + "/compiled.so";
  std::vector<std::string> objects;
  std::string commands = "set -e\n";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (entry.path().extension() != ".cpp") continue;
    objects.push_back(root + "/" + std::to_string(objects.size()) + ".o");
    commands +=
        "g++ -std=c++20 -O1 -fPIC -fvisibility=hidden -DEIGEN_MAX_ALIGN_BYTES=16 "
        "-DFMT_HEADER_ONLY -I " +
        root + " -I /usr/include/eigen3 -c " + entry.path().string() + " -o " + objects.back() +
        "\n";
  }
  commands += "g++ -shared -o " + object;
  for (const auto& one : objects) commands += " " + one;
  commands += " -lsundials_arkode -lsundials_cvode -lsundials_nvecserial\n";
  const auto run = run_program("/bin/sh", {"-c", commands}, {.timeout = 1500.0});
  EXPECT_EQ(0, run.exit_code) << run.err.substr(0, 3000);
  return object;
}

/// Headers come from Debian and from the FMU, none from this repository.
TEST(FmuSources, CompileFromTheFmuAloneAndMoveTheSame) {
  const auto machine = machine_of("heavy-platform");
  const auto archive = archive_of(
      machine,
      {.version = FmuVersion::fmi3, .sources = exchange::fmu_sources(exchange::fmu_object_file())});
  const Unpacked given(archive), made(archive, compiled);
  EXPECT_NE(given.object, made.object);
  const Slave one(given, true, true, 1e-10), other(made, true, true, 1e-10);
  std::vector<unsigned> references;
  for (const char* name : {"pose.x", "pose.z", "pose.ry", "leg2.p_cap", "leg5.spool"})
    references.push_back(given.reference(name));
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const double force = random.uniform(-5e3, 5e3), command = random.uniform(-0.1, 0.1);
    for (const auto* slave : {&one, &other}) {
      ASSERT_EQ(ok, slave->set("wrench.fx", force));
      ASSERT_EQ(ok, slave->set("leg2.valve_command", command));
      ASSERT_EQ(ok, slave->step(sample * k, sample));
    }
  }
  const auto expected = one.get(references), found = other.get(references);
  for (std::size_t k = 0; k < references.size(); ++k)
    EXPECT_NEAR(expected[k], found[k], 1e-8 * std::max(1.0, std::abs(expected[k])));
}

}  // namespace
}  // namespace hydrapod::test
