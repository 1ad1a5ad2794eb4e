#pragma once
/// Numbers with what they are known to, as people write them.

#include <string>

namespace hydrapod::diagnosis {

/// "0.841 ± 0.012 MN/m", "1.23 GPa" (deviation 0 or not finite), "14.2 ± 0.3 t"; as many digits as
/// the deviation leaves, else four.
std::string amount_text(double value, double deviation, const std::string& unit);

}  // namespace hydrapod::diagnosis
