#pragma once
/// Did a sensor change between parts of a measurement? Private to the module.
///
/// Per output o, with rows h of the responses of the first part and g of another one at a line,
/// M = cov(h) + cov(g), and sums over lines
///
///     S_hh = Σ h M⁻¹ hᴴ − tr M⁻¹ cov(h),   S_gg alike,   S_hg = Re Σ h M⁻¹ gᴴ,
///
/// the output of that part is α = ±√(S_gg/S_hh) times that of the first, with the sign of S_hg.
/// Both sums are those of the responses themselves, so that α does not depend on noise. A mode that
/// wanders between the parts makes |γ| = |S_hg|/√(S_hh S_gg) smaller and leaves √(S_gg/S_hh) as it
/// is; where γ is small, α tells nothing. What most parts agree on is right.
///
/// What a part has in common for all outputs, as a machine whose damping is another at another
/// level has, is no change of a sensor: gains are compared with the median of the outputs.

#include <optional>
#include <vector>

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

struct SensorWatchOptions {
  double chance{1e-4};       ///< of one false alarm in a measurement
  double least_change{0.1};  ///< |α| off by less is no change
  double common{1.5};        ///< gains that outputs have in common count as such up to this factor
  double alike{0.8};         ///< |γ| of a gain …
  double opposite{0.7};      ///< … and of another sign
  /// Deviations of a row below this share of it are not relied upon.
  double finest{0.01};
  /// As WanderOptions::least_excitation, per line, of a part at the level of the whole; of a weaker
  /// one by its own level, down to lowest_level (of the density): below, lines may be leakage.
  double least_excitation{0.5};
  double lowest_level{0.01};
  int fewest_lines{16};
};

class SensorWatch {
 public:
  /// `whole`: the responses of all parts together.
  explicit SensorWatch(const FrequencyResponses& whole, const SensorWatchOptions& options = {})
      : whole_(whole), options_(options) {}

  /// The next part; `label` is given back.
  void add(const FrequencyResponses& part, std::size_t label);

  struct Change {
    std::size_t label{};  ///< of the part
    Eigen::Index output{};
    double factor{};         ///< α by what is right
    std::int64_t outputs{};  ///< that changed
    double deviation{};      ///< of ln |factor|
  };
  /// The largest.
  [[nodiscard]] std::optional<Change> result() const;

 private:
  /// α of an output, and the deviation of ln |α|; NaN: not known.
  struct Ratio {
    double alpha{}, deviation{}, likeness{};
  };
  [[nodiscard]] Ratio ratio_of(const FrequencyResponses& part, const Eigen::VectorXd& level,
                               Eigen::Index output) const;
  [[nodiscard]] std::vector<std::vector<Ratio>> against_most() const;
  void look_at(std::size_t part, const std::vector<Ratio>& ratios, double largest,
               std::vector<Change>& changes) const;

  const FrequencyResponses& whole_;
  SensorWatchOptions options_;
  std::optional<FrequencyResponses> first_{};
  Eigen::VectorXd level_of_first_{};  ///< per input
  std::vector<std::size_t> labels_{};
  std::vector<std::vector<Ratio>> parts_{};  ///< per part, per output
};

}  // namespace hydrapod::identification
