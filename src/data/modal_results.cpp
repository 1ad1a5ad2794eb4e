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
#include "mode_dataset.hpp"
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

/// Lines 1 to 5 of text.
std::string id_text(const ModalResults& all, std::size_t number, const ModalPlaces& places) {
  const auto& mode = all.modes[number];
  const std::string frequency =
      fmt::format("mode {}: {:.6g} Hz, damping {:.4g} %", number + 1, mode.omega() / base::two_pi,
                  100.0 * mode.damping_ratio());
  std::array<std::string, 5> id{all.title, frequency, uff_date(all.date), "hydrapod",
                                input_text(places)};
  put_id_lines(mode.id_lines, id);
  std::string text;
  for (const std::string& line : id) text += uff_text_line(line);
  return text;
}

/// Eigenvalue, modal A, modal B.
std::string eigenvalue_line(std::complex<double> pole) {
  return real_line({pole.real(), pole.imag(), 1.0, 0.0, -pole.real(), -pole.imag()});
}

/// Record 6 of dataset 55 and 9 of dataset 2414.
std::string kind_line(int analysis, int data, std::size_t per_node) {
  return fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}\n", code::structural, analysis,
                     per_node == 6 ? code::translations_and_rotations : code::translations,
                     code::displacement, data, per_node);
}

std::string nodes_text(const NodeNumbers& nodes, bool is_complex) {
  std::string text;
  for (const auto& [node, values] : nodes) {
    std::vector<double> reals;
    for (const auto value : values) {
      reals.push_back(value.real());
      if (is_complex) reals.push_back(value.imag());
    }
    text += fmt::format("{:10}\n", node) + real_line(reals);
  }
  return text;
}

std::size_t values_per_node(const ModalPlaces& places) {
  const bool turns = std::ranges::any_of(places.outputs, [](auto& p) { return p.component > 2; });
  return turns ? 6 : 3;
}

/// Dataset 55.
std::string mode_text(const ModalResults& all, std::size_t number, const ModalPlaces& places) {
  const auto& mode = all.modes[number];
  const auto per_node = values_per_node(places);
  const auto numbers = scaled(mode, places);
  NodeNumbers nodes;
  if (places.at_output.empty()) add_numbers(numbers.inputs, places.inputs, per_node, nodes);
  add_numbers(numbers.outputs, places.outputs, per_node, nodes);
  return fmt::format("{}{:6}\n", uff_delimiter, uff_modes) + id_text(all, number, places) +
         kind_line(code::complex_eigenvalue, code::complex_data, per_node) +
         fmt::format("{:10}{:10}{:10}{:10}\n", 2, 6, 1, number + 1) + eigenvalue_line(mode.pole) +
         nodes_text(nodes, true) + uff_delimiter;
}

/// m of φ_o φ_i/(2 i ω_d m) = φ_o L_i where all shapes are real and all forces act where they are
/// measured.
std::vector<double> modal_masses(const ModalResults& all, const ModalPlaces& places) {
  std::vector<double> masses;
  constexpr double rounding = 1e-9;
  for (const auto& mode : all.modes) {
    if (places.at_output.empty() || !mode.shape.imag().isZero(0.0)) return {};
    std::complex<double> sum = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < places.at_output.size(); ++i) {
      const auto shape = at_output(mode.shape, places, i);
      sum += std::conj(shape) * 2.0 * std::complex(0.0, mode.pole.imag()) *
             at_input(mode.participation, places, i);
      square += std::norm(shape);
    }
    const auto inverse = sum / square;
    if (!(inverse.real() > 0.0) || std::abs(inverse.imag()) > rounding * inverse.real()) return {};
    masses.push_back(1.0 / inverse.real());
  }
  return masses;
}

/// Dataset 2414. `mass`: of a normal mode; 0: it is a complex one.
std::string analysis_text(const ModalResults& all, std::size_t number, const ModalPlaces& places,
                          double mass) {
  const auto& mode = all.modes[number];
  const bool normal = mass > 0.0;
  const auto per_node = values_per_node(places);
  const double omega = mode.omega();
  NodeNumbers nodes;
  add_numbers(normal ? mode.shape : scaled(mode, places).outputs, places.outputs, per_node, nodes);
  return fmt::format("{}{:6}\n{:10}\n", uff_delimiter, uff_analysis, number + 1) +
         uff_text_line(fmt::format("mode {}", number + 1)) +
         fmt::format("{:10}\n", code::at_nodes) + id_text(all, number, places) +
         (normal ? kind_line(code::normal_mode, code::real_data, per_node)
                 : kind_line(code::complex_eigenvalue, code::complex_data, per_node)) +
         fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}{:10}{:10}\n{:10}{:10}\n", 0, 0, 1, 0, 1,
                     number + 1, 0, 0, 0, 0) +
         real_line({0.0, omega / base::two_pi, omega * omega, mass,
                    omega > 0.0 ? mode.damping_ratio() : 0.0, 0.0}) +
         (normal ? real_line({0.0, 0.0, 0.0, 0.0, 0.0, 0.0}) : eigenvalue_line(mode.pole)) +
         nodes_text(nodes, !normal) + uff_delimiter;
}

constexpr const char* inputs_key = "modal_inputs";
constexpr const char* at_outputs = "at outputs";

/// Outputs for files without names: every node and direction in which a mode moves.
std::vector<Channel> outputs_of(const std::vector<ModeDataset>& modes) {
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
void take_participation(ModeDataset mode, const ModalPlaces& places, ModalResult& result) {
  const auto count = static_cast<Eigen::Index>(places.inputs.size());
  result.participation = Eigen::VectorXcd::Zero(count);
  if (mode.is_normal) {  // ψ of modal A = 1
    if (!(mode.modal_mass > 0.0)) return result.participation.resize(0);
    const auto scale = 1.0 / std::sqrt(std::complex(0.0, 2.0 * mode.pole.imag() * mode.modal_mass));
    for (auto& [place, value] : mode.values) value *= scale;
    result.shape *= scale;
    result.modal_mass = 0.0;
  }
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
  const std::complex<double> scale = result.participation[largest];
  result.participation /= scale;
  result.shape *= scale;
}

ModalResults assembled(const std::vector<ModeDataset>& modes, const RecordHeader& header,
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

/// Datasets of one kind; those of finite-element programs repeat the modes that a file has in
/// datasets 55 too.
std::vector<ModeDataset> modes_of(const UffContents& contents, Notes& notes) {
  std::vector<ModeDataset> modes, analyses;
  for (const UffLines& dataset : contents.modes)
    if (auto mode = read_mode(dataset, notes))
      (dataset.number == uff_modes ? modes : analyses).push_back(std::move(*mode));
  if (modes.empty() && analyses.empty())
    notes.fail("the Universal File holds no modes (datasets 55 or 2414)");
  if (modes.size() + analyses.size() < contents.modes.size())
    notes.add(fmt::format("{} datasets 55 and 2414 that are no modes left out",
                          contents.modes.size() - modes.size() - analyses.size()));
  if (modes.empty()) return analyses;
  if (!analyses.empty())
    notes.add(fmt::format("modes of {} datasets 2414 left out: the file has datasets 55",
                          analyses.size()));
  return modes;
}

}  // namespace

void write_modal_results(const std::string& path, const ModalResults& all, ModalDataset dataset) {
  for (const auto& mode : all.modes)
    if (mode.shape.size() != static_cast<Eigen::Index>(all.outputs.size()))
      throw std::invalid_argument(fmt::format("modal results: a shape of {} numbers for {} outputs",
                                              mode.shape.size(), all.outputs.size()));
  const bool analysis = dataset == ModalDataset::analysis;
  auto places = places_for(all);
  if (analysis && places.at_output.empty()) places.inputs.clear();  // no nodes without a place
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
                     (analysis ? uff_elements_text(all.geometry) : uff_geometry_text(all.geometry));
  const auto masses = analysis ? modal_masses(all, places) : std::vector<double>{};
  for (std::size_t r = 0; r < all.modes.size(); ++r)
    text += analysis ? analysis_text(all, r, places, masses.empty() ? 0.0 : masses[r])
                     : mode_text(all, r, places);
  base::write_file_whole(path, text);
}

ReadModalResultsResult read_modal_results(const std::string& path) {
  Notes notes(path);
  const UffContents contents = scan_uff(path, notes);
  const auto modes = modes_of(contents, notes);
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
