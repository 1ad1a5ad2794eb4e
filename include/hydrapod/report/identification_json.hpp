#pragma once
/// Frequency responses and identified modes as JSON; the fields are documented in
/// docs/howto/json.md.

#include "hydrapod/identification/bootstrap.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/identification/realisation.hpp"
#include "hydrapod/identification/cross_check.hpp"
#include "hydrapod/observation/targets.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// `inputs[]`, `outputs[]`, `frequency_hz[]`, `response[output][input]` with `re[]`, `im[]` and
/// `deviation[]`, coherences, condition, and all that responses_from_json needs to give the same
/// responses again.
Json responses_json(const identification::FrequencyResponses& responses);

/// Responses out of such JSON. Throws base::InputError naming the field that is missing or does not
/// fit; `file` is what messages call it.
identification::FrequencyResponses responses_from_json(const Json& json, const std::string& file);

/// Where responses come from: `title`, `date`, `notes`, `machine_file` of the record; and back, if
/// `json` has it as `record`.
Json record_origin_json(const data::RecordHeader& header);
std::optional<data::RecordHeader> record_origin_from_json(const Json& json,
                                                          const std::string& file);

/// `modes[]`, `heavily_damped[]`, `left_out[]`, `mac`, `band_hz`, `stabilisation[]`, `clusters[]`,
/// `indicator`, `fit_error`, `misfit`, `warnings[]`.
Json identification_json(const identification::Identification& result);
/// Reads it: modes, heavily damped poles, inputs, outputs and lines of the responses. The chart,
/// the clusters and the model stay empty.
identification::Identification identification_from_json(const Json& json, const std::string& file);

/// Adds `cross_check` to each of `modes[]` of identification_json(): null where there is none.
void add_cross_checks(const std::vector<std::optional<identification::CrossCheck>>& cross_checks,
                         Json& json);

/// Adds `bootstrap` to each of `modes[]`, and `bootstrap_resamples`.
void add_bootstrap(const identification::BootstrapScatter& scatter, Json& json);

/// Frequency, then re, im and deviation of every entry, then multiple coherence and condition.
std::string responses_csv(const identification::FrequencyResponses& responses);

/// `modes` of an output-only record, and the same as lines.
Json output_only_json(const std::vector<identification::OutputOnlyMode>& modes);
std::string output_only_csv(const std::vector<identification::OutputOnlyMode>& modes);

/// One line per mode. `observed`: the system that was measured, where it is known.
std::string identified_modes_csv(const identification::Identification& result,
                                 std::optional<observation::Observed> observed = {});

/// What such a table holds.
struct ListedModes {
  data::ModalResults modes{};  ///< and outputs; deviations of shapes are zero
  std::optional<observation::MotionAgainst> against{};
  std::optional<observation::Observed> observed{};
};
/// By its title row.
bool is_identified_modes_csv(const std::string& path);
/// Throws base::InputError with file:line:column.
ListedModes identified_modes_from_csv(const std::string& path);

}  // namespace hydrapod::report
