/// `hydrapod modes --amplitude`.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/report/model_results.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using testing::HasSubstr;

const std::string heavy_model = source_file("models/heavy-platform.toml").string();

RunResult amplitudes(std::vector<std::string> more) {
  more.insert(more.begin(), {"modes", heavy_model});
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

/// With a gap just above the static offset of 3.4 mm the branches of x and y turn back.
TEST(ModesAtAmplitudes, SayWhereTheBranchTurnsBackAndHaveAllItsSolutions) {
  const std::vector<std::string> words{"--amplitude", "0.1 mm:5 mm:5", "--set",
                                       "legs.guide_sleeve.gap=3.6 mm"};
  auto as_json = words;
  as_json.insert(as_json.end(), {"--format", "json"});
  const auto run = amplitudes(as_json);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = report::Json::parse(run.out);
  const auto& x = json["curves"][0];
  EXPECT_EQ(x["end"], "local");
  EXPECT_FALSE(x["further"].empty());
  EXPECT_GT(x["turning_points"][0]["amplitude_m"], 1e-4);
  EXPECT_LT(x["turning_points"][0]["amplitude_m"], 5e-3);
  EXPECT_FALSE(x["points"][4]["converged"].get<bool>());
  // Long swings are on another branch of the same mode.
  const auto second = std::ranges::find_if(json["curves"], [&](const report::Json& curve) {
    return curve["mode"] == x["mode"] && curve["from_long_swings"].get<bool>();
  });
  ASSERT_NE(second, json["curves"].end());
  EXPECT_TRUE((*second)["points"][4]["converged"].get<bool>());
  const auto again =
      report::modes_at_amplitudes_json(report::modes_at_amplitudes_from_json(json, "run"));
  EXPECT_EQ(again["curves"], json["curves"]);
  const auto table = amplitudes(words);
  EXPECT_THAT(table.out, HasSubstr("Several rows of one amplitude"));
  EXPECT_THAT(table.out, HasSubstr("Where branches end:"));
  EXPECT_THAT(table.out, HasSubstr("turns back at "));
  EXPECT_THAT(table.out, HasSubstr("x, from long swings"));
}

/// Joints that stick hold the rods upright: the highest x mode of small swings is that of rigid
/// legs, 6.11 Hz and more.
TEST(ModesAtAmplitudes, HaveTheFrictionOfJoints) {
  const auto x_of = [](const std::string& more) {
    const auto run = amplitudes({"--amplitude", "0.001 mm", "--format", "json", "--set",
                                 "legs.joint_friction.coulomb=40 N m", "--set", more});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    std::vector<double> found;
    const auto json = report::Json::parse(run.out);
    for (const auto& curve : json["curves"])
      for (const auto& point : curve["points"])
        if (curve["direction"] == "x" && point["converged"].get<bool>())
          found.push_back(point["frequency_hz"].get<double>());
    return found;
  };
  const auto sticking = x_of("legs.joint_friction.bristle_stiffness=300 kN m/rad");
  ASSERT_EQ(sticking.size(), 1U);
  EXPECT_NEAR(sticking[0], 6.19, 0.02);
  EXPECT_EQ(x_of("legs.joint_friction.smoothing_rate=0.01").size(), 2U);
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

/// Other programs see how far it is; Ctrl-C is then a wish to stop too (terminal.hpp).
TEST(ModesAtAmplitudes, SayHowFarTheyAre) {
  const auto run = run_hydrapod({"modes", heavy_model, "--amplitude", "0.1 mm:1 mm:3"},
                                {.variables = {{"HYDRAPOD_PROGRESS", "1"}}});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("progress 0."));
}

}  // namespace
}  // namespace hydrapod::test
