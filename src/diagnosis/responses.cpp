#include "hydrapod/diagnosis/responses.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/directions.hpp"
#include "hydrapod/kinematics/inverse.hpp"
#include "hydrapod/observation/observation.hpp"

namespace hydrapod::diagnosis {

namespace {

using observation::ResponseTarget;
using observation::Targets;
using Complex = std::complex<double>;

using base::two_pi;

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

/// Is it in a unit like these, for directions along and about an axis?
bool measures(const data::Channel& channel, std::string_view along, std::string_view about) {
  const int axis = std::abs(static_cast<int>(channel.direction));
  return base::read_quantity("1 " + channel.unit, axis >= 4 && axis <= 6 ? about : along).ok();
}

/// Is it a displacement, a speed or an acceleration, whichever its unit says that it is?
bool is_motion(const data::Channel& channel) {
  constexpr std::array along{"m", "m/s", "m/s^2"}, about{"rad", "rad/s", "rad/s^2"};
  const auto rate = static_cast<std::size_t>(identification::time_derivatives(channel.unit));
  return measures(channel, along[rate], about[rate]);
}

/// Directions of the platform as unit vectors; empty where an input has none.
Eigen::MatrixXd directions_of(const std::vector<data::Channel>& inputs) {
  Eigen::MatrixXd units = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const int code = static_cast<int>(inputs[i].direction);
    if (code == 0 || std::abs(code) > 6) return {};
    units(std::abs(code) - 1, static_cast<Eigen::Index>(i)) = code < 0 ? -1.0 : 1.0;
  }
  return units;
}

/// What each input does to each leg; empty where it has no direction. `of_platform`: per motion of
/// the platform.
Eigen::MatrixXd legs_of(const std::vector<data::Channel>& inputs,
                        const Eigen::MatrixXd& of_platform) {
  Eigen::MatrixXd legs(6, inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const int code = static_cast<int>(inputs[i].direction);
    const auto column = static_cast<Eigen::Index>(i);
    constexpr int first_leg = static_cast<int>(data::Direction::leg1);
    if (code == 0) return {};
    if (std::abs(code) <= 6)
      legs.col(column) = (code < 0 ? -1.0 : 1.0) * of_platform.col(std::abs(code) - 1);
    else
      legs.col(column) = spatial::Vector6::Unit(code - first_leg);
  }
  return legs;
}

/// Which mixture of the inputs moves each leg alone; the inputs themselves where they cannot. What
/// is not known of a valve is its own then: in a drive of the platform all six would mix.
Eigen::MatrixXd inputs_of_legs(const Eigen::MatrixXd& legs) {
  if (legs.cols() == 6) {
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(legs);
    if (lu.isInvertible()) return lu.inverse();
  }
  return Eigen::MatrixXd::Identity(legs.cols(), legs.cols());
}

/// What the inputs are, and the mixtures of them whose responses are compared.
struct Inputs {
  observation::Entry entry{};
  Eigen::MatrixXd of_entry{};  ///< of each mixture, see ResponseTarget::inputs; empty: none
  Eigen::MatrixXd mixture{};   ///< inputs × mixtures
};

Inputs valves(const std::vector<data::Channel>& inputs, const model::Machine& machine,
              const spatial::Pose& X_BP, const spatial::Vector3& p_PQ) {
  const auto J =
      kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), X_BP * p_PQ);
  const Eigen::MatrixXd legs = legs_of(inputs, J);
  if (legs.size() == 0) return {};
  const Eigen::MatrixXd mixture = inputs_of_legs(legs);
  return {observation::Entry::valves, legs * mixture, mixture};
}

/// Commanded displacements are of the platform's own frame.
Inputs commands(const std::vector<data::Channel>& inputs, const model::Machine& machine,
                const spatial::Pose& X_BP) {
  const auto units = directions_of(inputs);
  if (units.size() == 0) return {};
  const auto J = kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), X_BP.p_BP);
  const Eigen::MatrixXd mixture = inputs_of_legs(J * units);
  return {observation::Entry::commands, units * mixture, mixture};
}

/// Forces at the point that `at` says, as forces and moments at the measured one.
Inputs forces(const std::vector<data::Channel>& inputs, const spatial::Pose& X_BP,
              const MeasuredAt& at) {
  const auto units = directions_of(inputs);
  if (units.size() == 0) return {};
  spatial::Matrix6 to_point = spatial::Matrix6::Identity();
  to_point.bottomLeftCorner<3, 3>() =
      spatial::skew(X_BP.R_BP * (at.force_point.value_or(at.point) - at.point));
  return {observation::Entry::forces, to_point * units,
          Eigen::MatrixXd::Identity(units.cols(), units.cols())};
}

/// Responses to forces count with their size and where they act: what channels in units that are
/// none of motion, or at several measuring points (nodes), say of them is not known.
bool known_as_they_are(const std::vector<data::Channel>& inputs,
                       const std::vector<data::Channel>& outputs, const std::vector<Row>& rows) {
  int point = 0;
  const auto at_one_point = [&](const data::Channel& channel) {
    if (point == 0) point = channel.point;
    return channel.point == 0 || channel.point == point;
  };
  return std::ranges::all_of(inputs, at_one_point) &&
         std::ranges::all_of(rows, [&](const Row& row) {
           const auto& output = outputs[static_cast<std::size_t>(row.output)];
           return at_one_point(output) && is_motion(output);
         });
}

/// Without mixtures: not all of one kind.
Inputs inputs_of(const identification::FrequencyResponses& responses, const std::vector<Row>& rows,
                 const model::Machine& machine, const spatial::Pose& X_BP, const MeasuredAt& at) {
  const auto& inputs = responses.inputs;
  const auto entry = entry_of(inputs);
  if (!entry) return {};
  switch (*entry) {
    case observation::Entry::valves:
      return valves(inputs, machine, X_BP, at.point);
    case observation::Entry::commands:
      return commands(inputs, machine, X_BP);
    case observation::Entry::forces:
      break;
  }
  return known_as_they_are(inputs, responses.outputs, rows) ? forces(inputs, X_BP, at) : Inputs{};
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
  double omega{}, damping{}, width{};
};
constexpr double apart = 0.015;  // of the frequency: nearer lines say the same

std::vector<Peak> peaks_at(const Targets& measured, const std::string& pose) {
  constexpr double half_widths = 2.0, widest = 0.1, usual = 0.02;
  std::vector<Peak> peaks;
  for (const auto& mode : measured.modes)
    if (mode.pose == pose) {
      const double damping = mode.damping.value_or(usual);
      peaks.push_back({mode.omega, damping, std::min(widest, half_widths * damping)});
    }
  return peaks;
}

/// What a response to forces is off by, as share of it, where poles are off by `frequency_error`
/// and half widths by all of themselves.
double misplaced(const std::vector<Peak>& peaks, double omega, double frequency_error) {
  double most = 0.0;
  for (const auto& peak : peaks) {
    const Complex pole = peak.omega * Complex(-peak.damping, 1.0);
    most = std::max(most, std::hypot(frequency_error, peak.damping) * peak.omega /
                              std::abs(Complex(0.0, omega) - pole));
  }
  return most;
}

/// Where a line would be worth most: on the flanks of measured resonances, where the machine as
/// stated has some, and then anywhere in the band.
std::vector<double> wanted_lines(const std::vector<Peak>& peaks, const model::MachineFile& file,
                                 const model::NamedPose& pose, dynamics::ModelKind kind,
                                 observation::Observed observed, double from, double to, int most) {
  constexpr double felt = 2e-3, most_damped = 0.3;  // of the kinetic energy, as in resonances.hpp
  std::vector<double> omega;
  for (const auto& peak : peaks)
    for (const double side : {-1.0, 1.0})
      omega.push_back(peak.omega * (1.0 + side * (peak.width + 0.5 * apart)));
  const auto stated = observation::observe(file.machine, pose.X_BP, kind, observed);
  for (const auto& mode : stated.modes) {
    const observation::Vector6c motion = mode.motion();
    const observation::Vector6c momentum = stated.mechanics.platform_mass.cast<Complex>() * motion;
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

std::optional<observation::Entry> entry_of(const std::vector<data::Channel>& inputs) {
  const auto all = [&](const auto& is) { return std::ranges::all_of(inputs, is); };
  if (inputs.empty()) return std::nullopt;
  if (all([](const auto& input) { return input.role == data::Role::drive; }))
    return observation::Entry::valves;
  if (all([](const auto& input) { return measures(input, "N", "N m"); }))
    return observation::Entry::forces;
  if (all([](const auto& input) { return measures(input, "m", "rad"); }))
    return observation::Entry::commands;
  return std::nullopt;
}

std::optional<ResponseTarget> measured_responses(
    const identification::FrequencyResponses& responses, const model::Machine& machine,
    const MeasuredAt& at) {
  const auto* pose = pose_named(machine, at.pose);
  if (pose == nullptr) return std::nullopt;  // said with the modes
  const auto rows = direction_rows(responses.outputs);
  if (rows.empty()) return std::nullopt;
  const bool widened = responses.taper.size() > 0;
  const int rate = identification::time_derivatives(
      responses.outputs[static_cast<std::size_t>(rows[0].output)].unit);
  const auto window = observation::lag_window(responses.taper, responses.sample_rate, rate);
  if (widened && !window) return std::nullopt;  // in a way that is not known
  const auto inputs = inputs_of(responses, rows, machine, pose->X_BP, at);
  if (inputs.mixture.size() == 0) return std::nullopt;
  ResponseTarget target{.pose = at.pose,
                        .point = at.point,
                        .against = at.against.value_or(motion_against(responses.outputs)),
                        .entry = inputs.entry,
                        .inputs = inputs.of_entry,
                        .window = window};
  const spatial::Matrix6 root = metric(machine, pose->X_BP, at.point);
  const auto columns = target.inputs.cols();
  for (std::size_t line = 0; line < responses.lines(); ++line) {
    const Complex s(responses.shift, two_pi * responses.frequency[line]);
    const Complex displacement = std::pow(s, -rate);
    Eigen::MatrixXcd H(6, columns);
    double noise_of_outputs = 0.0;
    for (int k = 0; k < 6; ++k) {
      const auto& row = rows[static_cast<std::size_t>(k)];
      H.row(k) = row.sign * displacement * responses.H[line].row(row.output) * inputs.mixture;
      if (responses.has_errors())
        noise_of_outputs += root.col(k).squaredNorm() * std::norm(displacement) *
                            responses.noise[line](row.output, row.output).real();
    }
    Eigen::VectorXd noise = Eigen::VectorXd::Zero(columns);
    for (int i = 0; i < columns && responses.has_errors(); ++i)
      noise[i] = noise_of_outputs * inputs.mixture.col(i).dot(responses.input_factor[line].real() *
                                                              inputs.mixture.col(i));
    const Eigen::VectorXd size = (root.cast<Complex>() * H).colwise().norm();
    if (!H.allFinite() || !(size.minCoeff() > 0.0)) continue;
    target.s.push_back(s);
    target.H.push_back(H);
    target.deviation.push_back(noise.cwiseSqrt().cwiseQuotient(size));
  }
  if (target.s.empty()) return std::nullopt;
  return target;
}

std::vector<ResponseTarget> chosen_lines(const model::MachineFile& file, const Targets& measured,
                                         dynamics::ModelKind kind, const DiagnoseOptions& options) {
  constexpr double below = 0.6, above = 1.4;
  constexpr int of_shape = 5;  // values
  std::vector<ResponseTarget> chosen;
  for (const auto& all : measured.responses) {
    const auto* pose = pose_named(file.machine, all.pose);
    const auto peaks = peaks_at(measured, all.pose);
    if (pose == nullptr || peaks.empty() || !can_enter(measured.observed, all.entry)) continue;
    const double from = below * std::ranges::min(peaks, {}, &Peak::omega).omega;
    const double to = above * std::ranges::max(peaks, {}, &Peak::omega).omega;
    const int most = std::max(1, most_lines / static_cast<int>(measured.responses.size()));
    const auto lines =
        lines_of(all, from, to, peaks,
                 wanted_lines(peaks, file, *pose, kind, measured.observed, from, to, most));
    ResponseTarget some{.pose = all.pose,
                        .point = all.point,
                        .against = all.against,
                        .entry = all.entry,
                        .inputs = all.inputs,
                        .window = all.window};
    const auto inputs = static_cast<double>(all.inputs.cols());
    const auto shapes = static_cast<double>(std::min(lines.size(), peaks.size()));
    for (const auto line : lines) {
      some.s.push_back(all.s[line]);
      some.H.push_back(all.H[line]);
      const double of_poles = all.entry == observation::Entry::forces
                                  ? misplaced(peaks, all.s[line].imag(), options.frequency_error)
                                  : 0.0;
      const double error = (std::pow(options.response_error, 2) + std::pow(of_poles, 2)) *
                           static_cast<double>(lines.size()) / shapes;
      some.deviation.push_back(
          (inputs * (all.deviation[line].array().square() + error)).sqrt().matrix());
    }
    some.values = of_shape * static_cast<int>(shapes);
    if (!some.s.empty()) chosen.push_back(std::move(some));
  }
  return chosen;
}

}  // namespace hydrapod::diagnosis
