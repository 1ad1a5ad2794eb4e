#include "mode_dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

/// Lines of a dataset, from 0.
struct LinesOf {
  std::size_t text{}, kind{}, numbers{}, nodes{};
};
constexpr LinesOf shapes{0, 5, 7, 8}, analysis{3, 8, 11, 13};

class ModeReader {
 public:
  ModeReader(const UffLines& dataset, Notes& notes)
      : dataset_(dataset), notes_(notes), at_(dataset.number == uff_modes ? shapes : analysis) {}

  std::optional<ModeDataset> read() {
    const auto head = integers(at_.kind, 6);
    const auto kind = head[1], type = head[4], per_node = head[5];
    if (kind != code::normal_mode && kind != code::complex_eigenvalue && kind != code::second_order)
      return {};
    if (dataset_.number == uff_analysis && integers(2, 1)[0] != code::at_nodes) return {};
    if (type != code::real_data && type != code::complex_data)
      fail(at_.kind, fmt::format("data type {}: expected 2 (real) or 5 (complex)", type));
    if (per_node != 3 && per_node != 6)
      fail(at_.kind, fmt::format("{} values per node: expected 3 or 6", per_node));
    ModeDataset mode;
    mode.is_normal = kind == code::normal_mode;
    read_numbers(mode);
    read_nodes(static_cast<std::size_t>(per_node), type == code::complex_data, mode.values);
    become_displacements(head[3], mode);
    become_metres(mode);
    std::array<std::string, 5> id;
    for (std::size_t k = 0; k < id.size(); ++k)
      id[k] = clean_text(columns(line(at_.text + k), 0, 80));
    mode.id_lines = uff_id_lines(id);
    return mode;
  }

 private:
  void read_numbers(ModeDataset& mode) const {
    if (!mode.is_normal) {
      const auto lambda = reals(dataset_.number == uff_modes ? at_.numbers : at_.numbers + 1, 2);
      mode.pole = {lambda[0], lambda[1]};
      return;
    }
    double omega{}, zeta{};
    if (dataset_.number == uff_modes) {
      const auto numbers = reals(at_.numbers, 3);
      omega = base::two_pi * numbers[0];
      mode.modal_mass = numbers[1];
      zeta = numbers[2];
    } else {
      const auto numbers = reals(at_.numbers, 5);
      omega = base::two_pi * numbers[1];
      mode.modal_mass = numbers[3];
      zeta = numbers[4];
    }
    mode.pole = {-zeta * omega, omega * std::sqrt(std::max(0.0, 1.0 - zeta * zeta))};
  }

  /// Speeds are λ times displacements, accelerations λ² times.
  void become_displacements(long long quantity, ModeDataset& mode) {
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
  void become_metres(ModeDataset& mode) const {
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
    notes_.fail(fmt::format("dataset {}: {}", dataset_.number, what),
                dataset_.line > 0 ? dataset_.line + below : 0);
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
    for (std::size_t at = at_.nodes; at < dataset_.lines.size(); at += 1 + lines) {
      const int node = static_cast<int>(integers(at, 1)[0]);
      std::vector<double> all;
      for (std::size_t k = 0; k < lines; ++k) {
        const auto some = reals(at + 1 + k, std::min<std::size_t>(6, numbers - 6 * k));
        all.insert(all.end(), some.begin(), some.end());
      }
      for (std::size_t c = 0; c < per_node; ++c)
        values[{node, static_cast<int>(c)}] =
            complex ? std::complex(all[2 * c], all[2 * c + 1]) : std::complex(all[c], 0.0);
    }
  }

  const UffLines& dataset_;
  Notes& notes_;
  LinesOf at_;
};

}  // namespace

std::optional<ModeDataset> read_mode(const UffLines& dataset, Notes& notes) {
  return ModeReader(dataset, notes).read();
}

}  // namespace hydrapod::data
