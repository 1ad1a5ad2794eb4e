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
    if (!own && find("sample_rate_hz") != nullptr && find("format_version") != nullptr)
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
  /// one that cannot be read.
  std::int64_t read_rows(std::int64_t first, Eigen::Ref<Samples> block) {
    const auto reads = [&](std::int64_t at, std::int64_t rows) {
      return std::ranges::all_of(sources_, [&](const Source& s) {
        return read_source(s, first + at, block.middleRows(at, rows));
      });
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
      raw_rows_ = raw_.rows() > 0 ? read_rows(raw_done_, raw_) : 0;
      raw_at_ = 0;
      raw_times_.resize(static_cast<std::size_t>(raw_rows_));
      if (raw_rows_ == 0 || !read_times(static_cast<std::uint64_t>(raw_done_), raw_times_)) {
        raw_rows_ = 0;
        return false;
      }
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

  bool read_source(const Source& source, std::int64_t from, Eigen::Ref<Samples> block) {
    const auto first = static_cast<std::uint64_t>(from);
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
    settle_geometry(text(geometry_name), text(channel_texts_name), notes_, header_);
    length_ = samples->slow;
    declared_ = static_cast<std::int64_t>(std::max(samples->declared, samples->slow));
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
      if (times == nullptr && are_times(v)) times = &v;
    length_ = common_length(times);
    for (std::size_t i = 0; i < all().size(); ++i) take_variable(i, times);
    if (sources_.empty())
      notes_.fail("no array of numbers with two samples or more was found in the file");
    require_time_axes(all(), notes_);
    require_one_record(*file_, notes_);
    find_rate(times, options);
    take_texts();
    take_companions();
    if (!grid_) find_declared();
  }

  /// Of a file that was cut off, by what its arrays say.
  void find_declared() {
    std::uint64_t most = length_;
    for (const Source& source : sources_) {
      const std::uint64_t lines = all()[source.variable].declared;
      most = std::max(most, lines);
      uneven_ = uneven_ || (lines > 0 && lines < length_);  // of channels, one behind the other
    }
    declared_ = static_cast<std::int64_t>(most);
  }

  void take_variable(std::size_t index, const Variable* times) {
    constexpr std::uint64_t most_channels = 10'000;
    const Variable& v = all()[index];
    if (v.kind == VariableKind::array)
      notes_.add(fmt::format("'{}' {}: left out", base::printable(v.name),
                             v.is_complex ? std::string("is complex")
                                          : fmt::format("has {} dimensions", v.sizes.size())));
    if (v.kind != VariableKind::numbers || v.fast * v.slow < 2 || &v == times) return;
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
    if (v.is_complex)
      notes_.add(fmt::format("variable '{}' is complex; its imaginary part is left out",
                             base::printable(v.name)));
    sources_.push_back({index, slow, header_.channels.size(), static_cast<std::size_t>(channels)});
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
    if (sources_.empty()) return;
    const Source& widest =
        *std::max_element(sources_.begin(), sources_.end(),
                          [](const Source& a, const Source& b) { return a.channels < b.channels; });
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
    for (const Source& source : sources_) {
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
    for (const Source& source : sources_) samples.push_back(all()[source.variable].name);
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
    if (times != nullptr) return use_times(*times, stated);
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

  /// Start and rate, and the grid where samples are missing or times scatter.
  void use_times(const Variable& times, const std::optional<StatedRate>& stated) {
    times_ = static_cast<std::size_t>(&times - all().data());
    const auto seconds = seconds_of(times.unit);
    time_factor_ = seconds.value_or(1.0);
    bool single = true;  // times of single precision have seven digits
    std::vector<double> block;
    const TimeSource source{
        [&](const TimeSource::Use& use) {
          constexpr std::uint64_t most = 4096;
          for (std::uint64_t at = 0; at < length_; at += most) {
            block.resize(std::min(most, length_ - at));
            if (!read_times(at, block)) return;
            for (const double time : block) {
              single = single &&
                       (std::isnan(time) || static_cast<double>(static_cast<float>(time)) == time);
              use(time, 0);
            }
          }
        },
        [&single](double time) {
          constexpr double digits = 1.2e-7;
          return single ? digits * std::abs(time) : 0.0;
        }};
    TimeGrid grid = find_time_grid(source, stated, notes_);
    header_.sample_rate = grid.rate;
    header_.start = grid.start;
    if (!seconds && time_origin_ == 0.0)  // those of a calendar are known by their size
      notes_.add(fmt::format("the unit \"{}\" of the times '{}' is unknown: taken for s",
                             base::printable(times.unit, 30), base::printable(times.name)));
    if (times.unit.empty() && time_origin_ == 0.0)
      note_assumed_unit(times_taken_for_seconds, grid.rate, length_, state_the_unit("s"), notes_);
    if (grid.complete) return;
    if (grid.resolution)
      grid.resolution = [digits = single ? 1.2e-7 : 0.0](double t) { return digits * std::abs(t); };
    grid_.emplace(grid, static_cast<Eigen::Index>(header_.channels.size()));
  }

  /// Times from `first` on, in seconds; those of a calendar since the first one.
  bool read_times(std::uint64_t first, std::vector<double>& out) {
    if (!read_list(*file_, times_, first, out)) {
      notes_.add("the times cannot be read");
      return false;
    }
    if (first == 0 && !out.empty() && std::isfinite(out[0])) {
      constexpr double years = 1e8;  // [s]
      time_origin_ = std::abs(out[0]) * time_factor_ > years ? out[0] : 0.0;
    }
    for (double& time : out) {
      time = (time - time_origin_) * time_factor_;
      if (!std::isfinite(time)) time = std::numeric_limits<double>::quiet_NaN();
    }
    return true;
  }

  std::unique_ptr<VariableFile> file_;
  std::vector<Source> sources_;
  std::uint64_t length_{};  ///< samples
  Samples buffer_;
  std::size_t times_{};  ///< variable of the times
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
