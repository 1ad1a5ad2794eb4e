/// From measured responses to what a diagnosis compares: inputs brought to valves, lines chosen,
/// what each is known to.

#include "diagnosis/responses.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "hydrapod/base/units.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/observation/observation.hpp"
#include "support/calibration_machine.hpp"
#include "support/noisy_modes.hpp"
#include "support/run_program.hpp"

namespace hydrapod::diagnosis {
namespace {

using observation::Entry;
using observation::Observed;
using observation::Targets;
using Complex = std::complex<double>;
using data::FrequencyResponses;
using observation::entry_of;
using observation::measured_responses;
using observation::MeasuredAt;

using base::two_pi;
const MeasuredAt at{"low", {0.137, -0.219, 0.083}};

model::MachineFile heavy() {
  return test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")));
}

spatial::Pose pose_of(const model::Machine& machine) {
  return std::ranges::find(machine.poses, at.pose, &model::NamedPose::name)->X_BP;
}

/// Motion of Q per command of the valves.
spatial::Matrix6 to_point(const observation::Observation& plant) {
  spatial::Matrix6 map = spatial::Matrix6::Identity();
  map.topRightCorner<3, 3>() =
      -spatial::skew(plant.mechanics.X_BP * at.point - plant.mechanics.p_BC);
  return map;
}

/// As a rig measures it: drives in directions of the platform, the y channel the other way round,
/// variance of every output and input.
FrequencyResponses measured_on(const model::Machine& machine) {
  FrequencyResponses all;
  const auto X_BP = pose_of(machine);
  const auto plant =
      observation::observe(machine, X_BP, dynamics::ModelKind::guide, Observed::plant);
  const Eigen::MatrixXd J =
      kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), X_BP * at.point);
  for (int k = 0; k < 6; ++k) {
    const auto direction = static_cast<data::Direction>(k == 1 ? -2 : k + 1);
    all.outputs.push_back({.unit = k < 3 ? "m" : "rad", .direction = direction});
    all.inputs.push_back(
        {.direction = static_cast<data::Direction>(k + 1), .role = data::Role::drive});
  }
  all.shift = 0.71;
  for (double hertz = 1.0; hertz < 40.0; hertz += 0.05) {
    all.frequency.push_back(hertz);
    Eigen::MatrixXcd H =
        to_point(plant) * plant.response({all.shift, two_pi * hertz}, Entry::valves) * J;
    H.row(1) *= -1.0;
    all.H.push_back(H);
    Eigen::MatrixXcd noise = Eigen::MatrixXcd::Zero(6, 6);
    noise.diagonal() << 1e-12, 4e-12, 9e-12, 2e-12, 3e-12, 5e-12;
    Eigen::MatrixXcd Q = 0.3 * Eigen::MatrixXcd::Ones(6, 6);
    Q.diagonal() << 1.0, 2.0, 3.0, 1.5, 2.5, 0.7;
    all.noise.push_back(noise);
    all.input_factor.push_back(Q);
  }
  return all;
}

Targets modes_of(const model::Machine& machine) {
  test::Random random(7);
  auto targets =
      test::noisy_plant_modes(machine, {at.pose}, dynamics::ModelKind::guide, {}, random);
  for (auto& mode : targets.modes) mode.damping = 0.031;
  return targets;
}

TEST(MeasuredResponses, OfDrivesInDirectionsAreThoseOfTheValves) {
  const auto machine = heavy().machine;
  const auto responses = measured_on(machine);
  const auto target = measured_responses(responses, machine, at);
  ASSERT_TRUE(target);
  EXPECT_EQ(target->pose, at.pose);
  EXPECT_TRUE(target->inputs.isIdentity(1e-12));
  const auto plant =
      observation::observe(machine, pose_of(machine), dynamics::ModelKind::guide, Observed::plant);
  ASSERT_EQ(target->s.size(), responses.lines());
  for (const std::size_t line : {3U, 170U, 611U}) {
    const Eigen::MatrixXcd H = to_point(plant) * plant.response(target->s[line], Entry::valves);
    EXPECT_LT((target->H[line] - H).norm(), 1e-9 * H.norm()) << line;
  }
}

/// Noise of the directions, mixed as the valves' columns are: with noise drawn so, what is drawn
/// scatters as is said.
TEST(MeasuredResponses, NoiseOfAColumnIsThatOfItsMixture) {
  const auto machine = heavy().machine;
  auto responses = measured_on(machine);
  constexpr std::size_t line = 0;
  responses.frequency = {responses.frequency[137]};
  responses.H = {responses.H[137]};
  const auto clean = measured_responses(responses, machine, at);
  ASSERT_TRUE(clean);
  const Eigen::MatrixXd root_Q =
      Eigen::LLT<Eigen::MatrixXd>(responses.input_factor[line].real()).matrixL();
  const Eigen::VectorXd root_noise = responses.noise[line].diagonal().real().cwiseSqrt();
  const Eigen::MatrixXcd H = responses.H[line];
  test::Random random(1013);
  Eigen::VectorXd scatter = Eigen::VectorXd::Zero(6);
  constexpr int draws = 4000;
  const auto& R = pose_of(machine).R_BP;
  const spatial::Matrix3 inertia = R * machine.platform.inertia * R.transpose();
  spatial::Vector6 root;
  root << spatial::Vector3::Constant(machine.platform.mass), inertia.diagonal();
  spatial::Matrix6 to_center = spatial::Matrix6::Identity();
  to_center.topRightCorner<3, 3>() = -spatial::skew(R * (machine.platform.mass_center - at.point));
  const Eigen::MatrixXcd metric = (root.cwiseSqrt().asDiagonal() * to_center).cast<Complex>();
  for (int draw = 0; draw < draws; ++draw) {
    Eigen::MatrixXcd e(6, 6);
    for (auto& value : e.reshaped())
      value = std::sqrt(0.5) * Complex(test::normal(random), test::normal(random));
    responses.H[line] = H + root_noise.asDiagonal() * e * root_Q.transpose();
    const auto noisy = measured_responses(responses, machine, at);
    const Eigen::MatrixXcd difference = metric * (noisy->H[line] - clean->H[line]);
    scatter += difference.colwise().squaredNorm().transpose();
  }
  for (int i = 0; i < 6; ++i) {
    const double size = (metric * clean->H[line].col(i)).norm();
    const double found = std::sqrt(scatter[i] / draws) / size;
    EXPECT_NEAR(clean->deviation[line][i] / found, 1.0, 0.03) << i;
  }
}

/// Poses from lengths of legs are against a base that gives way, accelerations against the ground.
TEST(MeasuredResponses, AreAgainstWhatTheirOutputsAre) {
  const auto machine = heavy().machine;
  auto lengths = measured_on(machine);
  EXPECT_EQ(measured_responses(lengths, machine, at)->against, observation::MotionAgainst::base);
  for (int k = 0; k < 6; ++k)
    lengths.outputs[static_cast<std::size_t>(k)].unit = k < 3 ? "m/s^2" : "rad/s^2";
  EXPECT_EQ(measured_responses(lengths, machine, at)->against, observation::MotionAgainst::ground);
}

/// Accelerations for forces about a point of their own, the third the other way round.
FrequencyResponses forced(const model::Machine& machine, const spatial::Vector3& p_PF,
                          double shift = 0.0) {
  FrequencyResponses all{.shift = shift};
  const auto X_BP = pose_of(machine);
  const auto seen =
      observation::observe(machine, X_BP, dynamics::ModelKind::guide, Observed::mechanics);
  spatial::Matrix6 at_center = spatial::Matrix6::Identity();
  at_center.bottomLeftCorner<3, 3>() = spatial::skew(X_BP * p_PF - seen.mechanics.p_BC);
  for (int k = 0; k < 6; ++k) {
    const auto direction = static_cast<data::Direction>(k + 1);
    all.outputs.push_back({.unit = k < 3 ? "m/s^2" : "rad/s^2", .direction = direction});
    all.inputs.push_back({.unit = k < 3 ? "N" : "N m",
                          .direction = k == 2 ? data::Direction::minus_z : direction,
                          .role = data::Role::excitation});
  }
  for (double hertz = 3.0; hertz < 40.0; hertz += 0.31) {
    const Complex s(shift, two_pi * hertz);
    all.frequency.push_back(hertz);
    Eigen::MatrixXcd H = to_point(seen) * s * s *
                         seen.response(s, Entry::forces, observation::MotionAgainst::ground) *
                         at_center;
    H.col(2) *= -1.0;
    all.H.push_back(H);
  }
  return all;
}

/// As motion of Q for forces there, in m/N: what a force elsewhere is about Q is its own.
TEST(MeasuredResponses, OfForcesCountAsTheyAre) {
  const auto machine = heavy().machine;
  auto there = at;
  there.force_point = spatial::Vector3(-0.41, 0.53, -0.29);
  const auto responses = forced(machine, *there.force_point);
  const auto target = measured_responses(responses, machine, there);
  ASSERT_TRUE(target);
  EXPECT_EQ(target->entry, Entry::forces);
  EXPECT_EQ(target->against, observation::MotionAgainst::ground);
  const auto seen = observation::observe(machine, pose_of(machine), dynamics::ModelKind::guide,
                                         Observed::mechanics);
  for (const std::size_t line : {5U, 71U, 113U}) {
    const spatial::Matrix6 T = to_point(seen);
    const Eigen::MatrixXcd H =
        T * seen.response(target->s[line], Entry::forces, observation::MotionAgainst::ground) *
        T.transpose() * target->inputs;
    EXPECT_LT((target->H[line] - H).norm(), 1e-9 * H.norm()) << line;
  }
}

TEST(MeasuredResponses, OfForcesNeedUnitsAndOnePlace) {
  const auto machine = heavy().machine;
  const auto good = forced(machine, at.point);
  EXPECT_EQ(entry_of(good.inputs), Entry::forces);
  auto newton_metres = good;
  for (int k = 3; k < 6; ++k) newton_metres.inputs[static_cast<std::size_t>(k)].unit = "N.m";
  EXPECT_TRUE(measured_responses(newton_metres, machine, at));
  auto some = good;  // a hammer in two directions
  some.inputs.resize(2);
  for (auto& H : some.H) H = H.leftCols(2).eval();
  const auto two = measured_responses(some, machine, at);
  ASSERT_TRUE(two);
  EXPECT_EQ(two->inputs.cols(), 2);
  auto unknown = good;
  unknown.inputs[1].unit = "EU";
  EXPECT_FALSE(measured_responses(unknown, machine, at));
  auto strain = good;
  strain.outputs[4].unit = "1/s^2";
  EXPECT_FALSE(measured_responses(strain, machine, at));
  auto moment = good;  // a force about an axis
  moment.inputs[5].unit = "N";
  EXPECT_FALSE(measured_responses(moment, machine, at));
  auto elsewhere = good;
  for (auto& output : elsewhere.outputs) output.point = 7;
  EXPECT_TRUE(measured_responses(elsewhere, machine, at));
  elsewhere.inputs[0].point = 12;
  EXPECT_FALSE(measured_responses(elsewhere, machine, at));
}

/// Commands in directions of the platform, as displacements of the legs one by one.
TEST(MeasuredResponses, OfCommandsAreThoseOfTheLegs) {
  const auto machine = heavy().machine;
  const auto X_BP = pose_of(machine);
  const auto seen =
      observation::observe(machine, X_BP, dynamics::ModelKind::guide, Observed::system);
  FrequencyResponses all;
  for (int k = 0; k < 6; ++k) {
    const auto direction = static_cast<data::Direction>(k + 1);
    all.outputs.push_back({.unit = k < 3 ? "m" : "rad", .direction = direction});
    all.inputs.push_back(
        {.unit = k < 3 ? "m" : "rad", .direction = direction, .role = data::Role::excitation});
  }
  const Complex s(0.0, two_pi * 11.3);
  all.frequency = {11.3};
  all.H = {to_point(seen) * seen.response(s, Entry::commands)};
  const auto target = measured_responses(all, machine, at);
  ASSERT_TRUE(target);
  EXPECT_EQ(target->entry, Entry::commands);
  const auto legs =
      kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), X_BP.p_BP);
  EXPECT_TRUE((legs * target->inputs).isIdentity(1e-9));
  EXPECT_LT((target->H[0] - all.H[0] * target->inputs).norm(), 1e-9 * target->H[0].norm());
}

TEST(MeasuredResponses, AreLeftOutWhereInputsOrOutputsAreOthers) {
  const auto machine = heavy().machine;
  auto forces = measured_on(machine);
  forces.inputs[2].role = data::Role::excitation;
  EXPECT_FALSE(measured_responses(forces, machine, at));
  auto five = measured_on(machine);
  five.outputs[4].direction = data::Direction::none;
  EXPECT_FALSE(measured_responses(five, machine, at));
  auto mixed = measured_on(machine);
  mixed.outputs[3].unit = "rad/s";
  EXPECT_FALSE(measured_responses(mixed, machine, at));
  auto widened = measured_on(machine);
  widened.taper = Eigen::VectorXd::Ones(3);
  EXPECT_FALSE(measured_responses(widened, machine, at));
}

/// Lines lie in the band, off the measured resonances and apart from each other; together they
/// count like one shape per mode.
TEST(ChosenLines, LieOffThePeaksAndCountLikeOneShapePerMode) {
  const auto file = heavy();
  auto measured = modes_of(file.machine);
  measured.responses.push_back(*measured_responses(measured_on(file.machine), file.machine, at));
  auto& all = measured.responses[0];
  for (std::size_t line = 300; line < 340; ++line) all.deviation[line][4] = 0.4;  // 16 … 18 Hz
  constexpr double error = 0.07;
  const auto chosen =
      chosen_lines(file, measured, dynamics::ModelKind::guide, {.response_error = error});
  ASSERT_EQ(chosen.size(), 1U);
  const auto& some = chosen[0];
  ASSERT_GT(some.s.size(), 12U);
  EXPECT_EQ(some.values, 5 * static_cast<int>(measured.modes.size()));
  for (std::size_t k = 0; k < some.s.size(); ++k) {
    const double omega = some.s[k].imag();
    EXPECT_FALSE(omega > two_pi * 16.01 && omega < two_pi * 17.94);
    EXPECT_GT(omega, 1.0149 * (k > 0 ? some.s[k - 1].imag() : 0.0));
    for (const auto& mode : measured.modes)
      EXPECT_GE(std::abs(std::log(omega / mode.omega)), 2.0 * 0.031);
    const auto as_measured = std::ranges::find(all.s, some.s[k]) - all.s.begin();
    const auto& noise = all.deviation[static_cast<std::size_t>(as_measured)];
    const double shared = error * error * static_cast<double>(some.s.size()) /
                          static_cast<double>(measured.modes.size());
    for (int i = 0; i < 6; ++i)
      EXPECT_NEAR(some.deviation[k][i], std::sqrt(6.0 * (noise[i] * noise[i] + shared)), 1e-12);
  }
}

/// Forces: what a misplaced or misdamped pole makes of a line is its deviation too, of hits beside
/// the imaginary axis as far from the pole as the line is there; and lines of what the observed
/// system has no input for are none.
TEST(ChosenLines, OfForcesTrustLittleBesideAPeak) {
  const auto file = heavy();
  auto measured = modes_of(file.machine);
  measured.observed = Observed::mechanics;
  constexpr double shift = 1.37;
  auto responses = forced(file.machine, at.point, shift);
  measured.responses.push_back(*measured_responses(responses, file.machine, at));
  measured.responses.push_back(*measured_responses(measured_on(file.machine), file.machine, at));
  constexpr double error = 0.07, frequency_error = 0.0041;
  const auto chosen = chosen_lines(file, measured, dynamics::ModelKind::guide,
                                   {.frequency_error = frequency_error, .response_error = error});
  ASSERT_EQ(chosen.size(), 1U);
  const auto& some = chosen[0];
  ASSERT_EQ(some.entry, Entry::forces);
  ASSERT_GT(some.s.size(), 8U);
  for (std::size_t k = 0; k < some.s.size(); ++k) {
    double off = 0.0;
    for (const auto& mode : measured.modes) {
      const double distance = std::hypot(shift + 0.031 * mode.omega, some.s[k].imag() - mode.omega);
      off = std::max(off, std::hypot(0.031, frequency_error) * mode.omega / distance);
    }
    const double share = static_cast<double>(some.s.size()) /
                         static_cast<double>(std::min(some.s.size(), measured.modes.size()));
    EXPECT_NEAR(some.deviation[k][0], std::sqrt(6.0 * share * (error * error + off * off)), 1e-12);
  }
}

/// What the machine that was measured predicts is what was measured: direct responses of forces,
/// which stand as they are.
TEST(ResponseOverlays, OfForcesAreThoseOfTheMachineThatWasMeasured) {
  const auto file = heavy();
  auto measured = modes_of(file.machine);
  measured.observed = Observed::mechanics;
  const auto responses = forced(file.machine, at.point);
  measured.responses.push_back(*measured_responses(responses, file.machine, at));
  Diagnosis found;
  found.hypotheses.push_back({.kind = dynamics::ModelKind::guide});
  found.hypotheses.push_back({.rigid = true, .kind = dynamics::ModelKind::rigid});
  const auto overlays =
      response_overlays(file, measured, dynamics::ModelKind::guide, found, {0, 1}, 40);
  ASSERT_EQ(overlays.size(), 1U);
  const auto& overlay = overlays[0];
  EXPECT_TRUE(overlay.direct);
  EXPECT_FALSE(overlay.scaled);
  ASSERT_EQ(overlay.curves.size(), 6U);
  ASSERT_GT(overlay.omega.size(), 20U);
  EXPECT_LE(overlay.omega.size(), 40U);
  for (const auto& curve : overlay.curves) {
    double rigid_off = 0.0;
    for (std::size_t k = 0; k < overlay.omega.size(); ++k) {
      EXPECT_NEAR(curve.predicted[0][k], curve.measured[k], 1e-9 * curve.measured[k]);
      const auto line =
          std::ranges::min_element(
              responses.frequency, {},
              [&](double hertz) { return std::abs(two_pi * hertz - overlay.omega[k]); }) -
          responses.frequency.begin();
      const double displacement =
          std::abs(responses.H[static_cast<std::size_t>(line)](curve.direction, curve.direction)) /
          (overlay.omega[k] * overlay.omega[k]);
      EXPECT_NEAR(curve.measured[k], displacement, 1e-9 * displacement);
      rigid_off = std::max(rigid_off, std::abs(curve.predicted[1][k] / curve.measured[k] - 1.0));
    }
    EXPECT_GT(rigid_off, 5e-3) << curve.direction;  // with rigid legs it is another machine
  }
}

/// What a valve makes of a drive is one factor for each curve; and what the observed system has no
/// input for, or a machine by mechanics alone, has no prediction.
TEST(ResponseOverlays, OfValvesArePredictedUpToAFactor) {
  const auto file = heavy();
  auto measured = modes_of(file.machine);
  measured.observed = Observed::plant;
  auto responses = measured_on(file.machine);
  for (auto& H : responses.H) H *= 3.7;
  measured.responses.push_back(*measured_responses(responses, file.machine, at));
  Diagnosis found;
  found.hypotheses.push_back({.kind = dynamics::ModelKind::guide});
  found.hypotheses.push_back({.kind = dynamics::ModelKind::guide, .by_mechanics = true});
  const auto overlays =
      response_overlays(file, measured, dynamics::ModelKind::guide, found, {0, 1});
  ASSERT_EQ(overlays.size(), 1U);
  EXPECT_FALSE(overlays[0].direct);
  EXPECT_TRUE(overlays[0].scaled);
  for (const auto& curve : overlays[0].curves) {
    ASSERT_EQ(curve.predicted.size(), 2U);
    EXPECT_TRUE(curve.predicted[1].empty());
    for (std::size_t k = 0; k < curve.measured.size(); ++k)
      EXPECT_NEAR(curve.predicted[0][k], curve.measured[k], 1e-9 * curve.measured[k]);
  }
  measured.observed = Observed::system;
  EXPECT_TRUE(response_overlays(file, measured, dynamics::ModelKind::guide, found, {0}).empty());
}

}  // namespace
}  // namespace hydrapod::diagnosis
