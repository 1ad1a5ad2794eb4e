/// Frequency responses of systems known exactly, in open and in closed loop, and bad channels.

#include "hydrapod/identification/responses.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "exact/closed_loop.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "spectra_of.hpp"

namespace hydrapod::identification {
namespace {

using Eigen::Index;
using testing::HasSubstr;
using Kind = data::ResponseWarning::Kind;

constexpr double sample_rate = 50.0;

/// Three inputs, three outputs, well damped, so that blocks are long against its memory.
test::ModalSystem plant() {
  test::ModalSystem system;
  test::Random random(17);
  for (const auto& [f, zeta] : {std::pair{3.1, 0.11}, {6.7, 0.08}, {11.3, 0.06}}) {
    Eigen::VectorXd shape(3);
    for (double& x : shape) x = 8.0 * test::normal(random);
    system.modes.push_back(test::real_mode(f, zeta, shape));
  }
  return system;
}

data::Record closed_loop_record(const test::ModalSystem& system, double gain, double noise,
                                int samples, std::uint64_t seed) {
  return test::closed_loop_record(
      system,
      {.gain = gain, .noise = noise, .samples = samples, .sample_rate = sample_rate, .seed = seed});
}

const ChannelChoice from_excitation{.inputs = {0, 1, 2}, .outputs = {3, 4, 5}, .instruments = {}};
const ChannelChoice from_drive{.inputs = {6, 7, 8}, .outputs = {3, 4, 5}, .instruments = {0, 1, 2}};

/// The first warning of this kind, if there is one.
const data::ResponseWarning* warning_of(const FrequencyResponses& responses, Kind kind) {
  const auto found = std::ranges::find(responses.warnings, kind, &data::ResponseWarning::kind);
  return found == responses.warnings.end() ? nullptr : &*found;
}

/// Share of entries × lines of an estimate within their 95 % radius of the truth.
double coverage(const FrequencyResponses& r, const test::ModalSystem& system) {
  const double radius = confidence_radius(0.95, r.degrees);
  double inside = 0.0, all = 0.0;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const auto truth = system.sampled_response(r.frequency[k], 1.0 / sample_rate);
    for (int o = 0; o < 3; ++o)
      for (int i = 0; i < 3; ++i, all += 1.0)
        if (std::abs(r.H[k](o, i) - truth(o, i)) <= radius * std::sqrt(r.variance(k, o, i)))
          inside += 1.0;
  }
  return inside / all;
}

TEST(Responses, AreWhatTheirDefinitionsSay) {
  const auto record = closed_loop_record(plant(), 0.3, 0.3, 9000, 23);
  const auto s = spectra_of(record, {.block_length = 512});
  for (const auto estimator : {Estimator::h1, Estimator::h2, Estimator::instrumental}) {
    const auto r = estimate_responses(s, from_drive, estimator);
    ASSERT_GT(r.lines(), 80u);  // the excitation is smooth: the instruments have no more
    for (std::size_t k = 0; k < r.lines(); ++k) {
      const auto S = s.at(std::lround(r.frequency[k] * 512 / sample_rate));
      const auto part = [&](const auto& rows, const auto& columns) {
        return Eigen::MatrixXcd(S(rows, columns));
      };
      const auto &u = from_drive.inputs, &y = from_drive.outputs;
      const auto& w = estimator == Estimator::instrumental ? from_drive.instruments : u;
      const Eigen::MatrixXcd G = part(u, w).inverse();
      const Eigen::MatrixXcd H = estimator == Estimator::h2
                                     ? Eigen::MatrixXcd(part(y, y) * part(u, y).inverse())
                                     : Eigen::MatrixXcd(part(y, w) * G);
      EXPECT_LT((r.H[k] - H).norm(), 1e-11 * H.norm());
      const Eigen::MatrixXcd Q = G.adjoint() * part(w, w) * G;
      EXPECT_LT((r.input_factor[k] - Q).norm(), 1e-11 * Q.norm());
      Eigen::MatrixXcd left(3, 6);
      left << Eigen::MatrixXcd::Identity(3, 3), -H;
      auto both = y;
      both.insert(both.end(), u.begin(), u.end());
      const Eigen::MatrixXcd V = left * part(both, both) * left.adjoint() / r.degrees;
      EXPECT_LT((r.noise[k] - V).norm(), 1e-10 * V.norm());
      const auto levels = [&](const auto& list) {
        return Eigen::VectorXd(S.diagonal().real()(list).cwiseSqrt().cwiseInverse());
      };
      const Eigen::MatrixXcd A = levels(u).asDiagonal() * part(u, w) * levels(w).asDiagonal();
      const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXcd>(A).singularValues();
      EXPECT_NEAR(r.condition[k], singular[0] / singular[2], 1e-11 * r.condition[k]);
    }
  }
}

TEST(Responses, OpenLoopH1IsWithinItsBandAsOftenAsPromised) {
  const auto system = plant();
  auto record = closed_loop_record(system, 0.0, 0.2, 1 << 16, 3);
  const auto s = spectra_of(record, {.block_length = 1024});
  const auto r = estimate_responses(s, from_excitation, Estimator::h1);
  EXPECT_THAT(r.warnings, testing::IsEmpty());
  EXPECT_NEAR(coverage(r, system), 0.95, 0.03);
}

TEST(Responses, InClosedLoopH1IsBiasedAndTheInstrumentalEstimateIsNot) {
  const auto system = plant();
  auto record = closed_loop_record(system, 0.3, 0.8, 1 << 17, 5);
  const auto s = spectra_of(record, {.block_length = 1024});
  const auto plain = estimate_responses(s, from_drive, Estimator::h1);
  const auto instrumental = estimate_responses(s, from_drive, Estimator::instrumental);
  EXPECT_NEAR(coverage(instrumental, system), 0.95, 0.03);
  EXPECT_LT(coverage(plain, system), 0.75);
  const auto finding = compare_responses(plain, instrumental);
  EXPECT_GT(finding.share, 0.2);
  EXPECT_GT(finding.median, 0.02);
}

/// Responses that are moved by just less, or just more, than the radius of 95 %.
TEST(Responses, BiasIsCountedWhereItIsBeyondTheInterval) {
  const auto s =
      spectra_of(closed_loop_record(plant(), 0.3, 0.8, 1 << 15, 9), {.block_length = 512});
  const auto exact = estimate_responses(s, from_drive, Estimator::instrumental);
  for (const double factor : {0.98, 1.02}) {
    auto moved = exact;
    for (std::size_t k = 0; k < exact.lines(); ++k)
      for (Index o = 0; o < exact.H[k].rows(); ++o)
        for (Index i = 0; i < exact.H[k].cols(); ++i)
          moved.H[k](o, i) += std::polar(
              factor * confidence_radius(0.95, exact.degrees) * std::sqrt(exact.variance(k, o, i)),
              0.4 * static_cast<double>(k));
    EXPECT_EQ(compare_responses(moved, exact).share, factor > 1.0 ? 1.0 : 0.0);
  }
}

TEST(Responses, WithoutNoiseInTheLoopNoBiasIsClaimed) {
  auto record = closed_loop_record(plant(), 0.3, 1e-4, 1 << 15, 6);
  const auto s = spectra_of(record, {.block_length = 1024});
  const auto finding =
      compare_responses(estimate_responses(s, from_drive, Estimator::h1),
                        estimate_responses(s, from_drive, Estimator::instrumental));
  EXPECT_LT(finding.median, 0.01);
}

TEST(Responses, H2AndHvBoundTheNoiseOnTheInputs) {
  // noise on the measured inputs: H1 is too small, H2 right
  const auto system = plant();
  auto record = closed_loop_record(system, 0.0, 0.0, 1 << 16, 8);
  test::Random random(4);
  for (Index k = 0; k < record.samples.rows(); ++k)
    for (int i = 0; i < 3; ++i) record.samples(k, i) += 0.5 * test::normal(random);
  const auto s = spectra_of(record, {.block_length = 1024});
  double h1 = 0.0, h2 = 0.0, hv = 0.0, truth = 0.0;
  const auto r1 = estimate_responses(s, from_excitation, Estimator::h1);
  const auto r2 = estimate_responses(s, from_excitation, Estimator::h2);
  const auto rv = estimate_responses(s, from_excitation, Estimator::hv);
  for (std::size_t k = 0; k < r1.lines(); ++k) {
    const auto H = system.sampled_response(r1.frequency[k], 1.0 / sample_rate);
    // projection of the estimate on the truth: its mean gain
    const auto gain = [&](const FrequencyResponses& r) {
      return (H.conjugate().cwiseProduct(r.H[k])).sum().real();
    };
    h1 += gain(r1);
    h2 += gain(r2);
    hv += gain(rv);
    truth += H.squaredNorm();
  }
  EXPECT_NEAR(h1 / truth, 1.0 / 1.25, 0.02);  // S_uu holds the noise's variance 0.25
  EXPECT_NEAR(h2 / truth, 1.0, 0.03);
  EXPECT_GT(hv, h1);
  EXPECT_LT(hv, 1.02 * h2);
}

constexpr int period = 500, first_line = 5, last_line = 150;

/// Random-phase multisines with signs by a Hadamard-like matrix: over three records of six periods
/// the inputs are independent. They begin so many samples before the records. `fade`: what the
/// inputs are multiplied by, t counting from the beginning of a record.
template <class Fade>
CrossSpectra multisine_spectra(const test::ModalSystem& system, int before, const Fade& fade,
                               double noise_of_last_input = 0.0) {
  SpectrumEstimator estimator(test::header_of(3, 3, sample_rate),
                              {.block_length = period, .periodic = true});
  test::Random random(31);
  std::vector<double> base(period, 0.0);
  for (int k = first_line; k <= last_line; ++k) {
    const double phase = random.uniform(0.0, 6.28);
    for (int t = 0; t < period; ++t)
      base[static_cast<size_t>(t)] += std::cos(2.0 * M_PI * k * t / period + phase);
  }
  Eigen::Matrix3d mix;
  mix << 1, 1, 1, 1, -1, 0.5, 1, 0.3, -1;
  for (int experiment = 0; experiment < 3; ++experiment) {
    test::ModalRun run(system, 1.0 / sample_rate);
    data::Samples samples(6 * period, 6);
    for (int t = -before; t < samples.rows(); ++t) {
      Eigen::VectorXd u =
          mix.col(experiment) * fade(t) * base[static_cast<size_t>((t % period + period) % period)];
      if (noise_of_last_input > 0.0) u[2] = noise_of_last_input * test::normal(random);
      if (t >= 0) samples.row(t) << u.transpose(), run.output().transpose();
      run.advance(u);
    }
    estimator.begin_record();
    estimator.add(samples);
  }
  return estimator.result();
}

constexpr auto steady = [](int) { return 1.0; };

TEST(Responses, PeriodicExcitationOverThreeRecordsIsExactWithoutNoise) {
  const auto system = plant();
  const auto r = estimate_responses(multisine_spectra(system, 10 * period, steady), from_excitation,
                                    Estimator::h1);
  EXPECT_EQ(r.lines(), 146u);  // the excited lines, no other
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const auto truth = system.sampled_response(r.frequency[k], 1.0 / sample_rate);
    EXPECT_LT((r.H[k] - truth).norm(), 1e-9 * truth.norm()) << r.frequency[k];
  }
}

TEST(Responses, AFadeInBeforePeriodicExcitationExcitesNoLine) {
  // in the first period the input is at all lines, by far more than rounding
  const auto fade = [](int t) { return std::clamp(t / 50.0, 0.0, 1.0); };
  const auto s = multisine_spectra(plant(), 0, fade);
  EXPECT_GT(s.at(last_line + 30)(0, 0).real(), 1e-8 * s.at(last_line)(0, 0).real());
  const auto r = estimate_responses(s, from_excitation, Estimator::h1);
  ASSERT_EQ(r.lines(), 146u);
  EXPECT_NEAR(r.frequency.front(), s.frequency(first_line), 1e-9);
  EXPECT_NEAR(r.frequency.back(), s.frequency(last_line), 1e-9);
}

TEST(Responses, AnInputThatStandsStillLeavesThePeriodicOnesTheirLines) {
  const auto s = multisine_spectra(plant(), 10 * period, steady, 1e-4);
  EXPECT_EQ(estimate_responses(s, from_excitation, Estimator::h1).lines(), 146u);
}

TEST(Responses, ADeadOutputIsLeftOutAndADeadInputHasNoResponses) {
  auto record = closed_loop_record(plant(), 0.0, 0.1, 1 << 14, 3);
  record.samples.col(4).setConstant(0.7);
  record.samples.col(1).setZero();
  const auto r =
      estimate_responses(spectra_of(record, {.block_length = 512}), from_excitation, Estimator::h1);
  ASSERT_EQ(r.outputs.size(), 2u);
  EXPECT_EQ(r.outputs[1].name, "y3");
  ASSERT_EQ(r.inputs.size(), 2u);
  EXPECT_EQ(r.inputs[1].name, "u3");
  const auto* output = warning_of(r, Kind::dead_output);
  ASSERT_NE(output, nullptr);
  EXPECT_EQ(output->channel, "y2");
  EXPECT_EQ(output->value, 0.7);
  const auto* input = warning_of(r, Kind::dead_input);
  ASSERT_NE(input, nullptr);
  EXPECT_EQ(input->channel, "u2");
}

TEST(Responses, AClippedChannelIsSaid) {
  auto record = closed_loop_record(plant(), 0.0, 0.1, 1 << 14, 3);
  const double limit = 0.6 * record.samples.col(5).maxCoeff();
  record.samples.col(5) = record.samples.col(5).cwiseMin(limit).cwiseMax(-limit).eval();
  const auto r =
      estimate_responses(spectra_of(record, {.block_length = 512}), from_excitation, Estimator::h1);
  const auto* warning = warning_of(r, Kind::clipped);
  ASSERT_NE(warning, nullptr);
  EXPECT_EQ(warning->channel, "y3");
  EXPECT_EQ(warning->highest, limit);
  EXPECT_EQ(warning->lowest, -limit);
}

TEST(Responses, AnInputRepeatedTwiceCountsOnce) {
  const auto system = plant();
  auto record = closed_loop_record(system, 0.0, 0.1, 1 << 15, 3);
  record.samples.col(1) = -2.5 * record.samples.col(0);  // reversed and in another unit
  const auto r =
      estimate_responses(spectra_of(record, {.block_length = 512}), from_excitation, Estimator::h1);
  ASSERT_EQ(r.inputs.size(), 2u);
  const auto* warning = warning_of(r, Kind::repeated_input);
  ASSERT_NE(warning, nullptr);
  EXPECT_EQ(warning->channel, "u2");
  EXPECT_EQ(warning->other, "u1");
}

TEST(Responses, InputsThatAreAMixtureAreRefused) {
  auto record = closed_loop_record(plant(), 0.0, 0.1, 1 << 14, 3);
  record.samples.col(2) = record.samples.col(0) + record.samples.col(1);
  const auto s = spectra_of(record, {.block_length = 512});
  try {
    estimate_responses(s, from_excitation, Estimator::h1);
    FAIL() << "three inputs, two of them independent, were accepted";
  } catch (const base::ComputationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("linearly dependent"));
  }
}

TEST(Responses, CorrelatedInputsAreSaid) {
  auto record = closed_loop_record(plant(), 0.0, 0.1, 1 << 15, 3);
  record.samples.col(2) = record.samples.col(0) + 0.1 * record.samples.col(2);
  const auto r =
      estimate_responses(spectra_of(record, {.block_length = 512}), from_excitation, Estimator::h1);
  EXPECT_NE(warning_of(r, Kind::correlated_inputs), nullptr);
}

/// Two sweeps up to 9 Hz, in phase and then in opposition: above, there is nothing but rounding.
TEST(Responses, InputsAreJudgedWhereTheyExcite) {
  constexpr Index half = 8192;
  test::Random random(83);
  data::Record record{.header = test::header_of(2, 1, sample_rate), .samples = {}};
  record.samples.resize(2 * half, 3);
  for (Index k = 0; k < 2 * half; ++k) {
    const double t = static_cast<double>(k % half) / sample_rate, T = half / sample_rate;
    const double s = std::sin(2.0 * std::numbers::pi * t * (1.0 + 4.0 * t / T));
    const double u1 = 1.7 * s, u2 = k < half ? 0.9 * s : -0.9 * s;
    record.samples.row(k) << u1, u2, u1 - 0.3 * u2 + 0.01 * test::normal(random);
  }
  const ChannelChoice choice{.inputs = {0, 1}, .outputs = {2}, .instruments = {}};
  const auto r = estimate_responses(spectra_of(record, {.block_length = 512, .overlap = 0.75}),
                                    choice, Estimator::h1);
  EXPECT_GT(numerics::upper_median(r.condition), 1e3);
  EXPECT_EQ(warning_of(r, Kind::correlated_inputs), nullptr);
}

TEST(Responses, TooFewAveragesAreRefused) {
  auto record = closed_loop_record(plant(), 0.0, 0.1, 1200, 3);
  const auto s = spectra_of(record, {.block_length = 512});
  EXPECT_THROW(estimate_responses(s, from_excitation, Estimator::h1), base::ComputationError);
  // one period each says nothing of the noise; one record nothing of three inputs
  const auto periodic = spectra_of(record, {.block_length = 400, .periodic = true});
  EXPECT_THROW(estimate_responses(periodic, from_excitation, Estimator::h1),
               base::ComputationError);
}

TEST(Responses, RadiusOfKnownVarianceIsThatOfAComplexNormalNumber) {
  EXPECT_NEAR(confidence_radius(0.95, 0.0), std::sqrt(-std::log(0.05)), 1e-14);
  EXPECT_NEAR(confidence_radius(0.95, 1e9), std::sqrt(-std::log(0.05)), 1e-6);
  // F(2, 20) at 95 %: 3.4928 (tables)
  EXPECT_NEAR(std::pow(confidence_radius(0.95, 10.0), 2), 3.4928, 1e-4);
}

}  // namespace
}  // namespace hydrapod::identification
