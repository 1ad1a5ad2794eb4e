/// From identified modes to what a diagnosis compares: turning complex shapes, directions, points.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "support/calibration_machine.hpp"
#include "support/run_program.hpp"

namespace hydrapod::observation {
namespace {

model::MachineFile heavy() {
  return test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")));
}

/// The six directions of the platform.
std::vector<data::Channel> directions() {
  std::vector<data::Channel> outputs;
  for (int d = 1; d <= 6; ++d)
    outputs.push_back({.unit = d < 4 ? "m" : "rad", .direction = static_cast<data::Direction>(d)});
  return outputs;
}

/// The machine's own mode k at `pose`, as an identification at the point p_PQ would give it: any
/// phase, any size.
data::ModalResult identified(const model::Machine& machine, const std::string& pose, int k,
                             const spatial::Vector3& p_PQ, double damping = 0.0) {
  const auto& X_BP = std::ranges::find(machine.poses, pose, &model::NamedPose::name)->X_BP;
  const auto model = dynamics::linear_model(machine, X_BP, dynamics::ModelKind::guide);
  const auto modes = modal::normal_modes(model);
  Vector6 motion = modes.shapes.col(k).head<6>();
  motion.head<3>() += motion.tail<3>().cross(X_BP * p_PQ - model.p_BC);
  return {
      .pole = modes.omega(k) * std::complex<double>(-damping, std::sqrt(1.0 - damping * damping)),
      .shape = std::polar(3.7, 1.234) * motion,
      .omega_deviation = 1e-3 * modes.omega(k),
      .shape_deviation = 0.02 * 3.7 * motion.cwiseAbs()};
}

ModeTarget mode_target(const data::ModalResult& mode, const model::Machine& machine,
                       const MeasuredAt& at, double line_spacing = 0.0) {
  return measured_modes({.outputs = directions(), .line_spacing = line_spacing, .modes = {mode}},
                        machine, at)
      .modes.front();
}

TEST(MeasuredModes, OfAnyPointAndPhaseAreTheModelsOwn) {
  const auto machine = heavy().machine;
  for (const char* pose : {"neutral", "pitched"})
    for (const spatial::Vector3& point :
         {spatial::Vector3(0.0, 0.0, 0.0), spatial::Vector3(0.31, -0.17, 0.44)})
      for (const int k : {0, 1, 4, 13, 17}) {
        const auto target =
            mode_target(identified(machine, pose, k, point), machine, {pose, point});
        ASSERT_TRUE(target.shape);
        const auto& X_BP = std::ranges::find(machine.poses, pose, &model::NamedPose::name)->X_BP;
        const auto model = dynamics::linear_model(machine, X_BP, dynamics::ModelKind::guide);
        const Observation seen{.mechanics = model,
                               .modes = undamped_modes(model, modal::normal_modes(model))};
        EXPECT_NEAR(shown_mac(seen, {k}, target), 1.0, 1e-9);
        EXPECT_GT(direction_share(seen, k, *target.direction), 0.3);
      }
}

/// Sensors the other way round, any phase: the motion is real, as large as measured, and in its
/// directions.
TEST(MeasuredModes, AreTurnedToTheirRealMotion) {
  const auto machine = heavy().machine;
  const spatial::Vector3 point(0.31, -0.17, 0.44);
  for (const int k : {0, 1, 4}) {
    auto mode = identified(machine, "pitched", k, point);
    const Vector6 motion = (mode.shape * std::polar(1.0, -1.234)).real();
    auto outputs = directions();
    for (const std::size_t turned : {1U, 2U, 5U}) {
      outputs[turned].direction =
          static_cast<data::Direction>(-static_cast<int>(outputs[turned].direction));
      mode.shape[static_cast<Eigen::Index>(turned)] *= -1.0;
    }
    const auto target =
        measured_modes({.outputs = outputs, .modes = {mode}}, machine, {"pitched", point})
            .modes.front();
    ASSERT_TRUE(target.shape);
    const double sign = target.shape->dot(motion) < 0.0 ? -1.0 : 1.0;
    EXPECT_LT((sign * *target.shape - motion).norm(), 1e-12 * motion.norm()) << k;
    EXPECT_LT(target.complex_shape->motion.imag().norm(), 1e-12 * motion.norm()) << k;
  }
}

TEST(MeasuredModes, WhatIsImaginaryIsNotTrusted) {
  const auto machine = heavy().machine;
  auto measured = identified(machine, "neutral", 0, spatial::Vector3::Zero());
  const MeasuredAt at{"neutral", spatial::Vector3::Zero()};
  const double before = mode_target(measured, machine, at).shape_deviation;
  measured.shape[0] *= std::polar(1.0, 0.3);  // two directions out of step
  const double after = mode_target(measured, machine, at).shape_deviation;
  EXPECT_GT(after, before + 0.03);
}

TEST(MeasuredModes, AreTrustedAsFarAsTheModalModelHoldsEverything) {
  const auto machine = heavy().machine;
  const MeasuredAt at{"neutral", spatial::Vector3::Zero()};
  auto measured = identified(machine, "neutral", 0, spatial::Vector3::Zero(), 0.043);
  const double known_to = mode_target(measured, machine, at).deviation;
  EXPECT_NEAR(known_to, measured.omega_deviation, 1e-12 * measured.omega());
  const double half_width = 0.043 * measured.omega();
  EXPECT_NEAR(mode_target(measured, machine, at, 7.7).deviation,
              std::hypot(known_to, 0.05 * 2.0 * std::numbers::pi * 7.7), 1e-12);

  auto mixture = measured;
  for (int d = 0; d < 6; ++d) mixture.shape[d] = std::polar(0.37, 0.9 * d);
  EXPECT_GT(mode_target(mixture, machine, at).deviation, known_to + 0.2 * half_width);

  // a weak one in the flank of a strong one, and not the strong one
  measured.significance = 8000.0;
  auto weak = measured, far = measured;
  weak.significance = 80.0;
  weak.pole *= 1.0 + 1.9 * half_width / measured.omega();
  far.significance = 80.0;
  far.pole *= 1.0 + 3.1 * half_width / measured.omega();
  const auto targets =
      measured_modes({.outputs = directions(), .modes = {measured, weak, far}}, machine, at);
  ASSERT_EQ(targets.modes.size(), 3U);
  EXPECT_NEAR(targets.modes[0].deviation, known_to, 1e-12 * measured.omega());
  EXPECT_NEAR(targets.modes[1].deviation, std::hypot(known_to, 0.5 * 0.043 * weak.omega()),
              1e-12 * measured.omega());
  EXPECT_NEAR(targets.modes[2].deviation, known_to, 1e-12 * measured.omega());
}

TEST(MeasuredModes, WithoutAllSixDirectionsKeepTheLargestOne) {
  const auto machine = heavy().machine;
  const auto measured = identified(machine, "neutral", 1, spatial::Vector3::Zero());
  const MeasuredAt at{"neutral", spatial::Vector3::Zero()};
  auto outputs = directions();
  for (const std::size_t missing : {3, 4, 5}) outputs[missing].direction = data::Direction::none;
  const auto target =
      measured_modes({.outputs = outputs, .modes = {measured}}, machine, at).modes.front();
  EXPECT_FALSE(target.shape);
  EXPECT_EQ(target.direction, 1);
  for (auto& output : outputs) output.direction = data::Direction::none;
  EXPECT_FALSE(measured_modes({.outputs = outputs, .modes = {measured}}, machine, at)
                   .modes.front()
                   .direction);
}

report::Json identified_json() {
  return report::Json::parse(R"({"kind": "identified_modes",
    "outputs": [{"name": "x", "unit": "m", "direction": "x"},
                {"name": "up", "unit": "m", "direction": "-z"},
                {"name": "p", "unit": "Pa", "direction": ""}],
    "modes": [{"frequency_hz": 4.1, "frequency_95_hz": 0.01959963984540054, "damping_ratio": 0.03,
               "damping_95": 0.001959963984540054,
               "shape": {"re": [2, 0.2, 7], "im": [0, 0, 0]},
               "shape_deviation": [0.02, 0.01, 1],
               "displacement_shape": {"re": [1, 0.1, 3], "im": [0, 0, 0]}}]})");
}

TEST(MeasuredModes, AreReadFromTheJsonOfIdentify) {
  const auto machine = heavy().machine;
  const auto targets =
      measured_modes(identification::modal_results(
                         report::identification_from_json(identified_json(), "modes.json")),
                     machine, {});
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
  EXPECT_NEAR(
      measured_modes(identification::modal_results(report::identification_from_json(json, "")),
                     machine, {})
          .modes.front()
          .deviation,
      2.0 * std::numbers::pi * std::hypot(0.01, 0.05 * 0.7), 1e-12);
  json["indicator"] = {1.0, 1.7};
  EXPECT_NEAR(
      measured_modes(identification::modal_results(report::identification_from_json(json, "")),
                     machine, {})
          .modes.front()
          .deviation,
      2.0 * std::numbers::pi * 0.01, 1e-12);
}

/// Legs and poses see the platform from the base, accelerometers feel the ground.
TEST(MeasuredModes, SayWhatTheyAreAgainst) {
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
    const auto one = measured_modes(identification::modal_results(found), machine, at)
                         .modes.front()
                         .shape_against;
    const auto other =
        measured_modes(
            identification::modal_results(report::identification_from_json(json, "modes.json")),
            machine, at)
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
      measured_modes(
          identification::modal_results(report::identification_from_json(json, "modes.json")),
          machine, {});
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
}  // namespace hydrapod::observation
