/// Sensors that do not measure what is constant (AC coupling): their high pass is in the responses.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "exact/modal_system.hpp"
#include "found_pole.hpp"
#include "hydrapod/identification/identify.hpp"
#include "lines_with_errors.hpp"

namespace hydrapod::identification {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

/// Two forces and five accelerations.
test::ModalSystem four_modes(test::Random& random) {
  struct Mode {
    double frequency{}, damping{};
  };
  test::ModalSystem system;
  for (const Mode m : {Mode{8.31, 0.0062}, {19.7, 0.0053}, {36.1, 0.0047}, {53.3, 0.0051}}) {
    Eigen::VectorXd shape(5);
    for (double& x : shape) {
      const double sign = test::normal(random) > 0.0 ? 1.0 : -1.0;
      x = sign * (0.3 + 0.7 * std::abs(std::sin(test::normal(random))));
    }
    system.modes.push_back(test::real_mode(m.frequency, m.damping, shape));
    auto& participation = system.modes.back().participation;
    participation = participation.head(2).eval();
  }
  return system;
}

/// Each line with errors of 3 % of its row: what lies below the modes is known as well as they are.
FrequencyResponses coupled_responses(const test::ModalSystem& system, double corner,
                                     test::Random& random) {
  FrequencyResponses r;
  const auto header = test::header_of(2, 5, 1.0);
  r.inputs.assign(header.channels.begin(), header.channels.begin() + 2);
  r.outputs.assign(header.channels.begin() + 2, header.channels.end());
  for (auto& channel : r.outputs) channel.unit = "m/s^2";
  const double w = 2.0 * pi * corner;
  for (double f = 2.2; f < 66.0; f += 0.0613) {
    const Complex s(0.0, 2.0 * pi * f);
    const Complex filter = s * s / (s * s + std::numbers::sqrt2 * w * s + w * w);
    add_line_with_errors(f, s * s * filter * system.response(f), 0.03, random, r);
  }
  return r;
}

TEST(CoupledSensors, TheirHighPassIsAPoleAndNoMode) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const auto system = four_modes(random);
    const auto found = identify_modes(coupled_responses(system, 2.93, random));
    EXPECT_EQ(found.heavily_damped.size(), 1U);
    EXPECT_TRUE(found.unexplained.empty());
    EXPECT_LT(found.model.misfit, 1.03);
    ASSERT_EQ(found.modes.size(), system.modes.size());
    for (std::size_t r = 0; r < system.modes.size(); ++r) {
      SCOPED_TRACE(r);
      expect_within_deviations(found.modes[r].fit, TruePole(system.modes[r].pole), 0.0, 0.0, 3.5);
    }
  }
}

TEST(CoupledSensors, WithoutAHighPassThereIsNoPole) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    test::Random random(seed);
    const auto system = four_modes(random);
    EXPECT_TRUE(identify_modes(coupled_responses(system, 0.0, random)).heavily_damped.empty());
  }
}

}  // namespace
}  // namespace hydrapod::identification
