/// Two hours of 6 inputs and 12 responses at 2 kHz, 2 GB, within 500 MiB of memory.

#include <gtest/gtest.h>

#include "large_record.hpp"

namespace hydrapod::test {
namespace {

TEST(TwoHours, OfHdf5AreWrittenAndScannedWithin500MiB) {
  const double memory = memory_of_large_record(data::RecordFormat::hdf5, 7200.0);
  RecordProperty("peak_mib", std::to_string(memory));
  ASSERT_GT(memory, 0.0);
  EXPECT_LT(memory, 500.0);
}

TEST(TwoHours, OfUniversalFileAreWrittenAndScannedWithin500MiB) {
  const double memory = memory_of_large_record(data::RecordFormat::uff, 7200.0);
  ASSERT_GT(memory, 0.0);
  EXPECT_LT(memory, 500.0);
}

}  // namespace
}  // namespace hydrapod::test
