#pragma once
/// The JSON the program prints, for tests of its field names.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace hydrapod::test {

using Json = nlohmann::ordered_json;

/// What `hydrapod` prints with these arguments, which must go well and say nothing else.
inline Json json_of(const std::vector<std::string>& arguments, const RunOptions& options = {}) {
  const auto result = run_hydrapod(arguments, options);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  return Json::parse(result.out);
}

/// Names of the fields of an object, in order.
inline std::vector<std::string> fields(const Json& object) {
  std::vector<std::string> names;
  for (const auto& [name, value] : object.items()) names.push_back(name);
  return names;
}

}  // namespace hydrapod::test
