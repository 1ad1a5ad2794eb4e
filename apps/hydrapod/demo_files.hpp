#pragma once
/// What `hydrapod demo` does, without the command line: hydrapod-demo, which a fresh clone builds
/// first, has nothing else.

#include <string>

namespace hydrapod::cli {

/// Modes of three machines on the terminal; machine files, Bode diagrams and reports in `folder`,
/// which is made if it is not there. Throws base::InputError where that fails.
void write_demo(const std::string& folder);

inline constexpr const char* demo_folder = "hydrapod-demo";

}  // namespace hydrapod::cli
