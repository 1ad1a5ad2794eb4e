#pragma once
/// Samples of a channel that stand still because they were not measured: a cable was off, a sensor
/// or its amplifier was dead. Private to the module.
///
/// Signals stand still too: the steps of a coarse or slow channel, what comes before the excitation
/// begins, the force between hits. So a run of samples at one value is no signal only where
///
/// - it is longer than such runs in this channel by far,
/// - the channel moves by much more than its resolution,
/// - it moves as ever right before and right after the run, and
/// - what moves the channel goes on during the run: all inputs for an output, the outputs for a
///   single input, all other outputs where there are no inputs.
///
/// Where all channels stand still at once, the recorder dropped out or the machine came to rest. It
/// dropped out where the outputs jump to the value at which they stand, or stand away from their
/// mean and jump from there. Outputs at rest may begin with a jump too (accelerations under a force
/// that begins), but not from anywhere else than their mean.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// Samples at one value in succession.
class LongestHold {
 public:
  using Column = Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  /// Shorter ones are not looked for.
  static constexpr Eigen::Index least = 64;
  void add(const Column& samples);
  [[nodiscard]] std::int64_t samples() const { return longest_ >= least ? longest_ : 0; }

 private:
  double last_{std::numeric_limits<double>::quiet_NaN()};
  std::int64_t run_{}, longest_{};
};

struct HeldOptions {
  /// Samples of a run ≥ least, and ≥ of_usual · the mean length of all runs, the held ones aside.
  std::int64_t least{LongestHold::least};
  double of_usual{200.0};
  double of_step{20.0};       ///< RMS of the channel ≥ of_step · its least step
  double beside{0.1};         ///< RMS beside the run ≥ that of the channel, times this
  double beside_share{0.25};  ///< … in so much of its length on either side
  std::int64_t least_beside{32}, most_beside{4096};
  double goes_on{0.25};  ///< power during the run ≥ that at all times, times this
  /// Of an input, which may be meant so: longer, fewer, with outputs that do not decay, and in a
  /// record in which it moves most of the time.
  double of_usual_input{2000.0}, outputs_go_on{0.5}, moves{0.3};
  std::size_t most_of_input{3};
  std::size_t most{1000};  ///< runs that are looked at, the longest ones
  /// Of all channels at once, which hardly any other reason has, fewer of the usual ones are
  /// enough. The mean square of the jumps of the outputs at one end > jumps · their variance: where
  /// channels drop out anywhere in their motion, that is 1.
  double of_usual_of_all{16.0}, jumps{0.1};
  /// A channel with a share beyond that has no samples at all.
  double too_much{0.7};
};

struct Held {
  std::vector<data::RecordSet::Stretch> stretches{};
  std::vector<data::ResponseWarning> warnings{};  ///< one per channel
};

/// Is a run of `spectra`, those of all samples, long enough?
bool may_be_held(const CrossSpectra& spectra);

/// `used`: the channels of the record that `choice` numbers.
Held find_held(data::RecordSet& records, const std::vector<std::size_t>& used,
               const ChannelChoice& choice, const HeldOptions& options = {});

}  // namespace hydrapod::identification
