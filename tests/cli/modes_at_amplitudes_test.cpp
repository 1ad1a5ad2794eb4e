/// `hydrapod modes --amplitude`.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/report/model_results.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using testing::HasSubstr;

const std::string heavy = source_file("models/heavy-platform.toml").string();

RunResult amplitudes(std::vector<std::string> more) {
  more.insert(more.begin(), {"modes", heavy});
  return run_hydrapod(more);
}

TEST(ModesAtAmplitudes, WithoutContactAreThoseOfSmallMotions) {
  const auto small = amplitudes({"--format", "json"});
  const auto run = amplitudes({"--amplitude", "0.01 mm:1 mm:3", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = report::Json::parse(run.out);
  EXPECT_EQ(json["kind"], "modes_at_amplitudes");
  ASSERT_EQ(json["amplitude_m"].size(), 3U);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(json["amplitude_m"][k].get<double>(), 1e-5 * std::pow(10.0, k), 1e-17);
  ASSERT_GE(json["curves"].size(), 6U);
  for (const auto& curve : json["curves"])
    for (const auto& point : curve["points"]) {
      EXPECT_NEAR(point["omega_rad_s"].get<double>(), curve["omega_rad_s"].get<double>(),
                  1e-9 * curve["omega_rad_s"].get<double>());
      EXPECT_EQ(point["legs_on_guide"], 0);
    }
  // what is written is read
  const auto modes = report::modes_at_amplitudes_from_json(json, "run");
  const auto again = report::modes_at_amplitudes_json(modes);
  EXPECT_EQ(again["curves"], json["curves"]);
  const auto table = amplitudes({"--amplitude", "1 mm"});
  EXPECT_THAT(table.out, HasSubstr("Nothing in the file depends on the amplitude"));
}

TEST(ModesAtAmplitudes, MeetTheGuideRing) {
  const auto run = amplitudes(
      {"--amplitude", "0.1 mm:10 mm:5", "--format", "csv", "--set", "legs.guide_sleeve.gap=5 mm"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("mode,direction,amplitude_m,frequency_hz"));
  EXPECT_THAT(run.out, HasSubstr(",6\n"));  // all rods lie on their guides
}

TEST(ModesAtAmplitudes, WrongUseIsRefused) {
  const auto err = [](std::vector<std::string> more) {
    const auto run = amplitudes(std::move(more));
    EXPECT_EQ(run.exit_code, 2);
    return run.err;
  };
  EXPECT_THAT(err({"--amplitude", "-1 mm"}), HasSubstr("expected an amplitude above 0"));
  EXPECT_THAT(err({"--amplitude", "1 mm:2 mm"}), HasSubstr("FROM:TO:COUNT"));
  EXPECT_THAT(err({"--amplitude", "2 mm:1 mm:5"}), HasSubstr("the smaller one first"));
  EXPECT_THAT(err({"--amplitude", "1 mm:2 mm:1"}), HasSubstr("a whole number from 2 to 1000"));
  EXPECT_THAT(err({"--amplitude", "1 kg"}), HasSubstr("a length"));
  EXPECT_THAT(err({"--amplitude", "1 mm", "--system"}), HasSubstr("leave --system out"));
  EXPECT_THAT(err({"--amplitude", "1 mm", "--poses", "all"}), HasSubstr("give --pose once"));
  EXPECT_THAT(err({"--amplitude", "1 mm", "--plot", "a.svg"}),
              HasSubstr("needs several amplitudes"));
}

}  // namespace
}  // namespace hydrapod::test
