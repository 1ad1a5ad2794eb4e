#pragma once
/// Names of the six directions of a 6-vector, linear ones first.

#include <array>
#include <optional>
#include <string_view>

namespace hydrapod::spatial {

inline constexpr std::array<const char*, 6> direction_names{"x", "y", "z", "rx", "ry", "rz"};

/// The name of direction 0 … 5.
constexpr const char* direction_name(int direction) {
  return direction_names.at(static_cast<std::size_t>(direction));
}

/// The direction of that name.
constexpr std::optional<int> direction_from_name(std::string_view name) {
  for (int k = 0; k < 6; ++k)
    if (name == direction_name(k)) return k;
  return std::nullopt;
}

}  // namespace hydrapod::spatial
