#include "gapped.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace hydrapod::identification {

test::ModalSystem five_masses(Eigen::Index inputs) {
  const Eigen::Vector<double, 5> mass{1.37, 2.11, 0.83, 1.79, 1.23};
  const Eigen::Vector<double, 6> spring{2310.0, 4970.0, 3190.0, 6130.0, 2780.0, 1490.0},
      damper{1.31, 0.67, 1.93, 0.41, 1.17, 0.59};
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(5, 5), D = K;
  for (Eigen::Index j = 0; j < 5; ++j) {
    K(j, j) = spring[j] + spring[j + 1];
    D(j, j) = damper[j] + damper[j + 1];
    if (j == 0) continue;
    K(j, j - 1) = K(j - 1, j) = -spring[j];
    D(j, j - 1) = D(j - 1, j) = -damper[j];
  }
  const Eigen::MatrixXd flexibility = mass.cwiseInverse().asDiagonal();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(10, 10);
  A.topRightCorner<5, 5>().setIdentity();
  A.bottomLeftCorner<5, 5>() = -flexibility * K;
  A.bottomRightCorner<5, 5>() = -flexibility * D;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  const Eigen::MatrixXcd V = solver.eigenvectors(), W = V.inverse();
  test::ModalSystem system;
  for (Eigen::Index r = 0; r < 10; ++r)
    if (solver.eigenvalues()[r].imag() > 0.0)
      system.modes.push_back(
          {.pole = solver.eigenvalues()[r],
           .shape = V.col(r).head(5),
           .participation = (W.row(r).tail(5) * flexibility.cast<std::complex<double>>())
                                .transpose()
                                .head(inputs)});
  std::ranges::sort(system.modes, {}, [](const auto& m) { return std::abs(m.pole); });
  return system;
}

void drop(const DropOuts& d, test::Random& random, data::Record& record) {
  constexpr double lost = std::numeric_limits<double>::quiet_NaN();
  auto& x = record.samples;
  const auto length = static_cast<Eigen::Index>(std::llround(d.gap * d.sample_rate));
  const Eigen::Index sets = d.channels_separately ? x.cols() : 1, width = x.cols() / sets;
  for (Eigen::Index s = 0; s < sets; ++s) {
    for (Eigen::Index t = 0; t < x.rows(); ++t)
      if (random.chance(d.share)) x.row(t).segment(s * width, width).setConstant(lost);
    for (int k = 0; k < d.gaps; ++k) {
      const auto at =
          static_cast<Eigen::Index>(random.uniform() * static_cast<double>(x.rows() - length));
      x.block(at, s * width, length, width).setConstant(lost);
    }
  }
}

void add_output_noise(double noise, Eigen::Index inputs, test::Random& random,
                      data::Record& record) {
  auto& x = record.samples;
  for (Eigen::Index c = inputs; c < x.cols(); ++c) {
    const double rms = std::sqrt(x.col(c).squaredNorm() / static_cast<double>(x.rows()));
    for (Eigen::Index t = 0; t < x.rows(); ++t) x(t, c) += noise * rms * test::normal(random);
  }
}

data::Record gapped_record(const test::ModalSystem& system, const DropOuts& d, std::uint64_t seed) {
  const int samples = static_cast<int>(d.duration * d.sample_rate);
  test::NoiseExperiment experiment{
      .sample_rate = d.sample_rate, .samples = samples, .seed = 3331 * seed, .settling = 6000};
  auto record = test::record_of(system, experiment);
  test::Random random(7129 * seed);
  add_output_noise(d.noise, system.inputs(), random, record);
  drop(d, random, record);
  return record;
}

Measurement gapped_measurement(const data::Record& record, bool output_only) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  data::write_record(file, record, data::RecordFormat::hdf5);
  data::RecordSet records({file});
  return output_only ? measure_outputs(records, {}) : measure_responses(records, {});
}

GappedScore gapped_score(const DropOuts& d, int seeds, int first_seed) {
  const auto system = five_masses();
  const auto truth = test::true_modes(system);
  const auto modes = static_cast<Eigen::Index>(truth.size());
  Eigen::MatrixXd omega(modes, seeds), damping(modes, seeds);
  GappedScore result;
  int used = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const auto record = gapped_record(system, d, static_cast<std::uint64_t>(first_seed + seed));
    const auto measured = gapped_measurement(record, d.output_only);
    for (const auto& w : measured.responses.warnings)
      if (w.kind == data::ResponseWarning::Kind::missing_samples) {
        result.missing = w.share;
        result.unknown = w.value;
      }
    const auto found = identify_modes(measured.responses);
    result.warnings += found.warnings.size();
    result.score.add(truth, test::found_modes(found), {.frequency = 0.02});
    if (found.modes.size() != truth.size()) continue;
    for (Eigen::Index r = 0; r < modes; ++r) {
      const auto& fit = found.modes[static_cast<std::size_t>(r)].fit;
      const auto pole = truth[static_cast<std::size_t>(r)].pole;
      omega(r, used) = fit.omega() / std::abs(pole) - 1.0;
      damping(r, used) = fit.damping_ratio() / (-pole.real() / std::abs(pole)) - 1.0;
      result.frequency_in_deviations =
          std::max(result.frequency_in_deviations,
                   std::abs(fit.omega() - std::abs(pole)) / fit.omega_deviation);
      result.damping_in_deviations = std::max(
          result.damping_in_deviations,
          std::abs(fit.damping_ratio() + pole.real() / std::abs(pole)) / fit.damping_deviation);
    }
    ++used;
  }
  const auto in_deviations = [&](const Eigen::MatrixXd& all, Eigen::Index r) {
    const Eigen::ArrayXd x = all.row(r).head(used).transpose();
    const double mean = x.mean(), n = used;
    return std::abs(mean) / std::sqrt((x - mean).square().sum() / (n * (n - 1.0)));
  };
  for (Eigen::Index r = 0; r < modes && used > 1; ++r) {
    result.frequency_bias =
        std::max(result.frequency_bias, std::abs(omega.row(r).head(used).mean()));
    const double relative = damping.row(r).head(used).mean();
    if (std::abs(relative) > std::abs(result.damping_bias_relative))
      result.damping_bias_relative = relative;
    result.damping_bias = std::max(result.damping_bias, in_deviations(damping, r));
    result.frequency_bias_in_deviations =
        std::max(result.frequency_bias_in_deviations, in_deviations(omega, r));
  }
  return result;
}

}  // namespace hydrapod::identification
