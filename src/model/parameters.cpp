#include "hydrapod/model/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "hydrapod/base/text.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/model/section.hpp"
#include "parameter_access.hpp"

namespace hydrapod::model {

namespace {

constexpr unsigned all_legs = 0x3F;
constexpr std::string_view of_leg = "leg.*.", of_poses = "poses.*.", of_modes = "payload_modes.*.";
constexpr std::array tensor_elements{"xx", "yy", "zz", "xy", "xz", "yz"};

bool is_of_legs(const ParameterRow& row) {
  return row.path.starts_with(of_legs) || row.path.starts_with(of_leg);
}

/// Does the row hold numbers?
bool has_numbers(const ParameterRow& row) { return row.make != nullptr || row.get != nullptr; }

/// May one number stand for all of the row?
bool may_be_whole(const ParameterRow& row) {
  return row.kind == Kind::six || row.path == "environment.gravity";
}

/// The leg, pose or mode of the payload in which a number stands.
int index_of(const ParameterId& id) {
  if (is_of_legs(row_of(id))) return id.legs == 0 ? 0 : std::countr_zero(unsigned{id.legs});
  return id.of - 1;
}

std::optional<double> value_in(const Machine& machine, const ParameterId& id, int index) {
  const auto& row = row_of(id);
  if (is_of_legs(row) && !rows_of(leg_type(machine.legs[static_cast<std::size_t>(index)]))[id.row])
    return std::nullopt;
  if (row.get != nullptr) return row.get(machine, index, id.element);
  const auto* number = row.find(const_cast<Machine&>(machine), index, std::max<int>(id.element, 0));
  if (number == nullptr) return std::nullopt;
  return *number;
}

/// "[2]", ".xy", or nothing.
std::string element_text(const ParameterRow& row, int element) {
  if (row.kind == Kind::tensor) return fmt::format(".{}", tensor_elements.at(element));
  if (row.numbers == 1 || element == whole) return "";
  return fmt::format("[{}]", element);
}

/// The element that the end of a path means; nothing where the row has none such.
std::optional<int> element_at(const ParameterRow& row, std::string_view rest) {
  if (rest.empty()) {
    if (row.numbers == 1) return 0;
    if (may_be_whole(row)) return whole;
    return std::nullopt;
  }
  for (int element = 0; element < row.numbers; ++element)
    if (rest == element_text(row, element)) return element;
  return std::nullopt;
}

/// The number at `path` in that row; `shared`: "legs.", "leg.3." in front instead of the row's.
std::optional<ParameterId> in_table(std::string_view front, std::string_view rest, int of,
                                    unsigned legs) {
  const auto rows = parameter_table();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto& row = rows[r];
    if (!has_numbers(row) || !row.path.starts_with(front)) continue;
    const auto key = row.path.substr(front.size());
    if (!rest.starts_with(key)) continue;
    if (const auto element = element_at(row, rest.substr(key.size())))
      return ParameterId{static_cast<std::uint16_t>(r), static_cast<std::int16_t>(*element),
                         static_cast<std::int16_t>(of), static_cast<std::uint16_t>(legs)};
  }
  return std::nullopt;
}

/// The row of the table that row `r` stands in, or above it; itself where there is none.
std::size_t table_above(std::size_t r) {
  const auto rows = parameter_table();
  const auto path = table_of(rows[r].path);
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.path == path; });
  return found == rows.end() ? r : static_cast<std::size_t>(found - rows.begin());
}

/// table_above() of every row.
const std::vector<std::size_t>& tables_above() {
  static const std::vector<std::size_t> tables = [] {
    std::vector<std::size_t> above(parameter_table().size());
    for (std::size_t r = 0; r < above.size(); ++r) above[r] = table_above(r);
    return above;
  }();
  return tables;
}

/// Per row, the functions `instead` of the row and of the tables above it.
const std::vector<std::vector<decltype(ParameterRow::instead)>>& replacements() {
  static const auto all = [] {
    const auto rows = parameter_table();
    const auto& above = tables_above();
    std::vector<std::vector<decltype(ParameterRow::instead)>> found(rows.size());
    for (std::size_t row = 0; row < rows.size(); ++row)
      for (std::size_t r = row;; r = above[r]) {
        if (rows[r].instead != nullptr) found[row].push_back(rows[r].instead);
        if (above[r] == r) break;
      }
    return found;
  }();
  return all;
}

void set(Machine& machine, const Assignment& assignment) {
  const auto& id = assignment.id;
  const double value = assignment.value;
  const auto& row = row_of(id);
  const auto& replacing = replacements()[id.row];
  const auto set_in = [&](int index) {
    for (const auto replace : replacing) replace(machine, index);
    if (row.set != nullptr) return row.set(machine, index, id.element, value);
    const bool all = id.element == whole;
    const int first = all ? 0 : id.element, end = all ? row.numbers : first + 1;
    for (int element = first; element < end; ++element) *row.make(machine, index, element) = value;
  };
  if (!is_of_legs(row)) return set_in(id.of - 1);
  for (int leg = 0; leg < leg_count; ++leg) {
    if ((id.legs >> leg & 1) == 0) continue;
    const auto type = leg_type(machine.legs[static_cast<std::size_t>(leg)]);
    if (!rows_of(type)[id.row])
      throw std::invalid_argument(fmt::format("{}: a {} has no such number", row.path, name(type)));
    set_in(leg);
  }
}

/// Does the id stand for all legs, or for joints that all legs share?
bool is_shared(const ParameterId& id) {
  return id.of == 0 && (is_of_legs(row_of(id)) || row_of(id).finish != nullptr);
}

/// The legs for which the file says something of their own instead of what `id` says.
unsigned own_legs(const MachineFile& file, const ParameterId& id) {
  std::string_view instead = row_of(id).path;
  if (instead.starts_with("base.joints")) instead = "leg.*.base_joint";
  if (instead.starts_with("platform.joints")) instead = "leg.*.platform_joint";
  unsigned own = 0;
  for (const auto& given : file.given)
    if (given.id.of != 0 && row_of(given.id).path == instead) own |= given.id.legs;
  return own;
}

/// Of the legs of `id` those that have its number: a leg may have a stiffness in place of a
/// cylinder. 0: none has it yet.
std::uint16_t legs_that_hold(const Machine& machine, const ParameterId& id) {
  unsigned holding = 0;
  for (int leg = 0; leg < leg_count && is_of_legs(row_of(id)); ++leg)
    if ((id.legs >> leg & 1U) != 0 && value_in(machine, id, leg)) holding |= 1U << leg;
  return static_cast<std::uint16_t>(holding);
}

/// Number of the mode of the payload that has that name, or will have it; −1: none.
int payload_mode_called(const Machine& machine, std::string_view name) {
  const auto& modes = machine.payload_modes;
  const auto found = std::ranges::find(modes, name, &PayloadMode::name);
  if (found != modes.end()) return static_cast<int>(found - modes.begin());
  auto longer = machine.payload_modes;
  while (longer.size() < most_payload_modes) {
    const int next = static_cast<int>(longer.size());
    Machine with_these;
    with_these.payload_modes = longer;
    longer.push_back({.name = next_payload_mode(with_these, next)});
    if (longer.back().name == name) return next;
  }
  return -1;
}

}  // namespace

std::string next_payload_mode(const Machine& machine, int index) {
  std::string name;
  for (int number = index + 1;; ++number) {  // its own number, or the next that is free
    name = fmt::format("mode_{}", number);
    if (std::ranges::count(machine.payload_modes, name, &PayloadMode::name) == 0) return name;
  }
}

const NamedPose* find_pose(const Machine& machine, std::string_view name) {
  const auto found = std::ranges::find(machine.poses, name, &NamedPose::name);
  return found == machine.poses.end() ? nullptr : &*found;
}

const ParameterRow& row_of(const ParameterId& id) { return parameter_table()[id.row]; }

std::optional<ParameterId> find_parameter(const Machine& machine, std::string_view path) {
  const auto steps = parse_path(path);
  if (!steps) return std::nullopt;
  const std::string text = to_string(*steps);
  const auto below = [&](std::size_t first) {
    return to_string(KeyPath(steps->begin() + static_cast<long>(first), steps->end()));
  };
  if (steps->size() > 2 && (*steps)[0].key == "leg") {
    for (int leg = 1; leg <= leg_count; ++leg) {
      if ((*steps)[1].key != std::to_string(leg)) continue;
      if (auto id = in_table(of_legs, below(2), leg, 1U << (leg - 1))) return id;
      return in_table(of_leg, below(2), leg, 1U << (leg - 1));
    }
    return std::nullopt;
  }
  if (steps->size() > 2 && (*steps)[0].key == "poses") {
    for (std::size_t p = 0; p < machine.poses.size(); ++p)
      if ((*steps)[1].key == machine.poses[p].name)
        return in_table(of_poses, below(2), static_cast<int>(p) + 1, all_legs);
    return std::nullopt;
  }
  if (steps->size() > 2 && (*steps)[0].key == "payload_modes") {
    const int mode = payload_mode_called(machine, (*steps)[1].key);
    return mode < 0 ? std::nullopt : in_table(of_modes, below(2), mode + 1, all_legs);
  }
  return in_table("", text, 0, all_legs);
}

std::optional<ParameterId> in_file(const MachineFile& file, ParameterId id) {
  if (!is_shared(id)) return id;
  id.legs = static_cast<std::uint16_t>(all_legs & ~own_legs(file, id));
  if (id.legs == 0) return std::nullopt;
  if (const auto holding = legs_that_hold(file.machine, id); holding != 0) id.legs = holding;
  return id;
}

std::optional<ParameterId> find_parameter(const MachineFile& file, std::string_view path) {
  const auto written = std::find_if(file.given.begin(), file.given.end(),
                                    [&](const auto& given) { return given.written == path; });
  const auto id = written != file.given.end() ? written->id : find_parameter(file.machine, path);
  return id ? in_file(file, *id) : std::nullopt;
}

std::optional<FileNumber> number_of(const MachineFile& file, const ParameterId& id) {
  const auto number = value(file.machine, id);
  if (!number) return std::nullopt;
  return FileNumber{path(file.machine, id), std::string{unit(file.machine, id)}, *number, id};
}

std::optional<FileNumber> find_number(const MachineFile& file, std::string_view text) {
  const auto id = find_parameter(file, text);
  // one number stands for all of a row only where the file gives it so
  if (!id || (id->element == whole && std::ranges::count(file.given, *id, &GivenNumber::id) == 0))
    return std::nullopt;
  return number_of(file, *id);
}

std::string nearest_parameter(const MachineFile& file, std::string_view text) {
  std::vector<std::string> paths;
  for (const auto& id : parameters(file.machine)) paths.push_back(path(file.machine, id));
  const std::vector<std::string_view> views(paths.begin(), paths.end());
  return std::string{base::nearest(text, views).value_or("")};
}

std::string path(const Machine& machine, const ParameterId& id) {
  const auto& row = row_of(id);
  const std::string element = element_text(row, id.element);
  const auto below = [&](std::string_view front) { return row.path.substr(front.size()); };
  if (row.path.starts_with(of_poses))
    return fmt::format("poses.{}.{}{}", written_key(machine.poses.at(id.of - 1).name),
                       below(of_poses), element);
  if (row.path.starts_with(of_modes)) {
    const auto& modes = machine.payload_modes;
    const auto at = static_cast<std::size_t>(id.of - 1);
    const std::string name =
        at < modes.size() ? modes[at].name : next_payload_mode(machine, id.of - 1);
    return fmt::format("payload_modes.{}.{}{}", written_key(name), below(of_modes), element);
  }
  if (row.path.starts_with(of_leg))
    return fmt::format("leg.{}.{}{}", id.of, below(of_leg), element);
  if (row.path.starts_with(of_legs) && id.of != 0)
    return fmt::format("leg.{}.{}{}", id.of, below(of_legs), element);
  return fmt::format("{}{}", row.path, element);
}

std::string_view unit(const Machine& machine, const ParameterId& id) {
  return unit_of(machine, row_of(id));
}

std::string_view unit_of(const Machine& machine, const ParameterRow& row) {
  return row.other_unit != nullptr ? row.other_unit(machine, row.unit) : row.unit;
}

std::string_view last_key(std::string_view path) { return path.substr(path.rfind('.') + 1); }

std::string_view table_of(std::string_view path) {
  const auto dot = path.rfind('.');
  return path.substr(0, dot == std::string_view::npos ? 0 : dot);
}

namespace {
/// In every machine.
bool always_of_mechanics(const ParameterId& id) {
  const auto rows = parameter_table();
  const auto& above = tables_above();
  for (std::size_t r = id.row;; r = above[r]) {
    if (!rows[r].mechanics) return false;
    if (above[r] == r) return true;
  }
}
}  // namespace

bool of_mechanics(const Machine& machine, const ParameterId& id) {
  if (always_of_mechanics(id)) return true;
  constexpr std::array<std::string_view, 5> of_beams{"legs.case.diameter", "legs.case.wall",
                                                     "legs.rod.diameter", "legs.rod.wall",
                                                     "legs.rod.youngs_modulus"};
  if (has_elastic_legs(machine) && std::ranges::count(of_beams, row_of(id).path) > 0) return true;
  const std::string_view path = row_of(id).path;
  if (has_chambers(machine) && path.starts_with("legs.friction.")) return true;
  if (!has_chambers(machine) && !has_pressed_seals(machine)) return false;
  constexpr std::array<std::string_view, 4> of_pressures{"legs.valve.", "legs.leakage.",
                                                         "legs.equivalent_cylinder.", "supply."};
  return std::ranges::any_of(of_pressures,
                             [&](std::string_view table) { return path.starts_with(table); });
}

std::optional<double> value(const Machine& machine, const ParameterId& id) {
  return value_in(machine, id, index_of(id));
}

std::vector<ParameterId> parameters(const Machine& machine) {
  std::vector<ParameterId> ids;
  const auto add = [&](std::size_t r, int of, unsigned legs) {
    for (int element = 0; element < parameter_table()[r].numbers; ++element) {
      const ParameterId id{static_cast<std::uint16_t>(r), static_cast<std::int16_t>(element),
                           static_cast<std::int16_t>(of), static_cast<std::uint16_t>(legs)};
      if (value(machine, id)) ids.push_back(id);
    }
  };
  const auto rows = parameter_table();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!has_numbers(rows[r])) continue;
    const int poses = static_cast<int>(machine.poses.size());
    if (rows[r].path.starts_with(of_poses)) {
      for (int pose = 1; pose <= poses; ++pose) add(r, pose, all_legs);
      continue;
    }
    if (rows[r].path.starts_with(of_modes)) {
      const int modes = static_cast<int>(machine.payload_modes.size());
      for (int mode = 1; mode <= modes; ++mode) add(r, mode, all_legs);
      continue;
    }
    if (!rows[r].path.starts_with(of_leg)) add(r, 0, all_legs);
    if (!is_of_legs(rows[r])) continue;
    for (int leg = 1; leg <= leg_count; ++leg) add(r, leg, 1U << (leg - 1));
  }
  return ids;
}

void assign(Machine& machine, std::span<const Assignment> assignments) {
  for (const auto& assignment : assignments)
    if (assignment.id.of == 0) set(machine, assignment);
  for (const auto& assignment : assignments)
    if (assignment.id.of != 0) set(machine, assignment);
  for (const auto& [id, value] : assignments)
    if (row_of(id).finish != nullptr) row_of(id).finish(machine, id.legs);
}

Machine with(Machine machine, std::span<const Assignment> assignments) {
  assign(machine, assignments);
  return machine;
}

}  // namespace hydrapod::model
