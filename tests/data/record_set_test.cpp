/// Records of one experiment that are read together.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <thread>

#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod::data {
namespace {

/// Rows enough for several blocks.
std::shared_ptr<const Record> counted(double first) {
  Record record{.header = {.sample_rate = 217.0}, .samples = Samples(90'001, 3)};
  record.header.channels = {{.name = "a"}, {.name = "b"}, {.name = "c"}};
  for (Eigen::Index t = 0; t < record.samples.rows(); ++t)
    for (Eigen::Index c = 0; c < 3; ++c)
      record.samples(t, c) = first + static_cast<double>(3 * t + c);
  return std::make_shared<const Record>(std::move(record));
}

/// All samples of a set, file after file.
std::vector<double> streamed(RecordSet& set) {
  std::vector<double> all;
  set.stream([&](std::size_t, const Eigen::Ref<const Samples>& block) {
    for (const auto& row : block.rowwise()) all.insert(all.end(), row.begin(), row.end());
    return true;
  });
  return all;
}

TEST(RecordSets, InMemoryAreStreamedWithoutACopy) {
  const auto record = counted(7.0);
  RecordSet set({record}, {"run"});
  Eigen::Index rows = 0;
  set.stream([&](std::size_t, const Eigen::Ref<const Samples>& block) {
    EXPECT_EQ(block.data(), &record->samples(rows, 0));
    rows += block.rows();
    return true;
  });
  EXPECT_EQ(rows, 90'001);
}

TEST(RecordSets, HaveMissingSamplesInACopy) {
  const auto record = counted(7.0);
  RecordSet set({record, counted(-4e5)}, {"one", "other"});
  set.take_as_missing({{.file = 0, .channel = 1, .begin = 43'000, .end = 44'500}});
  const auto all = streamed(set);
  for (std::size_t t = 0; t < 90'001; ++t) {
    EXPECT_EQ(std::isnan(all[3 * t + 1]), t >= 43'000 && t < 44'500) << t;
    EXPECT_EQ(all[3 * t + 2], 7.0 + static_cast<double>(3 * t + 2));
    EXPECT_EQ(all[3 * (90'001 + t) + 1], -4e5 + static_cast<double>(3 * t + 1));
  }
  EXPECT_EQ(record->samples(43'100, 1), 7.0 + 3.0 * 43'100 + 1.0);
}

TEST(RecordSets, OfMemoryAreStreamedTwiceAtATime) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "run.mat";
  write_record(path, *counted(11.0), RecordFormat::mat5);
  RecordSet set({path});
  EXPECT_FALSE(set.of_memory().has_value());
  set.keep_samples(1'000'000);
  set.stream([](auto, const auto&) { return false; });
  EXPECT_FALSE(set.of_memory().has_value()) << "it was not read to its end";
  const auto from_file = streamed(set);
  auto other = set.of_memory();
  ASSERT_TRUE(other.has_value());
  set.take_as_missing({{.file = 0, .channel = 0, .begin = 0, .end = 90'001}});
  std::vector<double> beside;
  std::thread thread([&] { beside = streamed(*other); });
  const auto here = streamed(set);
  thread.join();
  EXPECT_EQ(beside, from_file);
  EXPECT_TRUE(std::isnan(here[0]));
  EXPECT_EQ(here[1], from_file[1]);
}

}  // namespace
}  // namespace hydrapod::data
