#pragma once
/// The samples of short records, all at once. Private to the module.

#include <vector>

#include "names.hpp"

namespace hydrapod::identification {

/// One record: a row per sample.
struct Piece {
  MatrixXd inputs{}, outputs{};
};

struct Signals {
  double sample_rate{};  ///< [Hz]
  std::vector<Piece> pieces{};
  /// At the ends of each piece, so many samples hold what filtering left of the world beyond them.
  Index touched{};
  [[nodiscard]] Index samples() const {
    Index count = 0;
    for (const auto& piece : pieces) count += piece.outputs.rows();
    return count;
  }
};

/// The same without their means and slopes.
Signals detrended(Signals signals);

/// At a lower rate, of which `highest` [Hz] is a share `room` of half: every line up to there is
/// kept, none above. Unchanged where that is hardly lower than the rate is.
Signals decimated(const Signals& signals, double highest, double room);

/// The largest even number of samples ≤ count whose factors are 2, 3 and 5: quick to transform.
Index good_length(Index count);

/// Lines 0 … n/2 of the first n samples, n = good_length(rows): lines × channels, times 2/n.
MatrixXcd lines_of(const MatrixXd& samples);

}  // namespace hydrapod::identification
