#pragma once
/// The algorithms of C++20 on whole ranges that the library uses and Debian's emscripten lacks
/// (libc++ 13). Given to every source of the core with -include; nothing else includes it.

#include <version>

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 15000

#include <algorithm>
#include <functional>
#include <iterator>
#include <ranges>

namespace std::ranges {  // NOLINT(cert-dcl58-cpp): what the standard says is there

template <class Range, class Value, class Projection = identity>
auto find(Range&& range, const Value& value, Projection projection = {}) {
  return std::find_if(std::begin(range), std::end(range), [&](const auto& item) {
    return std::invoke(projection, item) == value;
  });
}

template <class Range, class Test, class Projection = identity>
auto find_if(Range&& range, Test test, Projection projection = {}) {
  return std::find_if(std::begin(range), std::end(range), [&](const auto& item) {
    return std::invoke(test, std::invoke(projection, item));
  });
}

template <class Range, class Test, class Projection = identity>
bool any_of(Range&& range, Test test, Projection projection = {}) {
  return ranges::find_if(range, test, projection) != std::end(range);
}

template <class Range, class Test, class Projection = identity>
bool all_of(Range&& range, Test test, Projection projection = {}) {
  return !ranges::any_of(
      range, [&](const auto& item) { return !std::invoke(test, item); }, projection);
}

template <class Range, class Value, class Projection = identity>
auto count(Range&& range, const Value& value, Projection projection = {}) {
  return std::count_if(std::begin(range), std::end(range), [&](const auto& item) {
    return std::invoke(projection, item) == value;
  });
}

template <class Range, class Output>
void move(Range&& range, Output output) {
  std::move(std::begin(range), std::end(range), output);
}

}  // namespace std::ranges

#endif
