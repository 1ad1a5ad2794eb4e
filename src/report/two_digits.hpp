#pragma once
/// Numbers in sentences. Private to the module.

#include <string>

namespace hydrapod::report {

/// A share in per cent, which two digits would show as 1e+02 from 99.5 on.
std::string two_digits(double share);

}  // namespace hydrapod::report
