#pragma once
/// Another sample rate, without aliases.
///
/// Bandlimited interpolation: y(t) = Σ x_k h(t − k T), h a sinc that is cut off at the lower of the
/// two Nyquist frequencies under a Kaiser window. Up to 0.9 of that frequency the response is 1
/// within 1e-5; from there to the frequency itself it falls, and beyond it is below −100 dB. The
/// phase is zero: nothing is delayed. At both ends the record is taken to go on with its first and
/// last sample. A missing sample (NaN) stands for the last good one in the sum, and the output
/// samples nearest to it are missing.
///
/// Source: R. E. Crochiere, L. R. Rabiner, Multirate Digital Signal Processing, 1983, sect. 4.3.

#include <functional>
#include <memory>

#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

class Resampler {
 public:
  using Sink = std::function<void(const Eigen::Ref<const Samples>&)>;

  /// Throws std::invalid_argument for rates that are not positive or more than 1:10000 apart.
  Resampler(std::size_t channels, double from_rate, double to_rate, Sink sink);
  ~Resampler();
  Resampler(const Resampler&) = delete;
  Resampler& operator=(const Resampler&) = delete;

  void add(const Eigen::Ref<const Samples>& samples);
  /// The samples near the end; the last one is not later than the last that came in.
  void finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hydrapod::data
