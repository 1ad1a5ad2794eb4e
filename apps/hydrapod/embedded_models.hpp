#pragma once
/// The machine files of models/, carried inside the program.

#include <string_view>

namespace hydrapod::cli {

/// Text of models/`name`. Throws std::out_of_range for a file that was not there when it was built.
std::string_view embedded_model(std::string_view name);

}  // namespace hydrapod::cli
