#pragma once
/// Every number of a JSON: none may be another one's, and none may be left unlooked at.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "hydrapod/report/json.hpp"

namespace hydrapod::test {

/// The numbers, truth values and nulls in `json` by their paths.
inline void add_numbers(const report::Json& json, const std::string& path,
                        std::map<std::string, report::Json>& all) {
  if (json.is_structured()) {
    for (const auto& item : json.items()) add_numbers(item.value(), path + "/" + item.key(), all);
  } else if (!json.is_string()) {
    all[path] = json;
  }
}

/// `found` has the numbers of `expected`, and no others. Texts are not compared.
inline void expect_numbers(const report::Json& found, const report::Json& expected) {
  std::map<std::string, report::Json> numbers, wanted;
  add_numbers(found, "", numbers);
  add_numbers(expected, "", wanted);
  for (const auto& [path, value] : numbers)
    EXPECT_TRUE(wanted.contains(path)) << path << " = " << value;
  for (const auto& [path, value] : wanted) {
    ASSERT_TRUE(numbers.contains(path)) << path << " is missing";
    const auto& number = numbers[path];
    if (value.is_number() && number.is_number())
      EXPECT_NEAR(number.get<double>(), value.get<double>(), 1e-12 * std::abs(value.get<double>()))
          << path;
    else
      EXPECT_EQ(number, value) << path;
  }
}

/// Six different numbers: `first`, and each a bit more than the one before.
inline Eigen::Matrix<double, 6, 1> six(double first) {
  Eigen::Matrix<double, 6, 1> values;
  for (int i = 0; i < 6; ++i) values[i] = first + 0.01 * i + 0.001 * i * i;
  return values;
}
inline report::Json six_json(double first) {
  const auto values = six(first);
  return report::Json(std::vector<double>(values.begin(), values.end()));
}

/// A field that is a number, and what it is called in the JSON.
template <class T>
struct NumberField {
  const char* name;
  std::variant<double T::*, std::optional<double> T::*> field;
};

/// Gives the fields of `object` different numbers, the first a bit more than `first`; the JSON that
/// has them.
template <class T>
report::Json number_fields(T& object, double first, const std::vector<NumberField<T>>& fields) {
  report::Json json;
  for (const auto& [name, field] : fields) {
    first += 0.01;
    std::visit([&, number = first](auto member) { object.*member = number; }, field);
    json[name] = first;
  }
  return json;
}

}  // namespace hydrapod::test
