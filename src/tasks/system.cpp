#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::tasks {

namespace {

simulation::LinearSystemOptions linear_options(const Machine& machine,
                                               const SystemOptions& options) {
  return {.kind = machine.kind, .pade_order = options.pade_order, .closed = options.closed};
}

/// With its controller, with valves at rest, or with motors that turn freely.
simulation::LinearSystem described(const model::Machine& machine, const spatial::Pose& X_BP,
                                   const simulation::LinearSystemOptions& options) {
  if (!options.closed && model::leg_type(machine) == model::LegType::screw)
    return simulation::screw_system(machine, X_BP, options.kind);
  return simulation::linear_system(machine, X_BP, options);
}

/// Throws base::InputError for numbers without a relative sensitivity, and for the same one twice.
void check_parameters(const std::vector<std::string>& paths, const model::MachineFile& file) {
  std::vector<base::Diagnostic> errors;
  std::vector<model::ParameterId> known;
  for (const auto& path : paths) {
    const auto number = find_number(file, path);
    const std::string near = nearest_parameter(file, path);
    if (!number)
      errors.push_back(
          {.file = "--parameter " + path,
           .message = "the machine file has no such number" +
                      (near.empty() ? "" : fmt::format("; did you mean `{}`?", near))});
    else if (number->value == 0.0)
      errors.push_back(
          {.file = "--parameter " + path, .message = "is 0 and has no relative change"});
    else if (std::ranges::count(known, number->id) > 0)
      errors.push_back({.file = "--parameter " + path, .message = "is given twice"});
    else
      known.push_back(number->id);
  }
  if (!errors.empty()) throw base::InputError(errors);
}

}  // namespace

report::System system(const Machine& machine, const SystemOptions& options) {
  const auto& of = machine.file.machine;
  report::System result{
      .closed = options.closed,
      .linear = described(of, machine.pose.X_BP, linear_options(machine, options))};
  if (options.closed) result.tuning = simulation::tune_controller(of, machine.pose.X_BP);
  result.poles = simulation::system_poles(result.linear);
  return result;
}

report::RootLocus root_locus(const Machine& machine, const RootLocusOptions& options,
                             const Progress& progress) {
  constexpr int most_values = RootLocusOptions::most_values;
  if (options.count < 2 || options.count > most_values || options.from == options.to)
    throw std::invalid_argument(fmt::format(
        "root_locus: {} values from {} to {}; expected 2 to {} values and two different "
        "ends",
        options.count, options.from, options.to, most_values));
  const auto poles_at = [&](double value) {
    auto overrides = machine.file.overrides;
    overrides.push_back(fmt::format("{}={:.17g}", options.key, value));
    const auto changed =
        model::parse_machine(machine.file.text, machine.path, overrides, kinematics::check_machine);
    return simulation::system_poles(described(changed.machine,
                                              pose_of(changed.machine, machine.pose.name).X_BP,
                                              linear_options(machine, options.system)));
  };
  report::RootLocus locus{.key = options.key};
  const auto& today = machine.file.machine;
  locus.today = simulation::system_poles(
      described(today, machine.pose.X_BP, linear_options(machine, options.system)));
  if (const auto id = model::find_parameter(today, options.key))
    locus.today_value = model::value(today, *id);
  for (int k = 0; k < options.count; ++k) {
    locus.values.push_back(options.from + (options.to - options.from) * k / (options.count - 1));
    locus.poles.push_back(poles_at(locus.values.back()));
    if (progress && progress((k + 1.0) / options.count)) break;
  }
  for (std::size_t k = 0; k + 1 < locus.values.size(); ++k) {
    const bool stable = locus.poles[k].sampled_stable;
    if (stable == locus.poles[k + 1].sampled_stable) continue;
    double low = locus.values[k], high = locus.values[k + 1];
    const double enough = options.limit_accuracy * std::abs(high - low);
    while (std::abs(high - low) > enough) {
      const double middle = 0.5 * (low + high);
      (poles_at(middle).sampled_stable == stable ? low : high) = middle;
    }
    locus.limits.push_back(0.5 * (low + high));
  }
  return locus;
}

SystemResponse command_response(const Machine& machine, const CommandResponseOptions& options) {
  SystemResponse result;
  result.system = system(machine);
  const double lowest = result.system.tuning.lowest_oil_mode;
  const double from =
      options.from.value_or(std::min(0.01 * lowest, options.to.value_or(lowest) / 3.0));
  const double to = options.to.value_or(std::max(20.0 * lowest, 3.0 * from));
  result.response.omega = response::log_space(from, to, options.points);
  for (const double omega : result.response.omega)
    result.response.H.push_back(simulation::command_response(result.system.linear, omega));
  return result;
}

calibration::Sensitivities sensitivity(const Machine& machine, const SensitivityOptions& options) {
  check_parameters(options.parameters, machine.file);
  auto file = machine.file;
  auto pose = machine.pose;
  const auto index = add_pose(file, pose, "asked-for");
  return calibration::sensitivities(file, index, machine.kind, options.parameters);
}

}  // namespace hydrapod::tasks
