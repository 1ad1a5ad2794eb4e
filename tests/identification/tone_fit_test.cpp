/// A tone in a zoom of two channels that was made line by line.

#include "identification/tone_fit.hpp"

#include <gtest/gtest.h>

#include "exact/modal_system.hpp"

namespace hydrapod::identification {
namespace {

constexpr Eigen::Index rows = 509, hop = 16;
constexpr double line_of_zoom = two_pi / (rows * hop);  // [rad/sample]

/// Adds lines from `from` to `to` from the zoom's frequency: `first` and `second` times the same.
void add_noise(int from, int to, double first, double second, test::Random& random, Zoom& zoom) {
  for (int k = from; k <= to; ++k) {
    const Complex a(test::normal(random), test::normal(random));
    for (Eigen::Index j = 0; j < rows; ++j) {
      const Complex z = a * std::polar(1.0, two_pi * static_cast<double>(k * j) / rows);
      zoom.z(j, 0) += first * z;
      zoom.z(j, 1) += second * z;
    }
  }
}

/// The tone is below the zoom's frequency, where both channels have the same noise with opposite
/// signs. Above, noise that their difference shows best: it is not the tone's side.
TEST(ToneFit, BelowTheFrequencyOfTheZoomIsFoundInTheCombinationThatShowsIt) {
  test::Random random(2207);
  Zoom zoom{.omega = 0.731, .window = 4 * hop, .hop = hop, .z = MatrixXcd::Zero(rows, 2)};
  const double line = 20.0 * line_of_zoom, wander = 0.5 * line_of_zoom;
  const double offset = -12.3 * line_of_zoom;
  const Complex first(0.61, -0.2), second(0.57, -0.19);
  for (Eigen::Index j = 0; j < rows; ++j) {
    const Complex turn = std::polar(1.0, offset * zoom.time(j));
    zoom.z(j, 0) = first * turn;
    zoom.z(j, 1) = second * turn;
  }
  add_noise(-120, -21, 0.13, -0.12, random, zoom);
  add_noise(1, 19, 0.07, -0.071, random, zoom);
  add_noise(20, 120, 0.004, 0.0041, random, zoom);
  const auto tracks = fit_tone({zoom}, line, wander, {});
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_NEAR(tracks[0].omega, zoom.omega + offset, 0.05 * line_of_zoom);
  const Complex e = tracks[0].envelope.at(zoom.time(rows / 2));
  EXPECT_LT(std::abs(tracks[0].amplitude[0] * e - first), 0.1 * std::abs(first));
  EXPECT_LT(std::abs(tracks[0].amplitude[1] * e - second), 0.1 * std::abs(second));
}

}  // namespace
}  // namespace hydrapod::identification
