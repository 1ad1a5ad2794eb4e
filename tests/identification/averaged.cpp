#include "averaged.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>

#include "found_pole.hpp"
#include "hydrapod/numerics/fft.hpp"

namespace hydrapod::identification {

test::ModalSystem frame(Eigen::Index inputs) {
  using Eigen::Vector4d;
  return pushed_at_first({test::real_mode(4.37, 0.0123, Vector4d(1.03, 0.71, 0.33, 0.94)),
                          test::real_mode(7.91, 0.0091, Vector4d(0.83, -1.12, 0.52, -0.41)),
                          test::real_mode(8.63, 0.0207, Vector4d(-0.61, 0.94, 1.13, 0.32)),
                          test::real_mode(15.31, 0.0149, Vector4d(0.53, 1.21, -0.74, 0.81)),
                          test::real_mode(23.17, 0.0113, Vector4d(0.92, -0.33, 0.41, -1.04))},
                         inputs);
}

namespace {

Eigen::VectorXd samples_of_window(const Averaged& how) {
  Eigen::VectorXd w = Eigen::VectorXd::Ones(how.block);
  if (how.window == "hann")
    for (int t = 0; t < how.block; ++t)
      w[t] = std::pow(std::sin(std::numbers::pi * t / how.block), 2);
  if (how.window == "blackman")
    for (int t = 0; t < how.block; ++t) {
      const double x = 2.0 * std::numbers::pi * t / how.block;
      w[t] = 0.42 - 0.5 * std::cos(x) + 0.08 * std::cos(2.0 * x);
    }
  if (how.window == "tukey")  // a quarter of the block at either end
    for (int t = 0; 4 * t < how.block; ++t) {
      w[t] = std::pow(std::sin(2.0 * std::numbers::pi * t / how.block), 2);
      if (t > 0) w[how.block - t] = w[t];
    }
  if (how.window == "flat-top")
    for (int t = 0; t < how.block; ++t) {
      // D'Antona and Ferrero (2006)
      constexpr std::array a{0.21557895, -0.41663158, 0.277263158, -0.083578947, 0.006947368};
      w[t] = 0.0;
      for (std::size_t j = 0; j < a.size(); ++j)
        w[t] += a[j] * std::cos(2.0 * std::numbers::pi * static_cast<double>(j) * t / how.block);
    }
  return w;
}

Eigen::MatrixXd noisy_record(const Averaged& how, std::uint64_t seed) {
  const auto system = frame(how.inputs);
  test::Random random(seed);
  test::ModalRun run(system, 1.0 / averaged_rate);
  const auto rows = static_cast<Eigen::Index>(how.block * how.blocks);
  Eigen::MatrixXd samples(rows, how.inputs + system.outputs());
  Eigen::VectorXd u = Eigen::VectorXd::Zero(how.inputs);
  for (Eigen::Index k = -3 * how.block; k < rows; ++k) {
    for (double& one : u) one = how.colour * one + test::normal(random);
    if (k >= 0) samples.row(k) << u.transpose(), run.output().transpose();
    run.advance(u);
  }
  for (auto y : samples.rightCols(system.outputs()).colwise()) {
    const double deviation = how.noise * std::sqrt(y.squaredNorm() / static_cast<double>(rows));
    for (double& one : y) one += deviation * test::normal(random);
  }
  return samples;
}

}  // namespace

FrequencyResponses averaged_responses(const Averaged& how, std::uint64_t seed) {
  const Eigen::MatrixXd samples = noisy_record(how, seed);
  const Eigen::Index p = how.inputs, q = samples.cols() - p;
  const Eigen::VectorXd window = samples_of_window(how);
  numerics::RealFft fft(how.block);
  std::vector<Eigen::MatrixXcd> S(static_cast<std::size_t>(fft.lines()),
                                  Eigen::MatrixXcd::Zero(p + q, p + q));
  Eigen::MatrixXcd Z(fft.lines(), p + q);
  std::vector<std::complex<double>> lines(S.size());
  const Eigen::Index hop = how.window == "box" ? how.block : how.block / 2;
  for (Eigen::Index from = 0; from + how.block <= samples.rows(); from += hop) {
    for (Eigen::Index c = 0; c < p + q; ++c) {
      const Eigen::VectorXd block = samples.col(c).segment(from, how.block);
      const Eigen::VectorXd windowed = (block.array() - block.mean()) * window.array();
      fft.forward({windowed.data(), static_cast<std::size_t>(how.block)}, lines);
      Z.col(c) = Eigen::VectorXcd::Map(lines.data(), fft.lines());
    }
    for (std::size_t k = 0; k < S.size(); ++k) {
      const Eigen::VectorXcd z = Z.row(static_cast<Eigen::Index>(k)).transpose();
      S[k] += z * z.adjoint();
    }
  }
  FrequencyResponses r;
  const auto header = test::header_of(p, q, averaged_rate);
  r.inputs.assign(header.channels.begin(), header.channels.begin() + p);
  r.outputs.assign(header.channels.begin() + p, header.channels.end());
  for (std::size_t k = 0; k < S.size(); ++k) {
    const double f = static_cast<double>(k) * averaged_rate / how.block;
    if (f < 1.1 || f > 40.0) continue;
    r.frequency.push_back(f);
    r.H.push_back(S[k].bottomLeftCorner(q, p) * S[k].topLeftCorner(p, p).inverse());
  }
  return r;
}

test::ClassScore averaged_score(const Averaged& how, int seeds, const IdentifyOptions& options,
                                double least_quality) {
  test::ClassScore score;
  for (int seed = 1; seed <= seeds; ++seed) {
    auto found = identify_modes(averaged_responses(how, static_cast<std::uint64_t>(seed)), options);
    std::erase_if(found.modes, [&](const auto& mode) { return mode.quality() < least_quality; });
    score.add(test::true_modes(frame(how.inputs)), test::found_modes(found));
  }
  return score;
}

}  // namespace hydrapod::identification
