#include "hydrapod/calibration/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "poles.hpp"

namespace hydrapod::calibration {

namespace {

using model::Machine;

/// The pose of that number. A parameter far from its bounds may take a machine where numbers are no
/// longer finite: throws base::ComputationError.
const spatial::Pose& pose_of(const Machine& machine, std::size_t pose) {
  for (const auto& leg : machine.legs)
    if (!leg.base_joint.allFinite() || !leg.platform_joint.allFinite() ||
        !leg.gimbal_axis.allFinite())
      throw base::ComputationError("the joints' places are not finite with these values");
  return machine.poses.at(pose).X_BP;
}

/// Dampers, for instance.
void leave_out_what_does_nothing(Sensitivities& all) {
  constexpr double nothing = 1e-9;
  std::vector<Eigen::Index> kept;
  std::vector<model::FileNumber> parameters;
  for (Eigen::Index j = 0; j < all.percent_per_percent.cols(); ++j) {
    const auto column = all.percent_per_percent.col(j).array();
    if (!(column.abs() >= nothing).any() && !column.isNaN().any()) continue;
    kept.push_back(j);
    parameters.push_back(all.parameters[static_cast<std::size_t>(j)]);
  }
  all.percent_per_percent = all.percent_per_percent(Eigen::all, kept).eval();
  all.parameters = std::move(parameters);
}

/// Are the undamped modes those of seals whose arms have rigid dampers?
bool has_seal_arms(const Machine& machine, const ModePoint& point) {
  return model::has_elastomers(machine) && point.model.kind != dynamics::ModelKind::rigid;
}

/// ω and dω/dp of the damped modes where damping shifts them. Overdamped modes keep the undamped
/// ω, their derivatives are NaN.
void add_shifted(double modal_ratio, ModePoint& point, Eigen::VectorXd& omega,
                 Eigen::MatrixXd& slopes) {
  if (!is_shifted_by_damping(point.model)) return;
  if (point.damped.empty()) add_damped(modal_ratio, point);
  add_pole_derivatives(modal_ratio, point);
  for (int k = 0; k < point.modes.size(); ++k) {
    if (!(point.modes.omega2[k] > 0.0)) continue;
    if (const auto* mode = point.damped_mode(k)) {
      omega[k] = mode->omega;
      slopes.row(k) = point.dpole_omega.row(k);
    } else {
      slopes.row(k).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
}

}  // namespace

std::vector<double> VariedMachine::values() const {
  std::vector<double> values;
  for (const auto& ids : parameters) values.push_back(value(machine, ids.front()).value());
  return values;
}

Machine VariedMachine::at(const std::vector<double>& values) const {
  Machine result;
  at(values, result);
  return result;
}

void VariedMachine::at(const std::vector<double>& values, Machine& result) const {
  result = machine;
  std::vector<model::Assignment> assignments;
  for (std::size_t j = 0; j < parameters.size(); ++j)
    for (const auto& id : parameters[j]) assignments.push_back({id, values[j]});
  assign(result, assignments);
}

const modal::DampedMode* ModePoint::damped_mode(int mode) const {
  const auto k = static_cast<std::size_t>(mode);
  return damped.empty() || !damped[k] ? nullptr : &*damped[k];
}

double ModePoint::omega(int mode) const {
  if (const auto* own = damped_mode(mode)) return own->omega;
  return std::copysign(std::sqrt(std::abs(modes.omega2[mode])), modes.omega2[mode]);
}

ModePoint mode_point(const Machine& machine, std::size_t pose, dynamics::ModelKind kind) {
  ModePoint point;  // an initialiser list would set all of its 76 kB to zero
  point.model = dynamics::linear_model(machine, pose_of(machine, pose), kind);
  point.modes = modal::normal_modes(point.model);
  if (!point.modes.omega2.allFinite())
    throw base::ComputationError("the modes are not finite with these values");
  if (has_seal_arms(machine, point)) add_damped(modal::modal_ratio(machine).value, point);
  return point;
}

void add_derivatives(const VariedMachine& machine, const std::vector<double>& values,
                     std::size_t pose, std::span<const double> scales, ModePoint& point) {
  point.derivatives.clear();
  point.ratio_derivatives.clear();
  point.center_derivatives.clear();
  point.against_base_derivatives.clear();
  point.derivatives.reserve(scales.size());
  point.against_base_derivatives.reserve(scales.size());
  Machine workspace;
  double ratio = 0.0;
  const auto model_of = [&](const std::vector<double>& at) {
    machine.at(at, workspace);
    ratio = modal::modal_ratio(workspace).value;
    return dynamics::neighbour_model(workspace, pose_of(workspace, pose), point.model);
  };
  std::vector<double> moved = values;
  Eigen::VectorXd sizes(scales.size());
  for (std::size_t j = 0; j < scales.size(); ++j) {
    const double h = relative_step * scales[j];
    moved[j] = values[j] + h;
    const auto above = model_of(moved);
    const double ratio_above = ratio;
    moved[j] = values[j] - h;
    const auto below = model_of(moved);
    point.ratio_derivatives.push_back((ratio_above - ratio) / (2.0 * h));
    moved[j] = values[j];
    point.derivatives.push_back({(above.M - below.M) / (2.0 * h), (above.K - below.K) / (2.0 * h),
                                 (above.C - below.C) / (2.0 * h)});
    if (!above.arms.empty()) {
      auto& derivative = point.derivatives.back();
      derivative.arms_above = above.arms;
      derivative.arms_below = below.arms;
      derivative.step = h;
    }
    point.center_derivatives.push_back((above.p_BC - below.p_BC) / (2.0 * h));
    point.against_base_derivatives.push_back((above.against_base - below.against_base) / (2.0 * h));
    sizes[static_cast<Eigen::Index>(j)] = scales[j];
  }
  modal::turn_repeated(point.modes, point.derivatives, sizes);
  if (point.repeats() && !point.damped.empty()) {  // the modes have turned
    point.damped.clear();
    const auto center = machine.at(values);
    if (has_seal_arms(center, point)) add_damped(modal::modal_ratio(center).value, point);
  }
  point.domega2 = modal::omega2_derivatives(point.modes, point.derivatives);
}

Sensitivities sensitivities(const model::MachineFile& file, std::size_t pose,
                            dynamics::ModelKind kind, const std::vector<std::string>& paths) {
  Sensitivities result;
  auto& parameters = result.parameters;
  for (const auto& path : paths) {
    const auto number = find_number(file, path);
    if (!number)
      throw std::invalid_argument(fmt::format("the machine file has no number `{}`", path));
    parameters.push_back(*number);
  }
  // an element of a tensor in rows is given twice
  const auto known = [&](const model::ParameterId& id) {
    return std::ranges::count(parameters, id, &model::FileNumber::id) > 0;
  };
  for (const auto& given : file.given)
    if (paths.empty() && of_mechanics(file.machine, given.id) && !known(given.id))
      if (const auto number = number_of(file, given.id); number && number->value != 0.0)
        parameters.push_back(*number);
  VariedMachine machine{.machine = file.machine};
  std::vector<double> scales;
  for (const auto& number : parameters) {
    machine.parameters.push_back({number.id});
    scales.push_back(number.value != 0.0 ? std::abs(number.value) : 1.0);
  }
  const auto values = machine.values();
  auto point = mode_point(machine.at(values), pose, kind);
  add_derivatives(machine, values, pose, scales, point);
  const auto& modes = point.modes;
  result.omega = modes.omega2.cwiseMax(0.0).cwiseSqrt();
  result.percent_per_percent = point.domega2;
  for (int k = 0; k < modes.size(); ++k)
    result.percent_per_percent.row(k) *= modes.omega2[k] > 0.0
                                             ? 1.0 / (2.0 * result.omega[k])
                                             : std::numeric_limits<double>::quiet_NaN();
  add_shifted(modal::modal_ratio(machine.machine).value, point, result.omega,
              result.percent_per_percent);
  for (int k = 0; k < modes.size(); ++k)
    for (std::size_t j = 0; j < values.size(); ++j)
      result.percent_per_percent(k, static_cast<Eigen::Index>(j)) *= values[j] / result.omega[k];
  std::vector<int> order(static_cast<std::size_t>(modes.size()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int k) {
    const bool is_overdamped = result.omega[k] > 0.0 && !parameters.empty() &&
                               std::isnan(result.percent_per_percent(k, 0));
    return std::pair(is_overdamped, result.omega[k]);
  });
  result.omega = result.omega(order).eval();
  result.percent_per_percent = result.percent_per_percent(order, Eigen::all).eval();
  if (paths.empty()) leave_out_what_does_nothing(result);
  return result;
}

}  // namespace hydrapod::calibration
