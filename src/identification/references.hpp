#pragma once
/// Which outputs together see what all see. Private to the module.

#include <vector>

#include "names.hpp"

namespace hydrapod::identification {

/// Numbers of outputs, ascending: the one with the largest power that is not yet explained comes
/// next. `S`: spectra of outputs at lines, of which every one counts alike.
std::vector<int> choose_references(const std::vector<MatrixXcd>& S, Index most);

}  // namespace hydrapod::identification
