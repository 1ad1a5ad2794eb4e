#include "line_weights.hpp"

#include <algorithm>

#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

VectorXd running_mean(const VectorXd& values, Index reach) {
  VectorXd result(values.size());
  for (Index k = 0; k < values.size(); ++k) {
    const Index from = std::max<Index>(0, k - reach), to = std::min(values.size() - 1, k + reach);
    result[k] = values.segment(from, to - from + 1).mean();
  }
  return result;
}

double numbers_per_line(const FrequencyResponses& r) {
  return static_cast<double>(r.excitation.empty() ? r.H[0].size() : r.H[0].rows());
}

VectorXd signal_to_noise(const FrequencyResponses& r, Index reach) {
  VectorXd own = VectorXd::Zero(static_cast<Index>(r.lines()));
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const auto& H = r.H[k];
    double sum = 0.0;
    if (!r.excitation.empty()) {
      const VectorXcd seen = H * r.excitation[k];
      own[static_cast<Index>(k)] =
          seen.cwiseAbs2().cwiseQuotient(r.noise[k].diagonal().real().cwiseMax(1e-300)).mean();
      continue;
    }
    for (Index o = 0; o < H.rows(); ++o)
      for (Index i = 0; i < H.cols(); ++i)
        sum += std::norm(H(o, i)) / std::max(r.variance(k, o, i), 1e-300);
    own[static_cast<Index>(k)] = sum / static_cast<double>(H.size());
  }
  return running_mean(own, reach);
}

VectorXd row_sizes(const FrequencyResponses& responses) {
  VectorXd sum = VectorXd::Zero(responses.H[0].rows());
  for (const auto& H : responses.H) sum += H.rowwise().squaredNorm();
  return (sum / static_cast<double>(responses.lines())).cwiseSqrt().cwiseMax(1e-300);
}

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
        variance[k] += r.variance(static_cast<size_t>(k), transposed ? i : o, transposed ? o : i) /
                       static_cast<double>(columns);
    }
    if (square.maxCoeff() == 0.0 && variance.maxCoeff() == 0.0) {  // any weight will do
      weight.col(o).setOnes();
      continue;
    }
    // without known errors: in proportion to the response, but no better than in its quieter half
    const double median = std::max(numerics::upper_median({square.begin(), square.end()}), 1e-300);
    // a response measured without any noise still has errors of rounding and of the model
    constexpr double floor = 1e-12;
    if (r.has_errors())
      weight.col(o) =
          (running_mean(variance, reach) + floor * square).array().max(1e-300).inverse();
    else
      weight.col(o) = (running_mean(square, reach).array() + median).inverse();
  }
  return weight;
}

}  // namespace hydrapod::identification
