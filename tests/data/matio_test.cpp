/// MAT files against matio, which knows nothing of hydrapod: each reads what the other wrote.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <memory>

#include "hydrapod/data/record_io.hpp"
#include "mat_variables.hpp"
#include "sample_record.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::RecordFormat;

std::string narrow(const matvar_t* text) {
  std::string all;
  for (std::size_t i = 0; i < text->nbytes / 2; ++i)
    all += static_cast<char>(static_cast<const std::uint16_t*>(text->data)[i]);
  return all;
}

class Matio : public testing::TestWithParam<RecordFormat> {};

TEST_P(Matio, ReadsWhatHydrapodWrote) {
  const TemporaryFolder folder;
  const data::Record record = sample_record(321);
  data::write_record(folder / "record.mat", record, GetParam());
  const MatFile file(Mat_Open((folder / "record.mat").c_str(), MAT_ACC_RDONLY));
  ASSERT_TRUE(file);
  const Variable samples(Mat_VarRead(file.get(), "samples"));
  ASSERT_TRUE(samples);
  ASSERT_EQ(samples->rank, 2);
  ASSERT_EQ(samples->dims[0], record.header.channels.size());
  ASSERT_EQ(samples->dims[1], 321U);
  ASSERT_EQ(samples->class_type, MAT_C_DOUBLE);
  EXPECT_EQ(std::memcmp(samples->data, record.samples.data(), samples->nbytes), 0);
  const Variable rate(Mat_VarRead(file.get(), "sample_rate_hz"));
  ASSERT_TRUE(rate);
  EXPECT_EQ(*static_cast<const double*>(rate->data), record.header.sample_rate);
  const Variable units(Mat_VarRead(file.get(), "channel_unit"));
  ASSERT_TRUE(units);
  ASSERT_EQ(units->class_type, MAT_C_CELL);
  for (std::size_t c = 0; c < record.header.channels.size(); ++c) {
    const matvar_t* unit = Mat_VarGetCell(units.get(), static_cast<int>(c));
    ASSERT_NE(unit, nullptr);
    EXPECT_EQ(unit->data == nullptr ? "" : narrow(unit), record.header.channels[c].unit);
  }
}

INSTANTIATE_TEST_SUITE_P(Versions, Matio, testing::Values(RecordFormat::mat5, RecordFormat::mat73),
                         [](const auto& f) { return std::string(data::format_text(f.param)); });

struct Version {
  const char* name;
  mat_ft version;
  matio_compression compression;
};

class FromMatio : public testing::TestWithParam<Version> {};

TEST_P(FromMatio, IsReadByHydrapod) {
  const TemporaryFolder folder;
  const std::string path = folder / "m.mat";
  Random random(6);
  Eigen::MatrixXd values(500, 3);
  for (double& value : values.reshaped()) value = random.uniform(-1.0, 1.0);
  {
    const MatFile file(Mat_CreateVer(path.c_str(), nullptr, GetParam().version));
    ASSERT_TRUE(file);
    std::size_t size[2] = {500, 3}, one[2] = {1, 1};
    double rate = 1234.5;
    const Variable y(Mat_VarCreate("y", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, values.data(), 0));
    const Variable fs(Mat_VarCreate("Fs", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, one, &rate, 0));
    ASSERT_EQ(Mat_VarWrite(file.get(), y.get(), GetParam().compression), 0);
    ASSERT_EQ(Mat_VarWrite(file.get(), fs.get(), GetParam().compression), 0);
  }
  const auto [record, notes] = data::read_record(path);
  EXPECT_THAT(notes, testing::IsEmpty());
  EXPECT_EQ(record.header.sample_rate, 1234.5);
  ASSERT_EQ(record.samples.rows(), 500);
  EXPECT_EQ((record.samples - values).cwiseAbs().maxCoeff(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    Versions, FromMatio,
    testing::Values(Version{"v5", MAT_FT_MAT5, MAT_COMPRESSION_NONE},
                    Version{"v5_compressed", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB},
                    Version{"v73", MAT_FT_MAT73, MAT_COMPRESSION_NONE},
                    Version{"v73_compressed", MAT_FT_MAT73, MAT_COMPRESSION_ZLIB}),
    [](const auto& version) { return std::string(version.param.name); });

}  // namespace
}  // namespace hydrapod::test
