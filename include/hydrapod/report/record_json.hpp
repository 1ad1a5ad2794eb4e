#pragma once
/// A record's overview as JSON; the fields are listed in docs/howto/json.md.

#include <string>

#include "hydrapod/data/overview.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// What `hydrapod record show FILE --format json` prints. `reader` must have been read to its end.
Json record_json(const std::string& file, const data::RecordReader& reader,
                 const data::RecordOverview& overview, bool with_spectra);

}  // namespace hydrapod::report
