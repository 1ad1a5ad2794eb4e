#include "spiky.hpp"

namespace hydrapod::identification {

std::vector<Spike> spikes_in(const data::Record& record) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  data::write_record(file, record, data::RecordFormat::hdf5);
  data::RecordSet records({file});
  std::vector<std::size_t> channels(record.header.channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c) channels[c] = c;
  return find_spikes(records, channels);
}

std::vector<data::ResponseWarning> spike_warnings(const FrequencyResponses& responses) {
  std::vector<data::ResponseWarning> list;
  for (const auto& w : responses.warnings)
    if (w.kind == data::ResponseWarning::Kind::spikes) list.push_back(w);
  return list;
}

void add_spikes(Eigen::Index channel, int count, double height, test::Random& random,
                data::Record& record) {
  auto x = record.samples.col(channel);
  const double rms = std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
  for (int k = 0; k < count; ++k) {
    const auto at =
        static_cast<Eigen::Index>(random.uniform(0.03, 0.97) * static_cast<double>(x.size()));
    const double sign = random.chance(0.5) ? 1.0 : -1.0;
    for (int s = 0; s <= k % 3; ++s) x[at + s] += sign * height * rms * random.uniform(0.7, 1.0);
  }
}

data::Record quiet_record(std::uint64_t seed) { return gapped_record(five_masses(), {}, seed); }

double heavy_tailed(test::Random& random) {
  double squares = 0.0;
  for (int k = 0; k < 5; ++k) squares += std::pow(test::normal(random), 2);
  return test::normal(random) / std::sqrt(squares / 5.0);
}

data::Record stepped_sine(std::uint64_t seed) {
  constexpr double rate = 200.0;
  constexpr Eigen::Index each = 613;
  const auto system = five_masses(1);
  data::Record record{.header = test::header_of(1, 5, rate), .samples = {}};
  record.samples.resize(31 * each, 6);
  test::Random random(4513 * seed);
  test::ModalRun run(system, 1.0 / rate);
  double phase = random.uniform(0.0, 6.0);
  for (Eigen::Index t = 0; t < record.samples.rows(); ++t) {
    phase += 2.0 * std::numbers::pi / rate * (1.3 + 0.67 * static_cast<double>(t / each));
    const Eigen::VectorXd force = Eigen::VectorXd::Constant(1, 3.7 * std::sin(phase));
    record.samples.row(t) << force.transpose(), run.output().transpose();
    run.advance(force);
  }
  add_output_noise(0.003, 1, random, record);
  return record;
}

data::Record stepped_forces(std::uint64_t seed) {
  constexpr double rate = 200.0;
  const auto system = five_masses(1);
  data::Record record{.header = test::header_of(1, 5, rate), .samples = {}};
  record.samples.resize(20011, 6);
  test::Random random(6113 * seed);
  test::ModalRun run(system, 1.0 / rate);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(1);
  for (Eigen::Index t = 0; t < record.samples.rows(); ++t) {
    if (t % 74 == 0) force[0] = random.uniform(-4.0, 4.0);
    record.samples.row(t) << force.transpose(), run.output().transpose();
    run.advance(force);
  }
  add_output_noise(1e-4, 1, random, record);
  return record;
}

data::Record clean_record(CleanKind kind, std::uint64_t seed) {
  switch (kind) {
    case CleanKind::hammer:
      return hammer_record({.noise = 1e-4 * static_cast<double>(seed % 7)}, seed);
    case CleanKind::hammer_of_two_samples:
      return hammer_record({.at = {0.31}, .width = 0.93e-3}, seed);
    case CleanKind::several_hits:
      return hammer_record({.seconds = 7.0,
                            .at = {0.113, 0.94, 2.21, 3.07, 5.3},
                            .size = {1.0, 0.73, 1.19, 0.41, 0.88},
                            .width = 1.9e-3},
                           seed);
    case CleanKind::sweep:
    case CleanKind::multisine:
    case CleanKind::white_loop: {
      const auto excitation = kind == CleanKind::sweep       ? Excitation::sweep
                              : kind == CleanKind::multisine ? Excitation::multisine
                                                             : Excitation::white;
      return foreign_loop_record(foreign_plant(),
                                 {.excitation = excitation, .duration = 61.0, .seed = seed});
    }
    case CleanKind::stepped_sine:
      return stepped_sine(seed);
    case CleanKind::steps:
      return stepped_forces(seed);
    case CleanKind::three_bits: {
      auto record = quiet_record(seed);
      for (auto channel : record.samples.colwise()) {
        const double step = channel.cwiseAbs().maxCoeff() / 3.5;
        for (double& x : channel) x = step * (std::floor(x / step) + 0.5);
      }
      return record;
    }
    case CleanKind::heavy_tails: {
      auto record = quiet_record(seed);
      test::Random random(317 * seed);
      for (Eigen::Index c = 0; c < record.samples.cols(); ++c) {
        const double rms = std::sqrt(record.samples.col(c).squaredNorm() /
                                     static_cast<double>(record.samples.rows()));
        for (double& x : record.samples.col(c))
          x += (c < 3 ? 2.3 : 0.6) * rms * heavy_tailed(random);
      }
      return record;
    }
    case CleanKind::count:
      break;
  }
  return {};
}

}  // namespace hydrapod::identification
