/// `hydrapod diagnose` from what a hammer with a force sensor shows, in a Universal File.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "support/calibration_machine.hpp"
#include "support/json_fields.hpp"

namespace hydrapod {
namespace {

using test::run_hydrapod;
using testing::HasSubstr;

class DiagnoseForces : public testing::Test {
 protected:
  const std::string machine_ = test::source_file("models/heavy-platform.toml").string();
  test::TemporaryFolder folder_;

  /// Accelerations of the mass centre of the machine with its soft sleeves, for forces there.
  std::string hammer() {
    const auto machine = test::machine_file(test::read_text(machine_)).machine;
    const auto model =
        dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::guide);
    const auto at_center =
        response::response_model(model, modal::normal_modes(model),
                                 modal::modal_ratio(machine).value, machine.platform.mass_center);
    data::FrequencyResponses file{.title = "hammer"};
    std::vector<double> omega;
    for (int line = 20; line <= 400; ++line) omega.push_back(2.0 * std::numbers::pi * 0.05 * line);
    for (const double each : omega) file.frequency.push_back(each / (2.0 * std::numbers::pi));
    for (int k = 0; k < 6; ++k) {
      const auto direction = static_cast<data::Direction>(k + 1);
      file.outputs.push_back({.name = "acceleration " + std::to_string(k + 1),
                              .unit = k < 3 ? "m/s^2" : "rad/s^2",
                              .direction = direction,
                              .role = data::Role::response,
                              .point = 7});
      file.inputs.push_back({.name = "force " + std::to_string(k + 1),
                             .unit = k < 3 ? "N" : "N m",
                             .direction = direction,
                             .role = data::Role::excitation,
                             .point = 7});
    }
    for (const auto& H :
         response::frequency_response(at_center, omega, response::Output::acceleration))
      file.H.emplace_back(H);
    const auto path = (folder_ / "hammer.uff").string();
    data::write_frequency_responses(path, file);
    return path;
  }

  test::RunResult diagnose(const std::string& measured, std::vector<std::string> more) {
    std::vector<std::string> all{
        "diagnose",   machine_, "--set",    "legs.guide_sleeve.stiffness=3e6",
        "--measured", measured, "--format", "json"};
    all.insert(all.end(), more.begin(), more.end());
    return run_hydrapod(all);
  }
};

TEST_F(DiagnoseForces, NameTheSleevesFromAUniversalFile) {
  const auto run = diagnose(hammer(), {});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["observed"], "mechanics");
  ASSERT_EQ(json["response_lines"].size(), 1U);
  EXPECT_EQ(json["response_lines"][0]["entry"], "forces");
  const auto& best = json["hypotheses"][0];
  EXPECT_EQ(best["name"], "guide sleeves of all legs");
  EXPECT_NEAR(best["parameters"][0]["value"].get<double>(), 0.84e6, 0.01 * 0.84e6);
  EXPECT_FALSE(best["response_misfit"].is_null());
}

TEST_F(DiagnoseForces, AreLeftOutWhenAskedTo) {
  const auto run = diagnose(hammer(), {"--modes-only"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(nlohmann::json::parse(run.out)["response_lines"].empty());
}

TEST_F(DiagnoseForces, OfAnUnknownSystemAreRefusedBeforeAnythingIsRead) {
  const auto run = diagnose("missing.uff", {"--against", "modal"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--against modal"));
  EXPECT_THAT(run.err, HasSubstr("mechanics, plant"));
}

}  // namespace
}  // namespace hydrapod
