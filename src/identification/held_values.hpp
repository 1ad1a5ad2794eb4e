#pragma once
/// Channels of a slow logger that are read more quickly than it measures: each of their values
/// stays for h samples. Private to the module.
///
/// What such a channel shows is y at every h-th sample, as a comb of pulses, times
///
///     D(s) = (1 − e^(−shT))/(h (1 − e^(−sT))),
///
/// the transform of the hold: a delay of (h − 1)/2 samples, and zeros at multiples of its own rate.
/// The comb folds what is above half of its rate, fs/2h. Of an output that is noise, where the
/// input is random and measured at the full rate: folded lines do not go together with those that
/// they fall onto. So H/D is right, beyond half of its own rate too. Under periodic excitation
/// folded lines stay where they fall. And of an input that was measured no faster, what is above
/// and what is below cannot be told apart. An input that is held where outputs are not is the
/// output of a controller, and was so.

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

struct HeldValueOptions {
  int enough{4096}, least{64};  ///< changes of a channel that are looked at, and needed
  double shorter{0.02};         ///< all values last h or h + 1 samples, but for so many,
  double alike{0.9};            ///< … and so many do: others come from equal values in succession
  double of_step{2.0};  ///< median of the changes > of_step · the least: else it is a ramp in steps
  /// Outputs whose values last longer than much_slower · those of the fastest output are left out:
  /// they would cost the others the lines at which their D is nearly zero.
  double much_slower{4.0};
  double least_hold{0.1};  ///< lines with |D| < least_hold of an output are left out
  double below_own{0.9};   ///< of inputs: lines up to below_own · half of its own sample rate
};

/// Samples that each value of a channel lasts.
class ValueHold {
 public:
  using Column = Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  void add(const Column& samples);
  /// 1: it is not held.
  [[nodiscard]] double samples() const;

 private:
  static constexpr std::size_t longest = 256;
  HeldValueOptions options_{};
  std::array<int, longest + 1> lengths_{};  ///< how many values lasted so long
  int changes_{};
  std::size_t run_{};  ///< 0: it is not known how it began
  double last_{std::numeric_limits<double>::quiet_NaN()};
  std::vector<double> steps_{};  ///< sizes of the changes
};

/// Leaves out outputs that are much slower than others; a warning for each channel that is held.
void leave_out_slow(const CrossSpectra& spectra, ChannelChoice& choice,
                    std::vector<data::ResponseWarning>& warnings,
                    const HeldValueOptions& options = {});

/// Responses of channels of `spectra` as they would be without the hold.
void without_hold(const CrossSpectra& spectra, FrequencyResponses& responses,
                  const HeldValueOptions& options = {});

}  // namespace hydrapod::identification
