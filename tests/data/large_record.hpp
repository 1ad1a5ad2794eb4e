#pragma once
/// Writes and scans a record of 6 inputs and 12 responses at 2 kHz in a process of its own, and
/// tells how much memory that took.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <string>

#include "hydrapod/data/processing.hpp"
#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {

inline constexpr double large_rate = 2000.0;

inline data::RecordHeader large_header() {
  data::RecordHeader header;
  header.sample_rate = large_rate;
  for (int c = 0; c < 18; ++c)
    header.channels.push_back({"channel " + std::to_string(c + 1), "m", data::Direction::none,
                               c < 6 ? data::Role::excitation : data::Role::response, c});
  return header;
}

/// One channel's value at a sample: a saw-tooth, whose mean and range are known.
inline double large_sample(std::int64_t sample, Eigen::Index channel) {
  return static_cast<double>((sample + 7 * channel) % 1000);
}

/// Writes `seconds` of the record to `path`, reads it again and looks at every sample.
inline bool write_and_scan(const std::string& path, data::RecordFormat format, double seconds) {
  const auto total = static_cast<std::int64_t>(seconds * large_rate);
  const data::RecordHeader header = large_header();
  data::Samples block = data::make_block(header);
  {
    const auto writer = data::open_record_writer(path, header, format);
    for (std::int64_t at = 0; at < total;) {
      const auto rows = std::min<std::int64_t>(block.rows(), total - at);
      for (Eigen::Index row = 0; row < rows; ++row)
        for (Eigen::Index c = 0; c < 18; ++c) block(row, c) = large_sample(at + row, c);
      writer->append(block.topRows(rows));
      at += rows;
    }
    writer->close();
  }
  data::RecordSet record({path});
  data::OverviewBuilder overview(record.header(), 4096);
  record.stream([&](std::size_t /*file*/, const auto& samples) {
    overview.add(samples);
    return true;
  });
  const auto result = overview.result();
  bool good = record.notes().empty() && result.samples == total;
  for (const auto& channel : result.channels)
    good = good && channel.lowest == 0.0 && channel.highest == 999.0 &&
           std::abs(channel.mean - 499.5) < 1e-6;
  return good;
}

/// Peak resident memory in MiB of a child that does it; −1 when it failed.
inline double memory_of_large_record(data::RecordFormat format, double seconds) {
  const TemporaryFolder folder;
  const std::string path = folder / "large";
  const pid_t child = fork();
  if (child == 0) _exit(write_and_scan(path, format, seconds) ? 0 : 1);
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child) return -1.0;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return -1.0;
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace hydrapod::test
