#include "hydrapod/report/model_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "fields.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

constexpr double litres_per_minute = 6e4;  ///< in a m³/s

/// "leg 3", "legs 1, 2 and 5", "all legs".
std::string legs_text(const std::vector<int>& legs) {
  if (legs.empty()) return {};
  if (legs.size() == model::leg_count) return "all legs";
  std::string text = fmt::format("leg{} {}", legs.size() > 1 ? "s" : "", legs[0] + 1);
  for (size_t k = 1; k < legs.size(); ++k)
    text += fmt::format("{} {}", k + 1 == legs.size() ? " and" : ",", legs[k] + 1);
  return text;
}

}  // namespace

std::string mass_text(double mass) {
  constexpr double in_full = 1e4, too_long = 1e9;
  const double size = std::abs(mass);
  return size < in_full || size >= too_long ? fmt::format("{:.4g} kg", mass)
                                            : fmt::format("{:.0f} kg", mass);
}

std::string warning_text(const PoseWarning& warning) {
  static constexpr std::array texts{
      "the legs buckle under the present load: remove {mass}, or use stiffer guide sleeves",
      "the legs buckle with {mass} more on the platform (in all {ratio:.3g} times its mass)",
      "no static equilibrium was found at this pose",
      "{legs}: only {millimetres:.3g} mm of stroke left",
      "{legs}: the piston is only {millimetres:.3g} mm from the guide sleeve; the tilt stiffness "
      "is low there",
      "{legs}: the static load tilts the rod in its seals by {degrees:.2g}°",
      "the pose is close to a singular pose: condition {value:.3g}",
      "{legs}: the oil can give {limit} at the supply pressure, and {force} are to be held; "
      "expected a higher supply.pressure, a larger bore or less mass",
      "{legs}: the chambers rest at {bar:.3g} bar, and the air in the oil is stated at "
      "{stated_bar:.3g} bar (cylinder.air.pressure): oil springs are those of the stated pressure, "
      "simulations and open or closed loops have those at rest",
      "{legs}: the rod buckles: {force} are to be held, and as a column the leg bears {limit}; "
      "expected a thicker rod, a longer guide or less mass",
      "{legs}: as a column the leg bears {value:.2g} times the static force; usual are 3.5 times",
      "{legs}: the oil can push with {force}, and the rod buckles at {limit}",
      "{legs}: the rod lies on its guide ring: its axis is {millimetres:.3g} mm off the centre, "
      "the gap is {gap:.3g} mm",
      "the oil springs do not hold the platform: with rigid guide sleeves it is unstable too; "
      "{relief}use stiffer oil springs (legs.oil_spring)",
      "the pump gives {flow:.4g} l/min, and the valves leak {leakage:.4g} l/min at rest; expected "
      "a larger supply.pump_flow or less leakage",
      "{legs}: {force} of friction hold the piston, and the oil has {limit} beside the load; "
      "expected less legs.friction or a higher supply.pressure",
      "{legs}: {force} of friction are {percent:.0f} % of what the oil can push with; usual are "
      "some percent",
      "the struts do not hold the platform: the machine is unstable; {relief}use stiffer struts "
      "(legs.strut)",
      "the screws do not hold the platform: with rigid guide sleeves it is unstable too; "
      "{relief}use stiffer screws (legs.screw)",
      "{legs}: the motor can move {limit}, and the load is {force}; expected a higher "
      "legs.screw.torque_limit, a smaller lead or less mass",
      "{legs}: the motor can push with {force}, and the rod buckles at {limit}",
      "{legs}: at rest the rod is {millimetres:.3g} mm off the centre of its guide sleeve, farther "
      "than usual guide rings let it; state their gap and stiffness (legs.guide_sleeve.gap, "
      "guide_stiffness), else frequencies are those of seals without a guide"};
  const double value = warning.value;
  const std::string mass = mass_text(value), legs = legs_text(warning.legs);
  return fmt::format(
      fmt::runtime(texts.at(static_cast<std::size_t>(warning.kind))), fmt::arg("value", value),
      fmt::arg("ratio", warning.ratio), fmt::arg("mass", mass),
      fmt::arg("relief", value > 0.0 ? "remove " + mass + ", or " : ""), fmt::arg("legs", legs),
      fmt::arg("millimetres", 1e3 * value), fmt::arg("bar", 1e-5 * value),
      fmt::arg("flow", litres_per_minute * value),
      fmt::arg("leakage", litres_per_minute * warning.ratio),
      fmt::arg("percent", 100.0 * value / warning.ratio), fmt::arg("gap", 1e3 * warning.ratio),
      fmt::arg("stated_bar", 1e-5 * warning.ratio),
      fmt::arg("force", fmt::format("{:.4g} kN", 1e-3 * value)),
      fmt::arg("limit", fmt::format("{:.4g} kN", 1e-3 * warning.ratio)),
      fmt::arg("degrees", value * (180.0 / std::numbers::pi)));
}

bool is_fatal(PoseWarning::Kind kind) {
  using Kind = PoseWarning::Kind;
  return kind == Kind::buckled || kind == Kind::no_equilibrium || kind == Kind::weak_supply ||
         kind == Kind::rod_buckles || kind == Kind::soft_oil || kind == Kind::weak_pump ||
         kind == Kind::stuck || kind == Kind::soft_struts || kind == Kind::soft_screws ||
         kind == Kind::weak_motor;
}

bool is_sound(const PoseCheck& check) {
  return std::ranges::none_of(check.warnings,
                              [](const PoseWarning& warning) { return is_fatal(warning.kind); });
}

namespace {

/// "platform.mass is 10 kg": what was found, without what would be usual.
std::string number_text(const model::Finding& finding) {
  return finding.key + " " + finding.message.substr(0, finding.message.find_first_of(",;"));
}

/// "implausible number: legs.oil_spring.cylinder.bore is 100 m"; empty where there is none.
std::string numbers_text(std::string_view what, const std::vector<std::string>& numbers) {
  constexpr std::size_t most = 3;
  if (numbers.empty()) return {};
  const auto shown = std::min(numbers.size(), most);
  std::string text = fmt::format("{} number{}: {}", what, numbers.size() > 1 ? "s" : "",
                                 fmt::join(numbers.begin(), numbers.begin() + shown, ", "));
  if (numbers.size() > shown) text += fmt::format(" and {} more", numbers.size() - shown);
  return text;
}

/// Poses named in a sentence.
constexpr std::size_t most_named = 6;

std::string first_names(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names.begin(), names.begin() + most_named, ", "));
}

/// Of two warnings of a kind.
bool is_worse(const PoseWarning& one, const PoseWarning& other) {
  using Kind = PoseWarning::Kind;
  switch (one.kind) {
    case Kind::near_buckling:
    case Kind::little_stroke:
    case Kind::short_guide:
    case Kind::little_reserve:
      return one.value < other.value;
    case Kind::slender_rod:
    case Kind::slender_screw:
      return one.ratio < other.ratio;
    case Kind::weak_pump:
      return one.ratio > other.ratio;
    default:
      return one.value > other.value;
  }
}

/// Of the pose at which the valves leak most; null where the pump covers the leakage at all.
const PoseWarning* weakest_pump(const std::vector<PoseCheck>& poses) {
  const PoseWarning* weakest = nullptr;
  for (const auto& check : poses)
    for (const auto& warning : check.warnings)
      if (warning.kind == PoseWarning::Kind::weak_pump &&
          (weakest == nullptr || warning.ratio > weakest->ratio))
        weakest = &warning;
  return weakest;
}

struct NumbersToSay {
  std::vector<std::string> implausible{}, unusual{};
};

NumbersToSay numbers_to_say(const model::Machine& machine) {
  NumbersToSay numbers;
  for (const auto& finding : model::unusual_numbers(machine).findings)
    (is_implausible(machine, finding) ? numbers.implausible : numbers.unusual)
        .push_back(number_text(finding));
  return numbers;
}

}  // namespace

std::vector<std::string> warnings_by_cause(const std::vector<PoseCheck>& poses) {
  struct Cause {
    const PoseWarning* worst;
    std::string pose;                 ///< where it is worst
    std::vector<std::string> others;  ///< poses
  };
  std::vector<Cause> causes;
  for (const auto& check : poses)
    for (const auto& warning : check.warnings) {
      const auto cause = std::ranges::find_if(
          causes, [&](const auto& known) { return known.worst->kind == warning.kind; });
      if (cause == causes.end()) {
        causes.push_back({&warning, check.pose.name, {}});
      } else if (is_worse(warning, *cause->worst)) {
        cause->others.push_back(std::exchange(cause->pose, check.pose.name));
        cause->worst = &warning;
      } else {
        cause->others.push_back(check.pose.name);
      }
    }
  std::vector<std::string> texts;
  for (const auto& cause : causes) {
    const auto& others = cause.others;
    texts.push_back(
        warning_text(*cause.worst) + " (pose " + cause.pose +
        (others.empty() ? ")"
         : others.size() > most_named
             ? fmt::format("; also at {} others: {}, …)", others.size(), first_names(others))
             : fmt::format("; also {})", fmt::join(others, ", "))));
  }
  return texts;
}

bool is_implausible(const model::Machine& machine, const model::Finding& finding) {
  const auto id = model::find_parameter(machine, finding.key);
  if (!id || model::row_of(*id).kind == model::Kind::tensor) return false;
  const auto& bound = model::row_of(*id).bound;
  const double size = std::abs(model::value(machine, *id).value_or(0.0));
  return bound.usual_most == 0.0 || size < bound.usual_least || size > bound.usual_most;
}

bool is_sound(const std::vector<PoseCheck>& poses, const model::Machine& machine) {
  return std::ranges::all_of(poses, [](const auto& check) { return is_sound(check); }) &&
         numbers_to_say(machine).implausible.empty();
}

std::string verdict_text(const std::vector<PoseCheck>& poses, const model::Machine& machine) {
  using Kind = PoseWarning::Kind;
  std::vector<std::string> reasons;
  const auto add = [&](Kind kind, std::string_view what) {
    std::vector<std::string> names;
    for (const auto& check : poses)
      if (std::ranges::find(check.warnings, kind, &PoseWarning::kind) != check.warnings.end())
        names.push_back(check.pose.name);
    if (names.empty()) return;
    const bool all = names.size() == poses.size() && names.size() > 1;
    reasons.push_back(all ? fmt::format("{} at all {} poses", what, names.size())
                      : names.size() > most_named
                          ? fmt::format("{} at {} of {} poses: {}, …", what, names.size(),
                                        poses.size(), first_names(names))
                          : fmt::format("{} at pose{} {}", what, names.size() > 1 ? "s" : "",
                                        fmt::join(names, ", ")));
  };
  add(Kind::buckled, "the legs buckle");
  add(Kind::no_equilibrium, "no equilibrium was found");
  add(Kind::weak_supply, "the supply cannot hold the load");
  add(Kind::rod_buckles, "the rods buckle");
  add(Kind::soft_oil, "the oil springs do not hold the platform");
  add(Kind::soft_struts, "the struts do not hold the platform");
  add(Kind::soft_screws, "the screws do not hold the platform");
  add(Kind::weak_motor, "the motors cannot move the load");
  add(Kind::stuck, "the oil cannot move the legs against their friction");
  if (const auto* weak = weakest_pump(poses))
    add(Kind::weak_pump,
        fmt::format("the pump gives {:.4g} l/min and the valves leak {:.4g} l/min",
                    litres_per_minute * weak->value, litres_per_minute * weak->ratio));
  const auto numbers = numbers_to_say(machine);
  if (auto text = numbers_text("implausible", numbers.implausible); !text.empty())
    reasons.push_back(std::move(text));
  if (!reasons.empty()) return fmt::format("Not sound: {}.", fmt::join(reasons, "; "));
  const auto unusual = numbers_text("unusual", numbers.unusual);
  return fmt::format("Sound at {}{}.",
                     poses.size() == 1 ? "pose " + poses.front().pose.name
                                       : fmt::format("all {} poses", poses.size()),
                     unusual.empty() ? "" : "; " + unusual);
}

template <class Fields>
void describe(Fields& f, dynamics::ColumnStrength& column) {
  f("euler_N", column.euler);
  f("strength_N", column.strength);
  f("yields", column.yields);
}

template <class Fields>
void describe(Fields& f, simulation::Reach& reach) {
  f("value", reach.value);
  f.word("limit", reach.limit,
         words_of<simulation::Limit, simulation::limit_count>(&simulation::name));
  std::optional<int> number;
  if (reach.leg >= 0) number = reach.leg + 1;
  f.optional("leg", number);
  if constexpr (Fields::reads) reach.leg = number ? *number - 1 : -1;
}

template <class Fields>
void describe(Fields& f, simulation::LegAbility& leg) {
  f("force_N", leg.force);
  f("push_N", leg.push);
  f("pull_N", leg.pull);
  f.optional("column", leg.column);
  f("extending_m_s", leg.extending);
  f("retracting_m_s", leg.retracting);
  f("force_rate_out_N_s", leg.force_rate_out);
  f("force_rate_in_N_s", leg.force_rate_in);
}

template <class Fields>
void describe(Fields& f, simulation::Capability& capability) {
  f("legs", capability.legs);
  f.list("directions", 6, [&](auto& direction, std::size_t d) {
    direction.derived("direction", spatial::direction_names[d]);
    for (std::size_t k = 0; k < simulation::ability_count; ++k)
      direction(name(static_cast<simulation::Ability>(k)), capability.reach[k][d]);
  });
  f.object("combined", [&](auto& combined) {
    for (std::size_t k = 0; k < capability.combined.size(); ++k)
      combined(name(static_cast<simulation::Ability>(k)), capability.combined[k]);
  });
  f.optional("gain_limit_1_s", capability.gain_limit);
}

template <class Fields>
void describe(Fields& f, LegCheck& leg) {
  f("length_m", leg.length);
  f("piston_m", leg.piston);
  f("guided_length_m", leg.guided_length);
  f("oil_stiffness_N_m", leg.oil_stiffness);
  f("axial_force_N", leg.axial_force);
  f("static_tilt_rad", leg.tilt);
  f("sleeve_offset_m", leg.sleeve_offset);
  f.optional("ring_offset_m", leg.ring_offset);
  f.optional("guide_gap_m", leg.gap);
  f.optional("bending_m_N", leg.bending);
  f.optional("bow_m", leg.bow);
  f.optional("bow_growth", leg.bow_growth);
  f("base_joint_tilt_rad", leg.base_tilt);
  f("platform_joint_tilt_rad", leg.platform_tilt);
  f.optional("retract_left_m", leg.retract_left);
  f.optional("extend_left_m", leg.extend_left);
  f.optional("cap_pressure_Pa", leg.cap_pressure);
  f.optional("rod_pressure_Pa", leg.rod_pressure);
  f("largest_push_N", leg.largest_push);
  f("largest_pull_N", leg.largest_pull);
  f.optional("holding_torque_N_m", leg.holding_torque);
  f.optional("torque_limit_N_m", leg.torque_limit);
  f.optional("largest_speed_m_s", leg.largest_speed);
  f.optional("column", leg.column);
}

template <class Fields>
void describe(Fields& f, PoseWarning& warning) {
  static constexpr std::array words{
      "buckled",        "near_buckling", "no_equilibrium", "little_stroke", "short_guide",
      "tilted_rod",     "near_singular", "weak_supply",    "air_pressure",  "rod_buckles",
      "little_reserve", "slender_rod",   "rod_on_guide",   "soft_oil",      "weak_pump",
      "stuck",          "much_friction", "soft_struts",    "soft_screws",   "weak_motor",
      "slender_screw",  "no_gap_stated"};
  f.word("kind", warning.kind, words);
  f("value", warning.value);
  f("ratio", warning.ratio);
  f("legs", warning.legs);
}

template <class Fields>
void describe(Fields& f, PoseCheck& check) {
  f("pose", check.pose);
  f("condition", check.quality.condition);
  f("characteristic_length_m", check.quality.characteristic_length);
  f("equilibrium", check.equilibrium);
  f("legs", check.legs);
  f.object("buckling", [&](auto& b) {
    enum class Sought { found, not_found, buckled, not_sought };
    static constexpr std::array words{"found", "not_found", "buckled", "not_sought"};
    auto status =
        check.buckling_sought ? static_cast<Sought>(check.buckling.status) : Sought::not_sought;
    b.word("status", status, words);
    check.buckling_sought = status != Sought::not_sought;
    if (!check.buckling_sought) return;
    check.buckling.status = static_cast<dynamics::BucklingStatus>(status);
    if (check.buckling.status == dynamics::BucklingStatus::not_found) return;
    b("payload_kg", check.buckling.payload);
    b("limit_point", check.buckling.limit_point);
    b.optional("lowest_omega_rad_s", check.lowest_at_buckling);
  });
  f.optional("first_resonance_rad_s", check.first_resonance);
  f.optional("capability", check.capability);
  std::vector<std::string> words;
  for (const auto& warning : check.warnings) words.push_back(warning_text(warning));
  f.derived("sound", is_sound(check));
  f.derived("warnings", words);
  f("findings", check.warnings);
}

Json check_json(const std::vector<PoseCheck>& poses, const model::Machine& machine) {
  Json json{{"sound", is_sound(poses, machine)},
            {"unusual_numbers", Json::array()},
            {"simulation_assumptions", Json::array()},
            {"poses", written(poses)}};
  for (const auto& finding : model::unusual_numbers(machine).findings)
    json["unusual_numbers"].push_back({{"key", finding.key},
                                       {"text", finding.message},
                                       {"implausible", is_implausible(machine, finding)}});
  for (const auto& one : hydraulics::hydraulic_assumptions(machine))
    json["simulation_assumptions"].push_back({{"key", one.key}, {"text", one.text}});
  return json;
}

std::vector<PoseCheck> checks_from_json(const Json& json, const std::string& file) {
  std::vector<PoseCheck> poses;
  Reader(json, file)("poses", poses);
  return poses;
}

}  // namespace hydrapod::report
