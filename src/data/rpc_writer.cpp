/// RPC III files, written as docs/rpc-iii.md describes them.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "formats.hpp"
#include "hydrapod/base/text.hpp"
#include "out_stream.hpp"
#include "record_comments.hpp"
#include "rpc_layout.hpp"
#include "spool.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr Eigen::Index points_per_frame = 1024, points_per_group = 2048;

/// `text` in pieces that fit behind a key, none of which ends within a character.
std::vector<std::string> rpc_pieces(const std::string& text) {
  std::vector<std::string> pieces;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t size = std::min(rpc_value_bytes - 1, text.size() - begin);
    while (size > 1 && begin + size < text.size() &&
           (static_cast<unsigned char>(text[begin + size]) & 0xC0U) == 0x80U)
      --size;
    pieces.push_back(text.substr(begin, size));
    begin += size;
  }
  return pieces;
}

std::string rpc_field(std::string text, std::size_t bytes) {
  text.resize(bytes, '\0');
  return text;
}

/// What becomes of the samples of one channel.
struct RpcChannelState {
  double lowest{std::numeric_limits<double>::infinity()}, highest{-lowest};
  double last{};                     ///< finite sample
  std::int64_t missing{}, beyond{};  ///< samples that the file cannot hold
};

class RpcWriter final : public RecordWriter {
 public:
  RpcWriter(const std::string& path, const RecordHeader& header, bool as_shorts)
      : RecordWriter(header, false),
        header_(header),
        as_shorts_(as_shorts),
        states_(header.channels.size()),
        group_(points_per_group, static_cast<Eigen::Index>(header.channels.size())),
        notes_(path) {
    require_channels(path, header);
    if (as_shorts_)
      waiting_ = std::make_unique<Waiting>(path, header);
    else
      file_ = std::make_unique<PartStream>(path);
    plan_own_records();
    if (file_) file_->write(header_bytes());
  }

  void write(const Eigen::Ref<const Samples>& samples) override {
    for (Eigen::Index row = 0; row < samples.rows(); ++row) {
      for (Eigen::Index c = 0; c < samples.cols(); ++c)
        group_(filled_, c) = taken(samples(row, c), states_[static_cast<std::size_t>(c)]);
      ++samples_;
      if (++filled_ == points_per_group) put_group();
    }
  }

  [[nodiscard]] std::vector<base::Diagnostic> notes() const override { return notes_.all(); }

 private:
  std::string finish(bool complete) override {
    if (filled_ > 0) put_group();
    for (std::size_t c = 0; c < states_.size(); ++c) note_channel(header_.channels[c].name, c);
    ended_ = true;
    if (file_) {
      file_->write_at(0, header_bytes());
      return file_->close(complete);
    }
    replace_part(waiting_->part, samples_ > 0,
                 [&](OutStream& file) { return file.write(header_bytes()) && write_shorts(file); });
    return waiting_->part.commit(complete);
  }

  static void require_channels(const std::string& path, const RecordHeader& header) {
    if (header.channels.size() > rpc_most_channels)
      base::refuse(path, fmt::format("RPC III holds at most {} channels, the record has {}: write "
                                     "a part of them (`record cut --channel`)",
                                     rpc_most_channels, header.channels.size()));
  }

  /// The sample as the file can hold it.
  [[nodiscard]] double taken(double value, RpcChannelState& state) const {
    if (std::isnan(value)) {
      ++state.missing;
      return as_shorts_ ? state.last : value;
    }
    constexpr double most = std::numeric_limits<float>::max();
    const bool held =
        as_shorts_ ? std::isfinite(value) : std::isinf(value) || std::abs(value) <= most;
    if (!held) {
      ++state.beyond;
      if (as_shorts_) return value;  // the full scale, which is not known yet
      value = std::copysign(most, value);
    }
    state.last = value;
    if (std::isinf(value)) return value;
    state.lowest = std::min(state.lowest, value);
    state.highest = std::max(state.highest, value);
    return value;
  }

  /// Demultiplexed: all points of a channel, then those of the next.
  void put_group() {
    if (waiting_) {
      waiting_->spool.append(group_.topRows(filled_));
    } else {
      group_.bottomRows(points_per_group - filled_).setZero();
      const Eigen::MatrixXf floats = group_.cast<float>();  // column by column
      file_->write({reinterpret_cast<const char*>(floats.data()),
                    sizeof(float) * static_cast<std::size_t>(floats.size())});
      tell_size();
    }
    filled_ = 0;
  }

  /// The header says how many samples there are: now and then, for what a killed run leaves.
  void tell_size() {
    constexpr std::int64_t often = 1 << 20;  // bytes
    const auto row_bytes = static_cast<std::int64_t>(sizeof(float)) * group_.cols();
    if ((samples_ - told_) * row_bytes < often) return;
    told_ = samples_;
    file_->flush();
    file_->write_at(0, header_bytes());
    file_->keep_on_failure();
  }

  [[nodiscard]] double scale(std::size_t channel) const {
    const RpcChannelState& state = states_[channel];
    const double largest = std::max(std::abs(state.lowest), std::abs(state.highest));
    const double wanted = largest / rpc_full_scale;
    // a largest sample near the smallest number of all has no scale
    return std::isfinite(wanted) && wanted >= std::numeric_limits<double>::min() ? wanted : 1.0;
  }

  bool write_shorts(OutStream& file) {
    using Shorts = Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic>;
    Shorts shorts(group_.rows(), group_.cols());
    bool good = true;
    for (std::int64_t first = 0; first < samples_ && good; first += points_per_group) {
      group_.setZero();
      const auto rows = std::min<std::int64_t>(points_per_group, samples_ - first);
      waiting_->spool.read(static_cast<std::uint64_t>(first), group_.topRows(rows));
      for (Eigen::Index c = 0; c < group_.cols(); ++c) {
        const double step = scale(static_cast<std::size_t>(c));
        for (Eigen::Index k = 0; k < points_per_group; ++k)
          shorts(k, c) = static_cast<std::int16_t>(std::lround(
              std::clamp(group_(k, c) / step, -double{rpc_full_scale}, double{rpc_full_scale})));
      }
      good = file.write({reinterpret_cast<const char*>(shorts.data()),
                         sizeof(std::int16_t) * static_cast<std::size_t>(shorts.size())});
    }
    return good;
  }

  // the header

  using Record = std::pair<std::string, std::string>;

  [[nodiscard]] std::vector<Record> records() const {
    const bool drive = std::ranges::none_of(
        header_.channels, [](const Channel& c) { return c.role == Role::response; });
    const std::int64_t frames = (samples_ + points_per_frame - 1) / points_per_frame;
    std::vector<Record> all{{"FORMAT", "BINARY_IEEE_LITTLE_END"},
                            {"NUM_HEADER_BLOCKS", ""},
                            {"NUM_PARAMS", ""},
                            {"FILE_TYPE", "TIME_HISTORY"},
                            {"TIME_TYPE", drive ? "DRIVE" : "RESPONSE"},
                            {"DATA_TYPE", as_shorts_ ? "SHORT_INTEGER" : "FLOATING_POINT"},
                            {"DELTA_T", fmt::format("{}", 1.0 / header_.sample_rate)},
                            {"PTS_PER_FRAME", fmt::format("{}", points_per_frame)},
                            {"PTS_PER_GROUP", fmt::format("{}", points_per_group)},
                            {"FRAMES", fmt::format("{}", frames)},
                            {"SAMPLES", fmt::format("{}", samples_)},
                            {rpc_completed_key, ended_ ? "1" : "0"},
                            {"CHANNELS", fmt::format("{}", header_.channels.size())},
                            {"INT_FULL_SCALE", fmt::format("{}", rpc_full_scale)},
                            {"REPEATS", "1"},
                            {"HALF_FRAMES", "0"},
                            {"BYPASS_FILTER", "0"},
                            {"PARTITIONS", "1"},
                            {"PART.CHAN_1", "1"},
                            {"PART.NCHAN_1", fmt::format("{}", header_.channels.size())},
                            {"DATE", uff_date(header_.date)},
                            {"OPERATION", "hydrapod"}};
    for (std::size_t c = 0; c < header_.channels.size(); ++c) add_channel(c, all);
    for (std::size_t k = 0; k < own_.size(); ++k)
      all.emplace_back(fmt::format("{}{}", rpc_own_key, k + 1), own_[k]);
    all[1].second =
        fmt::format("{}", (all.size() + rpc_records_per_block - 1) / rpc_records_per_block);
    all[2].second = fmt::format("{}", all.size());
    return all;
  }

  void add_channel(std::size_t c, std::vector<Record>& all) const {
    const Channel& channel = header_.channels[c];
    const auto key = [&](const char* name) { return fmt::format("{}.CHAN_{}", name, c + 1); };
    const RpcChannelState& state = states_[c];
    const bool any = state.lowest <= state.highest;
    all.emplace_back(key("DESC"), channel.name);
    all.emplace_back(key("UNITS"), channel.unit);
    all.emplace_back(key("SCALE"), fmt::format("{}", as_shorts_ ? scale(c) : 1.0));
    all.emplace_back(key("LOWER_LIMIT"), fmt::format("{}", any ? state.lowest : 0.0));
    all.emplace_back(key("UPPER_LIMIT"), fmt::format("{}", any ? state.highest : 0.0));
    all.emplace_back(key("MAP"), fmt::format("{}", c + 1));
  }

  /// The header of the record as text behind keys of hydrapod's own, as far as there is room.
  void plan_own_records() {
    const std::size_t room = rpc_most_records - records().size();
    RecordHeader told = header_;
    const auto fits = [&] {
      own_ = rpc_pieces(comment_lines(told));
      return own_.size() <= room;
    };
    if (fits()) return;
    if (const std::size_t bytes = told.experiment.machine.size(); bytes > 0) {
      notes_.add(
          fmt::format("the machine file ({} bytes) does not fit into a header of RPC III, "
                      "which holds {} keys: left out",
                      bytes, rpc_most_records));
      told.experiment.machine.clear();
      if (fits()) return;
    }
    if (!told.geometry.empty()) {
      notes_.add(
          fmt::format("the {} nodes of the geometry do not fit into a header of RPC III: "
                      "left out",
                      told.geometry.nodes.size()));
      told.geometry = {};
      if (fits()) return;
    }
    notes_.add("notes and experiment do not fit into a header of RPC III either: left out");
    told.notes.clear();
    told.experiment = {};
    if (fits()) return;
    for (Channel& channel : told.channels) channel.id_lines.clear();
    fits();
    if (own_.size() > room) own_.clear();  // names of several kilobytes
  }

  [[nodiscard]] std::string header_bytes() const {
    std::string bytes;
    for (const auto& [key, value] : records()) {
      const auto pieces = rpc_pieces(value);
      bytes += rpc_field(key, rpc_key_bytes) +
               rpc_field(pieces.empty() ? "" : pieces.front(), rpc_value_bytes);
    }
    return rpc_field(bytes,
                     (bytes.size() + rpc_block_bytes - 1) / rpc_block_bytes * rpc_block_bytes);
  }

  void note_channel(const std::string& name, std::size_t c) {
    const RpcChannelState& state = states_[c];
    if (as_shorts_ && state.missing > 0)
      notes_.add(
          fmt::format("channel \"{}\": {} missing samples are written as the last one "
                      "before them: 16-bit integers have no mark for them",
                      base::printable(name), state.missing));
    if (state.beyond > 0)
      notes_.add(
          fmt::format("channel \"{}\": {} samples are beyond what the file can hold and are "
                      "written as its full scale",
                      base::printable(name), state.beyond));
  }

  /// Samples as doubles until their scale is known.
  struct Waiting {
    Waiting(const std::string& path, const RecordHeader& header)
        : part(path), spool(part, header) {}
    base::PartFile part;
    Spool spool;
  };

  std::unique_ptr<PartStream> file_{};  ///< of floats
  std::unique_ptr<Waiting> waiting_{};  ///< of 16-bit integers
  RecordHeader header_;
  bool as_shorts_;
  std::vector<RpcChannelState> states_;
  Samples group_;
  Eigen::Index filled_{};  ///< rows of group_
  std::int64_t samples_{}, told_{};
  bool ended_{};                    ///< no more samples come
  std::vector<std::string> own_{};  ///< values behind keys of hydrapod's own
  Notes notes_;
};

}  // namespace

std::unique_ptr<RecordWriter> make_rpc_writer(const std::string& path, const RecordHeader& header,
                                              bool as_shorts) {
  return std::make_unique<RpcWriter>(path, header, as_shorts);
}

}  // namespace hydrapod::data
