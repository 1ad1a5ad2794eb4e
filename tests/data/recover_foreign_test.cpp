/// What is left of files of other programs, of files whose end is something else, and of records
/// that were never completed.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "hydrapod/data/processing.hpp"
#include "library_files.hpp"
#include "rpc_file.hpp"
#include "said.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::ChecksumFinding;
using data::RecordFormat;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

struct Left {
  data::RecoverResult result{};
  data::Samples samples{};
  std::vector<std::string> said{};
  std::string refusal{};
};

Left left_of(const std::string& path, const data::ReadOptions& options = {}) {
  const TemporaryFolder folder;
  const std::string rest = folder / "rest.h5";
  Left left;
  left.refusal = refusal_of([&] {
                   left.result = data::recover_record(
                       path, rest, {.format = RecordFormat::hdf5, .read = options});
                 }).message;
  if (!left.refusal.empty()) return left;
  left.samples = data::read_record(rest).record.samples;
  left.said = messages(left.result.notes);
  return left;
}

Left left_of_text(const std::string& text, const data::ReadOptions& options = {}) {
  const TemporaryFolder folder;
  write_text(folder / "damaged", text);
  return left_of(folder / "damaged", options);
}

data::Samples wave(Eigen::Index rows, Eigen::Index columns) {
  return data::Samples::NullaryExpr(rows, columns, [](Eigen::Index k, Eigen::Index c) {
    return std::sin(0.317 * static_cast<double>(k) + 1.1 * static_cast<double>(c)) * 31.7;
  });
}

/// As the programs of analysers write it: every number has a point and digits behind it.
std::string table_of(const data::Samples& samples) {
  std::string text = "time [s],u [N],a [m/s^2]\n";
  for (Eigen::Index k = 0; k < samples.rows(); ++k)
    text += fmt::format("{:.3f},{:.7f},{:.7f}\n", 0.004 * static_cast<double>(k), samples(k, 0),
                        samples(k, 1));
  return text;
}

/// What a table holds in the rows of `text` that have an end.
data::Samples ended_rows(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = text.find('\n') + 1, end = 0;
       (end = text.find('\n', begin)) != text.npos; begin = end + 1) {
    double time = 0.0, u = 0.0, a = 0.0;
    EXPECT_EQ(std::sscanf(text.c_str() + begin, "%lf,%lf,%lf", &time, &u, &a), 3);
    numbers.insert(numbers.end(), {u, a});
  }
  return Eigen::Map<const data::Samples>(numbers.data(),
                                         static_cast<Eigen::Index>(numbers.size()) / 2, 2);
}

TEST(RecoverForeign, ATableCutWithinItsLastNumberIsLeftWithoutThatLine) {
  const std::string text = table_of(wave(40, 2));
  for (std::size_t bytes = text.size() - 70; bytes <= text.size(); ++bytes) {
    const std::string cut = text.substr(0, bytes);
    const auto left = left_of_text(cut);
    const auto expected = ended_rows(cut);
    ASSERT_EQ(left.samples.rows(), expected.rows()) << bytes;
    EXPECT_EQ(left.samples, expected) << bytes;
    const bool left_out =
        std::ranges::any_of(left.said, [](const auto& note) { return note.ends_with("left out"); });
    EXPECT_EQ(left_out, !cut.ends_with('\n')) << bytes;
    EXPECT_FALSE(left.result.declared);
    EXPECT_FALSE(left.result.has_checksum);
  }
}

/// Many programs do not end the last line; what a record holds is not made less for that.
TEST(RecoverForeign, ASoundTableMayEndWithoutALineEnd) {
  const TemporaryFolder folder;
  std::string text = table_of(wave(40, 2));
  const auto whole = ended_rows(text);
  text.pop_back();
  write_text(folder / "t.csv", text);
  const auto [record, notes] = data::read_record(folder / "t.csv");
  EXPECT_EQ(record.samples, whole);
  for (const auto& note : messages(notes)) EXPECT_THAT(note, Not(HasSubstr("left out")));
  EXPECT_THAT(left_of(folder / "t.csv").said,
              Contains(HasSubstr("the last line has no end, and its last number may be cut off")));
}

/// Readers take a number that the end of the file has cut off for a missing one.
TEST(RecoverForeign, NoReaderTakesAPieceOfANumberForANumber) {
  const TemporaryFolder folder;
  data::Record whole;
  whole.header.channels = {{.name = "a", .unit = "m"}, {.name = "b", .unit = "N"}};
  whole.header.sample_rate = 256.0;
  whole.samples = wave(9, 2);
  for (const auto format : {RecordFormat::uff_ascii, RecordFormat::csv}) {
    data::write_record(folder / "whole", whole, format);
    const std::string text = read_text(folder / "whole");
    const auto kept = data::read_record(folder / "whole").record.samples;
    int missing = 0;
    for (std::size_t bytes = text.size() - 250; bytes < text.size(); ++bytes) {
      write_text(folder / "cut", text.substr(0, bytes));
      const auto read = data::read_record(folder / "cut").record.samples;
      ASSERT_LE(read.rows(), 9);
      missing += 9 - static_cast<int>(read.rows());
      for (Eigen::Index c = 0; c < read.cols(); ++c)
        for (Eigen::Index k = 0; k < read.rows(); ++k) {
          if (std::isnan(read(k, c)))
            ++missing;
          else
            EXPECT_EQ(read(k, c), kept(k, c)) << bytes;
        }
    }
    EXPECT_GT(missing, 300);
  }
}

/// Zeros from a disk, for one: a line longer than any table has.
TEST(RecoverForeign, WhatStandsBeforeALineThatCannotBeReadIsKept) {
  const TemporaryFolder folder;
  const std::string zeros(20U << 20U, '\0');
  data::Record whole;
  whole.header.channels = {{.name = "a", .unit = "m"}, {.name = "b", .unit = "N"}};
  whole.header.sample_rate = 250.0;
  whole.samples = wave(3001, 2);
  data::write_record(folder / "own.csv", whole, RecordFormat::csv);
  const std::string own = read_text(folder / "own.csv");
  for (const std::string& sound :
       {own.substr(0, own.rfind("# checksum")), table_of(whole.samples)}) {
    const auto left = left_of_text(sound + zeros);
    EXPECT_EQ(left.refusal, "");
    ASSERT_EQ(left.samples.rows(), 3001);
    EXPECT_LE((left.samples - whole.samples).cwiseAbs().maxCoeff(), 0.5001e-7);
    EXPECT_THAT(left.said, Contains(HasSubstr("the line is longer than 16 MiB; this line and what "
                                              "follows are left out")));
    EXPECT_EQ(left.result.checksum, ChecksumFinding::none);
  }
  EXPECT_THAT(left_of_text("time [s],u [N]\n" + std::string(20U << 20U, '7')).refusal,
              HasSubstr("16 MiB"));
}

TEST(RecoverForeign, APartThatWasNeverCompletedIsSaidToBeOne) {
  using enum RecordFormat;
  data::Record whole;
  whole.header.channels = {{.name = "a", .unit = "m"}, {.name = "b", .unit = "N"}};
  whole.header.sample_rate = 250.0;
  whole.samples = wave(200'003, 2);  // 3 MB
  for (const auto format : {hdf5, mat73, mat5, csv, uff, uff_ascii, rpc, rpc_short}) {
    const TemporaryFolder folder;
    const std::string path = folder / "r", part = folder / "copy";
    const auto writer = data::open_record_writer(path, whole.header, format);
    for (Eigen::Index at = 0; at < whole.samples.rows(); at += 1013)
      writer->append(
          whole.samples.middleRows(at, std::min<Eigen::Index>(1013, whole.samples.rows() - at)));
    fs::copy_file(path + ".part", part);
    const auto left = left_of(part);
    const auto name = data::format_text(format);
    EXPECT_EQ(left.refusal, "") << name;
    EXPECT_GT(left.samples.rows(), 100'000) << name;
    EXPECT_LE((left.samples - whole.samples.topRows(left.samples.rows())).cwiseAbs().maxCoeff(),
              format == rpc ? 0x1p-20 : 0.0)
        << name;
    EXPECT_EQ(left.result.unfinished, format != csv) << name;  // which only lacks its end
    EXPECT_FALSE(left.result.declared) << name;
    EXPECT_FALSE(left.result.has_checksum) << name;
    EXPECT_THAT(left.said, Contains(HasSubstr("not completed"))) << name;
    writer->close();
    const auto complete = left_of(path);
    EXPECT_FALSE(complete.result.unfinished) << name;
    EXPECT_EQ(complete.result.declared, whole.samples.rows()) << name;
    EXPECT_THAT(complete.said, Not(Contains(HasSubstr("not completed")))) << name;
  }
}

TEST(RecoverForeign, ZerosThatFillAnRpcFileAreNotMissing) {
  const std::string whole =
      rpc_header("BINARY_IEEE_LITTLE_END", rpc_shorts_keys()) + rpc_shorts_data();
  const auto left = left_of_text(whole);
  EXPECT_EQ(left.samples.rows(), 6);
  EXPECT_EQ(left.result.declared, 6);
  EXPECT_THAT(left.said, Contains(HasSubstr("as RPC III fills its last group")));
  std::string data;  // the first of two groups, with zeros that were measured
  for (const int value : {1, 2, 0, 0, -10, -20, 0, 0})
    data += rpc_number(static_cast<std::int16_t>(value));
  const auto cut = left_of_text(rpc_header("BINARY_IEEE_LITTLE_END", rpc_shorts_keys()) + data);
  EXPECT_EQ(cut.samples.rows(), 4);
  EXPECT_EQ(cut.result.declared, 8);
  EXPECT_THAT(cut.said, Not(Contains(HasSubstr("as RPC III fills its last group"))));
}

matvar_t* numbers(const char* name, std::size_t rows, std::size_t columns,
                  std::vector<double> values) {
  std::size_t size[2] = {rows, columns};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, values.data(), 0);
}

/// Rows that can be read are read, also those before the first that cannot within one block.
TEST(RecoverForeign, AMatFileThatWasCutOffSaysHowManySamplesItHad) {
  const TemporaryFolder folder;
  constexpr Eigen::Index samples = 4'321;
  const auto values = wave(samples, 3);  // row by row: 3 × samples in a MAT file
  const std::vector<double> list(values.data(), values.data() + values.size());
  for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    write_mat(folder / "m.mat", {numbers("fs", 1, 1, {250.0}), numbers("x", 3, samples, list)},
              compression);
    const std::string whole = read_text(folder / "m.mat");
    EXPECT_EQ(left_of_text(whole).result.declared, samples);
    const auto left = left_of_text(whole.substr(0, whole.size() * 3 / 4));
    EXPECT_EQ(left.refusal, "");
    EXPECT_EQ(left.result.declared, samples);
    EXPECT_FALSE(left.result.has_checksum);
    EXPECT_GT(left.samples.rows(), 2'500);
    EXPECT_LT(left.samples.rows(), 4'000);
    EXPECT_EQ(left.samples, values.topRows(left.samples.rows()));
  }
}

TEST(RecoverForeign, AMatrixWithOneColumnBehindTheOtherLosesColumns) {
  const TemporaryFolder folder;
  const std::vector<double> list(3000, 0.1);
  write_mat(folder / "m.mat", {numbers("fs", 1, 1, {250.0}), numbers("x", 1000, 3, list)});
  const std::string whole = read_text(folder / "m.mat");
  const auto left = left_of_text(whole.substr(0, whole.size() - 9'000));
  EXPECT_EQ(left.samples.cols(), 1);
  EXPECT_EQ(left.samples.rows(), 1000);
  EXPECT_EQ(left.result.declared, 1000);
  EXPECT_TRUE(left.result.uneven);
}

TEST(RecoverForeign, AnHdf5FileOfAnotherProgramIsNotCalledCutBeforeItsIndex) {
  const TemporaryFolder folder;
  {
    Hdf5File file(folder / "h.h5");
    const std::vector<double> list(5000, 0.3);
    file.write("x", H5T_NATIVE_DOUBLE, {5000}, list.data());
  }
  const std::string whole = read_text(folder / "h.h5");
  EXPECT_THAT(left_of_text(whole.substr(0, whole.size() - 1000)).refusal,
              HasSubstr("or another program wrote it"));
}

}  // namespace
}  // namespace hydrapod::test
