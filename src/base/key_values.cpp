#include "hydrapod/base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::base {

KeyValues::KeyValues(std::string place, std::string_view text) : place_(std::move(place)) {
  text = trimmed(text);
  if (text.ends_with(',')) text.remove_suffix(1);
  if (text.empty()) return;
  for (const std::string& part : split(text, ",")) {
    const auto equals = part.find('=');
    if (equals == std::string::npos)
      fail(fmt::format("'{}' is no key=value, for instance \"z=1 mm\"", printable(part, 30)));
    const std::string key(trimmed(std::string_view(part).substr(0, equals)));
    if (!values_.emplace(key, trimmed(std::string_view(part).substr(equals + 1))).second)
      fail(fmt::format("{} is given twice", printable(key, 20)));
  }
}

std::optional<std::string> KeyValues::text(std::string_view key) {
  if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
  const auto at = values_.find(key);
  return at == values_.end() ? std::nullopt : std::optional(at->second);
}

std::optional<double> KeyValues::number(std::string_view key, const char* unit) {
  const auto value = text(key);
  if (!value) return {};
  const auto read = read_plain_or_quantity(*value, unit);
  if (!read.ok()) fail(fmt::format("{}: {}", key, read.problem));
  return read.value;
}

std::optional<int> KeyValues::whole(std::string_view key, int low, int high) {
  const auto value = number(key, "1");
  if (value && !(*value >= low && *value <= high && *value == std::floor(*value)))
    fail(
        fmt::format("{} is {:.6g}, expected a whole number from {} to {}", key, *value, low, high));
  return value ? std::optional(static_cast<int>(*value)) : std::nullopt;
}

std::optional<std::uint64_t> KeyValues::seed(std::string_view key) {
  const auto given = text(key);
  if (!given) return {};
  std::uint64_t value{};
  const auto* end = given->data() + given->size();
  const auto [stop, status] = std::from_chars(given->data(), end, value);
  if (status != std::errc{} || stop != end)
    fail(fmt::format("{} is '{}', expected a whole number of 0 or more", key, printable(*given)));
  return value;
}

std::optional<bool> KeyValues::choice(std::string_view key, std::string_view yes,
                                      std::string_view no) {
  const auto word = text(key);
  if (word && *word != yes && *word != no)
    fail(fmt::format("{} is '{}', expected {} or {}", key, printable(*word, 20), yes, no));
  return word ? std::optional(*word == yes) : std::nullopt;
}

void KeyValues::finish() const {
  for (const auto& [key, value] : values_) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    const auto near = nearest(key, std::vector<std::string_view>(known_.begin(), known_.end()));
    fail(fmt::format("unknown key '{}'; {}accepted are {}", printable(key, 20),
                     near ? fmt::format("did you mean '{}'? ", *near) : "",
                     fmt::join(known_, ", ")));
  }
}

void KeyValues::fail(const std::string& message) const { refuse(place_, message); }

}  // namespace hydrapod::base
