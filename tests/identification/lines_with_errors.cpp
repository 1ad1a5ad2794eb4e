#include "lines_with_errors.hpp"

#include <cmath>
#include <complex>

namespace hydrapod::identification {

void add_line_with_errors(double frequency, Eigen::MatrixXcd H, double share, test::Random& random,
                          FrequencyResponses& r) {
  using Number = std::complex<double>;
  const Eigen::VectorXd deviation = share * H.rowwise().norm();
  for (Eigen::Index o = 0; o < H.rows(); ++o)
    for (Eigen::Index i = 0; i < H.cols(); ++i)
      H(o, i) += deviation[o] * std::sqrt(0.5) * Number(test::normal(random), test::normal(random));
  r.frequency.push_back(frequency);
  r.H.push_back(H);
  r.noise.emplace_back(deviation.cwiseAbs2().cast<Number>().asDiagonal());
  r.input_factor.emplace_back(Eigen::MatrixXcd::Identity(H.cols(), H.cols()));
}

}  // namespace hydrapod::identification
