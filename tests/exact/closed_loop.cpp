#include "exact/closed_loop.hpp"

#include <fmt/format.h>

namespace hydrapod::test {

using Eigen::Index;

namespace {

constexpr int settling = 1000;

/// White noise, averaged over `width` samples three times; a row per sample.
Eigen::MatrixXd excitation(Index samples, Index inputs, int width, Random& random) {
  Eigen::MatrixXd r(samples, inputs);
  for (Index k = 0; k < samples; ++k)
    for (Index i = 0; i < inputs; ++i) r(k, i) = normal(random);
  for (int pass = 0; pass < 3 && width > 1; ++pass)
    for (Index k = samples - 1; k >= width - 1; --k)
      r.row(k) = Eigen::RowVectorXd(r.middleRows(k - width + 1, width).colwise().mean());
  return r;
}

}  // namespace

data::Record closed_loop_record(const ModalSystem& system, const LoopExperiment& e) {
  const Index p = system.inputs();
  data::Record record{.header = header_of(p, p, e.sample_rate), .samples = {}};
  for (Index i = 0; i < p; ++i)
    record.header.channels.push_back(
        {.name = fmt::format("d{}", i + 1), .role = data::Role::drive});
  record.samples.resize(e.samples, 3 * p);
  Random random(e.seed);
  const auto r = excitation(settling + e.samples, p, e.smoothed_over, random);
  ModalRun run(system, 1.0 / e.sample_rate);
  for (Index k = -settling; k < e.samples; ++k) {
    Eigen::VectorXd y = run.output();
    for (double& x : y) x += e.noise * normal(random);
    const Eigen::VectorXd u = r.row(k + settling).transpose() - e.gain * y;
    if (k >= 0) record.samples.row(k) << r.row(k + settling), y.transpose(), u.transpose();
    run.advance(u);
  }
  return record;
}

}  // namespace hydrapod::test
