#pragma once
/// Pictures of records: each channel over time beside its power spectral density.

#include <string>
#include <vector>

#include "hydrapod/data/processing.hpp"

namespace hydrapod::report {

/// Lowest and highest sample of each of up to a few thousand stretches of equal length, for a
/// record of any length: stretches grow as samples come.
class TraceBuilder {
 public:
  explicit TraceBuilder(std::size_t channels);
  void add(const Eigen::Ref<const data::Samples>& samples);

  struct Stretch {
    std::vector<double> low{}, high{};  ///< per channel; NaN where all samples are missing
  };
  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  [[nodiscard]] std::int64_t samples_per_stretch() const { return length_; }

 private:
  void halve();

  std::size_t channels_;
  std::int64_t length_{1};
  std::int64_t in_last_{};
  std::vector<Stretch> stretches_{};
};

/// Most channels of one picture.
inline constexpr std::size_t most_plotted_channels = 24;

/// Draws the channels `shown` (at most most_plotted_channels) to `path`, .svg, .png or .pdf. Throws
/// base::InputError, base::ComputationError as plot_bode does.
void plot_record(const data::RecordHeader& header, const TraceBuilder& traces,
                 const data::RecordOverview& overview, const std::vector<std::size_t>& shown,
                 const std::string& path);

}  // namespace hydrapod::report
