// Identified modes as targets.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/model/parameters.hpp"
#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::observation {

namespace {

using spatial::Matrix6;
using Complex = std::complex<double>;

/// One mode by its motion in the directions x … rz; NaN where it was not measured.
struct MeasuredShape {
  Vector6c motion{Vector6c::Constant(std::numeric_limits<double>::quiet_NaN())};
  Vector6 deviation{Vector6::Zero()};
};

const model::NamedPose& pose_of(const model::Machine& machine, const std::string& name) {
  if (const auto* pose = find_pose(machine, name)) return *pose;
  throw base::InputError(
      {{.key = "pose", .message = fmt::format("the machine has no pose \"{}\"", name)}});
}

MeasuredShape directions_of(const data::ModalResult& mode,
                            const std::vector<data::Channel>& outputs) {
  MeasuredShape measured;
  for (std::size_t o = 0; o < outputs.size(); ++o) {
    const int code = static_cast<int>(outputs[o].direction), k = std::abs(code) - 1;
    if (code == 0 || k > 5) continue;
    const auto row = static_cast<Eigen::Index>(o);
    measured.motion[k] = (code < 0 ? -1.0 : 1.0) * mode.shape[row];
    if (mode.shape_deviation.size() > 0) measured.deviation[k] = mode.shape_deviation[row];
  }
  return measured;
}

/// Turned so that the sum of the squares of the real parts, weighted, is largest.
Vector6c turned(const Vector6c& motion, const Vector6& weights) {
  Complex sum = 0.0;
  for (int k = 0; k < 6; ++k)
    if (!std::isnan(motion[k].real())) sum += weights[k] * motion[k] * motion[k];
  return motion * std::polar(1.0, -0.5 * std::arg(sum));
}

/// What the modal model lacks makes of a frequency [rad/s].
double model_error(const data::ModalResult& mode, const Vector6c& motion, const Vector6& weights,
                   double line_spacing, bool in_flank) {
  constexpr double leakage = 0.05;  // of the line spacing
  constexpr double flank = 0.5;     // of the half width
  std::vector<Complex> parts;
  for (int k = 0; k < 6; ++k)
    if (!std::isnan(motion[k].real())) parts.push_back(std::sqrt(weights[k]) * motion[k]);
  const Eigen::Map<const Eigen::VectorXcd> shape(parts.data(),
                                                 static_cast<Eigen::Index>(parts.size()));
  const double mixed = parts.empty() ? 0.0 : 1.0 - data::modal_phase_collinearity(shape);
  const double half_width = -mode.pole.real();
  return std::hypot(leakage * base::two_pi * line_spacing, mixed * half_width,
                    in_flank ? flank * half_width : 0.0);
}

/// Is it a weak mode in the flank of another?
bool in_flank(const data::ModalResult& weak, const std::vector<data::ModalResult>& modes) {
  constexpr double much_more = 10.0;
  return std::ranges::any_of(modes, [&](const data::ModalResult& strong) {
    return strong.significance > much_more * weak.significance &&
           std::abs(strong.omega() - weak.omega()) < -strong.pole.real() - weak.pole.real();
  });
}

/// Fills in the direction and, where all six are known, the shape.
void add_shape(const MeasuredShape& measured, double significance, const model::Machine& machine,
               const spatial::Pose& X_BP, const MeasuredAt& at, ModeTarget& target) {
  const Matrix6 root = platform_metric(machine, X_BP, at.point), M = root.transpose() * root;
  const Vector6c motion = turned(measured.motion, M.diagonal());
  Vector6 shape = motion.real(), lost = Vector6::Zero();
  int known = 0;
  for (int k = 0; k < 6; ++k) {
    const bool is_known = !std::isnan(shape[k]);
    known += is_known ? 1 : 0;
    if (is_known) lost[k] = std::hypot(measured.deviation[k], motion[k].imag());
    if (!is_known) shape[k] = 0.0;
  }
  if (known == 0) return;
  target.direction = known == 6 ? main_direction(machine, X_BP, at.point, shape)
                                : main_direction(Matrix6(M.diagonal().asDiagonal()), shape);
  if (known < 6) return;
  target.shape = shape;
  target.shape_point = at.point;
  target.shape_against = *at.against;
  const double hidden = significance > 0.0 ? 2.0 / std::sqrt(significance) : 0.0;
  const auto deviation = [&](const Vector6& error, double size) {
    return std::hypot(std::sqrt(error.cwiseAbs2().dot(M.diagonal()) / size), hidden);
  };
  target.shape_deviation = deviation(lost, shape.dot(M * shape));
  target.complex_shape = {
      motion, deviation(measured.deviation, (root.cast<Complex>() * motion).squaredNorm())};
}

}  // namespace

int main_direction(const Matrix6& mass, const Vector6& motion) {
  Eigen::Index main = 0;
  motion.cwiseProduct(mass * motion).maxCoeff(&main);
  return static_cast<int>(main);
}

int main_direction(const model::Machine& machine, const spatial::Pose& X_BP,
                   const spatial::Vector3& p_PQ, const Vector6& motion) {
  const auto& center = machine.platform.mass_center;
  const Matrix6 root = platform_metric(machine, X_BP, center);
  Vector6 at_center = motion;
  at_center.head<3>() += motion.tail<3>().cross(X_BP.R_BP * (center - p_PQ));
  return main_direction(root.transpose() * root, at_center);
}

MotionAgainst motion_against(const std::vector<data::Channel>& outputs) {
  const auto from_base = [](const data::Channel& output) {
    const int code = std::abs(static_cast<int>(output.direction));
    return code >= 1 && code <= 6 && !data::against_ground(output);
  };
  return std::ranges::any_of(outputs, from_base) ? MotionAgainst::base : MotionAgainst::ground;
}

bool from_drives(const std::vector<data::Channel>& inputs) {
  return !inputs.empty() && std::ranges::all_of(inputs, [](const auto& input) {
    return input.role == data::Role::drive;
  });
}

Targets measured_modes(const data::ModalResults& identified, const model::Machine& machine,
                       const MeasuredAt& where) {
  if (identified.modes.empty())
    throw base::InputError({{.message = "no mode was found in the measurement"}});
  auto at = where;
  if (!at.against) at.against = motion_against(identified.outputs);
  Targets targets{.title = "identified modes",
                  .observed = at.observed.value_or(
                      from_drives(identified.inputs) ? Observed::plant : Observed::mechanics)};
  const auto& X_BP = pose_of(machine, at.pose).X_BP;
  const Matrix6 root = platform_metric(machine, X_BP, at.point);
  const Vector6 weights = (root.transpose() * root).diagonal();
  for (const auto& mode : identified.modes) {
    const auto measured = directions_of(mode, identified.outputs);
    ModeTarget target{
        .name = fmt::format("{:.3f} Hz", mode.omega() / base::two_pi),
        .pose = at.pose,
        .omega = mode.omega(),
        .damped = true,
        .deviation = std::hypot(mode.omega_deviation,
                                model_error(mode, measured.motion, weights, identified.line_spacing,
                                            in_flank(mode, identified.modes)))};
    if (mode.damping_ratio() > 0.0 && mode.damping_deviation > 0.0) {
      target.damping = mode.damping_ratio();
      target.damping_deviation = mode.damping_deviation;
    }
    add_shape(measured, mode.significance, machine, X_BP, at, target);
    targets.modes.push_back(target);
  }
  return targets;
}

}  // namespace hydrapod::observation
