/// A whole diagnosis, from a record or a list of modes to the ranked hypotheses, stage by stage.
///
/// The machine is models/heavy-platform.toml as its owner believes it to be, with guide sleeves of
/// 20 kN/mm. On the rig the sleeve of leg 3 is softer, under a minute of noise in six directions;
/// in the list of modes, measured at two poses, the sleeves and the oil of all legs are.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>

#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/identification/responses.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/observation/targets.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/rig/rig.hpp"
#include "models.hpp"
#include "support/noisy_modes.hpp"

namespace {

using namespace hydrapod;
using dynamics::ModelKind;

const std::vector<std::string> owner{"legs.oil_spring.cylinder.air.fraction=0.001",
                                     "legs.oil_spring.cylinder.bulk_modulus=0.8 GPa",
                                     "legs.guide_sleeve.stiffness=20 kN/mm"};

model::MachineFile machine_file(const std::vector<std::string>& faults = {}) {
  auto overrides = owner;
  overrides.insert(overrides.end(), faults.begin(), faults.end());
  return model::read_machine_file(model_file("heavy-platform.toml"), overrides,
                                  kinematics::check_machine);
}

/// A record file of its own, removed at the end of the program.
class RecordOnRig {
 public:
  explicit RecordOnRig(const model::Machine& machine) {
    rig::RigOptions options;
    signals::Signal white{.form = signals::White{}};
    white.size.setConstant(2e-4);
    options.signals = {white};
    options.duration = 60.0;
    options.seed = 7002;
    options.instruments.accelerometers = {};
    simulation::ClosedLoop loop(machine, machine.neutral(), rig::loop_options(options));
    const auto writer = data::open_record_writer(
        path(), {.channels = rig::rig_channels(options), .sample_rate = options.rate});
    const auto result = rig::run_rig(loop, options, *writer);
    writer->close();
    if (result.summary.end != simulation::RunEnd::finished)
      throw std::runtime_error(result.summary.message);
  }
  ~RecordOnRig() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  RecordOnRig(const RecordOnRig&) = delete;
  RecordOnRig& operator=(const RecordOnRig&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_{std::filesystem::temp_directory_path() /
                              ("diagnosis_bench." + std::to_string(getpid()) + ".h5")};
};

identification::FrequencyResponses responses_of(const std::string& record) {
  const auto machine = machine_file().machine;
  identification::MeasureOptions options;
  options.platform = {machine, machine.neutral(), machine.neutral().p_BP};
  data::RecordSet records({record});
  return identification::measure_responses(records, options).responses;
}

/// What is known after each stage of the way from the record to the diagnosis.
struct Stages {
  RecordOnRig record{machine_file({"leg.3.guide_sleeve.stiffness=1.2 kN/mm"}).machine};
  identification::FrequencyResponses responses{responses_of(record.path())};
  identification::Identification identified{identification::identify_modes(responses)};
};

const Stages& stages() {
  static const Stages stages;
  return stages;
}

observation::Targets targets_of_record() {
  const auto machine = machine_file().machine;
  const observation::MeasuredAt at{.pose = "neutral", .point = spatial::Vector3::Zero()};
  auto targets =
      observation::measured_modes(identification::modal_results(stages().identified), machine, at);
  if (const auto lines = observation::measured_responses(stages().responses, machine, at))
    targets.responses.push_back(*lines);
  return targets;
}

observation::Targets targets_of_modes() {
  test::Random random(41);
  const auto truth = machine_file(
      {"legs.guide_sleeve.stiffness=1.1 kN/mm", "legs.oil_spring.cylinder.bulk_modulus=0.57 GPa"});
  return test::noisy_modes(truth.machine, {"neutral", "low"}, ModelKind::guide, {}, random);
}

/// What was found, so that no speed is gained by another answer.
std::string summary(const diagnosis::Diagnosis& d) {
  const auto& best = d.best();
  auto text = report::hypothesis_name(d, best) + ", " + std::to_string(best.misfit);
  for (const auto& p : best.fit.parameters) text += ", " + std::to_string(p.value);
  return text + "; " + std::to_string(d.equivalent.size()) + " alike of " +
         std::to_string(d.hypotheses.size());
}

void diagnose(benchmark::State& state, observation::Targets (*measured)(), int threads) {
  const auto file = machine_file();
  const auto targets = measured();
  diagnosis::DiagnoseOptions options;
  options.threads = threads;
  diagnosis::Diagnosis found;
  for (auto _ : state)
    found = diagnosis::diagnose(file, targets, ModelKind::guide, file.machine.poses, options);
  state.SetLabel(summary(found));
}
BENCHMARK_CAPTURE(diagnose, modes, targets_of_modes, 1)
    ->Name("diagnosis_of_modes")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(diagnose, record, targets_of_record, 1)
    ->Name("diagnosis_of_record")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(diagnose, modes_2, targets_of_modes, 2)
    ->Name("diagnosis_of_modes/two_threads")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(diagnose, record_2, targets_of_record, 2)
    ->Name("diagnosis_of_record/two_threads")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void responses_of_rig_record(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(responses_of(stages().record.path()));
}
BENCHMARK(responses_of_rig_record)->Unit(benchmark::kMillisecond);

void identification_of_record(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(identification::identify_modes(stages().responses));
  state.SetLabel(std::to_string(stages().identified.modes.size()) + " modes");
}
BENCHMARK(identification_of_record)->Unit(benchmark::kMillisecond);

}  // namespace
