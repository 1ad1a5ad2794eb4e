#include "hydrapod/diagnosis/measured.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/diagnosis/resonances.hpp"
#include "hydrapod/identification/directions.hpp"

namespace hydrapod::diagnosis {

namespace {

using spatial::Matrix6;
using spatial::Vector6;

/// Mass of the platform for motions of Q, in base axes.
Matrix6 mass_at(const model::Machine& machine, const model::NamedPose& pose,
                const spatial::Vector3& p_PQ) {
  const auto& R = pose.X_BP.R_BP;
  Matrix6 M = Matrix6::Zero();
  M.topLeftCorner<3, 3>().diagonal().setConstant(machine.platform.mass);
  M.bottomRightCorner<3, 3>() = R * machine.platform.inertia * R.transpose();
  Matrix6 to_center = Matrix6::Identity();
  to_center.topRightCorner<3, 3>() = -spatial::skew(R * (machine.platform.mass_center - p_PQ));
  return to_center.transpose() * M * to_center;
}

const model::NamedPose& pose_of(const model::Machine& machine, const std::string& name) {
  for (const auto& pose : machine.poses)
    if (pose.name == name) return pose;
  throw base::InputError(
      {{.key = "pose", .message = fmt::format("the machine has no pose \"{}\"", name)}});
}

/// Turned so that the sum of the squares of the real parts, weighted, is largest.
std::array<std::complex<double>, 6> turned(const std::array<std::complex<double>, 6>& motion,
                                           const Vector6& weights) {
  std::complex<double> sum = 0.0;
  for (int k = 0; k < 6; ++k)
    if (!std::isnan(motion[k].real())) sum += weights[k] * motion[k] * motion[k];
  const auto turn = std::polar(1.0, -0.5 * std::arg(sum));
  auto result = motion;
  for (auto& value : result) value *= turn;
  return result;
}

/// What the modal model lacks makes of a frequency [rad/s].
double model_error(const MeasuredShape& measured, const Vector6& weights) {
  constexpr double leakage = 0.05;  // of the line spacing
  constexpr double flank = 0.5;     // of the half width
  std::vector<std::complex<double>> parts;
  for (int k = 0; k < 6; ++k)
    if (!std::isnan(measured.motion[k].real()))
      parts.push_back(std::sqrt(weights[k]) * measured.motion[k]);
  const Eigen::Map<const Eigen::VectorXcd> shape(parts.data(),
                                                 static_cast<Eigen::Index>(parts.size()));
  const double mixed = parts.empty() ? 0.0 : 1.0 - identification::modal_phase_collinearity(shape);
  const double half_width = measured.damping * measured.omega;
  return std::hypot(leakage * measured.line_spacing, mixed * half_width,
                    measured.in_flank ? flank * half_width : 0.0);
}

/// Says which modes are weak ones in the flank of another.
void find_flanks(std::vector<MeasuredShape>& modes) {
  constexpr double much_more = 10.0;
  for (auto& weak : modes)
    weak.in_flank = std::ranges::any_of(modes, [&](const MeasuredShape& strong) {
      return strong.significance > much_more * weak.significance &&
             std::abs(strong.omega - weak.omega) <
                 strong.damping * strong.omega + weak.damping * weak.omega;
    });
}

}  // namespace

observation::MotionAgainst motion_against(const std::vector<data::Channel>& outputs) {
  const auto from_base = [](const data::Channel& output) {
    const int code = std::abs(static_cast<int>(output.direction));
    return code >= 1 && code <= 6 && !identification::against_ground(output);
  };
  return std::ranges::any_of(outputs, from_base) ? observation::MotionAgainst::base
                                                 : observation::MotionAgainst::ground;
}

observation::ModeTarget mode_target(const MeasuredShape& measured, const std::string& name,
                                    const model::Machine& machine, const MeasuredAt& at) {
  observation::ModeTarget target{.name = name,
                                 .pose = at.pose,
                                 .omega = measured.omega,
                                 .deviation = measured.omega_deviation};
  if (measured.damping > 0.0 && measured.damping_deviation > 0.0) {
    target.damping = measured.damping;
    target.damping_deviation = measured.damping_deviation;
  }
  const Matrix6 M = mass_at(machine, pose_of(machine, at.pose), at.point);
  target.deviation = std::hypot(target.deviation, model_error(measured, M.diagonal()));
  const auto motion = turned(measured.motion, M.diagonal());
  Vector6 shape = Vector6::Zero(), lost = Vector6::Zero(), noise = Vector6::Zero();
  observation::Vector6c as_measured = observation::Vector6c::Zero();
  int known = 0;
  for (int k = 0; k < 6; ++k) {
    if (std::isnan(motion[k].real())) continue;
    ++known;
    shape[k] = motion[k].real();
    noise[k] = measured.motion_deviation[k];
    lost[k] = std::hypot(noise[k], motion[k].imag());
    as_measured[k] = motion[k];
  }
  if (known == 0) return target;
  Eigen::Index main = 0;
  const Vector6 energy = known == 6 ? Vector6(shape.cwiseProduct(M * shape))
                                    : Vector6(shape.cwiseAbs2().cwiseProduct(M.diagonal()));
  energy.maxCoeff(&main);
  target.direction = static_cast<int>(main);
  if (known < 6) return target;
  target.shape = shape;
  target.shape_point = at.point;
  if (at.against) target.shape_against = *at.against;
  const double hidden = measured.significance > 0.0 ? 2.0 / std::sqrt(measured.significance) : 0.0;
  const auto deviation = [&](const Vector6& error, double size) {
    return std::hypot(std::sqrt(error.cwiseAbs2().dot(M.diagonal()) / size), hidden);
  };
  target.shape_deviation = deviation(lost, shape.dot(M * shape));
  const observation::Vector6c momentum = M.cast<std::complex<double>>() * as_measured;
  target.complex_shape = {as_measured, deviation(noise, as_measured.dot(momentum).real())};
  return target;
}

void add_modes(std::vector<MeasuredShape> modes, const model::Machine& machine,
               const MeasuredAt& at, observation::Targets& targets) {
  find_flanks(modes);
  for (const auto& mode : modes)
    targets.modes.push_back(
        mode_target(mode, fmt::format("{:.3f} Hz", mode.omega / (base::two_pi)), machine, at));
}

bool from_drives(const identification::FrequencyResponses& responses) {
  return !responses.inputs.empty() && std::ranges::all_of(responses.inputs, [](const auto& input) {
    return input.role == data::Role::drive;
  });
}

observation::Targets measured_modes(const identification::Identification& identified,
                                    const model::Machine& machine, const MeasuredAt& where) {
  observation::Targets targets{.title = "identified modes"};
  if (identified.modes.empty())
    throw base::InputError({{.message = "no mode was found in the measurement"}});
  const auto& outputs = identified.responses.outputs;
  auto at = where;
  if (!at.against) at.against = motion_against(outputs);
  targets.observed =
      at.observed.value_or(from_drives(identified.responses) ? observation::Observed::plant
                                                             : observation::Observed::mechanics);
  const auto& lines = identified.responses.frequency;
  const double spacing = lines.size() > 1 ? base::two_pi * (lines.back() - lines.front()) /
                                                static_cast<double>(lines.size() - 1)
                                          : 0.0;
  std::vector<MeasuredShape> shapes;
  for (const auto& mode : identified.modes) {
    MeasuredShape measured{.omega = mode.fit.omega(),
                           .omega_deviation = mode.fit.omega_deviation,
                           .damping = mode.fit.damping_ratio(),
                           .damping_deviation = mode.fit.damping_deviation,
                           .significance = mode.fit.significance,
                           .line_spacing = spacing};
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    measured.motion.fill(nan);
    for (std::size_t o = 0; o < outputs.size(); ++o) {
      const int code = static_cast<int>(outputs[o].direction);
      if (code == 0 || std::abs(code) > 6) continue;
      const auto k = static_cast<std::size_t>(std::abs(code) - 1);
      const auto row = static_cast<Eigen::Index>(o);
      const double sign = code < 0 ? -1.0 : 1.0;
      measured.motion[k] = sign * mode.displacement[row];
      // deviations are of φ; displacement is φ/λ^d
      const double scale = std::abs(mode.fit.shape[row]) > 0.0
                               ? std::abs(mode.displacement[row]) / std::abs(mode.fit.shape[row])
                               : 0.0;
      measured.motion_deviation[k] = mode.fit.shape_deviation[row] * scale;
    }
    shapes.push_back(measured);
  }
  add_modes(std::move(shapes), machine, at, targets);
  return targets;
}

}  // namespace hydrapod::diagnosis
