/// RPC III files, read as docs/rpc-iii.md describes them, without believing any size that they
/// declare.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "channel_units.hpp"
#include "file_window.hpp"
#include "formats.hpp"
#include "hydrapod/base/text.hpp"
#include "record_comments.hpp"
#include "rpc_layout.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

constexpr std::uint64_t most_header_blocks = 65'536;  // 32 MiB
constexpr std::int64_t most_points = std::int64_t{1} << 48U;

/// Text up to the zero, without blanks around.
std::string rpc_text(std::string_view field) {
  return std::string(base::trimmed(field.substr(0, field.find('\0'))));
}

/// Keys and values of a header, and what is wrong with them.
class RpcHeader {
 public:
  RpcHeader(FileWindow& file, Notes& notes) : notes_(&notes) {
    read_first_three(file);
    for (std::uint64_t k = 3; k < records_; ++k) take(file, k);
  }

  [[nodiscard]] std::uint64_t bytes() const { return blocks_ * rpc_block_bytes; }

  [[nodiscard]] std::optional<std::string> find(const std::string& key) const {
    const auto at = values_.find(key);
    return at == values_.end() ? std::nullopt : std::optional(at->second.text);
  }
  /// Without the quotation marks that enclose texts of several words.
  [[nodiscard]] std::string text(const std::string& key) const {
    std::string text = find(key).value_or("");
    if (text.size() > 1 && text.front() == '"' && text.back() == '"')
      text = text.substr(1, text.size() - 2);
    return clean_text(text);
  }
  [[nodiscard]] std::int64_t whole(const std::string& key, std::int64_t lowest,
                                   std::int64_t highest,
                                   std::optional<std::int64_t> otherwise = {}) const {
    const auto text = value(key, otherwise.has_value());
    if (!text) return *otherwise;
    std::int64_t number = 0;
    const auto [end, status] = std::from_chars(text->data(), text->data() + text->size(), number);
    if (status == std::errc{} && end == text->data() + text->size() && number >= lowest &&
        number <= highest)
      return number;
    refuse(key, *text, fmt::format("expected is a whole number from {} to {}", lowest, highest));
  }
  [[nodiscard]] double number(const std::string& key) const {
    const auto text = value(key, false);
    const auto number = fortran_number(*text);
    if (!number || !std::isfinite(*number)) refuse(key, *text, "expected is a finite number");
    return *number;
  }
  /// Which of `words` stands behind `key`; the first where the key is missing.
  std::size_t word(const std::string& key, const std::vector<std::string_view>& words) const {
    const auto text = find(key);
    if (!text) return 0;
    const auto at = std::ranges::find(words, std::string_view(*text));
    if (at == words.end()) refuse(key, *text, fmt::format("read are {}", fmt::join(words, ", ")));
    return static_cast<std::size_t>(at - words.begin());
  }
  [[noreturn]] void refuse(const std::string& key, const std::string& text,
                           const std::string& expected) const {
    const auto at = values_.find(key);
    notes_->fail(fmt::format(
        "{} = \"{}\"{}: {}", key, base::printable(text),
        at == values_.end() ? "" : fmt::format(" (byte {})", at->second.place + rpc_key_bytes),
        expected));
  }

  /// What hydrapod wrote behind keys of its own; byte by byte as it stands.
  [[nodiscard]] std::string own_text() const {
    std::string all;
    for (int k = 1;; ++k) {
      const auto at = values_.find(fmt::format("{}{}", rpc_own_key, k));
      if (at == values_.end()) return all;
      all += at->second.whole;
    }
  }

 private:
  struct Value {
    std::string text{};     ///< without blanks around
    std::string whole{};    ///< up to its zero
    std::uint64_t place{};  ///< of its record in the file
  };

  [[nodiscard]] std::optional<std::string> value(const std::string& key, bool may_miss) const {
    auto found = find(key);
    if (!found && !may_miss)
      notes_->fail(
          fmt::format("the header has no key {}, without which the samples cannot be "
                      "read",
                      key));
    return found;
  }

  void read_first_three(FileWindow& file) {
    for (std::uint64_t k = 0; k < 3; ++k) take(file, k);
    for (const auto& [key, place] :
         {std::pair{"FORMAT", 0U}, {"NUM_HEADER_BLOCKS", 1U}, {"NUM_PARAMS", 2U}}) {
      const auto at = values_.find(key);
      if (at == values_.end() || at->second.place != place * rpc_record_bytes)
        notes_->fail(fmt::format("key {} of the header (byte {}) must be {}", place + 1,
                                 place * rpc_record_bytes, key));
    }
    blocks_ = static_cast<std::uint64_t>(whole("NUM_HEADER_BLOCKS", 1, most_header_blocks));
    if (bytes() > file.size())
      notes_->fail(
          fmt::format("the file is cut off within its header: NUM_HEADER_BLOCKS = {} are "
                      "{} bytes, the file has {}",
                      blocks_, bytes(), file.size()));
    const std::uint64_t room = blocks_ * rpc_records_per_block;
    records_ = static_cast<std::uint64_t>(whole("NUM_PARAMS", 3, most_points));
    if (records_ > room) {
      notes_->add(
          fmt::format("NUM_PARAMS = {}, but the header has room for {} keys", records_, room));
      records_ = room;
    }
  }

  void take(FileWindow& file, std::uint64_t record) {
    const std::uint64_t place = record * rpc_record_bytes;
    const std::string_view bytes = file.at(place, rpc_record_bytes);
    if (bytes.size() < rpc_record_bytes)
      notes_->fail(fmt::format("the file is cut off within its header, at byte {}", file.size()));
    const std::string key = rpc_text(bytes.substr(0, rpc_key_bytes));
    if (key.empty()) return;
    std::string_view field = bytes.substr(rpc_key_bytes, rpc_value_bytes);
    field = field.substr(0, field.find('\0'));
    if (!values_.emplace(key, Value{rpc_text(field), std::string(field), place}).second)
      notes_->add(fmt::format("the key {} stands again at byte {}; the first one holds",
                              base::printable(key), place),
                  0, 0, "twice");
  }

  Notes* notes_;
  std::map<std::string, Value> values_;
  std::uint64_t blocks_{}, records_{};
};

enum class RpcNumber { short_integer, floating_point, double_precision };

class RpcReader final : public RecordReader {
 public:
  explicit RpcReader(const std::string& path) : RecordReader(path), file_(path) {
    const RpcHeader header(file_, notes_);
    read_kind(header);
    read_layout(header);
    read_channels(header);
    find_end(header);
  }

 private:
  void read_kind(const RpcHeader& header) {
    const auto format =
        header.word("FORMAT", {"BINARY_IEEE_LITTLE_END", "BINARY_IEEE_BIG_END", "BINARY"});
    big_endian_ = format == 1;
    header.word("FILE_TYPE", {"TIME_HISTORY"});
    drive_ = header.word("TIME_TYPE", {"RESPONSE", "DRIVE", "2", "1"}) % 2 == 1;
    number_ = static_cast<RpcNumber>(
        header.word("DATA_TYPE", {"SHORT_INTEGER", "FLOATING_POINT", "DOUBLE_PRECISION"}));
    size_ = number_ == RpcNumber::short_integer ? 2 : number_ == RpcNumber::floating_point ? 4 : 8;
    format_ = number_ == RpcNumber::short_integer ? RecordFormat::rpc_short : RecordFormat::rpc;
    full_scale_ = static_cast<double>(header.whole("INT_FULL_SCALE", 1, 32768, rpc_full_scale));
  }

  void read_layout(const RpcHeader& header) {
    channels_ = header.whole("CHANNELS", 1, 10'000);
    const std::int64_t frame = header.whole("PTS_PER_FRAME", 1, 1U << 30U);
    group_ = header.whole("PTS_PER_GROUP", 1, 1U << 30U);
    if (group_ % frame != 0)
      header.refuse("PTS_PER_GROUP", fmt::format("{}", group_),
                    fmt::format("expected is a multiple of PTS_PER_FRAME = {}", frame));
    const double step = header.number("DELTA_T");
    if (!(step > 0.0)) header.refuse("DELTA_T", fmt::format("{}", step), "it must be positive");
    constexpr double digits = 1e-6;  // DELTA_T has seven digits
    header_.sample_rate = rounded_rate(1.0 / step, digits);
    rate_key_ = "DELTA_T";
    std::int64_t declared = header.whole("FRAMES", 0, most_points / frame) * frame;
    const bool half_frames = declared > 0 && header.whole("HALF_FRAMES", 0, 1, 0) == 1;
    begin_ = header.bytes();
    by_hydrapod_ = header.text("OPERATION") == "hydrapod";
    settle_number(header, declared);
    if (half_frames && points_in_file(declared + frame) == declared + frame) declared += frame;
    const std::int64_t held = points_in_file(declared);
    if (held < declared)
      notes_.add(
          fmt::format("the file is cut off: {} samples of the {} that it declares are there "
                      "for all channels",
                      held, declared));
    count_ = held;
    if (!half_frames) declared_ = declared;
    if (!half_frames) return;
    skipped_ = frame / 2;
    count_ = std::max<std::int64_t>(0, held - (held == declared ? frame : skipped_));
    notes_.add(
        fmt::format("HALF_FRAMES = 1: half a frame of {} samples without data at each end "
                    "is left out",
                    skipped_));
  }

  /// Without DATA_TYPE integers are meant, unless the file is as long as floats are.
  void settle_number(const RpcHeader& header, std::int64_t declared) {
    if (header.find("DATA_TYPE")) return;
    const std::int64_t points = (declared + group_ - 1) / group_ * group_ * channels_;
    const auto bytes = static_cast<std::int64_t>(file_.size() - begin_);
    constexpr std::int64_t float_bytes = 4;
    if (points == 0 || bytes != points * float_bytes) return;
    number_ = RpcNumber::floating_point;
    size_ = float_bytes;
    format_ = RecordFormat::rpc;
    notes_.add("DATA_TYPE is missing; the file is as long as floats of 32 bits are: read as these");
  }

  /// Of `declared` points per channel, those that are there for all channels. Other programs may
  /// store a last group short that is not full: the file then ends with it. A file that is cut off
  /// within a full group has these points for the first channels only.
  std::int64_t points_in_file(std::int64_t declared) {
    const auto row = static_cast<std::uint64_t>(channels_) * size_;  // bytes
    const std::uint64_t points = (file_.size() - begin_) / row;
    const auto group = static_cast<std::uint64_t>(group_);
    const auto wanted = static_cast<std::uint64_t>(declared);
    const std::uint64_t full = points / group, rest = wanted - std::min(wanted, full * group);
    short_group_ = static_cast<std::int64_t>(full);
    const std::uint64_t last = file_.size() - begin_ - full * group * row;  // bytes
    const bool fits = last >= rest * row && last < rest * row + rpc_block_bytes;
    short_points_ =
        !by_hydrapod_ && rest > 0 && rest < group && fits ? static_cast<std::int64_t>(rest) : 0;
    return std::min<std::int64_t>(declared,
                                  static_cast<std::int64_t>(full * group) + short_points_);
  }

  void read_channels(const RpcHeader& header) {
    RecordComments comments;
    const std::string own = header.own_text();
    for (std::size_t begin = 0; begin < own.size();) {
      const std::size_t end = std::min(own.find('\n', begin), own.size());
      comments.take(std::string_view(own).substr(begin, end - begin), 0);
      begin = end + 1;
    }
    if (comments.by_hydrapod(notes_) && use_own_header(comments.header(notes_))) {
      scales_.assign(header_.channels.size(), 1.0);
      read_scales(header);
      return settle_channels(true);
    }
    for (std::int64_t c = 1; c <= channels_; ++c) {
      std::string name = header.text(fmt::format("DESC.CHAN_{}", c));
      if (name.empty()) name = fmt::format("channel {}", c);
      header_.channels.push_back({.name = name,
                                  .unit = header.text(fmt::format("UNITS.CHAN_{}", c)),
                                  .role = drive_ ? Role::drive : Role::response});
    }
    scales_.assign(header_.channels.size(), 1.0);
    read_scales(header);
    header_.date = iso_date(header.text("DATE"));
    for (const char* key : {"OPERATION", "PARENT_1", "REPEATS"})
      if (const std::string value = header.text(key); !value.empty())
        header_.notes += fmt::format("{} = {}\n", key, value);
    settle_channels(false);
  }

  bool use_own_header(RecordHeader own) {
    constexpr double tolerance = 1e-6;
    if (static_cast<std::int64_t>(own.channels.size()) == channels_ && own.sample_rate > 0.0 &&
        std::abs(own.sample_rate - header_.sample_rate) <= tolerance * header_.sample_rate) {
      header_ = std::move(own);
      return true;
    }
    notes_.add(
        "channels and rate are not those that the header of hydrapod in the file describes; that "
        "header is left aside");
    return false;
  }

  /// A scale belongs to integers: value = integer · SCALE.
  void read_scales(const RpcHeader& header) {
    for (std::int64_t c = 1; c <= channels_; ++c) {
      const std::string key = fmt::format("SCALE.CHAN_{}", c);
      if (number_ == RpcNumber::short_integer) {
        scales_[static_cast<std::size_t>(c - 1)] = header.number(key);
      } else if (header.find(key) && header.number(key) != 1.0) {
        notes_.add(fmt::format("{} = {} is not applied: it belongs to integers, and the samples "
                               "are not",
                               key, header.number(key)),
                   0, 0, "scale");
      }
    }
    clipping_.assign(static_cast<std::size_t>(channels_), {});
  }

  /// The number of samples, where the file tells it, or what fills the last group with zeros.
  void find_end(const RpcHeader& header) {
    if (header.find("SAMPLES")) {
      const std::int64_t declared = header.whole("SAMPLES", 0, most_points);
      count_ = std::min(*count_, declared);
      declared_ = declared;
      if (header.text(rpc_completed_key) == "0") note_unfinished();
      return;
    }
    if (declared_ && *count_ < *declared_) return;  // what fills the last group is cut off
    std::int64_t zeros = std::min(*count_, group_);
    column_.resize(static_cast<std::size_t>(zeros));
    for (std::int64_t c = 0; c < channels_ && zeros > 0; ++c) {
      if (!read_points(c, skipped_ + *count_ - zeros, zeros, column_.data())) return;
      std::int64_t here = 0;
      while (here < zeros && column_[static_cast<std::size_t>(zeros - here - 1)] == 0.0) ++here;
      zeros = here;
    }
    if (zeros == 0 || zeros == *count_ || zeros >= group_) return;
    *count_ -= zeros;
    if (declared_) *declared_ -= zeros;
    notes_.add(
        fmt::format("the last {} samples of every channel are 0, as RPC III fills its last "
                    "group: left out",
                    zeros));
  }

  std::int64_t read_values(Eigen::Ref<Samples> block) override {
    column_.resize(static_cast<std::size_t>(block.rows()));
    for (Eigen::Index c = 0; c < block.cols(); ++c) {
      if (!read_points(c, done_ + skipped_, block.rows(), column_.data())) {
        notes_.add(fmt::format("the samples from {} on cannot be read", done_ + 1));
        return 0;
      }
      const double scale = scales_[static_cast<std::size_t>(c)];
      for (Eigen::Index k = 0; k < block.rows(); ++k) {
        const double value = column_[static_cast<std::size_t>(k)];
        if (number_ == RpcNumber::short_integer) watch_limits(c, value);
        block(k, c) = value * scale;
      }
    }
    if (done_ + block.rows() == *count_) note_clipping();
    return block.rows();
  }

  void to_first_sample() override { clipping_.assign(clipping_.size(), {}); }

  /// `count` numbers of a channel from `first` on, as they stand in the file.
  bool read_points(std::int64_t channel, std::int64_t first, std::int64_t count, double* out) {
    while (count > 0) {
      const std::int64_t group = first / group_, within = first % group_;
      const std::int64_t width =
          group == short_group_ && short_points_ > 0 ? short_points_ : group_;
      constexpr std::int64_t most = 1 << 14;
      const std::int64_t points = std::min({count, width - within, most});
      if (points <= 0) return false;
      const auto offset =
          begin_ +
          static_cast<std::uint64_t>(group * group_ * channels_ + channel * width + within) * size_;
      const auto bytes = static_cast<std::size_t>(points) * size_;
      const std::string_view got = file_.at(offset, bytes);
      if (got.size() < bytes) return false;
      for (std::int64_t k = 0; k < points; ++k)
        *out++ = number_at(got.data() + static_cast<std::size_t>(k) * size_);
      first += points;
      count -= points;
    }
    return true;
  }

  [[nodiscard]] double number_at(const char* at) const {
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), at, size_);
    if (big_endian_) std::reverse(bytes.begin(), bytes.begin() + static_cast<int>(size_));
    if (number_ == RpcNumber::double_precision) return std::bit_cast<double>(bytes);
    std::array<char, 4> four{bytes[0], bytes[1], bytes[2], bytes[3]};
    if (number_ == RpcNumber::floating_point) return std::bit_cast<float>(four);
    return std::bit_cast<std::int16_t>(std::array<char, 2>{bytes[0], bytes[1]});
  }

  // integers at their full scale

  /// Runs of three or more that are no rounded top: there the sample next to a run of n is at most
  /// (1 + 2/n)² integers below. Where every sample is held for a while, runs are everywhere.
  struct Clipping {
    std::int64_t run{}, samples{};
    std::int64_t pending{};  ///< samples of a run, the one after which is the last
    double last{std::numeric_limits<double>::quiet_NaN()}, before_last{last}, before_run{last};
    bool was_held{};  ///< what came before the run
  };

  [[nodiscard]] bool is_steep(double beside, std::int64_t run) const {
    const double rounded = std::pow(1.0 + 2.0 / static_cast<double>(run), 2) + 1.0;
    return !(full_scale_ - std::abs(beside) <= rounded);  // or not known
  }

  void watch_limits(Eigen::Index channel, double integer) {
    Clipping& c = clipping_[static_cast<std::size_t>(channel)];
    constexpr std::int64_t least_run = 3;  // one sample at full scale is what a scale is made from
    if (integer != c.last) c.samples += c.pending;
    c.pending = 0;
    if (std::abs(integer) >= full_scale_) {
      if (c.run++ == 0) {
        c.before_run = c.last;
        c.was_held = c.last == c.before_last;
      }
    } else {
      if (c.run >= least_run && !c.was_held && is_steep(c.before_run, c.run) &&
          is_steep(integer, c.run))
        c.pending = c.run;
      c.run = 0;
    }
    c.before_last = c.last;
    c.last = integer;
  }

  void note_clipping() {
    for (std::size_t c = 0; c < clipping_.size(); ++c)
      if (clipping_[c].samples + clipping_[c].pending > 0)
        notes_.add(
            fmt::format("channel \"{}\": {} samples are at the full scale of ±{}, in runs "
                        "of three or more: clipped",
                        base::printable(header_.channels[c].name),
                        clipping_[c].samples + clipping_[c].pending, full_scale_));
  }

  FileWindow file_;
  bool big_endian_{}, drive_{}, by_hydrapod_{};
  RpcNumber number_{};
  std::size_t size_{};                 ///< bytes of a number
  double full_scale_{};                ///< of integers
  std::int64_t channels_{}, group_{};  ///< points of one channel in a group
  std::uint64_t begin_{};              ///< of the samples in the file
  std::int64_t skipped_{};             ///< points before the first sample
  std::int64_t short_group_{}, short_points_{};
  std::vector<double> scales_, column_;
  std::vector<Clipping> clipping_;
};

}  // namespace

std::unique_ptr<RecordReader> make_rpc_reader(const std::string& path) {
  return std::make_unique<RpcReader>(path);
}

}  // namespace hydrapod::data
