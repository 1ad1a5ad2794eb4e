#pragma once
/// Did a sensor or an input change between parts of a measurement? Private to the module.
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
///
/// Per input i the same is done with columns, each output by its own size: an input that is β times
/// what it was has the response α = 1/β times to all outputs, and the rows of outputs, which are
/// mixtures of it and the others, look changed too. So both are asked, and what explains more
/// counts. Of two parts, with Σ over the channels of a kind,
///
///     left = Σ |g − a h|² / Σ (|h|² + |g|²),   a = α where the channel changed, else 1,
///
/// is what it leaves unexplained: 2 α² (1 − |γ|) and 1 + α² − 2 γ |α| by S_hh. Where both leave the
/// same, as with one input, the fewer channels have changed.
///
/// Another damping has α too. Of a resonance it makes |γ| = 1/cosh ln α, and where nothing but a
/// gain changed |γ| is 1.

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
  /// The gain of a single input is its own where 1 − |γ| < pure · what another damping with this
  /// gain would make of it.
  double pure{0.25};
  /// Inputs and outputs explain alike where what they leave differs by less than that.
  double as_good{0.01};
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
    bool is_input{};
    Eigen::Index channel{};  ///< of the outputs or inputs
    double factor{};         ///< of the channel by what is right
    std::int64_t changed{};  ///< of the outputs or inputs
    double deviation{};      ///< of ln |factor|
  };
  /// The largest.
  [[nodiscard]] std::optional<Change> result() const;

 private:
  enum class Side { outputs, inputs };
  /// α of a channel, the deviation of ln |α|, γ and S_hh; NaN: not known.
  struct Ratio {
    double alpha{}, deviation{}, likeness{}, size{};
  };
  using Ratios = std::vector<std::vector<Ratio>>;  ///< per part, per channel
  struct Found {
    std::vector<Change> changes{};
    double left{};  ///< unexplained
  };
  [[nodiscard]] Ratio ratio_of(const FrequencyResponses& part, const Eigen::VectorXd& level,
                               Side side, Eigen::Index channel) const;
  [[nodiscard]] Ratios against_most(Side side) const;
  void look_at(std::size_t part, const std::vector<Ratio>& ratios, Side side, double largest,
               std::vector<Change>& changes) const;
  [[nodiscard]] Found find(Side side, double largest) const;

  const FrequencyResponses& whole_;
  SensorWatchOptions options_;
  std::optional<FrequencyResponses> first_{};
  Eigen::VectorXd level_of_first_{};  ///< per input
  Eigen::VectorXd weight_{};          ///< per output, one by its size in the first part
  std::vector<std::size_t> labels_{};
  Ratios of_outputs_{}, of_inputs_{};
};

}  // namespace hydrapod::identification
