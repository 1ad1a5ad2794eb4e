#include "hydrapod/calibration/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"

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
  all.point.domega2 = all.point.domega2(Eigen::all, kept).eval();
  all.parameters = std::move(parameters);
}

/// ω and ζ of the damped modes that the undamped ones are: the pair most alike first, every mode in
/// one pair only. Modes of equal frequency are combinations of each other.
void add_damped(const Machine& machine, ModePoint& point) {
  const auto damped =
      modal::damped_modes(point.model, point.modes, modal::modal_ratio(machine).value);
  const dynamics::ModelMatrix momenta = point.model.M * point.modes.shapes;
  const auto count = static_cast<std::size_t>(point.modes.size());
  if (damped.size() < count)
    throw base::ComputationError(fmt::format(
        "of {} modes, {} are left with the damping of these values", count, damped.size()));
  Eigen::MatrixXd alike(count, damped.size());
  for (Eigen::Index j = 0; j < alike.cols(); ++j) {
    const auto& mode = damped[static_cast<std::size_t>(j)];
    alike.col(j) = (momenta.transpose() * mode.real).cwiseAbs2() +
                   (momenta.transpose() * mode.imaginary).cwiseAbs2();
  }
  point.damped_omega.resize(count);
  point.damped_ratio.resize(count);
  for (std::size_t pair = 0; pair < count; ++pair) {
    Eigen::Index k = 0, j = 0;
    alike.maxCoeff(&k, &j);
    alike.row(k).setConstant(-1.0);
    alike.col(j).setConstant(-1.0);
    const auto& mode = damped[static_cast<std::size_t>(j)];
    point.damped_omega[static_cast<std::size_t>(k)] = mode.omega;
    point.damped_ratio[static_cast<std::size_t>(k)] = mode.damping_ratio;
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

ModePoint mode_point(const Machine& machine, std::size_t pose, dynamics::ModelKind kind) {
  ModePoint point;  // an initialiser list would set all of its 76 kB to zero
  point.model = dynamics::linear_model(machine, pose_of(machine, pose), kind);
  point.modes = modal::normal_modes(point.model);
  if (!point.modes.omega2.allFinite())
    throw base::ComputationError("the modes are not finite with these values");
  if (model::has_elastomers(machine) && kind != dynamics::ModelKind::rigid)
    add_damped(machine, point);
  return point;
}

void add_derivatives(const VariedMachine& machine, const std::vector<double>& values,
                     std::size_t pose, std::span<const double> scales, ModePoint& point) {
  point.derivatives.clear();
  point.center_derivatives.clear();
  point.against_base_derivatives.clear();
  point.derivatives.reserve(scales.size());
  point.against_base_derivatives.reserve(scales.size());
  Machine workspace;
  const auto model_of = [&](const std::vector<double>& at) {
    machine.at(at, workspace);
    return dynamics::neighbour_model(workspace, pose_of(workspace, pose), point.model);
  };
  std::vector<double> moved = values;
  Eigen::VectorXd sizes(scales.size());
  for (std::size_t j = 0; j < scales.size(); ++j) {
    const double h = relative_step * scales[j];
    moved[j] = values[j] + h;
    const auto above = model_of(moved);
    moved[j] = values[j] - h;
    const auto below = model_of(moved);
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
  result.point = mode_point(machine.at(values), pose, kind);
  add_derivatives(machine, values, pose, scales, result.point);
  const auto& modes = result.point.modes;
  result.omega = modes.omega2.cwiseMax(0.0).cwiseSqrt();
  result.percent_per_percent = result.point.domega2;
  for (int k = 0; k < modes.size(); ++k)
    for (std::size_t j = 0; j < values.size(); ++j)
      result.percent_per_percent(k, static_cast<Eigen::Index>(j)) *=
          modes.omega2[k] > 0.0 ? values[j] / (2.0 * modes.omega2[k])
                                : std::numeric_limits<double>::quiet_NaN();
  if (paths.empty()) leave_out_what_does_nothing(result);
  return result;
}

}  // namespace hydrapod::calibration
