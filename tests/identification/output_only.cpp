#include "output_only.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace hydrapod::test {

Eigen::MatrixXd chain_matrix(const Eigen::VectorXd& links) {
  const Eigen::Index n = links.size() - 1;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    K(k, k) = links[k] + links[k + 1];
    if (k > 0) K(k, k - 1) = K(k - 1, k) = -links[k];
  }
  return K;
}

ModalSystem modes_of(const Chain& chain) {
  const Eigen::Index n = chain.masses.size();
  const Eigen::MatrixXd K = chain_matrix(chain.springs), C = chain_matrix(chain.dampers);
  const Eigen::MatrixXd M = chain.masses.asDiagonal();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -(chain.masses.cwiseInverse().asDiagonal() * K);
  A.bottomRightCorner(n, n) = -(chain.masses.cwiseInverse().asDiagonal() * C);
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  ModalSystem system;
  for (Eigen::Index r = 0; r < 2 * n; ++r) {
    const std::complex<double> pole = solver.eigenvalues()[r];
    if (pole.imag() <= 0.0) continue;
    const Eigen::VectorXcd shape = solver.eigenvectors().col(r).head(n);
    const std::complex<double> scale =
        (shape.transpose() * (2.0 * pole * M + C.cast<std::complex<double>>()) * shape)(0, 0);
    system.modes.push_back({pole, shape, shape / scale});
  }
  std::ranges::sort(system.modes, {}, [](const ExactMode& m) { return std::abs(m.pole); });
  return system;
}

data::Record outputs_of(const ModalSystem& system, const OutputExperiment& e) {
  Random random(e.seed);
  const Eigen::Index p = system.inputs(), q = system.outputs();
  data::Record record{.header = header_of(0, q, e.sample_rate), .samples = {}};
  record.samples.resize(e.samples, q);
  ModalRun run(system, 1.0 / e.sample_rate);
  const double keep =
      e.colour > 0.0 ? std::exp(-2.0 * std::numbers::pi * e.colour / e.sample_rate) : 0.0;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(p);
  constexpr int settling = 20000;
  for (int k = -settling; k < e.samples; ++k) {
    for (double& x : u) x = keep * x + (1.0 - keep) * normal(random);
    if (k >= 0) record.samples.row(k) = run.output().transpose();
    run.advance(u);
  }
  const Eigen::VectorXd rms =
      (record.samples.colwise().squaredNorm() / static_cast<double>(e.samples)).cwiseSqrt();
  for (int k = 0; k < e.samples; ++k)
    for (Eigen::Index o = 0; o < q; ++o) {
      double more = e.noise * normal(random);
      for (const auto& tone : e.tones)
        more += tone.amplitude[o] *
                std::sin(2.0 * std::numbers::pi * tone.frequency * k / e.sample_rate + 0.4);
      record.samples(k, o) += rms[o] * more;
    }
  return record;
}

identification::CrossSpectra output_spectra(const data::Record& record, int block) {
  identification::SpectrumEstimator estimator(record.header, {.block_length = block});
  estimator.add(record.samples);
  return estimator.result();
}

std::vector<int> all_channels(const data::Record& record) {
  std::vector<int> all(record.header.channels.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<int>(k);
  return all;
}

identification::Identification identified_outputs(const data::Record& record, int block) {
  return identification::identify_modes(
      identification::half_spectra(output_spectra(record, block), all_channels(record)));
}

std::vector<FoundMode> textbook_output_modes(const data::Record& record) {
  const auto& y = record.samples;
  const Eigen::Index rows = y.rows();
  identification::MarkovSequence sequence{.values = {},
                                          .interval = 1.0 / record.header.sample_rate};
  const Eigen::MatrixXd centred = y.rowwise() - y.colwise().mean();
  constexpr Eigen::Index lags = 119;
  for (Eigen::Index k = 1; k <= lags; ++k)
    sequence.values.emplace_back(centred.bottomRows(rows - k).transpose() *
                                 centred.topRows(rows - k) / static_cast<double>(rows - k));
  const auto chart = identification::realised_poles(sequence, {4, 40, 2});
  struct Chainlet {
    identification::PoleEstimate last;
    int length;
  };
  std::vector<Chainlet> open;
  std::vector<FoundMode> found;
  for (const auto& order : chart) {
    std::vector<Chainlet> next;
    for (const auto& pole : order.poles) {
      if (pole.damping_ratio() <= 0.0 || pole.damping_ratio() > 0.2) continue;
      int length = 0;
      for (const auto& before : open)
        if (std::abs(pole.omega() / before.last.omega() - 1.0) < 0.01 &&
            std::abs(pole.damping_ratio() / before.last.damping_ratio() - 1.0) < 0.05 &&
            identification::mac(pole.shape, before.last.shape) > 0.98)
          length = std::max(length, before.length);
      next.push_back({pole, length + 1});
      constexpr int stable = 5;
      if (length + 1 < stable) continue;
      const auto same = std::ranges::find_if(found, [&](const FoundMode& m) {
        return std::abs(std::abs(m.pole) / pole.omega() - 1.0) < 0.01 &&
               identification::mac(m.shape, pole.shape) > 0.9;
      });
      if (same == found.end())
        found.push_back({.pole = pole.pole, .shape = pole.shape});
      else
        same->pole = pole.pole;
    }
    open = std::move(next);
  }
  return found;
}

OutputClass unequal_chain() {
  const Chain chain{.masses = Eigen::VectorXd{{1.31, 0.87, 1.64, 1.12, 0.73}},
                    .springs = Eigen::VectorXd{{1270.0, 941.0, 1530.0, 1105.0, 688.0, 412.0}},
                    .dampers = Eigen::VectorXd{{0.61, 0.23, 0.52, 0.31, 0.17, 0.44}}};
  return {.name = "output only: 5 unequal masses", .system = modes_of(chain)};
}

OutputClass sharp_chain() {
  const Chain chain{.masses = Eigen::VectorXd{{10.3, 19.7, 14.6}},
                    .springs = Eigen::VectorXd{{40.3e3, 88.9e3, 121e3, 0.0}},
                    .dampers = Eigen::VectorXd{{12.1, 24.3, 18.7, 0.0}}};
  OutputClass result{
      .name = "output only: a sharp mode, 90 s", .system = modes_of(chain), .block = 2048};
  for (auto& mode : result.system.modes) mode.shape *= mode.pole * mode.pole;
  result.experiment.sample_rate = 256.0;
  result.experiment.samples = 23040;
  result.experiment.noise = 0.005;
  return result;
}

OutputClass close_pairs() {
  ModalSystem system;
  const std::array<double, 6> hertz{4.27, 7.31, 7.42, 11.9, 17.2, 17.6};
  const std::array<double, 6> damping{0.011, 0.0093, 0.0117, 0.016, 0.0081, 0.0124};
  Random random(4711);
  for (std::size_t r = 0; r < hertz.size(); ++r) {
    Eigen::VectorXd shape(8);
    for (double& x : shape) x = normal(random);
    auto mode = real_mode(hertz[r], damping[r], shape);
    for (auto& x : mode.shape) x *= std::polar(1.0, 0.15 * normal(random));
    mode.shape *= std::abs(mode.pole);  // accelerations of similar size
    system.modes.push_back(mode);
  }
  return {.name = "output only: close pairs", .system = system};
}

OutputClass chain_with_tones() {
  const Chain chain{.masses = Eigen::VectorXd{{0.94, 1.27, 0.66}},
                    .springs = Eigen::VectorXd{{7300.0, 5150.0, 8420.0, 3310.0}},
                    .dampers = Eigen::VectorXd{{1.1, 0.7, 1.6, 0.4}}};
  OutputClass result{.name = "output only: tones, coloured forces", .system = modes_of(chain)};
  result.experiment.colour = 9.0;
  const Eigen::Vector3d first{0.31, 0.12, 0.22}, second{0.05, 0.09, 0.03};
  result.experiment.tones = {{23.7, first}, {47.4 - 0.02, second}};
  result.experiment.sample_rate = 120.0;
  return result;
}

}  // namespace hydrapod::test
