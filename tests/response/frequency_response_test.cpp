/// Frequency responses: four ways to the same numbers, and what physics demands of them.

#include "hydrapod/response/frequency_response.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hydrapod/modal/damped_modes.hpp"
#include "response/state_space.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using response::Complex;
using response::Input;
using response::Matrix6c;
using response::Method;
using response::Output;
using spatial::Matrix6;
using spatial::Vector3;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

void remove_dampers(model::Machine& machine) {
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.damping = leg.oil_spring.damping = 0.0;
    if (leg.piston_ring) leg.piston_ring->damping = 0.0;
  }
}

response::ResponseModel response_of(const model::Machine& machine, ModelKind kind,
                                    double modal_ratio, const Vector3& p_PQ, Input input) {
  const auto linear = dynamics::linear_model(machine, machine.poses.back().X_BP, kind);
  return response::response_model(linear, modal::normal_modes(linear), modal_ratio, p_PQ, input);
}

/// A band that holds all modes.
std::vector<double> band_of(const response::ResponseModel& model, int points) {
  return response::log_space(0.1 * model.modes.omega(0),
                             3.0 * model.modes.omega(model.modes.size() - 1), points);
}

/// Largest difference of two sweeps, each entry weighted so that metres and radians compare,
/// against the largest at its frequency.
double difference(const std::vector<Matrix6c>& A, const std::vector<Matrix6c>& B) {
  double worst = 0.0;
  for (size_t i = 0; i < A.size(); ++i) {
    const Eigen::Matrix<double, 6, 1> root = B[i].diagonal().cwiseAbs().cwiseSqrt();
    const auto weight = root.cwiseInverse().asDiagonal();
    const Matrix6c scaled = weight * B[i] * weight;
    const Matrix6c apart = weight * (A[i] - B[i]) * weight;
    const double now = apart.cwiseAbs().maxCoeff() / scaled.cwiseAbs().maxCoeff();
    worst = now <= worst ? worst : now;  // keeps NaN
  }
  return worst;
}

/// A base with coordinates, half as heavy as the platform, on springs as stiff as the legs.
model::Machine on_a_base(model::Machine machine, ModelKind kind) {
  const auto still = dynamics::linear_model(machine, machine.poses.back().X_BP, kind);
  model::BaseMount mount{.mass = 0.5 * machine.platform.mass,
                         .inertia = 0.7 * machine.platform.inertia.diagonal()};
  for (std::size_t k = 0; k < 6; ++k)
    mount.stiffness[k] = 0.8 * still.K(static_cast<int>(k), static_cast<int>(k));
  mount.stiffness[1].reset();
  machine.base_mount = mount;
  return machine;
}

class Methods : public testing::TestWithParam<AxesAndKind> {
 protected:
  /// Calls claim(machine, point, input) for machines of all sorts.
  template <class Claim>
  void for_each(const Claim& claim) {
    for (int i = 0; i < 24; ++i) {
      SCOPED_TRACE(fmt::format("machine {}", i));
      const auto gravity = i % 2 == 0 ? Gravity::none : Gravity::down;
      const auto machine =
          random_machine(random_, {.axes = std::get<0>(GetParam()), .gravity = gravity});
      claim(machine, random_.vector(0.7), i % 4 < 2 ? Input::wrench : Input::actuator);
    }
  }
  const ModelKind kind_ = std::get<1>(GetParam());
  Random random_{1977};
};

TEST_P(Methods, EliminationIsTheDenseSolution) {
  constexpr double rounding = 5e-11;  // condition of D near lightly damped resonances
  double worst = 0.0;
  for_each([&](const model::Machine& machine, const Vector3& p_PQ, Input input) {
    const auto model = response_of(machine, kind_, 0.0, p_PQ, input);
    const auto omega = band_of(model, 203);  // no multiple of the lanes
    EXPECT_EQ(response::best_method(model), Method::elimination);
    const double error =
        difference(response::frequency_response(model, omega, {}, Method::elimination),
                   response::frequency_response(model, omega, {}, Method::dense));
    EXPECT_LE(error, rounding);
    worst = std::max(worst, error);
  });
  RecordProperty("worst", fmt::format("{:.1e}", worst));
}

TEST_P(Methods, TheWholeEliminationIsTheDenseSolution) {
  constexpr double rounding = 5e-11;  // as above
  double worst = 0.0;
  int machines = 0;
  for_each([&](model::Machine machine, const Vector3& p_PQ, Input input) {
    if (++machines % 3 == 0) machine = on_a_base(machine, kind_);
    const auto model = response_of(machine, kind_, 0.01, p_PQ, input);
    const auto omega = band_of(model, 203);
    EXPECT_EQ(response::best_method(model), Method::whole);
    const double error = difference(response::frequency_response(model, omega, {}, Method::whole),
                                    response::frequency_response(model, omega, {}, Method::dense));
    EXPECT_LE(error, rounding);
    worst = std::max(worst, error);
  });
  RecordProperty("worst", fmt::format("{:.1e}", worst));
}

/// The modal sum knows ω² to some epsilons of the largest one, which a resonance of ζ shows 1/2ζ
/// times.
TEST_P(Methods, TheModalSumIsTheDenseSolution) {
  constexpr double zeta = 0.01;
  double worst = 0.0, worst_in_bound = 0.0;
  for_each([&](model::Machine machine, const Vector3& p_PQ, Input input) {
    remove_dampers(machine);
    const auto model = response_of(machine, kind_, zeta, p_PQ, input);
    const auto omega = band_of(model, 203);
    EXPECT_EQ(response::best_method(model), Method::modes);
    const double spread = model.modes.omega2[model.modes.size() - 1] / model.modes.omega2[0];
    const double bound = 5 * epsilon * spread / (2.0 * zeta);
    const double error = difference(response::frequency_response(model, omega, {}, Method::modes),
                                    response::frequency_response(model, omega, {}, Method::dense));
    EXPECT_LE(error, bound);
    worst = std::max(worst, error);
    worst_in_bound = std::max(worst_in_bound, error / bound);
  });
  RecordProperty("worst", fmt::format("{:.1e}, {:.2f} of the bound", worst, worst_in_bound));
}

/// K⁻¹ of the whole model: the flexible legs give way to a static load too.
TEST_P(Methods, TheStaticLimitIsTheCompliance) {
  for_each([&](const model::Machine& machine, const Vector3& p_PQ, Input) {
    const auto model = response_of(machine, kind_, 0.0, p_PQ, Input::wrench);
    const Eigen::MatrixXd compliance = Eigen::MatrixXd(model.K).inverse();
    const double omega = 1e-4 * model.modes.omega(0);
    const auto H = response::frequency_response(model, {&omega, 1});
    constexpr double slow = 1e-6;  // 2 ζ ω / ω_1 with ζ below a few per cent
    EXPECT_LE(difference(H, {compliance.topLeftCorner<6, 6>().cast<Complex>()}), slow);
  });
}

/// M⁻¹ of the whole model: far above all modes only masses resist.
TEST_P(Methods, FarAboveAllModesIsTheMassLine) {
  for_each([&](model::Machine machine, const Vector3& p_PQ, Input) {
    remove_dampers(machine);
    const auto model = response_of(machine, kind_, 0.0, p_PQ, Input::wrench);
    const Eigen::MatrixXd mobility = Eigen::MatrixXd(model.M).inverse();
    const double omega = 1e4 * model.modes.omega(model.modes.size() - 1);
    const auto H = response::frequency_response(model, {&omega, 1}, Output::acceleration);
    EXPECT_LE(difference(H, {mobility.topLeftCorner<6, 6>().cast<Complex>()}), 1e-7);
  });
}

/// Maxwell, Betti: what a force here moves there is what the force there moves here.
TEST_P(Methods, OfWrenchesIsSymmetric) {
  for_each([&](const model::Machine& machine, const Vector3& p_PQ, Input) {
    const auto model = response_of(machine, kind_, 0.01, p_PQ, Input::wrench);
    const auto omega = band_of(model, 50);
    const auto H = response::frequency_response(model, omega);
    auto transposed = H;
    for (auto& h : transposed) h.transposeInPlace();
    EXPECT_LE(difference(H, transposed), 1e-10);
  });
}

/// Straight legs carry the oil's force to the platform as it is; bent ones also push their knees.
TEST_P(Methods, ActuatorForcesAreWrenchesWhileLegsAreStraight) {
  for_each([&](const model::Machine& machine, const Vector3& p_PQ, Input) {
    const auto by_wrench = response_of(machine, kind_, 0.0, p_PQ, Input::wrench);
    const auto by_oil = response_of(machine, kind_, 0.0, p_PQ, Input::actuator);
    const auto omega = band_of(by_wrench, 50);
    const double apart = difference(response::frequency_response(by_oil, omega),
                                    response::frequency_response(by_wrench, omega));
    const bool straight = machine.gravity.isZero() || kind_ == ModelKind::rigid;
    if (straight) {
      EXPECT_LE(apart, 1e-10);
    } else {
      EXPECT_GE(apart, 1e-6);
    }
  });
}

TEST_P(Methods, TheModalSumAndTheStateSpaceHaveABaseToo) {
  constexpr double zeta = 0.02;
  for_each([&](model::Machine machine, const Vector3& p_PQ, Input input) {
    machine = on_a_base(machine, kind_);
    const bool damped = machine.gravity.isZero();
    if (!damped) remove_dampers(machine);
    const auto model = response_of(machine, kind_, damped ? 0.0 : zeta, p_PQ, input);
    ASSERT_EQ(model.modes.size(), dynamics::degrees_of_freedom(kind_) + 5);
    const auto omega = band_of(model, 20);
    EXPECT_EQ(response::best_method(model), damped ? Method::whole : Method::modes);
    EXPECT_THROW(response::frequency_response(model, omega, {}, Method::elimination),
                 std::invalid_argument);
    const auto found = response::frequency_response(model, omega);
    EXPECT_LE(difference(found, response::frequency_response(model, omega, {}, Method::dense)),
              1e-8);
    const auto system = response::state_space(model);
    std::vector<Matrix6c> H;
    for (const double at : omega) {
      Eigen::MatrixXcd sI_A = -system.A.cast<Complex>();
      sI_A.diagonal().array() += Complex(0.0, at);
      H.push_back(system.C * sI_A.partialPivLu().solve(system.B.cast<Complex>()).eval());
    }
    EXPECT_LE(difference(H, found), 1e-7);
  });
}

/// The oil pushes the base back: at rest the mount carries nothing of it, but all of a wrench.
TEST_P(Methods, ActuatorForcesAreInnerForcesOfAMachineOnItsBase) {
  for_each([&](const model::Machine& machine, const Vector3& p_PQ, Input) {
    const auto moving = on_a_base(machine, kind_);
    const auto still = response_of(machine, kind_, 0.0, p_PQ, Input::actuator);
    const double omega = 1e-5 * still.modes.omega(0);
    const auto at_rest = [&](const model::Machine& which, Input input) {
      return response::frequency_response(response_of(which, kind_, 0.0, p_PQ, input), {&omega, 1});
    };
    EXPECT_LE(difference(at_rest(moving, Input::actuator), at_rest(machine, Input::actuator)),
              1e-6);
    EXPECT_GE(difference(at_rest(moving, Input::wrench), at_rest(machine, Input::wrench)), 0.1);
  });
}

/// C (jω I − A)⁻¹ B + D, solved as it stands.
TEST_P(Methods, TheStateSpaceHasTheSameResponse) {
  constexpr double rounding = 1e-9;  // displacements and velocities side by side, not scaled
  double worst = 0.0;
  for_each([&](model::Machine machine, const Vector3& p_PQ, Input input) {
    if (machine.gravity.isZero()) remove_dampers(machine);
    const double ratio = machine.gravity.isZero() ? 0.02 : 0.0;
    const auto model = response_of(machine, kind_, ratio, p_PQ, input);
    const auto omega = band_of(model, 20);
    for (const auto output : {Output::displacement, Output::velocity, Output::acceleration}) {
      const auto system = response::state_space(model, output);
      ASSERT_EQ(system.A.rows(), 2 * model.modes.size());
      std::vector<Matrix6c> H;
      for (const double at : omega) {
        Eigen::MatrixXcd sI_A = -system.A.cast<Complex>();
        sI_A.diagonal().array() += Complex(0.0, at);
        H.push_back(system.C * sI_A.partialPivLu().solve(system.B.cast<Complex>()).eval() +
                    system.D.cast<Complex>());
      }
      const double error = difference(H, response::frequency_response(model, omega, output));
      EXPECT_LE(error, rounding);
      worst = std::max(worst, error);
    }
  });
  RecordProperty("worst", fmt::format("{:.1e}", worst));
}

INSTANTIATE_TEST_SUITE_P(, Methods,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

TEST(FrequencyResponse, OfVelocityAndAccelerationIsDisplacementDifferentiated) {
  Random random(3);
  const auto model =
      response_of(random_machine(random), ModelKind::full, 0.0, {0.1, 0.2, 0.3}, Input::wrench);
  const auto omega = band_of(model, 30);
  const auto x = response::frequency_response(model, omega);
  const auto v = response::frequency_response(model, omega, Output::velocity);
  const auto a = response::frequency_response(model, omega, Output::acceleration);
  for (size_t i = 0; i < omega.size(); ++i) {
    EXPECT_LE((v[i] - Complex(0.0, omega[i]) * x[i]).norm(), 1e-15 * v[i].norm());
    EXPECT_LE((a[i] + omega[i] * omega[i] * x[i]).norm(), 1e-15 * a[i].norm());
  }
}

/// Motion and force at Q from motion and force at the mass centre.
TEST(FrequencyResponse, MovesWithItsPointAsARigidBody) {
  Random random(4);
  const auto machine = random_machine(random);
  const Vector3 p_PC = machine.platform.mass_center, p_PQ = random.vector(0.8);
  const auto at_C = response_of(machine, ModelKind::guide, 0.0, p_PC, Input::wrench);
  const auto at_Q = response_of(machine, ModelKind::guide, 0.0, p_PQ, Input::wrench);
  const Vector3 arm = at_Q.p_BQ - at_C.p_BQ;
  Matrix6 T = Matrix6::Identity();  // v_Q = v_C + ω × arm
  T.topRightCorner<3, 3>() = -spatial::skew(arm);
  const auto omega = band_of(at_C, 30);
  auto expected = response::frequency_response(at_C, omega);
  for (auto& H : expected) H = (T * H * T.transpose()).eval();
  EXPECT_LE(difference(response::frequency_response(at_Q, omega), expected), 1e-10);
}

/// A knee between fixed joints resonates: its block is singular, the model is not.
TEST(FrequencyResponse, PassesAnUndampedLegAtItsOwnResonance) {
  auto machine = symmetric_machine();
  const auto model = response_of(machine, ModelKind::guide, 0.0, {}, Input::wrench);
  const double omega = std::sqrt(model.K(6, 6) / model.M(6, 6));
  // around it, and on both sides of the last bit
  std::vector<double> close{omega};
  for (int k = 0; k < 20; ++k) close.push_back(std::nextafter(close.back(), 0.0));
  for (const auto& H : response::frequency_response(model, close, {}, Method::elimination))
    EXPECT_TRUE(H.allFinite());
}

TEST(FrequencyResponse, RefusesAMethodThatIsNotExact) {
  Random random(5);
  auto machine = random_machine(random);
  const double omega = 1.0;
  const auto coupled = response_of(machine, ModelKind::guide, 0.0, {}, Input::wrench);
  EXPECT_THROW(response::frequency_response(coupled, {&omega, 1}, {}, Method::modes),
               std::invalid_argument);
  const auto with_ratio = response_of(machine, ModelKind::guide, 0.01, {}, Input::wrench);
  EXPECT_THROW(response::frequency_response(with_ratio, {&omega, 1}, {}, Method::elimination),
               std::invalid_argument);
  EXPECT_EQ(response::best_method(with_ratio), Method::whole);
}

TEST(LogSpace, IncludesBothEndsAndKeepsItsRatio) {
  const auto omega = response::log_space(2.0, 200.0, 11);
  ASSERT_EQ(omega.size(), 11U);
  EXPECT_EQ(omega.front(), 2.0);
  EXPECT_EQ(omega.back(), 200.0);
  for (size_t i = 1; i < omega.size(); ++i)
    EXPECT_NEAR(omega[i] / omega[i - 1], std::pow(10.0, 0.2), 1e-14);
  EXPECT_THROW(response::log_space(0.0, 1.0, 5), std::invalid_argument);
  EXPECT_THROW(response::log_space(2.0, 1.0, 5), std::invalid_argument);
  EXPECT_THROW(response::log_space(1.0, 2.0, 1), std::invalid_argument);
  EXPECT_THROW(response::log_space(std::numeric_limits<double>::quiet_NaN(), 2.0, 5),
               std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::test
