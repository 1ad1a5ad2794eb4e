#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "channel_units.hpp"
#include "formats.hpp"
#include "hydrapod/base/text.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

namespace {

/// The last part of "group/name" or "structure.name", in small letters.
std::string short_name(const std::string& name) {
  const std::size_t at = name.find_last_of("/.");
  return base::lower_case(at == name.npos ? name : name.substr(at + 1));
}

template <std::size_t n>
bool is_one_of(const std::string& name, const std::array<std::string_view, n>& words) {
  return std::find(words.begin(), words.end(), short_name(name)) != words.end();
}

constexpr std::array<std::string_view, 6> time_words{"t",    "time", "times",
                                                     "zeit", "tout", "x_time"};
constexpr std::array<std::string_view, 9> rate_words{
    "fs",    "sample_rate", "samplerate", "sample_rate_hz",   "sampling_rate",
    "srate", "rate",        "f_s",        "samplingfrequency"};
constexpr std::array<std::string_view, 5> step_words{"dt", "ts", "t_s", "step", "increment"};
constexpr std::array<std::string_view, 6> name_words{"channel_name", "channel_names", "names",
                                                     "channels",     "labels",        "signals"};
constexpr std::array<std::string_view, 4> unit_words{"channel_unit", "channel_units", "units",
                                                     "unit"};

/// Where the samples of some channels are.
struct Source {
  std::size_t variable{};
  bool samples_are_slow{};      ///< channels side by side
  std::size_t first_channel{};  ///< of those of the record
  std::size_t channels{};
};

class VariablesReader final : public RecordReader {
 public:
  VariablesReader(const std::string& path, OpenVariableFile open, const ReadOptions& options)
      : RecordReader(path), file_(open(path, notes_)) {
    const bool own = text("format") == record_mark;
    if (own)
      read_own();
    else
      read_foreign(options);
    format_ = file_->format();
    count_ = static_cast<std::int64_t>(length_);
    settle_channels(own);
  }

 private:
  std::int64_t read_values(Eigen::Ref<Samples> block) override {
    if (std::ranges::all_of(sources_, [&](const Source& s) { return read_source(s, block); }))
      return block.rows();
    notes_.add(
        fmt::format("the samples from {} on cannot be read: the file is damaged there", done_ + 1));
    return 0;
  }

  [[nodiscard]] const std::vector<Variable>& all() const { return file_->variables(); }

  [[nodiscard]] const Variable* find(const std::string& name) const {
    const auto at =
        std::find_if(all().begin(), all().end(), [&](const Variable& v) { return v.name == name; });
    return at == all().end() ? nullptr : &*at;
  }
  [[nodiscard]] std::string text(const std::string& name) const {
    const Variable* found = find(name);
    return found != nullptr && found->kind == VariableKind::text ? found->text : "";
  }
  [[nodiscard]] double number(const std::string& name, std::optional<double> otherwise = {}) const {
    const Variable* found = find(name);
    if (found == nullptr && otherwise) return *otherwise;
    if (found == nullptr || found->kind != VariableKind::numbers ||
        found->fast * found->slow != 1 || !std::isfinite(found->number))
      notes_.fail(fmt::format("the variable '{}' is missing or is not one finite number", name));
    return found->number;
  }

  bool read_source(const Source& source, Eigen::Ref<Samples> block) {
    const auto first = static_cast<std::uint64_t>(done_);
    const auto rows = static_cast<std::uint64_t>(block.rows());
    auto columns = block.middleCols(static_cast<Eigen::Index>(source.first_channel),
                                    static_cast<Eigen::Index>(source.channels));
    if (source.samples_are_slow) {
      buffer_.resize(columns.rows(), columns.cols());
      if (!file_->read(source.variable, first, rows, 0, source.channels, buffer_.data()))
        return false;
      columns = buffer_;
      return true;
    }
    buffer_.resize(columns.rows(), 1);
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      if (!file_->read(source.variable, static_cast<std::uint64_t>(c), 1, first, rows,
                       buffer_.data()))
        return false;
      columns.col(c) = buffer_;
    }
    return true;
  }

  [[nodiscard]] std::vector<std::string> texts(const std::string& name, std::size_t count) {
    const Variable* found = find(name);
    if (found != nullptr && found->kind == VariableKind::texts && found->texts.size() == count)
      return found->texts;
    if (found != nullptr && found->kind == VariableKind::text && count == 1) return {found->text};
    notes_.add(fmt::format("the variable '{}' is missing or does not hold {} texts; it is left out",
                           name, count));
    return std::vector<std::string>(count);
  }

  void read_own() {
    if (const double version = number("format_version"); version != record_version)
      notes_.fail(fmt::format("format_version is {}; this program reads version {}", version,
                              record_version));
    header_.sample_rate = number("sample_rate_hz");
    if (!(header_.sample_rate > 0.0))
      notes_.fail(fmt::format("sample_rate_hz is {} and must be positive", header_.sample_rate));
    header_.start = number("start_s", 0.0);
    const double repeat = number("repeat", 1.0);
    if (!(repeat >= 1.0) || repeat > 1e9 || repeat != std::floor(repeat))
      notes_.fail(fmt::format("repeat is {} and must be a whole number, 1 or more", repeat));
    header_.repeat = static_cast<int>(repeat);
    header_.title = clean_text(text("title"));
    header_.date = clean_text(text("date"));
    header_.notes = clean_text(text("notes"), true);
    header_.experiment.machine = clean_text(text("machine"), true);
    settle_experiment(text("experiment"), notes_, header_);
    const Variable* samples = find("samples");
    if (samples == nullptr || samples->kind != VariableKind::numbers)
      notes_.fail("the variable 'samples' is missing or does not hold numbers");
    own_channels(samples->fast);
    length_ = samples->slow;
    sources_ = {{static_cast<std::size_t>(samples - all().data()), true, 0,
                 static_cast<std::size_t>(samples->fast)}};
  }

  void own_channels(std::uint64_t count) {
    const std::string group = find("channels/name") != nullptr ? "channels/" : "channel_";
    const Variable* names = find(group + "name");
    const std::size_t named = names == nullptr                     ? 0
                              : names->kind == VariableKind::texts ? names->texts.size()
                              : names->kind == VariableKind::text  ? 1
                                                                   : 0;
    if (named == 0 || named != count)
      notes_.fail(
          fmt::format("'samples' has {} channels for {} names in '{}name'", count, named, group));
    const auto name = texts(group + "name", named), unit = texts(group + "unit", named),
               direction = texts(group + "direction", named), role = texts(group + "role", named);
    const Variable* points = find(group + "point");
    std::vector<double> point(named, 0.0);
    if (points != nullptr && points->kind == VariableKind::numbers &&
        points->fast * points->slow == named)
      file_->read(static_cast<std::size_t>(points - all().data()), 0, points->slow, 0, points->fast,
                  point.data());
    for (std::size_t c = 0; c < named; ++c) {
      Channel channel{.name = name[c], .unit = unit[c]};
      channel.direction = known(direction_from_text(direction[c]), "direction", direction[c]);
      channel.role = role[c].empty() ? Role::other
                                     : known(role_from_text(role[c]), "role", role[c], Role::other);
      if (std::abs(point[c]) < 1e9) channel.point = static_cast<int>(point[c]);
      header_.channels.push_back(channel);
    }
  }

  template <class Word>
  Word known(const std::optional<Word>& word, const char* what, const std::string& text,
             Word otherwise = {}) {
    if (!word)
      notes_.add(fmt::format("the {} \"{}\" of a channel is unknown and left out", what,
                             base::printable(text)),
                 0, 0, what);
    return word.value_or(otherwise);
  }

  /// The length that most arrays have, that of the times if there are some.
  [[nodiscard]] std::uint64_t common_length(const Variable* times) const {
    if (times != nullptr) return std::max(times->fast, times->slow);
    std::map<std::uint64_t, std::size_t> lengths;
    for (const Variable& v : all())
      if (v.kind == VariableKind::numbers && v.fast * v.slow > 1)
        ++lengths[std::max(v.fast, v.slow)];
    std::uint64_t best = 0;
    for (const auto& [length, times_found] : lengths)
      if (best == 0 || times_found >= lengths[best]) best = length;
    return best;
  }

  void read_foreign(const ReadOptions& options) {
    const Variable* times = nullptr;
    for (const Variable& v : all())
      if (times == nullptr && v.kind == VariableKind::numbers && is_one_of(v.name, time_words) &&
          std::min(v.fast, v.slow) == 1 && std::max(v.fast, v.slow) > 1)
        times = &v;
    length_ = common_length(times);
    for (std::size_t i = 0; i < all().size(); ++i) take_variable(i, times);
    if (sources_.empty())
      notes_.fail("no array of numbers with two samples or more was found in the file");
    find_rate(times, options);
    take_texts();
  }

  void take_variable(std::size_t index, const Variable* times) {
    constexpr std::uint64_t most_channels = 10'000;
    const Variable& v = all()[index];
    if (v.kind != VariableKind::numbers || v.fast * v.slow < 2 || &v == times) return;
    const bool slow = v.slow == length_;
    const std::uint64_t channels = slow ? v.fast : v.slow;
    if ((!slow && v.fast != length_) || channels > most_channels) {
      notes_.add(
          fmt::format("variable '{}' is {} × {} and not of the record's length of {}: left out",
                      base::printable(v.name), v.fast, v.slow, length_),
          0, 0, "length");
      return;
    }
    sources_.push_back({index, slow, header_.channels.size(), static_cast<std::size_t>(channels)});
    for (std::uint64_t c = 0; c < channels; ++c)
      header_.channels.push_back(
          {.name = channels == 1 ? v.name : fmt::format("{} {}", v.name, c + 1),
           .unit = v.unit,
           .role = Role::response});
  }

  /// Names and units from lists of texts that are as long as the channels of the widest array.
  void take_texts() {
    if (sources_.empty()) return;
    const Source& widest =
        *std::max_element(sources_.begin(), sources_.end(),
                          [](const Source& a, const Source& b) { return a.channels < b.channels; });
    for (const Variable& v : all()) {
      if (v.kind != VariableKind::texts || v.texts.size() != widest.channels) continue;
      for (std::size_t c = 0; c < widest.channels; ++c) {
        Channel& channel = header_.channels[widest.first_channel + c];
        if (is_one_of(v.name, name_words)) channel.name = v.texts[c];
        if (is_one_of(v.name, unit_words)) channel.unit = v.texts[c];
      }
    }
    for (const Variable& v : all())
      if (v.kind == VariableKind::text && short_name(v.name) == "title")
        header_.title = clean_text(v.text);
  }

  void find_rate(const Variable* times, const ReadOptions& options) {
    for (const Variable& v : all()) {
      if (v.kind != VariableKind::numbers || v.fast * v.slow != 1) continue;
      const bool usable = std::isfinite(v.number) && v.number > 0.0;
      if (usable && is_one_of(v.name, rate_words)) header_.sample_rate = v.number;
      if (usable && is_one_of(v.name, step_words)) header_.sample_rate = 1.0 / v.number;
    }
    if (header_.sample_rate == 0.0 && options.sample_rate)
      header_.sample_rate = *options.sample_rate;
    if (times != nullptr) use_times(*times);
    if (header_.sample_rate > 0.0) return;
    notes_.fail(
        "the file states no sample rate: no variable such as fs, dt or time was found; give the "
        "rate in Hz with --rate");
  }

  /// Start and, if it is not known yet, the rate.
  void use_times(const Variable& times) {
    const auto index = static_cast<std::size_t>(&times - all().data());
    constexpr std::uint64_t looked_at = 1000;
    const std::uint64_t n = std::min(length_, looked_at);
    std::vector<double> t(n);
    const bool lies = times.slow == 1;
    if (!file_->read(index, 0, lies ? 1 : n, 0, lies ? n : 1, t.data()) || !std::isfinite(t[0]))
      return notes_.add("the times cannot be read");
    header_.start = t.front();
    const double span = t.back() - t.front();
    if (header_.sample_rate > 0.0 || !(span > 0.0) || !std::isfinite(span)) return;
    const double step = span / static_cast<double>(n - 1);
    for (std::uint64_t k = 0; k < n; ++k)
      if (!(std::abs(t[k] - (t[0] + static_cast<double>(k) * step)) <= 0.1 * step))
        notes_.fail(fmt::format("the times in '{}' are not evenly spaced: sample {} is at {} s",
                                base::printable(times.name), k + 1, t[k]));
    header_.sample_rate = rounded_rate(1.0 / step, 1e-7);
  }

  std::unique_ptr<VariableFile> file_;
  std::vector<Source> sources_;
  std::uint64_t length_{};  ///< samples
  Samples buffer_;
};

}  // namespace

std::unique_ptr<RecordReader> make_mat5_reader(const std::string& path,
                                               const ReadOptions& options) {
  return std::make_unique<VariablesReader>(path, open_mat5_file, options);
}

std::unique_ptr<RecordReader> make_hdf5_reader(const std::string& path,
                                               const ReadOptions& options) {
  return std::make_unique<VariablesReader>(path, open_hdf5_variables, options);
}

}  // namespace hydrapod::data
