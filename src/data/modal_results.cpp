#include "hydrapod/data/modal_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "uff_dataset.hpp"
#include "uff_geometry.hpp"
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

bool has_direction(const Channel& channel) {
  const int direction = static_cast<int>(channel.direction);
  return direction != 0 && std::abs(direction) <= 6;
}

/// Node and component of a channel that has a direction, apart from others in the same place.
ModalPlace own_place(const Channel& channel) {
  const int direction = static_cast<int>(channel.direction);
  return {std::max(1, channel.point), std::abs(direction) - 1, direction < 0 ? -1.0 : 1.0};
}

/// Where outputs stand, and inputs as far as there are any.
struct ModalPlaces {
  std::vector<ModalPlace> outputs{}, inputs{};
  std::vector<std::size_t> at_output{};  ///< per input: the output in its place; empty: apart
};

/// A place of its own for every output, see modal_results.hpp; inputs apart from them.
ModalPlaces modal_places(const std::vector<Channel>& outputs, const std::vector<Channel>& inputs) {
  ModalPlaces places;
  std::set<std::pair<int, int>> taken;
  int last = 1;
  for (const auto& channel : outputs)
    if (has_direction(channel)) last = std::max(last, channel.point);
  for (const auto& channel : outputs) {
    const auto place = own_place(channel);
    if (has_direction(channel) && taken.emplace(place.node, place.component).second)
      places.outputs.push_back(place);
    else
      places.outputs.push_back({++last, 0, 1.0});
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) places.inputs.push_back({++last, 0, 1.0});
  return places;
}

/// Inputs in the places of outputs, if all are forces there.
bool put_at_outputs(const std::vector<Channel>& outputs, const std::vector<Channel>& inputs,
                    ModalPlaces& places) {
  std::vector<std::size_t> at;
  for (const Channel& input : inputs) {
    const auto place = own_place(input);
    const char* unit = place.component < 3 ? "N" : "N m";
    const auto same = [&](const ModalPlace& p) {
      return p.node == place.node && p.component == place.component;
    };
    const auto found = std::ranges::find_if(places.outputs, same);
    if (!has_direction(input) || input.unit != unit || found == places.outputs.end()) return false;
    const auto o = static_cast<std::size_t>(found - places.outputs.begin());
    if (!has_direction(outputs[o])) return false;
    at.push_back(o);
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) places.inputs[i] = own_place(inputs[i]);
  places.at_output = std::move(at);
  return !inputs.empty();
}

namespace code {  // record 6 of dataset 55
constexpr int structural = 1, complex_eigenvalue = 3, complex_data = 5;
constexpr int displacement = 8, speed = 11, acceleration = 12;
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

/// Numbers of a mode with modal A = 1.
struct ScaledMode {
  Eigen::VectorXcd outputs{}, inputs{};
};

/// The number at the output in the place of input i, in the direction of the node.
std::complex<double> at_output(const Eigen::VectorXcd& shape, const ModalPlaces& places,
                               std::size_t i) {
  const std::size_t o = places.at_output[i];
  return places.outputs[o].sign * shape[static_cast<Eigen::Index>(o)];
}

std::complex<double> at_input(const Eigen::VectorXcd& participation, const ModalPlaces& places,
                              std::size_t i) {
  return places.inputs[i].sign * participation[static_cast<Eigen::Index>(i)];
}

/// c φ and L/c; of inputs at outputs c² is the best of c² φ_i/L_i = 1, which forces and moments
/// share.
ScaledMode scaled(const ModalResult& mode, const ModalPlaces& places) {
  if (mode.participation.size() == 0) return {mode.shape, {}};
  if (places.at_output.empty()) return {mode.shape, mode.participation};
  std::complex<double> sum = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < places.at_output.size(); ++i) {
    const auto ratio = at_output(mode.shape, places, i) / at_input(mode.participation, places, i);
    sum += std::conj(ratio);
    square += std::norm(ratio);
  }
  const auto c = std::sqrt(sum / square);
  return {c * mode.shape, mode.participation / c};
}

/// Is ψ_o ψ_i that of the fit, with the numbers at outputs for those at inputs?
bool is_reciprocal(const ModalResult& mode, const ModalPlaces& places) {
  constexpr double tolerance = 0.02;  // noise of a good measurement makes that much
  const auto numbers = scaled(mode, places);
  if (!numbers.outputs.allFinite() || !numbers.inputs.allFinite()) return false;
  for (std::size_t i = 0; i < places.at_output.size(); ++i) {
    const auto input = at_input(numbers.inputs, places, i);
    if (!(std::abs(at_output(numbers.outputs, places, i) - input) <= tolerance * std::abs(input)))
      return false;
  }
  return true;
}

/// Places for these modes, with inputs where all participations are known.
ModalPlaces places_for(const ModalResults& all) {
  const bool with_inputs = !all.inputs.empty() && std::ranges::all_of(all.modes, [&](auto& mode) {
    return mode.participation.size() == static_cast<Eigen::Index>(all.inputs.size());
  });
  if (!with_inputs) return modal_places(all.outputs, {});
  auto places = modal_places(all.outputs, all.inputs);
  const auto apart = places;
  const auto fits = [&](const auto& mode) { return is_reciprocal(mode, places); };
  if (!put_at_outputs(all.outputs, all.inputs, places) || !std::ranges::all_of(all.modes, fits))
    return apart;
  return places;
}

using NodeNumbers = std::map<int, std::vector<std::complex<double>>>;

/// Puts numbers at their nodes.
void add_numbers(const Eigen::VectorXcd& numbers, const std::vector<ModalPlace>& places,
                 std::size_t per_node, NodeNumbers& nodes) {
  for (std::size_t k = 0; k < places.size(); ++k) {
    auto& values = nodes.try_emplace(places[k].node, per_node).first->second;
    values[static_cast<std::size_t>(places[k].component)] =
        places[k].sign * numbers[static_cast<Eigen::Index>(k)];
  }
}

/// "inputs at nodes 8x 9x", as many as fit into a line.
std::string input_text(const ModalPlaces& places) {
  std::string text = "shape as displacement, SI";
  if (places.inputs.empty()) return text;
  text += places.at_output.empty() ? "; inputs at nodes" : "; forces at nodes";
  for (const auto& place : places.inputs)
    text += fmt::format(" {}{}", place.node,
                        direction_text(static_cast<Direction>(place.component + 1)));
  return text;
}

std::string mode_text(const ModalResults& all, std::size_t number, const ModalPlaces& places) {
  const auto& mode = all.modes[number];
  const bool turns = std::ranges::any_of(places.outputs, [](auto& p) { return p.component > 2; });
  const std::size_t per_node = turns ? 6 : 3;
  const double omega = std::abs(mode.pole);
  std::string text = fmt::format("{}    55\n", uff_delimiter);
  const std::string frequency =
      fmt::format("mode {}: {:.6g} Hz, damping {:.4g} %", number + 1, omega / base::two_pi,
                  -100.0 * mode.pole.real() / omega);
  std::array<std::string, 5> id{all.title, frequency, uff_date(all.date), "identified by hydrapod",
                                input_text(places)};
  put_id_lines(mode.id_lines, id);
  for (const std::string& line : id) text += uff_text_line(line);
  text +=
      fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}\n", code::structural, code::complex_eigenvalue,
                  turns ? code::translations_and_rotations : code::translations, code::displacement,
                  code::complex_data, per_node);
  text += fmt::format("{:10}{:10}{:10}{:10}\n", 2, 6, 1, number + 1);
  text += real_line(
      {mode.pole.real(), mode.pole.imag(), 1.0, 0.0, -mode.pole.real(), -mode.pole.imag()});
  const auto numbers = scaled(mode, places);
  NodeNumbers nodes;
  if (places.at_output.empty()) add_numbers(numbers.inputs, places.inputs, per_node, nodes);
  add_numbers(numbers.outputs, places.outputs, per_node, nodes);
  for (const auto& [node, values] : nodes) {
    std::vector<double> reals;
    for (const auto value : values) {
      reals.push_back(value.real());
      reals.push_back(value.imag());
    }
    text += fmt::format("{:10}\n", node) + real_line(reals);
  }
  return text + uff_delimiter;
}

constexpr const char* inputs_key = "modal_inputs";
constexpr const char* at_outputs = "at outputs";

using Complex = std::complex<double>;
using NodeValues = std::map<std::pair<int, int>, Complex>;  // (node, component)

struct Mode {
  Complex pole{};
  double modal_mass{};  ///< 0: not known
  NodeValues values{};
  std::vector<std::string> id_lines{};
};

class ModeReader {
 public:
  ModeReader(const UffLines& dataset, Notes& notes) : dataset_(dataset), notes_(notes) {}

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
      mode.modal_mass = numbers[1];
    } else {
      mode.pole = {numbers[0], numbers[1]};
    }
    read_nodes(static_cast<std::size_t>(per_node), type == complex, mode.values);
    become_displacements(head[3], mode);
    become_metres(mode);
    std::array<std::string, 5> id;
    for (std::size_t k = 0; k < id.size(); ++k) id[k] = clean_text(columns(line(k), 0, 80));
    mode.id_lines = uff_id_lines(id);
    return mode;
  }

 private:
  /// Speeds are λ times displacements, accelerations λ² times.
  void become_displacements(long long quantity, Mode& mode) {
    const int derivatives = quantity == code::acceleration ? 2 : quantity == code::speed ? 1 : 0;
    if (derivatives == 0) return;
    mode.modal_mass = 0.0;  // that of another scale
    if (mode.pole == 0.0) return;
    notes_.add(
        fmt::format("the shapes are {}: divided by λ{} they are displacements",
                    derivatives == 2 ? "accelerations" : "speeds", derivatives == 2 ? "²" : ""),
        0, 0, "derivatives");
    for (auto& [place, value] : mode.values) value /= std::pow(mode.pole, derivatives);
  }

  /// Beside angles lengths must be in metres.
  void become_metres(Mode& mode) const {
    if (!dataset_.units) return;
    // of an energy, force times length
    mode.modal_mass = dataset_.units->usable
                          ? mode.modal_mass / (dataset_.units->length * dataset_.units->force)
                          : 0.0;
    const bool turns = std::ranges::any_of(
        mode.values, [](const auto& at) { return at.first.second > 2 && at.second != 0.0; });
    if (!dataset_.units->usable) {
      if (turns) fail(0, "has lengths and angles, and the unit of the lengths is unknown");
      return;
    }
    for (auto& [place, value] : mode.values)
      if (place.second < 3) value /= dataset_.units->length;
  }

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

  const UffLines& dataset_;
  Notes& notes_;
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

/// φ and L of ψ, the largest of L being 1.
void take_participation(const Mode& mode, const ModalPlaces& places, ModalResult& result) {
  const auto count = static_cast<Eigen::Index>(places.inputs.size());
  result.participation = Eigen::VectorXcd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& place = places.inputs[static_cast<std::size_t>(i)];
    const auto at = mode.values.find({place.node, place.component});
    if (at != mode.values.end()) result.participation[i] = place.sign * at->second;
  }
  Eigen::Index largest = 0;
  if (!(result.participation.cwiseAbs().maxCoeff(&largest) > 0.0)) {
    result.participation.resize(0);
    return;
  }
  const Complex scale = result.participation[largest];
  result.participation /= scale;
  result.shape *= scale;
}

ModalResults assembled(const std::vector<Mode>& modes, const RecordHeader& header,
                       std::size_t inputs, bool inputs_at_outputs) {
  ModalResults all{.title = header.title, .date = header.date, .outputs = header.channels};
  all.geometry = header.geometry;
  if (inputs < all.outputs.size()) {
    const auto border = all.outputs.end() - static_cast<std::ptrdiff_t>(inputs);
    all.inputs.assign(border, all.outputs.end());
    all.outputs.erase(border, all.outputs.end());
  }
  if (all.outputs.empty()) all.outputs = outputs_of(modes);
  auto places = modal_places(all.outputs, all.inputs);
  if (inputs_at_outputs) put_at_outputs(all.outputs, all.inputs, places);
  for (const auto& mode : modes) {
    ModalResult result{.pole = mode.pole, .modal_mass = mode.modal_mass};
    result.shape = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(places.outputs.size()));
    for (std::size_t o = 0; o < places.outputs.size(); ++o) {
      const auto& place = places.outputs[o];
      const auto at = mode.values.find({place.node, place.component});
      if (at != mode.values.end())
        result.shape[static_cast<Eigen::Index>(o)] = place.sign * at->second;
    }
    if (!all.inputs.empty()) take_participation(mode, places, result);
    if (header.channels.empty()) result.id_lines = mode.id_lines;
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
  const auto places = places_for(all);
  RecordHeader header;
  header.title = all.title;
  header.date = all.date;
  header.channels = all.outputs;
  header.geometry = all.geometry;
  header.sample_rate = 1.0;
  std::string inputs;
  if (!places.inputs.empty()) {
    header.channels.insert(header.channels.end(), all.inputs.begin(), all.inputs.end());
    inputs = fmt::format("# {}: {} {}\n", inputs_key, all.inputs.size(),
                         places.at_output.empty() ? "apart" : at_outputs);
  }
  std::string text = uff_beginning(all.title, all.date, comment_lines(header) + inputs) +
                     uff_geometry_text(all.geometry);
  for (std::size_t r = 0; r < all.modes.size(); ++r) text += mode_text(all, r, places);
  base::write_file_whole(path, text);
}

ReadModalResultsResult read_modal_results(const std::string& path) {
  Notes notes(path);
  const UffContents contents = scan_uff(path, notes);
  std::vector<Mode> modes;
  for (const UffLines& dataset : contents.modes)
    if (auto mode = ModeReader(dataset, notes).read()) modes.push_back(std::move(*mode));
  if (modes.empty()) notes.fail("the Universal File holds no modes (dataset 55)");
  if (modes.size() < contents.modes.size())
    notes.add(fmt::format("{} datasets 55 that are no modes left out",
                          contents.modes.size() - modes.size()));
  const RecordComments& own = contents.own;
  const std::string inputs = own.text_of(inputs_key);
  const auto count = fortran_integer(inputs.substr(0, inputs.find(' '))).value_or(0);
  auto results =
      assembled(modes, own.by_hydrapod(notes) ? own.header(notes) : RecordHeader{},
                static_cast<std::size_t>(std::max(0LL, count)), inputs.ends_with(at_outputs));
  if (!own.by_hydrapod(notes)) {
    results.title = given(contents.model_name);
    results.geometry = contents.geometry;
  }
  return {std::move(results), notes.all()};
}

}  // namespace hydrapod::data
