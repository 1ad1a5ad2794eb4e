#pragma once
/// Samples of a channel that are missing or stand at a limit. Private to the module.

#include <array>
#include <cstdint>
#include <limits>

#include "flat_tops.hpp"
#include "held.hpp"
#include "held_values.hpp"
#include "hydrapod/identification/responses.hpp"
#include "names.hpp"

namespace hydrapod::identification {

/// Sees all samples of a channel.
class ChannelWatch {
 public:
  using Column = Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  /// `low` and `high`: least and largest of the samples, not finite where one of them is not.
  void add(const Column& samples, double low, double high);
  [[nodiscard]] ChannelHealth health() const;

 private:
  /// Samples at one end of the range, and at the three values next to it.
  class Limit {
   public:
    /// 1 for the upper end, −1 for the lower.
    explicit Limit(double side) : side_(side) {}
    /// `extreme`: of these.
    void add(const Column& samples, double extreme);
    [[nodiscard]] double value() const { return values_[0]; }
    /// Samples that were cut off here, of `all`.
    [[nodiscard]] std::int64_t clipped(std::int64_t all) const;

   private:
    void count(double sample);

    double side_;
    double least_{-std::numeric_limits<double>::infinity()};  // what counts, times the side
    std::size_t known_{};
    std::array<double, 4> values_{};
    std::array<std::int64_t, 4> counts_{};
  };

  std::int64_t samples_{}, missing_{};
  Limit low_{-1.0}, high_{1.0};
  FlatTops tops_{};
  CutTops cut_tops_{};
  ValueHold values_{};
  LongestHold hold_{};
};

}  // namespace hydrapod::identification
