/// Cross spectra of a record and poles of its responses, with what the time goes into. The
/// yardstick of the spectra is SciPy: bench/spectra_scipy.py.

#include <benchmark/benchmark.h>

#include <cmath>
#include <complex>
#include <random>

#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/identification/responses.hpp"
#include "hydrapod/numerics/fft.hpp"

namespace {

using namespace hydrapod;
using Complex = std::complex<double>;
constexpr int channels = 12, block_length = 8192;
constexpr Eigen::Index sample_count = 1 << 19;

/// Twelve channels of noise, six of which are called excitations.
const data::Record& record() {
  static const data::Record record = [] {
    data::Record r;
    r.header.sample_rate = 1000.0;
    for (int c = 0; c < channels; ++c)
      r.header.channels.push_back({.name = "c" + std::to_string(c)});
    r.samples.resize(sample_count, channels);
    std::mt19937_64 generator(5);
    std::normal_distribution<double> normal;
    for (Eigen::Index k = 0; k < r.samples.size(); ++k) r.samples.data()[k] = normal(generator);
    return r;
  }();
  return record;
}

identification::CrossSpectra spectra(int threads = 1) {
  identification::SpectrumEstimator estimator(record().header,
                                              {.block_length = block_length, .threads = threads});
  estimator.add(record().samples);
  return estimator.result();
}

const identification::ChannelChoice six_by_six{
    .inputs = {0, 1, 2, 3, 4, 5}, .outputs = {6, 7, 8, 9, 10, 11}, .instruments = {}};

void responses_of_record(benchmark::State& state) {
  record();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        identification::estimate_responses(spectra(), six_by_six, identification::Estimator::h1));
}
BENCHMARK(responses_of_record)->Unit(benchmark::kMillisecond);

void responses_on_all_cores(benchmark::State& state) {
  record();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        identification::estimate_responses(spectra(0), six_by_six, identification::Estimator::h1));
}
BENCHMARK(responses_on_all_cores)->Unit(benchmark::kMillisecond)->UseRealTime();

void spectra_of_record(benchmark::State& state) {
  record();
  for (auto _ : state) benchmark::DoNotOptimize(spectra());
}
BENCHMARK(spectra_of_record)->Unit(benchmark::kMillisecond);

/// The transforms alone: 127 blocks of 12 channels.
void transforms_of_record(benchmark::State& state) {
  numerics::RealFft fft(block_length);
  const numerics::RealFft::Block block = record().samples.topRows(block_length);
  const Eigen::RowVectorXd mean = block.colwise().mean();
  const Eigen::VectorXd window =
      identification::window_samples(identification::Window::hann, block_length);
  std::vector<numerics::EightLines> lines(static_cast<std::size_t>(fft.line_groups() * channels));
  for (auto _ : state)
    for (int b = 0; b < 127; ++b) {
      fft.forward(block, mean, window, lines.data(), channels);
      benchmark::DoNotOptimize(lines.data());
    }
}
BENCHMARK(transforms_of_record)->Unit(benchmark::kMillisecond);

/// The same by KISS FFT, one channel after the other.
void transforms_kiss_fft(benchmark::State& state) {
  numerics::RealFft fft(block_length);
  const Eigen::VectorXd samples = record().samples.col(0).head(block_length);
  std::vector<Complex> lines(static_cast<std::size_t>(fft.lines()));
  for (auto _ : state)
    for (int b = 0; b < 127 * channels; ++b) {
      fft.forward({samples.data(), static_cast<std::size_t>(block_length)}, lines);
      benchmark::DoNotOptimize(lines.data());
    }
}
BENCHMARK(transforms_kiss_fft)->Unit(benchmark::kMillisecond);

/// 36 responses at 2000 frequencies, nine modes, 1 % of noise.
const identification::FrequencyResponses& responses() {
  static const identification::FrequencyResponses responses = [] {
    identification::FrequencyResponses r;
    r.inputs.resize(6);
    r.outputs.resize(6);
    std::mt19937_64 generator(3);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd shapes(6, 9);
    for (double& x : shapes.reshaped()) x = normal(generator);
    for (int k = 0; k < 2000; ++k) {
      const double f = 1.0 + 49.0 * k / 1999.0;
      const Complex s(0.0, base::two_pi * f);
      Eigen::MatrixXcd H = Eigen::MatrixXcd::Zero(6, 6);
      for (int m = 0; m < 9; ++m) {
        const double w = base::two_pi * (3.0 + 5.1 * m), zeta = 0.01 + 0.003 * m;
        H += shapes.col(m) * shapes.col(m).transpose() / (s * s + 2.0 * zeta * w * s + w * w);
      }
      for (Complex& h : H.reshaped()) h += 1e-5 * Complex(normal(generator), normal(generator));
      r.frequency.push_back(f);
      r.H.push_back(H);
    }
    return r;
  }();
  return responses;
}

void poles_of_orders_2_to_40(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(identification::poly_reference_poles(responses(), {2, 40, 2}));
}
BENCHMARK(poles_of_orders_2_to_40)->Unit(benchmark::kMillisecond);

/// Order 40 alone: the sums over lines, the normal equations and the largest eigenproblem.
void poles_of_order_40(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(identification::poly_reference_poles(responses(), {40, 40, 1}));
}
BENCHMARK(poles_of_order_40)->Unit(benchmark::kMillisecond);

/// Clusters over all orders.
void selection_of_poles(benchmark::State& state) {
  const auto chart = identification::poly_reference_poles(responses(), {2, 40, 2});
  for (auto _ : state) benchmark::DoNotOptimize(identification::select_poles(chart));
}
BENCHMARK(selection_of_poles)->Unit(benchmark::kMillisecond);

}  // namespace
