#pragma once
/// Tops of a signal that are cut off. Private to the module.
///
/// n ≥ 3 samples in succession stand exactly at the extreme. The outermost of them are n − 1
/// samples apart: a rounded top, c t², has them there where its resolution is δ ≥ c ((n − 1)/2)².
/// Then n samples further it has fallen by c ((3n − 1)/2)² ≤ ((3n − 1)/(n − 1))² δ, 16 δ for three
/// samples and 9 δ for many. A top that was cut off has steeper flanks, on both sides. A hold of
/// every sample, as of a slow sensor that is read quickly, has runs everywhere: no top of it
/// counts.

#include <cstdint>
#include <limits>
#include <vector>

#include "cut_tops.hpp"
#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

struct FlatTopOptions {
  /// The flatter side falls by > of_rounded · what a rounded top of as many samples does, where δ
  /// is the least step of the channel, see above, and by more than of_range · its range: a slow
  /// signal of fine resolution has tops that are round.
  double of_rounded{4.0 / 3.0}, of_range{0.09};
};

/// Sees all samples of a channel, piece by piece.
class FlatTops {
 public:
  using Column = Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  /// `low` and `high`: least and largest of the finite samples.
  void add(const Column& samples, double low, double high);
  /// Of a channel of that range.
  [[nodiscard]] CutOff cut_off(double range, const FlatTopOptions& options = {}) const;
  /// The least step between two samples.
  [[nodiscard]] double step() const { return step_; }

 private:
  struct Top {
    std::int64_t samples{};
    double flank{};  ///< what it falls by, on the flatter side
  };
  /// Tops at one end of the range.
  struct End {
    double side{}, extreme{std::numeric_limits<double>::quiet_NaN()};
    std::vector<Top> tops{};
  };
  void look(End& end, Eigen::Index known) const;
  void measure_steps(const Column& samples);

  End low_{.side = -1.0}, high_{.side = 1.0};
  std::vector<double> seen_{};  ///< the last samples before this piece, and it
  double last_{std::numeric_limits<double>::quiet_NaN()};
  double step_{std::numeric_limits<double>::infinity()};  ///< the least between two samples
  int steps_{};                                           ///< that were measured
  bool is_near_{};                                        ///< an extreme in the last piece
};

}  // namespace hydrapod::identification
