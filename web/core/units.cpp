#include "units.hpp"

#include <cstdlib>
#include <map>
#include <stdexcept>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::page {

/// By SI unit and unit.
static std::map<std::string, std::map<std::string, double>>& scales() {
  static std::map<std::string, std::map<std::string, double>> known;
  return known;
}

void know_units(const report::Json& given) { scales() = given.get<std::map<std::string, std::map<std::string, double>>>(); }

}  // namespace hydrapod::page

namespace hydrapod::base {

double quantity(std::string_view text, std::string_view unit) {
  const std::string all(text);
  char* end = nullptr;
  const double number = std::strtod(all.c_str(), &end);
  const auto of_dimension = page::scales().find(std::string(unit));
  if (end != all.c_str() && of_dimension != page::scales().end()) {
    const auto scale = of_dimension->second.find(std::string(trimmed(end)));
    if (scale != of_dimension->second.end()) return number * scale->second;
  }
  throw std::invalid_argument(all + " has no unit that the page knows for " + std::string(unit));
}

}  // namespace hydrapod::base
