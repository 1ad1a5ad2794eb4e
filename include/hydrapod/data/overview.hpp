#pragma once
/// What a look at a record tells: levels, clipping, drop-outs, spectra.

#include <cstdint>
#include <memory>
#include <vector>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/data/spectrum.hpp"

namespace hydrapod::data {

struct ChannelOverview {
  std::int64_t samples{};      ///< that are there
  std::int64_t missing{};      ///< NaN: drop-outs
  std::int64_t infinite{};     ///< ±∞; in no other number here
  double mean{};               ///< [unit], of the samples that are there
  double rms{};                ///< about the mean [unit]
  double lowest{}, highest{};  ///< [unit]
  double peak{};               ///< largest distance from the mean [unit]
  /// Samples in runs of three or more at the lowest or highest value: a sensor or converter at the
  /// end of its range. A signal of few steps has such runs as well.
  std::int64_t at_limit{};
  /// Longest run of one value [samples]: a transmission that stands still. 0 for a constant
  /// channel.
  std::int64_t longest_hold{};
  bool constant{};
  double strongest_frequency{};  ///< of the spectrum above f = 0 [Hz]; 0 without one
};

struct RecordOverview {
  std::int64_t samples{};
  double duration{};  ///< [s]
  std::vector<ChannelOverview> channels{};
  Spectrum spectrum{};
};

/// Takes blocks one after the other; memory does not grow.
class OverviewBuilder {
 public:
  /// `segment`: samples per segment of the spectra, see WelchSpectrum.
  OverviewBuilder(const RecordHeader& header, std::size_t segment);
  ~OverviewBuilder();

  void add(const Eigen::Ref<const Samples>& samples);
  [[nodiscard]] RecordOverview result() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Samples per segment for spectra of `header`: lines about half a hertz apart, fewer where the
/// record is short.
std::size_t default_segment(const RecordHeader& header, std::optional<std::int64_t> samples);

}  // namespace hydrapod::data
