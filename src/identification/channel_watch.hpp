#pragma once
/// Watches a channel for samples that are missing or stand at a limit. Private to the module.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

class ChannelWatch {
 public:
  using Column = Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  void add(const Column& samples);
  [[nodiscard]] ChannelHealth health() const;

 private:
  /// Samples at one end of the range, and at the value next to it: a clipped channel has more of
  /// the former, a coarsely resolved one fewer.
  struct Limit {
    double value{}, next{};
    std::int64_t counted{}, counted_next{};
    /// `extreme`: of these and all samples before; `side`: 1 for the upper end, −1 for the lower.
    void add(const Column& samples, double extreme, double side);
    [[nodiscard]] std::int64_t clipped() const { return counted > counted_next ? counted : 0; }
  };

  bool begun_{};
  std::int64_t samples_{}, missing_{};
  Limit low_{}, high_{};
};

}  // namespace hydrapod::identification
