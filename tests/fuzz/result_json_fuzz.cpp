/// JSON of `hydrapod identify`, `frf` and `modes` as it is read again: an InputError, or results
/// whose JSON is read alike, and that can be made targets of a machine.

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/observation/targets.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "json_mutator.hpp"

namespace {

using namespace hydrapod;
using report::Json;

const model::Machine& machine() {
  static const model::Machine sound =
      model::parse_machine(model::starter_machine_file(), "starter.toml").machine;
  return sound;
}

template <class Use>
void also_computed(const Use& use) {
  try {
    use();
  } catch (const base::ComputationError&) {
  }
}

void read_modes(const Json& json) {
  const auto result = report::identification_from_json(json, "modes.json");
  for (const auto& warning : result.warnings) report::warning_text(warning);
  report::identified_modes_csv(result);
  also_computed(
      [&] { observation::measured_modes(identification::modal_results(result), machine(), {}); });
}

void read_responses(const Json& json) {
  const auto responses = report::responses_from_json(json, "frf.json");
  for (const auto& warning : responses.warnings) report::warning_text(warning);
  const Json written = report::responses_json(responses);
  const Json again = report::responses_json(report::responses_from_json(written, "again.json"));
  if (again.dump() != written.dump()) {  // what is not a number is null there
    std::fprintf(stderr, "%s\n", Json::diff(written, again).dump().c_str());
    std::abort();
  }
  observation::measured_responses(responses, machine(), {});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Json json = Json::parse(fuzz::text_of(data, size), nullptr, false);
  if (json.is_discarded()) return 0;
  fuzz::accepted([&] { report::record_origin_from_json(json, "result.json"); });
  fuzz::accepted([&] { read_modes(json); });
  fuzz::accepted([&] { read_responses(json); });
  fuzz::accepted([&] {
    report::pose_from_json(json, "modes.json");
    report::modes_from_json(json, "modes.json");
  });
  return 0;
}
