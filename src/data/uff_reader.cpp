#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats.hpp"
#include "hydrapod/base/text.hpp"
#include "uff_dataset.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

constexpr double rate_tolerance = 2e-5;          ///< increments are written with six digits
constexpr const char* of_repeat = " of repeat";  ///< behind the role, in what hydrapod writes
constexpr const char* lost_own_header =
    "hydrapod wrote the file, but its dataset 99001 (header of the record) is not there or cannot "
    "be read: the file is damaged, or another program changed it; no checksum is compared";

class UffReader final : public RecordReader {
 public:
  explicit UffReader(const std::string& path)
      : RecordReader(path), file_(path), contents_(scan_uff(path, notes_)) {
    choose();
    make_header();
    const std::uint64_t most = std::ranges::max(chosen_, {}, &UffFunction::count).count;
    for (std::size_t c = 0; c < chosen_.size(); ++c) {
      uneven_ = uneven_ || chosen_[c].count < most;
      if (chosen_[c].count < most)
        notes_.add(
            fmt::format("channel \"{}\" has {} of {} samples; absent ones are taken as missing",
                        base::printable(header_.channels[c].name), chosen_[c].count, most),
            chosen_[c].line);
    }
    count_ = static_cast<std::int64_t>(most);
    declared_ =
        static_cast<std::int64_t>(std::ranges::max(chosen_, {}, &UffFunction::declared).declared);
    format_ = chosen_.front().binary ? RecordFormat::uff : RecordFormat::uff_ascii;
    to_first_sample();
  }

 private:
  std::int64_t read_values(Eigen::Ref<Samples> block) override {
    for (std::size_t c = 0; c < values_.size(); ++c)
      for (Eigen::Index row = 0; row < block.rows(); ++row)
        block(row, static_cast<Eigen::Index>(c)) =
            sample(c, static_cast<std::uint64_t>(done_ + row));
    return block.rows();
  }

  void to_first_sample() override {
    const std::size_t window = std::clamp<std::size_t>((32U << 20U) / chosen_.size(), 8192, 65536);
    values_.clear();
    for (const UffFunction& f : chosen_)
      values_.push_back(std::make_unique<UffValues>(file_, f, window));
  }

  double sample(std::size_t channel, std::uint64_t index) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (index >= chosen_[channel].count) return value;
    if (!chosen_[channel].is_even) values_[channel]->next(value, notes_);  // its time
    values_[channel]->next(value, notes_);
    return value;
  }

  /// Functions over time that share the first one's sampling.
  void choose() {
    std::size_t others = 0;
    for (UffFunction& f : contents_.functions) {
      const bool time =
          f.type == uff_function::time_response ||
          (f.type == uff_function::general && f.abscissa.quantity == uff_quantity::time);
      if (!time || f.is_complex) {
        ++others;
        continue;
      }
      if (!f.is_even && !make_even(f)) continue;
      const double factor = uff_seconds(f, notes_);
      f.first *= factor;
      f.step *= factor;
      if (chosen_.empty() || same_sampling(f)) chosen_.push_back(f);
    }
    if (others > 0)
      notes_.add(
          fmt::format("{} function{} over time (spectra, frequency responses, …) left out of "
                      "the record",
                      others, others == 1 ? " that is none" : "s that are none"));
    if (!contents_.modes.empty())
      notes_.add(fmt::format("modes (datasets 55 and 2414, {} times) left out of the record",
                             contents_.modes.size()));
    if (chosen_.empty())
      notes_.fail("the Universal File holds no function over time that can be read");
  }

  bool same_sampling(const UffFunction& f) {
    const UffFunction& first = chosen_.front();
    const bool same_rate = std::abs(f.step - first.step) <= rate_tolerance * first.step;
    const bool same_start =
        std::abs(f.first - first.first) <= 0.01 * first.step + 1e-5 * std::abs(first.first);
    if (same_rate && same_start) return true;
    notes_.add(
        fmt::format("dataset {} is sampled every {} s from {} s, unlike the first one (every "
                    "{} s from {} s): left out",
                    f.dataset, f.step, f.first, first.step, first.first),
        f.line);
    return false;
  }

  /// Times that are even though the file says they need not be give start and step.
  bool make_even(UffFunction& f) {
    UffValues values(file_, f);
    Notes ignored(notes_.file());
    double first = 0.0, last = 0.0, time = 0.0, value = 0.0;
    std::uint64_t n = 0;
    for (; n < f.count && values.next(time, ignored) && values.next(value, ignored); ++n) {
      if (n == 0) first = time;
      last = time;
    }
    const double step = n > 1 ? (last - first) / static_cast<double>(n - 1) : 0.0;
    bool even = step > 0.0 && std::isfinite(step);
    UffValues again(file_, f);
    for (std::uint64_t k = 0; even && k < n; ++k) {
      again.next(time, ignored);
      again.next(value, ignored);
      even = is_time_of_sample(time, first, step, k);
    }
    if (!even) {
      notes_.add(fmt::format("dataset {} is not evenly sampled: left out", f.dataset), f.line);
      return false;
    }
    f.first = first;
    f.step = step;
    return true;
  }

  void make_header() {
    const UffFunction& first = chosen_.front();
    header_.sample_rate = rounded_rate(1.0 / first.step, rate_tolerance);
    rate_key_ = "abscissa increment";
    header_.start = first.first;
    header_.title = given(contents_.model_name);
    header_.date = date_of(first);
    header_.geometry = contents_.geometry;
    header_.repeat = static_cast<int>(std::clamp(first.version, 1LL, 99999LL));
    for (const UffFunction& f : chosen_) header_.channels.push_back(channel_of(f));
    if (contents_.own.by_hydrapod(notes_) && use_own_header()) {
      settle_channels(true);
      stated_checksum_ = contents_.own.text_of(checksum_name);
      if (chosen_.front().binary && stated_checksum_.empty()) notes_.add(absent_checksum);
      return begin_checksum();
    }
    if (!contents_.own.text_of("sample_rate_hz").empty() && !contents_.own.by_hydrapod(notes_))
      notes_.add(damaged_mark);
    else if (hydrapod_wrote() && !contents_.own.by_hydrapod(notes_))
      notes_.add(lost_own_header);
    header_.notes = origin_notes();
    name_by_place(header_.channels);
    make_names_unique(header_.channels);
    for (std::size_t c = 0; c < chosen_.size(); ++c) {
      const UffFunction& f = chosen_[c];
      const auto unit = uff_unit(f.ordinate, f.response.direction, f.units, notes_);
      factors_.push_back(use_unit(header_.channels[c], unit, "", notes_));
    }
  }

  /// What hydrapod wrote about the record, if the functions are still those it wrote.
  bool use_own_header() {
    RecordHeader own = contents_.own.header(notes_);
    const std::size_t described = own.channels.size();
    bool same =
        described >= chosen_.size() && own.sample_rate > 0.0 &&
        std::abs(own.sample_rate - header_.sample_rate) <= rate_tolerance * header_.sample_rate;
    for (std::size_t c = 0; same && c < chosen_.size(); ++c)
      same = chosen_[c].response.node == own.channels[c].point &&
             (described == chosen_.size() || chosen_[c].number == static_cast<long long>(c + 1));
    if (same && described > chosen_.size()) {  // the file is cut off
      uneven_ = true;
      notes_.add(
          fmt::format("only the first {} of its {} channels are there", chosen_.size(), described));
      own.channels.resize(chosen_.size());
    }
    if (same)
      header_ = std::move(own);
    else
      notes_.add(
          "the functions are not those that the header of hydrapod in the file describes: the file "
          "is "
          "damaged, or another program changed it; the header is left aside, and no checksum is "
          "compared");
    return same;
  }

  /// By what stands outside of its own dataset: dataset 151, or the fourth line of a function.
  [[nodiscard]] bool hydrapod_wrote() const {
    return contents_.program.starts_with("hydrapod ") ||
           std::ranges::any_of(chosen_, [](const UffFunction& f) {
             const std::size_t at = f.id[3].find(of_repeat);
             return at != std::string::npos && role_from_text(f.id[3].substr(0, at));
           });
  }

  /// That of the function, if its line is one, else that of the file.
  [[nodiscard]] std::string date_of(const UffFunction& f) const {
    const std::string own = given(f.id[2]), date = iso_date(own);
    return date != own || contents_.date.empty() || contents_.own.by_hydrapod(notes_)
               ? date
               : iso_date(given(contents_.date));
  }

  /// What dataset 151 says besides the title.
  [[nodiscard]] std::string origin_notes() const {
    std::string text;
    if (const std::string description = given(contents_.description); !description.empty())
      text += description + '\n';
    if (const std::string program = given(contents_.program); !program.empty())
      text += "program: " + program + '\n';
    return text;
  }

  static Channel channel_of(const UffFunction& f) {
    Channel channel;
    channel.name = given(f.ordinate.label).empty() ? f.id[0] : f.ordinate.label;
    if (channel.name.size() < f.id[0].size() && f.id[0].starts_with(channel.name))
      channel.name = f.id[0];  // the label has 20 characters only
    channel.direction = uff_direction(f.response);
    channel.point = uff_point(f.response);
    channel.entity = uff_entity(f.response);
    channel.id_lines = uff_id_lines(f.id);
    channel.role = Role::response;
    if (f.ordinate.quantity == uff_quantity::excitation_force) channel.role = Role::excitation;
    const std::string word = f.id[3].substr(0, f.id[3].find(of_repeat));
    if (const auto role = role_from_text(word)) channel.role = *role;
    return channel;
  }

  FileWindow file_;
  UffContents contents_;
  std::vector<UffFunction> chosen_;
  std::vector<std::unique_ptr<UffValues>> values_;
};

}  // namespace

std::unique_ptr<RecordReader> make_uff_reader(const std::string& path) {
  return std::make_unique<UffReader>(path);
}

}  // namespace hydrapod::data
