// Measured frequency responses as targets.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/parameters.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "hydrapod/observation/targets.hpp"

namespace hydrapod::observation {

namespace {

using Complex = std::complex<double>;

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
    return data::time_derivatives(outputs[static_cast<std::size_t>(row.output)].unit);
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
  const auto rate = static_cast<std::size_t>(data::time_derivatives(channel.unit));
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
  Entry entry{};
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
  return {Entry::valves, legs * mixture, mixture};
}

/// Commanded displacements are of the platform's own frame.
Inputs commands(const std::vector<data::Channel>& inputs, const model::Machine& machine,
                const spatial::Pose& X_BP) {
  const auto units = directions_of(inputs);
  if (units.size() == 0) return {};
  const auto J = kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), X_BP.p_BP);
  const Eigen::MatrixXd mixture = inputs_of_legs(J * units);
  return {Entry::commands, units * mixture, mixture};
}

/// Forces at the point that `at` says, as forces and moments at the measured one.
Inputs forces(const std::vector<data::Channel>& inputs, const spatial::Pose& X_BP,
              const MeasuredAt& at) {
  const auto units = directions_of(inputs);
  if (units.size() == 0) return {};
  spatial::Matrix6 to_point = spatial::Matrix6::Identity();
  to_point.bottomLeftCorner<3, 3>() =
      spatial::skew(X_BP.R_BP * (at.force_point.value_or(at.point) - at.point));
  return {Entry::forces, to_point * units, Eigen::MatrixXd::Identity(units.cols(), units.cols())};
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
Inputs inputs_of(const data::FrequencyResponses& responses, const std::vector<Row>& rows,
                 const model::Machine& machine, const spatial::Pose& X_BP, const MeasuredAt& at) {
  const auto& inputs = responses.inputs;
  const auto entry = entry_of(inputs);
  if (!entry) return {};
  switch (*entry) {
    case Entry::valves:
      return valves(inputs, machine, X_BP, at.point);
    case Entry::commands:
      return commands(inputs, machine, X_BP);
    case Entry::forces:
      break;
  }
  return known_as_they_are(inputs, responses.outputs, rows) ? forces(inputs, X_BP, at) : Inputs{};
}

/// The six inputs of an entry per input; else why there are none.
struct Columns {
  Eigen::MatrixXd of_entry{};
  std::string why_not{};
};

/// Forces at `p_BF` as forces and moments about the mass centre.
Columns at_mass_center(const std::vector<data::Channel>& inputs, const Observation& seen,
                       const spatial::Vector3& p_BF) {
  const auto units = directions_of(inputs);
  if (units.size() == 0) return {.why_not = "the direction of one of its forces is not known"};
  spatial::Matrix6 to_center = spatial::Matrix6::Identity();
  to_center.bottomLeftCorner<3, 3>() = spatial::skew(p_BF - seen.mechanics.p_BC);
  return {.of_entry = to_center * units};
}

Columns columns_of(const std::vector<data::Channel>& inputs, Entry entry,
                   const ComparisonFrame& frame, const Observation& seen,
                   const spatial::Vector3& p_BF) {
  switch (entry) {
    case Entry::valves: {
      // shares of each leg's range: of one leg, or of all by directions, as lengths of legs go
      const auto is_share = [](const data::Channel& input) {
        const int axis = std::abs(static_cast<int>(input.direction));
        return axis != 0 && input.unit == (axis >= 4 && axis <= 6 ? "1/m" : "1");
      };
      if (!std::ranges::all_of(inputs, is_share))
        return {.why_not =
                    "its drives are no shares of the range of legs, and their size is not "
                    "known"};
      const auto geometry = kinematics::inverse_kinematics(frame.machine, frame.X_BP);
      return {.of_entry = legs_of(inputs, kinematics::leg_jacobian(geometry, frame.p_BQ))};
    }
    case Entry::commands: {
      Columns columns{.of_entry = directions_of(inputs)};
      if (columns.of_entry.size() == 0)
        columns.why_not = "the direction of one of its commands is not known";
      return columns;
    }
    case Entry::forces:
      break;
  }
  return at_mass_center(inputs, seen, p_BF);
}

/// How an output sees the motion of the platform.
struct View {
  Eigen::Index output{};
  int rate{};
  MotionAgainst against{};
};

std::vector<View> views_of(const std::vector<data::Channel>& outputs, const Eigen::MatrixXd& map) {
  std::vector<View> views;
  for (Eigen::Index o = 0; o < map.rows(); ++o) {
    const auto& output = outputs[static_cast<std::size_t>(o)];
    if (map.row(o).allFinite() && is_motion(output))
      views.push_back(
          {.output = o,
           .rate = data::time_derivatives(output.unit),
           .against = data::against_ground(output) ? MotionAgainst::ground : MotionAgainst::base});
  }
  return views;
}

/// What estimates of displacements, speeds and accelerations make of responses; empty where that
/// is not known.
std::vector<std::optional<LagWindow>> windows_of(const data::FrequencyResponses& measured) {
  std::vector<std::optional<LagWindow>> windows(3);
  if (measured.taper.size() == 0) return windows;
  for (int rate = 0; rate < 3; ++rate) {
    auto& window = windows[static_cast<std::size_t>(rate)];
    window = lag_window(measured.taper, measured.sample_rate, rate);
    if (!window) return {};
  }
  return windows;
}

const char* entry_without_system(Entry entry) {
  return entry == Entry::valves ? "its inputs are drives, which only the plant has"
                                : "its inputs are commands, which only a controlled machine has";
}

}  // namespace

ShownResponses shown_responses(const data::FrequencyResponses& measured,
                               const ComparisonFrame& frame, const Observation& seen,
                               const spatial::Vector3& p_BF) {
  if (measured.estimator == data::Estimator::half_spectra)
    return {.why_not = "its excitation was not measured"};
  const auto entry = entry_of(measured.inputs);
  if (!entry)
    return {.why_not = "its inputs are neither drives nor forces nor commanded displacements"};
  if (seen.inputs[static_cast<std::size_t>(*entry)].cols() == 0)
    return {.why_not = entry_without_system(*entry)};
  const auto columns = columns_of(measured.inputs, *entry, frame, seen, p_BF);
  if (!columns.why_not.empty()) return {.why_not = columns.why_not};
  const Eigen::MatrixXd map = output_map(measured.outputs, frame);
  const auto views = views_of(measured.outputs, map);
  if (views.empty()) return {.why_not = "no output is a motion of the platform at one point"};
  std::vector<Row> rows;
  for (const auto& view : views) rows.push_back({.output = static_cast<int>(view.output)});
  if (*entry == Entry::forces && !known_as_they_are(measured.inputs, measured.outputs, rows))
    return {.why_not = "its forces and motions are at several points"};
  const auto windows = windows_of(measured);
  if (windows.empty()) return {.why_not = "how its estimate widens resonances is not known"};
  ShownResponses shown;
  const Eigen::MatrixXcd inputs = columns.of_entry.cast<Complex>();
  for (const double f : measured.frequency) {
    const Complex s(measured.shift, base::two_pi * f);
    auto& H =
        shown.H.emplace_back(Eigen::MatrixXcd::Constant(map.rows(), inputs.cols(), std::nan("")));
    if (s == 0.0) continue;
    std::array<std::optional<Eigen::MatrixXcd>, 6> of_views;  // per rate and ground or base
    for (const auto& view : views) {
      const auto rate = static_cast<std::size_t>(view.rate);
      auto& motion = of_views[2 * rate + static_cast<std::size_t>(view.against)];
      if (!motion) {
        const auto& window = windows[rate];
        motion = std::pow(s, view.rate) *
                 seen.response(s, *entry, view.against, window ? &*window : nullptr) * inputs;
      }
      H.row(view.output) = map.row(view.output).cast<Complex>() * *motion;
    }
  }
  return shown;
}

std::optional<Entry> entry_of(const std::vector<data::Channel>& inputs) {
  const auto all = [&](const auto& is) { return std::ranges::all_of(inputs, is); };
  if (inputs.empty()) return std::nullopt;
  if (all([](const auto& input) { return input.role == data::Role::drive; })) return Entry::valves;
  if (all([](const auto& input) { return measures(input, "N", "N m"); })) return Entry::forces;
  if (all([](const auto& input) { return measures(input, "m", "rad"); })) return Entry::commands;
  return std::nullopt;
}

std::optional<ResponseTarget> measured_responses(const data::FrequencyResponses& responses,
                                                 const model::Machine& machine,
                                                 const MeasuredAt& at) {
  const auto* pose = find_pose(machine, at.pose);
  if (pose == nullptr) return std::nullopt;  // said with the modes
  const auto rows = direction_rows(responses.outputs);
  if (rows.empty()) return std::nullopt;
  const bool widened = responses.taper.size() > 0;
  const int rate =
      data::time_derivatives(responses.outputs[static_cast<std::size_t>(rows[0].output)].unit);
  const auto window = lag_window(responses.taper, responses.sample_rate, rate);
  if (widened && !window) return std::nullopt;  // in a way that is not known
  const auto inputs = inputs_of(responses, rows, machine, pose->X_BP, at);
  if (inputs.mixture.size() == 0) return std::nullopt;
  ResponseTarget target{.pose = at.pose,
                        .point = at.point,
                        .against = at.against.value_or(motion_against(responses.outputs)),
                        .entry = inputs.entry,
                        .inputs = inputs.of_entry,
                        .window = window};
  const spatial::Matrix6 root = platform_metric(machine, pose->X_BP, at.point);
  const auto columns = target.inputs.cols();
  for (std::size_t line = 0; line < responses.lines(); ++line) {
    const Complex s(responses.shift, base::two_pi * responses.frequency[line]);
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

}  // namespace hydrapod::observation
