/// Damped modes of chambers that leak, where they are known in closed form.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

/// Both rods through: two equal chambers per leg at the neutral pose, whose pressures even out at
/// one rate λ with a valve that (nearly) does not leak: λ = 2 c_i β/V.
model::Machine equal_chambers(double internal_leakage) {
  auto machine = symmetric_machine();
  machine.damping.oil = model::OilDamping::chambers;
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs) {
    leg.hydraulics.equivalent_cylinder = {.area_ratio = 1.0, .area = 1.7e-3, .bulk_modulus = 1.1e9};
    leg.hydraulics.valve.leakage = internal_leakage > 0.0 ? 1e-14 : 0.0;  // [m³/s]
    leg.hydraulics.leakage.internal = internal_leakage;
  }
  return machine;
}

/// V = 2 β A²/k_h of each chamber.
double rate_of(const model::Machine& machine) {
  const auto& leg = machine.legs[0];
  const auto& cylinder = leg.hydraulics.equivalent_cylinder;
  const double V =
      2.0 * cylinder.bulk_modulus * *cylinder.area * *cylinder.area / *leg.oil_spring.stiffness;
  return 2.0 * *leg.hydraulics.leakage.internal * cylinder.bulk_modulus / V;
}

std::vector<modal::DampedMode> modes_of(const dynamics::LinearModel& model) {
  return modal::damped_modes(model, modal::normal_modes(model), 0.0);
}

/// With all springs relaxing at λ: s² + λ s + ω² = 0 beside the drift s = 0, so that the poles have
/// the modulus ω and ζ = λ/2ω, less at high frequencies. A damper beside the spring has it the
/// other way round.
TEST(LeakingChambers, DampInInverseProportionToTheFrequency) {
  for (const double leakage : {0.9e-12, 4.3e-12, 13.7e-12}) {
    const auto machine = equal_chambers(leakage);
    const double lambda = rate_of(machine);
    const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
    const auto normal = modal::normal_modes(model);
    const auto modes = modes_of(model);
    ASSERT_EQ(modes.size(), 6U);
    for (int k = 0; k < 6; ++k) {
      const double omega = normal.omega(k);
      EXPECT_NEAR(modes[static_cast<size_t>(k)].omega, omega, 1e-9 * omega);
      EXPECT_NEAR(modes[static_cast<size_t>(k)].damping_ratio, 0.5 * lambda / omega,
                  1e-9 * lambda / omega);
      EXPECT_TRUE(modes[static_cast<size_t>(k)].stable);
    }
    EXPECT_NEAR(modes[0].damping_ratio * modes[0].omega, modes[5].damping_ratio * modes[5].omega,
                1e-9 * lambda);
  }
}

/// λ > 2 ω: what was a mode falls back by s² + λ s + ω² = 0 with real poles.
TEST(LeakingChambers, MakeModesOfLowFrequencyOverdamped) {
  const auto machine = equal_chambers(2.9e-10);
  const double lambda = rate_of(machine);
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  const auto normal = modal::normal_modes(model);
  ASSERT_GT(lambda, 2.0 * normal.omega(5));
  const auto modes = modes_of(model);
  ASSERT_EQ(modes.size(), 6U);
  for (int k = 0; k < 6; ++k) {
    const auto& mode = modes[static_cast<size_t>(k)];
    EXPECT_NEAR(mode.omega, normal.omega(k), 1e-7 * normal.omega(k));
    EXPECT_NEAR(mode.damping_ratio, 0.5 * lambda / normal.omega(k), 1e-7 * mode.damping_ratio);
  }
}

/// Every mode solves (s² M + s C + K − Σ κ λ/(s + λ) s_y s_yᵀ) φ = 0.
TEST(LeakingChambers, HaveModesThatSolveTheEquationOfMotion) {
  for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full}) {
    auto machine = equal_chambers(3.7e-12);
    for (size_t i = 0; i < 6; ++i) {  // unequal chambers, and a valve that leaks
      machine.legs[i].hydraulics.equivalent_cylinder.area_ratio = 0.51 + 0.03 * double(i);
      machine.legs[i].hydraulics.valve.leakage = 1.7e-5;
      machine.legs[i].guide_sleeve.damping = 61.0;
    }
    machine.gravity = {0.0, 0.0, -2.1};
    const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
    const auto modes = modes_of(model);
    ASSERT_EQ(static_cast<int>(modes.size()), model.dof());
    const double largest = std::pow(modes.back().omega, 2);
    for (const auto& mode : modes) {
      const auto s = mode.pole;
      const Eigen::VectorXcd phi =
          mode.real.cast<std::complex<double>>() + std::complex<double>(0, 1) * mode.imaginary;
      Eigen::MatrixXcd D = s * s * model.M.cast<std::complex<double>>() +
                           s * model.C.cast<std::complex<double>>() +
                           model.K.cast<std::complex<double>>();
      for (const auto& arm : model.arms)
        D -= arm.stiffness * arm.rate / (s + arm.rate) *
             (arm.s_y * arm.s_y.transpose()).cast<std::complex<double>>();
      const Eigen::VectorXd weight = model.M.diagonal().cwiseSqrt().cwiseInverse();
      EXPECT_LE((weight.asDiagonal() * (D * phi)).norm(), 1e-10 * largest);
    }
  }
}

TEST(ClosedChambers, AreAnUndampedOilSpring) {
  const auto machine = equal_chambers(0.0);
  auto viscous = machine;
  viscous.damping.oil = model::OilDamping::viscous;
  const auto modes = modes_of(dynamics::linear_model(machine, machine.neutral(), ModelKind::guide));
  const auto springs =
      modes_of(dynamics::linear_model(viscous, machine.neutral(), ModelKind::guide));
  for (size_t k = 0; k < modes.size(); ++k) {
    EXPECT_NEAR(modes[k].omega, springs[k].omega, 1e-12 * springs[k].omega);
    EXPECT_EQ(modes[k].damping_ratio, 0.0);
  }
}

/// Whoever states what leaks means it: no key has to be found for that, and a damper that stands
/// for it is not used. The word of the file comes first.
TEST(OilDamping, IsThatOfChambersWhereLeakageOrAValveIsStated) {
  const auto plain = symmetric_machine();
  EXPECT_FALSE(model::has_chambers(plain));
  const auto with = [&](auto change) {
    auto machine = plain;
    change(machine.legs[3].hydraulics);
    return machine;
  };
  using Hydraulics = model::LegHydraulics;
  EXPECT_FALSE(model::has_chambers(with([](Hydraulics& of) { of.leakage.internal = 0.0; })));
  EXPECT_FALSE(model::has_chambers(with([](Hydraulics& of) { of.valve.leakage = 0.0; })));
  EXPECT_FALSE(model::has_chambers(with([](Hydraulics& of) { of.friction.viscous = 370.0; })));
  for (const auto& machine : {with([](Hydraulics& of) { of.leakage.internal = 2.9e-12; }),
                              with([](Hydraulics& of) { of.leakage.external = 1.7e-13; }),
                              with([](Hydraulics& of) { of.valve.rated_flow = 7.1e-4; }),
                              with([](Hydraulics& of) { of.valve.leakage = 1.3e-5; })}) {
    EXPECT_TRUE(model::has_chambers(machine));
    auto stated = machine;
    stated.damping.oil = model::OilDamping::chambers;
    for (const auto kind : {ModelKind::rigid, ModelKind::full}) {
      const auto modes = modes_of(dynamics::linear_model(machine, machine.neutral(), kind));
      const auto same = modes_of(dynamics::linear_model(stated, machine.neutral(), kind));
      for (size_t k = 0; k < modes.size(); ++k) EXPECT_EQ(modes[k].pole, same[k].pole);
      EXPECT_LT(modes[0].pole.real(), 0.0);
    }
    auto viscous = machine;
    viscous.damping.oil = model::OilDamping::viscous;
    EXPECT_FALSE(model::has_chambers(viscous));
    auto damper = machine;
    for (auto& leg : damper.legs) leg.oil_spring.damping = 113.0;
    const auto damped =
        modes_of(dynamics::linear_model(damper, machine.neutral(), ModelKind::rigid));
    const auto modes =
        modes_of(dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid));
    for (size_t k = 0; k < modes.size(); ++k) EXPECT_EQ(damped[k].pole, modes[k].pole);
  }
}

/// 2 % of critical for the seals where nothing is stated, none for the platform's modes.
TEST(Chambers, LeaveTheModalRatioToTheSeals) {
  auto machine = symmetric_machine();
  machine.damping = {.modal_ratio = 0.03, .oil = model::OilDamping::chambers};
  EXPECT_EQ(model::modal_ratio(machine).value, 0.0);
  EXPECT_EQ(model::seal_ratio(machine).value, 0.03);
  for (auto& leg : machine.legs) {
    leg.hydraulics.leakage.internal = 0.0;
    leg.hydraulics.valve.leakage = 0.0;
  }
  const auto table = modal::mode_table(machine, machine.neutral(), ModelKind::guide);
  int local = 0;
  for (const auto& entry : table.real.modes)
    if (!entry.moves_platform) {
      // that of a seal between fixed joints, of which local modes are but for the leg's gimbals
      EXPECT_NEAR(entry.mode.damping_ratio, 0.03, 1e-5);
      ++local;
    }
  EXPECT_GE(local, 6);
  for (const auto& entry : table.rigid.modes) EXPECT_EQ(entry.mode.damping_ratio, 0.0);
}

/// The half-power width of a response's highest peak is that of its mode, 2 ζ ω.
TEST(LeakingChambers, ShowTheirDampingInResponses) {
  const auto machine = equal_chambers(1.3e-12);
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  const auto normal = modal::normal_modes(model);
  const auto swept = response::response_model(model, normal, 0.0, machine.platform.mass_center);
  const auto peaks = response::find_peaks(swept, {.from = 5.0, .to = 500.0});
  ASSERT_FALSE(peaks.empty());
  const double lambda = rate_of(machine);
  for (const auto& peak : peaks) {
    if (!peak.own) continue;
    // |H| at resonance of κ iω/(iω + λ) − ω² m: 1/(m ω λ) but for λ²/ω²
    const double omega = normal.omega(peak.mode);
    EXPECT_NEAR(peak.omega, omega, 2.0 * lambda * lambda / omega);
  }
}

}  // namespace
}  // namespace hydrapod::test
