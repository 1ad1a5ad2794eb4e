#pragma once
/// A record made from the bytes of an input, written by hydrapod's own writer and damaged: the
/// structure stays valid but for what the input changes in it.
///
/// An undamaged record must come back as it was. A damaged one is refused, or read; where its
/// checksum holds, channels and samples must be those that were written.

#include <fmt/format.h>
#include <fuzzer/FuzzedDataProvider.h>

#include <array>
#include <bit>
#include <fstream>
#include <iterator>

#include "record_fuzz.hpp"

namespace hydrapod::fuzz {

inline data::Channel channel_from(FuzzedDataProvider& bytes, std::size_t number) {
  static constexpr std::array units{"1", "m", "rad", "m/s^2", "N", "N m", "Pa", "A"};
  data::Channel channel{
      .name = base::printable(bytes.ConsumeRandomLengthString(12)),
      .unit = bytes.PickValueInArray(units),
      .direction = static_cast<data::Direction>(bytes.ConsumeIntegralInRange(-6, 6)),
      .role = static_cast<data::Role>(bytes.ConsumeIntegralInRange(0, 3)),
      .point = bytes.ConsumeIntegralInRange(0, 1000)};
  channel.name = base::trimmed(channel.name + std::to_string(number));  // unique
  return channel;
}

inline data::Record record_from(FuzzedDataProvider& bytes) {
  data::Record record;
  auto& header = record.header;
  header.title = base::printable(bytes.ConsumeRandomLengthString(20));
  header.sample_rate = std::ldexp(1.0, bytes.ConsumeIntegralInRange(-3, 14));
  header.start = bytes.ConsumeIntegralInRange(0, 3) * 0.5;
  if (bytes.ConsumeBool()) header.date = "2026-11-20T09:00:00";
  header.repeat = bytes.ConsumeIntegralInRange(1, 5);
  header.notes = base::printable(bytes.ConsumeRandomLengthString(30));
  if (bytes.ConsumeBool()) {
    header.experiment.seed = bytes.ConsumeIntegral<std::uint64_t>();
    header.experiment.pose_name = "low";
    header.experiment.overrides = {"platform.mass=3 t"};
  }
  const std::size_t channels = bytes.ConsumeIntegralInRange<std::size_t>(1, 6);
  for (std::size_t k = 0; k < channels; ++k) header.channels.push_back(channel_from(bytes, k));
  record.samples.resize(bytes.ConsumeIntegralInRange(1, 40), static_cast<Eigen::Index>(channels));
  for (double& value : record.samples.reshaped())
    value = bytes.ConsumeIntegral<std::int16_t>() / 64.0;
  return record;
}

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Bytes that are changed, words that are replaced, an end that is cut off. Whether anything
/// changed.
inline bool damage(FuzzedDataProvider& bytes, std::string& file) {
  const std::string before = file;
  while (bytes.remaining_bytes() > 0 && !file.empty()) {
    // most of what matters stands at the beginning
    const std::size_t reach =
        bytes.ConsumeBool() ? file.size() : std::min<std::size_t>(4096, file.size());
    const auto at = bytes.ConsumeIntegralInRange<std::size_t>(0, reach - 1);
    switch (bytes.ConsumeIntegralInRange(0, 4)) {
      case 0:
        file[at] = static_cast<char>(file[at] ^ (1 << bytes.ConsumeIntegralInRange(0, 7)));
        break;
      case 1:
        file[at] = bytes.ConsumeIntegral<char>();
        break;
      case 2: {
        const auto word = bytes.ConsumeIntegral<std::uint32_t>();
        for (std::size_t k = 0; k < 4 && at + k < file.size(); ++k)
          file[at + k] = static_cast<char>(word >> (8 * k));
        break;
      }
      case 3:
        if (bytes.ConsumeIntegralInRange(0, 7) == 0) file.resize(at);
        break;
      default: {
        const auto from = bytes.ConsumeIntegralInRange<std::size_t>(0, file.size() - 1);
        const auto count = std::min({bytes.ConsumeIntegralInRange<std::size_t>(1, 64),
                                     file.size() - at, file.size() - from});
        file.replace(at, count, file.substr(from, count));
      }
    }
  }
  return file != before;
}

inline bool same_channels(const data::RecordHeader& a, const data::RecordHeader& b) {
  if (a.channels.size() != b.channels.size()) return false;
  for (std::size_t k = 0; k < a.channels.size(); ++k)
    if (a.channels[k].name != b.channels[k].name || a.channels[k].unit != b.channels[k].unit ||
        a.channels[k].direction != b.channels[k].direction ||
        a.channels[k].role != b.channels[k].role || a.channels[k].point != b.channels[k].point)
      return false;
  return a.sample_rate == b.sample_rate && a.start == b.start && a.repeat == b.repeat;
}

/// What same_channels() compares, in one line.
inline std::string said_of(const data::RecordHeader& header) {
  std::string text =
      fmt::format("{} Hz from {} s, repeat {}:", header.sample_rate, header.start, header.repeat);
  for (const auto& c : header.channels)
    text += fmt::format(" [{}] [{}] {} {} {};", c.name, c.unit, static_cast<int>(c.direction),
                        static_cast<int>(c.role), c.point);
  return text;
}

/// Do the file's channels and samples differ from those of `written`?
inline bool differs(data::RecordSet& read, const data::Record& written) {
  bool same = same_channels(read.header(), written.header);
  Eigen::Index row = 0;
  read.stream([&](std::size_t /*file*/, const auto& block) {
    for (Eigen::Index k = 0; k < block.rows() && same; ++k, ++row)
      same = row < written.samples.rows() && block.cols() == written.samples.cols() &&
             block.row(k) == written.samples.row(row);
    return same;
  });
  return !same || row != written.samples.rows();
}

inline bool is_bit_for_bit(data::RecordFormat format) {
  using enum data::RecordFormat;
  return format != uff_ascii && format != rpc && format != rpc_short;
}

template <std::size_t Count>
void write_damage_and_read(const std::uint8_t* data, std::size_t size,
                           const std::array<data::RecordFormat, Count>& formats) {
  static const Folder folder;
  static const std::string path = folder.file("record");
  FuzzedDataProvider bytes(data, size);
  const auto format = bytes.PickValueInArray(formats);
  const data::Record record = record_from(bytes);
  data::write_record(path, record, format);
  std::string file = bytes_of(path);
  const bool damaged = damage(bytes, file);
  const bool taken = accepted([&] {
    const std::string& damaged_path = file_of(file);
    data::RecordSet read = with_a_rate(
        [&](const auto& options) { return data::RecordSet({damaged_path}, options); });
    const bool changed = differs(read, record);
    if (!is_bit_for_bit(format) || !changed) return;
    const bool holds = read.checksum() == data::ChecksumFinding::holds;
    if (damaged && !holds) return;
    std::fprintf(stderr, "%s, %s: read otherwise than it was written\n%s\n%s\n",
                 std::string(data::format_text(format)).c_str(),
                 damaged ? "damaged, but the checksum holds" : "undamaged",
                 said_of(record.header).c_str(), said_of(read.header()).c_str());
    std::abort();
  });
  if (!taken && !damaged) {
    data::RecordSet refused({file_of(file)});  // what it says is what the target ends with
    std::abort();
  }
  read_as_record(file);
}

}  // namespace hydrapod::fuzz
