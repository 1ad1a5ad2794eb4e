#include "hydrapod/data/modal_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "uff_dataset.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

int time_derivatives(const std::string& unit) {
  return unit.ends_with("/s^2") || unit.ends_with("s^-2") || unit.ends_with("/s2")    ? 2
         : unit == "m/s" || unit == "rad/s" || unit == "m s^-1" || unit == "rad s^-1" ? 1
                                                                                      : 0;
}

bool against_ground(const Channel& channel) {
  return channel.direction < Direction::leg1 && time_derivatives(channel.unit) == 2;
}

double mac(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  const double norms = a.squaredNorm() * b.squaredNorm();
  return norms > 0.0 ? std::norm(a.dot(b)) / norms : 0.0;
}

double modal_phase_collinearity(const Eigen::VectorXcd& shape) {
  const double rr = shape.real().squaredNorm(), ii = shape.imag().squaredNorm();
  const double ri = shape.real().dot(shape.imag());
  // the eigenvalues of [rr ri; ri ii]: (λ1 − λ2)²/(λ1 + λ2)²
  return rr + ii > 0.0 ? (std::pow(rr - ii, 2) + 4.0 * ri * ri) / std::pow(rr + ii, 2) : 0.0;
}

double mean_phase_deviation(const Eigen::VectorXcd& shape) {
  if (!(shape.squaredNorm() > 0.0)) return 0.0;
  // the straight line through the complex plane that fits the elements best
  const double rr = shape.real().squaredNorm(), ii = shape.imag().squaredNorm();
  const double ri = shape.real().dot(shape.imag());
  const double direction = 0.5 * std::atan2(2.0 * ri, rr - ii);
  double sum = 0.0, weight = 0.0;
  for (const std::complex<double> c : shape) {
    if (c == 0.0) continue;
    const std::complex<double> turned = c * std::polar(1.0, -direction);
    sum += std::abs(c) * std::atan2(std::abs(turned.imag()), std::abs(turned.real()));
    weight += std::abs(c);
  }
  return sum / weight;
}

namespace {

/// Where an output stands in dataset 55 of a Universal File.
struct ModalPlace {
  int node{};
  int component{};   ///< 0 … 5: x … rz
  double sign{1.0};  ///< −1: the sensor is mounted the other way round
};

/// A place of its own for every output, see modal_results.hpp.
std::vector<ModalPlace> modal_places(const std::vector<Channel>& outputs) {
  std::vector<ModalPlace> places(outputs.size());
  std::set<std::pair<int, int>> taken;
  int last = 1;
  const auto has_direction = [](const Channel& channel) {
    const int direction = static_cast<int>(channel.direction);
    return direction != 0 && std::abs(direction) <= 6;
  };
  for (const auto& channel : outputs)
    if (has_direction(channel)) last = std::max(last, channel.point);
  for (std::size_t o = 0; o < outputs.size(); ++o) {
    const int direction = static_cast<int>(outputs[o].direction);
    const int node = std::max(1, outputs[o].point), component = std::abs(direction) - 1;
    if (has_direction(outputs[o]) && taken.emplace(node, component).second)
      places[o] = {node, component, direction < 0 ? -1.0 : 1.0};
    else
      places[o] = {++last, 0, 1.0};
  }
  return places;
}

namespace code {  // record 6 of dataset 55
constexpr int structural = 1, complex_eigenvalue = 3, displacement = 8, complex_data = 5;
constexpr int translations = 2, translations_and_rotations = 3;
}  // namespace code

std::string real_line(const std::vector<double>& values) {
  constexpr std::size_t per_line = 6;
  std::string text;
  for (std::size_t k = 0; k < values.size(); ++k) {
    text += fortran_e(values[k], 13, 5);
    if ((k + 1) % per_line == 0 || k + 1 == values.size()) text += '\n';
  }
  return text;
}

/// Values of all nodes that have any.
std::map<int, std::vector<std::complex<double>>> node_values(const Eigen::VectorXcd& shape,
                                                             const std::vector<ModalPlace>& places,
                                                             std::size_t per_node) {
  std::map<int, std::vector<std::complex<double>>> nodes;
  for (std::size_t o = 0; o < places.size(); ++o) {
    auto& values = nodes.try_emplace(places[o].node, per_node).first->second;
    values[static_cast<std::size_t>(places[o].component)] =
        places[o].sign * shape[static_cast<Eigen::Index>(o)];
  }
  return nodes;
}

std::string mode_text(const ModalResults& all, std::size_t number,
                      const std::vector<ModalPlace>& places) {
  const auto& mode = all.modes[number];
  const bool turns = std::ranges::any_of(places, [](auto& p) { return p.component > 2; });
  const std::size_t per_node = turns ? 6 : 3;
  const double omega = std::abs(mode.pole);
  std::string text = fmt::format("{}    55\n", uff_delimiter);
  const std::string frequency =
      fmt::format("mode {}: {:.6g} Hz, damping {:.4g} %", number + 1, omega / base::two_pi,
                  -100.0 * mode.pole.real() / omega);
  for (const std::string& id :
       {all.title, frequency, uff_date(all.date), std::string("identified by hydrapod"),
        std::string("shape as displacement, SI")})
    text += uff_text_line(id);
  text +=
      fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}\n", code::structural, code::complex_eigenvalue,
                  turns ? code::translations_and_rotations : code::translations, code::displacement,
                  code::complex_data, per_node);
  text += fmt::format("{:10}{:10}{:10}{:10}\n", 2, 6, 1, number + 1);
  text += real_line(
      {mode.pole.real(), mode.pole.imag(), 1.0, 0.0, -mode.pole.real(), -mode.pole.imag()});
  for (const auto& [node, values] : node_values(mode.shape, places, per_node)) {
    std::vector<double> numbers;
    for (const auto value : values) {
      numbers.push_back(value.real());
      numbers.push_back(value.imag());
    }
    text += fmt::format("{:10}\n", node) + real_line(numbers);
  }
  return text + uff_delimiter;
}

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
    const auto below = static_cast<unsigned>(std::min(line, dataset_.lines.size()));
    notes_.fail("dataset 55: " + what, dataset_.line > 0 ? dataset_.line + below : 0);
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

void write_modal_results(const std::string& path, const ModalResults& all) {
  for (const auto& mode : all.modes)
    if (mode.shape.size() != static_cast<Eigen::Index>(all.outputs.size()))
      throw std::invalid_argument(fmt::format("modal results: a shape of {} numbers for {} outputs",
                                              mode.shape.size(), all.outputs.size()));
  RecordHeader header;
  header.title = all.title;
  header.date = all.date;
  header.channels = all.outputs;
  header.sample_rate = 1.0;
  std::string text = uff_beginning(all.title, all.date, comment_lines(header));
  const auto places = modal_places(all.outputs);
  for (std::size_t r = 0; r < all.modes.size(); ++r) text += mode_text(all, r, places);
  base::write_file_whole(path, text);
}

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
  auto results = assembled(modes, own.by_hydrapod(notes) ? own.header(notes) : RecordHeader{});
  return {std::move(results), notes.all()};
}

}  // namespace hydrapod::data
