/// Hammers that rove from point to point: what is said where their records are not combined.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hammer.hpp"

namespace hydrapod::identification {
namespace {

std::string refusal_of(const std::vector<data::Record>& records) {
  try {
    measured(records);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

/// A channel for the force at each of three points.
data::Record at_point(Eigen::Index point, std::uint64_t seed) {
  const auto hit = hammer_record({.noise = 1e-3, .point = point}, seed);
  test::Random random(seed + 1000);
  data::Record record{.header = test::header_of(3, 3, hammer_rate), .samples = {}};
  record.samples.resize(hit.samples.rows(), 6);
  for (double& u : record.samples.leftCols(3).reshaped()) u = 0.4 * test::normal(random);
  record.samples.col(point) = hit.samples.col(0);
  record.samples.rightCols(3) = hit.samples.rightCols(3);
  return record;
}

TEST(Roving, OneRecordPerPointIsNotCombinedAndThatIsSaid) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal_of({at_point(0, 81), at_point(1, 82), at_point(2, 83), at_point(2, 84)}),
              AllOf(HasSubstr("a hammer test that roves: u1 is hit in run0.h5, u2 in run1.h5"),
                    HasSubstr("--inputs \"u1\" for run0.h5")));
  EXPECT_THAT(refusal_of({at_point(1, 85), at_point(1, 86)}),
              HasSubstr("of the inputs u2 alone is hit, and the others hold noise: take --inputs"));
  auto other = at_point(1, 87);
  other.header.channels[1].name = "u7";
  EXPECT_THAT(refusal_of({at_point(1, 88), other}),
              HasSubstr("identify each record by itself, or give the responses"));
}

}  // namespace
}  // namespace hydrapod::identification
