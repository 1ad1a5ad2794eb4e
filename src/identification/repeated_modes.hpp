#pragma once
/// Shapes of modes that cannot be told apart. Private to the module.
///
/// Where two poles are equal within their errors any mixture of their shapes fits as well, and the
/// fit returns some complex one. The space that they span is known. If it has a real basis, as
/// that of normal modes has, the shapes are given along outputs: each is 1 at an output of its own,
/// where the others are 0; outputs are chosen by size, in proportion to their responses. They go
/// to the modes in the order of the outputs, unless the shapes that were fitted clearly say
/// another.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Sets `displacement` and `repeated` of such modes; `modes` ascend in frequency.
void untangle_repeated(const FrequencyResponses& responses, std::vector<IdentifiedMode>& modes);

}  // namespace hydrapod::identification
