/// Ten seconds of an FMU against the plant that it holds.

#include <gtest/gtest.h>

#include "exchange/fmu_subject.hpp"

namespace hydrapod::test {
namespace {

TEST(FmuLong, FollowsThePlantOverTenSecondsOfNoise) {
  expect_same_motion({FmuVersion::fmi2, true}, 10000);
}

}  // namespace
}  // namespace hydrapod::test
