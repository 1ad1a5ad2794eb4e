#include "hydrapod/calibration/sensitivity.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::calibration {

namespace {

using model::Machine;

/// A parameter far from its bounds may take a machine where numbers are no longer finite.
void require_finite(const Machine& machine) {
  for (const auto& leg : machine.legs)
    if (!leg.base_joint.allFinite() || !leg.platform_joint.allFinite() ||
        !leg.gimbal_axis.allFinite())
      throw base::ComputationError("the joints' places are not finite with these values");
}

/// The machine with these values, into `workspace`, and its pose.
const spatial::Pose& pose_at(const model::VariableMachine& machine,
                             const std::vector<double>& values, std::size_t pose,
                             Machine& workspace) {
  machine.machine(values, workspace);
  require_finite(workspace);
  return workspace.poses.at(pose).X_BP;
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

}  // namespace

ModePoint mode_point(const model::VariableMachine& machine, const std::vector<double>& values,
                     std::size_t pose, dynamics::ModelKind kind, std::span<const double> scales,
                     const dynamics::StaticEquilibrium* start) {
  Machine workspace = machine.machine(values);
  const auto& X_BP = pose_at(machine, values, pose, workspace);
  ModePoint point{.model = dynamics::linear_model(workspace, X_BP, kind, start)};
  point.modes = modal::normal_modes(point.model);
  if (!point.modes.omega2.allFinite())
    throw base::ComputationError("the modes are not finite with these values");
  if (!scales.empty()) add_derivatives(machine, values, pose, scales, point);
  return point;
}

void add_derivatives(const model::VariableMachine& machine, const std::vector<double>& values,
                     std::size_t pose, std::span<const double> scales, ModePoint& point) {
  point.derivatives.clear();
  point.center_derivatives.clear();
  point.against_base_derivatives.clear();
  Machine workspace = machine.machine(values);
  const auto model_of = [&](const std::vector<double>& at) {
    const auto& X_BP = pose_at(machine, at, pose, workspace);
    return dynamics::neighbour_model(workspace, X_BP, point.model);
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
    point.center_derivatives.push_back((above.p_BC - below.p_BC) / (2.0 * h));
    point.against_base_derivatives.push_back((above.against_base - below.against_base) / (2.0 * h));
    sizes[static_cast<Eigen::Index>(j)] = scales[j];
  }
  modal::turn_repeated(point.modes, point.derivatives, sizes);
  point.domega2 = modal::omega2_derivatives(point.modes, point.derivatives);
}

Sensitivities sensitivities(const model::MachineFile& file, std::size_t pose,
                            dynamics::ModelKind kind, const std::vector<std::string>& paths) {
  model::VariableMachine machine(file);
  std::vector<model::TiedPaths> chosen;
  for (const auto& number : machine.numbers())
    if (paths.empty() && number.given && number.value != 0.0) chosen.push_back({number.path});
  for (const auto& path : paths) chosen.push_back({path});
  machine.vary(chosen);
  Sensitivities result;
  std::vector<model::TiedPaths> that_matter;
  for (std::size_t j = 0; j < chosen.size(); ++j)
    if (!paths.empty() || machine.matters(j)) {
      that_matter.push_back(chosen[j]);
      result.parameters.push_back(*machine.find(chosen[j].front()));
    }
  machine.vary(that_matter);
  std::vector<double> scales;
  for (const double value : machine.values())
    scales.push_back(value != 0.0 ? std::abs(value) : 1.0);
  result.point = mode_point(machine, machine.values(), pose, kind, scales);
  const auto& modes = result.point.modes;
  result.omega = modes.omega2.cwiseMax(0.0).cwiseSqrt();
  result.percent_per_percent = result.point.domega2;
  for (int k = 0; k < modes.size(); ++k)
    for (std::size_t j = 0; j < that_matter.size(); ++j)
      result.percent_per_percent(k, static_cast<Eigen::Index>(j)) *=
          modes.omega2[k] > 0.0 ? machine.values()[j] / (2.0 * modes.omega2[k])
                                : std::numeric_limits<double>::quiet_NaN();
  if (paths.empty()) leave_out_what_does_nothing(result);
  return result;
}

}  // namespace hydrapod::calibration
