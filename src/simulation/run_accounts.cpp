#include "run_accounts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hydrapod::simulation {

RunAccounts::RunAccounts(const Plant& plant, const Pose& operating, const Vector6& settling_band)
    : plant_(plant), operating_(operating), settling_band_(settling_band) {
  summary.piston_low.fill(std::numeric_limits<double>::infinity());
  summary.piston_high.fill(-std::numeric_limits<double>::infinity());
}

void RunAccounts::see(const Eigen::VectorXd& x, const Vector6& applied, const Vector6& command,
                      const control::ControllerState& controller, double time) {
  const Vector6 motion = displacement_between(operating_, plant_.pose(x.data()));
  const Vector6 error = command - motion;
  squares_ += error.cwiseAbs2();
  summary.peak_error = summary.peak_error.cwiseMax(error.cwiseAbs());
  summary.peak_command = summary.peak_command.cwiseMax(command.cwiseAbs());
  summary.peak_motion = summary.peak_motion.cwiseMax(motion.cwiseAbs());
  summary.final_error = error;
  const double T = time - summary.time;  // since the last sample, 0 at the first
  for (int i = 0; i < 6; ++i)
    if (std::abs(error[i]) > settling_band_[i]) summary.settled[i] = time;
  const Vector6 lengths = plant_.leg_lengths(x.data());
  const Vector6 torques = plant_.motor_torques(x.data(), applied);
  for (size_t i = 0; i < model::leg_count; ++i) {
    const int leg = static_cast<int>(i);
    const double piston = lengths[leg] - plant_.machine().legs[i].rod.length;
    summary.piston_low[i] = std::min(summary.piston_low[i], piston);
    summary.piston_high[i] = std::max(summary.piston_high[i], piston);
    if (T > 0.0)
      summary.peak_speed[i] =
          std::max(summary.peak_speed[i], std::abs(lengths[leg] - lengths_[leg]) / T);
    summary.peak_drive[i] = std::max(summary.peak_drive[i], std::abs(applied[leg]));
    summary.limited[i] += controller.limited[i] ? 1 : 0;
    if (plant_.layout().nuts < 0) continue;
    const double torque = std::abs(torques[leg]);
    summary.peak_torque[i] = std::max(summary.peak_torque[i], torque);
    summary.torque_limited[i] += torque >= *plant_.machine().legs[i].screw->torque_limit ? 1 : 0;
  }
  lengths_ = lengths;
  summary.time = time;
  ++summary.samples;
}

Settling settling_of(const std::vector<signals::Signal>& commands) {
  constexpr double share = 0.02;  // of a step
  Settling settling;
  for (const auto& command : commands) {
    const auto* step = std::get_if<signals::Step>(&command.form);
    for (int i = 0; step != nullptr && i < 6; ++i) {
      if (command.size[i] == 0.0) continue;
      auto& time = settling.step[static_cast<std::size_t>(i)];
      time = std::max(time.value_or(0.0), step->at);
      settling.band[i] = share * std::abs(command.size[i]);
    }
  }
  return settling;
}

std::optional<double> settling_time(const RunSummary& run, const Settling& settling,
                                    int direction) {
  constexpr double stays = 0.1;  // of the time since the step: what swings crosses the band too
  const double step = settling.step[static_cast<std::size_t>(direction)].value_or(0.0);
  const double within = run.time - run.settled[direction];
  if (std::abs(run.final_error[direction]) > settling.band[direction] ||
      within < stays * (run.time - step))
    return std::nullopt;
  return std::max(run.settled[direction] - step, 0.0);
}

RunSummary RunAccounts::finish(double time) {
  if (summary.samples > 0)
    summary.rms_error = (squares_ / static_cast<double>(summary.samples)).cwiseSqrt();
  summary.time = time;
  return std::move(summary);
}

}  // namespace hydrapod::simulation
