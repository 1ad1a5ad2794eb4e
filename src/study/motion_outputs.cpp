#include "motion_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "machine_outputs.hpp"

namespace hydrapod::study {

namespace {

using simulation::RunSummary;

struct OfDirection {
  const char* name;
  spatial::Vector6 RunSummary::*values;
  const char* meaning;
};
constexpr std::array of_directions{
    OfDirection{"rms_error", &RunSummary::rms_error, "root mean square of command less motion"},
    OfDirection{"peak_error", &RunSummary::peak_error, "largest command less motion"},
    OfDirection{"peak_motion", &RunSummary::peak_motion, "largest motion from the pose"}};

}  // namespace

MotionOutputs::MotionOutputs(const std::optional<Motion>& motion, dynamics::ModelKind kind,
                             std::shared_ptr<const Interruption> interruption)
    : motion_(motion), kind_(kind), interruption_(std::move(interruption)) {
  if (!motion_) return;
  settling_ = simulation::settling_of(motion_->commands);
  for (const auto& [name, values, meaning] : of_directions)
    for (std::size_t d = 0; d < 6; ++d)
      columns_.push_back(
          {fmt::format("{}_{}", name, spatial::direction_names[d]), d < 3 ? "m" : "rad",
           fmt::format("{} in {}", meaning, spatial::direction_names[d]), Worse::more});
  for (std::size_t d = 0; d < 6; ++d)
    if (settling_.step[d])
      columns_.push_back(
          {fmt::format("settling_{}", spatial::direction_names[d]), "s",
           fmt::format("time from the last step in {} until the motion stays within 2 % of it",
                       spatial::direction_names[d]),
           Worse::more});
  columns_.push_back({"peak_speed", "m/s", "largest speed of a piston", Worse::more});
  columns_.push_back({"peak_drive", "1", "largest drive of a leg", Worse::more});
  columns_.push_back(
      {"limited", "1", "share of the samples with the drive of a leg at its limit", Worse::more});
}

void MotionOutputs::operator()(const model::Machine& machine, const spatial::Pose& X_BP,
                               std::span<double> outputs) const {
  if (!motion_) return;
  std::ranges::fill(outputs, missing);
  RunSummary run;
  try {
    simulation::ClosedLoop loop(machine, X_BP, {.kind = kind_, .until = motion_->until});
    signals::Generator commands(motion_->commands, 1.0 / loop.parameters().sample_time);
    run = loop.run(
        simulation::command_source(commands), [](const simulation::LoopSample&) {},
        [&](double) { return !interruption_ || !interruption_->is_asked(); }, settling_.band);
  } catch (const base::ComputationError&) {  // it does not stand at the pose
    return;
  }
  if (run.end != simulation::RunEnd::finished) return;
  auto next = outputs.begin();
  for (const auto& [name, values, meaning] : of_directions)
    for (int d = 0; d < 6; ++d) *next++ = (run.*values)[d];
  for (int d = 0; d < 6; ++d)
    if (settling_.step[static_cast<std::size_t>(d)])
      *next++ = simulation::settling_time(run, settling_, d).value_or(missing);
  *next++ = std::ranges::max(run.peak_speed);
  *next++ = std::ranges::max(run.peak_drive);
  *next++ = static_cast<double>(std::ranges::max(run.limited)) / static_cast<double>(run.samples);
}

}  // namespace hydrapod::study
