#include "support/rig_record.hpp"

#include <gtest/gtest.h>

#include "hydrapod/identification/responses.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {

identification::FrequencyResponses measured_on_rig(const model::Machine& machine,
                                                   const RigExperiment& experiment) {
  rig::RigOptions options;
  signals::Signal white{.form = signals::White{}};
  if (experiment.to > 0.0) white.form = signals::Noise{.to = experiment.to};
  white.size.setConstant(experiment.level);
  if (experiment.force > 0.0) {
    options.entry = rig::Entry::wrench;
    white.size.setConstant(experiment.force);
  }
  options.signals = {white};
  options.duration = experiment.duration;
  options.seed = experiment.seed;
  options.instruments.accelerometers = {};
  options.instruments.length.noise *= experiment.sensors;
  options.instruments.length.resolution *= experiment.sensors;
  options.loop.kind = experiment.kind;
  const TemporaryFolder folder;
  const std::string path = folder / "run.h5";
  simulation::ClosedLoop loop(machine, experiment.X_BP, rig::loop_options(options));
  const auto writer = data::open_record_writer(
      path, {.channels = rig::rig_channels(options), .sample_rate = options.rate});
  const auto result = rig::run_rig(loop, options, *writer);
  EXPECT_EQ(result.summary.end, simulation::RunEnd::finished) << result.summary.message;
  writer->close();
  identification::MeasureOptions measure;
  measure.platform = {machine, experiment.X_BP,
                      experiment.X_BP * experiment.point.value_or(machine.platform.mass_center)};
  data::RecordSet record({path});
  return identification::measure_responses(record, measure).responses;
}

identification::Identification identified_on_rig(const model::Machine& machine,
                                                 const RigExperiment& experiment) {
  return identification::identify_modes(measured_on_rig(machine, experiment));
}

}  // namespace hydrapod::test
