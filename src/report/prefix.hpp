#pragma once
/// Prefixes of SI units. Private to the module.

#include <array>

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

}  // namespace hydrapod::report
