#include "line_weights.hpp"

#include <algorithm>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// Running mean over ±`reach` lines.
VectorXd smoothed(const VectorXd& values, Index reach) {
  VectorXd result(values.size());
  for (Index k = 0; k < values.size(); ++k) {
    const Index from = std::max<Index>(0, k - reach), to = std::min(values.size() - 1, k + reach);
    result[k] = values.segment(from, to - from + 1).mean();
  }
  return result;
}

}  // namespace

MatrixXd row_weights(const FrequencyResponses& r, bool transposed) {
  constexpr Index reach = 2;
  const auto lines = static_cast<Index>(r.lines());
  const Index rows = transposed ? r.H[0].cols() : r.H[0].rows();
  const Index columns = transposed ? r.H[0].rows() : r.H[0].cols();
  MatrixXd weight(lines, rows);
  for (Index o = 0; o < rows; ++o) {
    VectorXd square(lines), variance = VectorXd::Zero(lines);
    for (Index k = 0; k < lines; ++k) {
      const auto& H = r.H[static_cast<size_t>(k)];
      square[k] = (transposed ? H.col(o).squaredNorm() : H.row(o).squaredNorm()) /
                  static_cast<double>(columns);
      if (!r.has_errors()) continue;
      for (Index i = 0; i < columns; ++i)
        variance[k] += r.variance(static_cast<size_t>(k), static_cast<int>(transposed ? i : o),
                                  static_cast<int>(transposed ? o : i)) /
                       static_cast<double>(columns);
    }
    // without known errors: in proportion to the response, but no better than in its quieter half
    VectorXd sorted = square;
    std::nth_element(sorted.begin(), sorted.begin() + lines / 2, sorted.end());
    const double median = std::max(sorted[lines / 2], 1e-300);
    // a response measured without any noise still has errors of rounding and of the model
    constexpr double floor = 1e-12;
    if (r.has_errors())
      weight.col(o) = (smoothed(variance, reach) + floor * square).array().max(1e-300).inverse();
    else
      weight.col(o) = (smoothed(square, reach).array() + median).inverse();
  }
  return weight;
}

}  // namespace hydrapod::identification
