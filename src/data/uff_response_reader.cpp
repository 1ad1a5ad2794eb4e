#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "channel_roles.hpp"
#include "hydrapod/base/text.hpp"
#include "response_comments.hpp"
#include "response_files.hpp"
#include "uff_dataset.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

Channel channel_at(const UffPlace& place, const std::string& name, const ChannelUnit& unit = {},
                   Role role = Role::other) {
  return {name, unit.unit, uff_direction(place), role, uff_point(place), uff_entity(place)};
}

/// Outputs or inputs in the order in which they come. Those of hydrapod are told apart by point,
/// direction and name; those of other programs, whose names are of any kind, by part and unit in
/// place of the name, unless they have no place.
class Places {
 public:
  explicit Places(bool by_hydrapod) : by_hydrapod_(by_hydrapod) {}

  /// The number of a place; the channel is kept when it is new.
  std::size_t number(const Channel& channel) {
    const auto [at, is_new] = numbers_.emplace(key_of(channel), channels.size());
    if (is_new) channels.push_back(channel);
    return at->second;
  }
  /// A companion of a response need not state its unit: the only channel of that part and place, or
  /// of those the only one of that name.
  [[nodiscard]] std::optional<std::size_t> known(const Channel& channel) const {
    if (const auto at = numbers_.find(key_of(channel)); at != numbers_.end()) return at->second;
    if (by_hydrapod_) return std::nullopt;
    std::vector<std::size_t> there, named;
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const Channel& c = channels[k];
      if (c.point != channel.point || c.direction != channel.direction ||
          c.entity != channel.entity)
        continue;
      there.push_back(k);
      if (c.name == channel.name) named.push_back(k);
    }
    if (there.size() == 1) return there[0];
    return named.size() == 1 ? std::optional(named[0]) : std::nullopt;
  }

  std::vector<Channel> channels{};

 private:
  using Key = std::tuple<int, Direction, std::string>;
  [[nodiscard]] Key key_of(const Channel& channel) const {
    const bool placed = channel.point != 0 || channel.direction != Direction::none;
    return {channel.point, channel.direction,
            by_hydrapod_ || !placed ? channel.name : channel.entity + '\n' + channel.unit};
  }

  bool by_hydrapod_;
  std::map<Key, std::size_t> numbers_{};
};

struct Curve {
  std::size_t output{}, input{};
  std::vector<std::complex<double>> values{};
  std::vector<std::string> id_lines{};
};

class ResponseReader {
 public:
  explicit ResponseReader(const std::string& path)
      : notes_(path),
        file_(path),
        contents_(scan_uff(path, notes_)),
        by_hydrapod_(contents_.own.by_hydrapod(notes_)),
        described_(described_responses(contents_.own, notes_)) {}

  ReadFrequencyResponsesResult read() {
    for (const UffFunction& f : contents_.functions)
      if (f.type == uff_function::frequency_response) take_response(f);
    if (responses_.empty())
      notes_.fail("the Universal File holds no frequency response that can be read");
    std::size_t others = 0;
    for (const UffFunction& f : contents_.functions) {
      if (f.type == uff_function::multiple_coherence)
        take_companion(f, "coherence", coherences_, outputs_, nullptr);
      else if (f.type == uff_function::general && take_part(f))
        continue;
      else if (f.type != uff_function::frequency_response)
        ++others;
    }
    if (others > 0) notes_.add(fmt::format("{} functions of other types left out", others));
    return {assembled(), notes_.all()};
  }

 private:
  [[nodiscard]] std::string name_of(const UffAxis& axis, const std::string& line) const {
    const std::string label = given(axis.label), whole = given(line);
    return by_hydrapod_ && !whole.empty() && whole.starts_with(label) ? whole : label;
  }

  /// Output and input by the number that hydrapod gave the function, if they are in its place.
  [[nodiscard]] std::optional<std::pair<Channel, Channel>> described_pair(
      const UffFunction& f) const {
    if (!described_) return {};
    const auto n = static_cast<long long>(described_->inputs.size());
    const auto row = (f.number - 1) / n, column = (f.number - 1) % n;
    if (f.number < 1 || row >= static_cast<long long>(described_->outputs.size())) return {};
    auto pair = std::pair(described_->outputs[static_cast<std::size_t>(row)],
                          described_->inputs[static_cast<std::size_t>(column)]);
    const auto is_at = [](const Channel& channel, const UffPlace& place) {
      return channel.point == uff_point(place) && channel.direction == uff_direction(place);
    };
    if (!is_at(pair.first, f.response) || !is_at(pair.second, f.reference)) return {};
    for (Channel* channel : {&pair.first, &pair.second})  // as other functions name it
      channel->name = base::trimmed(fortran_a(channel->name, 80));
    return pair;
  }

  /// Frequencies and values; false where the frequencies are not those of the first function.
  bool values_of(const UffFunction& f, std::vector<std::complex<double>>& values) {
    UffValues reader(file_, f);
    const double hertz = uff_hertz(f, notes_);
    std::vector<double> frequency;
    for (std::uint64_t k = 0; k < f.count; ++k) {
      double at = f.first + static_cast<double>(k) * f.step, real = uff_missing, imaginary = 0.0;
      if (!f.is_even && !reader.next(at, notes_)) break;
      if (!reader.next(real, notes_) || (f.is_complex && !reader.next(imaginary, notes_))) break;
      frequency.push_back(hertz * at);
      values.emplace_back(real, imaginary);
    }
    const bool ascending =
        !frequency.empty() && frequency.front() >= 0.0 &&
        std::ranges::all_of(frequency, [](double v) { return std::isfinite(v); }) &&
        std::ranges::adjacent_find(frequency, std::greater_equal<>()) == frequency.end();
    if (!ascending) {
      if (!frequency.empty() && frequency.front() < 0.0)
        notes_.fail(fmt::format("dataset {}: its first frequency is {} Hz{}", f.dataset,
                                frequency.front(), two_sided_remedy),
                    f.line);
      notes_.add(fmt::format("dataset {}: its frequencies do not ascend from 0 Hz on: left out",
                             f.dataset),
                 f.line);
      return false;
    }
    if (frequency_.empty()) frequency_ = frequency;
    bool same = frequency.size() == frequency_.size();
    for (std::size_t k = 0; same && k < frequency.size(); ++k)
      same = std::abs(frequency[k] - frequency_[k]) <= 2e-5 * std::abs(frequency_[k]);
    if (!same)
      notes_.add(fmt::format("dataset {} has other frequencies than the first response: left out",
                             f.dataset),
                 f.line);
    return same;
  }

  void require_response(const UffFunction& f) const {
    if (f.abscissa.quantity == uff_quantity::time)
      notes_.fail(fmt::format("dataset {} is a frequency response (function type 4), but its "
                              "abscissa is time (specific data type 17); expected is 18, frequency",
                              f.dataset),
                  f.line);
    if (!f.is_complex)
      notes_.fail(fmt::format("dataset {} is a frequency response (function type 4) of real "
                              "numbers (data type {}), without phases; expected are complex ones "
                              "(data type 5 or 6)",
                              f.dataset, f.is_double ? 4 : 2),
                  f.line);
  }

  void take_response(const UffFunction& f) {
    require_response(f);
    Curve curve;
    if (!values_of(f, curve.values)) return;
    const ChannelUnit up = uff_unit(f.ordinate, f.response.direction, f.units, notes_);
    UffAxis below = f.denominator;
    if (is_pounds(below.unit) && below.quantity <= uff_quantity::general)
      below.quantity = uff_quantity::excitation_force;
    const ChannelUnit down = uff_unit(below, f.reference.direction, f.units, notes_);
    const double factor = up.factor / down.factor;
    if (factor != 1.0) {
      for (auto& value : curve.values) value *= factor;
      notes_.add(fmt::format("dataset {}: converted to SI, times {}", f.dataset, factor), f.line, 0,
                 "unit");
    }
    const auto pair = described_pair(f).value_or(std::pair(
        channel_at(f.response, name_of(f.ordinate, f.id[3]), up, Role::response),
        channel_at(f.reference, name_of(f.denominator, f.id[4]), down, Role::excitation)));
    curve.output = outputs_.number(pair.first);
    curve.input = inputs_.number(pair.second);
    if (!taken_.emplace(curve.output, curve.input).second)
      return notes_.add(
          fmt::format("dataset {} is a second response of the same output to the same "
                      "input: left out",
                      f.dataset),
          f.line, 0, "second");
    if (!by_hydrapod_) curve.id_lines = uff_id_lines(f.id);
    if (responses_.empty()) date_ = iso_date(given(f.id[2]));
    responses_.push_back(std::move(curve));
  }

  /// What identification needs, see response_comments.hpp; false for another function.
  bool take_part(const UffFunction& f) {
    if (f.id[0] == response_part::variance)
      take_companion(f, "variance", variances_, outputs_, &inputs_);
    else if (f.id[0] == response_part::beside_axis)
      take_companion(f, "response beside the axis", beside_, outputs_, &inputs_);
    else if (f.id[0] == response_part::noise)
      take_companion(f, "noise", noise_, outputs_, &outputs_);
    else if (f.id[0] == response_part::input_factor)
      take_companion(f, "input factor", input_factor_, inputs_, &inputs_);
    else
      return false;
    return true;
  }

  /// What is said of a channel, or of two.
  void take_companion(const UffFunction& f, const char* what, std::vector<Curve>& curves,
                      const Places& rows, const Places* columns) {
    Curve curve;
    const auto row = rows.known(channel_at(f.response, given(f.id[3])));
    const auto column = columns != nullptr ? columns->known(channel_at(f.reference, given(f.id[4])))
                                           : std::optional<std::size_t>(0);
    if (!row || !column || !values_of(f, curve.values))
      return notes_.add(
          fmt::format("dataset {}: a {} without its response: left out", f.dataset, what), f.line,
          0, what);
    curve.output = *row;
    curve.input = *column;
    curves.push_back(std::move(curve));
  }

  FrequencyResponses assembled() {
    FrequencyResponses all;
    all.title = given(contents_.model_name);
    all.date = date_;
    all.outputs = outputs_.channels;
    all.inputs = inputs_.channels;
    all.geometry = contents_.geometry;
    for (auto* channels : {&all.outputs, &all.inputs}) {
      if (!by_hydrapod_) name_by_place(*channels);
      make_names_unique(*channels);
    }
    if (!by_hydrapod_) tell_measured_inputs(all.inputs);
    take_id_lines(all);
    all.frequency = frequency_;
    const auto lines = static_cast<Eigen::Index>(frequency_.size());
    const auto rows = static_cast<Eigen::Index>(all.outputs.size());
    const auto columns = static_cast<Eigen::Index>(all.inputs.size());
    constexpr Eigen::Index most = 1 << 26;  // complex numbers, 1 GiB
    if (rows * columns > most / lines)
      notes_.fail(
          fmt::format("{} outputs × {} inputs × {} frequencies are more than fit into memory", rows,
                      columns, lines));
    const auto collected = [&](const std::vector<Curve>& curves, Eigen::Index height,
                               Eigen::Index width) {
      std::vector<Eigen::MatrixXcd> matrices;
      if (!curves.empty())
        matrices.assign(frequency_.size(), Eigen::MatrixXcd::Constant(height, width, uff_missing));
      for (const Curve& curve : curves)
        for (std::size_t k = 0; k < frequency_.size(); ++k)
          matrices[k](static_cast<Eigen::Index>(curve.output),
                      static_cast<Eigen::Index>(curve.input)) = curve.values[k];
      return matrices;
    };
    all.H = collected(responses_, rows, columns);
    require_all_pairs(all);
    if (!by_hydrapod_) require_imaginary_parts(all, notes_);
    for (const auto& coherence : collected(coherences_, rows, 1))
      all.multiple_coherence.emplace_back(coherence.real());
    WrittenErrors errors;
    if (rows * rows <= most / lines) {
      errors.noise = collected(noise_, rows, rows);
      errors.input_factor = collected(input_factor_, columns, columns);
    }
    for (const auto& variance : collected(variances_, rows, columns))
      errors.variance.emplace_back(variance.real());
    take_errors(std::move(errors), notes_, all);
    if (described_) {
      take_description(*described_, notes_, all);
      take_names(described_->outputs, all.outputs);
      take_names(described_->inputs, all.inputs);
    }
    take_beside_axis(collected(beside_, rows, columns), notes_, all);
    return all;
  }

  void take_id_lines(FrequencyResponses& all) const {
    const auto has_lines = [](const Curve& curve) { return !curve.id_lines.empty(); };
    if (std::ranges::none_of(responses_, has_lines)) return;
    all.id_lines.resize(all.outputs.size() * all.inputs.size());
    for (const Curve& curve : responses_)
      all.id_lines[curve.output * all.inputs.size() + curve.input] = curve.id_lines;
  }

  /// Names that are longer than lines of 80 characters, and roles.
  static void take_names(const std::vector<Channel>& described, std::vector<Channel>& channels) {
    for (Channel& channel : channels)
      for (const Channel& whole : described)
        if (whole.point == channel.point && whole.direction == channel.direction &&
            whole.unit == channel.unit &&
            base::trimmed(fortran_a(whole.name, 80)) == channel.name) {
          channel = whole;
          break;
        }
  }

  void require_all_pairs(const FrequencyResponses& all) const {
    for (std::size_t k = 0; k < all.lines(); ++k)
      for (Eigen::Index o = 0; o < all.H[k].rows(); ++o)
        for (Eigen::Index i = 0; i < all.H[k].cols(); ++i)
          if (!std::isfinite(std::abs(all.H[k](o, i))))
            notes_.fail(
                fmt::format("the response of {} to {} is missing at {:.6g} Hz; modes need all "
                            "pairs of outputs and inputs at all frequencies",
                            all.outputs[static_cast<std::size_t>(o)].name,
                            all.inputs[static_cast<std::size_t>(i)].name, all.frequency[k]));
  }

  Notes notes_;
  FileWindow file_;
  UffContents contents_;
  bool by_hydrapod_;
  std::optional<FrequencyResponses> described_;
  std::vector<double> frequency_{};
  std::string date_{};
  Places outputs_{by_hydrapod_}, inputs_{by_hydrapod_};
  std::set<std::pair<std::size_t, std::size_t>> taken_{};  ///< outputs and inputs
  std::vector<Curve> responses_{}, coherences_{}, variances_{}, beside_{}, noise_{},
      input_factor_{};
};

}  // namespace

ReadFrequencyResponsesResult read_uff_responses(const std::string& path) {
  return ResponseReader(path).read();
}

}  // namespace hydrapod::data
