#include "measured_records.hpp"

namespace hydrapod::identification {

Measurement measured(const std::vector<data::Record>& list, const MeasureOptions& options) {
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
