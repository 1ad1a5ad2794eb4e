#pragma once
/// Watches a channel for samples that are missing or stand at a limit. Private to the module.

#include "hydrapod/identification/spectra.hpp"

namespace hydrapod::identification {

class ChannelWatch {
 public:
  using Column = Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  void add(const Column& samples);
  [[nodiscard]] ChannelHealth health() const;

 private:
  /// Samples at one end of the range.
  struct Limit {
    double value{};
    std::int64_t counted{};
    void restart(double at);
  };

  bool begun_{};
  std::int64_t samples_{}, missing_{};
  Limit low_{}, high_{};
};

}  // namespace hydrapod::identification
