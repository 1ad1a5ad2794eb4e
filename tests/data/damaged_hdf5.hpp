#pragma once
/// A small HDF5 record with one byte changed, and what reading it may do: refuse it with an error
/// that names the file, or read it; where its checksum holds, it is the record that was written.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>

#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {

inline data::Record small_hdf5_record() {
  data::Record record;
  record.header.channels = {{"demand x", "m", data::Direction::x, data::Role::excitation, 1},
                            {"acceleration", "m/s^2", data::Direction::z, data::Role::response, 3}};
  record.header.sample_rate = 170.5;
  record.header.start = -0.25;
  record.header.notes = "a line\nand another";
  record.samples = data::Samples::NullaryExpr(
      23, 2, [](Eigen::Index k, Eigen::Index c) { return std::cos(0.7 * k + c); });
  return record;
}

struct DamagedRead {
  std::string refusal{};  ///< empty: it was read
  bool same_header{};     ///< as far as a checksum covers it
  bool same_samples{};
  data::ChecksumFinding checksum{};
};

struct DamageCounts {
  int crashed{}, refused{}, read{};
};

class DamagedHdf5 {
 public:
  explicit DamagedHdf5(data::RecordFormat format) {
    data::write_record(path_, whole_, format);
    bytes_ = read_text(path_);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] const DamageCounts& counts() const { return counts_; }

  /// Reads it with `value` at `place`; nothing else may happen than this class says.
  DamagedRead read_with(std::size_t place, char value) {
    std::string damaged = bytes_;
    damaged[place] = value;
    write_text(path_, damaged);
    const auto begin = std::chrono::steady_clock::now();
    DamagedRead result;
    try {
      data::RecordSet set({path_});
      std::int64_t differs = 0, rows = 0;
      set.stream([&](std::size_t, const Eigen::Ref<const data::Samples>& block) {
        for (Eigen::Index k = 0; k < block.rows(); ++k, ++rows)
          if (block.cols() != 2 || rows >= 23 || block.row(k) != whole_.samples.row(rows))
            ++differs;
        return rows < 1'000'000;
      });
      ++counts_.read;
      result.same_samples = differs == 0 && rows == 23;
      result.same_header = is_that_of_whole(set.header());
      result.checksum = set.checksum();
      if (result.checksum == data::ChecksumFinding::holds)
        EXPECT_TRUE(result.same_header && result.same_samples) << place << ' ' << int(value);
    } catch (const base::InputError& error) {
      result.refusal = error.diagnostics().back().message;
      const bool crashed = result.refusal.find("crashed") != result.refusal.npos;
      ++(crashed ? counts_.crashed : counts_.refused);
      EXPECT_FALSE(result.refusal.empty());
      EXPECT_EQ(result.refusal.find('\n'), result.refusal.npos) << result.refusal;
      for (const auto& said : error.diagnostics()) EXPECT_EQ(said.file, path_) << said.message;
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(taken.count(), 15.0) << place << ' ' << int(value);
    return result;
  }

 private:
  [[nodiscard]] bool is_that_of_whole(const data::RecordHeader& header) const {
    const auto covered = [](const data::RecordHeader& h) {
      auto all = fmt::format("{} {} {}", h.sample_rate, h.start, h.repeat);
      for (const auto& c : h.channels)
        all += fmt::format("\n{}\n{}\n{} {} {}", c.name, c.unit, static_cast<int>(c.direction),
                           static_cast<int>(c.role), c.point);
      return all;
    };
    return covered(header) == covered(whole_.header);
  }

  data::Record whole_{small_hdf5_record()};
  TemporaryFolder folder_;
  std::string path_{(folder_.path() / "r.h5").string()};
  std::string bytes_;
  DamageCounts counts_;
};

}  // namespace hydrapod::test
