/// The bandwidth of a command response, against a first-order lag.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "hydrapod/base/units.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::test {
namespace {

using base::two_pi;
using report::Json;

TEST(CommandBandwidth, IsWhereTheCurveFallsBelowMinusThreeDecibels) {
  // 1/(1 + iω/ω_1): down by √½ and behind by 45° at ω_1; its square by 90°
  report::CommandResponse response;
  constexpr double corner = two_pi * 1.37;
  for (int k = 0; k < 2000; ++k) {
    const double omega = corner * std::pow(10.0, (k - 1000) / 900.0);
    const std::complex<double> one = 1.0 / std::complex<double>(1.0, omega / corner);
    response.omega.push_back(omega);
    response.H.emplace_back(response::Matrix6c::Identity() * one);
    response.H.back()(4, 4) = 1.3 * one * one;
  }
  const auto first = report::command_bandwidth(response, 0),
             second = report::command_bandwidth(response, 4);
  EXPECT_NEAR(*first.magnitude, corner, 1e-5 * corner);
  EXPECT_FALSE(first.phase);
  EXPECT_NEAR(*second.phase, corner, 1e-5 * corner);
  EXPECT_NEAR(*second.magnitude, corner * std::sqrt(1.3 * std::sqrt(2.0) - 1.0), 1e-5 * corner);
  EXPECT_NEAR(second.peak, 1.3, 1e-2);
  const Json json = report::command_response_json(response)["bandwidths"];
  EXPECT_NEAR(json[0]["minus_3_db_hz"].get<double>(), 1.37, 1e-4);
  EXPECT_TRUE(json[0]["minus_90_deg_hz"].is_null());
  EXPECT_NEAR(json[4]["minus_90_deg_hz"].get<double>(), 1.37, 1e-4);
  EXPECT_NEAR(json[4]["peak_hz"].get<double>(), second.peak_omega / two_pi, 1e-12);
  EXPECT_EQ(json[4]["peak"], second.peak);
}

}  // namespace
}  // namespace hydrapod::test
