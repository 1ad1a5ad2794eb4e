/// Parts of the identification against what can be written down: white noise, ramps, splines, a
/// tone beside strong noise, and fits of modes with noise that is known.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "exact/modal_system.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/cross_check.hpp"
#include "hydrapod/identification/identify.hpp"
#include "identification/harmonics.hpp"
#include "identification/tone_fit.hpp"
#include "spectra_of.hpp"

namespace hydrapod::identification {
namespace {

using base::two_pi;

/// Independent Gaussian channels.
data::Record white(int samples, double rate, const std::vector<double>& deviations,
                   std::uint64_t seed) {
  const auto channels = static_cast<Eigen::Index>(deviations.size());
  data::Record record{.header = test::header_of(0, channels, rate), .samples = {}};
  record.samples.resize(samples, channels);
  test::Random random(seed);
  for (Eigen::Index t = 0; t < samples; ++t)
    for (Eigen::Index c = 0; c < channels; ++c)
      record.samples(t, c) = deviations[static_cast<std::size_t>(c)] * test::normal(random);
  return record;
}

/// An output one sample behind its input, in noise of 0.36 of its power: 1/1.36 of it is coherent
/// at every line, whatever its phase there.
TEST(Coherence, OfADelayInNoiseIsTheShareOfThePower) {
  data::Record record{.header = test::header_of(1, 1, 50.0), .samples = {}};
  record.samples.resize(1 << 15, 2);
  test::Random random(101);
  double before = 0.0;
  for (Eigen::Index t = 0; t < record.samples.rows(); ++t) {
    record.samples(t, 0) = test::normal(random);
    record.samples(t, 1) = before + 0.6 * test::normal(random);
    before = record.samples(t, 0);
  }
  const auto r =
      estimate_responses(spectra_of(record, {.block_length = 256}),
                         {.inputs = {0}, .outputs = {1}, .instruments = {}}, Estimator::h1);
  double coherence = 0.0, multiple = 0.0, lowest = 1.0;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    coherence += r.coherence[k](0, 0) / static_cast<double>(r.lines());
    multiple += r.multiple_coherence[k][0] / static_cast<double>(r.lines());
    lowest = std::min(lowest, r.coherence[k](0, 0));
  }
  EXPECT_NEAR(coherence, 1.0 / 1.36, 0.02);
  EXPECT_NEAR(multiple, 1.0 / 1.36, 0.02);
  EXPECT_GT(lowest, 0.5);
}

/// Of white noise of variance σ² only lag zero is left, and each half has half of it: σ² T/2.
TEST(HalfSpectra, OfWhiteNoiseAreHalfItsVariance) {
  constexpr double rate = 37.0;
  const auto half =
      half_spectra(spectra_of(white(1 << 15, rate, {1.7, 0.6}, 7), {.block_length = 256}), {0, 1});
  ASSERT_EQ(half.inputs.size(), 2U);
  std::complex<double> first = 0.0, second = 0.0;
  for (const auto& H : half.H) {
    first += H(0, 0) / static_cast<double>(half.lines());
    second += H(1, 1) / static_cast<double>(half.lines());
  }
  EXPECT_NEAR(std::abs(first - 0.5 * 1.7 * 1.7 / rate), 0.0, 0.02 * 0.5 * 1.7 * 1.7 / rate);
  EXPECT_NEAR(std::abs(second - 0.5 * 0.6 * 0.6 / rate), 0.0, 0.02 * 0.5 * 0.6 * 0.6 / rate);
}

/// Many records: what their half spectra scatter by is what each of them states.
TEST(HalfSpectra, OfWhiteNoiseScatterAsTheySay) {
  constexpr double rate = 37.0;
  double found = 0.0, stated = 0.0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const auto half = half_spectra(
        spectra_of(white(4096, rate, {1.7, 0.6}, seed), {.block_length = 128}), {0, 1});
    for (std::size_t k = 0; k < half.lines(); ++k) {
      found += std::norm(half.H[k](0, 1));  // independent channels: 0
      stated += half.variance(k, 0, 1);
    }
  }
  EXPECT_NEAR(found / stated, 1.0, 0.2);
}

/// A harmonic on spectra that rise along a line leaves that line.
TEST(Harmonics, LeaveAStraightLineBehind) {
  const auto ramp = [](std::size_t k) {
    const double at = static_cast<double>(k);
    Eigen::MatrixXcd S(2, 2);
    S << 3.1 + 0.07 * at, std::complex(0.4, 0.013 * at), std::complex(0.4, -0.013 * at),
        5.3 - 0.02 * at;
    return S;
  };
  std::vector<Eigen::MatrixXcd> S;
  for (std::size_t k = 0; k < 100; ++k) S.push_back(ramp(k));
  for (const std::size_t k : {40U, 41U, 42U}) S[k] += 7.0 * Eigen::MatrixXcd::Identity(2, 2);
  constexpr double spacing = 0.13;
  leave_out_harmonics({{41.0 * spacing, Eigen::VectorXd::Ones(2)}}, spacing, S);
  for (std::size_t k = 0; k < S.size(); ++k)
    EXPECT_LT((S[k] - ramp(k)).norm(), 1e-12 * ramp(k).norm()) << k;
}

/// Lags of four seconds: what decays by less than e^−0.3 in that time is endless.
TEST(Harmonics, AreNotToldFromPolesThatHardlyDecay) {
  FrequencyResponses half;
  half.taper = Eigen::VectorXd::Ones(200);
  half.sample_rate = 50.0;
  half.whole = std::make_shared<data::OutputSpectra>();
  EXPECT_TRUE(is_endless(half, {-0.9 * 0.3 / 4.0, 31.0}));
  EXPECT_FALSE(is_endless(half, {-1.1 * 0.3 / 4.0, 31.0}));
}

/// A tone of amplitude a in white noise of both channels.
TEST(Harmonics, HaveTheAmplitudeOfTheirTone) {
  auto record = white(1 << 14, 64.0, {1.0, 1.0}, 19);
  for (Eigen::Index t = 0; t < record.samples.rows(); ++t) {
    const double angle = two_pi * 11.37 * static_cast<double>(t) / 64.0;
    record.samples(t, 0) += 1.3 * std::cos(angle + 0.4);
    record.samples(t, 1) += 0.8 * std::cos(angle - 1.9);
  }
  const auto found = find_harmonics(spectra_of(record, {.block_length = 512}), {0, 1});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].frequency, 11.37, 0.02);
  EXPECT_NEAR(found[0].amplitude[0], 1.3, 0.05);
  EXPECT_NEAR(found[0].amplitude[1], 0.8, 0.05);
}

/// Cubic splines with coefficients on a parabola: Σ B(x − k) = 1, Σ k B(x − k) = x and
/// Σ k² B(x − k) = x² + 1/3, x counted from the middle of the first.
TEST(ToneEnvelopes, OfCoefficientsOnAParabolaAreOne) {
  ToneEnvelope envelope{.spacing = 17.0, .coefficients = Eigen::VectorXcd(9)};
  const std::complex<double> a(0.7, -0.2), b(0.31, 0.45), c(-0.06, 0.11);
  for (Eigen::Index k = 0; k < 9; ++k) {
    const double at = static_cast<double>(k) - 1.0;
    envelope.coefficients[k] = a + b * at + c * at * at;
  }
  for (const double x : {0.0, 0.37, 1.0, 2.81, 5.5}) {
    const auto expected = a + b * x + c * (x * x + 1.0 / 3.0);
    EXPECT_LT(std::abs(envelope.at(17.0 * x) - expected), 1e-12) << x;
  }
}

/// A tone below the frequency of the zoom, in one of two channels that share noise far above it:
/// their difference shows it, steady.
TEST(ToneFit, FindsASteadyToneBelowNoiseThatChannelsShare) {
  constexpr double line = two_pi / 1024.0, offset = -0.61 * line;
  Zoom zoom{.omega = 0.73, .window = 64, .hop = 16, .first = 31};
  zoom.z.resize(400, 2);
  test::Random random(43);
  const auto noise = [&](double size) {
    return size * std::complex(test::normal(random), test::normal(random));
  };
  for (Eigen::Index row = 0; row < zoom.z.rows(); ++row) {
    const auto shared = noise(60.0);
    zoom.z(row, 0) = std::polar(1.0, offset * zoom.time(row)) + shared + noise(0.05);
    zoom.z(row, 1) = shared + noise(0.05);
  }
  const auto tracks = fit_tone({zoom}, line, 0.1 * line, {});
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_NEAR(tracks[0].omega, zoom.omega + offset, 1e-3 * line);
  EXPECT_EQ(tracks[0].envelope.spacing, 0.0);
  ASSERT_EQ(tracks[0].envelope.coefficients.size(), 1);
  EXPECT_NEAR(std::abs(tracks[0].envelope.coefficients[0]), 1.0, 1e-9);
}

/// H at the lines 0 … K of a sequence of 2K values has them as its lags.
TEST(ImpulseResponse, HasTheLagsOfItsSequence) {
  constexpr int K = 32;
  test::Random random(61);
  std::vector<double> h(2 * K);
  for (int t = 0; t < 2 * K; ++t) h[static_cast<std::size_t>(t)] = test::normal(random);
  FrequencyResponses r;
  for (int k = 0; k <= K; ++k) {
    std::complex<double> sum = 0.0;
    for (int t = 0; t < 2 * K; ++t)
      sum += h[static_cast<std::size_t>(t)] * std::polar(1.0, -two_pi * k * t / (2.0 * K));
    r.frequency.push_back(0.25 * k);
    r.H.emplace_back(Eigen::MatrixXcd::Constant(1, 1, sum));
  }
  const auto sequence = impulse_response(r);
  EXPECT_DOUBLE_EQ(sequence.interval, 1.0 / (2.0 * K * 0.25));
  ASSERT_EQ(sequence.values.size(), static_cast<std::size_t>(K - 1));
  for (std::size_t t = 0; t < sequence.values.size(); ++t)
    EXPECT_NEAR(sequence.values[t](0, 0), h[t + 1], 1e-12) << t;
}

/// One mode between 3 and 5 Hz, in noise of this deviation of every entry.
FrequencyResponses one_mode(const test::ModalSystem& system, int lines, double deviation,
                            test::Random& random) {
  FrequencyResponses r;
  const auto header = test::header_of(system.inputs(), system.outputs(), 1.0);
  r.inputs.assign(header.channels.begin(), header.channels.begin() + system.inputs());
  r.outputs.assign(header.channels.begin() + system.inputs(), header.channels.end());
  for (int k = 0; k < lines; ++k) {
    r.frequency.push_back(3.0 + 2.0 * k / (lines - 1.0));
    Eigen::MatrixXcd H = system.response(r.frequency.back());
    for (auto& value : H.reshaped())
      value +=
          std::sqrt(0.5) * deviation * std::complex(test::normal(random), test::normal(random));
    r.H.push_back(H);
    r.noise.push_back(deviation * deviation *
                      Eigen::MatrixXcd::Identity(system.outputs(), system.outputs()));
    r.input_factor.push_back(Eigen::MatrixXcd::Identity(system.inputs(), system.inputs()));
  }
  return r;
}

/// Over many fits: squares over their variances are as many as numbers less parameters, and shapes
/// scatter as is stated.
TEST(ModalFit, ErrorsAreWhatTheNoiseMakes) {
  Eigen::VectorXd shape(2);
  shape << 1.3, -0.7;
  auto system = test::ModalSystem{{test::real_mode(4.1, 0.031, shape)}};
  auto& mode = system.modes[0];
  mode.shape *= mode.participation[0];
  mode.participation = Eigen::VectorXcd::Ones(1);
  const double deviation = 0.01 * system.response(4.1).norm();
  test::Random random(1009);
  double misfit = 0.0, scatter = 0.0, stated = 0.0;
  constexpr int fits = 150;
  for (int fit = 0; fit < fits; ++fit) {
    const auto r = one_mode(system, 14, deviation, random);
    const auto model = fit_modes(r, {{.pole = mode.pole * std::polar(1.01, 0.004),
                                      .shape = mode.shape,
                                      .participation = mode.participation}});
    misfit += model.misfit / fits;
    scatter += (model.modes[0].shape - mode.shape).squaredNorm();
    stated += model.modes[0].shape_deviation.squaredNorm();
  }
  EXPECT_NEAR(misfit, 1.0, 0.1);
  EXPECT_NEAR(scatter / stated, 1.0, 0.25);
}

/// The estimate that it starts with has another input in front than the data.
TEST(ModalFit, ShapeAndParticipationGoTogetherWhateverInputLeads) {
  test::ModalSystem system;
  system.modes.resize(1);
  auto& mode = system.modes[0];
  mode.pole = {-0.9, 25.7};
  mode.shape.resize(2);
  mode.shape << std::complex(0.3, -1.1), std::complex(0.8, 0.2);
  mode.participation.resize(2);
  mode.participation << std::complex(0.2, 0.3), std::complex(-1.4, 0.9);
  test::Random random(5);
  auto r = one_mode(system, 40, 0.0, random);
  r.noise = {};
  r.input_factor = {};
  Eigen::VectorXcd wrong(2);
  wrong << 1.0, 0.4;
  const auto model =
      fit_modes(r, {{.pole = {-0.8, 25.5}, .shape = mode.shape, .participation = wrong}});
  const auto& found = model.modes.front();
  EXPECT_LT(std::abs(found.participation[1] - 1.0), 1e-12);
  const Eigen::MatrixXcd residue = mode.shape * mode.participation.transpose();
  EXPECT_LT((found.shape * found.participation.transpose() - residue).norm(),
            1e-4 * residue.norm());
}

/// What the synthesis is off by, as share of what was measured.
TEST(ModalFit, ErrorIsTheShareThatTheSynthesisLeaves) {
  const auto system =
      test::ModalSystem{{test::real_mode(4.1, 0.031, Eigen::VectorXd::Constant(1, 1.7))}};
  test::Random random(71);
  const auto r = one_mode(system, 60, 0.05 * system.response(4.1).norm(), random);
  const auto model = fit_modes(r, {{.pole = system.modes[0].pole,
                                    .shape = system.modes[0].shape,
                                    .participation = system.modes[0].participation}});
  double off = 0.0, whole = 0.0;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    off += (r.H[k] - synthesised(model, r.frequency[k])).squaredNorm();
    whole += r.H[k].squaredNorm();
  }
  EXPECT_GT(off, 1e-4 * whole);
  EXPECT_NEAR(model.error, std::sqrt(off / whole), 1e-6 * model.error);
}

/// Of an acceleration identified as such and shown as displacement, a share of the shape stays that
/// share; lines at 1.0, 1.7 and 2.4 Hz are 0.7 Hz apart.
TEST(ModalResults, HaveDeviationsOfDisplacementsAndTheSpacingOfLines) {
  Identification found;
  found.responses.outputs = {{.name = "a", .unit = "m/s^2"}, {.name = "b", .unit = "m/s^2"}};
  found.responses.frequency = {1.0, 1.7, 2.4};
  IdentifiedMode mode;
  mode.fit.pole = {-0.7, 31.0};
  mode.fit.shape.resize(2);
  mode.fit.shape << std::complex(3.0, 4.0), std::complex(-0.9, 0.0);
  mode.fit.shape_deviation = Eigen::Vector2d(0.5, 0.018);
  mode.displacement = mode.fit.shape / (mode.fit.pole * mode.fit.pole);
  found.modes = {mode};
  const auto results = modal_results(found);
  EXPECT_NEAR(results.line_spacing, 0.7, 1e-12);
  const auto& shown = results.modes.at(0);
  EXPECT_NEAR(shown.shape_deviation[0] / std::abs(shown.shape[0]), 0.1, 1e-12);
  EXPECT_NEAR(shown.shape_deviation[1] / std::abs(shown.shape[1]), 0.02, 1e-12);
}

}  // namespace
}  // namespace hydrapod::identification
