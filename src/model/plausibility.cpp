#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "hydrapod/base/units.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/model/parameters.hpp"
#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

namespace {

/// What is usual where a row says nothing, and units that are written or forgotten for the SI one.
struct UsualForUnit {
  std::string_view unit{};
  double least{}, most{};
  std::array<std::string_view, 3> others{};
};
constexpr UsualForUnit usual_for_units[]{
    {"m", 0.0, 50.0, {"mm", "cm", "um"}},
    {"kg", 0.0, 1e8, {"t", "g"}},
    {"kg m^2", 0.0, 1e9, {"t m^2", "kg cm^2", "kg mm^2"}},
    {"N/m", 1e2, 1e13, {"N/mm", "kN/mm", "MN/m"}},
    {"N m/rad", 1e2, 1e14, {"kN m/rad", "MN m/rad"}},
    {"N s/m", 0.0, 1e10, {"N s/mm", "kN s/m"}},
    {"Pa", 0.0, 1e10, {"bar", "MPa", "GPa"}},
    {"m^2", 0.0, 100.0, {"cm^2", "mm^2"}},
    {"m^3", 0.0, 10.0, {"l", "cm^3", "mm^3"}},
    {"m^3/s", 0.0, 1.0, {"l/min", "l/s"}},
    {"rad", 0.0, base::two_pi*(1.0 + 1e-9), {"deg"}},
    {"rad/s", 0.0, 1e6, {}},
};

struct Range {
  double least{}, most{};
  [[nodiscard]] bool holds(double value) const {
    const double size = std::abs(value);
    return size == 0.0 || (size >= least && size <= most);
  }
};

std::string in(double value, std::string_view unit) {
  return unit == "1" ? fmt::format("{:.6g}", value) : fmt::format("{:.6g} {}", value, unit);
}

std::string usual_text(const Range& range, std::string_view unit) {
  if (range.least == 0.0) return fmt::format("usual are up to {}", in(range.most, unit));
  return fmt::format("usual are {} to {}", in(range.least, unit), in(range.most, unit));
}

struct Guess {
  double value{};  ///< [SI]
  std::string text{};
};

/// Moduli and strengths of materials are in MPa and GPa, pressures rather in bar.
using Units = std::array<std::string_view, 3>;
Units units_like(const UsualForUnit& known, const Range& range) {
  constexpr double of_materials = 1e9;  // [Pa] no oil is under this pressure
  const bool material = known.unit == "Pa" && range.most >= of_materials;
  return material ? Units{"MPa", "GPa", "bar"} : known.others;
}

/// "; did you mean 1050 mm?": the same digits in another unit, where that is usual. Either the unit
/// was forgotten, or it was written where another was meant.
std::optional<Guess> guess(double value, std::string_view unit, const Range& range) {
  for (const auto& known : usual_for_units) {
    if (known.unit != unit) continue;
    for (const auto other : units_like(known, range)) {
      if (other.empty()) continue;
      const double size = base::quantity(fmt::format("1 {}", other), unit);
      const double larger = value / size;
      if (range.holds(value * size))
        return Guess{value * size, fmt::format("; did you mean {}?", in(value, other))};
      if (range.holds(larger))
        return Guess{larger, fmt::format(", {} here; did you mean {}?", in(larger, other),
                                         in(larger, unit))};
    }
  }
  return {};
}

class Unusual {
 public:
  explicit Unusual(const Machine& machine) : machine_(machine), result_{.guessed = machine} {}

  UnusualNumbers find() {
    const auto rows = parameter_table();
    for (const auto& id : parameters(machine_)) {
      const auto& row = rows[id.row];
      const bool of_all_legs = row.path.starts_with(of_legs) && id.of == 0;
      const bool on_circle = (row.path == "leg.*.base_joint" && machine_.base_circle) ||
                             (row.path == "leg.*.platform_joint" && machine_.platform_circle);
      if (of_all_legs || on_circle || row.kind == Kind::tensor || shared_before(id)) continue;
      judge(id);
    }
    compare_masses();
    compare_inertia();
    return std::move(result_);
  }

 private:
  void add(std::string key, std::string message) {
    result_.findings.push_back({base::Severity::warning, std::move(key), std::move(message), true});
  }

  /// Do all legs have this number? Then leg 1 stands for them.
  [[nodiscard]] bool shared(ParameterId id) const {
    const auto [known, is_new] = shared_.try_emplace({id.row, id.element}, true);
    if (!is_new) return known->second;
    const auto first = value(machine_, id);
    for (id.of = 1; id.of <= leg_count && known->second; ++id.of) {
      id.legs = static_cast<std::uint16_t>(1U << static_cast<unsigned>(id.of - 1));
      known->second = value(machine_, id) == first;
    }
    return known->second;
  }
  [[nodiscard]] bool shared_before(const ParameterId& id) const {
    return row_of(id).path.starts_with(of_legs) && id.of > 1 && shared(id);
  }

  [[nodiscard]] std::string key_of(ParameterId id) const {
    if (row_of(id).path.starts_with(of_legs) && shared(id)) {
      id.of = 0;
      id.legs = ParameterId{}.legs;
    }
    return path(machine_, id);
  }

  /// Where leg 1 stands for all, all of them.
  void take(ParameterId id, double number) {
    if (row_of(id).path.starts_with(of_legs) && shared(id)) id.legs = ParameterId{}.legs;
    const std::array one{Assignment{id, number}};
    assign(result_.guessed, one);
  }

  void judge(const ParameterId& id) {
    const auto& row = row_of(id);
    const auto unit = unit_of(machine_, row);
    const double number = *value(machine_, id);
    Range range{row.bound.usual_least, row.bound.usual_most};
    if (range.most == 0.0) {
      const auto* known = std::ranges::find(usual_for_units, unit, &UsualForUnit::unit);
      if (known == std::end(usual_for_units)) return;
      range = {known->least, known->most};
    }
    if (!std::isfinite(number) || range.holds(number)) return;
    const bool rigid = is_spring_rate(unit) && number > range.most;
    const auto meant = rigid ? std::nullopt : guess(number, unit, range);
    if (meant) take(id, meant->value);
    add(key_of(id), fmt::format("is {}, {}{}", in(number, unit), usual_text(range, unit),
                                meant ? meant->text : (rigid ? "; did you mean \"rigid\"?" : "")));
  }

  /// Ten tonnes typed as ten kilograms is a mass that some machine may have, but not with such
  /// legs.
  void compare_masses() {
    constexpr double least = 0.05;  // of the legs' mass
    double legs = 0.0;
    for (const auto& leg : machine_.legs) legs += leg.cylinder_case.mass + leg.rod.mass;
    const double mass = machine_.platform.mass;
    if (!(mass > 0.0 && mass < least * legs) || !std::isfinite(legs)) return;
    constexpr double heaviest = 2e6;  // [kg]
    const auto meant = guess(mass, "kg", {least * legs, heaviest});
    if (meant) result_.guessed.platform.mass = meant->value;
    add("platform.mass", fmt::format("is {}, less than a twentieth of the legs' {}{}",
                                     in(mass, "kg"), in(legs, "kg"), meant ? meant->text : ""));
  }

  /// The radius of gyration against the circle of the joints.
  void compare_inertia() {
    constexpr double least = 0.02, most = 20.0;  // of the largest distance of a joint
    double size = 0.0;
    for (const auto& leg : machine_.legs) size = std::max(size, leg.platform_joint.norm());
    const double mass = machine_.platform.mass, largest = machine_.platform.inertia.trace() / 2.0;
    if (!(mass > 0.0) || !(largest > 0.0) || !std::isfinite(largest) || !(size > 0.0)) return;
    const double radius = std::sqrt(largest / mass);
    if (radius >= least * size && radius <= most * size) return;
    if (std::ranges::any_of(result_.findings, [](const Finding& finding) {
          return finding.key.starts_with("platform.");
        }))
      return;  // the mass, or the joints
    add("platform.inertia",
        fmt::format("goes with a radius of gyration of {:.3g} m for {}; the joints are {:.3g} m "
                    "from the origin",
                    radius, in(mass, "kg"), size));
  }

  const Machine& machine_;
  UnusualNumbers result_{};
  mutable std::map<std::pair<std::uint16_t, std::int16_t>, bool> shared_{};  ///< row and element
};

}  // namespace

UnusualNumbers unusual_numbers(const Machine& machine) { return Unusual(machine).find(); }

}  // namespace hydrapod::model
