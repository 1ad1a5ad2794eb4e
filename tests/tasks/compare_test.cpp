/// Tests of differences between two lists of modes.

#include <gmock/gmock.h>

#include <cmath>

#include "hydrapod/numerics/statistics.hpp"
#include "tasks/mode_differences.hpp"

namespace hydrapod::tasks {
namespace {

using Verdict = report::TestedDifference::Verdict;

/// Modes with shapes of their own on as many outputs.
Side measured(const std::vector<double>& omega, const std::vector<double>& zeta, double omega_error,
              double zeta_error) {
  Side side;
  const auto count = static_cast<Eigen::Index>(omega.size());
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    side.modal.outputs.push_back({.name = "sensor " + std::to_string(k), .unit = "m"});
    side.modal.modes.push_back(
        {.pole = omega[i] * std::complex<double>(-zeta[i], std::sqrt(1.0 - zeta[i] * zeta[i])),
         .shape = Eigen::VectorXcd::Unit(count, k)});
    side.thing.modes.push_back({.omega = omega[i], .damping_ratio = zeta[i]});
    if (omega_error > 0.0) side.thing.modes.back().omega_deviation = omega_error * omega[i];
    if (zeta_error > 0.0) side.thing.modes.back().damping_deviation = zeta_error;
  }
  return side;
}

const std::vector<double> omegas{31.7, 36.1, 71.3, 77.9, 101.3};
const std::vector<double> zetas{0.021, 0.017, 0.033, 0.012, 0.025};
constexpr double omega_error = 1.3e-3, zeta_error = 7e-4;

/// The same modes with errors of the measurement.
Side drawn(numerics::Gaussian& random, double shift = 0.0) {
  auto omega = omegas;
  auto zeta = zetas;
  for (auto& value : omega) value *= 1.0 + omega_error * random();
  for (auto& value : zeta) value += zeta_error * random();
  omega[2] *= 1.0 + shift;
  return measured(omega, zeta, omega_error, zeta_error);
}

TEST(ModeDifferences, OneInTwentyComparisonsOfTheSameMachineFindsADifference) {
  numerics::Gaussian random(4);
  constexpr int trials = 4000;
  constexpr double level = 0.05;
  int found = 0;
  for (int k = 0; k < trials; ++k) {
    const auto comparison = compare_sides(drawn(random), drawn(random), level);
    ASSERT_EQ(comparison.pairs.size(), omegas.size());
    bool any = false;
    for (const auto& pair : comparison.pairs)
      any = any || pair.frequency.verdict == Verdict::significant ||
            pair.damping.verdict == Verdict::significant;
    found += any ? 1 : 0;
  }
  // Holm with m independent tests of no difference: 1 − (1 − level/m)^m = 0.0489
  const double expected = 1.0 - std::pow(1.0 - level / 10.0, 10.0);
  const double deviation = std::sqrt(expected * (1.0 - expected) / trials);
  EXPECT_NEAR(static_cast<double>(found) / trials, expected, 4.0 * deviation);
}

TEST(ModeDifferences, AChangeOfSevenDeviationsIsFoundAndItAlone) {
  numerics::Gaussian random(5);
  const double change = 7.0 * std::sqrt(2.0) * omega_error;
  const auto comparison = compare_sides(drawn(random), drawn(random, change), 0.05);
  ASSERT_EQ(comparison.pairs.size(), omegas.size());
  for (std::size_t k = 0; k < omegas.size(); ++k) {
    EXPECT_EQ(comparison.pairs[k].frequency.verdict,
              k == 2 ? Verdict::significant : Verdict::not_significant)
        << k;
    EXPECT_EQ(comparison.pairs[k].damping.verdict, Verdict::not_significant) << k;
  }
}

TEST(ModeDifferences, AKnownDeviationOfOneSideIsThatOfTheDifferenceToACalculatedOne) {
  auto model = measured(omegas, zetas, 0.0, 0.0);
  model.calculated = true;
  auto moved = omegas;
  moved[0] *= 1.0 + 3.0 * omega_error;
  const auto comparison =
      compare_sides(model, measured(moved, zetas, omega_error, zeta_error), 0.05);
  const auto& first = comparison.pairs[0].frequency;
  const double z = 3.0 / (1.0 + 3.0 * omega_error);  // its deviation is a share of its ω
  EXPECT_NEAR(first.value / *first.deviation, z, 1e-9);
  EXPECT_NEAR(*first.p, std::erfc(z / std::sqrt(2.0)), 1e-12);
  EXPECT_EQ(first.verdict, Verdict::significant);  // 0.0028 < 0.05/10
}

TEST(ModeDifferences, WithoutUncertaintyNothingIsSaid) {
  auto moved = omegas;
  moved[1] *= 1.04;
  const auto known = measured(omegas, zetas, omega_error, zeta_error);
  const auto unknown = measured(moved, zetas, 0.0, zeta_error);
  for (const auto& pair : compare_sides(known, unknown, 0.05).pairs) {
    EXPECT_EQ(pair.frequency.verdict, Verdict::cannot_say);
    EXPECT_FALSE(pair.frequency.p);
    EXPECT_EQ(pair.damping.verdict, Verdict::not_significant);
  }
  auto a = unknown, b = measured(omegas, zetas, 0.0, 0.0);
  a.calculated = b.calculated = true;
  for (const auto& pair : compare_sides(a, b, 0.05).pairs)
    EXPECT_EQ(pair.frequency.verdict, Verdict::calculated);
}

TEST(ModeDifferences, ModesWithoutAPartnerAreListed) {
  auto fewer = omegas;
  fewer[1] = 61.0;  // too far from 36.1, and of another shape than 71.3
  const auto comparison = compare_sides(measured(omegas, zetas, omega_error, zeta_error),
                                        measured(fewer, zetas, omega_error, zeta_error), 0.05);
  EXPECT_EQ(comparison.pairs.size(), omegas.size() - 1);
  EXPECT_THAT(comparison.first_left, testing::ElementsAre(1));
  EXPECT_THAT(comparison.second_left, testing::ElementsAre(1));
}

TEST(ModeDifferences, AShapeOutOfPhaseWidensTheUncertainty) {
  data::ModalResult mode{.pole = {-0.7, 35.0}, .omega_deviation = 0.01};
  mode.shape = Eigen::Vector2cd(1.0, 0.5);
  EXPECT_NEAR(frequency_deviation(mode, 0.0), 0.01, 1e-12);
  mode.shape[1] = {0.0, 1.0};  // a circle: MPC 0
  EXPECT_NEAR(frequency_deviation(mode, 0.0), std::hypot(0.01, 0.7), 1e-9);
}

}  // namespace
}  // namespace hydrapod::tasks
