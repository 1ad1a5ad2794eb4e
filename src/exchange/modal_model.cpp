#include <fmt/format.h>

#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/response/frequency_response.hpp"

namespace hydrapod::exchange {

namespace {

using data::Direction;
using Eigen::Index;

constexpr int center_node = 1, first_platform_node = 11, first_base_node = 21;

/// Rows that take the platform's coordinates at C to the motion at every output.
struct Outputs {
  std::vector<data::Channel> channels{};
  std::vector<Eigen::Matrix<double, 1, 6>> rows{};

  void add(int node, const Vector3& from_center, int count) {
    spatial::Matrix6 T = spatial::Matrix6::Identity();
    T.topRightCorner<3, 3>() = -spatial::skew(from_center);
    for (int d = 0; d < count; ++d) {
      channels.push_back(
          {.name = fmt::format("node {} {}", node,
                               spatial::direction_names[static_cast<std::size_t>(d)]),
           .unit = d < 3 ? "m" : "rad",
           .direction = static_cast<Direction>(d + 1),
           .role = data::Role::response,
           .point = node});
      rows.emplace_back(T.row(d));
    }
  }
};

data::Geometry wire_frame(const Machine& machine, const Pose& X_BP, const Vector3& p_BC) {
  data::Geometry geometry;
  geometry.nodes.push_back({.number = center_node, .position = p_BC});
  data::TraceLine platform{.name = "platform"}, base{.name = "base"}, legs{.name = "legs"};
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[static_cast<std::size_t>(i)];
    geometry.nodes.push_back(
        {.number = first_platform_node + i, .position = X_BP * leg.platform_joint});
    geometry.nodes.push_back({.number = first_base_node + i, .position = leg.base_joint});
    platform.nodes.push_back(first_platform_node + i);
    base.nodes.push_back(first_base_node + i);
    legs.nodes.insert(legs.nodes.end(), {first_base_node + i, first_platform_node + i, 0});
  }
  platform.nodes.push_back(first_platform_node);
  base.nodes.push_back(first_base_node);
  geometry.lines = {platform, base, legs};
  return geometry;
}

Eigen::VectorXcd full_shape(const modal::DampedMode& mode) {
  Eigen::VectorXcd shape(mode.real.size());
  shape.real() = mode.real;
  shape.imag() = mode.imaginary;
  return shape;
}

/// Do complex modes share a pole? Their shapes are then any mix, and residues do not belong to one.
bool mixed(const std::vector<modal::DampedMode>& modes) {
  for (std::size_t k = 1; k < modes.size(); ++k)
    if (modes[k].is_complex() && modes[k].group == modes[k - 1].group) return true;
  return false;
}

}  // namespace

data::ModalResults modal_model(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                               const FileHead& head) {
  const auto linear = dynamics::linear_model(machine, X_BP, kind);
  const auto normal = modal::normal_modes(linear);
  const auto damped = modal::damped_modes(linear, normal, model::modal_ratio(machine).value);
  Outputs outputs;
  outputs.add(center_node, Vector3::Zero(), 6);
  for (int i = 0; i < model::leg_count; ++i)
    outputs.add(first_platform_node + i,
                X_BP * machine.legs[static_cast<std::size_t>(i)].platform_joint - linear.p_BC, 3);
  data::ModalResults results{.title = head.title, .date = head.date, .outputs = outputs.channels};
  results.geometry = wire_frame(machine, X_BP, linear.p_BC);
  for (int d = 0; d < 6; ++d) {
    auto channel = outputs.channels[static_cast<std::size_t>(d)];
    channel.name = fmt::format("force {}", spatial::direction_names[static_cast<std::size_t>(d)]);
    channel.unit = d < 3 ? "N" : "N m";
    channel.role = data::Role::excitation;
    results.inputs.push_back(std::move(channel));
  }
  const Eigen::MatrixXd M = linear.M, C = response::damping_matrix(response::response_model(
                                          linear, normal, model::modal_ratio(machine).value,
                                          machine.platform.mass_center));
  const auto rows = static_cast<Index>(outputs.rows.size());
  for (const auto& mode : damped) {
    if (!mode.stable || mode.damping_ratio >= 1.0)
      throw base::ComputationError(
          "a mode does not oscillate at this pose (unstable or overdamped); a table of modes "
          "cannot hold it");
    data::ModalResult result{.pole = mode.pole, .shape = Eigen::VectorXcd(rows)};
    const Eigen::VectorXcd phi = full_shape(mode).head(6);
    for (Index r = 0; r < rows; ++r)
      result.shape[r] = outputs.rows[static_cast<std::size_t>(r)] * phi;
    // Residue of the symmetric (λ² M + λ C + K)⁻¹ at its pole: φ φᵀ / φᵀ(2 λ M + C) φ.
    const Eigen::VectorXcd whole = full_shape(mode);
    std::complex<double> norm = (whole.transpose() * (2.0 * mode.pole * M + C) * whole).value();
    for (const auto& arm : linear.arms) {  // −κ λ/(s + λ) s_y s_yᵀ of the chambers
      const std::complex<double> beside = mode.pole + arm.rate;
      const Eigen::VectorXd s_y = arm.s_y;
      norm += arm.stiffness * arm.rate / (beside * beside) *
              std::pow((s_y.transpose() * whole).value(), 2);
    }
    result.participation = phi / norm;
    results.modes.push_back(std::move(result));
  }
  if (mixed(damped)) {
    results.inputs.clear();
    for (auto& mode : results.modes) mode.participation.resize(0);
  }
  for (const auto& mode : results.modes) results.to = std::max(results.to, mode.omega());
  results.to /= base::two_pi;
  return results;
}

}  // namespace hydrapod::exchange
