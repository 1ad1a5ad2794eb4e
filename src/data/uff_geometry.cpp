#include "uff_geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/text.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

constexpr std::size_t most_nodes = 1'000'000;

/// Of dataset 2412: rods, beams, pipes and rigid bars have a record more.
constexpr int rod = 11;
constexpr std::array beams{rod, 21, 22, 23, 24, 31, 32, 121};

struct KnownUnits {
  int code;
  double length, force;  ///< units of the file in a metre, in a newton
};

constexpr double foot = 0.3048, inch = 0.0254, pound = 4.4482216152605, poundal = 0.138254954376,
                 kilopond = 9.80665;
constexpr std::array known_units{KnownUnits{1, 1.0, 1.0},
                                 KnownUnits{2, 1.0 / foot, 1.0 / pound},
                                 KnownUnits{3, 1.0, 1.0 / kilopond},
                                 KnownUnits{4, 1.0 / foot, 1.0 / poundal},
                                 KnownUnits{5, 1e3, 1e3},
                                 KnownUnits{6, 1e2, 1e2},
                                 KnownUnits{7, 1.0 / inch, 1.0 / pound},
                                 KnownUnits{8, 1e3, 1.0 / kilopond}};

/// Numbers up to the end of the dataset, in their columns or not.
std::vector<double> all_numbers(const UffNextLine& next) {
  std::vector<double> numbers;
  for (std::string_view line; next(line);) {
    for (std::string_view rest = base::trimmed(line); !rest.empty();) {
      const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
      const auto number = fortran_number(rest.substr(0, end));
      if (!number || !std::isfinite(*number))
        throw Unusable{fmt::format("its factor \"{}\" is not a finite number",
                                   base::printable(rest.substr(0, end), 20))};
      numbers.push_back(*number);
      rest = base::trimmed(rest.substr(end));
    }
  }
  return numbers;
}

int number_of(std::string_view line, std::size_t begin, const char* what) {
  constexpr long long most = 999'999'999;
  return uff_small(line, begin, 10, what, -most, most);
}

Node node_of(std::string_view line) {
  Node node;
  node.number = number_of(line, 0, "the number of a node");
  node.position_system = number_of(line, 10, "the coordinate system of a node");
  node.motion_system = number_of(line, 20, "the coordinate system of a node");
  node.color = number_of(line, 30, "the colour of a node");
  return node;
}

/// Six digits, as in columns of 13.
bool fits_six_digits(const Geometry& geometry) {
  return std::ranges::all_of(geometry.nodes, [](const Node& node) {
    return std::ranges::all_of(node.position, [](double value) {
      return fortran_number(fortran_e(value, 13, 5)) == value;
    });
  });
}

std::string node_text(const Node& node, bool in_double) {
  std::string text = fmt::format("{:10}{:10}{:10}{:10}", node.number, node.position_system,
                                 node.motion_system, node.color);
  if (in_double) text += '\n';
  for (const double value : node.position)
    text += in_double ? fortran_d(value) : fortran_e(value, 13, 5);
  return text + '\n';
}

std::string trace_line_text(const TraceLine& line, std::size_t number) {
  std::string text = fmt::format("{}{:6}\n{:10}{:10}{:10}\n{}", uff_delimiter, uff_trace_line,
                                 number, line.nodes.size(), line.color, uff_text_line(line.name));
  constexpr std::size_t per_line = 8;
  for (std::size_t k = 0; k < line.nodes.size(); ++k) {
    text += fmt::format("{:10}", line.nodes[k]);
    if ((k + 1) % per_line == 0 || k + 1 == line.nodes.size()) text += '\n';
  }
  return text + uff_delimiter;
}

}  // namespace

UffUnits read_uff_units(const UffNextLine& next, Notes& notes) {
  std::string_view first;
  if (!next(first)) throw Unusable{"it ends before its units code"};
  UffUnits units;
  units.code = uff_small(first, 0, 10, "the units code", 0, 99999);
  units.description = uff_field(first, 10, 20);
  const auto known = std::ranges::find(known_units, units.code, &KnownUnits::code);
  const auto numbers = all_numbers(next);
  const auto sensible = [](double factor) { return factor > 1e-12 && factor < 1e12; };
  const bool stated = numbers.size() > 1 && sensible(numbers[0]) && sensible(numbers[1]);
  if (stated) {
    units.length = numbers[0];
    units.force = numbers[1];
    if (numbers.size() > 2) units.temperature = numbers[2];
    if (numbers.size() > 3) units.temperature_offset = numbers[3];
  } else if (known != known_units.end()) {
    units.length = known->length;
    units.force = known->force;
    notes.add(
        fmt::format("dataset 164: its factors of length and force are not two positive "
                    "numbers; those of units code {} hold",
                    units.code));
  } else {
    units.usable = false;
    notes.add(
        "dataset 164: its factors of length and force are not two positive numbers; the units of "
        "what has no unit label are unknown");
  }
  constexpr double same = 1e-3;  // factors are written with four digits or more
  const auto differs = [&](double a, double b) { return std::abs(a - b) > same * b; };
  if (known == known_units.end() || !stated) return units;
  if (!differs(units.length, known->length) && !differs(units.force, known->force)) return units;
  units.usable = false;
  notes.add(
      fmt::format("dataset 164 contradicts itself: units code {} means {:.6g} units of length "
                  "in a metre and {:.6g} of force in a newton, its factors are {:.6g} and "
                  "{:.6g}; the units of what has no unit label are unknown",
                  units.code, known->length, known->force, units.length, units.force));
  return units;
}

void read_uff_nodes(const UffNextLine& next, bool in_double, std::vector<Node>& nodes) {
  std::string_view line;
  while (next(line)) {
    if (base::trimmed(line).empty()) continue;
    if (nodes.size() == most_nodes) throw Unusable{fmt::format("more than {} nodes", most_nodes)};
    Node node = node_of(line);
    if (in_double && !next(line)) throw Unusable{"it ends before the place of a node"};
    for (std::size_t axis = 0; axis < 3; ++axis)
      node.position[static_cast<Eigen::Index>(axis)] =
          in_double ? uff_real(line, 25 * axis, 25, "a coordinate")
                    : uff_real(line, 40 + 13 * axis, 13, "a coordinate");
    nodes.push_back(node);
  }
}

TraceLine read_uff_trace_line(const UffNextLine& next) {
  std::string_view line;
  if (!next(line)) throw Unusable{"it ends before the number of its nodes"};
  TraceLine trace;
  const int count = number_of(line, 10, "the number of nodes");
  trace.color = number_of(line, 20, "the colour of a line");
  if (!next(line)) throw Unusable{"it ends before its name"};
  trace.name = given(uff_field(line, 0, 80));
  while (next(line)) {
    for (std::size_t begin = 0; begin < 80 && !columns(line, begin, 10).empty(); begin += 10)
      trace.nodes.push_back(number_of(line, begin, "the number of a node"));
    if (trace.nodes.size() > most_nodes)
      throw Unusable{fmt::format("more than {} nodes in a line", most_nodes)};
  }
  if (count >= 0 && trace.nodes.size() > static_cast<std::size_t>(count))
    trace.nodes.resize(static_cast<std::size_t>(count));
  return trace;
}

TraceLine read_uff_rods(const UffNextLine& next) {
  TraceLine rods;
  for (std::string_view line; next(line);) {
    if (base::trimmed(line).empty()) continue;
    const int kind = number_of(line, 10, "the kind of an element"),
              nodes = number_of(line, 50, "the number of nodes of an element");
    const bool is_rod = std::ranges::find(beams, kind) != beams.end();
    if (is_rod && !next(line)) throw Unusable{"it ends before the orientation of a beam"};
    if (nodes < 1 || nodes > static_cast<int>(most_nodes))
      throw Unusable{fmt::format("an element of {} nodes", nodes)};
    for (int k = 0; k < nodes; ++k) {
      const auto begin = static_cast<std::size_t>(k) % 8 * 10;
      if (begin == 0 && !next(line)) throw Unusable{"it ends before the nodes of an element"};
      if (is_rod) rods.nodes.push_back(number_of(line, begin, "the node of an element"));
    }
    if (is_rod) rods.nodes.push_back(0);
    if (rods.nodes.size() > most_nodes)
      throw Unusable{fmt::format("more than {} nodes in rods", most_nodes)};
  }
  return rods;
}

std::string uff_elements_text(const Geometry& geometry) {
  if (geometry.nodes.empty()) return {};
  std::string text = fmt::format("{}{:6}\n", uff_delimiter, uff_nodes_double);
  for (const Node& node : geometry.nodes) text += node_text(node, true);
  text += uff_delimiter;
  std::string rods;
  int number = 0;
  for (const auto& line : geometry.lines)
    for (std::size_t k = 1; k < line.nodes.size(); ++k)
      if (line.nodes[k - 1] != 0 && line.nodes[k] != 0)
        rods += fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}\n{:10}{:10}{:10}\n{:10}{:10}\n",
                            ++number, rod, 1, 1, 7, 2, 0, 1, 1, line.nodes[k - 1], line.nodes[k]);
  if (!rods.empty())
    text += fmt::format("{}{:6}\n", uff_delimiter, uff_elements) + rods + uff_delimiter;
  return text;
}

std::string uff_geometry_text(const Geometry& geometry) {
  std::string text;
  if (!geometry.nodes.empty()) {
    const bool in_double = !fits_six_digits(geometry);
    text += fmt::format("{}{:6}\n", uff_delimiter, in_double ? uff_nodes_double : uff_nodes);
    for (const Node& node : geometry.nodes) text += node_text(node, in_double);
    text += uff_delimiter;
  }
  for (std::size_t k = 0; k < geometry.lines.size(); ++k)
    text += trace_line_text(geometry.lines[k], k + 1);
  return text;
}

}  // namespace hydrapod::data
