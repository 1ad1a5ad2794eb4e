#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "axis_units.hpp"
#include "channel_roles.hpp"
#include "channel_units.hpp"
#include "formats.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "response_files.hpp"
#include "sample_sources.hpp"
#include "time_column.hpp"
#include "time_grid.hpp"
#include "variable_file.hpp"
#include "variables_beside.hpp"

namespace hydrapod::data {

namespace {

constexpr std::array<std::string_view, 6> name_words{"channel_name", "channel_names", "names",
                                                     "channels",     "labels",        "signals"};
constexpr std::array<std::string_view, 1> title_words{"title"};
constexpr std::array<std::string_view, 4> unit_words{"channel_unit", "channel_units", "units",
                                                     "unit"};
constexpr const char* unreadable_times = "the times cannot be read";

class VariablesReader final : public RecordReader {
 public:
  VariablesReader(const std::string& path, OpenVariableFile open, const ReadOptions& options)
      : RecordReader(path), file_(open(path, notes_)) {
    const bool own = text("format") == record_mark;
    if (const char* other = own ? nullptr : what_else(*file_)) notes_.fail(other);
    if (own)
      read_own();
    else
      read_foreign(options);
    format_ = file_->format();
    if (!grid_) count_ = static_cast<std::int64_t>(length_);
    settle_channels(own);
    if (own) {
      stated_checksum_ = text(checksum_name);
      if (stated_checksum_.empty()) notes_.add(absent_checksum);
      if (stated_checksum_ == no_checksum_yet) note_unfinished();
      begin_checksum();
    }
    if (!own) guess_roles(header_.channels, notes_);
    const auto has_all = [this](std::initializer_list<const char*> names) {
      return std::ranges::all_of(names, [this](const char* name) { return find(name) != nullptr; });
    };
    if (!own && (has_all({"sample_rate_hz", "format_version"}) ||
                 has_all({"samples", "channels/name", "channels/role", "channels/point"})))
      notes_.add(damaged_mark);
  }

 private:
  std::int64_t read_values(Eigen::Ref<Samples> block) override {
    if (!grid_) return read_rows(done_, block);
    std::int64_t rows = 0;
    Eigen::RowVectorXd values(block.cols());
    for (; rows < block.rows() && grid_->next(fetch_, values); ++rows) block.row(rows) = values;
    return rows;
  }

  /// Samples as they stand in the file, from `first` on: how many, which are all up to the first
  /// one that cannot be read. `times`: gets those of a channel of times, if it is not empty.
  std::int64_t read_rows(std::int64_t first, Eigen::Ref<Samples> block,
                         std::span<double> times = {}) {
    const auto reads = [&](std::int64_t at, std::int64_t rows) {
      const auto n = static_cast<std::size_t>(rows), from = static_cast<std::size_t>(at);
      return sources_.read(static_cast<std::uint64_t>(first + at), block.middleRows(at, rows),
                           times.empty() ? times : times.subspan(from, n));
    };
    const std::int64_t rows = block.rows();
    if (reads(0, rows)) return rows;
    std::int64_t good = 0;
    for (auto n = std::bit_floor(static_cast<std::uint64_t>(rows)); n > 0; n /= 2)
      if (const auto more = static_cast<std::int64_t>(n); good + more <= rows && reads(good, more))
        good += more;
    if (good == 0)
      notes_.add(fmt::format("the samples from {} on cannot be read: the file is damaged there",
                             first + 1));
    return good;
  }

  void to_first_sample() override {
    if (!grid_) return;
    grid_->rewind();
    raw_rows_ = raw_at_ = raw_done_ = 0;
  }

  /// The next sample as it stands in the file, with its time.
  bool next_raw(double& time, Eigen::RowVectorXd& row) {
    if (raw_at_ == raw_rows_) {
      constexpr std::int64_t most = 1024;
      const std::int64_t left = static_cast<std::int64_t>(length_) - raw_done_;
      raw_.resize(std::clamp<std::int64_t>(left, 0, most), row.cols());
      raw_times_.resize(times_ ? 0 : static_cast<std::size_t>(raw_.rows()));
      raw_rows_ = raw_.rows() > 0 ? read_rows(raw_done_, raw_, raw_times_) : 0;
      raw_at_ = 0;
      raw_times_.resize(static_cast<std::size_t>(raw_rows_));
      const auto from = static_cast<std::uint64_t>(raw_done_);
      if (raw_rows_ == 0 || (times_ && !read_list(*file_, *times_, from, raw_times_))) {
        if (raw_rows_ > 0) notes_.add(unreadable_times);
        raw_rows_ = 0;
        return false;
      }
      to_seconds(from, raw_times_);
      raw_done_ += raw_rows_;
    }
    time = raw_times_[static_cast<std::size_t>(raw_at_)];
    row = raw_.row(raw_at_++);
    return true;
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
    settle_geometry(text(geometry_name), text(channel_texts_name), notes_, header_);
    length_ = samples->slow;
    declared_ = static_cast<std::int64_t>(std::max(samples->declared, samples->slow));
    sources_.add(static_cast<std::size_t>(samples - all().data()), true,
                 static_cast<std::size_t>(samples->fast));
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

  static bool holds_several(const Variable& v) {
    return std::ranges::any_of(v.sizes, [](std::uint64_t size) { return size > 1; });
  }
  static bool may_be_samples(const Variable& v) {
    return v.kind == VariableKind::numbers && !v.is_complex && v.fast * v.slow > 1;
  }

  /// The length that most arrays have, that of the times if there are some.
  [[nodiscard]] std::uint64_t common_length(const Variable* times) const {
    if (times != nullptr) return std::max(times->fast, times->slow);
    std::map<std::uint64_t, std::size_t> lengths;
    for (const Variable& v : all())
      if (may_be_samples(v)) ++lengths[std::max(v.fast, v.slow)];
    std::uint64_t best = 0;
    for (const auto& [length, times_found] : lengths)
      if (best == 0 || times_found >= lengths[best]) best = length;
    return best;
  }

  void read_foreign(const ReadOptions& options) {
    const Variable* times = nullptr;
    for (const Variable& v : all())
      if (times == nullptr && are_times(v)) times = &v;
    length_ = common_length(times);
    for (std::size_t i = 0; i < all().size(); ++i) take_variable(i, times);
    if (sources_.all().empty())
      notes_.fail("no array of numbers with two samples or more was found in the file");
    require_time_axes(all(), notes_);
    require_one_record(*file_, notes_);
    take_texts();
    take_companions();
    find_rate(times, options);
    if (!grid_) find_declared();
  }

  /// Of a file that was cut off, by what its arrays say.
  void find_declared() {
    std::uint64_t most = length_;
    for (const Source& source : sources_.all()) {
      const std::uint64_t lines = all()[source.variable].declared;
      most = std::max(most, lines);
      uneven_ = uneven_ || (lines > 0 && lines < length_);  // of channels, one behind the other
    }
    declared_ = static_cast<std::int64_t>(most);
  }

  void take_variable(std::size_t index, const Variable* times) {
    constexpr std::uint64_t most_channels = 10'000;
    const Variable& v = all()[index];
    if (v.is_complex && holds_several(v))
      notes_.add(fmt::format("'{}' {}: left out", base::printable(v.name), complex_words));
    else if (v.kind == VariableKind::array && !v.is_complex)
      notes_.add(
          fmt::format("'{}' has {} dimensions: left out", base::printable(v.name), v.sizes.size()));
    if (!may_be_samples(v) || &v == times) return;
    const bool slow = v.slow == length_;
    const std::uint64_t channels = slow ? v.fast : v.slow;
    if ((!slow && v.fast != length_) || channels > most_channels) {
      notes_.add(
          fmt::format("variable '{}' is {} × {} and not of the record's length of {}: left out",
                      base::printable(v.name), v.fast, v.slow, length_),
          0, 0, "length");
      uneven_ = uneven_ || v.declared > 0;
      return;
    }
    sources_.add(index, slow, static_cast<std::size_t>(channels));
    const bool fit = v.texts.size() == channels, units = fit && (v.unit.empty() || channels > 1);
    if (fit && !v.unit.empty())
      if (const auto other = std::ranges::find_if(v.texts, [&](auto& t) { return t != v.unit; });
          other != v.texts.end())
        notes_.add(
            fmt::format("variable '{}' has the unit \"{}\" by its attribute 'unit' and \"{}\" by "
                        "'units': {} used",
                        base::printable(v.name), base::printable(v.unit, 30),
                        base::printable(*other, 30), units ? "'units' is" : "'unit' is"));
    if (!fit && v.texts.size() > 1)
      notes_.add(fmt::format("variable '{}' has {} units for {} channel{}: not used",
                             base::printable(v.name), v.texts.size(), channels,
                             channels == 1 ? "" : "s"));
    for (std::uint64_t c = 0; c < channels; ++c)
      header_.channels.push_back(
          {.name = channels == 1 ? v.name : fmt::format("{} {}", v.name, c + 1),
           .unit = units ? v.texts[c] : v.unit,
           .role = Role::response});
  }

  /// Names and units from lists of texts that are as long as the channels of the widest array.
  void take_texts() {
    if (sources_.all().empty()) return;
    const Source& widest = *std::ranges::max_element(sources_.all(), {}, &Source::channels);
    for (const Variable& v : all()) {
      if (v.kind != VariableKind::texts) continue;
      if (v.texts.size() != widest.channels) {
        if (is_one_of(name_words, v.name) || is_one_of(unit_words, v.name))
          notes_.add(
              fmt::format("the variable '{}' has {} texts, and '{}' has {} channels: not used",
                          base::printable(v.name), v.texts.size(),
                          base::printable(all()[widest.variable].name), widest.channels));
        continue;
      }
      for (std::size_t c = 0; c < widest.channels; ++c) {
        Channel& channel = header_.channels[widest.first_channel + c];
        if (is_one_of(name_words, v.name)) channel.name = v.texts[c];
        if (is_one_of(unit_words, v.name)) channel.unit = v.texts[c];
      }
    }
    for (const Variable& v : all())
      if (v.kind == VariableKind::text && is_one_of(title_words, v.name))
        header_.title = clean_text(v.text);
  }

  /// Names and units that stand beside the samples of a source.
  void take_companions() {
    for (const Source& source : sources_.all()) {
      const auto [names, units] = texts_beside(all(), all()[source.variable].name, source.channels);
      const bool one_name = names.size() > 1 && std::ranges::count(names, names[0]) ==
                                                    static_cast<std::ptrdiff_t>(names.size());
      for (std::size_t c = 0; c < source.channels; ++c) {
        Channel& channel = header_.channels[source.first_channel + c];
        if (!names.empty())
          channel.name = one_name ? fmt::format("{} {}", names[c], c + 1) : names[c];
        if (!units.empty()) channel.unit = units[c];
        if (!channel.unit.empty() || !channel.name.ends_with(']')) continue;
        const base::TableTitle title = base::table_title({channel.name, 0});  // "force [N]"
        channel.name = title.name;
        channel.unit = title.unit;
      }
    }
  }

  void find_rate(const Variable* times, const ReadOptions& options) {
    std::vector<std::string> samples;
    for (const Source& source : sources_.all()) samples.push_back(all()[source.variable].name);
    const auto found =
        rates_beside(all(), samples, times == nullptr && !options.sample_rate, notes_);
    std::optional<StatedRate> stated;
    if (!found.empty())
      stated = {found[0].hertz, fmt::format("the variable '{}'", base::printable(found[0].name))};
    constexpr double same = 1e-6;
    for (const RateVariable& rate : found) {
      if (std::abs(rate.hertz - stated->rate) <= same * stated->rate || options.sample_rate)
        continue;
      notes_.fail(fmt::format(
          "the file states several sample rates: {:.9g} Hz by '{}' and {:.9g} "
          "Hz by '{}'; give the one that holds with --rate",
          found[0].hertz, base::printable(found[0].name), rate.hertz, base::printable(rate.name)));
    }
    const bool one = !found.empty() && std::ranges::all_of(found, [&](const RateVariable& rate) {
      return std::abs(rate.hertz - found[0].hertz) <= same * found[0].hertz;
    });
    const auto agrees = [&](const RateVariable& rate) {
      return std::abs(rate.hertz - *options.sample_rate) <= 1e-3 * rate.hertz;
    };
    if (!found.empty()) rate_key_ = found[0].name;
    if (options.sample_rate && !one && (found.empty() || std::ranges::any_of(found, agrees)))
      stated = {*options.sample_rate, fmt::format("--rate {}", *options.sample_rate)};
    for (const Variable& v : all())
      if (v.kind == VariableKind::numbers && v.fast * v.slow == 1 && std::isfinite(v.number) &&
          is_start_name(v.name))
        header_.start = v.number * seconds_of(v.unit).value_or(1.0);
    if (stated) header_.sample_rate = stated->rate;
    if (times != nullptr) {
      times_ = static_cast<std::size_t>(times - all().data());
      return use_times({times->name, times->unit, seconds_of(times->unit)}, stated);
    }
    if (const auto channel = found.empty() ? take_time_channel() : std::nullopt)
      return use_times(*channel, stated);
    if (!found.empty() && !options.sample_rate && !found[0].has_unit)
      note_assumed_unit(
          fmt::format("'{}' has no unit and is taken for {}", base::printable(found[0].name),
                      found[0].is_step ? "seconds" : "Hz"),
          found[0].hertz, length_, state_the_unit(found[0].is_step ? "s" : "Hz"), notes_);
    if (header_.sample_rate > 0.0) return;
    notes_.fail(
        "the file states no sample rate: no variable such as fs, dt or time was found; give the "
        "rate in Hz with --rate");
  }

  /// What is said of the times, and the factor of their unit if it is known.
  struct Times {
    std::string name{}, unit{};
    std::optional<double> seconds{};
  };

  /// The first channel with a name of times, as in a table of text: it leaves the record.
  std::optional<Times> take_time_channel() {
    auto& channels = header_.channels;
    for (auto at = channels.begin(); channels.size() > 1 && at != channels.end(); ++at)
      if (const auto found = named_time(at->unit.empty() ? base::table_title({at->name, 0})
                                                         : base::TableTitle{at->name, at->unit})) {
        const Times times{at->name, found->has_unit ? "s" : "", found->factor};
        sources_.set_times(static_cast<std::size_t>(at - channels.begin()));
        channels.erase(at);
        return times;
      }
    return {};
  }

  /// Start and rate, and the grid where samples are missing or times scatter.
  void use_times(const Times& times, const std::optional<StatedRate>& stated) {
    time_factor_ = times.seconds.value_or(1.0);
    BinaryTimes binary;
    std::vector<double> block;
    const TimeSource source{[&](const TimeSource::Use& use) {
                              constexpr std::uint64_t most = 4096;
                              for (std::uint64_t at = 0; at < length_; at += most) {
                                block.resize(std::min(most, length_ - at));
                                if (!read_times(at, block)) return;
                                for (const double time : block) {
                                  binary.take(time);
                                  use(time, 0);
                                }
                              }
                            },
                            [&binary](double time) { return binary.resolution(time); }};
    TimeGrid grid = find_time_grid(source, stated, notes_);
    header_.sample_rate = grid.rate;
    header_.start = grid.start;
    if (!times.seconds && time_origin_ == 0.0)  // those of a calendar are known by their size
      notes_.add(fmt::format("the unit \"{}\" of the times '{}' is unknown: taken for s",
                             base::printable(times.unit, 30), base::printable(times.name)));
    if (times.unit.empty() && time_origin_ == 0.0)
      note_assumed_unit(times_taken_for_seconds, grid.rate, length_, state_the_unit("s"), notes_);
    if (grid.complete) return;
    if (grid.resolution)
      grid.resolution = [binary](double time) { return binary.resolution(time); };
    grid_.emplace(grid, static_cast<Eigen::Index>(header_.channels.size()));
  }

  /// Times from `first` on, in seconds; those of a calendar since the first one.
  bool read_times(std::uint64_t first, std::vector<double>& out) {
    if (!(times_ ? read_list(*file_, *times_, first, out) : sources_.read_times(first, out))) {
      notes_.add(unreadable_times);
      return false;
    }
    to_seconds(first, out);
    return true;
  }

  void to_seconds(std::uint64_t first, std::vector<double>& out) {
    if (first == 0 && !out.empty() && std::isfinite(out[0])) {
      constexpr double years = 1e8;  // [s]
      time_origin_ = std::abs(out[0]) * time_factor_ > years ? out[0] : 0.0;
    }
    for (double& time : out) {
      time = (time - time_origin_) * time_factor_;
      if (!std::isfinite(time)) time = std::numeric_limits<double>::quiet_NaN();
    }
  }

  std::unique_ptr<VariableFile> file_;
  SampleSources sources_{*file_};
  std::uint64_t length_{};              ///< samples
  std::optional<std::size_t> times_{};  ///< variable of the times; none: a channel, if there are
  double time_factor_{1.0}, time_origin_{};
  std::optional<GridRows> grid_{};  ///< where the times have gaps or scatter
  // what next_raw() has read ahead
  Samples raw_;
  std::vector<double> raw_times_;
  std::int64_t raw_rows_{}, raw_at_{}, raw_done_{};
  GridRows::Fetch fetch_{
      [this](double& time, Eigen::RowVectorXd& row) { return next_raw(time, row); }};
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

std::unique_ptr<RecordReader> make_hdf5_remains_reader(const std::string& path) {
  return std::make_unique<VariablesReader>(path, open_hdf5_remains, ReadOptions{});
}

}  // namespace hydrapod::data
