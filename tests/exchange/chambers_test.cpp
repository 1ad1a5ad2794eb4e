/// Chambers that relax in files of other programs: state spaces and tables of modes hold them,
/// superelements are refused.

#include <gtest/gtest.h>

#include "hydrapod/base/error.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::exchange {
namespace {

using Complex = std::complex<double>;

/// Every leg with a leakage of its own, so that no pole is there twice.
Machine leaking_machine() {
  auto machine = test::symmetric_machine();
  machine.damping = {.modal_ratio = 0.004, .oil = model::OilDamping::chambers};
  for (std::size_t i = 0; i < 6; ++i) {
    const double more = 1.0 + 0.3 * static_cast<double>(i);
    machine.legs[i].hydraulics.leakage.internal = 1.3e-12 * more;
    machine.legs[i].guide_sleeve.stiffness *= 1.0 + 0.1 * more;
    machine.legs[i].oil_spring.stiffness = *machine.legs[i].oil_spring.stiffness * more;
  }
  return machine;
}

response::Matrix6c response_of(const Machine& machine, double omega) {
  const auto linear =
      dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::guide);
  const auto model = response::response_model(linear, modal::normal_modes(linear), 0.0,
                                              machine.platform.mass_center);
  return response::frequency_response(model, {&omega, 1})[0];
}

TEST(StateSpaceOfChambers, IsTheFrequencyResponse) {
  const auto machine = leaking_machine();
  const auto system =
      state_space(machine, machine.neutral(), {.p_PQ = machine.platform.mass_center});
  ASSERT_EQ(system.states.size(), static_cast<std::size_t>(system.A.rows()));
  EXPECT_EQ(system.A.rows(), 2 * 18 + 12);
  EXPECT_EQ(system.states.back().name, "leg6.oil2");
  for (const double omega : {4.0, 47.0, 131.0, 800.0}) {
    Eigen::MatrixXcd pencil = -system.A.cast<Complex>();
    pencil.diagonal().array() += Complex(0.0, omega);
    const Eigen::MatrixXcd x = numerics::solve(pencil, system.B.leftCols(6).cast<Complex>());
    const Eigen::MatrixXcd H = system.C.topRows(6).cast<Complex>() * x;
    const auto expected = response_of(machine, omega);
    EXPECT_LT((H - expected).norm(), 1e-9 * expected.norm()) << omega;
  }
}

/// φ Lᵀ is the residue of the state space at the pole.
TEST(ModalModelOfChambers, HasTheResiduesOfItsPoles) {
  const auto machine = leaking_machine();
  const auto results = modal_model(machine, machine.neutral(), dynamics::ModelKind::guide, {});
  const auto system =
      state_space(machine, machine.neutral(), {.p_PQ = machine.platform.mass_center});
  const auto pairs = numerics::eigen_pairs(system.A);
  const Eigen::MatrixXcd left = numerics::inverse(pairs.vectors);
  ASSERT_EQ(results.inputs.size(), 6U);
  ASSERT_EQ(results.modes.size(), 18U);
  for (const auto& mode : results.modes) {
    Eigen::Index k = 0;
    (pairs.values.array() - mode.pole).abs().minCoeff(&k);
    EXPECT_LT(std::abs(pairs.values[k] - mode.pole), 1e-9 * std::abs(mode.pole));
    const Eigen::MatrixXcd expected = (system.C.topRows(6).cast<Complex>() * pairs.vectors.col(k)) *
                                      (left.row(k) * system.B.leftCols(6).cast<Complex>());
    const Eigen::MatrixXcd residue = mode.shape.head(6) * mode.participation.transpose();
    EXPECT_LT((residue - expected).norm(), 1e-6 * expected.norm());
  }
}

TEST(SuperelementOfChambers, IsRefused) {
  const auto machine = leaking_machine();
  try {
    (void)superelement(machine, machine.neutral(), {});
    FAIL() << "expected an error";
  } catch (const base::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("state space"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace hydrapod::exchange
