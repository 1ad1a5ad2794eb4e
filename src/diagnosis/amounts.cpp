#include "hydrapod/diagnosis/diagnose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hydrapod::diagnosis {

namespace {

struct Scale {
  double size;
  const char* prefix;
};

/// The prefix that leaves one to four digits before the point.
Scale scale_of(double value, const std::string& unit) {
  const bool prefixed = unit == "N/m" || unit == "Pa" || unit == "N m/rad" || unit == "N s/m";
  const double size = std::abs(value);
  if (unit == "m" && size < 1.0) return {1e-3, "m"};
  if (unit == "m^3" && size < 1.0) return {1e-3, ""};
  if (!prefixed) return {1.0, ""};
  for (const Scale& scale : {Scale{1e9, "G"}, Scale{1e6, "M"}, Scale{1e3, "k"}})
    if (size >= scale.size) return scale;
  return {1.0, ""};
}

}  // namespace

std::string amount_text(double value, double deviation, const std::string& unit) {
  const auto scale = scale_of(value, unit);
  std::string name = unit == "1" ? "" : fmt::format(" {}{}", scale.prefix, unit);
  if (unit == "m^3" && scale.size != 1.0) name = " l";
  const double shown = value / scale.size, spread = std::abs(deviation) / scale.size;
  if (!(spread > 0.0) || !std::isfinite(spread)) return fmt::format("{:.4g}{}", shown, name);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(spread))), 0, 9);
  return fmt::format("{:.{}f} ± {:.{}f}{}", shown, decimals, spread, decimals, name);
}

}  // namespace hydrapod::diagnosis
