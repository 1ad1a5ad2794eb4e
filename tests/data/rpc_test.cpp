/// RPC III: files made by hand, files that are written and read again, damaged ones.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>

#include "hydrapod/data/record_io.hpp"
#include "rpc_file.hpp"
#include "said.hpp"
#include "sample_record.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::RecordFormat;
using testing::HasSubstr;

data::ReadRecordResult read_bytes(const std::string& bytes) {
  const TemporaryFolder folder;
  write_text(folder / "r.rsp", bytes);
  return data::read_record(folder / "r.rsp");
}

std::string refusal_of_bytes(const std::string& bytes) {
  return refusal_of([&] { read_bytes(bytes); }).message;
}

void expect_counts(const data::Record& record) {
  ASSERT_EQ(record.samples.rows(), 6);
  ASSERT_EQ(record.samples.cols(), 2);
  for (Eigen::Index k = 0; k < 6; ++k) {
    EXPECT_EQ(record.samples(k, 0), static_cast<double>(k + 1) * 0.5 * 0.001);
    EXPECT_EQ(record.samples(k, 1), static_cast<double>(-10 * (k + 1)) * 0.125 * 1000.0);
  }
}

TEST(Rpc, IntegersByHandAreIntegerTimesScale) {
  const auto [record, notes] =
      read_bytes(rpc_header("BINARY_IEEE_LITTLE_END", rpc_shorts_keys()) + rpc_shorts_data());
  expect_counts(record);
  EXPECT_EQ(record.header.sample_rate, 4.0);
  EXPECT_EQ(record.header.channels[0].name, "left front");
  EXPECT_EQ(record.header.channels[0].unit, "m");
  EXPECT_EQ(record.header.channels[1].unit, "N");
  EXPECT_EQ(record.header.channels[1].role, data::Role::response);
  EXPECT_EQ(record.header.date, "1995-10-05T14:19:14");
  EXPECT_THAT(record.header.notes, HasSubstr("OPERATION = by hand"));
  EXPECT_THAT(messages(notes),
              testing::Contains("the last 2 samples of every channel are 0, as RPC III fills its "
                                "last group: left out"));
}

TEST(Rpc, BothByteOrdersAndTheOldName) {
  expect_counts(
      read_bytes(rpc_header("BINARY_IEEE_BIG_END", rpc_shorts_keys()) + rpc_shorts_data(true))
          .record);
  expect_counts(read_bytes(rpc_header("BINARY", rpc_shorts_keys()) + rpc_shorts_data()).record);
}

TEST(Rpc, ADriveFileHasDrives) {
  for (const char* type : {"DRIVE", "1"})
    EXPECT_EQ(
        read_bytes(rpc_with(rpc_shorts_keys(), "TIME_TYPE", type)).record.header.channels[0].role,
        data::Role::drive);
}

TEST(Rpc, ALastGroupMayBeShort) {
  auto keys = rpc_shorts_keys();
  for (auto& [key, value] : keys)
    if (key == "FRAMES") value = "3";
  std::string data;
  for (const int value : {1, 2, 3, 4, -10, -20, -30, -40, 5, 6, -50, -60})
    data += rpc_number(static_cast<std::int16_t>(value));
  const auto [record, notes] = read_bytes(rpc_header("BINARY", keys) + data);
  expect_counts(record);
}

TEST(Rpc, FloatsByHandAreNotScaled) {
  RpcKeys keys = rpc_shorts_keys();
  for (auto& [key, value] : keys) {
    if (key == "FRAMES") value = "1";
    if (key == "PTS_PER_GROUP") value = "2";
    if (key.starts_with("UNITS")) value = "m";
  }
  keys.insert(keys.begin(), {"DATA_TYPE", "FLOATING_POINT"});
  std::string data;
  for (const float value : {0.1F, -3e30F, 7.25F, 1e-40F}) data += rpc_number(value);
  const auto [record, notes] = read_bytes(rpc_header("BINARY_IEEE_LITTLE_END", keys) + data);
  ASSERT_EQ(record.samples.rows(), 2);
  EXPECT_EQ(record.samples(0, 0), static_cast<double>(0.1F));
  EXPECT_EQ(record.samples(1, 0), static_cast<double>(-3e30F));
  EXPECT_EQ(record.samples(0, 1), 7.25);
  EXPECT_EQ(record.samples(1, 1), static_cast<double>(1e-40F));
  EXPECT_THAT(messages(notes), testing::Contains(HasSubstr("SCALE.CHAN_1 = 0.5 is not applied")));
}

/// Without DATA_TYPE the length of the file tells floats from integers.
TEST(Rpc, FloatsWithoutADataTypeAreKnownByTheLengthOfTheFile) {
  RpcKeys keys = rpc_shorts_keys();
  for (auto& [key, value] : keys)
    if (key == "FRAMES") value = "3";
  std::string data;
  for (const float value : {0.1F, -3.5F, 7.25F, 1.75F, 1.0F, 2.0F, 3.0F, 4.0F, -0.5F, 0.25F, 0.0F,
                            0.0F, 9.0F, 8.0F, 0.0F, 0.0F})
    data += rpc_number(value);
  const auto [record, notes] = read_bytes(rpc_header("BINARY_IEEE_LITTLE_END", keys) + data);
  EXPECT_THAT(messages(notes), testing::Contains(HasSubstr("DATA_TYPE is missing")));
  ASSERT_EQ(record.samples.rows(), 6);
  EXPECT_EQ(record.samples(1, 0), -3.5 * 0.001);  // mm, and no scale
  EXPECT_EQ(record.samples(4, 0), -0.5 * 0.001);
  EXPECT_EQ(record.samples(5, 1), 8.0 * 1000.0);
}

TEST(Rpc, HalfFramesHoldNoData) {
  auto keys = rpc_shorts_keys();
  keys.emplace_back("HALF_FRAMES", "1");
  for (auto& [key, value] : keys)
    if (key == "FRAMES") value = "3";
  std::string data;  // 3 frames of data and one of two halves
  for (const int value : {0, 1, 2, 3, 0, -10, -20, -30, 4, 5, 6, 0, -40, -50, -60, 0})
    data += rpc_number(static_cast<std::int16_t>(value));
  expect_counts(read_bytes(rpc_header("BINARY", keys) + data).record);
}

TEST(Rpc, RunsAtFullScaleAreReported) {
  std::string data = rpc_shorts_data();
  for (const std::size_t at : {1U, 2U, 3U})
    data.replace(2 * at, 2, rpc_number(std::int16_t{32752}));
  const auto notes = read_bytes(rpc_header("BINARY", rpc_shorts_keys()) + data).notes;
  EXPECT_THAT(
      messages(notes),
      testing::Contains("channel \"left front\": 3 samples are at the full scale of ±32752, "
                        "in runs of three or more: clipped"));
}

/// A top that is rounded to integers, and samples that are each there twice or more.
TEST(Rpc, RunsAtFullScaleOfASlowTopAndOfHeldSamplesAreNone) {
  const std::string plain = rpc_shorts_data();
  for (const std::array<int, 6> values : {std::array{32750, 32752, 32752, 32752, 32751, 32740},
                                          std::array{171, 171, 32752, 32752, 32752, 9}}) {
    std::string data = plain;
    for (const std::size_t at : {0U, 1U, 2U, 3U})
      data.replace(2 * at, 2, rpc_number(static_cast<std::int16_t>(values[at])));
    const std::size_t later = 2 * 4 * 2;  // behind the group of the other channel
    for (const std::size_t at : {0U, 1U})
      data.replace(later + 2 * at, 2, rpc_number(static_cast<std::int16_t>(values[4 + at])));
    EXPECT_THAT(messages(read_bytes(rpc_header("BINARY", rpc_shorts_keys()) + data).notes),
                testing::Not(testing::Contains(HasSubstr("full scale"))));
  }
}

TEST(Rpc, DamagedHeadersNameKeyPlaceAndWhatIsAccepted) {
  const RpcKeys keys = rpc_shorts_keys();
  const auto with = [&](const std::string& key, const std::string& value) {
    return refusal_of_bytes(rpc_with(keys, key, value));
  };
  EXPECT_EQ(with("PTS_PER_FRAME", "two"),
            "PTS_PER_FRAME = \"two\" (byte 800): expected is a whole number from 1 to 1073741824");
  EXPECT_THAT(with("PTS_PER_GROUP", "3"), HasSubstr("multiple of PTS_PER_FRAME = 2"));
  EXPECT_THAT(with("FRAMES", "-1"), HasSubstr("FRAMES = \"-1\""));
  EXPECT_THAT(with("DELTA_T", "0"), HasSubstr("must be positive"));
  EXPECT_THAT(with("DELTA_T", "nan"), HasSubstr("expected is a finite number"));
  EXPECT_THAT(with("CHANNELS", "0"), HasSubstr("from 1 to"));
  EXPECT_THAT(with("FILE_TYPE", "HISTOGRAM"), HasSubstr("read are TIME_HISTORY"));
  EXPECT_THAT(with("TIME_TYPE", "PEAK_PICK"), HasSubstr("read are RESPONSE, DRIVE"));
  EXPECT_THAT(with("SCALE.CHAN_2", "x"), HasSubstr("SCALE.CHAN_2 = \"x\""));
  RpcKeys fewer = keys;
  std::erase_if(fewer, [](const auto& key) { return key.first == "DELTA_T"; });
  EXPECT_THAT(refusal_of_bytes(rpc_header("BINARY", fewer) + rpc_shorts_data()),
              HasSubstr("the header has no key DELTA_T"));
  EXPECT_THAT(refusal_of_bytes(rpc_header("ASCII", keys) + rpc_shorts_data()),
              HasSubstr("FORMAT = \"ASCII\" (byte 32): read are BINARY_IEEE_LITTLE_END"));
  EXPECT_THAT(refusal_of_bytes(rpc_header("BINARY", keys).substr(0, 700)),
              HasSubstr("cut off within its header: NUM_HEADER_BLOCKS = 7 are 3584 bytes"));
}

TEST(Rpc, OfACutFileTheWholeGroupsAreRead) {
  const std::string whole = rpc_header("BINARY", rpc_shorts_keys()) + rpc_shorts_data();
  const auto [record, notes] = read_bytes(whole.substr(0, whole.size() - 9));
  EXPECT_EQ(record.samples.rows(), 4);
  EXPECT_THAT(
      messages(notes),
      testing::Contains("the file is cut off: 4 samples of the 8 that it declares are there "
                        "for all channels"));
}

TEST(Rpc, CutOrChangedAnywhereItIsReadOrRefused) {
  const std::string whole = rpc_header("BINARY", rpc_shorts_keys()) + rpc_shorts_data();
  for (std::size_t size = 1; size < whole.size(); size += 13)
    refusal_of_bytes(whole.substr(0, size));
  for (std::size_t at = 0; at < whole.size(); at += 7)
    for (const char change : {'\x80', '\x15', '\x01'}) {
      std::string changed = whole;
      changed[at] = static_cast<char>(changed[at] ^ change);
      refusal_of_bytes(changed);
    }
}

// what the program writes

/// Samples that single precision holds.
data::Record float_record(Eigen::Index samples) {
  data::Record record = sample_record(samples);
  for (double& value : record.samples.reshaped())
    if (std::isfinite(value)) value = static_cast<double>(static_cast<float>(value));
  return record;
}

bool same_bits(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) ||
         std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

TEST(RpcWriter, FloatsComeBackBitForBitWithTheWholeHeader) {
  for (const Eigen::Index samples : {0, 1, 2047, 2048, 2049, 5000}) {
    const TemporaryFolder folder;
    data::Record sent = float_record(samples);
    for (double& value : sent.samples.reshaped())  // what single precision has no room for
      if (std::isfinite(value) && std::abs(value) > 3e38) value = -1.5;
    data::write_record(folder / "r.rsp", sent, RecordFormat::rpc);
    const auto [read, notes] = data::read_record(folder / "r.rsp");
    EXPECT_THAT(notes, testing::IsEmpty());
    expect_same_header(read.header, sent.header);
    ASSERT_EQ(read.samples.rows(), samples);
    for (Eigen::Index i = 0; i < sent.samples.size(); ++i)
      ASSERT_TRUE(same_bits(read.samples.data()[i], sent.samples.data()[i])) << i;
  }
}

TEST(RpcWriter, IntegersComeBackWithinHalfAStepOfTheirScale) {
  const TemporaryFolder folder;
  data::Record sent;
  sent.header.channels = {{.name = "small", .unit = "m"},
                          {.name = "large", .unit = "N"},
                          {.name = "none", .unit = "Pa"}};
  sent.header.sample_rate = 1000.0 / 3.0;
  sent.samples = data::Samples::NullaryExpr(3001, 3, [](Eigen::Index k, Eigen::Index c) {
    return c == 2 ? 0.0
                  : (c == 0 ? 1.7e-5 : 8.3e4) * std::cos(0.3137 * static_cast<double>(k * (c + 1)));
  });
  data::write_record(folder / "r.drv", sent, RecordFormat::rpc_short);
  const auto read = data::read_record(folder / "r.drv").record;
  EXPECT_EQ(read.header.sample_rate, sent.header.sample_rate);
  ASSERT_EQ(read.samples.rows(), 3001);
  for (Eigen::Index c = 0; c < 3; ++c) {
    const double step = sent.samples.col(c).cwiseAbs().maxCoeff() / 32752.0;
    EXPECT_LE((read.samples.col(c) - sent.samples.col(c)).cwiseAbs().maxCoeff(),
              0.5 * step * (1.0 + 1e-9));
  }
}

std::vector<std::string> written_notes(const data::Record& record, RecordFormat format,
                                       const std::string& path) {
  const auto writer = data::open_record_writer(path, record.header, format);
  writer->append(record.samples);
  writer->close();
  return messages(writer->notes());
}

TEST(RpcWriter, WhatIntegersCannotHoldIsReported) {
  const TemporaryFolder folder;
  data::Record sent;
  sent.header.channels = {{.name = "x", .unit = "m"}};
  sent.header.sample_rate = 10.0;
  sent.samples.resize(5, 1);
  sent.samples << 1.0, 2.0, std::nan(""), std::numeric_limits<double>::infinity(), -4.0;
  EXPECT_THAT(
      written_notes(sent, RecordFormat::rpc_short, folder / "r.rpc"),
      testing::ElementsAre(
          "channel \"x\": 1 missing samples are written as the last one before them: 16-bit "
          "integers have no mark for them",
          "channel \"x\": 1 samples are beyond what the file can hold and are written as its "
          "full scale"));
  const auto read = data::read_record(folder / "r.rpc").record.samples;
  const double near = 4.0 / 32752.0;
  EXPECT_NEAR(read(2, 0), 2.0, near);
  EXPECT_NEAR(read(3, 0), 4.0, near);
  EXPECT_NEAR(read(4, 0), -4.0, near);
  sent.samples(3, 0) = 1e39;
  EXPECT_THAT(written_notes(sent, RecordFormat::rpc, folder / "f.rpc"),
              testing::ElementsAre(HasSubstr("beyond what the file can hold")));
}

TEST(RpcWriter, AMachineFileThatHasNoRoomIsLeftOutAndNamed) {
  const TemporaryFolder folder;
  data::Record sent = float_record(10);
  sent.header.experiment.machine.assign(200'000, 'm');
  EXPECT_THAT(written_notes(sent, RecordFormat::rpc, folder / "r.tim"),
              testing::Contains(HasSubstr("the machine file (200000 bytes) does not fit")));
  const auto read = data::read_record(folder / "r.tim").record;
  EXPECT_TRUE(read.header.experiment.machine.empty());
  EXPECT_EQ(read.header.notes, sent.header.notes);
  EXPECT_EQ(read.header.experiment.seed, sent.header.experiment.seed);
}

TEST(RpcWriter, KeepsTheLimitsOfTheFormat) {
  const TemporaryFolder folder;
  data::Record sent;
  sent.header.sample_rate = 10.0;
  for (int c = 0; c < 129; ++c)
    sent.header.channels.push_back({.name = "c" + std::to_string(c), .unit = "m"});
  EXPECT_THROW(data::open_record_writer(folder / "r.rpc", sent.header, RecordFormat::rpc),
               base::InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "r.rpc"));
  sent.header.channels.resize(128);
  sent.samples = data::Samples::Ones(3, 128);
  data::write_record(folder / "r.rpc", sent, RecordFormat::rpc);
  EXPECT_EQ(data::read_record(folder / "r.rpc").record.samples.cols(), 128);
}

/// Byte by byte: other programs find keys, types and groups where they look for them.
TEST(RpcWriter, TheFileIsLaidOutAsDescribed) {
  const TemporaryFolder folder;
  data::Record sent;
  sent.header.channels = {{.name = "a", .unit = "m"}, {.name = "b", .unit = "N"}};
  sent.header.sample_rate = 8.0;
  sent.samples = data::Samples::NullaryExpr(
      2050, 2, [](Eigen::Index k, Eigen::Index c) { return static_cast<double>(c == 0 ? k : -k); });
  data::write_record(folder / "r.rpc", sent, RecordFormat::rpc);
  const std::string bytes = read_text(folder / "r.rpc");
  const auto value = [&](const std::string& key) {
    for (std::size_t at = 0; at + 128 <= bytes.size(); at += 128)
      if (bytes.substr(at, key.size() + 1) == key + '\0') return std::string(&bytes[at + 32]);
    return std::string("no such key");
  };
  EXPECT_EQ(bytes.substr(0, 7), std::string("FORMAT\0", 7));
  EXPECT_EQ(bytes.substr(128, 18), std::string("NUM_HEADER_BLOCKS\0", 18));
  EXPECT_EQ(bytes.substr(256, 11), std::string("NUM_PARAMS\0", 11));
  EXPECT_EQ(value("FILE_TYPE"), "TIME_HISTORY");
  EXPECT_EQ(value("DATA_TYPE"), "FLOATING_POINT");
  EXPECT_EQ(value("DELTA_T"), "0.125");
  EXPECT_EQ(value("PTS_PER_FRAME"), "1024");
  EXPECT_EQ(value("PTS_PER_GROUP"), "2048");
  EXPECT_EQ(value("FRAMES"), "3");
  EXPECT_EQ(value("SAMPLES"), "2050");
  EXPECT_EQ(value("DESC.CHAN_2"), "b");
  EXPECT_EQ(value("UPPER_LIMIT.CHAN_1"), "2049");
  const std::size_t begin = 512 * std::stoul(value("NUM_HEADER_BLOCKS"));
  EXPECT_EQ(bytes.size(), begin + 2 * 2 * 2048 * 4);
  const auto number = [&](std::size_t index) {
    float found = 0.0F;
    std::memcpy(&found, bytes.data() + begin + 4 * index, 4);
    return found;
  };
  EXPECT_EQ(number(5), 5.0F);                // channel 1 of group 1
  EXPECT_EQ(number(2048 + 5), -5.0F);        // channel 2
  EXPECT_EQ(number(2 * 2048 + 1), 2049.0F);  // group 2
  EXPECT_EQ(number(2 * 2048 + 2), 0.0F);     // what fills it
}

}  // namespace
}  // namespace hydrapod::test
