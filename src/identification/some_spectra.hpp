#pragma once
/// Averaged spectra of neighbouring lines as matrices that are computed side by side. Private to
/// the module.

#include <algorithm>
#include <array>
#include <vector>

#include "line_matrix.hpp"
#include "names.hpp"

namespace hydrapod::identification {

using Channels = std::vector<int>;
using Lines = std::array<Index, together>;

/// Lines `first` … of `all`; beyond its end the last one again.
inline Lines lines_from(const std::vector<Index>& all, std::size_t first) {
  Lines lines{};
  for (std::size_t k = 0; k < lines.size(); ++k)
    lines[k] = all[std::min(first + k, all.size() - 1)];
  return lines;
}

/// The same of all lines 0 … `count` − 1.
inline Lines lines_from(Index first, Index count) {
  Lines lines{};
  for (std::size_t k = 0; k < lines.size(); ++k)
    lines[k] = std::min(first + static_cast<Index>(k), count - 1);
  return lines;
}

/// S or N of some lines, for rows and columns of channels.
class SomeSpectra {
 public:
  SomeSpectra(const MatrixXd& re, const MatrixXd& im, const Lines& lines)
      : re_(re), im_(im), lines_(lines) {}
  [[nodiscard]] LineMatrix part(const Channels& rows, const Channels& columns) const {
    LineMatrix S(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
    for (Index i = 0; i < S.rows(); ++i)
      for (Index j = 0; j < S.cols(); ++j)
        load(rows[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(j)], S(i, j));
    return S;
  }

 private:
  void load(Index row, Index column, ComplexLines& to) const {
    const Index a = std::max(row, column), b = std::min(row, column), pair = a * (a + 1) / 2 + b;
    const double sign = row < column ? -1.0 : 1.0;
    for (int k = 0; k < together; ++k) {
      to.re[k] = re_(lines_[static_cast<std::size_t>(k)], pair);
      to.im[k] = sign * im_(lines_[static_cast<std::size_t>(k)], pair);
    }
  }

  const MatrixXd &re_, &im_;
  Lines lines_;
};

}  // namespace hydrapod::identification
