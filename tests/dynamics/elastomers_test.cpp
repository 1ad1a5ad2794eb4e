/// Seals that are elastomers: arms against their definition, the linear models against complex
/// stiffnesses, pressures, and legs that fold while seals creep.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using Complex = std::complex<double>;
using dynamics::ModelKind;

/// k(iω), written down once more.
Complex stiffness(double k, const dynamics::SealArms& arms, Complex s) {
  Complex sum = k;
  for (const auto& arm : arms) sum += arm.stiffness * s / (s + arm.rate);
  return sum;
}

TEST(SealArms, HaveTheStiffnessAndTheLossThatAreAskedFor) {
  constexpr double k = 3.17e6;
  for (const double ratio : {1.03, 1.3, 1.9, 3.1})
    for (const double loss : {0.021, 0.13, 0.29, 0.9}) {
      const model::Elastomer elastomer{.dynamic_ratio = ratio,
                                       .loss_factor = loss,
                                       .frequency = 61.0 / (2.0 * std::numbers::pi)};
      const auto arms = dynamics::seal_arms(k, elastomer);
      const Complex at = stiffness(k, arms, Complex(0.0, 61.0));
      EXPECT_NEAR(at.real(), ratio * k, 1e-12 * k);
      EXPECT_NEAR(at.imag() / at.real(), loss, 1e-12);
      for (const auto& arm : arms) {
        EXPECT_GT(arm.stiffness, 0.0);
        EXPECT_GT(arm.rate, 0.0);
      }
      // Slow motions meet k.
      EXPECT_NEAR(stiffness(k, arms, Complex(0.0, 1e-9)).real(), k, 1e-9 * k);
    }
}

/// Of usual O-rings the loss factor stays near that stated over a decade around the frequency.
TEST(SealArms, SpreadTheirLossOverADecade) {
  const model::Elastomer elastomer{
      .dynamic_ratio = 1.6, .loss_factor = 0.2, .frequency = 50.0 / (2.0 * std::numbers::pi)};
  const auto arms = dynamics::seal_arms(1.0, elastomer);
  for (double omega = 50.0 / std::sqrt(10.0); omega < 50.0 * std::sqrt(10.0); omega *= 1.1) {
    const Complex at = stiffness(1.0, arms, Complex(0.0, omega));
    EXPECT_GT(at.imag() / at.real(), 0.157) << omega;
    EXPECT_LT(at.imag() / at.real(), 0.21) << omega;
  }
}

model::Machine with_elastomers(model::Machine machine) {
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const double d = static_cast<double>(i);
    machine.legs[i].guide_sleeve.elastomer = {
        .dynamic_ratio = 1.31 + 0.23 * d, .loss_factor = 0.11 + 0.03 * d, .frequency = 9.1 + d};
    if (i % 2 == 0 && machine.legs[i].piston_ring)
      machine.legs[i].piston_ring->elastomer = {
          .dynamic_ratio = 2.2 - 0.1 * d, .loss_factor = 0.27, .frequency = 14.3};
  }
  return machine;
}

model::Machine with_stiffness(model::Machine machine, std::size_t leg, bool ring, double by) {
  auto& seals = machine.legs[leg];
  (ring ? seals.piston_ring->stiffness : seals.guide_sleeve.stiffness) += by;
  return machine;
}

/// K is linear in the stiffness of every seal where nothing is preloaded. So K(s) is put together
/// from models with ideal springs, without a word about arms.
Eigen::MatrixXcd dynamic_stiffness(const model::Machine& machine, ModelKind kind, Complex s) {
  model::Machine ideal = machine;
  for (auto& leg : ideal.legs) {
    leg.guide_sleeve.elastomer.reset();
    if (leg.piston_ring) leg.piston_ring->elastomer.reset();
  }
  const auto& X_BP = machine.poses.back().X_BP;
  const auto model = dynamics::linear_model(ideal, X_BP, kind);
  Eigen::MatrixXcd D =
      s * s * model.M.cast<Complex>() + s * model.C.cast<Complex>() + model.K.cast<Complex>();
  const auto add = [&](std::size_t leg, bool ring, double k, const model::Elastomer& elastomer) {
    const auto stiffer = dynamics::linear_model(with_stiffness(ideal, leg, ring, k), X_BP, kind);
    const Eigen::MatrixXd per_k = (stiffer.K - model.K) / k;
    D += (stiffness(k, dynamics::seal_arms(k, elastomer), s) - k) * per_k.cast<Complex>();
  };
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    if (leg.guide_sleeve.elastomer)
      add(i, false, leg.guide_sleeve.stiffness, *leg.guide_sleeve.elastomer);
    if (kind == ModelKind::full && leg.piston_ring->elastomer)
      add(i, true, leg.piston_ring->stiffness, *leg.piston_ring->elastomer);
  }
  return D;
}

TEST(Elastomers, MakeResponsesThoseOfComplexStiffnesses) {
  Random random(77);
  for (const auto kind : {ModelKind::guide, ModelKind::full}) {
    auto machine = with_elastomers(random_machine(random));
    machine.damping.modal_ratio = 0.0;
    const auto& X_BP = machine.poses.back().X_BP;
    const auto linear = dynamics::linear_model(machine, X_BP, kind);
    const auto model = response::response_model(linear, modal::normal_modes(linear), 0.0,
                                                machine.platform.mass_center);
    const auto omega = response::log_space(3.0, 900.0, 23);
    for (const auto method : {response::Method::elimination, response::Method::dense}) {
      const auto H =
          response::frequency_response(model, omega, response::Output::displacement, method);
      for (std::size_t k = 0; k < omega.size(); ++k) {
        const auto D = dynamic_stiffness(machine, kind, Complex(0.0, omega[k]));
        const Eigen::MatrixXcd wanted =
            D.partialPivLu().solve(Eigen::MatrixXcd::Identity(linear.dof(), 6)).topRows(6);
        EXPECT_LT((H[k] - wanted).norm(), 1e-9 * wanted.norm()) << omega[k];
      }
    }
  }
}

/// Every mode makes the dynamic stiffness singular, and there are as many as coordinates.
TEST(Elastomers, HaveModesThatSolveTheEquationOfMotion) {
  Random random(78);
  for (const auto kind : {ModelKind::guide, ModelKind::full}) {
    auto machine = with_elastomers(random_machine(random));
    const auto linear = dynamics::linear_model(machine, machine.poses.back().X_BP, kind);
    const auto modes = modal::damped_modes(linear, modal::normal_modes(linear), 0.0);
    ASSERT_EQ(static_cast<int>(modes.size()), linear.dof());
    const double largest = std::pow(modes.back().omega, 2);
    const Eigen::VectorXd weight = linear.M.diagonal().cwiseSqrt().cwiseInverse();
    int oscillating = 0;
    for (const auto& mode : modes) {
      if (!(mode.pole.imag() > 0.0)) continue;
      ++oscillating;
      EXPECT_GT(mode.damping_ratio, 0.0);
      const Eigen::VectorXcd phi =
          mode.real.cast<Complex>() + Complex(0.0, 1.0) * mode.imaginary.cast<Complex>();
      const Eigen::VectorXcd left = dynamic_stiffness(machine, kind, mode.pole) * phi;
      EXPECT_LE((weight.asDiagonal() * left).norm(), 1e-9 * largest);
    }
    EXPECT_GT(oscillating, 6);
  }
}

TEST(Elastomers, HoldTheWeightWithTheStiffnessOfSlowMotions) {
  const auto ideal = symmetric_machine(2.3);
  const auto machine = with_elastomers(ideal);
  const auto at = dynamics::static_equilibrium(machine, machine.neutral(), ModelKind::full);
  const auto wanted = dynamics::static_equilibrium(ideal, ideal.neutral(), ModelKind::full);
  for (std::size_t i = 0; i < model::leg_count; ++i)
    EXPECT_EQ(at.legs[i].flexible, wanted.legs[i].flexible);
}

/// Quick motions meet stiffer seals, but the load stays: the payload at which the legs fold is that
/// of ideal springs with the stiffness of slow motions.
TEST(Elastomers, CarryAsMuchAsIdealSpringsInTheLongRun) {
  const auto ideal = symmetric_machine(9.81);
  const auto machine = with_elastomers(ideal);
  const auto wanted = dynamics::buckling_payload(ideal, ideal.neutral(), ModelKind::guide);
  const auto found = dynamics::buckling_payload(machine, machine.neutral(), ModelKind::guide);
  EXPECT_EQ(found.status, wanted.status);
  // Both are bisected to 1e-6 of the mass on the legs.
  EXPECT_NEAR(found.payload, wanted.payload, 3e-6 * (machine.platform.mass + wanted.payload));
}

TEST(Elastomers, ThatCreepTillTheLegsFoldAreAnError) {
  auto ideal = symmetric_machine(9.81);
  for (auto& leg : ideal.legs) {  // without weight: straight until they fold
    leg.cylinder_case.mass_center = 0.0;
    leg.cylinder_case.mass = leg.rod.mass = 1e-7;
  }
  const auto folds = dynamics::buckling_payload(ideal, ideal.neutral(), ModelKind::guide);
  ideal.platform.mass += folds.payload;
  ideal.platform.mass *= 1.002;
  const auto machine = with_elastomers(ideal);
  try {
    (void)dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
    FAIL() << "expected an error";
  } catch (const base::ComputationError& error) {
    EXPECT_NE(std::string(error.what()).find("fold"), std::string::npos) << error.what();
  }
}

TEST(PressedSeals, AreAsStiffAsThePressuresOfTheOilAtRestMakeThem) {
  auto machine = symmetric_machine(9.81);
  constexpr double growth = 3.1e-8;  // [1/Pa]
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.elastomer = {
        .dynamic_ratio = 1.4, .loss_factor = 0.2, .frequency = 9.7, .pressure_stiffening = growth};
    leg.piston_ring->elastomer = leg.guide_sleeve.elastomer;
    leg.hydraulics.equivalent_cylinder = {.area_ratio = 0.47, .area = 1.1e-3};
  }
  const auto pressed = dynamics::with_pressed_seals(machine, ModelKind::full, machine.neutral());
  // Both chambers hold the leg: p_cap A − p_rod e A = F + p_0 (1 − e) A.
  const auto statics = dynamics::static_equilibrium(machine, machine.neutral(), ModelKind::rigid);
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const double k_s = machine.legs[i].guide_sleeve.stiffness;
    const double k_g = machine.legs[i].piston_ring->stiffness;
    const double p_rod = 101325.0 + (pressed.legs[i].guide_sleeve.stiffness / k_s - 1.0) / growth;
    const double mean = 101325.0 + (pressed.legs[i].piston_ring->stiffness / k_g - 1.0) / growth;
    const double p_cap = 2.0 * mean - p_rod;
    constexpr double A = 1.1e-3, e = 0.47;
    const double held = (p_cap - 101325.0) * A - (p_rod - 101325.0) * e * A;
    EXPECT_NEAR(held, -statics.legs[i].oil_force, 1e-6 * std::abs(held));
    EXPECT_GT(p_rod, 5e5);   // above the return's
    EXPECT_LT(p_cap, 14e6);  // below the supply's
    EXPECT_EQ(pressed.legs[i].guide_sleeve.elastomer->pressure_stiffening, 0.0);
  }
  const auto at = dynamics::linear_model(machine, machine.neutral(), ModelKind::full);
  const auto wanted = dynamics::linear_model(pressed, machine.neutral(), ModelKind::full);
  EXPECT_EQ(at.K, wanted.K);
}

}  // namespace
}  // namespace hydrapod::test
