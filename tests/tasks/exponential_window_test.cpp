/// A hammer test whose samples an analyser multiplied by a window e^(−t/τ): who says so gets the
/// damping of the structure, and who says a window that cannot have been is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "identification/hammer.hpp"

namespace hydrapod::test {
namespace {

constexpr double tau = 0.41;  // [s]

enum class Windowed { outputs, all };

/// Modes of 1.13, 1.71 and 0.62 %, with that the window adds 1/(τω).
data::Record windowed_hit(std::uint64_t seed, Windowed windowed) {
  auto record = identification::hammer_record({.seconds = 2.0, .noise = 1e-3}, seed);
  for (Eigen::Index k = 0; k < record.samples.rows(); ++k) {
    const double w = std::exp(-static_cast<double>(k) / (identification::hammer_rate * tau));
    if (windowed == Windowed::all)
      record.samples.row(k) *= w;
    else
      record.samples.row(k).tail(3) *= w;
  }
  return record;
}

tasks::Identified identified(const std::string& file, std::optional<double> window) {
  return tasks::identify({.measure = {.files = {file}, .exponential_window = window}});
}

/// The mode found next to `omega` [rad/s].
const identification::IdentifiedMode& nearest(const tasks::Identified& found, double omega) {
  return *std::ranges::min_element(
      found.modes.modes, {}, [&](const auto& mode) { return std::abs(mode.fit.omega() - omega); });
}

/// What else is listed, in the noise above the band of the blow, must not look certain.
void expect_the_beam(const tasks::Identified& found, std::uint64_t seed) {
  const auto truth = identification::beam();
  ASSERT_GE(found.modes.modes.size(), 3U) << seed;
  std::vector<const identification::IdentifiedMode*> true_ones;
  for (std::size_t r = 0; r < 3; ++r) {
    const double omega = std::abs(truth.modes[r].pole);
    true_ones.push_back(&nearest(found, omega));
    const auto& fit = true_ones.back()->fit;
    const double damping = -truth.modes[r].pole.real() / omega;
    EXPECT_NEAR(fit.omega(), omega, 5e-4 * fit.omega()) << seed;
    constexpr double far = 4.5;  // standard deviations; 1 % where these are smaller
    EXPECT_NEAR(fit.damping_ratio(), damping, std::max(far * fit.damping_deviation, 0.01 * damping))
        << seed << " " << r;
  }
  for (const auto& mode : found.modes.modes) {
    if (std::ranges::count(true_ones, &mode) == 0) {
      EXPECT_LT(mode.quality(), 0.8) << seed << ", " << mode.fit.omega() << " rad/s";
    }
  }
}

TEST(ExponentialWindow, IsTakenOutWhereItIsStated) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (const auto windowed : {Windowed::outputs, Windowed::all}) {
      const TemporaryFolder folder;
      data::write_record(folder / "hit.h5", windowed_hit(seed, windowed), data::RecordFormat::hdf5);
      // without it the damping is that of structure and window together
      const auto without = identified(folder / "hit.h5", {});
      const double omega = std::abs(identification::beam().modes[0].pole);
      EXPECT_NEAR(nearest(without, omega).fit.damping_ratio(), 0.0113 + 1.0 / (tau * omega), 0.001)
          << seed;
      const auto with = identified(folder / "hit.h5", tau);
      expect_the_beam(with, seed);
      EXPECT_THAT(
          with.modes.responses.warnings,
          ::testing::Contains(::testing::Field(&data::ResponseWarning::kind,
                                               data::ResponseWarning::Kind::exponential_window)));
    }
}

TEST(ExponentialWindow, IsReadFromNotesAndMeantForResponsesToo) {
  const TemporaryFolder folder;
  auto record = windowed_hit(3, Windowed::all);
  record.header.notes = "a beam on foam\nexponential window: 410 ms";
  data::write_record(folder / "hit.h5", record, data::RecordFormat::hdf5);
  expect_the_beam(identified(folder / "hit.h5", {}), 3);
  // responses of the samples as they are, as an analyser writes them
  record.header.notes.clear();
  data::write_record(folder / "plain.h5", record, data::RecordFormat::hdf5);
  const auto shared = tasks::shared_responses(tasks::frf({.files = {folder / "plain.h5"}}));
  data::write_frequency_responses(folder / "plain.uff", data::brought_to_axis(shared));
  const auto found = identified(folder / "plain.uff", tau);
  const double omega = std::abs(identification::beam().modes[0].pole);
  EXPECT_NEAR(nearest(found, omega).fit.damping_ratio(), 0.0113, 0.0006);
}

/// Noise n(t) e^(−at) goes on from line to line: with e_k = Σ n w e^(−iω_k t),
/// E[e_k e*_{k+d}] = Σ w² e^(i(ω_{k+d} − ω_k)t).
std::vector<std::complex<double>> covariance_of_samples(double decay, double step,
                                                        std::size_t lags) {
  std::vector<std::complex<double>> sums(lags);
  for (int k = 0; k < 8.0 / decay * identification::hammer_rate; ++k) {
    const double t = k / identification::hammer_rate, w = std::exp(-decay * t);
    for (std::size_t d = 0; d < lags; ++d)
      sums[d] +=
          w * w * std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(d) * step * t);
  }
  const double alone = sums.front().real();
  for (auto& sum : sums) sum /= alone;
  return sums;
}

TEST(ExponentialWindow, CorrelatesNoiseOfLines) {
  const TemporaryFolder folder;
  data::write_record(folder / "hit.h5", windowed_hit(6, Windowed::all), data::RecordFormat::hdf5);
  // an errorless file of an analyser: the window alone
  const auto shared = tasks::shared_responses(tasks::frf({.files = {folder / "hit.h5"}}));
  auto plain = data::brought_to_axis(shared);
  plain.line_covariance = {1.0};
  data::write_frequency_responses(folder / "plain.uff", plain);
  const auto step = [](const auto& r) { return r.frequency[1] - r.frequency[0]; };
  const auto of_file = tasks::shared_responses(
      tasks::frf({.files = {folder / "plain.uff"}, .exponential_window = tau}));
  ASSERT_GT(of_file.line_covariance.size(), 3U);
  const auto expected =
      covariance_of_samples(1.0 / tau, step(of_file), of_file.line_covariance.size());
  // half a sample more in the sum is a/rate = 1.2e-3 of it
  for (std::size_t d = 0; d < expected.size(); ++d)
    EXPECT_LT(std::abs(of_file.line_covariance[d] - expected[d]), 1.3e-3) << d;
  // samples of a hit have a decay of their own, and turn with the time of the hit
  const auto of_record = tasks::shared_responses(
      tasks::frf({.files = {folder / "hit.h5"}, .exponential_window = tau}));
  ASSERT_GT(of_record.line_covariance.size(), 3U);
  const auto sums =
      covariance_of_samples(of_record.shift, step(of_record), of_record.line_covariance.size());
  for (std::size_t d = 0; d < sums.size(); ++d)
    EXPECT_NEAR(std::abs(of_record.line_covariance[d]), std::abs(sums[d]), 1.3e-3) << d;
}

TEST(ExponentialWindow, ThatCannotHaveBeenIsRefused) {
  const TemporaryFolder folder;
  data::write_record(folder / "hit.h5", windowed_hit(4, Windowed::all), data::RecordFormat::hdf5);
  // the first mode decays with 1.68 + 2.44 1/s in the file, a window of 0.2 s alone with 5
  try {
    identified(folder / "hit.h5", 0.2);
    FAIL() << "not refused";
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("the window was longer, or there was none"));
  }
  // nor of responses: one mode that decays with 0.43 1/s, a window of 0.4 s
  data::FrequencyResponses plain;
  plain.inputs = {{.name = "u", .unit = "N", .role = data::Role::excitation}};
  plain.outputs = {{.name = "y1", .unit = "m", .role = data::Role::response},
                   {.name = "y2", .unit = "m", .role = data::Role::response}};
  const auto beam = ModalSystem{{real_mode(6.3, 0.011, Eigen::Vector2d(0.9, -0.7))}};
  for (double f = 2.0; f < 30.0; f += 0.05) {
    plain.frequency.push_back(f);
    plain.H.push_back(beam.response(f).leftCols(1));
  }
  data::write_frequency_responses(folder / "bare.csv", plain);
  EXPECT_THROW(identified(folder / "bare.csv", 0.4), base::InputError);
  // noise all the time is no hammer test
  const auto noise = record_of(chain(2, 1.3, 4100.0, 0.02), {.seed = 9});
  data::write_record(folder / "noise.h5", noise, data::RecordFormat::hdf5);
  EXPECT_THROW(identified(folder / "noise.h5", tau), base::InputError);
}

}  // namespace
}  // namespace hydrapod::test
