#pragma once
/// The words between page and program.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/studio/jobs.hpp"
#include "hydrapod/studio/open_machine.hpp"

namespace hydrapod::studio {

/// Without its result.
report::Json job_json(const Job& job);
/// With `result`, `picture` (SVG) and the arguments of its command.
report::Json whole_job_json(const Job& job);

report::Json edits_json(const std::vector<PlannedEdit>& edits);

struct ValueChange {
  report::Json values{};
  std::vector<std::string> assignments{};
  std::string from{};  ///< the page that changed them
};
/// Throws base::InputError for anything else than the page writes.
ValueChange values_in(const report::Json& asked);

/// A number in a path, 0 for anything else.
std::uint64_t number_in(std::string_view text);

/// Text that a browser wrote with encodeURIComponent; broken signs stay as they are.
std::string decoded(std::string_view text);

}  // namespace hydrapod::studio
