#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "extra_outputs.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/study/design.hpp"
#include "machine_outputs.hpp"

namespace hydrapod::study {

namespace {

using dynamics::ModelKind;

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
Problem nominal_problem(const DesignProblem& problem, const model::NamedPose& pose,
                        std::vector<std::string> also) {
  const MachineOptions options{
      .kind = problem.kind, .X_BP = pose.X_BP, .also = std::move(also), .pose = pose.name};
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
  auto columns = nominal_problem(problem, problem.poses.front(), {}).outputs;
  const auto extra = extra_outputs(problem.machine, problem.kind);
  columns.insert(columns.end(), extra.begin(), extra.end());
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
  return why_no_extra(machine, kind, name);
}

struct DesignModel::Parts {
  model::Machine machine{};
  ModelKind kind{};
  model::NamedPose pose{};
  std::vector<Input> changes{};
  std::vector<Column> columns{};
  std::vector<int> wanted{};
  std::vector<OwnOutput> own{};  ///< the last columns; without a function: not wanted
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
    const auto behind = outputs.last(own.size());
    for (std::size_t k = 0; k < own.size(); ++k) behind[k] = own_value(own[k], values);
  }

  [[nodiscard]] double own_value(const OwnOutput& output, std::span<const double> values) const {
    if (!output.of) return missing;
    try {
      return output.of(values, pose);
    } catch (const base::ComputationError&) {
      return missing;
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
  parts.own = problem.own;
  const std::size_t first_own = problem.outputs.size() - parts.own.size();
  for (std::size_t k = 0; k < parts.own.size(); ++k)
    if (std::ranges::count(parts.wanted, static_cast<int>(first_own + k)) == 0)
      parts.own[k].of = {};
  std::vector<std::string> names;
  for (const int column : parts.wanted)
    if (const auto k = static_cast<std::size_t>(column); k < first_own)
      names.push_back(problem.outputs[k].name);
  parts.problem = nominal_problem(problem, pose, names);
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
