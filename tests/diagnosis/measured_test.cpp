/// From identified modes to what a diagnosis compares: turning complex shapes, directions, points.

#include "hydrapod/diagnosis/measured.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "hydrapod/report/identification_json.hpp"
#include "support/calibration_machine.hpp"
#include "support/run_program.hpp"

namespace hydrapod::diagnosis {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

model::MachineFile heavy() {
  return test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")));
}

/// The machine's own mode k at `pose`, as an identification at the point p_PQ would give it: any
/// phase, any size.
MeasuredShape identified(const model::Machine& machine, const std::string& pose, int k,
                         const spatial::Vector3& p_PQ) {
  const auto& X_BP = std::ranges::find(machine.poses, pose, &model::NamedPose::name)->X_BP;
  const auto model = dynamics::linear_model(machine, X_BP, dynamics::ModelKind::guide);
  const auto modes = modal::normal_modes(model);
  spatial::Vector6 motion = modes.shapes.col(k).head<6>();
  motion.head<3>() += motion.tail<3>().cross(X_BP * p_PQ - model.p_BC);
  MeasuredShape measured{.omega = modes.omega(k), .omega_deviation = 1e-3 * modes.omega(k)};
  const auto phase = std::polar(3.7, 1.234);
  for (int d = 0; d < 6; ++d) {
    measured.motion[d] = phase * motion[d];
    measured.motion_deviation[d] = 0.02 * std::abs(measured.motion[d]);
  }
  return measured;
}

TEST(MeasuredModes, OfAnyPointAndPhaseAreTheModelsOwn) {
  const auto machine = heavy().machine;
  for (const char* pose : {"neutral", "pitched"})
    for (const spatial::Vector3& point :
         {spatial::Vector3(0.0, 0.0, 0.0), spatial::Vector3(0.31, -0.17, 0.44)})
      for (const int k : {0, 1, 4, 13, 17}) {
        const auto target =
            mode_target(identified(machine, pose, k, point), "mode", machine, {pose, point});
        ASSERT_TRUE(target.shape);
        const auto& X_BP = std::ranges::find(machine.poses, pose, &model::NamedPose::name)->X_BP;
        const auto model = dynamics::linear_model(machine, X_BP, dynamics::ModelKind::guide);
        const auto modes = modal::normal_modes(model);
        EXPECT_NEAR(
            observation::platform_mac(model, modes, k, observation::shape_at_center(model, target)),
            1.0, 1e-9);
        EXPECT_GT(observation::direction_share(model, modes, k, *target.direction), 0.3);
      }
}

TEST(MeasuredModes, WhatIsImaginaryIsNotTrusted) {
  const auto machine = heavy().machine;
  auto measured = identified(machine, "neutral", 0, spatial::Vector3::Zero());
  const double before =
      mode_target(measured, "", machine, {"neutral", spatial::Vector3::Zero()}).shape_deviation;
  measured.motion[0] *= std::polar(1.0, 0.3);  // two directions out of step
  const double after =
      mode_target(measured, "", machine, {"neutral", spatial::Vector3::Zero()}).shape_deviation;
  EXPECT_GT(after, before + 0.03);
}

TEST(MeasuredModes, AreTrustedAsFarAsTheModalModelHoldsEverything) {
  const auto machine = heavy().machine;
  const MeasuredAt at{"neutral", spatial::Vector3::Zero()};
  auto measured = identified(machine, "neutral", 0, spatial::Vector3::Zero());
  measured.damping = 0.043;
  const double known_to = mode_target(measured, "", machine, at).deviation;
  EXPECT_NEAR(known_to, measured.omega_deviation, 1e-12 * measured.omega);
  const double half_width = measured.damping * measured.omega;

  auto coarse = measured;
  coarse.line_spacing = 7.7;
  EXPECT_NEAR(mode_target(coarse, "", machine, at).deviation, std::hypot(known_to, 0.05 * 7.7),
              1e-12);

  auto mixture = measured;
  for (int d = 0; d < 6; ++d) mixture.motion[d] = std::polar(0.37, 0.9 * d);
  EXPECT_GT(mode_target(mixture, "", machine, at).deviation, known_to + 0.2 * half_width);

  // a weak one in the flank of a strong one, and not the strong one
  measured.significance = 8000.0;
  auto weak = measured, far = measured;
  weak.significance = 80.0;
  weak.omega += 1.9 * half_width;
  far.significance = 80.0;
  far.omega += 3.1 * half_width;
  observation::Targets targets;
  add_modes({measured, weak, far}, machine, at, targets);
  ASSERT_EQ(targets.modes.size(), 3U);
  EXPECT_NEAR(targets.modes[0].deviation, known_to, 1e-12 * measured.omega);
  EXPECT_NEAR(targets.modes[1].deviation, std::hypot(known_to, 0.5 * weak.damping * weak.omega),
              1e-12 * measured.omega);
  EXPECT_NEAR(targets.modes[2].deviation, known_to, 1e-12 * measured.omega);
}

TEST(MeasuredModes, WithoutAllSixDirectionsKeepTheLargestOne) {
  const auto machine = heavy().machine;
  auto measured = identified(machine, "neutral", 1, spatial::Vector3::Zero());
  for (const int missing : {3, 4, 5}) measured.motion[missing] = {nan, nan};
  const auto target = mode_target(measured, "", machine, {"neutral", spatial::Vector3::Zero()});
  EXPECT_FALSE(target.shape);
  EXPECT_EQ(target.direction, 1);
  measured.motion.fill({nan, nan});
  EXPECT_FALSE(mode_target(measured, "", machine, {"neutral", spatial::Vector3::Zero()}).direction);
}

report::Json identified_json() {
  return report::Json::parse(R"({"kind": "identified_modes",
    "outputs": [{"name": "x", "unit": "m", "direction": "x"},
                {"name": "up", "unit": "m", "direction": "-z"},
                {"name": "p", "unit": "Pa", "direction": ""}],
    "modes": [{"frequency_hz": 4.1, "frequency_95_hz": 0.0196, "damping_ratio": 0.03,
               "damping_95": 0.00196,
               "shape": {"re": [2, 0.2, 7], "im": [0, 0, 0]},
               "shape_deviation": [0.02, 0.01, 1],
               "displacement_shape": {"re": [1, 0.1, 3], "im": [0, 0, 0]}}]})");
}

TEST(MeasuredModes, AreReadFromTheJsonOfIdentify) {
  const auto machine = heavy().machine;
  const auto targets = measured_modes(
      report::identification_from_json(identified_json(), "modes.json"), machine, {});
  ASSERT_EQ(targets.modes.size(), 1U);
  const auto& mode = targets.modes.front();
  EXPECT_NEAR(mode.omega, 2.0 * std::numbers::pi * 4.1, 1e-9);
  EXPECT_NEAR(mode.deviation, 2.0 * std::numbers::pi * 0.01, 1e-12);
  EXPECT_NEAR(mode.damping.value_or(0.0), 0.03, 1e-15);
  EXPECT_NEAR(mode.damping_deviation, 0.001, 1e-15);
  EXPECT_EQ(mode.direction, 0);
  // the lines of the responses, where they are said
  auto json = identified_json();
  json["indicator"] = {{"frequency_hz", {1.0, 1.7, 2.4}}};
  EXPECT_NEAR(measured_modes(report::identification_from_json(json, ""), machine, {})
                  .modes.front()
                  .deviation,
              2.0 * std::numbers::pi * std::hypot(0.01, 0.05 * 0.7), 1e-12);
  json["indicator"] = {1.0, 1.7};
  EXPECT_NEAR(measured_modes(report::identification_from_json(json, ""), machine, {})
                  .modes.front()
                  .deviation,
              2.0 * std::numbers::pi * 0.01, 1e-12);
}

/// Legs and poses see the platform from the base, accelerometers feel the ground.
TEST(MeasuredModes, SayWhatTheyAreAgainst) {
  using observation::MotionAgainst;
  const auto machine = heavy().machine;
  identification::Identification found;
  identification::IdentifiedMode mode;
  mode.fit.pole = {-0.7, 31.0};
  mode.fit.shape = mode.displacement = Eigen::VectorXcd::Ones(6);
  mode.fit.shape_deviation = Eigen::VectorXd::Constant(6, 0.01);
  found.modes = {mode};
  const auto against = [&](const std::array<const char*, 2>& units, MeasuredAt at = {}) {
    auto& outputs = found.responses.outputs;
    outputs.clear();
    report::Json json{
        {"outputs", report::Json::array()},
        {"modes",
         {{{"frequency_hz", 4.9},
           {"frequency_95_hz", 0.02},
           {"damping_ratio", 0.03},
           {"damping_95", 0.002},
           {"displacement_shape",
            {{"re", std::vector<double>(6, 1.0)}, {"im", std::vector<double>(6, 0.0)}}}}}}};
    for (int d = 1; d <= 6; ++d) {
      const auto direction = static_cast<data::Direction>(d);
      outputs.push_back({.unit = units[d > 3], .direction = direction});
      json["outputs"].push_back(
          {{"unit", units[d > 3]}, {"direction", data::direction_text(direction)}});
    }
    const auto one = measured_modes(found, machine, at).modes.front().shape_against;
    const auto other =
        measured_modes(report::identification_from_json(json, "modes.json"), machine, at)
            .modes.front()
            .shape_against;
    EXPECT_EQ(one, other);
    return one;
  };
  EXPECT_EQ(against({"m", "rad"}), MotionAgainst::base);
  EXPECT_EQ(against({"m/s", "rad/s"}), MotionAgainst::base);
  EXPECT_EQ(against({"m/s^2", "rad/s^2"}), MotionAgainst::ground);
  EXPECT_EQ(against({"m/s^2", "rad"}), MotionAgainst::base);
  MeasuredAt on_the_floor;
  on_the_floor.against = MotionAgainst::ground;
  EXPECT_EQ(against({"m", "rad"}, on_the_floor), MotionAgainst::ground);
}

TEST(MeasuredModes, WrongJsonIsNamed) {
  const auto machine = heavy().machine;
  const auto message = [&](const report::Json& json) {
    try {
      measured_modes(report::identification_from_json(json, "modes.json"), machine, {});
    } catch (const base::InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  auto json = identified_json();
  json["modes"][0].erase("frequency_hz");
  EXPECT_THAT(message(json), testing::HasSubstr("modes[0].frequency_hz"));
  json = identified_json();
  json["modes"][0]["displacement_shape"]["im"] = {1};
  EXPECT_THAT(message(json), testing::HasSubstr("displacement_shape"));
  json = identified_json();
  json.erase("outputs");
  EXPECT_THAT(message(json), testing::HasSubstr("outputs"));
  json = identified_json();
  json["modes"] = report::Json::array();
  EXPECT_THAT(message(json), testing::HasSubstr("no mode was identified"));
  json["modes"] = {3};
  EXPECT_THAT(message(json), testing::HasSubstr("modes[0]: expected an object"));
}

}  // namespace
}  // namespace hydrapod::diagnosis
