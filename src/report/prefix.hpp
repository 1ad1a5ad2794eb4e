#pragma once
/// Prefixes of SI units. Private to the module.

#include <algorithm>
#include <array>
#include <string>

namespace hydrapod::report {

struct Prefix {
  double size{1.0};
  const char* name{""};
};

/// The largest prefix that is not above `size`; none below a millionth.
inline Prefix prefix_of(double size) {
  constexpr std::array all{Prefix{1e9, "G"}, Prefix{1e6, "M"},  Prefix{1e3, "k"},
                           Prefix{1.0, ""},  Prefix{1e-3, "m"}, Prefix{1e-6, "µ"}};
  for (const auto& prefix : all)
    if (size >= prefix.size) return prefix;
  return {};
}

/// A unit that fits the numbers: "MPa" for those of millions of Pa.
struct ShownUnit {
  std::string name{};
  double size{1.0};
};

/// `unit`, with a prefix where it takes one and the largest number is below 1 or has five digits
/// before the point.
inline ShownUnit shown_unit(const std::string& unit, double largest) {
  constexpr std::array prefixable{"Pa", "N", "N m", "N/m",  "N m/rad", "m",
                                  "V",  "A", "m/s", "m/s²", "m/s^2",   "W"};
  if (std::ranges::find(prefixable, unit) == prefixable.end()) return {unit};
  if (!(largest > 0.0) || (largest >= 1.0 && largest < 1e4)) return {unit};
  const auto prefix = prefix_of(largest);
  return {prefix.name + unit, prefix.size};
}

}  // namespace hydrapod::report
