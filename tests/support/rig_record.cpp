#include "support/rig_record.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/responses.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {

namespace {

rig::RigOptions rig_options(const RigExperiment& experiment) {
  rig::RigOptions options;
  signals::Signal signal{.form = experiment.form};
  signal.size.setConstant(experiment.level);
  if (experiment.force > 0.0) {
    options.entry = rig::Entry::wrench;
    signal.form = signals::White{};
    signal.size.setConstant(experiment.force);
  }
  options.signals = {signal};
  options.duration = experiment.duration;
  options.seed = experiment.seed;
  options.instruments.accelerometers = {};
  options.instruments.length.noise *= experiment.sensors;
  options.instruments.length.resolution *= experiment.sensors;
  options.loop.kind = experiment.kind;
  return options;
}

/// What recorders do to signals: a pump's ripple in its cables, and samples that are lost.
void spoil(const std::string& path, const RigExperiment& experiment) {
  constexpr double ripple = 23.7;  // [Hz]
  auto record = data::read_record(path).record;
  Random random(experiment.seed);
  const auto rows = record.samples.rows();
  for (Eigen::Index c = 0; c < record.samples.cols(); ++c) {
    auto samples = record.samples.col(c);
    if (record.header.channels[static_cast<std::size_t>(c)].role != data::Role::excitation) {
      const double rms = std::sqrt((samples.array() - samples.mean()).square().mean());
      const double phase = random.uniform(0.0, base::two_pi);
      for (Eigen::Index t = 0; t < rows; ++t)
        samples[t] += std::sqrt(2.0) * experiment.ripple * rms *
                      std::sin(phase + base::two_pi * ripple * static_cast<double>(t) /
                                           record.header.sample_rate);
    }
    for (Eigen::Index t = 0; t < rows; ++t)
      if (random.uniform(0.0, 1.0) < experiment.drop_outs)
        samples[t] = std::numeric_limits<double>::quiet_NaN();
  }
  data::write_record(path, record, data::RecordFormat::hdf5);
}

void run(const model::Machine& machine, const RigExperiment& experiment, const std::string& path) {
  const auto options = rig_options(experiment);
  simulation::ClosedLoop loop(machine, experiment.X_BP, rig::loop_options(options));
  const auto writer = data::open_record_writer(
      path, {.channels = rig::rig_channels(options, model::leg_type(machine)),
             .sample_rate = options.rate});
  const auto result = rig::run_rig(loop, options, *writer);
  EXPECT_EQ(result.summary.end, simulation::RunEnd::finished) << result.summary.message;
  writer->close();
  if (experiment.drop_outs > 0.0 || experiment.ripple > 0.0) spoil(path, experiment);
}

}  // namespace

identification::FrequencyResponses measured_on_rig(const model::Machine& machine,
                                                   const RigExperiment& experiment) {
  const TemporaryFolder folder;
  std::vector<std::string> files;
  auto one = experiment;
  auto* const multisine = std::get_if<signals::Multisine>(&one.form);
  const int experiments = multisine != nullptr ? 6 : 1;
  one.duration /= experiments;
  for (int k = 1; k <= experiments; ++k) {
    files.push_back(folder / fmt::format("run{}.h5", k));
    if (multisine != nullptr) multisine->experiment = k;
    run(machine, one, files.back());
  }
  identification::MeasureOptions measure;
  measure.platform = {machine, experiment.X_BP,
                      experiment.X_BP * experiment.point.value_or(machine.platform.mass_center)};
  data::RecordSet records(files);
  return identification::measure_responses(records, measure).responses;
}

identification::Identification identified_on_rig(const model::Machine& machine,
                                                 const RigExperiment& experiment) {
  return identification::identify_modes(measured_on_rig(machine, experiment));
}

}  // namespace hydrapod::test
