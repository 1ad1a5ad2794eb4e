/// Memory does not grow with the length of a record.

#include <gtest/gtest.h>

#include "large_record.hpp"
#include "support/places.hpp"

namespace hydrapod::test {
namespace {

using data::RecordFormat;

class LargeRecord : public testing::TestWithParam<RecordFormat> {};

TEST_P(LargeRecord, TakesNoMoreMemoryWhenItIsEightTimesLonger) {
  if (sanitized) GTEST_SKIP() << "sanitizers keep what was freed";
  // whole saw-teeth, so that the mean is known
  const double few = memory_of_large_record(GetParam(), 4.0);
  const double many = memory_of_large_record(GetParam(), 32.0);  // 9 MB of samples
  ASSERT_GT(few, 0.0);
  ASSERT_GT(many, 0.0);
  EXPECT_LT(many, few + 6.0);
  EXPECT_LT(many, 500.0);
}

INSTANTIATE_TEST_SUITE_P(Formats, LargeRecord,
                         testing::Values(RecordFormat::hdf5, RecordFormat::mat5,
                                         RecordFormat::mat73, RecordFormat::csv, RecordFormat::uff),
                         [](const auto& f) { return std::string(data::format_text(f.param)); });

}  // namespace
}  // namespace hydrapod::test
