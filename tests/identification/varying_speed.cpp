#include "varying_speed.hpp"

#include "support/run_program.hpp"

namespace hydrapod::test {

data::Record with_machine(data::Record record, const Machine& machine, std::uint64_t seed) {
  Random random(seed);
  const Eigen::Index samples = record.samples.rows();
  const double interval = 1.0 / record.header.sample_rate;
  // two low-passes of first order, begun long before the record
  const double keep = std::exp(-2.0 * std::numbers::pi * machine.slow * interval);
  Eigen::VectorXd speed(samples);
  double first = 0.0, second = 0.0;
  const auto settling = static_cast<Eigen::Index>(10.0 / (machine.slow * interval));
  for (Eigen::Index k = -settling; k < samples; ++k) {
    first = keep * first + (1.0 - keep) * normal(random);
    second = keep * second + (1.0 - keep) * first;
    if (k >= 0) speed[k] = second;
  }
  speed.array() -= speed.mean();
  speed *= machine.spread / std::sqrt(speed.squaredNorm() / static_cast<double>(samples));
  const Eigen::RowVectorXd rms =
      (record.samples.colwise().squaredNorm() / static_cast<double>(samples)).cwiseSqrt();
  double turned = normal(random);
  for (Eigen::Index k = 0; k < samples; ++k) {
    for (std::size_t n = 0; n < machine.orders.size(); ++n)
      for (Eigen::Index o = 0; o < record.samples.cols(); ++o)
        record.samples(k, o) +=
            rms[o] *
            (machine.orders[n][o] * std::polar(1.0, static_cast<double>(n + 1) * turned)).real();
    turned += 2.0 * std::numbers::pi * machine.frequency * (1.0 + speed[k]) * interval;
  }
  return record;
}

identification::Identification identified_as_asked(const data::Record& record) {
  const TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  data::write_record(file, record, data::RecordFormat::hdf5);
  data::RecordSet records({file});
  return identification::identify_modes(identification::measure_outputs(records, {}).responses);
}

MachineClass floor_with_machine(double spread) {
  const Chain chain{.masses = Eigen::VectorXd{{213.0, 171.0, 246.0, 134.0}},
                    .springs = Eigen::VectorXd{{0.417e6, 0.351e6, 0.633e6, 0.288e6, 0.196e6}},
                    .dampers = Eigen::VectorXd{{171.0, 113.0, 196.0, 157.0, 88.0}}};
  MachineClass result{.name = "output only: a machine whose speed varies",
                      .system = modes_of(chain)};
  result.experiment.samples = 60000;
  result.experiment.noise = 0.03;
  result.machine = {
      .frequency = 12.37,
      .spread = spread,
      .orders = {Eigen::VectorXcd{{{0.71, 0.2}, {-0.48, 0.33}, {0.9, 0.0}, {0.24, -0.5}}},
                 Eigen::VectorXcd{{{0.11, 0.2}, {0.28, -0.13}, {-0.3, 0.1}, {0.2, 0.0}}},
                 Eigen::VectorXcd{{{0.08, 0.0}, {0.02, 0.11}, {0.05, 0.0}, {0.1, 0.04}}}}};
  return result;
}

}  // namespace hydrapod::test
