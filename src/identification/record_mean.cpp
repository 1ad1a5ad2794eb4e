#include "record_mean.hpp"

#include <algorithm>
#include <complex>
#include <span>

namespace hydrapod::identification {

RecordMean::RecordMean(const VectorXd& window, Index channels, numerics::RealFft& fft)
    : sum_(VectorXd::Zero(channels)), squares_(MatrixXd::Zero(channels, channels)) {
  constexpr double nothing = 1e-9;
  std::vector<Complex> lines(static_cast<std::size_t>(fft.lines()));
  fft.forward(std::span(window.data(), static_cast<std::size_t>(window.size())), lines);
  const std::size_t most = std::min(lines.size(), numerics::EightLines{}.re.size());
  for (std::size_t k = 0; k < most && std::abs(lines[k]) > nothing * std::abs(lines[0]); ++k)
    window_.push_back(lines[k]);
  products_.assign(window_.size(), MatrixXcd::Zero(channels, channels));
  line_sums_.assign(window_.size(), VectorXcd::Zero(channels));
  line_means_ = products_;
}

void RecordMean::add(const Eigen::RowVectorXd& mean, const numerics::EightLines* first_lines) {
  const Index channels = sum_.size();
  if (blocks_++ == 0) reference_ = mean.head(channels).transpose();
  const VectorXd b = mean.head(channels).transpose() - reference_;
  sum_ += b;
  squares_ += b * b.transpose();
  VectorXcd z(channels);
  for (std::size_t k = 0; k < window_.size(); ++k) {
    for (Index c = 0; c < channels; ++c) z[c] = {first_lines[c].re[k], first_lines[c].im[k]};
    line_sums_[k] += z;
    line_means_[k] += z * b.transpose();
  }
}

void RecordMean::end_record() {
  if (blocks_ == 0) return;
  const auto n = static_cast<double>(blocks_);
  const MatrixXd means = squares_ - sum_ * sum_.transpose() / n;
  for (std::size_t k = 0; k < window_.size(); ++k) {
    const MatrixXcd cross = line_means_[k] - line_sums_[k] * sum_.transpose() / n;
    products_[k] += std::conj(window_[k]) * cross + window_[k] * cross.adjoint() +
                    std::norm(window_[k]) * means;
    line_sums_[k].setZero();
    line_means_[k].setZero();
  }
  sum_.setZero();
  squares_.setZero();
  blocks_ = 0;
}

}  // namespace hydrapod::identification
