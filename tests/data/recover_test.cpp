/// Records that were cut off: what is left of them is what was written, and as much as there is.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "hydrapod/data/processing.hpp"
#include "said.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::ChecksumFinding;
using data::RecordFormat;
using testing::HasSubstr;
namespace fs = std::filesystem;

data::Record record(Eigen::Index samples, Eigen::Index channels) {
  data::Record all;
  for (int c = 0; c < channels; ++c)
    all.header.channels.push_back({fmt::format("sensor {} of the table", c), "m/s^2",
                                   data::Direction::z, data::Role::response, 40 + c});
  all.header.sample_rate = 1706.6666666666667;
  all.header.start = -0.12345678901234567;
  all.header.title = "Prüfstand";
  all.header.notes = "a line\nand another";
  all.header.experiment.machine = std::string(700, '#') + "\nname = \"ugly\"\n";
  all.samples = data::Samples::NullaryExpr(samples, channels, [](Eigen::Index k, Eigen::Index c) {
    return std::cos(0.37 * static_cast<double>(k) + static_cast<double>(c)) + 1e-3;
  });
  return all;
}

/// A record in a file, of which pieces are recovered.
class Written {
 public:
  Written(data::Record whole, RecordFormat format) : whole_(std::move(whole)), format_(format) {
    data::write_record(file(), whole_, format);
    bytes_ = fs::file_size(file());
    text_ = read_text(file());
    kept_ = data::read_record(file()).record.samples;
    EXPECT_LE((kept_ - whole_.samples).cwiseAbs().maxCoeff(), rounding());
  }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const data::Record& whole() const { return whole_; }

  struct Left {
    Eigen::Index rows{}, values{};
    std::string refusal{};
    data::RecoverResult result{};
  };
  /// Of the first bytes: every value that is there is what was written, or there is an error.
  Left left_of(const std::string& text) {
    const std::string cut = folder_ / "cut", rest = folder_ / "rest.h5";
    write_text(cut, text);
    fs::remove(rest);
    Left left;
    left.refusal = refusal_of([&] {
                     left.result = data::recover_record(cut, rest, {.format = RecordFormat::hdf5});
                   }).message;
    EXPECT_EQ(read_text(cut), text);
    EXPECT_EQ(fs::exists(rest), left.refusal.empty()) << left.refusal;
    EXPECT_FALSE(fs::exists(rest + ".part"));
    if (left.refusal.empty()) compare(data::read_record(rest), cut, left);
    return left;
  }
  Left left_of(std::uint64_t bytes) { return left_of(text_.substr(0, bytes)); }

 private:
  [[nodiscard]] std::string file() const { return folder_ / "whole"; }

  /// Of samples up to 1.001, in the format: 13 digits, 24 bits, 32752 steps.
  [[nodiscard]] double rounding() const {
    return format_ == RecordFormat::uff_ascii   ? 0.501e-12
           : format_ == RecordFormat::rpc       ? 0x1p-24
           : format_ == RecordFormat::rpc_short ? 0.501 / 32752.0
                                                : 0.0;
  }

  void compare(const data::ReadRecordResult& read, const std::string& from, Left& left) const {
    const auto& [header, samples] = read.record;
    EXPECT_THAT(read.notes, testing::IsEmpty());
    left.rows = samples.rows();
    EXPECT_EQ(left.rows, left.result.samples);
    ASSERT_LE(left.rows, whole_.samples.rows());
    ASSERT_LE(samples.cols(), whole_.samples.cols());
    for (Eigen::Index c = 0; c < samples.cols(); ++c) {
      EXPECT_EQ(header.channels[static_cast<std::size_t>(c)].name,
                whole_.header.channels[static_cast<std::size_t>(c)].name);
      for (Eigen::Index k = 0; k < samples.rows(); ++k) {
        const bool uff = format_ == RecordFormat::uff || format_ == RecordFormat::uff_ascii;
        if (uff && std::isnan(samples(k, c))) continue;
        ++left.values;
        if (samples(k, c) != kept_(k, c)) FAIL() << k << ' ' << c << ": " << samples(k, c);
      }
    }
    EXPECT_EQ(header.sample_rate, whole_.header.sample_rate);
    EXPECT_EQ(header.start, whole_.header.start);
    EXPECT_EQ(header.title, whole_.header.title);
    EXPECT_EQ(header.experiment.machine, whole_.header.experiment.machine);
    EXPECT_THAT(header.notes,
                testing::StartsWith(whole_.header.notes + "\nrecovered by hydrapod "));
    EXPECT_THAT(header.notes, HasSubstr("from " + from));
  }

  TemporaryFolder folder_;
  data::Record whole_;
  data::Samples kept_;  ///< as the format keeps them
  RecordFormat format_;
  std::uint64_t bytes_{};
  std::string text_;
};

class Recover : public testing::TestWithParam<RecordFormat> {
 protected:
  /// A checksum of the whole record is no reason to say anything about a part. That of a CSV file
  /// stands at its end.
  void expect_no_verdict_on_a_part(const data::RecoverResult& result, bool part,
                                   std::uint64_t bytes) const {
    const bool csv = GetParam() == RecordFormat::csv;
    EXPECT_FALSE(result.notes.empty()) << bytes;
    EXPECT_FALSE(result.unfinished);
    if (csv) EXPECT_EQ(result.declared.has_value(), result.checksum == ChecksumFinding::holds);
    if (!part) return;
    EXPECT_EQ(result.checksum, ChecksumFinding::none) << bytes;
    EXPECT_THAT(messages(result.notes), testing::Not(testing::Contains(HasSubstr("checksum does"))))
        << bytes;
    const bool stated = GetParam() == RecordFormat::hdf5 || GetParam() == RecordFormat::mat73 ||
                        GetParam() == RecordFormat::mat5 || GetParam() == RecordFormat::uff;
    EXPECT_EQ(result.has_checksum, stated) << bytes;
  }
};

/// Cut at 61 places. RPC III has one channel behind the other within 1,024 samples or more.
TEST_P(Recover, CutAnywhereItGivesWhatIsLeft) {
  const bool rpc = GetParam() == RecordFormat::rpc || GetParam() == RecordFormat::rpc_short,
             text = GetParam() == RecordFormat::uff_ascii,
             hdf5 = GetParam() == RecordFormat::hdf5 || GetParam() == RecordFormat::mat73;
  const Eigen::Index samples = rpc ? 41'011 : 2'003, all = 5 * samples;
  Written file(record(samples, 5), GetParam());
  Eigen::Index before = 0, grown = 0;
  for (std::uint64_t bytes = 1; bytes < file.bytes(); bytes += file.bytes() / 61) {
    const auto left = file.left_of(bytes);
    EXPECT_GE(left.values, before) << bytes;
    grown += left.values > before ? 1 : 0;
    before = left.values;
    if (!left.refusal.empty()) continue;
    expect_no_verdict_on_a_part(left.result, left.values < all, bytes);
    if (GetParam() != RecordFormat::csv) EXPECT_EQ(left.result.declared, samples) << bytes;
  }
  EXPECT_GE(grown, rpc ? 15 : hdf5 ? 28 : 56);  // the last chunk of HDF5 is not full
  const auto whole = file.left_of(file.bytes());
  EXPECT_EQ(whole.values, all);
  EXPECT_EQ(whole.result.declared, samples);
  EXPECT_EQ(whole.result.checksum, rpc || text ? ChecksumFinding::none : ChecksumFinding::holds);
}

/// Every byte of the end of a small file: the last numbers are whole or missing.
TEST_P(Recover, CutAtAnyByteANumberIsWholeOrMissing) {
  Written file(record(11, 2), GetParam());
  for (std::uint64_t bytes = file.bytes() - std::min<std::uint64_t>(file.bytes() / 2, 120);
       bytes <= file.bytes(); ++bytes)
    file.left_of(bytes);
}

INSTANTIATE_TEST_SUITE_P(Formats, Recover,
                         testing::Values(RecordFormat::hdf5, RecordFormat::mat73,
                                         RecordFormat::mat5, RecordFormat::csv, RecordFormat::uff,
                                         RecordFormat::uff_ascii, RecordFormat::rpc,
                                         RecordFormat::rpc_short),
                         [](const auto& info) {
                           std::string name(data::format_text(info.param));
                           std::erase(name, '-');
                           return name;
                         });

/// Twenty megabytes: the index of the chunks has six leaves, the last one in a second place.
class RecoverLarge : public testing::TestWithParam<RecordFormat> {};

TEST_P(RecoverLarge, SamplesBeforeTheCutAreThere) {
  constexpr std::uint64_t rows = 370'003, channels = 7, row_bytes = 8 * channels,
                          chunk_rows = 1'170, chunk_bytes = chunk_rows * row_bytes,
                          chunks = (rows - 1) / chunk_rows + 1;
  Written file(record(rows, channels), GetParam());
  const std::uint64_t rooms = 16'384;  // of the index, between chunks
  const std::uint64_t begin = file.bytes() - chunks * chunk_bytes - rooms;
  EXPECT_LT(begin, 60'000U);
  Eigen::Index before = 0;
  for (const double share : {0.0041, 0.0173, 0.18, 0.2137, 0.3, 0.47, 0.6, 0.777, 0.9, 0.9973}) {
    const auto bytes = static_cast<std::uint64_t>(share * static_cast<double>(file.bytes()));
    const auto left = file.left_of(bytes);
    EXPECT_EQ(left.refusal, "") << share;
    EXPECT_GT(left.rows, before) << share;
    before = left.rows;
    const auto got = static_cast<std::uint64_t>(left.rows), exact = (bytes - begin) / row_bytes;
    EXPECT_LE(got, exact);
    const bool index_is_behind = share >= 0.9 && share < 0.93;  // that of the last eight chunks
    EXPECT_GE(got + rooms / row_bytes + 1 + (index_is_behind ? 8 * chunk_rows : 0), exact) << share;
    EXPECT_EQ(left.result.checksum, ChecksumFinding::none);
    EXPECT_THAT(
        left.result.notes.back().message,
        HasSubstr(fmt::format("{} of the {} samples that it declares are there", got, rows)));
  }
  const auto all_but_one = file.left_of(file.bytes() - 1);  // the last chunk is not full
  EXPECT_EQ(all_but_one.rows, static_cast<Eigen::Index>(rows));
  EXPECT_EQ(all_but_one.result.checksum, ChecksumFinding::holds);
}

INSTANTIATE_TEST_SUITE_P(Formats, RecoverLarge,
                         testing::Values(RecordFormat::hdf5, RecordFormat::mat73),
                         [](const auto& info) {
                           return std::string(data::format_text(info.param));
                         });

/// Where the index of a file that was cut off is damaged besides, there is less or nothing; never
/// another number.
TEST(RecoverDamaged, AnIndexThatContradictsItselfIsNotFollowed) {
  constexpr std::size_t chunks = 8, entries = 24 + chunks * 40;
  Written file(record(12'011, 5), RecordFormat::hdf5);
  const std::string whole = file.text().substr(0, file.bytes() * 4 / 5);
  const std::size_t leaf = whole.find(std::string("TREE\1\0", 6));
  ASSERT_NE(leaf, whole.npos);
  const Eigen::Index all = file.left_of(whole).rows;
  EXPECT_GT(all, 8'000);
  int fewer = 0, refused = 0;
  for (std::size_t at = leaf; at < leaf + entries; at += 5)
    for (const int bit : {0x01, 0x40}) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ bit);
      const auto left = file.left_of(damaged);
      refused += left.refusal.empty() ? 0 : 1;
      fewer += left.refusal.empty() && left.rows < all ? 1 : 0;
      EXPECT_LE(left.rows, all) << at;
    }
  EXPECT_GE(fewer, 30);
  EXPECT_GE(refused, 10);
}

/// The numbers of another chunk do not stand in for those that are missing, although HDF5 reads
/// zeros where a file has a hole.
TEST(RecoverDamaged, WhatTheIndexDoesNotNameIsMissing) {
  Written file(record(30'011, 5), RecordFormat::hdf5);
  std::string text = file.text();
  const std::size_t leaf = text.find(std::string("TREE\1\0", 6));
  text[leaf + 6] = 7;  // chunks of 1,638 samples
  text.resize(text.size() - 70'000);
  EXPECT_EQ(file.left_of(text).rows, 7 * 1'638);
}

TEST(RecoverDamaged, WhatCannotBeRecoveredIsSaid) {
  Written file(record(30'011, 5), RecordFormat::hdf5);
  EXPECT_THAT(file.left_of(20).refusal,
              HasSubstr("nothing can be recovered: the file is cut off within its first bytes"));
  EXPECT_THAT(file.left_of(200).refusal,
              HasSubstr("nothing can be recovered: no index of samples is found: the file is cut "
                        "off before it, or another program wrote it"));
  const std::size_t index = file.text().find(std::string("TREE\1\0", 6));
  EXPECT_THAT(file.left_of(index).refusal,
              HasSubstr("nothing can be recovered: the file is cut off before the index"));
  std::string other = file.text().substr(0, file.bytes() / 2);
  const std::size_t mark = other.find("hydrapod record");
  other[mark] = 'H';
  EXPECT_THAT(file.left_of(other).refusal, HasSubstr("it is no record of hydrapod"));
  EXPECT_THAT(file.left_of("Dear colleague,\nplease find attached\n").refusal,
              HasSubstr("no line of numbers was found"));
  const TemporaryFolder folder;
  EXPECT_THROW(data::recover_record(folder / "absent.h5", folder / "new.h5", {}), base::InputError);
}

}  // namespace
}  // namespace hydrapod::test
