// Responses in the convention e^(−iωt): no mode describes them, and that is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "exact/modal_system.hpp"
#include "found_pole.hpp"
#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {
namespace {

/// Three modes, two inputs, three outputs; errors of `noise` times the largest response at the
/// second mode.
FrequencyResponses responses_with(double noise, std::uint64_t seed) {
  const auto system =
      pushed_at_first({test::real_mode(3.37, 0.021, Eigen::Vector3d(0.71, -0.33, 0.52)),
                       test::real_mode(5.91, 0.013, Eigen::Vector3d(0.28, 0.64, -0.47)),
                       test::real_mode(11.83, 0.034, Eigen::Vector3d(-0.39, 0.57, 0.83))},
                      2);
  const double deviation = noise * system.response(5.91).cwiseAbs().maxCoeff();
  test::Random random(seed);
  FrequencyResponses r;
  const auto header = test::header_of(2, 3, 1.0);
  r.inputs.assign(header.channels.begin(), header.channels.begin() + 2);
  r.outputs.assign(header.channels.begin() + 2, header.channels.end());
  constexpr double spacing = 0.0417;
  for (int k = 1; k < 380; ++k) {
    r.frequency.push_back(k * spacing);
    r.H.push_back(system.response(k * spacing));
    for (auto& h : r.H.back().reshaped())
      h += deviation * std::sqrt(0.5) *
           std::complex<double>(test::normal(random), test::normal(random));
  }
  return r;
}

FrequencyResponses conjugates_of(FrequencyResponses r) {
  for (auto& H : r.H) H = H.conjugate().eval();
  return r;
}

std::int64_t warnings_in(const Identification& found) {
  return std::ranges::count(found.warnings, ModeWarning::Kind::conjugated, &ModeWarning::kind);
}

TEST(Conjugated, AreNamedAndNoModeOfThemIsTrusted) {
  for (const double noise : {3e-4, 0.02}) {
    const auto found = identify_modes(conjugates_of(responses_with(noise, 5)));
    ASSERT_EQ(warnings_in(found), 1) << noise;
    const auto& warning =
        *std::ranges::find(found.warnings, ModeWarning::Kind::conjugated, &ModeWarning::kind);
    EXPECT_LT(warning.value, 0.3) << noise;
    EXPECT_GT(warning.share, 0.3) << noise;
    for (const auto& mode : found.modes) EXPECT_EQ(mode.quality(), 0.0);
  }
}

TEST(Conjugated, SoundResponsesAreNot) {
  for (const double noise : {3e-4, 0.02, 0.2})
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
      EXPECT_EQ(warnings_in(identify_modes(responses_with(noise, seed))), 0) << noise;
}

/// Signs of sensors, accelerations and delays are no matter.
TEST(Conjugated, SoundResponsesOfOtherSignsUnitsAndDelaysAreNot) {
  auto r = responses_with(3e-4, 2);
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * r.frequency[k]);
    r.H[k].row(0) *= -s * s;
    r.H[k].row(1) *= std::exp(-0.003 * s);
    r.H[k].row(2) *= std::exp(0.003 * s);  // recorded 3 ms too early
  }
  EXPECT_EQ(warnings_in(identify_modes(r)), 0);
}

TEST(Conjugated, NoiseAloneIsNot) {
  auto r = responses_with(3e-4, 2);
  test::Random random(11);
  for (auto& H : r.H)
    for (auto& h : H.reshaped())
      h = std::complex<double>(test::normal(random), test::normal(random));
  EXPECT_EQ(warnings_in(identify_modes(r)), 0);
  EXPECT_EQ(warnings_in(identify_modes(conjugates_of(r))), 0);
}

}  // namespace
}  // namespace hydrapod::identification
