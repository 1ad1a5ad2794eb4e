#include "extra_outputs.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/capability.hpp"
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

/// All of them; a machine has some.
struct Extra {
  enum { buckling, power, sag, oil_force, stiffness, first_ability = stiffness + 6 };
  static constexpr int count = first_ability + 6 * simulation::ability_count;
};
using Values = std::array<double, Extra::count>;

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

std::vector<Column> all_columns(model::LegType type) {
  std::vector<Column> columns{
      {"buckling", "kg", "payload at which the legs buckle; none: not found"},
      {"power", "W", "supply pressure above return pressure times the flow of the pump",
       Worse::more},
      {"sag", "m", "largest static offset of a rod at its guide sleeve", Worse::more},
      {"oil_force", "N",
       fmt::format("largest static force {}, pushed or pulled", axial_words(type)), Worse::more}};
  for (std::size_t d = 0; d < 6; ++d)
    columns.push_back(
        {fmt::format("stiffness_{}", spatial::direction_names[d]), d < 3 ? "N/m" : "N m/rad",
         fmt::format("static stiffness in {}, free in the other directions, oil shut in",
                     spatial::direction_names[d])});
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
std::optional<std::string> why_missing(const model::Machine& machine, ModelKind kind, int extra) {
  const auto type = model::leg_type(machine);
  const auto without = [&](const char* what) {
    return fmt::format("{}, and {}s have none", what, model::name(type));
  };
  const bool screws = type == model::LegType::screw, struts = type == model::LegType::strut;
  if (extra == Extra::buckling)
    return kind == ModelKind::rigid
               ? std::optional<std::string>("is of flexible legs, and rigid legs do not buckle")
               : std::nullopt;
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

double pump_power(const model::Supply& supply) {
  if (!supply.pump_flow) return missing;
  return (supply.pressure - supply.return_pressure) * *supply.pump_flow;
}

void add_statics(const model::Machine& machine, const LinearModel& linear, Values& values) {
  values[Extra::sag] = values[Extra::oil_force] = 0.0;
  if (machine.gravity.isZero(0.0)) return;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    values[Extra::sag] = std::max(values[Extra::sag], linear.legs[at].sleeve_offset.norm());
    values[Extra::oil_force] =
        std::max(values[Extra::oil_force], std::abs(linear.statics.legs[at].oil_force));
  }
}

/// Oil is shut in and does not leak; elastomers have relaxed.
void add_stiffness(const LinearModel& linear, Values& values) {
  Eigen::MatrixXd K = linear.K;
  for (const auto& arm : linear.arms)
    if (arm.what != dynamics::Relaxing::oil) K -= arm.stiffness * arm.s_y * arm.s_y.transpose();
  const Eigen::LLT<Eigen::MatrixXd> factor(K);
  if (factor.info() != Eigen::Success) return;
  const Eigen::MatrixXd compliance = factor.solve(Eigen::MatrixXd::Identity(linear.dof(), 6));
  for (int d = 0; d < 6; ++d)
    values[Extra::stiffness + static_cast<std::size_t>(d)] = 1.0 / compliance(d, d);
}

void add_abilities(const simulation::Capability& found, Values& values) {
  for (std::size_t a = 0; a < abilities.size(); ++a)
    for (int d = 0; d < 6; ++d)
      values[Extra::first_ability + 6 * a + static_cast<std::size_t>(d)] =
          std::min(found.of(abilities[a], d, 0).value, found.of(abilities[a], d, 1).value);
}

/// Of what the machine does not have an answer to, the values stay.
template <class Add>
void where_there_is_one(const Add& add) {
  try {
    add();
  } catch (const base::ComputationError&) {  // then they stay without a value
  }
}

}  // namespace

std::vector<Column> extra_outputs(const model::Machine& machine, ModelKind kind) {
  const auto all = all_columns(model::leg_type(machine));
  std::vector<Column> columns;
  for (int extra = 0; extra < Extra::count; ++extra)
    if (!why_missing(machine, kind, extra)) columns.push_back(all[static_cast<std::size_t>(extra)]);
  return columns;
}

std::optional<std::string> why_no_extra(const model::Machine& machine, ModelKind kind,
                                        std::string_view name) {
  const auto all = all_columns(model::leg_type(machine));
  const auto found = std::ranges::find(all, name, &Column::name);
  if (found == all.end()) return std::nullopt;
  return why_missing(machine, kind, static_cast<int>(found - all.begin()));
}

ExtraOutputs::ExtraOutputs(const model::Machine& machine, ModelKind kind,
                           const std::vector<std::string>& wanted)
    : kind_(kind) {
  const auto all = all_columns(model::leg_type(machine));
  for (int extra = 0; extra < Extra::count; ++extra) {
    const auto& column = all[static_cast<std::size_t>(extra)];
    if (std::ranges::count(wanted, column.name) == 0 || why_missing(machine, kind, extra)) continue;
    columns_.push_back(column);
    kinds_.push_back(extra);
    linear_ = linear_ || (extra >= Extra::sag && extra < Extra::first_ability);
    capability_ = capability_ || extra >= Extra::first_ability;
  }
}

void ExtraOutputs::operator()(const model::Machine& machine, const spatial::Pose& X_BP,
                              std::span<double> outputs) const {
  if (columns_.empty()) return;
  Values values;
  values.fill(missing);
  values[Extra::power] = pump_power(machine.hydraulics.supply);
  if (kinds_.front() == Extra::buckling)
    where_there_is_one([&] {
      const auto found = dynamics::buckling_payload(machine, X_BP, kind_);
      if (found.status != dynamics::BucklingStatus::not_found)
        values[Extra::buckling] = found.payload;
    });
  if (linear_)
    where_there_is_one([&] {
      const auto linear = dynamics::linear_model(machine, X_BP, kind_);
      add_statics(machine, linear, values);
      add_stiffness(linear, values);
    });
  if (capability_)
    where_there_is_one([&] {
      if (const auto found = simulation::capability(machine, X_BP, kind_, false))
        add_abilities(*found, values);
    });
  for (std::size_t k = 0; k < kinds_.size(); ++k)
    outputs[k] = values[static_cast<std::size_t>(kinds_[k])];
}

void ExtraOutputs::only_buckling(std::span<double> outputs) const {
  for (std::size_t k = 0; k < kinds_.size(); ++k)
    if (kinds_[k] != Extra::buckling) outputs[k] = missing;
}

}  // namespace hydrapod::study
