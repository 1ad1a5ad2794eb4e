#include "hydrapod/simulation/linear_system.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "drives.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "sliding_seals.hpp"

namespace hydrapod::simulation {

namespace {

using control::ControllerParameters;
using spatial::Matrix6;
using spatial::Vector6;

constexpr double integral_ratio = 8.0;  // integral time times gain
constexpr double corner_share = 0.1;    // of the lowest oil mode

struct OilModes {
  double lowest{}, highest{};  ///< [rad/s]
};

/// ω² of the lowest mode, and of the highest of the six that move the platform most: a light base
/// vibrates far above what the controller meets, and so may a payload.
std::array<double, 2> lowest_and_highest(const dynamics::LinearModel& model) {
  const Eigen::MatrixXd M = model.M, K = model.K;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, M);
  const Eigen::MatrixXd platform = solver.eigenvectors().topRows<6>();
  const Eigen::VectorXd share =
      platform.cwiseProduct(model.platform_mass * platform).colwise().sum().transpose();
  std::vector<Eigen::Index> modes(static_cast<std::size_t>(share.size()));
  std::iota(modes.begin(), modes.end(), 0);
  std::ranges::stable_sort(modes, std::greater{}, [&](Eigen::Index k) { return share[k]; });
  const auto highest = *std::max_element(modes.begin(), modes.begin() + 6);
  return {solver.eigenvalues()[0], solver.eigenvalues()[highest]};
}

std::array<double, 2> on_still_base(const dynamics::LinearModel& model) {
  const Matrix6 M = model.M;
  const Matrix6 K = model.K;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> solver(K, M, Eigen::EigenvaluesOnly);
  return {solver.eigenvalues()[0], solver.eigenvalues()[5]};
}

OilModes oil_modes(const dynamics::LinearModel& model) {
  const auto [lowest, highest] =
      model.beyond_legs() == 0 ? on_still_base(model) : lowest_and_highest(model);
  if (!(lowest > 0.0))
    throw base::ComputationError(
        "the rigid-leg model is not stable at this pose (it has no positive lowest frequency), so "
        "the controller cannot be tuned; give controller.gain, controller.feedback_gain and "
        "controller.feedback_corner");
  return {std::sqrt(lowest), std::sqrt(highest)};
}

control::DriveAxis drive_axis(const model::Machine& machine, int leg, double oil_force) {
  if (const auto& of = machine.legs[static_cast<std::size_t>(leg)]; of.screw) {
    const auto drive = drive_of(of);
    return {.load = -oil_force, .full_speed = drive.speed_limit / drive.ratio};
  }
  const auto axis = hydraulics::servo_axis(machine, leg);
  const auto& supply = machine.hydraulics.supply;
  return {.piston_area = axis.area.piston,
          .annulus_area = axis.area.annulus,
          .flow_coefficient = axis.valve.gain,
          .supply_pressure = supply.pressure,
          .return_pressure = supply.return_pressure,
          .overlap = axis.valve.overlap,
          .load = -oil_force +
                  hydraulics::atmospheric_pressure * (axis.area.piston - axis.area.annulus)};
}

double smallest_above_zero(const Vector6& gains) {
  double smallest = 0.0;
  for (int i = 0; i < 6; ++i)
    if (gains[i] > 0.0 && (smallest == 0.0 || gains[i] < smallest)) smallest = gains[i];
  return smallest;
}

}  // namespace

Tuning tune_controller(const model::Machine& machine, const spatial::Pose& X_BP) {
  const auto linear =
      dynamics::linear_model(with_sliding_seals(machine), X_BP, dynamics::ModelKind::rigid);
  const auto& settings = machine.controller;
  const bool screws = model::leg_type(machine) == model::LegType::screw;
  const auto modes = oil_modes(linear);
  const double omega = modes.lowest;
  const bool pressure = settings.feedback == model::DampingFeedback::pressure && !screws;
  const double bandwidth = settings.bandwidth.value_or(
      omega * (pressure ? model::ControlSettings::default_bandwidth_share
                        : model::ControlSettings::default_bandwidth_share_undamped));
  ControllerParameters p;
  p.space = settings.space;
  p.gain = settings.gain.value_or(Vector6::Constant(bandwidth));
  const double smallest = smallest_above_zero(p.gain);
  p.integral_time =
      settings.integral_time.value_or(smallest > 0.0 ? integral_ratio / smallest : 0.0);
  p.velocity_feedforward = settings.velocity_feedforward;
  // an electric cylinder has no pressures: its speed loop damps, and holds the speed at any load
  p.feedback = pressure || settings.feedback == model::DampingFeedback::acceleration
                   ? settings.feedback
                   : model::DampingFeedback::none;
  p.feedback_corner = settings.feedback_corner.value_or(corner_share * omega);
  p.sample_time = settings.sample_time;
  p.delay = settings.delay;
  p.compensation = screws ? model::Compensation::none : settings.compensation;
  p.overlap_compensation = settings.overlap_compensation;
  p.output = settings.output;
  for (int i = 0; i < model::leg_count; ++i) {
    const double oil = pressure ? omega / linear.legs[i].k_h : 1.0 / modes.highest;
    p.feedback_gain[i] = settings.feedback_gain.value_or(2.0 * settings.feedback_damping * oil);
    p.axes[i] = drive_axis(machine, i, linear.statics.legs[i].oil_force);
  }
  return {p, omega};
}

}  // namespace hydrapod::simulation
