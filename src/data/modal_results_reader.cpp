#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "hydrapod/base/units.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "modal_nodes.hpp"
#include "uff_dataset.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

using Complex = std::complex<double>;
using NodeValues = std::map<std::pair<int, int>, Complex>;  // (node, component)

struct Mode {
  Complex pole{};
  NodeValues values{};
};

class ModeReader {
 public:
  ModeReader(const UffMode& dataset, const Notes& notes) : dataset_(dataset), notes_(notes) {}

  /// None for analyses that are no modes.
  std::optional<Mode> read() {
    const auto head = integers(5, 6);
    const auto analysis = head[1], type = head[4], per_node = head[5];
    constexpr long long normal = 2, first_order = 3, second_order = 7, real = 2, complex = 5;
    if (analysis != normal && analysis != first_order && analysis != second_order) return {};
    if (type != real && type != complex)
      fail(5, fmt::format("data type {}: expected 2 (real) or 5 (complex)", type));
    if (per_node != 3 && per_node != 6)
      fail(5, fmt::format("{} values per node: expected 3 or 6", per_node));
    Mode mode;
    const auto numbers = reals(7, analysis == normal ? 3 : 2);
    if (analysis == normal) {
      const double omega = base::two_pi * numbers[0], zeta = numbers[2];
      mode.pole = {-zeta * omega, omega * std::sqrt(std::max(0.0, 1.0 - zeta * zeta))};
    } else {
      mode.pole = {numbers[0], numbers[1]};
    }
    read_nodes(static_cast<std::size_t>(per_node), type == complex, mode.values);
    return mode;
  }

 private:
  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    notes_.fail("dataset 55: " + what,
                dataset_.line + static_cast<unsigned>(std::min(line, dataset_.lines.size())));
  }
  [[nodiscard]] const std::string& line(std::size_t at) const {
    if (at >= dataset_.lines.size()) fail(at, "ends too early");
    return dataset_.lines[at];
  }
  [[nodiscard]] std::vector<long long> integers(std::size_t at, std::size_t count) const {
    std::vector<long long> values;
    for (std::size_t k = 0; k < count; ++k) {
      const auto value = fortran_integer(columns(line(at), 10 * k, 10));
      if (!value) fail(at, fmt::format("field {} is no whole number", k + 1));
      values.push_back(*value);
    }
    return values;
  }
  [[nodiscard]] std::vector<double> reals(std::size_t at, std::size_t count) const {
    std::vector<double> values;
    for (std::size_t k = 0; k < count; ++k) {
      const auto value = fortran_number(columns(line(at), 13 * k, 13));
      if (!value) fail(at, fmt::format("field {} is no number", k + 1));
      values.push_back(*value);
    }
    return values;
  }
  void read_nodes(std::size_t per_node, bool complex, NodeValues& values) const {
    const std::size_t numbers = per_node * (complex ? 2 : 1);
    const std::size_t lines = (numbers + 5) / 6;
    for (std::size_t at = 8; at < dataset_.lines.size(); at += 1 + lines) {
      const int node = static_cast<int>(integers(at, 1)[0]);
      std::vector<double> all;
      for (std::size_t k = 0; k < lines; ++k) {
        const auto some = reals(at + 1 + k, std::min<std::size_t>(6, numbers - 6 * k));
        all.insert(all.end(), some.begin(), some.end());
      }
      for (std::size_t c = 0; c < per_node; ++c)
        values[{node, static_cast<int>(c)}] =
            complex ? Complex(all[2 * c], all[2 * c + 1]) : Complex(all[c], 0.0);
    }
  }

  const UffMode& dataset_;
  const Notes& notes_;
};

/// Outputs for files without names: every node and direction in which a mode moves.
std::vector<Channel> outputs_of(const std::vector<Mode>& modes) {
  std::map<std::pair<int, int>, bool> moves;
  for (const auto& mode : modes)
    for (const auto& [place, value] : mode.values)
      if (value != 0.0) moves[place] = true;
  std::vector<Channel> outputs;
  for (const auto& [place, moving] : moves) {
    const auto direction = static_cast<Direction>(place.second + 1);
    outputs.push_back({.name = fmt::format("node {} {}", place.first, direction_text(direction)),
                       .unit = place.second < 3 ? "m" : "rad",
                       .direction = direction,
                       .role = Role::response,
                       .point = place.first});
  }
  return outputs;
}

ModalResults assembled(const std::vector<Mode>& modes, const RecordHeader& header) {
  ModalResults all{.title = header.title, .date = header.date, .outputs = header.channels};
  if (all.outputs.empty()) all.outputs = outputs_of(modes);
  const auto places = modal_places(all.outputs);
  for (const auto& mode : modes) {
    ModalResult result{.pole = mode.pole};
    result.shape = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(places.size()));
    for (std::size_t o = 0; o < places.size(); ++o) {
      const auto at = mode.values.find({places[o].node, places[o].component});
      if (at != mode.values.end())
        result.shape[static_cast<Eigen::Index>(o)] = places[o].sign * at->second;
    }
    all.modes.push_back(std::move(result));
  }
  return all;
}

}  // namespace

ReadModalResultsResult read_modal_results(const std::string& path) {
  Notes notes(path);
  const UffContents contents = scan_uff(path, notes);
  std::vector<Mode> modes;
  for (const UffMode& dataset : contents.modes)
    if (auto mode = ModeReader(dataset, notes).read()) modes.push_back(std::move(*mode));
  if (modes.empty()) notes.fail("the Universal File holds no modes (dataset 55)");
  if (modes.size() < contents.modes.size())
    notes.add(fmt::format("{} datasets 55 that are no modes left out",
                          contents.modes.size() - modes.size()));
  const RecordComments& own = contents.own;
  auto results = assembled(modes, own.by_hydrapod() ? own.header(notes) : RecordHeader{});
  return {std::move(results), notes.all()};
}

}  // namespace hydrapod::data
