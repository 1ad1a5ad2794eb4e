#include "problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "amplitudes.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "poles.hpp"

namespace hydrapod::calibration {

double Variable::value(double x) const {
  return sign != 0 ? sign * std::exp(x) : start + scale * x;
}
double Variable::x(double value) const {
  return sign != 0 ? std::log(sign * value) : (value - start) / scale;
}
double Variable::slope(double x) const { return sign != 0 ? sign * std::exp(x) : scale; }

Problem::Problem(const model::Machine& machine, const Targets& targets,
                 std::vector<Variable> variables, dynamics::ModelKind kind,
                 const ProblemOptions& options)
    : machine_{machine, {}},
      targets_(targets),
      variables_(std::move(variables)),
      kind_(kind),
      options_(options),
      common_error_(targets.modes) {
  for (const auto& variable : variables_) machine_.parameters.push_back(variable.ids);
  const auto tied = machine_.at(machine_.values());
  find_poses(tied);
  const auto constraints = admissibility_margins(tied).size();
  residuals_ = make_residuals(targets_, variables_, options_.hold_to_physics, constraints);
}

void Problem::find_poses(const model::Machine& machine) {
  std::vector<base::Diagnostic> errors;
  const auto point_at = [&](const std::string& what, const std::string& name, double amplitude) {
    const auto* named = find_pose(machine, name);
    if (named == nullptr) {
      errors.push_back({.key = "pose",
                        .message = fmt::format("{}: the machine has no pose \"{}\"", what, name)});
      return -1;
    }
    const Place place{static_cast<std::size_t>(named - machine.poses.data()), amplitude};
    const auto known = std::ranges::find(places_, place);
    const auto point = static_cast<int>(known - places_.begin());
    if (known == places_.end()) places_.push_back(place);
    return point;
  };
  for (const auto& target : targets_.modes) {
    if (target.amplitude != 0.0 && observes_plant())
      errors.push_back({.key = "amplitude",
                        .message = fmt::format("target {}: modes at an amplitude are those of "
                                               "mechanics (--against mechanics)",
                                               target.name)});
    point_of_.push_back(point_at("target " + target.name, target.pose, target.amplitude));
  }
  for (const auto& target : targets_.responses) {
    if (!can_enter(targets_.observed, target.entry))
      throw std::invalid_argument("Targets::responses: what is observed has no such input");
    point_of_response_.push_back(point_at("responses", target.pose, 0.0));
  }
  if (!errors.empty()) throw base::InputError(errors);
  const auto metric = [&](int point, const spatial::Vector3& p_PQ) {
    const auto& pose = machine.poses[places_[static_cast<std::size_t>(point)].pose];
    return observation::platform_metric(machine, pose.X_BP, p_PQ);
  };
  for (std::size_t i = 0; i < targets_.modes.size(); ++i)
    metric_.push_back(
        metric(point_of_[i], targets_.modes[i].shape_point.value_or(machine.platform.mass_center)));
  for (std::size_t i = 0; i < targets_.responses.size(); ++i)
    metric_of_response_.push_back(metric(point_of_response_[i], targets_.responses[i].point));
  for (std::size_t p = 0; p < places_.size(); ++p) {
    const auto wanted = std::count(point_of_.begin(), point_of_.end(), static_cast<int>(p));
    const int modes = dynamics::degrees_of_freedom(machine, kind_);
    if (wanted > modes)
      errors.push_back({.key = "mode",
                        .message = fmt::format(
                            "{} targets at pose \"{}\", but the {} model has {} modes", wanted,
                            machine.poses[places_[p].pose].name, dynamics::name(kind_), modes)});
  }
  if (!errors.empty()) throw base::InputError(errors);
}

void Problem::add_margins(const std::vector<double>& scales, State& state) const {
  const auto margins_of = [](const model::Machine& machine) {
    const auto margins = admissibility_margins(machine);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
        margins.data(), static_cast<Eigen::Index>(margins.size())));
  };
  state.margins = margins_of(state.machine);
  state.dmargins.setZero(state.margins.size(), size());
  if (scales.empty()) return;
  // only what is nearly broken pushes, and only then are its derivatives wanted
  constexpr double near = 1e-2;
  if (!(state.margins.array() < near && state.margins.array() != 0.0).any()) return;
  std::vector<double> values = state.values;
  model::Machine moved = state.machine;
  for (std::size_t j = 0; j < scales.size(); ++j) {
    const double h = relative_step * scales[j];
    values[j] = state.values[j] + h;
    machine_.at(values, moved);
    const Eigen::VectorXd above = margins_of(moved);
    values[j] = state.values[j] - h;
    machine_.at(values, moved);
    state.dmargins.col(static_cast<Eigen::Index>(j)) = (above - margins_of(moved)) / (2.0 * h);
    values[j] = state.values[j];
  }
}

std::vector<std::size_t> Problem::targets_at(std::size_t point) const {
  std::vector<std::size_t> here;
  for (std::size_t i = 0; i < targets_.modes.size(); ++i)
    if (point_of_[i] == static_cast<int>(point)) here.push_back(i);
  return here;
}

bool Problem::see_modes(const std::vector<double>& scales, State& state) const {
  if (state.modes_at.empty() || state.modes_at != state.values) {
    state.modes_at.clear();
    state.points.clear();
    for (const auto& place : places_)
      state.points.push_back(mode_point(state.machine, place.pose, kind_));
    state.seen.resize(places_.size());
    for (std::size_t p = 0; p < places_.size(); ++p)
      if (!pair_modes_at(p, state)) return false;
    state.modes_at = state.values;
  }
  for (std::size_t p = 0; p < places_.size() && !scales.empty(); ++p) {
    auto& point = state.points[p];
    if (point.derivatives.size() == scales.size()) continue;  // known already
    add_derivatives(machine_, state.values, places_[p].pose, scales, point);
    // repeated ones have another basis now
    if (point.repeats() && !pair_modes_at(p, state)) return false;
    if (!add_damped_derivatives(p, scales, state)) return false;
  }
  return true;
}

bool Problem::add_damped_derivatives(std::size_t p, const std::vector<double>& scales,
                                     State& state) const {
  auto& point = state.points[p];
  const auto& [pose, amplitude] = places_[p];
  if (amplitude > 0.0) {
    std::vector<int> modes;
    for (const auto i : targets_at(p)) modes.push_back(state.seen[p].mode_of[i]);
    return add_amplitude_derivatives(machine_, state.values, pose, amplitude, scales, modes, point);
  }
  if (!point.damped.empty()) add_pole_derivatives(modal::modal_ratio(state.machine).value, point);
  return true;
}

bool Problem::pair_modes_at(std::size_t point, State& state) const {
  auto& here = state.points[point];
  auto& seen = state.seen[point];
  seen.seen.mechanics = here.model;
  seen.seen.modes = observation::undamped_modes(here.model, here.modes);
  const auto see_damped = [&] {
    for (int k = 0; k < here.modes.size(); ++k) {
      const auto* damped = here.damped_mode(k);
      if (damped == nullptr) continue;
      auto& mode = seen.seen.modes[static_cast<std::size_t>(k)];
      mode.pole = damped->pole;
      mode.shape = damped->real.cast<std::complex<double>>();
      mode.against_base = here.model.against_base * mode.shape;
    }
  };
  const auto& [pose, amplitude] = places_[point];
  if (amplitude > 0.0) add_at_amplitude(state.machine, pose, amplitude, here);
  see_damped();
  const auto targets = targets_at(point);
  if (!pair_seen(targets_.modes, targets, seen)) return false;
  if (amplitude > 0.0)
    return std::ranges::all_of(targets, [&](std::size_t i) {
      const int k = seen.mode_of[i];
      return here.damped_mode(k) != nullptr || !moves_platform(here, k);
    });
  if (!is_shifted_by_damping(here.model)) return true;
  std::vector<int> damped;
  for (const auto i : targets)
    if (targets_.modes[i].damped) damped.push_back(seen.mode_of[i]);
  if (damped.empty()) return true;
  if (here.damped.empty()) {
    add_damped(modal::modal_ratio(state.machine).value, damped, here);
    see_damped();
  }
  // of a mode that does not oscillate there is nothing to compare with
  return std::ranges::all_of(damped, [&](int k) { return here.damped_mode(k) != nullptr; });
}

const control::ControllerParameters* Problem::controller(const model::NamedPose& pose) const {
  const auto known = targets_.controllers.find(pose.name);
  return known == targets_.controllers.end() ? nullptr : &known->second;
}

Observation Problem::see(const model::Machine& machine, std::size_t point) const {
  const auto& pose = machine.poses.at(places_[point].pose);
  return observe(machine, pose.X_BP, kind_, targets_.observed, controller(pose));
}

ObservedSystem Problem::system(const model::Machine& machine, std::size_t point) const {
  const auto& pose = machine.poses.at(places_[point].pose);
  return observed_system(machine, pose.X_BP, kind_, targets_.observed, controller(pose));
}

bool Problem::see_all(const std::vector<double>& scales, State& state) const {
  if (state.seen_at.empty() || state.seen_at != state.values) {
    state.seen.assign(places_.size(), {});
    state.seen_at.clear();
    state.modes_at.clear();
    state.steps.clear();
    for (std::size_t p = 0; p < places_.size(); ++p) {
      state.seen[p].seen = see(state.machine, p);
      if (observes_plant() && !pair_seen(targets_.modes, targets_at(p), state.seen[p]))
        return false;
    }
    state.seen_at = state.values;
  }
  if (scales.empty() || state.steps.size() == scales.size()) return true;  // known already
  // of a relative change: far above the rounding of the plant's own differences
  constexpr double step = 1e-3;
  state.seen_below.assign(scales.size(), {});
  state.seen_above.assign(scales.size(), {});
  state.steps.clear();
  for (std::size_t j = 0; j < scales.size(); ++j)
    if (!see_beside(j, step * scales[j], state)) return false;
  return true;
}

bool Problem::see_beside(std::size_t parameter, double step, State& state) const {
  constexpr double tiny = 1e-4;  // of the step
  const auto moved_by = [&](double change) {
    std::vector<double> values = state.values;
    values[parameter] += change;
    return machine_.at(values);
  };
  const model::Machine below = moved_by(-step), above = moved_by(step);
  auto& seen_below = state.seen_below[parameter];
  auto& seen_above = state.seen_above[parameter];
  for (std::size_t p = 0; p < places_.size(); ++p) {
    if (!observes_plant()) {
      seen_below.push_back({.seen = see(below, p)});
      seen_above.push_back({.seen = see(above, p)});
      continue;
    }
    const auto& center = state.seen[p];
    const observation::Tangent tangent(center.seen, system(below, p), system(above, p), 2.0 * step);
    for (const double side : {-tiny, tiny}) {
      SeenPoint point{tangent.at(side * step), center.mode_of, center.group_of_mode};
      if (tangent.turned() && !pair_again(targets_.modes, targets_at(p), point)) return false;
      (side < 0.0 ? seen_below : seen_above).push_back(std::move(point));
    }
  }
  state.steps.push_back(observes_plant() ? tiny * step : step);
  return true;
}

bool Problem::evaluate(const Eigen::VectorXd& x, bool derivatives, State& state) const {
  state.values.resize(variables_.size());
  std::vector<double> scales;
  for (std::size_t j = 0; j < variables_.size(); ++j) {
    const double at = x[static_cast<Eigen::Index>(j)];
    state.values[j] = variables_[j].value(at);
    if (derivatives) scales.push_back(std::abs(variables_[j].slope(at)));
  }
  try {
    machine_.at(state.values, state.machine);
    if ((observes_plant() || !targets_.responses.empty()) && !see_all(scales, state)) return false;
    if (!observes_plant() && !see_modes(scales, state)) return false;
  } catch (const base::ComputationError&) {
    return false;
  } catch (const std::invalid_argument&) {  // a leg along its gimbal axis
    return false;
  }
  if (options_.hold_to_physics) add_margins(scales, state);
  return true;
}

void Problem::residuals(const Eigen::VectorXd& x, const State& state, Eigen::VectorXd& r,
                        Eigen::MatrixXd* J) const {
  int rows = 0;
  for (const auto& kind : residuals_) rows += kind->size();
  r.resize(rows);
  if (J != nullptr) J->resize(rows, size());
  int row = 0;
  for (const auto& kind : residuals_) {
    Eigen::MatrixXd part;
    kind->evaluate(*this, state, r.segment(row, kind->size()), J != nullptr ? &part : nullptr);
    if (J != nullptr) J->middleRows(row, kind->size()) = part;
    row += kind->size();
  }
  if (common_error_.any()) without_common_error(r, J);
  if (J == nullptr) return;
  for (int j = 0; j < size(); ++j) J->col(j) *= variables_[static_cast<std::size_t>(j)].slope(x[j]);
}

void Problem::without_common_error(Eigen::VectorXd& r, Eigen::MatrixXd* J) const {
  std::vector<int> rows;  // in the order of the targets
  int row = 0;
  for (const auto& kind : residuals_) {
    if (kind->is_frequency()) rows.push_back(row);
    row += kind->size();
  }
  r(rows) = common_error_.whitened(r(rows));
  if (J != nullptr) (*J)(rows, Eigen::all) = common_error_.whitened((*J)(rows, Eigen::all));
}

Eigen::VectorXd Problem::start() const {
  Eigen::VectorXd x(size());
  for (int j = 0; j < size(); ++j) {
    const auto& variable = variables_[static_cast<std::size_t>(j)];
    x[j] = variable.x(variable.start);
  }
  return x;
}

}  // namespace hydrapod::calibration
