/// Frequency responses as tables of text: a column of frequencies, and two columns per response,
/// real and imaginary part or magnitude and phase.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "axis_units.hpp"
#include "channel_roles.hpp"
#include "channel_units.hpp"
#include "formats.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/data/frequency_response.hpp"
#include "response_comments.hpp"
#include "response_files.hpp"
#include "response_titles.hpp"
#include "table_head.hpp"

namespace hydrapod::data {

namespace {

struct ResponseName {
  std::string output{}, input{};
  int output_point{}, input_point{};
};

/// "a1/F", "a1 from F", "H12" (output 1, input 2); another name is one of an output.
ResponseName response_name(const std::string& name) {
  for (const std::string_view between : {" / ", "/", " from ", " due to "}) {
    const std::size_t at = name.find(between);
    if (at == name.npos || at == 0 || name.find(between, at + 1) != name.npos) continue;
    return {bare_name(name.substr(0, at)), bare_name(name.substr(at + between.size()))};
  }
  std::string digits;
  for (const char c : name)
    if (c >= '0' && c <= '9') digits += c;
  const bool only_digits = digits.size() == 2 && (name.starts_with('H') || name.starts_with('h')) &&
                           name.find_first_not_of("Hh_,(){} 0123456789") == name.npos;
  if (only_digits) {
    const int o = digits[0] - '0', i = digits[1] - '0';
    return {fmt::format("output {}", o), fmt::format("input {}", i), o, i};
  }
  return {name.empty() ? "response" : name, "input"};
}

struct ResponseUnit {
  ChannelUnit output{}, input{};
};

/// Nobody measures responses of masses, or to masses.
ChannelUnit unit_of_response(const std::string& written, Notes& notes) {
  if (!is_pounds(written)) return channel_unit(written);
  notes.add(pounds_of_force(written), 0, 0, "pounds");
  return channel_unit("lbf");
}

/// "m/s^2/N", "(m/s^2)/N", "g/N": the last slash parts them, unless a time stands behind it.
ResponseUnit response_unit(std::string text, Notes& notes) {
  text = std::string(base::trimmed(text));
  const auto enclosed = [](std::string_view part) {
    part = base::trimmed(part);
    if (part.size() > 1 && part.front() == '(' && part.back() == ')')
      part = part.substr(1, part.size() - 2);
    return std::string(part);
  };
  int depth = 0;
  for (std::size_t k = text.size(); k-- > 1;) {
    if (text[k] == ')') ++depth;
    if (text[k] == '(') --depth;
    if (text[k] != '/' || depth != 0) continue;
    const ChannelUnit below = unit_of_response(enclosed(text.substr(k + 1)), notes);
    if (!below.known || below.unit == "s" || below.unit == "s^2") break;
    return {unit_of_response(enclosed(text.substr(0, k)), notes), below};
  }
  return {unit_of_response(enclosed(text), notes), {}};
}

class ResponseTable {
 public:
  explicit ResponseTable(const std::string& path) : notes_(path), table_(path) {
    RecordComments comments;
    head_ = read_table_head(table_, notes_, [&](std::string_view line, unsigned number) {
      comments.take(line, number);
    });
    if (!head_.first_row) return;
    described_ = described_responses(comments, notes_);
    const TableNames names = table_names(head_, table_.style.separator, false, notes_);
    for (std::size_t c = 0; c < head_.columns; ++c) {
      columns_.push_back(described_ ? own_column(names.titles[c]) : table_column(names.titles[c]));
      if (!names.units.empty() && !names.units[c].empty()) columns_.back().unit = names.units[c];
    }
    pairs_ = pairs_of(columns_);
    if (!described_)  // what belongs to responses means nothing without its description
      std::erase_if(pairs_, [](auto& pair) { return pair.group != TableGroup::response; });
  }

  [[nodiscard]] bool holds_responses() const {
    const auto has = [&](TablePart part) {
      return std::ranges::find(columns_, part, &TableColumn::part) != columns_.end();
    };
    return !pairs_.empty() && has(TablePart::frequency) && !has(TablePart::time);
  }

  ReadFrequencyResponsesResult read() {
    if (!holds_responses())
      notes_.fail(
          "this is no table of frequency responses: expected are titles that name a frequency, and "
          "per response a real and an imaginary part or a magnitude and a phase (\"Hz, re a/F, im "
          "a/F\")");
    frequency_column_ = static_cast<std::size_t>(
        std::ranges::find(columns_, TablePart::frequency, &TableColumn::part) - columns_.begin());
    require_phase_units();
    find_plain_magnitudes();
    find_needed();
    read_rows();
    settle_phases();
    FrequencyResponses all = assembled();
    if (!described_) require_imaginary_parts(all, notes_);
    return {std::move(all), notes_.all()};
  }

 private:
  void read_rows() {
    const TableColumn& column = columns_[frequency_column_];
    const auto hertz = hertz_of(column.unit, column.circular);
    if (!hertz)
      notes_.fail(fmt::format("the unit \"{}\" of the frequencies {}", base::printable(column.unit),
                              frequency_problem(column.unit)));
    table_.go_to(*head_.first_row);
    std::string_view line;
    constexpr std::size_t most = std::size_t{1} << 27U;  // numbers, 1 GiB
    while (table_.next_line(line)) {
      if (!take_row(line)) continue;
      rows_.back()[frequency_column_] *= *hertz;
      require_ascending();
      require_magnitudes();
      if (rows_.size() * head_.columns > most)
        notes_.fail("the table is larger than fits into memory", table_.line());
    }
  }

  bool note_cut_line() {
    notes_.add("the file is cut off within this line, which is left out", table_.line());
    return false;
  }

  bool take_row(std::string_view line) {
    // hydrapod ends each line, so the last number may be cut off too
    if (described_ && !table_.line_was_ended()) return note_cut_line();
    std::vector<double> row;
    base::TableCells cells(line, table_.style.separator);
    std::string_view cell;
    for (std::size_t c = 0; c < head_.columns && cells.next(cell); ++c) {
      const auto value = base::table_number(cell, table_.style.decimal_comma);
      if (needed_[c] && (!value || !std::isfinite(*value)))
        notes_.fail(fmt::format("\"{}\" is not a finite number; a response needs a value at every "
                                "frequency",
                                base::printable(cell, 30)),
                    table_.line(), cells.column());
      row.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    if (row.size() < head_.columns && !table_.line_was_ended()) return note_cut_line();
    if (row.size() < head_.columns)
      notes_.fail(fmt::format("{} fields instead of {}", row.size(), head_.columns), table_.line());
    rows_.push_back(std::move(row));
    return true;
  }

  void find_needed() {
    needed_.assign(head_.columns, false);
    needed_[frequency_column_] = true;
    for (const PairColumns& pair : pairs_) needed_[pair.first] = needed_[pair.second] = true;
  }

  void require_ascending() const {
    const double now = rows_.back()[frequency_column_];
    const double before = rows_.size() > 1 ? rows_[rows_.size() - 2][frequency_column_] : -1.0;
    if (now < 0.0)
      notes_.fail(fmt::format("the frequency is {} Hz{}", now, two_sided_remedy), table_.line());
    if (now <= before)
      notes_.fail(
          fmt::format("the frequency {} Hz does not ascend; expected are frequencies from 0 "
                      "Hz on, each above the one before",
                      now),
          table_.line());
  }

  [[nodiscard]] bool is_decibel(const PairColumns& pair) const {
    return pair.polar && base::lower_case(columns_[pair.first].unit).starts_with("db");
  }

  void find_plain_magnitudes() {
    for (const PairColumns& pair : pairs_)
      if (pair.polar && !is_decibel(pair)) plain_magnitudes_.emplace_back(pair.first, pair.name);
  }

  void require_phase_units() {
    for (const PairColumns& pair : pairs_) {
      const std::string& unit = columns_[pair.second].unit;
      if (!pair.polar || unit.empty()) continue;
      if (!radians_of(unit))
        notes_.fail(fmt::format("the unit \"{}\" of the phase \"{}\" is unknown; accepted are deg, "
                                "rad and gon",
                                base::printable(unit, 30), base::printable(pair.name)),
                    head_.texts.empty() ? 0 : head_.texts.back().number,
                    columns_[pair.second].column);
      if (base::trimmed(unit) == "grad")
        notes_.add("phases in \"grad\" are taken for gon, 400 per turn", 0, 0, "grad");
    }
  }

  void require_magnitudes() const {
    for (const auto& [column, name] : plain_magnitudes_)
      if (rows_.back()[column] < 0.0)
        notes_.fail(fmt::format("the magnitude \"{}\" is {}, and must not be below 0; is it in dB? "
                                "Title it [dB]",
                                base::printable(name), rows_.back()[column]),
                    table_.line());
  }

  /// Phases without a unit are degrees where they go up to some 180 or 360; else nobody knows.
  void settle_phases() {
    for (const PairColumns& pair : pairs_) {
      TableColumn& phase = columns_[pair.second];
      if (!pair.polar || !phase.unit.empty()) continue;
      double largest = 0.0;
      for (const auto& row : rows_) largest = std::max(largest, std::abs(row[pair.second]));
      constexpr double least_degrees = 60.0, most_degrees = 360.001;  // 60 rad turn ten times
      if (largest < least_degrees || largest > most_degrees)
        notes_.fail(fmt::format("the phase \"{}\" has no unit, and its values may be degrees or "
                                "radians; title it with its unit (\"phase [deg]\" or \"phase "
                                "[rad]\")",
                                base::printable(pair.name)),
                    head_.texts.empty() ? 0 : head_.texts.back().number, phase.column);
      phase.unit = "deg";
      notes_.add("phases without a unit are taken for degrees", 0, 0, "phase");
    }
  }

  /// Units are read once: a table has many rows.
  struct Polar {
    bool decibel{};
    double radians{};  ///< of one of the phase
  };
  [[nodiscard]] Polar polar_of(const PairColumns& pair) const {
    if (!pair.polar) return {};
    return {is_decibel(pair), *radians_of(columns_[pair.second].unit)};
  }

  static std::complex<double> value(const PairColumns& pair, const Polar& polar,
                                    const std::vector<double>& row) {
    if (!pair.polar) return {row[pair.first], row[pair.second]};
    const double magnitude =
        polar.decibel ? std::pow(10.0, row[pair.first] / 20.0) : row[pair.first];
    return std::polar(1.0, polar.radians * row[pair.second]) * magnitude;
  }

  static std::size_t number_of(const Channel& channel, std::vector<Channel>& channels) {
    const auto at = std::ranges::find(channels, channel.name, &Channel::name);
    if (at != channels.end()) return static_cast<std::size_t>(at - channels.begin());
    channels.push_back(channel);
    return channels.size() - 1;
  }

  struct Place {
    Eigen::Index row{}, column{};
    double factor{1.0};  ///< to SI
    Polar polar{};
  };

  /// Of a response by any program; its channels are added where they are new.
  Place place_of(const PairColumns& pair, FrequencyResponses& all) {
    const ResponseName name = response_name(pair.name);
    std::string written = columns_[pair.first].unit;
    if (const std::string lower = base::lower_case(written); lower.starts_with("db")) {
      const std::size_t re = lower.find("re");
      written = re == lower.npos ? "" : written.substr(re + 2);
    }
    const ResponseUnit unit = response_unit(written, notes_);
    const double factor = unit.output.factor / unit.input.factor;
    if (factor != 1.0)
      notes_.add(fmt::format("\"{}\": \"{}\" converted to SI, times {}", base::printable(pair.name),
                             base::printable(written), factor),
                 0, 0, "unit");
    const auto o = number_of({.name = name.output,
                              .unit = unit.output.unit,
                              .role = Role::response,
                              .point = name.output_point},
                             all.outputs);
    const auto i = number_of({.name = name.input,
                              .unit = unit.input.unit,
                              .role = Role::excitation,
                              .point = name.input_point},
                             all.inputs);
    return {static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(i), factor, polar_of(pair)};
  }

  /// The channels of "a1/F" among those that are described.
  static std::optional<std::pair<const Channel*, const Channel*>> described_pair(
      const std::string& name, const std::vector<Channel>& rows,
      const std::vector<Channel>& columns) {
    for (const Channel& row : rows)
      if (name.starts_with(row.name + "/"))
        for (const Channel& column : columns)
          if (name.size() == row.name.size() + 1 + column.name.size() &&
              name.ends_with(column.name))
            return std::pair(&row, &column);
    return {};
  }

  void take_channels(FrequencyResponses& all) {
    for (const PairColumns& pair : pairs_) {
      if (pair.group != TableGroup::response) continue;
      if (!described_) {
        places_.emplace_back(pair, place_of(pair, all));
        continue;
      }
      const auto channels = described_pair(pair.name, described_->outputs, described_->inputs);
      if (!channels) {
        notes_.add(fmt::format("\"{}\" is not among the responses that are described: left out",
                               base::printable(pair.name)),
                   0, 0, "not described");
        continue;
      }
      places_.emplace_back(
          pair, Place{.row = static_cast<Eigen::Index>(number_of(*channels->first, all.outputs)),
                      .column = static_cast<Eigen::Index>(number_of(*channels->second, all.inputs)),
                      .polar = polar_of(pair)});
    }
    if (!described_) tell_measured_inputs(all.inputs);
    if (places_.empty()) notes_.fail("none of the responses that are described is in the table");
  }

  /// A matrix per line of a group of columns, NaN where there is none; nothing without any column.
  [[nodiscard]] std::vector<Eigen::MatrixXcd> collected(TableGroup group,
                                                        const std::vector<Channel>& of,
                                                        const std::vector<Channel>& to) const {
    std::vector<Eigen::MatrixXcd> matrices;
    constexpr double missing = std::numeric_limits<double>::quiet_NaN();
    for (const PairColumns& pair : pairs_) {
      const auto channels = pair.group == group ? described_pair(pair.name, of, to) : std::nullopt;
      if (!channels) continue;
      if (matrices.empty())
        matrices.assign(rows_.size(),
                        Eigen::MatrixXcd::Constant(static_cast<Eigen::Index>(of.size()),
                                                   static_cast<Eigen::Index>(to.size()), missing));
      const auto i = channels->first - of.data(), j = channels->second - to.data();
      const Polar polar = polar_of(pair);
      for (std::size_t k = 0; k < rows_.size(); ++k)
        matrices[k](i, j) = value(pair, polar, rows_[k]);
    }
    return matrices;
  }

  FrequencyResponses assembled() {
    FrequencyResponses all;
    take_channels(all);
    require_all_pairs(all);
    const auto rows = static_cast<Eigen::Index>(all.outputs.size());
    const auto columns = static_cast<Eigen::Index>(all.inputs.size());
    const bool deviations = std::ranges::all_of(
        places_, [](const auto& entry) { return entry.first.deviation.has_value(); });
    WrittenErrors errors;
    for (const auto& row : rows_) {
      all.frequency.push_back(row[frequency_column_]);
      Eigen::MatrixXcd H(rows, columns);
      Eigen::MatrixXd V(rows, columns);
      for (const auto& [pair, place] : places_) {
        H(place.row, place.column) = place.factor * value(pair, place.polar, row);
        if (deviations)
          V(place.row, place.column) = std::pow(place.factor * row[*pair.deviation], 2);
      }
      all.H.push_back(H);
      if (deviations) errors.variance.push_back(V);
    }
    if (described_) {
      all.title = described_->title;
      all.date = described_->date;
      take_description(*described_, notes_, all);
      errors.noise = collected(TableGroup::noise, all.outputs, all.outputs);
      errors.input_factor = collected(TableGroup::input_factor, all.inputs, all.inputs);
      take_beside_axis(collected(TableGroup::beside_axis, all.outputs, all.inputs), notes_, all);
    }
    take_errors(std::move(errors), notes_, all);
    add_coherence(all);
    return all;
  }

  void require_all_pairs(const FrequencyResponses& all) const {
    Eigen::MatrixXi found = Eigen::MatrixXi::Zero(static_cast<Eigen::Index>(all.outputs.size()),
                                                  static_cast<Eigen::Index>(all.inputs.size()));
    for (const auto& [pair, place] : places_) ++found(place.row, place.column);
    for (Eigen::Index o = 0; o < found.rows(); ++o)
      for (Eigen::Index i = 0; i < found.cols(); ++i)
        if (found(o, i) != 1)
          notes_.fail(
              fmt::format("the response of {} to {} stands {} in the table; expected are "
                          "all pairs of outputs and inputs, once each",
                          base::printable(all.outputs[static_cast<std::size_t>(o)].name),
                          base::printable(all.inputs[static_cast<std::size_t>(i)].name),
                          found(o, i) == 0 ? "nowhere" : "more than once"));
  }

  /// Where every output has a column of coherences.
  void add_coherence(FrequencyResponses& all) const {
    std::vector<std::size_t> columns;
    for (const Channel& output : all.outputs)
      for (std::size_t c = 0; c < columns_.size(); ++c)
        if (columns_[c].part == TablePart::coherence &&
            (columns_[c].name == output.name || all.outputs.size() == 1))
          columns.push_back(c);
    if (columns.size() != all.outputs.size()) return;
    for (const auto& row : rows_) {
      Eigen::VectorXd coherence(static_cast<Eigen::Index>(columns.size()));
      for (std::size_t k = 0; k < columns.size(); ++k)
        coherence[static_cast<Eigen::Index>(k)] = row[columns[k]];
      if (!coherence.allFinite()) return all.multiple_coherence.clear();
      all.multiple_coherence.push_back(coherence);
    }
  }

  Notes notes_;
  base::TableReader table_;
  TableHead head_{};
  std::vector<TableColumn> columns_{};
  std::vector<PairColumns> pairs_{};
  std::optional<FrequencyResponses> described_{};        ///< by hydrapod, without lines
  std::vector<std::pair<PairColumns, Place>> places_{};  ///< of the responses
  std::size_t frequency_column_{};
  std::vector<bool> needed_{};  ///< columns of which every number is
  std::vector<std::pair<std::size_t, std::string>> plain_magnitudes_{};  ///< columns, names
  std::vector<std::vector<double>> rows_{};
};

}  // namespace

bool is_response_table(const std::string& path) { return ResponseTable(path).holds_responses(); }

ReadFrequencyResponsesResult read_response_table(const std::string& path) {
  return ResponseTable(path).read();
}

}  // namespace hydrapod::data
