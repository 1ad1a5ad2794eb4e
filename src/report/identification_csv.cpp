#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

using base::two_pi;
using Eigen::Index;

namespace {

constexpr const char* pose_title = "pose";
constexpr const char* spacing_title = "line_spacing_hz";
const std::string deviation_title = "deviation ";  // of the shape at an output

/// "pose x" … "pose rz": of the platform in the base frame [m, rad].
std::string pose_number_title(int direction) {
  return fmt::format("{} {}", pose_title, spatial::direction_name(direction));
}

/// Titles and cells of the pose, each after a comma.
std::pair<std::string, std::string> pose_columns(const data::Experiment* experiment) {
  if (experiment == nullptr || experiment->pose_name.empty()) return {};
  std::string titles = fmt::format(",{}", pose_title);
  std::string cells = fmt::format(",{}", base::quoted_cell(experiment->pose_name));
  if (!experiment->pose) return {titles, cells};
  for (int k = 0; k < 6; ++k) {
    titles += ',' + pose_number_title(k);
    cells += fmt::format(",{:.17g}", (*experiment->pose)[static_cast<std::size_t>(k)]);
  }
  return {titles, cells};
}

}  // namespace

std::string identified_modes_csv(const identification::Identification& result,
                                 std::optional<observation::Observed> observed,
                                 const data::Experiment* experiment) {
  std::string text =
      "mode,frequency_hz,frequency_95_hz,damping_ratio,damping_95,mpc,mpd_rad,quality,significance";
  for (const auto& o : result.responses.outputs)
    text +=
        fmt::format(",{},{}", base::quoted_cell("re " + o.name), base::quoted_cell("im " + o.name));
  const auto [pose_titles, pose_cells] = pose_columns(experiment);
  text += ",shape_against,observed" + pose_titles;
  for (const auto& o : result.responses.outputs)
    text += ',' + base::quoted_cell(deviation_title + o.name);
  text += fmt::format(",{}\n", spacing_title);
  const auto numbers = identification::modal_results(result);
  const auto* against = observation::name(observation::motion_against(result.responses.outputs));
  std::size_t number = 0;
  for (const auto& m : result.modes) {
    text += fmt::format(
        "{},{:.17g},{:.6g},{:.17g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", ++number,
        m.fit.omega() / two_pi, numerics::normal_half_width * m.fit.omega_deviation / two_pi,
        m.fit.damping_ratio(), numerics::normal_half_width * m.fit.damping_deviation, m.mpc, m.mpd,
        m.quality(), m.fit.significance);
    for (const auto& value : m.displacement)
      text += fmt::format(",{:.9g},{:.9g}", value.real(), value.imag());
    text +=
        fmt::format(",{},{}{}", against, observed ? observation::name(*observed) : "", pose_cells);
    for (const double deviation : numbers.modes[number - 1U].shape_deviation)
      text += fmt::format(",{:.6g}", deviation);
    text += fmt::format(",{:.9g}\n", numbers.line_spacing);
  }
  return text;
}

namespace {

/// A row of the table of identified modes, by the titles of its columns.
class ModeRow {
 public:
  ModeRow(const base::TableReader& table, const std::vector<base::TableTitle>& titles,
          const std::vector<base::TableCell>& cells)
      : table_(table), titles_(titles), cells_(cells) {
    if (cells.size() != titles.size())
      throw base::InputError(
          {table.fault(1, "",
                       fmt::format("has {} cells, expected {} as in the title row", cells.size(),
                                   titles.size()))});
  }

  [[nodiscard]] const base::TableCell* find(std::string_view title) const {
    for (std::size_t k = 0; k < titles_.size(); ++k)
      if (titles_[k].name == title) return &cells_[k];
    return nullptr;
  }
  [[nodiscard]] double number(const std::string& title) const {
    const auto* cell = find(title);
    const auto value = cell != nullptr ? base::table_number(cell->text, table_.style.decimal_comma)
                                       : std::optional<double>();
    if (!value)
      throw base::InputError(
          {table_.fault(cell != nullptr ? cell->column : 1, base::printable(title),
                        "expected a number, as `hydrapod identify` writes it")});
    return *value;
  }
  /// One of two words and more; none for an empty cell.
  template <class Enum, std::size_t N>
  [[nodiscard]] std::optional<Enum> word(const char* title,
                                         const std::array<Enum, N>& values) const {
    const auto* cell = find(title);
    if (cell == nullptr || cell->text.empty()) return {};
    for (const auto value : values)
      if (cell->text == observation::name(value)) return value;
    throw base::InputError({table_.fault(cell->column, title, "is an unknown word")});
  }

 private:
  const base::TableReader& table_;
  const std::vector<base::TableTitle>& titles_;
  const std::vector<base::TableCell>& cells_;
};

/// The outputs whose shapes stand in the columns "re NAME" and "im NAME".
std::vector<data::Channel> outputs_of(const std::vector<base::TableTitle>& titles) {
  std::vector<data::Channel> outputs;
  for (const auto& title : titles) {
    if (!title.name.starts_with("re ")) continue;
    data::Channel channel{.name = title.name.substr(3)};
    if (const auto direction = spatial::direction_from_name(channel.name))
      channel.direction = static_cast<data::Direction>(*direction + 1);
    outputs.push_back(channel);
  }
  return outputs;
}

data::ModalResult mode_of(const ModeRow& row, const std::vector<data::Channel>& outputs) {
  constexpr double band = numerics::normal_half_width;
  data::ModalResult mode;
  const double omega = two_pi * row.number("frequency_hz"), ratio = row.number("damping_ratio");
  const auto count = static_cast<Index>(outputs.size());
  mode.pole = omega * std::complex<double>(-ratio, std::sqrt(std::max(0.0, 1.0 - ratio * ratio)));
  mode.omega_deviation = two_pi * row.number("frequency_95_hz") / band;
  mode.damping_deviation = row.number("damping_95") / band;
  mode.significance = row.number("significance");
  mode.shape.resize(count);
  for (Index o = 0; o < count; ++o) {
    const auto& name = outputs[static_cast<std::size_t>(o)].name;
    mode.shape[o] = {row.number("re " + name), row.number("im " + name)};
  }
  mode.shape_deviation = Eigen::VectorXd::Zero(count);  // lists of earlier versions have none
  for (Index o = 0; o < count; ++o) {
    const std::string title = deviation_title + outputs[static_cast<std::size_t>(o)].name;
    if (row.find(title) != nullptr) mode.shape_deviation[o] = row.number(title);
  }
  return mode;
}

}  // namespace

bool is_identified_modes_csv(const std::string& path) {
  const auto titles = base::TableReader(path).titles();
  return std::ranges::count(titles, "frequency_95_hz", &base::TableTitle::name) > 0;
}

ListedModes identified_modes_from_csv(const std::string& path) {
  using observation::MotionAgainst;
  using observation::Observed;
  base::TableReader table(path);
  const auto titles = table.titles();
  ListedModes list;
  list.modes.outputs = outputs_of(titles);
  std::vector<base::TableCell> cells;
  while (table.row(cells)) {
    const ModeRow row(table, titles, cells);
    list.modes.modes.push_back(mode_of(row, list.modes.outputs));
    list.against =
        row.word("shape_against", std::array{MotionAgainst::ground, MotionAgainst::base});
    list.observed =
        row.word("observed", std::array{Observed::mechanics, Observed::plant, Observed::system});
    if (row.find(spacing_title) != nullptr) list.modes.line_spacing = row.number(spacing_title);
    if (const auto* cell = row.find(pose_title)) list.experiment.pose_name = cell->text;
    if (row.find(pose_number_title(0)) == nullptr) continue;
    auto& pose = list.experiment.pose.emplace();
    for (int k = 0; k < 6; ++k)
      pose[static_cast<std::size_t>(k)] = row.number(pose_number_title(k));
  }
  if (list.modes.modes.empty())
    throw base::InputError({table.fault(0, "", "there is no mode below the title row")});
  return list;
}

}  // namespace hydrapod::report
