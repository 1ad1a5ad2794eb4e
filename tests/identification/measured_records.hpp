#pragma once
/// Records measured as a user does it, without any option: written to files and read again.

#include <string>
#include <vector>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/identification/responses.hpp"
#include "support/run_program.hpp"

namespace hydrapod::identification {

inline Measurement measured(const std::vector<data::Record>& list,
                            const MeasureOptions& options = {}) {
  const test::TemporaryFolder folder;
  std::vector<std::string> files;
  for (const auto& record : list) {
    files.push_back(folder / ("run" + std::to_string(files.size()) + ".h5"));
    data::write_record(files.back(), record, data::RecordFormat::hdf5);
  }
  data::RecordSet records(files);
  return measure_responses(records, options);
}

}  // namespace hydrapod::identification
