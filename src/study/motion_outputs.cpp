#include "motion_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "machine_outputs.hpp"

namespace hydrapod::study {

namespace {

using simulation::RunSummary;

constexpr double settled_share = 0.02;  // of a step

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
  for (int d = 0; d < 6; ++d) {
    double size = 0.0;
    for (const auto& command : motion_->commands) {
      const auto* step = std::get_if<signals::Step>(&command.form);
      if (step == nullptr || command.size[d] == 0.0) continue;
      auto& last = last_step_[static_cast<std::size_t>(d)];
      last = std::max(last, step->at);
      size = std::abs(command.size[d]);
    }
    if (size == 0.0) continue;
    stepped_.push_back(d);
    settling_band_[d] = settled_share * size;
  }
  for (const auto& [name, values, meaning] : of_directions)
    for (std::size_t d = 0; d < 6; ++d)
      columns_.push_back(
          {fmt::format("{}_{}", name, spatial::direction_names[d]), d < 3 ? "m" : "rad",
           fmt::format("{} in {}", meaning, spatial::direction_names[d]), Worse::more});
  for (const int d : stepped_) {
    const char* name = spatial::direction_names[static_cast<std::size_t>(d)];
    columns_.push_back({fmt::format("settling_{}", name), "s",
                        fmt::format("time from the last step in {} until the motion stays within "
                                    "2 % of it",
                                    name),
                        Worse::more});
  }
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
        [&](double) { return !interruption_ || !interruption_->is_asked(); }, settling_band_);
  } catch (const base::ComputationError&) {  // it does not stand at the pose
    return;
  }
  if (run.end != simulation::RunEnd::finished) return;
  auto next = outputs.begin();
  for (const auto& [name, values, meaning] : of_directions)
    for (int d = 0; d < 6; ++d) *next++ = (run.*values)[d];
  for (const int d : stepped_) {
    const bool settled = std::abs(run.final_error[d]) <= settling_band_[d];
    const double time = run.settled[d] - last_step_[static_cast<std::size_t>(d)];
    *next++ = settled ? std::max(time, 0.0) : missing;
  }
  *next++ = std::ranges::max(run.peak_speed);
  *next++ = std::ranges::max(run.peak_drive);
  *next++ = static_cast<double>(std::ranges::max(run.limited)) / static_cast<double>(run.samples);
}

}  // namespace hydrapod::study
