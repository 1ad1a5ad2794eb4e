#pragma once
/// Progress for other programs.

namespace hydrapod::cli {

/// Where this stands in the environment, the progress comes as lines "progress 0.4231" on stderr,
/// also where that is no terminal.
inline constexpr const char* progress_variable = "HYDRAPOD_PROGRESS";

}  // namespace hydrapod::cli
