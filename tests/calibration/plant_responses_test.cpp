/// Measured responses in a calibration, against the state space solved by elimination.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "hydrapod/base/error.hpp"
#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/calibration/observation.hpp"
#include "hydrapod/simulation/plant.hpp"
#include "support/calibration_machine.hpp"
#include "support/noisy_modes.hpp"
#include "support/run_program.hpp"

namespace hydrapod::calibration {
namespace {

using Complex = std::complex<double>;
using dynamics::ModelKind;

const spatial::Vector3 p_PQ(0.137, -0.219, 0.083);

model::MachineFile heavy(const std::vector<std::string>& overrides = {}) {
  return test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")),
                            overrides);
}

const model::NamedPose& low(const model::Machine& machine) {
  return *std::ranges::find(machine.poses, "low", &model::NamedPose::name);
}

/// Motion of Q for drives of the valves, C (s − A)⁻¹ B.
Eigen::MatrixXcd by_elimination(const model::Machine& machine, Complex s,
                                const Eigen::MatrixXd& drives) {
  const auto& X_BP = low(machine).X_BP;
  const simulation::Plant plant(machine, ModelKind::guide,
                                {.friction = simulation::Friction::viscous}, X_BP);
  const auto rest = plant.equilibrium(X_BP);
  const auto linear = plant.linearise(rest.x, rest.input);
  Eigen::MatrixXcd pencil = -linear.A.cast<Complex>();
  pencil.diagonal().array() += s;
  const Eigen::MatrixXcd center =
      linear.C.topRows<6>().cast<Complex>() *
      pencil.partialPivLu().solve((linear.B.leftCols<6>() * drives).cast<Complex>());
  Eigen::MatrixXcd point = center;
  const spatial::Vector3 arm = X_BP.R_BP * (p_PQ - machine.platform.mass_center);
  point.topRows<3>() -= spatial::skew(arm).cast<Complex>() * center.bottomRows<3>();
  return point;
}

/// Two lines beside resonances and one between them, three drives; no noise.
ResponseTarget response_of(const model::Machine& machine) {
  ResponseTarget target{.pose = "low", .point = p_PQ, .values = 15};
  target.drives = Eigen::MatrixXd::Zero(6, 3);
  target.drives << 1.0, 0.2, 0.0, -0.4, 1.0, 0.0, 0.3, -0.1, 0.0, 0.0, 0.7, 0.0, 0.6, 0.0, 1.0, 0.1,
      -0.9, 0.0;
  for (const double omega : {23.7, 41.3, 88.9}) {
    target.s.emplace_back(0.71, omega);
    target.H.push_back(by_elimination(machine, target.s.back(), target.drives));
    target.deviation.emplace_back(Eigen::Vector3d(0.031, 0.047, 0.023));
  }
  return target;
}

/// Beside the responses a mode that says next to nothing.
Targets targets_of(const model::MachineFile& file) {
  test::Random random(41);
  auto targets = test::noisy_plant_modes(file.machine, {"low"}, ModelKind::guide, {}, random);
  targets.modes.resize(1);
  auto& mode = targets.modes[0];
  mode.shape.reset();
  mode.complex_shape.reset();
  mode.deviation = 1e6 * mode.omega;
  targets.responses = {response_of(file.machine)};
  return targets;
}

/// What is left of every measured column beside the machine's: 1 − v vᴴ/vᴴv by a projector.
Eigen::VectorXcd rest_of(const Targets& targets, const model::Machine& stated,
                         const model::Machine& machine) {
  const auto& target = targets.responses[0];
  const auto& R = low(stated).X_BP.R_BP;
  spatial::Vector6 root;
  root << spatial::Vector3::Constant(stated.platform.mass),
      (R * stated.platform.inertia * R.transpose()).diagonal();
  root = root.cwiseSqrt().eval();
  Eigen::VectorXcd all(0);
  for (std::size_t line = 0; line < target.s.size(); ++line) {
    const Eigen::MatrixXcd H =
        root.cast<Complex>().asDiagonal() * by_elimination(machine, target.s[line], target.drives);
    for (Eigen::Index i = 0; i < H.cols(); ++i) {
      const Eigen::VectorXcd v = H.col(i).normalized();
      const Eigen::VectorXcd u =
          (root.cast<Complex>().asDiagonal() * target.H[line].col(i)).normalized();
      const Eigen::MatrixXcd projector = Eigen::MatrixXcd::Identity(6, 6) - v * v.adjoint();
      all.conservativeResize(all.size() + 6);
      all.tail<6>() = projector * u / target.deviation[line][i];
    }
  }
  return all;
}

/// What a machine with another number leaves, and what the number is known to, which is one over
/// the derivative of what is left.
TEST(PlantResponses, ResidualsAndTheirDerivativesAreThoseOfTheStateSpace) {
  const auto file = heavy();
  const auto targets = targets_of(file);
  EXPECT_LT(compare(file, targets, ModelKind::guide).misfit, 1e-10);
  for (const auto& [path, value] : std::vector<std::pair<std::string, double>>{
           {"leg.3.guide_sleeve.stiffness", file.machine.legs[2].guide_sleeve.stiffness},
           {"platform.mass_center[2]", file.machine.platform.mass_center.z()},
           {"platform.mass", file.machine.platform.mass}}) {
    const auto moved = [&](double share) {
      return heavy({fmt::format("{}={:.17g}", path, value * (1.0 + share))});
    };
    const auto other = compare(moved(0.19), targets, ModelKind::guide);
    const double far = rest_of(targets, moved(0.19).machine, moved(0.19).machine).squaredNorm();
    EXPECT_NEAR(other.misfit, far, 1e-6 * far) << path;
    double described = 0.0;
    for (const auto& response : other.responses) described += std::pow(response.difference, 2);
    EXPECT_NEAR(described, far, 1e-6 * far) << path;

    const Plan plan{.free = {{.paths = {path}}}, .options = {.starts = 1}};
    const auto fit = calibrate(file, targets, plan, ModelKind::guide).best();
    ASSERT_EQ(fit.parameters.size(), 1U);
    EXPECT_NEAR(fit.parameters[0].value, value, 1e-5 * std::abs(value)) << path;
    constexpr double h = 2e-3;
    const Eigen::VectorXcd slope = (rest_of(targets, file.machine, moved(h).machine) -
                                    rest_of(targets, file.machine, moved(-h).machine)) /
                                   (2.0 * h * std::abs(value));
    EXPECT_NEAR(fit.parameters[0].deviation * slope.norm(), 1.0, 1e-4) << path;
  }
}

/// A column counts up to a complex factor: what a valve lets through is not the platform's.
TEST(PlantResponses, GainsAndPhasesOfTheDrivesDoNotCount) {
  const auto file = heavy();
  auto targets = targets_of(file);
  for (auto& H : targets.responses[0].H)
    H = H * Eigen::Vector3cd(Complex(0.7, 0.2), Complex(0.0, -3.1), Complex(1.3, 1.3)).asDiagonal();
  EXPECT_LT(compare(file, targets, ModelKind::guide).misfit, 1e-10);
  targets.responses[0].H[1].row(2) *= 1.37;
  EXPECT_GT(compare(file, targets, ModelKind::guide).misfit, 1.0);
}

/// Beside a pole the response is that mode's motion, against what it is asked for.
TEST(PlantResponses, BesideAPoleAreTheMotionOfItsMode) {
  const auto machine =
      heavy({"base.mount.mass=1.31 t", "base.mount.stiffness.x=0.041 kN/um"}).machine;
  const auto seen = observe_plant(machine, low(machine).X_BP, ModelKind::guide);
  int differ = 0;
  for (const auto& mode : seen.modes) {
    const bool alone = std::ranges::count_if(seen.modes, [&](const auto& other) {
                         return std::abs(other.pole - mode.pole) < 1e-2 * mode.omega();
                       }) == 1;
    if (!alone || mode.damping_ratio() > 0.3) continue;
    const Complex s = mode.pole * (1.0 + 1e-7);
    for (const auto against : {MotionAgainst::base, MotionAgainst::ground}) {
      const Eigen::MatrixXcd residue = mode.motion(against) * mode.input;
      EXPECT_LT(((s - mode.pole) * seen.response(s, against) - residue).norm(),
                1e-4 * residue.norm());
    }
    const Vector6c apart = mode.motion(MotionAgainst::ground) - mode.motion(MotionAgainst::base);
    differ += apart.norm() > 0.05 * mode.motion().norm();
  }
  EXPECT_GE(differ, 1);
}

TEST(PlantResponses, OfAPoseThatTheMachineDoesNotHaveAreRefused) {
  const auto file = heavy();
  auto targets = targets_of(file);
  targets.responses[0].pose = "aloft";
  try {
    compare(file, targets, ModelKind::guide);
    FAIL() << "not refused";
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("responses: the machine has no pose \"aloft\""));
  }
}

}  // namespace
}  // namespace hydrapod::calibration
