/// Poles of a filter that all sensors pass and no input does are no modes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "exact/modal_system.hpp"
#include "found_pole.hpp"
#include "hydrapod/identification/identify.hpp"
#include "lines_with_errors.hpp"

namespace hydrapod::identification {
namespace {

using Number = std::complex<double>;

/// Five accelerations. `twice`: each mode has another one at the same place, as symmetry makes it.
test::ModalSystem bench_with_five_sensors(Eigen::Index inputs, bool twice, test::Random& random) {
  struct Mode {
    double frequency{}, damping{};
  };
  std::vector<test::ExactMode> modes;
  for (const Mode m : {Mode{9.73, 0.0113}, {21.7, 0.0089}, {33.9, 0.0231}, {47.1, 0.0167}})
    for (int k = 0; k < (twice ? 2 : 1); ++k) {
      Eigen::VectorXd shape(5);
      for (double& x : shape) {
        const double sign = test::normal(random) > 0.0 ? 1.0 : -1.0;
        x = sign * (0.3 + 0.7 * std::abs(std::sin(test::normal(random))));
      }
      modes.push_back(test::real_mode(m.frequency, m.damping, shape));
    }
  return pushed_at_first(std::move(modes), inputs);
}

/// Butterworth's low pass of this order (even; 0: none).
Number low_pass(Number s, int order, double corner) {
  Number product = 1.0;
  for (int k = 0; k < order / 2; ++k) {
    const double angle = std::numbers::pi * (2.0 * k + 1.0) / (2.0 * order);
    const Number x = s / corner;
    product *= 1.0 / (x * x + 2.0 * std::sin(angle) * x + 1.0);
  }
  return product;
}

/// Each line with errors of 1 % of its row.
FrequencyResponses filtered_responses(const test::ModalSystem& system, int order,
                                      test::Random& random) {
  constexpr double corner = 2.0 * std::numbers::pi * 71.3;
  FrequencyResponses r;
  const auto inputs = system.inputs();
  const auto header = test::header_of(inputs, 5, 1.0);
  r.inputs.assign(header.channels.begin(), header.channels.begin() + inputs);
  r.outputs.assign(header.channels.begin() + inputs, header.channels.end());
  for (auto& channel : r.outputs) channel.unit = "m/s^2";
  for (double f = 4.1; f < 104.0; f += 0.113) {
    const Number s(0.0, 2.0 * std::numbers::pi * f);
    add_line_with_errors(f, s * s * low_pass(s, order, corner) * system.response(f), 0.01, random,
                         r);
  }
  return r;
}

bool names_common_poles(const Identification& found) {
  return std::ranges::any_of(found.warnings, [](const ModeWarning& warning) {
    return warning.kind == ModeWarning::Kind::common_poles;
  });
}

TEST(CommonPoles, OfAFilterAreNoModes) {
  for (const Eigen::Index inputs : {1, 2, 3})
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE(inputs);
      SCOPED_TRACE(seed);
      test::Random random(seed);
      const auto system = bench_with_five_sensors(inputs, false, random);
      const auto found = identify_modes(filtered_responses(system, 8, random));
      ASSERT_GT(found.modes.size(), system.modes.size());
      EXPECT_TRUE(names_common_poles(found));
      for (std::size_t r = 0; r < found.modes.size(); ++r) {
        SCOPED_TRACE(r);
        const auto& mode = found.modes[r];
        if (r >= system.modes.size()) {
          EXPECT_LE(mode.quality(), 0.3) << mode.fit.omega() / (2.0 * std::numbers::pi);
          continue;
        }
        EXPECT_GT(mode.quality(), 0.6);
        expect_within_deviations(mode.fit, TruePole(system.modes[r].pole), 0.0, 0.0, 4.5);
      }
    }
}

TEST(CommonPoles, ModesOfAMachineAreNone) {
  for (const Eigen::Index inputs : {1, 2, 3})
    for (const bool twice : {false, true}) {
      SCOPED_TRACE(inputs);
      SCOPED_TRACE(twice);
      test::Random random(7);
      const auto system = bench_with_five_sensors(inputs, twice, random);
      EXPECT_FALSE(names_common_poles(identify_modes(filtered_responses(system, 0, random))));
    }
}

}  // namespace
}  // namespace hydrapod::identification
