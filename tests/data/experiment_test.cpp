/// How a record was made, from text of anybody.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/data/record.hpp"

namespace hydrapod::data {
namespace {

std::string message(const std::string& json) {
  try {
    read_experiment(json, "");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "read";
}

TEST(ExperimentText, WholeNumbersFitTheirType) {
  EXPECT_EQ(read_experiment(R"({"seed": 18446744073709551615})", "").seed, ~std::uint64_t{0});
  for (const char* wrong : {"18446744073709551616", "-1", "2.5", "\"7\"", "1e3", "true"})
    EXPECT_THAT(message(std::string(R"({"seed": )") + wrong + "}"),
                testing::HasSubstr("seed: must be a whole number from 0 to 18446744073709551615"))
        << wrong;
}

}  // namespace
}  // namespace hydrapod::data
