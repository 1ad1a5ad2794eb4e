/// The linear part of the modal fit: shapes and residual terms of poles and participations that are
/// given, as the page asks for them.

#include "identification/fixed_poles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "exact/modal_system.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::identification {
namespace {

/// Three real modes of three outputs; participations with a largest element of 1.
test::ModalSystem three_modes() {
  test::ModalSystem system;
  for (const auto& [f, shape] : {std::pair{5.0, Eigen::Vector3d(1.0, -0.4, 0.3)},
                                 {7.5, Eigen::Vector3d(0.2, 1.0, 0.6)},
                                 {11.0, Eigen::Vector3d(-0.5, 0.1, 1.0)}})
    system.modes.push_back(test::real_mode(f, 0.02, shape));
  for (auto& mode : system.modes) {
    Eigen::Index largest = 0;
    mode.participation.cwiseAbs().maxCoeff(&largest);
    const auto unit = mode.participation[largest];
    mode.participation /= unit;
    mode.shape *= unit;
  }
  return system;
}

FrequencyResponses responses_of_modes(const test::ModalSystem& system) {
  FrequencyResponses r;
  for (int k = 0; k < 200; ++k) {
    r.frequency.push_back(2.0 + 0.0625 * k);
    r.H.push_back(system.response(r.frequency.back()));
  }
  return r;
}

std::vector<PoleEstimate> poles_of(const test::ModalSystem& system) {
  std::vector<PoleEstimate> poles;
  for (const auto& mode : system.modes)
    poles.push_back({.pole = mode.pole, .shape = {}, .participation = mode.participation});
  return poles;
}

ModalModel fit_of(const FrequencyResponses& r, const std::vector<PoleEstimate>& poles) {
  const FitSystem system(r, {});
  return model_of(system, r, system.solved(shared_parameters(poles, system.inputs())));
}

/// Covariances of inputs: `off` is what any two of them have in common.
FrequencyResponses with_errors(FrequencyResponses r, double off) {
  for (std::size_t k = 0; k < r.lines(); ++k) {
    Eigen::MatrixXcd Q = Eigen::MatrixXcd::Constant(3, 3, std::complex(off, 0.0));
    for (int i = 0; i < 3; ++i) Q(i, i) = 1.0 + i;
    r.noise.push_back(1e-6 * (1.0 + 0.01 * static_cast<double>(k)) *
                      Eigen::MatrixXcd::Identity(3, 3));
    r.input_factor.push_back(Q);
  }
  return r;
}

TEST(FixedPoles, HaveTheShapesOfTheSystem) {
  const auto system = three_modes();
  const auto r = responses_of_modes(system);
  for (const auto& given : {r, with_errors(r, 0.0), with_errors(r, 0.3)}) {
    const auto model = fit_of(given, poles_of(system));
    ASSERT_EQ(model.modes.size(), 3U);
    for (std::size_t m = 0; m < 3; ++m)
      EXPECT_LT((model.modes[m].shape - system.modes[m].shape).norm(),
                1e-9 * system.modes[m].shape.norm());
    EXPECT_LT(model.error, 1e-9);
  }
}

/// Errors of inputs that are independent take a shorter way to the same sums.
TEST(FixedPoles, OfIndependentInputsAreThoseOfNearlyIndependentOnes) {
  const auto system = three_modes();
  auto r = responses_of_modes(system);
  for (std::size_t k = 0; k < r.lines(); ++k)  // what no model has
    r.H[k](1, 2) += std::complex(0.01 * std::sin(static_cast<double>(7 * k)), 0.0);
  auto poles = poles_of(system);
  poles.pop_back();
  const auto one = fit_of(with_errors(r, 0.0), poles), other = fit_of(with_errors(r, 1e-12), poles);
  EXPECT_GT(one.error, 1e-3);
  EXPECT_NEAR(one.cost, other.cost, 1e-9 * one.cost);
  for (std::size_t m = 0; m < poles.size(); ++m)
    EXPECT_LT((one.modes[m].shape - other.modes[m].shape).norm(), 1e-9 * one.modes[m].shape.norm());
}

TEST(FixedPoles, AreSolvedAloneAsBesideAStateThatHasSomeOfThem) {
  const auto given = three_modes();
  auto r = responses_of_modes(given);
  r.taper = Eigen::VectorXd::LinSpaced(1024, 1.0, 0.0);
  r.sample_rate = 64.0;
  const FitSystem system(r, {});
  const auto poles = poles_of(given);
  const auto before = system.solved(shared_parameters({poles[2], poles[0]}, 3));
  const auto alone = system.solved(shared_parameters(poles, 3));
  const auto beside = system.solved(shared_parameters(poles, 3), &before);
  EXPECT_EQ(alone.cost, beside.cost);
  EXPECT_EQ(alone.residual, beside.residual);
}

TEST(FixedPoles, NeedNotBeAny) {
  const auto model = fit_of(responses_of_modes(three_modes()), {});
  EXPECT_TRUE(model.modes.empty());
  EXPECT_EQ(model.residuals.size(), 4U);
  EXPECT_GT(model.error, 0.3);
  EXPECT_LE(model.error, 1.0);
}

TEST(FixedPoles, HaveNoShapeWhereAnOutputHasNoResponse) {
  const auto system = three_modes();
  auto r = responses_of_modes(system);
  for (auto& H : r.H) H.row(1).setZero();
  auto known = with_errors(r, 0.0);
  for (auto& noise : known.noise) noise(1, 1) = 0.0;
  for (const auto& given : {r, known}) {
    const auto model = fit_of(given, poles_of(system));
    for (std::size_t m = 0; m < 3; ++m) {
      EXPECT_EQ(model.modes[m].shape[1], 0.0);
      EXPECT_NEAR(std::abs(model.modes[m].shape[0] - system.modes[m].shape[0]), 0.0,
                  1e-9 * system.modes[m].shape.norm());
    }
    EXPECT_LT(model.error, 1e-9);
  }
}

/// The transform of the window repeats after n lines; a file may have lines beyond.
TEST(PoleBasis, HasTheWindowsPartOfLinesBeyondItsRate) {
  constexpr int n = 64;
  constexpr double step = 0.25;
  FrequencyResponses r;
  r.frequency = {3 * step, (3 + n) * step, (3 + 5 * n) * step};
  r.taper = Eigen::VectorXd::LinSpaced(n, 1.0, 0.2);
  r.sample_rate = n * step;
  const std::complex<double> pole(-0.5, 6.0);
  const auto lines = PoleBasis(r, true).at(pole);
  const auto of_window = [&](int k) {
    const std::complex<double> s(0.0, base::two_pi * r.frequency[static_cast<std::size_t>(k)]);
    return lines.g[k] - (1.0 - std::exp(pole / step)) / (s - pole);
  };
  for (const int k : {1, 2})
    EXPECT_LT(std::abs(of_window(k) - of_window(0)), 1e-12 * std::abs(of_window(0)));
}

}  // namespace
}  // namespace hydrapod::identification
