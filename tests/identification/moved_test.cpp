/// A resonance that jumps or swings during the record comes out as two modes of one shape. They are
/// told from two modes that the machine has.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <vector>

#include "exact/modal_system.hpp"
#include "found_pole.hpp"
#include "gapped.hpp"

namespace hydrapod::identification {
namespace {

constexpr double moving_hz = 39.7;

/// One force, four displacements. `beside`: of the frequency of a second mode with the shape of the
/// last one, as an absorber makes it whose motion is not measured; 0: there is none.
test::ModalSystem pushed_once(double beside) {
  using Eigen::Vector4d;
  const Vector4d last(0.61, 1.03, 0.94, -0.87);
  std::vector<test::ExactMode> modes{
      test::real_mode(11.83, 0.0113, Vector4d(0.97, 0.79, 0.53, -0.41)),
      test::real_mode(23.3, 0.0091, Vector4d(-0.44, 1.07, -0.38, 0.83)),
      test::real_mode(moving_hz, 0.0053, last)};
  if (beside > 0.0) modes.push_back(test::real_mode(beside * moving_hz, 0.0059, 0.7 * last));
  return pushed_at_first(std::move(modes), 1);
}

/// 200 s at 200 Hz; the last mode has `factor` of its frequency at this share of the record.
Measurement measured_while_moving(const test::ModalSystem& system,
                                  const std::function<double(double)>& factor, std::uint64_t seed) {
  constexpr double T = 0.005;
  constexpr Eigen::Index samples = 40000, settling = 2000;
  test::Random random(811 * seed + 5);
  data::Record record{.header = test::header_of(1, 4, 1.0 / T),
                      .samples = data::Samples(samples, 5)};
  std::vector<std::complex<double>> state(system.modes.size());
  for (Eigen::Index k = -settling; k < samples; ++k) {
    const double u = test::normal(random);
    Eigen::VectorXd y = Eigen::VectorXd::Zero(4);
    const double share = std::max(0.0, static_cast<double>(k) / static_cast<double>(samples));
    for (std::size_t r = 0; r < state.size(); ++r) {
      const auto& mode = system.modes[r];
      y += 2.0 * (mode.shape * state[r]).real();
      const auto pole = mode.pole * (r == 2 ? factor(share) : 1.0), decay = std::exp(pole * T);
      state[r] = decay * state[r] + (decay - 1.0) / pole * mode.participation[0] * u;
    }
    if (k >= 0) record.samples.row(k) << u, y.transpose();
  }
  add_output_noise(0.01, 1, random, record);
  return gapped_measurement(record);
}

std::vector<const IdentifiedMode*> modes_near(const Identification& found, double hertz) {
  std::vector<const IdentifiedMode*> list;
  for (const auto& mode : found.modes)
    if (std::abs(mode.fit.omega() / (2.0 * std::numbers::pi) / hertz - 1.0) < 0.05)
      list.push_back(&mode);
  return list;
}

bool is_called_moved(const Identification& found) {
  return std::ranges::any_of(found.warnings, [](const ModeWarning& warning) {
    return warning.kind == ModeWarning::Kind::moved;
  });
}

/// A jump by eight half widths, and two that are slow enough to be two peaks.
TEST(Moved, AResonanceThatMovesIsNoPairOfModes) {
  const auto jump = [](double share) { return share < 0.5 ? 1.0 : 1.04; };
  const auto swing = [](double share) {
    return 1.0 + 0.02 * std::sin(6.0 * std::numbers::pi * share);
  };
  int pairs = 0;
  for (const std::function<double(double)>& factor : {std::function<double(double)>(jump), {swing}})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(seed);
      const auto found =
          identify_modes(measured_while_moving(pushed_once(0.0), factor, seed).responses);
      const auto near = modes_near(found, 1.01 * moving_hz);
      if (near.size() < 2) continue;
      ++pairs;
      EXPECT_TRUE(is_called_moved(found));
      for (const auto* mode : near) EXPECT_LE(mode->quality(), 0.3);
      // the others did not move
      for (const double hertz : {11.83, 23.3})
        for (const auto* mode : modes_near(found, hertz)) EXPECT_GT(mode->quality(), 0.8);
    }
  EXPECT_GE(pairs, 5);
}

TEST(Moved, APairThatTheMachineHasIsNotCalledOneResonance) {
  for (const double beside : {1.025, 1.04})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(seed);
      const auto found = identify_modes(measured_while_moving(
                                            pushed_once(beside), [](double) { return 1.0; }, seed)
                                            .responses);
      EXPECT_FALSE(is_called_moved(found));
      const auto near = modes_near(found, 1.02 * moving_hz);
      EXPECT_EQ(near.size(), 2U);
      for (const auto* mode : near) EXPECT_GT(mode->quality(), 0.8);
    }
}

}  // namespace
}  // namespace hydrapod::identification
