/// What is observed of the plant, against its equations solved in other ways.

#include "hydrapod/observation/observation.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/calibration_machine.hpp"
#include "support/eigenvalues.hpp"
#include "support/run_program.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::observation {
namespace {

using Complex = std::complex<double>;
using dynamics::ModelKind;

model::MachineFile heavy_with(const std::vector<std::string>& overrides = {}) {
  return test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")),
                            overrides);
}

model::MachineFile published(const std::vector<std::string>& overrides = {}) {
  return test::machine_file(test::read_text(test::source_file("models/zhang-jiang-2021.toml")),
                            overrides);
}

class ObservedPlant : public testing::TestWithParam<bool> {};

TEST_P(ObservedPlant, HasThePolesAndMotionsOfTheLinearSystem) {
  std::vector<std::string> overrides{"platform.mass=14.713 t"};
  if (GetParam()) {
    overrides.push_back("base.mount.mass=1.31 t");
    overrides.push_back("base.mount.stiffness.x=0.41 kN/um");
    overrides.push_back("base.mount.stiffness.z=0.93 kN/um");
    overrides.push_back("base.mount.stiffness.ry=7.1e8");
  }
  const auto machine = heavy_with(overrides).machine;
  const auto X_BP = machine.poses.back().X_BP;
  const auto seen = observe(machine, X_BP, ModelKind::guide, Observed::plant);
  const auto system = simulation::system_poles(
      simulation::linear_system(machine, X_BP, {.kind = ModelKind::guide, .closed = false}));
  spatial::Matrix6 to_center = spatial::Matrix6::Identity();
  to_center.topRightCorner<3, 3>() = -spatial::skew(seen.mechanics.p_BC - X_BP.p_BP);
  int compared = 0;
  double differs = 0.0;
  for (const auto& pole : system.poles) {
    if (!pole.oscillates() || pole.damping_ratio > 0.3 || pole.omega < 1.0) continue;
    const auto nearest = std::ranges::min_element(
        seen.modes, {}, [&](const auto& mode) { return std::abs(mode.pole - pole.pole); });
    EXPECT_LT(std::abs(nearest->pole - pole.pole), 1e-8 * pole.omega);
    const bool alone = std::ranges::count_if(seen.modes, [&](const auto& mode) {
                         return std::abs(mode.pole - pole.pole) < 1e-4 * pole.omega;
                       }) == 1;
    if (!alone) continue;                // of close poles any mix is one
    Eigen::Matrix<Complex, 12, 1> a, b;  // against ground and base, in one scale
    a << nearest->motion(), nearest->motion(MotionAgainst::base);
    b << to_center.cast<Complex>() * pole.ground_motion, to_center.cast<Complex>() * pole.motion;
    EXPECT_GT(std::abs(a.dot(b)), (1.0 - 1e-8) * a.norm() * b.norm());
    differs = std::max(differs, (a.head<6>() - a.tail<6>()).norm() / a.norm());
    ++compared;
  }
  EXPECT_GE(compared, 8);
  if (GetParam())
    EXPECT_GT(differs, 0.1);
  else
    EXPECT_EQ(differs, 0.0);
}

INSTANTIATE_TEST_SUITE_P(OnABaseThatGivesWay, ObservedPlant, testing::Bool());

/// (s − A)⁻¹ B by elimination, on the imaginary axis and beside it.
TEST(Observation, ResponsesAreThoseOfTheStateSpace) {
  for (const auto& file : {heavy_with(), published({"legs.guide_sleeve.stiffness=1.31e5"})}) {
    const auto& machine = file.machine;
    const auto X_BP = machine.neutral();
    const auto seen = observe(machine, X_BP, ModelKind::guide, Observed::plant);
    const simulation::Plant plant(machine, ModelKind::guide,
                                  {.friction = simulation::Friction::viscous}, X_BP);
    const auto rest = plant.equilibrium(X_BP);
    const auto linear = plant.linearise(rest.x, rest.input);
    for (const Complex s :
         {Complex(0.0, 7.3), Complex(0.9766, 26.1), Complex(0.5, 47.7), Complex(1.7, 190.0)}) {
      Eigen::MatrixXcd pencil = -linear.A.cast<Complex>();
      pencil.diagonal().array() += s;
      const Eigen::MatrixXcd H =
          linear.C.topRows<6>().cast<Complex>() *
          pencil.partialPivLu().solve(linear.B.leftCols<6>().cast<Complex>());
      EXPECT_LT((seen.response(s, Entry::valves) - H).norm(), 1e-7 * H.norm()) << s;
    }
  }
}

/// Forces on legs with oil springs: by elimination of the legs' coordinates, with dampers and with
/// a ratio for each mode.
TEST(Observation, OfMechanicsRespondsAsTheLinearModel) {
  for (const auto& file :
       {heavy_with(), published({"damping.modal_ratio=0.037"}),
        heavy_with({"base.mount.mass=1.31 t", "base.mount.stiffness.x=0.041 kN/um",
                    "base.mount.stiffness.ry=7.1e8"})}) {
    const auto& machine = file.machine;
    const auto X_BP = machine.neutral();
    const auto seen = observe(machine, X_BP, ModelKind::guide, Observed::mechanics);
    const auto model = dynamics::linear_model(machine, X_BP, ModelKind::guide);
    const auto swept =
        response::response_model(model, modal::normal_modes(model),
                                 modal::modal_ratio(machine).value, machine.platform.mass_center);
    const std::vector<double> omega{7.3, 26.1, 47.7, 190.0};
    const auto H = response::frequency_response(swept, omega);
    for (std::size_t k = 0; k < omega.size(); ++k) {
      const Complex s(0.0, omega[k]);
      EXPECT_LT((seen.response(s, Entry::forces, MotionAgainst::ground) - H[k]).norm(),
                1e-9 * H[k].norm());
      const Eigen::MatrixXcd D = s * s * model.M.cast<Complex>() + model.K.cast<Complex>() +
                                 s * response::damping_matrix(swept).cast<Complex>();
      const Eigen::MatrixXcd all =
          D.lu().solve(Eigen::MatrixXcd::Identity(model.dof(), model.dof()));
      EXPECT_LT(
          (seen.response(s, Entry::forces) - model.against_base.cast<Complex>() * all.leftCols<6>())
              .norm(),
          1e-9 * H[k].norm());
    }
  }
}

/// Legs that have folded under their load do not swing: they part from rest at the rate √−ω², and
/// come to it as fast.
TEST(Observation, OfABuckledMachineHasRealPoles) {
  auto machine = test::symmetric_machine(9.81);
  for (auto& leg : machine.legs) leg.cylinder_case.mass = leg.rod.mass = 0.0;
  machine.platform.mass = 3000.0;
  machine.damping.modal_ratio = 0.0;
  const auto seen = observe(machine, machine.neutral(), ModelKind::guide, Observed::mechanics);
  const auto omega2 = test::omega_squared(seen.mechanics.M, seen.mechanics.K);
  int folded = 0;
  for (const double value : omega2) {
    if (value > 0.0) continue;
    ++folded;
    for (const double rate : {std::sqrt(-value), -std::sqrt(-value)})
      EXPECT_LT((seen.poles.array() - rate).abs().minCoeff(), 1e-6 * std::abs(rate));
  }
  EXPECT_GE(folded, 2);
  EXPECT_EQ(std::ssize(seen.modes), omega2.size() - folded);
}

/// Commands through the controller, and forces on the controlled machine.
TEST(Observation, OfTheSystemRespondsAsTheClosedLoop) {
  const auto machine = heavy_with().machine;
  const auto X_BP = machine.poses.back().X_BP;
  const auto seen = observe(machine, X_BP, ModelKind::guide, Observed::system);
  const auto system = simulation::linear_system(machine, X_BP, {.kind = ModelKind::guide});
  spatial::Matrix6 to_origin = spatial::Matrix6::Identity();
  to_origin.topRightCorner<3, 3>() = -spatial::skew(X_BP.p_BP - seen.mechanics.p_BC);
  for (const double omega : {3.1, 19.7, 44.3, 131.0}) {
    const Complex s(0.0, omega);
    const auto commanded = simulation::command_response(system, omega);
    EXPECT_LT((to_origin * seen.response(s, Entry::commands) - commanded).norm(),
              1e-7 * commanded.norm());
    Eigen::MatrixXcd pencil = -system.A.cast<Complex>();
    pencil.diagonal().array() += s;
    const Eigen::MatrixXcd H =
        system.C.cast<Complex>() * pencil.partialPivLu().solve(system.B_wrench.cast<Complex>());
    EXPECT_LT((to_origin * seen.response(s, Entry::forces) - H).norm(), 1e-7 * H.norm());
  }
  EXPECT_THROW(static_cast<void>(seen.response({0.0, 3.0}, Entry::valves)), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::observation
