#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "modal_nodes.hpp"
#include "record_comments.hpp"
#include "uff_dataset.hpp"
#include "uff_text.hpp"
#include "uff_write.hpp"

namespace hydrapod::data {

namespace {

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
    text += fortran_a(id.empty() ? "NONE" : id, 80) + '\n';
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

}  // namespace

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
  std::string text = uff_file_header(all.title, "", all.date) + uff_si_units();
  text += fmt::format("{}{:6}\n{}{}", uff_delimiter, uff_own_dataset, comment_lines(header),
                      uff_delimiter);
  const auto places = modal_places(all.outputs);
  for (std::size_t r = 0; r < all.modes.size(); ++r) text += mode_text(all, r, places);
  base::write_file_whole(path, text);
}

}  // namespace hydrapod::data
