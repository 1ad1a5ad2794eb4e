#pragma once
/// How records are read: what is missing in them filled, tones subtracted, channels at one clock.
/// Private to the module.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "beginning.hpp"
#include "channel_plan.hpp"
#include "gaps.hpp"
#include "hydrapod/identification/responses.hpp"
#include "tones.hpp"
#include "two_clocks.hpp"

namespace hydrapod::identification {

/// How the records are read.
struct Reading {
  Plan plan{};  ///< of the channels that are used
  SpectrumOptions spectrum{};
  std::vector<std::size_t> used{};   ///< channels
  std::int64_t settling{}, total{};  ///< samples
  GapPlan gap_plan{};
  std::shared_ptr<const GapModel> gaps{};   ///< none: samples are taken as they are
  std::vector<Tone> tones{};                ///< that are subtracted
  std::optional<ClockDifference> clocks{};  ///< by which outputs are corrected
  bool inputs_cut_off{};                    ///< one or more reached the limit of its range
  std::optional<Swept> sweep{};  ///< where the excitation is one: all that the inputs pass
};

/// Is what needs the samples and not the spectra done sooner on a thread of its own?
[[nodiscard]] bool is_worth_a_thread(const Reading& reading);

struct Streamed {
  std::int64_t samples{};
  bool whole{};            ///< that is all
  double unknown_share{};  ///< see GapFiller
};

[[nodiscard]] std::int64_t settling_samples(const data::RecordSet& records,
                                            const MeasureOptions& options);

/// `plan`: its choice becomes one of the channels that are used.
Reading plan_reading(data::RecordSet& records, Plan& plan, const MeasureOptions& options,
                     Beginning& beginning);

/// begin(file) where a record begins, add(samples) for all its samples, all channels, filled and
/// without tones where the reading says so.
Streamed stream_read(data::RecordSet& records, const Reading& reading,
                     const numerics::Progress& progress,
                     const std::function<void(std::size_t)>& begin,
                     const std::function<void(const Eigen::Ref<const data::Samples>&)>& add);

/// Reads all files into m.spectra. Where samples are missing they are filled, and where outputs
/// have another clock than inputs they are brought to theirs; it is said.
void read_spectra(data::RecordSet& records, Reading& reading, const numerics::Progress& progress,
                  Measurement& m);

/// Finds tones in records whose spectra are known. Of a loop that rings there is a warning instead.
std::vector<Tone> tones_in(data::RecordSet& records, const Reading& reading, const Plan& plan,
                           const CrossSpectra& spectra,
                           std::vector<data::ResponseWarning>& warnings);

/// Reads once more, without the tones, where there are some.
void subtract_found_tones(data::RecordSet& records, const Plan& plan, Reading& reading,
                          Measurement& m);

}  // namespace hydrapod::identification
