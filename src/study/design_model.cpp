#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/simulation/capability.hpp"
#include "hydrapod/study/study.hpp"
#include "machine_outputs.hpp"

namespace hydrapod::study {

namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;
using simulation::Ability;

constexpr std::array abilities{Ability::force, Ability::velocity, Ability::acceleration,
                               Ability::jerk, Ability::excursion};
constexpr std::array<std::array<const char*, 2>, simulation::ability_count> ability_units{
    {{"N", "N m"}, {"m/s", "rad/s"}, {"m/s^2", "rad/s^2"}, {"m/s^3", "rad/s^3"}, {"m", "rad"}}};

/// Outputs beside those of machine_problem(); a machine has some of them.
struct Extra {
  enum { power, sag, oil_force, first_ability };
  static constexpr int count = first_ability + 6 * simulation::ability_count;
};

/// What bears the axial force of a leg.
const char* axial_words(model::LegType type) {
  switch (type) {
    case model::LegType::strut:
      return "of a strut";
    case model::LegType::screw:
      return "of the screw of a leg";
    default:
      return "of the oil of a leg";
  }
}

std::vector<Column> all_extra_columns(model::LegType type) {
  std::vector<Column> columns{
      {"power", "W", "supply pressure above return pressure times the flow of the pump"},
      {"sag", "m", "largest static offset of a rod at its guide sleeve"},
      {"oil_force", "N",
       fmt::format("largest static force {}, pushed or pulled", axial_words(type))}};
  for (std::size_t a = 0; a < abilities.size(); ++a)
    for (std::size_t d = 0; d < 6; ++d)
      columns.push_back(
          {fmt::format("{}_{}", simulation::name(abilities[a]), spatial::direction_names[d]),
           ability_units[a][d < 3 ? 0 : 1],
           fmt::format("{} from rest in {}, the smaller of both senses",
                       simulation::name(abilities[a]), spatial::direction_names[d])});
  return columns;
}

/// Why the machine does not have the output; none: it has.
std::optional<std::string> why_missing(const model::Machine& machine, int extra) {
  const auto type = model::leg_type(machine);
  const auto without = [&](const char* what) {
    return fmt::format("{}, and {}s have none", what, model::name(type));
  };
  const bool screws = type == model::LegType::screw, struts = type == model::LegType::strut;
  if (extra == Extra::power) {
    if (screws || struts) return without("is that of the pump");
    if (machine.hydraulics.supply.pump_flow) return std::nullopt;
    return "is that of the pump, and the machine file gives no flow of a pump; add --set "
           "supply.pump_flow=…";
  }
  if (extra == Extra::sag && struts) return without("is an offset at guide sleeves");
  if (extra < Extra::first_ability) return std::nullopt;
  if (struts) return without("is a limit of drives");
  if (!screws) return std::nullopt;
  const auto ability = static_cast<std::size_t>(extra - Extra::first_ability) / 6;
  if (abilities[ability] == Ability::jerk)
    return "is not limited: the model has no limit of how fast the torque of a motor changes";
  const auto is_limited = [](const model::Leg& leg) {
    return leg.screw->torque_limit && leg.screw->speed_limit;
  };
  if (std::ranges::all_of(machine.legs, is_limited)) return std::nullopt;
  return "needs the limits of every motor; expected legs.screw.torque_limit and "
         "legs.screw.speed_limit";
}

/// Numbers of the outputs that the machine has.
std::vector<int> extras_of(const model::Machine& machine) {
  std::vector<int> extras;
  for (int extra = 0; extra < Extra::count; ++extra)
    if (!why_missing(machine, extra)) extras.push_back(extra);
  return extras;
}

double pump_power(const model::Supply& supply) {
  if (!supply.pump_flow) return missing;
  return (supply.pressure - supply.return_pressure) * *supply.pump_flow;
}

void add_statics(const model::Machine& machine, const LinearModel& linear,
                 std::span<double> extra) {
  extra[Extra::sag] = extra[Extra::oil_force] = 0.0;
  if (machine.gravity.isZero(0.0)) return;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    extra[Extra::sag] = std::max(extra[Extra::sag], linear.legs[at].sleeve_offset.norm());
    extra[Extra::oil_force] =
        std::max(extra[Extra::oil_force], std::abs(linear.statics.legs[at].oil_force));
  }
}

void add_abilities(const simulation::Capability& found, std::span<double> extra) {
  for (std::size_t a = 0; a < abilities.size(); ++a)
    for (int d = 0; d < 6; ++d)
      extra[Extra::first_ability + 6 * a + static_cast<std::size_t>(d)] =
          std::min(found.of(abilities[a], d, 0).value, found.of(abilities[a], d, 1).value);
}

/// Which mode an output is the frequency of, or the frequency and that of rigid legs.
struct OfMode {
  bool any{}, drop{};
  int direction{-1};  ///< of a first resonance
};

OfMode of_mode(const std::string& name) {
  const auto direction = [](std::string_view word) -> int {
    const auto at = std::ranges::find(spatial::direction_names, word);
    return at == spatial::direction_names.end()
               ? -1
               : static_cast<int>(at - spatial::direction_names.begin());
  };
  if (name == "lowest") return {.any = true};
  if (name == "drop") return {.any = true, .drop = true};
  if (name.starts_with("mode")) return {.any = true};
  if (const int d = direction(name); d >= 0) return {.any = true, .direction = d};
  if (!name.starts_with("drop_")) return {};
  return {.any = true, .drop = true, .direction = direction(name.substr(5))};
}

/// Frequencies with their derivatives: rows of modes, columns of changes.
struct ModesAndDerivatives {
  dynamics::NormalModes modes{};
  Eigen::MatrixXd domega2{};

  /// Derivatives of the frequency [Hz per SI] of the mode at `hertz`, the one that holds most of
  /// `direction` where several have it. Nothing where no mode does.
  [[nodiscard]] std::optional<Eigen::RowVectorXd> at(double hertz, int direction) const {
    constexpr double same = 1e-8;  // relative: rounding, not a neighbour
    int best = -1;
    for (int k = 0; k < modes.size(); ++k) {
      if (std::abs(modes.omega(k) / base::two_pi - hertz) > same * hertz) continue;
      if (best < 0 || (direction >= 0 && std::abs(modes.shapes(direction, k)) >
                                             std::abs(modes.shapes(direction, best))))
        best = k;
    }
    if (best < 0) return {};
    const double omega = base::two_pi * hertz;
    return Eigen::RowVectorXd(domega2.row(best) / (2.0 * omega * base::two_pi));
  }
};

/// The machine that modes are followed from: with its own numbers, or where these have no modes
/// with others between the bounds.
Problem nominal_problem(const DesignProblem& problem, const model::NamedPose& pose, bool buckling) {
  const MachineOptions options{
      .kind = problem.kind, .X_BP = pose.X_BP, .buckling = buckling, .pose = pose.name};
  std::string why;
  for (const double share : {-1.0, 1.0, 0.5, 0.75, 0.25, 0.0}) {
    std::vector<double> values;
    for (const auto& change : problem.changes)
      values.push_back(change.distribution.a +
                       share * (change.distribution.b - change.distribution.a));
    const auto machine =
        share < 0.0 ? problem.machine : machine_of(problem.machine, problem.changes, values);
    try {
      return machine_problem(machine, problem.changes, options);
    } catch (const base::ComputationError& error) {
      if (why.empty()) why = error.what();
    }
  }
  throw base::ComputationError(
      why + "; nor has it modes with the bounds of what may change, or in the middle of them");
}

}  // namespace

std::vector<Column> design_outputs(const DesignProblem& problem) {
  auto columns = nominal_problem(problem, problem.poses.front(), true).outputs;
  const auto all = all_extra_columns(model::leg_type(problem.machine));
  for (const int extra : extras_of(problem.machine))
    columns.push_back(all[static_cast<std::size_t>(extra)]);
  for (const auto& own : problem.own) {
    const auto& name = own.column.name;
    if (std::ranges::count(columns, name, &Column::name) > 0 ||
        std::ranges::count(problem.changes, name, &Input::name) > 0)
      base::refuse("output " + name, "there is such an output or number already");
    columns.push_back(own.column);
  }
  return columns;
}

std::optional<std::string> why_no_output(const model::Machine& machine, ModelKind kind,
                                         std::string_view name) {
  if (auto why = why_no_column(machine, kind, name)) return why;
  const auto all = all_extra_columns(model::leg_type(machine));
  const auto found = std::ranges::find(all, name, &Column::name);
  if (found == all.end()) return std::nullopt;
  return why_missing(machine, static_cast<int>(found - all.begin()));
}

struct DesignModel::Parts {
  model::Machine machine{};
  ModelKind kind{};
  model::NamedPose pose{};
  std::vector<Input> changes{};
  std::vector<Column> columns{};
  std::vector<int> wanted{};
  std::vector<int> extras{};     ///< those that stand behind the problem's outputs
  std::vector<OwnOutput> own{};  ///< those behind the extras; without a function: not wanted
  bool statics{}, capability{};
  Problem problem{};
  Model alone{};
  BatchModel batch{};
  std::vector<int> column_of{};  ///< of the problem's outputs, the number among `columns`; −1: none
  std::vector<double> raw{};

  [[nodiscard]] const spatial::Pose& at(const model::Machine& changed) const {
    return pose_now(changed, pose.name, pose.X_BP);
  }

  /// The problem's row, put where the design's columns are.
  void take(std::span<const double> values, std::span<const double> row,
            std::span<double> outputs) {
    std::ranges::fill(outputs, missing);
    for (std::size_t k = 0; k < row.size(); ++k)
      if (column_of[k] >= 0) outputs[static_cast<std::size_t>(column_of[k])] = row[k];
    if (row[static_cast<std::size_t>(problem.status)] != 0.0) return;
    std::array<double, Extra::count> extra{};
    extra.fill(missing);
    add_extra(values, extra);
    const auto behind = outputs.last(extras.size() + own.size());
    for (std::size_t k = 0; k < extras.size(); ++k)
      behind[k] = extra[static_cast<std::size_t>(extras[k])];
    for (std::size_t k = 0; k < own.size(); ++k)
      behind[extras.size() + k] = own_value(own[k], values);
  }

  [[nodiscard]] double own_value(const OwnOutput& output, std::span<const double> values) const {
    if (!output.of) return missing;
    try {
      return output.of(values, pose);
    } catch (const base::ComputationError&) {
      return missing;
    }
  }

  void add_extra(std::span<const double> values, std::span<double> extra) const {
    const auto changed = machine_of(machine, changes, values);
    extra[Extra::power] = pump_power(changed.hydraulics.supply);
    try {
      if (statics) add_statics(changed, dynamics::linear_model(changed, at(changed), kind), extra);
      if (!capability) return;
      if (const auto found = simulation::capability(changed, at(changed), kind, false))
        add_abilities(*found, extra);
    } catch (const base::ComputationError&) {  // then they stay without a value
    }
  }

  /// Those of `own` may be called as they like.
  [[nodiscard]] OfMode mode_of(int column) const {
    const auto k = static_cast<std::size_t>(column);
    return k + own.size() < columns.size() ? of_mode(columns[k].name) : OfMode{};
  }

  ModesAndDerivatives modes(std::span<const double> values, ModelKind of) const;
  std::optional<Eigen::RowVectorXd> mode_derivative(const OfMode& which,
                                                    std::span<const double> outputs, int column,
                                                    const ModesAndDerivatives& flexible,
                                                    const ModesAndDerivatives* rigid) const;
};

DesignModel::DesignModel(const DesignProblem& problem, const model::NamedPose& pose,
                         std::vector<int> wanted)
    : parts_(std::make_shared<Parts>()) {
  auto& parts = *parts_;
  parts.machine = problem.machine;
  parts.kind = problem.kind;
  parts.pose = pose;
  parts.changes = problem.changes;
  parts.columns = problem.outputs;
  parts.wanted = std::move(wanted);
  parts.extras = extras_of(problem.machine);
  parts.own = problem.own;
  const auto first_own = static_cast<int>(problem.outputs.size() - parts.own.size());
  const auto first_extra = first_own - static_cast<int>(parts.extras.size());
  for (std::size_t k = 0; k < parts.own.size(); ++k)
    if (std::ranges::count(parts.wanted, first_own + static_cast<int>(k)) == 0)
      parts.own[k].of = {};
  bool buckling = false;
  for (const int column : parts.wanted) {
    if (column >= first_own) continue;
    const int extra =
        column < first_extra ? -1 : parts.extras[static_cast<std::size_t>(column - first_extra)];
    buckling = buckling || problem.outputs[static_cast<std::size_t>(column)].name == "buckling";
    parts.statics = parts.statics || extra == Extra::sag || extra == Extra::oil_force;
    parts.capability = parts.capability || extra >= Extra::first_ability;
  }
  parts.problem = nominal_problem(problem, pose, buckling);
  for (const auto& output : parts.problem.outputs) {
    const auto at = std::ranges::find(parts.columns, output.name, &Column::name);
    parts.column_of.push_back(
        at == parts.columns.end() ? -1 : static_cast<int>(at - parts.columns.begin()));
  }
  parts.alone = parts.problem.model();
  parts.raw.resize(parts.problem.outputs.size());
}

void DesignModel::outputs(std::span<const double> values, std::span<double> outputs) {
  parts_->alone(values, parts_->raw);
  parts_->take(values, parts_->raw, outputs);
}

void DesignModel::outputs(std::span<const Row> rows) {
  auto& parts = *parts_;
  if (!parts.batch) parts.batch = parts.problem.batch();
  const std::size_t width = parts.problem.outputs.size();
  std::vector<double> raw(rows.size() * width);
  std::vector<Row> inner;
  for (std::size_t k = 0; k < rows.size(); ++k)
    inner.push_back({rows[k].inputs, std::span(raw).subspan(k * width, width)});
  parts.batch(inner);
  for (std::size_t k = 0; k < rows.size(); ++k)
    parts.take(rows[k].inputs, inner[k].outputs, rows[k].outputs);
}

namespace {

/// A step for central differences: small beside the number, or beside its range where it is zero.
double step_of(const Input& change, double value) {
  constexpr double relative = 1e-4, of_range = 1e-3;
  const double range = change.distribution.b - change.distribution.a;
  return relative * std::max(std::abs(value), of_range * range);
}

}  // namespace

ModesAndDerivatives DesignModel::Parts::modes(std::span<const double> values, ModelKind of) const {
  const auto nominal = machine_of(machine, changes, values);
  const auto center = dynamics::linear_model(nominal, at(nominal), of);
  const auto neighbour = [&](std::span<const double> numbers) {
    const auto changed = machine_of(machine, changes, numbers);
    return dynamics::neighbour_model(changed, at(changed), center);
  };
  ModesAndDerivatives result{.modes = modal::normal_modes(center)};
  std::vector<modal::ModelDerivative> derivatives;
  std::vector<double> moved(values.begin(), values.end());
  Eigen::VectorXd scales(static_cast<Eigen::Index>(changes.size()));
  for (std::size_t j = 0; j < changes.size(); ++j) {
    const double h = step_of(changes[j], values[j]);
    moved[j] = values[j] + h;
    const auto above = neighbour(moved);
    moved[j] = values[j] - h;
    const auto below = neighbour(moved);
    moved[j] = values[j];
    derivatives.push_back({(above.M - below.M) / (2.0 * h), (above.K - below.K) / (2.0 * h),
                           (above.C - below.C) / (2.0 * h)});
    scales[static_cast<Eigen::Index>(j)] = h;
  }
  modal::turn_repeated(result.modes, derivatives, scales);
  result.domega2 = modal::omega2_derivatives(result.modes, derivatives);
  return result;
}

std::optional<Eigen::RowVectorXd> DesignModel::Parts::mode_derivative(
    const OfMode& which, std::span<const double> outputs, int column,
    const ModesAndDerivatives& flexible, const ModesAndDerivatives* rigid) const {
  const double value = outputs[static_cast<std::size_t>(column)];
  if (!which.drop) return flexible.at(value, which.direction);
  if (rigid == nullptr) return {};
  const std::string of = which.direction < 0
                             ? "lowest"
                             : spatial::direction_names[static_cast<std::size_t>(which.direction)];
  const auto at = std::ranges::find(columns, of, &Column::name);
  const double hertz = outputs[static_cast<std::size_t>(at - columns.begin())];
  const double rigid_hertz = hertz / (1.0 - value);
  const auto slope = flexible.at(hertz, which.direction);
  const auto rigid_slope = rigid->at(rigid_hertz, which.direction);
  if (!slope || !rigid_slope) return {};
  return Eigen::RowVectorXd(-*slope / rigid_hertz +
                            hertz / (rigid_hertz * rigid_hertz) * *rigid_slope);
}

DesignModel::Derivatives DesignModel::derivatives(std::span<const double> values,
                                                  std::span<const double> outputs) {
  auto& parts = *parts_;
  const auto rows = static_cast<Eigen::Index>(parts.wanted.size());
  Derivatives result{
      .by_change = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(parts.changes.size())),
      .of_mode = std::vector<bool>(parts.wanted.size())};
  std::optional<ModesAndDerivatives> flexible, rigid;
  bool any = false, drop = false;
  for (const int column : parts.wanted) {
    const auto which = parts.mode_of(column);
    any = any || which.any;
    drop = drop || which.drop;
  }
  try {
    // of elastomers the outputs are frequencies of damped modes, which these are not
    if (any && !model::has_elastomers(parts.machine)) flexible = parts.modes(values, parts.kind);
    if (drop && flexible) rigid = parts.modes(values, ModelKind::rigid);
  } catch (const base::ComputationError&) {  // then by differences
  }
  bool all = true;
  for (std::size_t k = 0; k < parts.wanted.size(); ++k) {
    const int column = parts.wanted[k];
    const auto which = parts.mode_of(column);
    std::optional<Eigen::RowVectorXd> slope;
    if (which.any && flexible && std::isfinite(outputs[static_cast<std::size_t>(column)]))
      slope = parts.mode_derivative(which, outputs, column, *flexible, rigid ? &*rigid : nullptr);
    result.of_mode[k] = slope.has_value();
    if (slope) result.by_change.row(static_cast<Eigen::Index>(k)) = *slope;
    all = all && slope.has_value();
  }
  if (!all) add_differences(values, outputs, result);
  return result;
}

void DesignModel::add_differences(std::span<const double> values, std::span<const double> outputs,
                                  Derivatives& result) {
  auto& parts = *parts_;
  std::vector<double> moved(values.begin(), values.end()), above(outputs.size()),
      below(outputs.size());
  for (std::size_t j = 0; j < parts.changes.size(); ++j) {
    const double h = step_of(parts.changes[j], values[j]);
    moved[j] = values[j] + h;
    this->outputs(moved, above);
    moved[j] = values[j] - h;
    this->outputs(moved, below);
    moved[j] = values[j];
    for (std::size_t k = 0; k < parts.wanted.size(); ++k) {
      if (result.of_mode[k]) continue;
      const auto column = static_cast<std::size_t>(parts.wanted[k]);
      const double high = std::isfinite(above[column]) ? above[column] : outputs[column];
      const double low = std::isfinite(below[column]) ? below[column] : outputs[column];
      const double apart =
          (std::isfinite(above[column]) ? h : 0.0) + (std::isfinite(below[column]) ? h : 0.0);
      result.by_change(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j)) =
          apart > 0.0 && std::isfinite(high - low) ? (high - low) / apart : 0.0;
    }
  }
}

}  // namespace hydrapod::study
