#pragma once
/// A record's overview as JSON; the fields are listed in docs/howto/json.md.

#include <string>

#include "hydrapod/data/processing.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// data::experiment_json as an object.
Json experiment_object(const data::Experiment& experiment);

/// What `hydrapod record show FILE --format json` prints. `record` must have been read to its end.
Json record_json(const data::RecordSet& record, const data::RecordOverview& overview,
                 bool with_spectra);

}  // namespace hydrapod::report
