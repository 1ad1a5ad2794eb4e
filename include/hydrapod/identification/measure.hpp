#pragma once
/// From record files to frequency responses without a choice to make.
///
/// Inputs are the channels with the role drive where there are as many excitations that are
/// commands (not forces): the modes are then those of the machine without its controller. Else they
/// are the channels with the role excitation, else those with the role drive. Outputs are those
/// with the role response; among sensors of several kinds the platform's motion in six directions,
/// else the six leg lengths. Estimator: H1 from excitations; from drives, the instrumental estimate
/// where there are as many excitations, else H1. Block length: a power of two, so that there are
/// some 4 p + 8 blocks side by side for p inputs. Excitation that repeats exactly is averaged over
/// whole periods.

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/identification/directions.hpp"
#include "hydrapod/identification/responses.hpp"
#include "hydrapod/numerics/parallel.hpp"

namespace hydrapod::identification {

/// A machine at a pose: brings leg lengths to directions of the platform at Q.
struct PlatformFrame {
  model::Machine machine{};
  spatial::Pose X_BP{};
  spatial::Vector3 p_BQ{};  ///< [m]
};

struct MeasureOptions {
  std::vector<std::string> inputs{}, outputs{}, instruments{};  ///< channel names; empty: by role
  /// Role of the inputs, excitation or drive; default: as said above.
  std::optional<data::Role> input_role{};
  std::optional<Estimator> estimator{};
  std::optional<int> block_length{};  ///< [samples]
  std::optional<double> overlap{};
  Window window{Window::hann};
  std::optional<double> period{};  ///< [s] of the excitation; 0: not periodic; default: found out
  double settling{};               ///< [s] at the beginning of each record that are passed over
  std::optional<PlatformFrame> platform{};  ///< for responses that are the six leg lengths
  /// 6 × `outputs`: makes directions of the platform of them, see platform_from_accelerometers.
  std::optional<Eigen::MatrixXd> outputs_to_platform{};
};

struct Measurement {
  FrequencyResponses responses{};
  CrossSpectra spectra{};
  data::RecordHeader header{};            ///< of the first record
  std::vector<base::Diagnostic> notes{};  ///< of the readers
  std::int64_t samples{};                 ///< of all records that were read
  bool interrupted{};
  bool from_legs{};            ///< the responses were brought from leg lengths to the platform
  std::vector<int> outputs{};  ///< of the spectra, by measure_outputs
  std::optional<BiasFinding> h1_against_instrument{};  ///< where both could be formed
};

/// The records are averaged together. Where `progress` asks to stop the rest is left
/// unread. Throws base::InputError and base::ComputationError.
Measurement measure_responses(data::RecordSet& records, const MeasureOptions& options,
                              const numerics::Progress& progress = {});

/// The spectra alone, for machines whose excitation was not measured; `outputs` are those that
/// live.
Measurement measure_outputs(data::RecordSet& records, const MeasureOptions& options,
                            const numerics::Progress& progress = {});

/// The record in pieces, for bootstrap.hpp: spectra of groups of neighbouring blocks, formed as
/// measure_responses would, and what is input and output among their channels.
struct GroupedSpectra {
  std::vector<CrossSpectra> groups{};
  ChannelChoice choice{};
  Estimator estimator{Estimator::h1};
};

/// In at most `groups` pieces, each at least two blocks long. Throws as measure_responses, and
/// base::ComputationError for periodic excitation, whose periods are no blocks to draw from.
GroupedSpectra measure_groups(data::RecordSet& records, const MeasureOptions& options, int groups,
                              const numerics::Progress& progress = {});

}  // namespace hydrapod::identification
