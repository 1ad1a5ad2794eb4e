/// The instrumental estimate beside the imaginary axis, of loops known exactly.

#include "identification/damped.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "exact/closed_loop.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/identify.hpp"
#include "spectra_of.hpp"

namespace hydrapod::identification {
namespace {

using base::two_pi;
constexpr double sample_rate = 50.0;

const ChannelChoice from_drive{.inputs = {6, 7, 8}, .outputs = {3, 4, 5}, .instruments = {0, 1, 2}};

/// A broad resonance, and one so sharp that no block shows its width.
test::ModalSystem sharp_plant() {
  test::ModalSystem system;
  system.modes.push_back(test::real_mode(3.1, 0.11, Eigen::Vector3d(7.0, 3.3, -1.2)));
  system.modes.push_back(test::real_mode(6.71, 0.0023, Eigen::Vector3d(-0.9, 2.1, 1.7)));
  system.modes.push_back(test::real_mode(11.3, 0.06, Eigen::Vector3d(2.9, -6.0, 8.1)));
  return system;
}

TEST(Damped, IsTheResponseAtItsShiftAsOftenWithinItsBandAsPromised) {
  const auto system = sharp_plant();
  double inside = 0.0, all = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto record = test::closed_loop_record(
        system,
        {.gain = 0.2, .noise = 0.5, .samples = 1 << 17, .sample_rate = sample_rate, .seed = seed});
    const auto r = damped_instrumental(spectra_of(record, {.block_length = 4096}), from_drive);
    ASSERT_GT(r.shift, 0.0);
    const double radius = confidence_radius(0.95, r.degrees);
    for (std::size_t k = 0; k < r.lines(); ++k) {
      const auto truth = system.sampled_response(r.frequency[k], 1.0 / sample_rate, r.shift);
      for (int o = 0; o < 3; ++o)
        for (int i = 0; i < 3; ++i, all += 1.0)
          if (std::abs(r.H[k](o, i) - truth(o, i)) <= radius * std::sqrt(r.variance(k, o, i)))
            inside += 1.0;
    }
  }
  EXPECT_NEAR(inside / all, 0.95, 0.03);
}

/// What the plain ratio of spectra makes of the sharp mode is seen beside it.
TEST(Damped, SharpModesInsideALoopKeepTheirDamping) {
  const auto system = sharp_plant();
  const auto record = test::closed_loop_record(
      system,
      {.gain = 0.2, .noise = 0.05, .samples = 1 << 17, .sample_rate = sample_rate, .seed = 5});
  const auto spectra = spectra_of(record, {.block_length = 2048});
  const auto damped = identify_modes(damped_instrumental(spectra, from_drive), {.to = 20.0});
  ASSERT_EQ(damped.modes.size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) {
    const auto& fit = damped.modes[r].fit;
    const auto pole = system.modes[r].pole;
    const double zeta = -pole.real() / std::abs(pole);
    EXPECT_NEAR(fit.omega(), std::abs(pole), 3.5 * fit.omega_deviation) << r;
    EXPECT_NEAR(fit.damping_ratio(), zeta, 3.5 * fit.damping_deviation) << r;
    EXPECT_LT(fit.omega_deviation, 2e-3 * fit.omega()) << r;
    EXPECT_LT(fit.damping_deviation, 0.06 * zeta + 1e-4) << r;
  }
  IdentifyOptions no_window{.to = 20.0};
  no_window.window.evidence = std::numeric_limits<double>::infinity();
  const auto ratio =
      identify_modes(estimate_responses(spectra, from_drive, Estimator::instrumental), no_window);
  const auto sharp = std::ranges::find_if(ratio.modes, [](const IdentifiedMode& m) {
    return std::abs(m.fit.omega() / two_pi - 6.71) < 0.1;
  });
  ASSERT_NE(sharp, ratio.modes.end());
  EXPECT_GT(sharp->fit.damping_ratio(), 1.4 * 0.0023);
}

TEST(Damped, LeavesOutWhereNothingIsExcited) {
  const auto system = sharp_plant();
  const auto record =
      test::closed_loop_record(system, {.gain = 0.2,
                                        .noise = 0.05,
                                        .samples = 1 << 16,
                                        .sample_rate = sample_rate,
                                        .seed = 6,
                                        .smoothed_over = 5});  // nothing at 10 Hz and 20 Hz
  const auto r = damped_instrumental(spectra_of(record, {.block_length = 2048}), from_drive);
  for (const double f : r.frequency) {
    EXPECT_GT(std::abs(f - 10.0), 0.02);
    EXPECT_GT(std::abs(f - 20.0), 0.02);
  }
  EXPECT_GT(r.lines(), 250U);
}

TEST(Damped, NeedsAnExcitationPerInput) {
  const auto record = test::closed_loop_record(
      sharp_plant(), {.gain = 0.2, .samples = 1 << 13, .sample_rate = sample_rate});
  const auto s = spectra_of(record, {.block_length = 256});
  auto choice = from_drive;
  choice.instruments.pop_back();
  EXPECT_THROW(damped_instrumental(s, choice), base::ComputationError);
}

}  // namespace
}  // namespace hydrapod::identification
