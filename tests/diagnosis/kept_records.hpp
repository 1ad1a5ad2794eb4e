#pragma once
/// Measurements of a blind series kept between runs, for those who work on what comes after them.
///
/// With HYDRAPOD_RECORDS=FOLDER in the environment the frequency responses of every record are
/// written there, in full, and read from there when they are needed again: the rig is run once. Of
/// case C of setting S (repetition 1000 (S + 1) + C):
///
///     S-C.json             machine, overrides, what was planted, poses, model of the fault
///     S-C-POSE.frf.json    what `hydrapod frf --format json` writes
///     S-C-POSE.modes.json  the same of `hydrapod identify`
///
/// Without the variable nothing is kept or read.

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>

#include "blind_series.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::test {

inline std::optional<std::filesystem::path> records_folder() {
  const char* const folder = std::getenv("HYDRAPOD_RECORDS");
  if (folder == nullptr || *folder == '\0') return {};
  return folder;
}

inline std::string kept_name(const BlindCase& test) {
  return fmt::format("{}-{:02}", test.repetition / 1000 - 1, test.repetition % 1000);
}

inline report::Json case_json(const BlindCase& test) {
  return {{"machine", test.machine}, {"design", test.design}, {"fault", test.fault},
          {"planted", test.planted}, {"poses", test.poses},   {"kind", dynamics::name(test.kind)}};
}

/// The responses of a case at a pose: kept ones, else those of `measure`.
inline identification::FrequencyResponses kept_responses(
    const BlindCase& test, const std::string& pose,
    const std::function<identification::FrequencyResponses()>& measure) {
  const auto folder = records_folder();
  if (!folder) return measure();
  const auto path = *folder / fmt::format("{}-{}.frf.json", kept_name(test), pose);
  if (std::filesystem::exists(path))
    return report::responses_from_json(report::Json::parse(read_text(path)), path.string());
  const auto responses = measure();
  std::filesystem::create_directories(*folder);
  base::write_file_whole(*folder / (kept_name(test) + ".json"), case_json(test).dump(2) + "\n");
  base::write_file_whole(path, report::responses_json(responses).dump() + "\n");
  return responses;
}

inline void keep_modes(const BlindCase& test, const std::string& pose,
                       const identification::Identification& found) {
  if (const auto folder = records_folder())
    base::write_file_whole(*folder / fmt::format("{}-{}.modes.json", kept_name(test), pose),
                           report::identification_json(found).dump() + "\n");
}

}  // namespace hydrapod::test
