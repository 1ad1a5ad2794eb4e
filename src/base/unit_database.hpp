#pragma once
/// UDUNITS-2 behind a lock: what a unit measures and how large it is. Private to base/units.cpp.

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace hydrapod::base {

/// Powers of the base units, radian included: {"m": 1, "s": -2}. Empty: a pure number.
using Dimension = std::map<std::string, int>;

enum class UnitKind {
  scale,        ///< a plain factor
  offset,       ///< has a zero elsewhere, as degC
  logarithmic,  ///< as dB re 1 mW
  timestamp     ///< a time since a date
};

struct Unit {
  UnitKind kind{UnitKind::scale};
  double factor{1.0};  ///< SI value of one of it
  Dimension dimension{};
};

/// The unit that `text` names; none when UDUNITS-2 does not understand it. Throws
/// std::runtime_error when the unit database cannot be read.
std::optional<Unit> find_unit(const std::string& text);

}  // namespace hydrapod::base
