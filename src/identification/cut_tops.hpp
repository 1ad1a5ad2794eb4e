#pragma once
/// Tops of a signal that were cut off before noise came to it: an amplifier is at its limit, and
/// the recorder behind it adds noise of its own. Private to the module.
///
/// n ≥ 3 samples in succession are within a band δ of the extreme. Of a round top, c t², these are
/// c (n/2)² ≤ δ, and n/2 samples further it has fallen by 4 δ at most; by 16 δ where its curvature
/// vanishes, c t⁴, as it does here and there in a signal of several frequencies, and by 64 δ for
/// c t⁶. A top that was cut off has corners: with δ as wide as the noise, it falls by more. It is
/// no chance where most of the tops in the band do so. The width of the noise is not known: all are
/// tried.

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

struct CutTopOptions {
  /// δ as shares of the range. With noise of a thousandth of the range, δ is six of that; above
  /// 1/22 the rule below asks for more than the range.
  std::vector<double> bands{0.001, 0.002, 0.004, 0.006, 0.008, 0.012, 0.016, 0.024, 0.032, 0.045};
  double of_step{3.0};  ///< δ ≥ of_step · the least step: below, tops are steps of the resolution
  /// A top of `least` samples or more is cut off where it falls by > corner · δ on both sides; one
  /// alone is believed where it falls by > sharp_corner · δ, else `fewest` are needed; and those
  /// that are not cut off must be no more than those that are.
  double corner{16.0}, sharp_corner{64.0};
  std::int64_t fewest{3};
  Eigen::Index least{3}, longest{4096};  ///< samples of a top
  /// Samples that are kept of each end; where there are more, of every second top, and so on.
  std::size_t most{std::size_t{1} << 16U};
};

/// Samples from these on were cut off; not finite: none.
struct CutOff {
  double below{std::numeric_limits<double>::quiet_NaN()}, above{below};
  std::int64_t samples{};
};

/// Sees all samples of a channel, piece by piece.
class CutTops {
 public:
  using Column = Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  /// `low` and `high`: least and largest of the finite samples.
  void add(const Column& samples, double low, double high);
  /// `step`: the least between two samples.
  [[nodiscard]] CutOff cut_off(double step) const;

 private:
  using Samples = std::vector<double>;
  /// With `beside` samples on either side.
  struct Top {
    Samples x{};
    Eigen::Index beside{};
  };
  /// Excursions to one end of the range, with what is beside them; times `side`.
  struct End {
    double side{}, extreme{-std::numeric_limits<double>::infinity()};
    std::vector<Top> tops{};
    std::size_t stored{};  ///< samples
    std::int64_t every{1}, seen{};
  };
  struct Count {
    std::int64_t cut{}, sharp{}, round{};
    std::int64_t samples{};  ///< in the band, in short excursions too
  };
  /// In `x` from sample `from` on; the first sample that must be seen again.
  Eigen::Index look(End& end, const Samples& x, Eigen::Index from) const;
  void keep(End& end, Top top) const;
  [[nodiscard]] Count count(const End& end, double band) const;

  CutTopOptions options_{};
  End low_{.side = -1.0}, high_{.side = 1.0};
  Samples before_{};                       ///< the last samples before this piece
  Eigen::Index seen_low_{}, seen_high_{};  ///< of `before_`, as far as they were looked at
};

}  // namespace hydrapod::identification
