#pragma once
/// Measured modes beside a model's, for people and programs.

#include "hydrapod/identification/identify.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "hydrapod/report/bode.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// What was compared with what.
struct ComparedModes {
  observation::ModeComparison result{};
  std::vector<std::string> labels{};  ///< of the model's modes
  observation::Observed source{};
  dynamics::ModelKind kind{};
  std::string machine{}, pose{};  ///< names
};

/// Identified modes beside those of the machine. Throws as observation::observe. The names of
/// machine and pose are the caller's to fill in.
ComparedModes compared_with(const identification::Identification& measured,
                            const observation::ComparisonFrame& frame, dynamics::ModelKind kind,
                            observation::Observed source, double highest_damping = 0.3);

/// "not found", "the platform does not feel it", "the outputs do not see it".
std::string_view words(observation::Unpaired reason);

/// "Heavy motion platform, pose neutral, guide model: mechanics, hydraulics, …".
std::string comparison_heading(const ComparedModes& compared);

/// `machine`, `pose`, `model`, `source`, `pairs[]`, `not_in_model[]`, `not_measured[]`,
/// `outputs[]`, `cross_mac`.
Json comparison_json(const ComparedModes& compared, const identification::Identification& measured);

/// A line per pair, then per mode that has no partner.
std::string comparison_csv(const ComparedModes& compared,
                           const identification::Identification& measured);

/// MAC of measured and model modes that were paired or left in the band. Throws as plot_bode; and
/// base::InputError where no shapes could be compared.
void plot_cross_mac(const ComparedModes& compared, const identification::Identification& measured,
                    const PlotText& text, const std::string& path);

}  // namespace hydrapod::report
