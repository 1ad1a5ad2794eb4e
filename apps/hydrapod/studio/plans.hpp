#pragma once
/// What a page asks for, as the arguments of a command.

#include <string>

#include "hydrapod/studio/jobs.hpp"
#include "hydrapod/studio/open_machine.hpp"
#include "hydrapod/studio/records.hpp"

namespace hydrapod::studio {

struct PlanContext {
  const OpenMachine& machine;
  const Records& records;
  TemporaryFolder& folder;
};

/// `asked`: { "kind": "identify", "pose": 0, "fields": { "records": ["record:0"], "from": "2 Hz" },
/// "replace": false, "then": ["diagnose"] }. A file is a path of this computer, relative to the
/// folder that the studio was started in, or "record:N". A result is a file only where the page
/// says so; it never takes the place of another without `replace`.
///
/// Throws base::InputError for what no job has.
JobPlan job_plan(const report::Json& asked, const PlanContext& context);

/// Absolute. Throws base::InputError for an empty text.
std::string absolute_path(const std::string& text, const std::string& what);

}  // namespace hydrapod::studio
