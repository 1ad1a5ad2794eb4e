#include "amplitudes.hpp"

#include <algorithm>
#include <cmath>

namespace hydrapod::calibration {

namespace {

std::optional<modal::DampedMode> as_damped(const modal::ModeAtAmplitude& at, int group) {
  const double zeta = at.damping_ratio;
  if (!at.converged || !(std::abs(zeta) < 1.0)) return std::nullopt;
  const std::complex<double> pole(-zeta * at.omega, at.omega * std::sqrt(1.0 - zeta * zeta));
  return modal::DampedMode{.pole = pole,
                           .omega = at.omega,
                           .damping_ratio = zeta,
                           .stable = zeta >= 0.0,
                           .real = at.shape,
                           .imaginary = dynamics::ModelVector::Zero(at.shape.size()),
                           .group = group};
}

}  // namespace

bool has_amplitudes(const observation::Targets& targets) {
  return std::ranges::any_of(targets.modes, [](const auto& mode) { return mode.amplitude > 0.0; });
}

bool acts_at_amplitudes(const model::ParameterId& id) {
  const std::string_view path = model::row_of(id).path;
  return (path.starts_with("legs.friction.") || path.starts_with("legs.joint_friction.")) &&
         !path.ends_with(".viscous");
}

bool moves_platform(const ModePoint& point, int mode) {
  const spatial::Vector6 v = point.modes.shapes.col(mode).head<6>();  // of φᵀ M φ = 1
  return v.dot(point.model.platform_mass * v) >= modal::AmplitudeOptions{}.least_platform;
}

void add_at_amplitude(const model::Machine& machine, std::size_t pose, double amplitude,
                      ModePoint& point) {
  std::vector<int> modes;
  std::vector<modal::SwingStart> starts;
  for (int k = 0; k < point.modes.size(); ++k) {
    if (!(point.modes.omega2[k] > 0.0) || !moves_platform(point, k)) continue;
    modes.push_back(k);
    starts.push_back({amplitude, point.modes.shapes.col(k)});
  }
  const auto found =
      modal::balances_at(machine, machine.poses.at(pose).X_BP, point.model.kind, starts);
  point.damped.assign(static_cast<std::size_t>(point.modes.size()), {});
  for (std::size_t i = 0; i < modes.size(); ++i)
    point.damped[static_cast<std::size_t>(modes[i])] =
        as_damped(found[i], point.modes.group[static_cast<std::size_t>(modes[i])]);
}

bool add_amplitude_derivatives(const VariedMachine& machine, const std::vector<double>& values,
                               std::size_t pose, double amplitude, std::span<const double> scales,
                               const std::vector<int>& modes, ModePoint& point) {
  constexpr double step = 1e-4;  // balances are exact to 1e-11
  const auto count = static_cast<Eigen::Index>(scales.size());
  point.dpole_omega.setZero(point.modes.size(), count);
  point.dpole_ratio.setZero(point.modes.size(), count);
  std::vector<int> balanced;
  std::vector<modal::SwingStart> starts;
  for (const int k : modes) {
    const auto* at = point.damped_mode(k);
    if (at == nullptr) continue;
    balanced.push_back(k);
    starts.push_back({amplitude, at->real});
  }
  std::vector<double> moved = values;
  model::Machine workspace;
  const auto balances = [&](std::size_t parameter, double value) {
    moved[parameter] = value;
    machine.at(moved, workspace);
    moved[parameter] = values[parameter];
    return modal::balances_at(workspace, workspace.poses.at(pose).X_BP, point.model.kind, starts);
  };
  for (std::size_t j = 0; j < scales.size(); ++j) {
    const double h = step * scales[j];
    const auto above = balances(j, values[j] + h), below = balances(j, values[j] - h);
    for (std::size_t i = 0; i < balanced.size(); ++i) {
      if (!above[i].converged || !below[i].converged) return false;
      const auto slope = [&](double modal::ModeAtAmplitude::*of) {
        return (above[i].*of - below[i].*of) / (2.0 * h);
      };
      const auto column = static_cast<Eigen::Index>(j);
      point.dpole_omega(balanced[i], column) = slope(&modal::ModeAtAmplitude::omega);
      point.dpole_ratio(balanced[i], column) = slope(&modal::ModeAtAmplitude::damping_ratio);
    }
  }
  return true;
}

}  // namespace hydrapod::calibration
