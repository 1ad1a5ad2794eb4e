#pragma once
/// What is written is read: the JSON of what was read is the JSON that was read.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "hydrapod/report/json.hpp"

namespace hydrapod::test {

/// Numbers agree to rounding: JSON holds hertz, results hold radians per second.
inline void expect_same_json(const report::Json& found, const report::Json& expected,
                             const std::string& path = "") {
  constexpr double rounding = 1e-13, nothing = 1e-15;  // relative, and of what should be zero
  if (expected.is_number() && found.is_number()) {
    const double value = expected.get<double>();
    EXPECT_NEAR(found.get<double>(), value, rounding * std::abs(value) + nothing) << path;
  } else if (expected.is_structured() && found.size() == expected.size()) {
    for (const auto& item : expected.items()) {
      const auto key = path + "/" + item.key();
      if (expected.is_array())
        expect_same_json(found[std::stoul(item.key())], item.value(), key);
      else
        expect_same_json(found.contains(item.key()) ? found[item.key()] : report::Json("missing"),
                         item.value(), key);
    }
  } else {
    EXPECT_EQ(found, expected) << path;
  }
}

template <class Read, class Write>
void expect_round_trip(const report::Json& json, const Read& read, const Write& write) {
  const auto parsed = report::Json::parse(json.dump());
  expect_same_json(write(read(parsed, "file.json")), parsed);
}

}  // namespace hydrapod::test
