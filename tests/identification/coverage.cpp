#include "coverage.hpp"

namespace hydrapod::identification {

Coverage coverage_of(int seeds, double noise, double damping_ratio) {
  const auto system = test::chain(3, 1.13, 1733.0, damping_ratio);
  Coverage coverage{.runs = seeds};
  int intervals = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    test::NoiseExperiment experiment{
        .sample_rate = 160.0, .samples = 1 << 16, .seed = static_cast<std::uint64_t>(seed)};
    const auto clean = test::record_of(system, experiment);
    experiment.output_noise = Eigen::VectorXd::Constant(
        3, noise * std::sqrt(clean.samples.rightCols(3).squaredNorm() / (3.0 * (1 << 16))));
    const auto record = test::record_of(system, experiment);
    SpectrumEstimator estimator(record.header, {.block_length = 4096});
    estimator.add(record.samples);
    const auto found = identify_modes(estimate_responses(
        estimator.result(), {.inputs = {0, 1, 2}, .outputs = {3, 4, 5}, .instruments = {}},
        Estimator::h1));
    if (found.modes.size() != 3) continue;
    ++coverage.all_found;
    for (std::size_t r = 0; r < 3; ++r, ++intervals) {
      const auto& fit = found.modes[r].fit;
      const double omega = std::abs(system.modes[r].pole);
      if (std::abs(fit.omega() - omega) <= 1.96 * fit.omega_deviation) coverage.frequency += 1.0;
      if (std::abs(fit.damping_ratio() - damping_ratio) <= 1.96 * fit.damping_deviation)
        coverage.damping += 1.0;
      coverage.square +=
          0.5 * std::pow((fit.omega() - omega) / fit.omega_deviation, 2) +
          0.5 * std::pow((fit.damping_ratio() - damping_ratio) / fit.damping_deviation, 2);
    }
  }
  coverage.frequency /= intervals;
  coverage.damping /= intervals;
  coverage.square /= intervals;
  return coverage;
}

}  // namespace hydrapod::identification
