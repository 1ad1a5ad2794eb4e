#pragma once
/// From the command line's options to identified modes and their comparison with a model: what
/// `hydrapod identify` and `hydrapod report --measured` share.

#include "hydrapod/identification/bootstrap.hpp"
#include "hydrapod/identification/second_opinion.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/observation/targets.hpp"
#include "hydrapod/report/mode_comparison.hpp"

namespace hydrapod::cli {

struct IdentificationArguments {
  MeasurementArguments measurement{};
  std::string from{}, to{};
  int order{40};
  double highest_damping{30.0};  ///< [%]
  std::string against{"auto"};
};

/// All but the files.
void add_identification_options(Command command, IdentificationArguments& arguments);

/// Throws base::InputError for options that make no sense: before the work is done.
void check_identification(const IdentificationArguments& arguments);

std::optional<double> upper_frequency(const IdentificationArguments& arguments);  ///< --to [Hz]

/// What is identified, and what is known of where it comes from.
struct IdentifiedSource {
  identification::FrequencyResponses responses{};
  std::optional<data::RecordSet> records{};  ///< where it is records
  std::string date{};
  std::optional<data::Experiment> experiment{};
  std::string frame{"outputs as measured"};  ///< how they were brought to directions
};

/// The system that the inputs of a record of the rig see: the plant from the drives on, else the
/// machine under its controller. None for other records (`experiment` null: not known).
std::optional<observation::Observed> seen_in_rig(
    const identification::FrequencyResponses& responses, const data::Experiment* experiment);

/// Records, JSON of `hydrapod frf` or a Universal File; warnings go to stderr.
IdentifiedSource identified_source(const IdentificationArguments& arguments);

/// With a progress line; warnings go to stderr.
identification::Identification identified_modes(const IdentificationArguments& arguments,
                                                const IdentifiedSource& source);

/// Scatter over `resamples` draws of the record's averages; none with a warning where the record
/// does not give it. Ctrl-C ends the draws and keeps what was drawn.
std::optional<identification::BootstrapScatter> bootstrap_scatter(
    const IdentificationArguments& arguments, IdentifiedSource& source,
    const identification::Identification& result, int resamples);

/// What the eigensystem realisation says of the same responses; empty with a warning where it
/// cannot be had.
std::vector<std::optional<identification::SecondOpinion>> second_opinions(
    const IdentificationArguments& arguments, const IdentifiedSource& source,
    const identification::Identification& result);

/// Modes beside those of the machine that is known; none where there is no machine. A model that
/// cannot be computed is a warning: the modes were found all the same.
std::optional<report::ComparedModes> compared_modes(const IdentificationArguments& arguments,
                                                    const IdentifiedSource& source,
                                                    const identification::Identification& result);

}  // namespace hydrapod::cli
