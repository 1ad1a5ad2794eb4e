/// `hydrapod compare`: machines, poses, records and identified modes side by side.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "exact/modal_system.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "support/round_trip.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::string published = test::source_file("models/zhang-jiang-2021.toml");
const std::string heavy = test::source_file("models/heavy-platform.toml");

json compared(std::vector<std::string> arguments, const std::filesystem::path& folder = {}) {
  arguments.insert(arguments.begin(), "compare");
  arguments.insert(arguments.end(), {"--format", "json"});
  const auto run = test::run_hydrapod(arguments, {.folder = folder});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return run.exit_code == 0 ? json::parse(run.out) : json();
}

class Compare : public testing::Test {
 protected:
  test::TemporaryFolder folder;

  /// A record of a chain of three masses with springs of `stiffness`.
  std::string record(const std::string& name, double stiffness, int seed) {
    data::write_record(folder / name,
                       test::record_of(test::chain(3, 1.13, stiffness, 0.021),
                                       {.sample_rate = 50.0,
                                        .samples = 1 << 14,
                                        .output_noise = Eigen::Vector3d::Constant(3e-5),
                                        .seed = static_cast<std::uint64_t>(seed)}),
                       data::format_of_ending(name));
    return name;
  }

  void refused(std::vector<std::string> arguments, const std::string& message) {
    arguments.insert(arguments.begin(), "compare");
    const auto run = test::run_hydrapod(arguments, {.folder = folder.path()});
    EXPECT_EQ(run.exit_code, 2) << message;
    EXPECT_THAT(run.err, HasSubstr(message));
    EXPECT_EQ(run.out, "");
  }
};

TEST_F(Compare, AStifferOilRaisesAllRigidModesByTheRootOfIt) {
  // rigid legs without gravity: K is the oil alone, ω² ∝ its stiffness, here 1.21 × 3.85353e6 N/m
  const auto found =
      compared({published, "--model", "rigid", "--set", "legs.oil_spring.stiffness=4.6627713e6"});
  const auto& pairs = found["comparisons"][0]["pairs"];
  ASSERT_EQ(pairs.size(), 6U);
  for (const auto& pair : pairs) {
    const double a = found["things"][0]["modes"][pair["first"].get<int>() - 1]["omega_rad_s"];
    EXPECT_NEAR(pair["omega_rad_s"]["difference"].get<double>() / a, 0.1, 1e-9);
    EXPECT_NEAR(pair["mac"].get<double>(), 1.0, 1e-9);
    EXPECT_EQ(pair["first"], pair["second"]);
  }
}

TEST_F(Compare, TwoPosesAreTheModesOfEachWithTheSameShape) {
  const auto found = compared({heavy, "--pose", "neutral", "--pose", "low"});
  ASSERT_EQ(found["things"].size(), 2U);
  const auto& comparison = found["comparisons"][0];
  ASSERT_GE(comparison["pairs"].size(), 6U);
  for (const int side : {0, 1}) {
    const auto modes =
        json::parse(test::run_hydrapod({"modes", heavy, "--pose", side == 0 ? "neutral" : "low",
                                        "--format", "json"})
                        .out);
    std::size_t k = 0;
    for (const auto& mode : modes["modes"]) {
      if (!mode["moves_platform"].get<bool>()) continue;
      ASSERT_LT(k, found["things"][side]["modes"].size());
      const auto& one = found["things"][side]["modes"][k++];
      EXPECT_DOUBLE_EQ(one["omega_rad_s"].get<double>(), mode["omega_rad_s"].get<double>());
      EXPECT_DOUBLE_EQ(one["damping_ratio"].get<double>(), mode["damping_ratio"].get<double>());
    }
    EXPECT_EQ(k, found["things"][side]["modes"].size());
  }
  for (const auto& pair : comparison["pairs"]) {
    EXPECT_EQ(pair["omega_rad_s"]["verdict"], "calculated");
    EXPECT_GT(pair["mac"].get<double>(), 0.6);
    const double a = found["things"][0]["modes"][pair["first"].get<int>() - 1]["omega_rad_s"];
    const double b = found["things"][1]["modes"][pair["second"].get<int>() - 1]["omega_rad_s"];
    EXPECT_NEAR(pair["omega_rad_s"]["difference"].get<double>(), b - a, 1e-12 * a);
  }
}

TEST_F(Compare, ARepairIsSeenInRecordsAndItsAbsenceToo) {
  record("before.h5", 1733.0, 3);
  record("again.h5", 1733.0, 4);
  record("after.h5", 1733.0 * 1.05, 5);  // ω by √1.05 = 1.02470
  const auto found = compared({"before.h5", "again.h5", "after.h5"}, folder.path());
  ASSERT_EQ(found["comparisons"].size(), 2U);
  for (const auto& pair : found["comparisons"][0]["pairs"])
    EXPECT_EQ(pair["omega_rad_s"]["verdict"], "not_significant") << pair;
  ASSERT_EQ(found["comparisons"][1]["pairs"].size(), 3U);
  for (const auto& pair : found["comparisons"][1]["pairs"]) {
    EXPECT_EQ(pair["omega_rad_s"]["verdict"], "significant") << pair;
    const double a = found["things"][0]["modes"][pair["first"].get<int>() - 1]["omega_rad_s"];
    const double expected = a * (std::sqrt(1.05) - 1.0);
    EXPECT_NEAR(pair["omega_rad_s"]["difference"].get<double>(), expected,
                4.0 * pair["omega_rad_s"]["deviation"].get<double>());
    EXPECT_GT(pair["mac"].get<double>(), 0.99);
  }
  EXPECT_EQ(found["things"][0]["responses"].size(), 3U);
  test::expect_round_trip(
      report::Json::parse(found.dump()),
      [](const auto& read, const auto& file) { return report::side_by_side_from_json(read, file); },
      [&](const auto& result) {
        auto again = report::side_by_side_json(result);
        again["kind"] = "comparison";
        again["reproduction"] = report::Json::parse(found["reproduction"].dump());
        return again;
      });
}

TEST_F(Compare, IdentifiedModesAreThoseOfTheirRecord) {
  record("before.h5", 1733.0, 3);
  record("after.h5", 1733.0 * 1.05, 5);
  for (const char* output : {"before.json", "before.csv", "before.uff"})
    test::run_hydrapod({"identify", "before.h5", "-o", output}, {.folder = folder.path()});
  const auto expected = compared({"before.h5", "after.h5"}, folder.path());
  for (const char* file : {"before.json", "before.csv", "before.uff"}) {
    const auto found = compared({file, "after.h5"}, folder.path());
    const auto& pairs = found["comparisons"][0]["pairs"];
    ASSERT_EQ(pairs.size(), 3U) << file;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& of_record = expected["comparisons"][0]["pairs"][k]["omega_rad_s"];
      EXPECT_NEAR(pairs[k]["omega_rad_s"]["difference"].get<double>(),
                  of_record["difference"].get<double>(), 2e-4)  // dataset 55 has six digits
          << file;
      EXPECT_EQ(pairs[k]["omega_rad_s"]["verdict"],
                std::string(file).ends_with("uff") ? "cannot_say" : "significant");
    }
  }
}

TEST_F(Compare, AMachineIsComparedAtThePoseThatTheMeasurementStates) {
  const auto rig = test::run_hydrapod(
      {"rig", heavy, "--pose", "low", "--duration", "20 s", "-o", "low.h5", "--quiet"},
      {.folder = folder.path()});
  ASSERT_EQ(rig.exit_code, 0) << rig.err;
  const auto described = [&](std::vector<std::string> things) {
    const auto found = compared(std::move(things), folder.path());
    return found["things"][0]["description"].get<std::string>();
  };
  EXPECT_THAT(described({heavy, "low.h5"}), HasSubstr("pose low as low.h5 states,"));
  EXPECT_THAT(described({heavy + "@low", "low.h5"}), HasSubstr("pose low, "));
  const auto other =
      test::run_hydrapod({"compare", heavy + "@neutral", "low.h5"}, {.folder = folder.path()});
  EXPECT_EQ(other.exit_code, 0);
  EXPECT_THAT(other.out, HasSubstr("pose neutral, "));
  EXPECT_THAT(other.err, HasSubstr("low.h5: warning: states pose low, and " + heavy +
                                   " is compared at pose neutral"));
  const auto stranger =
      test::run_hydrapod({"compare", published, "low.h5"}, {.folder = folder.path()});
  EXPECT_THAT(stranger.err, HasSubstr("low.h5: warning: states a pose that is none of"));
}

/// The rig's record is of the very machine, its valves and its friction: what is left is noise.
TEST_F(Compare, TheResponsesOfTheMachineLieOverThoseOfItsRecord) {
  const auto rig = test::run_hydrapod(
      {"rig", heavy, "--pose", "low", "--duration", "40 s", "-o", "low.h5", "--quiet"},
      {.folder = folder.path()});
  ASSERT_EQ(rig.exit_code, 0) << rig.err;
  const auto found = compared({heavy, "low.h5", "--plot", "low.svg"}, folder.path());
  const auto &machine = found["things"][0]["responses"], &record = found["things"][1]["responses"];
  ASSERT_EQ(record.size(), 6U);
  ASSERT_EQ(machine.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(machine[k]["name"], record[k]["name"]);
    EXPECT_EQ(machine[k]["unit"], record[k]["unit"]);
    ASSERT_EQ(machine[k]["frequency_hz"], record[k]["frequency_hz"]);
    double difference = 0.0, size = 0.0;
    for (std::size_t line = 0; line < record[k]["re"].size(); ++line) {
      const double f = record[k]["frequency_hz"][line];
      if (f < 4.0 || f > 20.0) continue;
      for (const char* part : {"re", "im"}) {
        const double value = record[k][part][line];
        size += value * value;
        difference += std::pow(machine[k][part][line].get<double>() - value, 2);
      }
    }
    EXPECT_GT(size, 0.0);
    EXPECT_LT(std::sqrt(difference / size), 0.08) << record[k]["name"];
  }
  EXPECT_THAT(test::read_text(folder / "low.svg"), HasSubstr("z from drive z"));
  const auto mechanics = compared({heavy, "low.h5", "--against", "mechanics"}, folder.path());
  EXPECT_THAT(mechanics["things"][0]["description"].get<std::string>(),
              HasSubstr("; no responses beside those of low.h5: its inputs are drives, which only "
                        "the plant has"));
  EXPECT_TRUE(mechanics["things"][1]["responses"].empty());
}

TEST_F(Compare, TheTableEndsWithTheVerdictAndCsvHasALinePerPair) {
  record("before.h5", 1733.0, 3);
  record("after.h5", 1733.0 * 1.05, 5);
  const auto run = test::run_hydrapod({"compare", "before.h5", "after.h5", "--plot", "d.svg"},
                                      {.folder = folder.path()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("B − A: 3 of 3 modes of A have a partner; 3 frequencies"));
  EXPECT_THAT(run.out, HasSubstr("z test"));
  EXPECT_GT(std::filesystem::file_size(folder / "d.svg"), 5000U);
  const auto csv = test::run_hydrapod({"compare", "before.h5", "after.h5", "--format", "csv"},
                                      {.folder = folder.path()});
  const auto lines = std::ranges::count(csv.out, '\n');
  EXPECT_EQ(lines, 4);
  const auto commas = std::count(csv.out.begin(), csv.out.begin() + csv.out.find('\n'), ',');
  EXPECT_EQ(std::ranges::count(csv.out, ','), 4 * commas);
}

TEST_F(Compare, WrongUseIsRefusedWithAClearMessage) {
  record("run.h5", 1733.0, 3);
  std::filesystem::create_hard_link(folder / "run.h5", folder / "link.h5");
  test::write_text(folder / "targets.csv", "frequency [Hz],direction\n16.9,x\n");
  test::write_text(folder / "frf.json", R"({"kind": "calibration"})");
  refused({"run.h5"}, "run.h5: error: is one thing; expected at least two");
  refused({heavy}, "is one thing; add another file, or for this machine several --pose, or --set");
  refused({"run.h5", "run.h5"}, "run.h5: error: is given twice; expected two different things");
  refused({"run.h5", "link.h5"}, "link.h5: error: is the same file as run.h5");
  refused({heavy, heavy}, "is given twice");
  refused({heavy + "@low", heavy, "--pose", "low"}, "is the same file as");
  refused({heavy, "--pose", "low", "--pose", "low"}, "is given twice");
  refused({heavy, published, "--pose", "low", "--pose", "neutral"},
          "--pose: error: is given several");
  refused({"run.h5", "link.h5", "--set", "platform.mass=1"}, "--set: error: is of machine files");
  refused({"run.h5", "link.h5", "--pose", "low"}, "--pose: error: is of machine files");
  refused({"run.h5@low", heavy}, "only machine files take a pose");
  refused({heavy + "@lwo", heavy}, "did you mean 'low'?");
  refused({heavy + "@low", "--pose", "low", "--pose", "neutral"}, "says its pose");
  refused({"targets.csv", heavy}, "is a list of targets, not a table of `hydrapod identify`");
  refused({"frf.json", heavy}, "is \"calibration\"; accepted here are");
  refused({"missing.h5", heavy}, "missing.h5");
  refused({"run.h5", heavy, "--level", "60"}, "--level");
  refused({"run.h5", heavy, "--plot", "d.bmp"}, "d.bmp");
  refused({"run.h5", heavy, "-o", "run.h5"}, "run.h5");
}

}  // namespace
}  // namespace hydrapod
