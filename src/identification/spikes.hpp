#pragma once
/// Samples that are no signal: hits on a cable, glitches of a converter. Private to the module.
///
/// A spike of four samples or fewer leaves the median of the nine samples around it where it is.
/// So the deviation from it,
///
///     d_t = |x_t − median(x_(t−4) … x_(t+4))|,
///
/// is all of a spike, none of a step, and little of whatever goes on for longer. A spike is no
/// matter of scale or colour of the signal: its d is compared with those beside it, before and
/// after, and with the RMS of all other samples. What a hammer does looks alike in its force, and
/// in outputs near it; but then the outputs ring: where any channel moves more after than before,
/// nothing is a spike. Nor is what two channels show at once.

#include <compare>
#include <vector>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

struct SpikeOptions {
  /// d of a spike > of_usual · d of all but `rare` of the samples within `reach` on either side,
  /// the larger one. At 30, one of 60 records with Student's t of five degrees of freedom had one.
  double of_usual{60.0}, rare{0.02};
  std::int64_t reach{256}, least_reach{32};
  /// … and > of_rms · the RMS of all other samples, and > of_step · the least step between samples:
  /// the last digit of a channel that hardly moves is no spike.
  double of_rms{30.0}, of_step{20.0};
  /// Looked at is what is > looked_at · the RMS of all samples from their mean. A spike that has
  /// most of the power of n samples is √n times their RMS.
  double looked_at{5.0};
  /// What is within the nine samples around a spike and > beside · what is usual is part of it.
  double beside{6.0};
  /// The spread of a channel after > rises · that before: it was hit.
  double rises{3.0};
  /// More in one channel of a file are its signal.
  std::size_t most{40};
  /// Looked for where half the range of a channel > conspicuous · its RMS: below, spikes have less
  /// than a share of the power that matters.
  double conspicuous{8.0};
  /// Samples between those of two channels ≤ at_once: a blow that the outputs follow at once.
  std::int64_t at_once{4};
  int rounds{8};  ///< each finds what is less than 1/√n as large, of n samples
};

struct SpikePlace {
  std::size_t file{};
  std::int64_t sample{};
  std::size_t channel{};
  friend auto operator<=>(const SpikePlace&, const SpikePlace&) = default;
};

struct Spike {
  SpikePlace place{};
  double height{};  ///< d by what is usual; 0: of a spike beside it
};

/// May one of the channels have spikes? `spectra`: those of all samples.
bool may_have_spikes(const CrossSpectra& spectra, const SpikeOptions& options = {});

/// Of all files, in channels of the record.
std::vector<Spike> find_spikes(data::RecordSet& records, const std::vector<std::size_t>& channels,
                               const SpikeOptions& options = {});

std::vector<data::RecordSet::Stretch> stretches_of(const std::vector<Spike>& spikes);

/// The same again and again, from then on without those that were found, which the records are told
/// to leave out: a large one hides smaller ones. Ascending.
std::vector<Spike> leave_out_spikes(data::RecordSet& records,
                                    const std::vector<std::size_t>& channels,
                                    const SpikeOptions& options = {});

/// One per channel.
std::vector<data::ResponseWarning> warnings_of_spikes(const std::vector<Spike>& spikes,
                                                      const data::RecordHeader& header);

}  // namespace hydrapod::identification
