/// Measured responses in a calibration, against the equations of motion solved by elimination.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "hydrapod/base/error.hpp"
#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/observation/observation.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/calibration_machine.hpp"
#include "support/noisy_modes.hpp"
#include "support/run_program.hpp"

namespace hydrapod::calibration {
namespace {

using namespace observation;

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

/// What is measured, and from where on.
struct Experiment {
  const char* name{};
  Observed observed{};
  Entry entry{};
};
constexpr Experiment from_valves{"FromValves", Observed::plant, Entry::valves};
constexpr Experiment from_forces{"FromForcesWithValvesShut", Observed::mechanics, Entry::forces};

Eigen::MatrixXcd solved(const Eigen::MatrixXcd& pencil, const Eigen::MatrixXcd& loads) {
  return pencil.partialPivLu().solve(loads);
}

/// Motion of the mass centre per force there: rows of (s² M + s C + K)⁻¹.
Eigen::MatrixXcd of_mechanics(const model::Machine& machine, Complex s,
                              const Eigen::MatrixXd& wrenches) {
  const auto model = dynamics::linear_model(machine, low(machine).X_BP, ModelKind::guide);
  Eigen::MatrixXcd loads = Eigen::MatrixXcd::Zero(model.dof(), wrenches.cols());
  loads.topRows(6) = wrenches.cast<Complex>();
  return solved(s * s * model.M.cast<Complex>() + s * model.C.cast<Complex>() +
                    model.K.cast<Complex>(),
                loads)
      .topRows(6);
}

/// Motion of P's origin, C (s − A)⁻¹ B.
Eigen::MatrixXcd of_system(const model::Machine& machine, Complex s, const Experiment& experiment,
                           const Eigen::MatrixXd& inputs) {
  const auto system = simulation::linear_system(
      machine, low(machine).X_BP,
      {.kind = ModelKind::guide, .closed = experiment.observed == Observed::system});
  Eigen::MatrixXcd B = system.B_valve.cast<Complex>();
  if (experiment.entry == Entry::forces) B = system.B_wrench.cast<Complex>();
  if (experiment.entry == Entry::commands)
    B = system.B_command.cast<Complex>() + s * system.B_velocity.cast<Complex>();
  Eigen::MatrixXcd pencil = -system.A.cast<Complex>();
  pencil.diagonal().array() += s;
  return system.C.cast<Complex>() * solved(pencil, B * inputs.cast<Complex>());
}

/// Motion of Q; forces act there too.
Eigen::MatrixXcd by_elimination(const model::Machine& machine, Complex s,
                                const Experiment& experiment, const Eigen::MatrixXd& inputs) {
  const spatial::Vector3 arm = low(machine).X_BP.R_BP * (p_PQ - machine.platform.mass_center);
  Eigen::MatrixXd of_entry = inputs;
  if (experiment.entry == Entry::forces)
    for (Eigen::Index i = 0; i < inputs.cols(); ++i)
      of_entry.col(i).tail<3>() += arm.cross(inputs.col(i).head<3>());
  const bool mechanics = experiment.observed == Observed::mechanics;
  const Eigen::MatrixXcd motion =
      mechanics ? of_mechanics(machine, s, of_entry) : of_system(machine, s, experiment, of_entry);
  const spatial::Vector3 from_it =
      mechanics ? arm : spatial::Vector3(low(machine).X_BP.R_BP * p_PQ);
  Eigen::MatrixXcd point = motion;
  point.topRows<3>() -= spatial::skew(from_it).cast<Complex>() * motion.bottomRows<3>();
  return point;
}

/// Two lines beside resonances and one between them, three inputs; no noise.
ResponseTarget response_of(const model::Machine& machine, const Experiment& experiment) {
  ResponseTarget target{.pose = "low", .point = p_PQ, .entry = experiment.entry, .values = 15};
  target.inputs = Eigen::MatrixXd::Zero(6, 3);
  target.inputs << 1.0, 0.2, 0.0, -0.4, 1.0, 0.0, 0.3, -0.1, 0.0, 0.0, 0.7, 0.0, 0.6, 0.0, 1.0, 0.1,
      -0.9, 0.0;
  for (const double omega : {23.7, 41.3, 88.9}) {
    target.s.emplace_back(0.71, omega);
    target.H.push_back(by_elimination(machine, target.s.back(), experiment, target.inputs));
    target.deviation.emplace_back(Eigen::Vector3d(0.031, 0.047, 0.023));
  }
  return target;
}

/// Beside the responses a mode that says next to nothing.
Targets targets_of(const model::MachineFile& file, const Experiment& experiment = from_valves) {
  test::Random random(41);
  auto targets = test::noisy_plant_modes(file.machine, {"low"}, ModelKind::guide, {}, random);
  targets.observed = experiment.observed;
  targets.modes.resize(1);
  auto& mode = targets.modes[0];
  mode.shape.reset();
  mode.complex_shape.reset();
  mode.deviation = 1e6 * mode.omega;
  targets.responses = {response_of(file.machine, experiment)};
  return targets;
}

/// What is left of every measured column beside the machine's: 1 − v vᴴ/vᴴv by a projector, for
/// forces the difference to what has the same size and the best phase.
Eigen::VectorXcd rest_of(const Targets& targets, const model::Machine& stated,
                         const model::Machine& machine, const Experiment& experiment) {
  const auto& target = targets.responses[0];
  // |root q|²: twice the kinetic energy of the platform when Q moves with q
  const auto& R = low(stated).X_BP.R_BP;
  spatial::Matrix6 mass = spatial::Matrix6::Zero(), to_center = spatial::Matrix6::Identity();
  mass.diagonal().head<3>().setConstant(stated.platform.mass);
  mass.bottomRightCorner<3, 3>() = R * stated.platform.inertia * R.transpose();
  to_center.topRightCorner<3, 3>() = -spatial::skew(R * (stated.platform.mass_center - p_PQ));
  const spatial::Matrix6 root = (to_center.transpose() * mass * to_center).llt().matrixU();
  Eigen::VectorXcd all(0);
  for (std::size_t line = 0; line < target.s.size(); ++line) {
    const Eigen::MatrixXcd H =
        root.cast<Complex>() * by_elimination(machine, target.s[line], experiment, target.inputs);
    for (Eigen::Index i = 0; i < H.cols(); ++i) {
      const Eigen::VectorXcd measured = root.cast<Complex>() * target.H[line].col(i);
      const Eigen::VectorXcd v = H.col(i).normalized(), u = measured.normalized();
      const Eigen::MatrixXcd projector = Eigen::MatrixXcd::Identity(6, 6) - v * v.adjoint();
      // for forces the nearest vector of the calculated size along v
      const Complex along = v.dot(u);
      const Eigen::VectorXcd rest =
          experiment.entry == Entry::forces
              ? Eigen::VectorXcd(u -
                                 std::polar(H.col(i).norm() / measured.norm(), std::arg(along)) * v)
              : Eigen::VectorXcd(projector * u);
      all.conservativeResize(all.size() + 6);
      all.tail<6>() = rest / target.deviation[line][i];
    }
  }
  return all;
}

/// What a machine with another number leaves, and what the number is known to, which is one over
/// the derivative of what is left.
class ResponseResidual : public testing::TestWithParam<Experiment> {};

TEST_P(ResponseResidual, ResidualsAndTheirDerivativesAreThoseOfTheEquations) {
  const auto file = heavy();
  const auto targets = targets_of(file, GetParam());
  EXPECT_LT(compare(file, targets, ModelKind::guide).misfit, 1e-10);
  for (const auto& [path, value] : std::vector<std::pair<std::string, double>>{
           {"leg.3.guide_sleeve.stiffness", file.machine.legs[2].guide_sleeve.stiffness},
           {"platform.mass_center[2]", file.machine.platform.mass_center.z()},
           {"platform.mass", file.machine.platform.mass}}) {
    const auto moved = [&](double share) {
      return heavy({fmt::format("{}={:.17g}", path, value * (1.0 + share))});
    };
    const auto other = compare(moved(0.19), targets, ModelKind::guide);
    const double far =
        rest_of(targets, moved(0.19).machine, moved(0.19).machine, GetParam()).squaredNorm();
    const double rounding = 1e-6 * far + 1e-9;  // of poles and vectors, where little is left
    EXPECT_NEAR(other.misfit, far, rounding) << path;
    double described = 0.0;
    for (const auto& response : other.responses) described += std::pow(response.difference, 2);
    EXPECT_NEAR(described, far, rounding) << path;

    const Plan plan{.free = {{.paths = {path}}}, .options = {.starts = 1}};
    const auto fit = calibrate(file, targets, plan, ModelKind::guide).best();
    ASSERT_EQ(fit.parameters.size(), 1U);
    EXPECT_NEAR(fit.parameters[0].value, value, 1e-5 * std::abs(value)) << path;
    constexpr double h = 2e-3;
    const Eigen::VectorXcd slope = (rest_of(targets, file.machine, moved(h).machine, GetParam()) -
                                    rest_of(targets, file.machine, moved(-h).machine, GetParam())) /
                                   (2.0 * h * std::abs(value));
    EXPECT_NEAR(fit.parameters[0].deviation * slope.norm(), 1.0, 1e-4) << path;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, ResponseResidual,
    testing::Values(from_valves, from_forces,
                    Experiment{"FromForcesOnThePlant", Observed::plant, Entry::forces},
                    Experiment{"FromForcesUnderControl", Observed::system, Entry::forces},
                    Experiment{"FromCommands", Observed::system, Entry::commands}),
    [](const auto& experiment) { return std::string(experiment.param.name); });

/// Sleeves, mass centre and mass all half as far off again would change the controller too, which
/// stays what it was.
TEST(ResponseResiduals, UnderControlAreThoseOfTheControllerThatWasAtWork) {
  const auto file = heavy();
  const Experiment under_control{"", Observed::system, Entry::forces};
  auto targets = targets_of(file, under_control);
  const auto heavier = heavy({"platform.mass=17.31 t"});
  const double retuned = compare(heavier, targets, ModelKind::guide).misfit;
  targets.controllers["low"] =
      simulation::tune_controller(file.machine, low(file.machine).X_BP).parameters;
  const double held = compare(heavier, targets, ModelKind::guide).misfit;
  EXPECT_GT(std::abs(held - retuned), 1e-3 * held);
  EXPECT_LT(compare(file, targets, ModelKind::guide).misfit, 1e-10);
  // by the equations, with the controller of the one around the other
  const auto p = targets.controllers.at("low");
  const auto explicit_file =
      heavy({"platform.mass=17.31 t", fmt::format("controller.gain={:.17g}", p.gain[0]),
             fmt::format("controller.feedback_gain={:.17g}", p.feedback_gain[0]),
             fmt::format("controller.feedback_corner={:.17g} rad/s", p.feedback_corner)});
  targets.controllers.clear();
  const double by_file = compare(explicit_file, targets, ModelKind::guide).misfit;
  EXPECT_NEAR(held, by_file, 0.02 * held);  // loads of the axes are those of the mass
}

TEST(ResponseResiduals, AreRefusedWhereTheSystemHasNoSuchInput) {
  const auto file = heavy();
  auto targets = targets_of(file);
  targets.observed = Observed::mechanics;
  EXPECT_THROW(compare(file, targets, ModelKind::guide), std::invalid_argument);
}

/// Sizes count, and delays do not: a machine that is heavier and stiffer throughout has the same
/// modes.
TEST(ResponseResiduals, ToForcesTellHowHeavyAMachineIs) {
  const auto file = heavy();
  auto targets = targets_of(file, from_forces);
  auto& responses = targets.responses[0];
  for (std::size_t line = 0; line < responses.s.size(); ++line)
    responses.H[line] *= std::exp(-responses.s[line] * 0.0021);
  const double shift = std::exp(-0.71 * 0.0021);  // of a line beside the imaginary axis
  for (auto& H : responses.H) H *= 1.1 / shift;
  const double off = compare(file, targets, ModelKind::guide).misfit;
  double all = 0.0;
  for (const auto& deviation : targets.responses[0].deviation)
    all += deviation.cwiseAbs2().cwiseInverse().sum();
  EXPECT_NEAR(off, std::pow(0.1 / 1.1, 2) * all, 1e-6 * off);
}

/// A column counts up to a complex factor: what a valve lets through is not the platform's.
TEST(ResponseResiduals, GainsAndPhasesOfTheDrivesDoNotCount) {
  const auto file = heavy();
  auto targets = targets_of(file);
  for (auto& H : targets.responses[0].H)
    H = H * Eigen::Vector3cd(Complex(0.7, 0.2), Complex(0.0, -3.1), Complex(1.3, 1.3)).asDiagonal();
  EXPECT_LT(compare(file, targets, ModelKind::guide).misfit, 1e-10);
  targets.responses[0].H[1].row(2) *= 1.37;
  EXPECT_GT(compare(file, targets, ModelKind::guide).misfit, 1.0);
}

/// Beside a pole the response is that mode's motion, against what it is asked for.
TEST(ResponseResiduals, BesideAPoleAreTheMotionOfItsMode) {
  const auto machine =
      heavy({"base.mount.mass=1.31 t", "base.mount.stiffness.x=0.041 kN/um"}).machine;
  const auto seen = observe(machine, low(machine).X_BP, ModelKind::guide, Observed::plant);
  int differ = 0;
  for (const auto& mode : seen.modes) {
    const bool alone = std::ranges::count_if(seen.modes, [&](const auto& other) {
                         return std::abs(other.pole - mode.pole) < 1e-2 * mode.omega();
                       }) == 1;
    if (!alone || mode.damping_ratio() > 0.3) continue;
    const Complex s = mode.pole * (1.0 + 1e-7);
    for (const auto against : {MotionAgainst::base, MotionAgainst::ground}) {
      const Eigen::MatrixXcd residue = mode.motion(against) * mode.input;
      EXPECT_LT(((s - mode.pole) * seen.response(s, Entry::valves, against) - residue).norm(),
                1e-4 * residue.norm());
    }
    const Vector6c apart = mode.motion(MotionAgainst::ground) - mode.motion(MotionAgainst::base);
    differ += apart.norm() > 0.05 * mode.motion().norm();
  }
  EXPECT_GE(differ, 1);
}

TEST(ResponseResiduals, OfAPoseThatTheMachineDoesNotHaveAreRefused) {
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
