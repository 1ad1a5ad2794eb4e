#include "hydrapod/diagnosis/responses.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/calibration/observation.hpp"
#include "hydrapod/identification/directions.hpp"
#include "hydrapod/kinematics/inverse.hpp"

namespace hydrapod::diagnosis {

namespace {

using calibration::ResponseTarget;
using calibration::Targets;
using Complex = std::complex<double>;

constexpr double two_pi = 2.0 * std::numbers::pi;

const model::NamedPose* pose_named(const model::Machine& machine, const std::string& name) {
  const auto found = std::ranges::find(machine.poses, name, &model::NamedPose::name);
  return found == machine.poses.end() ? nullptr : &*found;
}

/// Row of every direction among the outputs and its sign; empty where one is missing.
struct Row {
  int output{-1};
  double sign{1.0};
};
std::vector<Row> direction_rows(const std::vector<data::Channel>& outputs) {
  std::vector<Row> rows(6);
  for (std::size_t o = 0; o < outputs.size(); ++o) {
    const int code = static_cast<int>(outputs[o].direction);
    if (code == 0 || std::abs(code) > 6) continue;
    rows[static_cast<std::size_t>(std::abs(code) - 1)] = {static_cast<int>(o),
                                                          code < 0 ? -1.0 : 1.0};
  }
  // displacements, speeds or accelerations: all of them the same
  const auto rate = [&](const Row& row) {
    return identification::time_derivatives(outputs[static_cast<std::size_t>(row.output)].unit);
  };
  if (std::ranges::any_of(rows, [](const Row& row) { return row.output < 0; })) return {};
  if (std::ranges::any_of(rows, [&](const Row& row) { return rate(row) != rate(rows[0]); }))
    return {};
  return rows;
}

/// What the inputs drive the six valves with; empty where one is no drive.
Eigen::MatrixXd drives_of(const std::vector<data::Channel>& inputs, const model::Machine& machine,
                          const spatial::Pose& X_BP, const spatial::Vector3& p_PQ) {
  const auto J =
      kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), X_BP * p_PQ);
  Eigen::MatrixXd drives(6, inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const int code = static_cast<int>(inputs[i].direction);
    const auto column = static_cast<Eigen::Index>(i);
    constexpr int first_leg = static_cast<int>(data::Direction::leg1);
    if (inputs[i].role != data::Role::drive || code == 0) return {};
    if (std::abs(code) <= 6)
      drives.col(column) = (code < 0 ? -1.0 : 1.0) * J.col(std::abs(code) - 1);
    else
      drives.col(column) = spatial::Vector6::Unit(code - first_leg);
  }
  return drives;
}

/// Which mixture of the inputs drives each valve alone; the inputs themselves where they cannot.
/// What is not known of a valve is its own then: in a drive of the platform all six would mix.
Eigen::MatrixXd inputs_of_valves(const Eigen::MatrixXd& drives) {
  if (drives.cols() == 6) {
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(drives);
    if (lu.isInvertible()) return lu.inverse();
  }
  return Eigen::MatrixXd::Identity(drives.cols(), drives.cols());
}

/// Root of the platform's mass for motions of its mass centre, times the way from Q to there.
spatial::Matrix6 metric(const model::Machine& machine, const spatial::Pose& X_BP,
                        const spatial::Vector3& p_PQ) {
  const spatial::Matrix3 inertia = X_BP.R_BP * machine.platform.inertia * X_BP.R_BP.transpose();
  spatial::Vector6 mass;
  mass << spatial::Vector3::Constant(machine.platform.mass), inertia.diagonal();
  spatial::Matrix6 to_center = spatial::Matrix6::Identity();
  to_center.topRightCorner<3, 3>() =
      -spatial::skew(X_BP.R_BP * (machine.platform.mass_center - p_PQ));
  return mass.cwiseSqrt().asDiagonal() * to_center;
}

/// A measured resonance: within `width` of it, as share of ω, its damping decides.
struct Peak {
  double omega{}, width{};
};
constexpr double apart = 0.015;  // of the frequency: nearer lines say the same

std::vector<Peak> peaks_at(const Targets& measured, const std::string& pose) {
  constexpr double half_widths = 2.0, widest = 0.1, usual = 0.02;
  std::vector<Peak> peaks;
  for (const auto& mode : measured.modes)
    if (mode.pose == pose)
      peaks.push_back({mode.omega, std::min(widest, half_widths * mode.damping.value_or(usual))});
  return peaks;
}

/// Where a line would be worth most: on the flanks of measured resonances, where the machine as
/// stated has some, and then anywhere in the band.
std::vector<double> wanted_lines(const std::vector<Peak>& peaks, const model::MachineFile& file,
                                 const model::NamedPose& pose, dynamics::ModelKind kind,
                                 double from, double to, int most) {
  constexpr double felt = 2e-3, most_damped = 0.3;  // of the kinetic energy, as in resonances.hpp
  std::vector<double> omega;
  for (const auto& peak : peaks)
    for (const double side : {-1.0, 1.0})
      omega.push_back(peak.omega * (1.0 + side * (peak.width + 0.5 * apart)));
  const auto stated = calibration::observe_plant(file.machine, pose.X_BP, kind);
  for (const auto& mode : stated.modes) {
    const calibration::Vector6c motion = mode.motion();
    const calibration::Vector6c momentum = stated.mechanics.platform_mass.cast<Complex>() * motion;
    if (mode.damping_ratio() < most_damped && motion.dot(momentum).real() > felt)
      omega.push_back(mode.omega());
  }
  for (int k = 0; k < most; ++k)
    omega.push_back(from * std::pow(to / from, (k + 0.5) / static_cast<double>(most)));
  return omega;
}

/// Largest noise of a column at a line, as share of it.
double noise_at(const ResponseTarget& all, std::size_t line) {
  return all.deviation[line].maxCoeff();
}

/// Numbers of the lines that count, ascending.
std::vector<std::size_t> lines_of(const ResponseTarget& all, double from, double to,
                                  const std::vector<Peak>& peaks,
                                  const std::vector<double>& wanted) {
  const auto off = [](double a, double b) { return std::abs(std::log(a / b)); };
  std::vector<std::size_t> good;
  for (std::size_t line = 0; line < all.s.size(); ++line) {
    const double omega = all.s[line].imag();
    if (omega >= from && omega <= to && noise_at(all, line) < worst_noise &&
        std::ranges::none_of(peaks, [&](const Peak& p) { return off(omega, p.omega) < p.width; }))
      good.push_back(line);
  }
  if (good.empty()) return {};
  std::vector<std::size_t> chosen;
  for (const double omega : wanted) {
    const auto nearest = *std::ranges::min_element(
        good, {}, [&](std::size_t line) { return off(all.s[line].imag(), omega); });
    if (off(all.s[nearest].imag(), omega) > 2.0 * apart) continue;  // nothing is known there
    const bool taken = std::ranges::any_of(chosen, [&](std::size_t line) {
      return off(all.s[line].imag(), all.s[nearest].imag()) < apart;
    });
    if (!taken) chosen.push_back(nearest);
  }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace

std::optional<ResponseTarget> measured_responses(
    const identification::FrequencyResponses& responses, const model::Machine& machine,
    const MeasuredAt& at) {
  const auto* pose = pose_named(machine, at.pose);
  if (pose == nullptr) return std::nullopt;  // said with the modes
  const auto rows = direction_rows(responses.outputs);
  ResponseTarget target{.pose = at.pose,
                        .point = at.point,
                        .against = at.against.value_or(motion_against(responses.outputs)),
                        .drives = drives_of(responses.inputs, machine, pose->X_BP, at.point)};
  // widened resonances are not those of any model line by line
  if (rows.empty() || target.drives.size() == 0 || responses.taper.size() > 0) return std::nullopt;
  const spatial::Matrix6 root = metric(machine, pose->X_BP, at.point);
  const Eigen::MatrixXd of_valves = inputs_of_valves(target.drives);
  target.drives = target.drives * of_valves;
  const auto inputs = target.drives.cols();
  for (std::size_t line = 0; line < responses.lines(); ++line) {
    Eigen::MatrixXcd H(6, inputs);
    double noise_of_outputs = 0.0;
    for (int k = 0; k < 6; ++k) {
      const auto& row = rows[static_cast<std::size_t>(k)];
      H.row(k) = row.sign * responses.H[line].row(row.output) * of_valves;
      if (responses.has_errors())
        noise_of_outputs +=
            root.col(k).squaredNorm() * responses.noise[line](row.output, row.output).real();
    }
    Eigen::VectorXd noise = Eigen::VectorXd::Zero(inputs);
    for (int i = 0; i < inputs && responses.has_errors(); ++i)
      noise[i] = noise_of_outputs *
                 of_valves.col(i).dot(responses.input_factor[line].real() * of_valves.col(i));
    const Eigen::VectorXd size = (root.cast<Complex>() * H).colwise().norm();
    if (!H.allFinite() || !(size.minCoeff() > 0.0)) continue;
    target.s.emplace_back(responses.shift, two_pi * responses.frequency[line]);
    target.H.push_back(H);
    target.deviation.push_back(noise.cwiseSqrt().cwiseQuotient(size));
  }
  if (target.s.empty()) return std::nullopt;
  return target;
}

std::vector<ResponseTarget> chosen_lines(const model::MachineFile& file, const Targets& measured,
                                         dynamics::ModelKind kind, double response_error) {
  constexpr double below = 0.6, above = 1.4;
  constexpr int of_shape = 5;  // values
  std::vector<ResponseTarget> chosen;
  for (const auto& all : measured.responses) {
    const auto* pose = pose_named(file.machine, all.pose);
    const auto peaks = peaks_at(measured, all.pose);
    if (pose == nullptr || peaks.empty()) continue;
    const double from = below * std::ranges::min(peaks, {}, &Peak::omega).omega;
    const double to = above * std::ranges::max(peaks, {}, &Peak::omega).omega;
    const int most = std::max(1, most_lines / static_cast<int>(measured.responses.size()));
    const auto lines =
        lines_of(all, from, to, peaks, wanted_lines(peaks, file, *pose, kind, from, to, most));
    ResponseTarget some{
        .pose = all.pose, .point = all.point, .against = all.against, .drives = all.drives};
    const auto inputs = static_cast<double>(all.drives.cols());
    const auto shapes = static_cast<double>(std::min(lines.size(), peaks.size()));
    for (const auto line : lines) {
      some.s.push_back(all.s[line]);
      some.H.push_back(all.H[line]);
      const double error = std::pow(response_error, 2) * static_cast<double>(lines.size()) / shapes;
      some.deviation.push_back(
          (inputs * (all.deviation[line].array().square() + error)).sqrt().matrix());
    }
    some.values = of_shape * static_cast<int>(shapes);
    if (!some.s.empty()) chosen.push_back(std::move(some));
  }
  return chosen;
}

}  // namespace hydrapod::diagnosis
