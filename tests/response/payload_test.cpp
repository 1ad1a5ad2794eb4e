/// Frequency responses of machines whose payload swings: elimination against the whole matrix, both
/// against a payload that is taken out by hand.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <complex>

#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "support/payload_modes.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using response::Complex;
using response::Input;
using response::Matrix6c;
using spatial::Vector3;

constexpr std::array omegas{3.0, 17.3, 41.9, 71.0, 133.7, 410.0};

model::Machine machine_with(bool dampers, std::uint64_t seed = 4) {
  Random random(seed);
  auto machine = random_machine(random, {.gravity = Gravity::down});
  put_modes_on(machine, 3, random);
  for (auto& mode : machine.payload_modes) mode.damping_ratio = dampers ? 0.031 : 0.0;
  for (auto& leg : machine.legs) {
    leg.oil_spring = {.stiffness = 1.7e3 * machine.platform.mass,
                      .damping = dampers ? 1.9 * machine.platform.mass : 0.0};
    leg.guide_sleeve.damping = leg.piston_ring->damping = dampers ? 711.0 : 0.0;
  }
  return machine;
}

response::ResponseModel at_center(const model::Machine& machine, ModelKind kind, double ratio,
                                  Input input) {
  const auto linear = dynamics::linear_model(machine, machine.poses[1].X_BP, kind);
  return response::response_model(linear, modal::normal_modes(linear), ratio,
                                  machine.platform.mass_center, input);
}

double worst(const std::vector<Matrix6c>& a, const std::vector<Matrix6c>& b) {
  double difference = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference = std::max(difference, (a[i] - b[i]).norm() / b[i].norm());
  return difference;
}

/// Of the best method, against the whole matrix.
double error_of(const response::ResponseModel& model) {
  const auto dense = response::frequency_response(model, omegas, response::Output::displacement,
                                                  response::Method::dense);
  return worst(response::frequency_response(model, omegas), dense);
}

TEST(PayloadResponse, IsTheSameByEliminationAndByTheWholeMatrix) {
  for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full})
    for (const auto input : {Input::wrench, Input::actuator}) {
      const auto model = at_center(machine_with(true), kind, 0.0, input);
      EXPECT_EQ(response::best_method(model), response::Method::elimination);
      EXPECT_LT(error_of(model), 1e-10);
    }
}

TEST(PayloadResponse, IsTheSameByModesAndByTheWholeMatrix) {
  const auto model = at_center(machine_with(false), ModelKind::guide, 0.017, Input::wrench);
  EXPECT_EQ(response::best_method(model), response::Method::modes);
  EXPECT_LT(error_of(model), 1e-9);
}

/// The rigid machine loses d dᵀ/(ω_k² − ω² + 2iζω_kω) per mode, d = −ω² √m (n; ρ × n) + (0; g × √m
/// n), n and ρ in base axes from C.
TEST(PayloadResponse, IsThatOfTheRigidPayloadLessWhatSwings) {
  const auto machine = machine_with(true);
  auto rigid_payload = machine;
  rigid_payload.payload_modes.clear();
  const auto& X_BP = machine.poses[1].X_BP;
  const auto still = dynamics::linear_model(rigid_payload, X_BP, ModelKind::rigid);
  const auto model = at_center(machine, ModelKind::rigid, 0.0, Input::wrench);
  const auto found = response::frequency_response(model, omegas);
  for (std::size_t i = 0; i < omegas.size(); ++i) {
    const double w = omegas[i];
    Matrix6c D = (spatial::Matrix6(still.K) - w * w * spatial::Matrix6(still.M)).cast<Complex>() +
                 Complex(0.0, w) * spatial::Matrix6(still.C).cast<Complex>();
    for (const auto& mode : machine.payload_modes) {
      const Vector3 n = X_BP.R_BP * mode.direction.normalized() * std::sqrt(*mode.mass);
      const Vector3 rho = X_BP.R_BP * (mode.position - machine.platform.mass_center);
      spatial::Vector6 d;
      d << -w * w * n, -w * w * rho.cross(n) + machine.gravity.cross(n);
      const Complex own(omega_of(mode) * omega_of(mode) - w * w,
                        2.0 * mode.damping_ratio * omega_of(mode) * w);
      D -= (d * d.transpose()).cast<Complex>() / own;
    }
    const Matrix6c expected = D.inverse();
    EXPECT_LT((found[i] - expected).norm(), 1e-10 * expected.norm()) << w;
  }
}

}  // namespace
}  // namespace hydrapod::test
