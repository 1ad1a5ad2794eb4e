#include "short_records.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

#include "measured_records.hpp"

namespace hydrapod::identification {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Poles, shapes and participations of M q̈ + D q̇ + K q = B u.
test::ModalSystem modal_system(const VectorXd& mass, const MatrixXd& D, const MatrixXd& K,
                               const MatrixXd& B) {
  const Index n = mass.size();
  const MatrixXd flexibility = mass.cwiseInverse().asDiagonal();
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -flexibility * K;
  A.bottomRightCorner(n, n) = -flexibility * D;
  const Eigen::EigenSolver<MatrixXd> solver(A);
  const MatrixXcd V = solver.eigenvectors(), W = V.inverse();
  test::ModalSystem system;
  for (Index r = 0; r < 2 * n; ++r)
    if (solver.eigenvalues()[r].imag() > 0.0)
      system.modes.push_back(
          {.pole = solver.eigenvalues()[r],
           .shape = V.col(r).head(n),
           .participation = (W.row(r).tail(n) * (flexibility * B).cast<Complex>()).transpose()});
  std::ranges::sort(system.modes, {}, [](const auto& m) { return std::abs(m.pole); });
  return system;
}

/// Springs or dampers in a row, both ends held.
MatrixXd row_matrix(const VectorXd& between) {
  const Index n = between.size() - 1;
  MatrixXd K = MatrixXd::Zero(n, n);
  for (Index j = 0; j < n; ++j) {
    K(j, j) = between[j] + between[j + 1];
    if (j > 0) K(j, j - 1) = K(j - 1, j) = -between[j];
  }
  return K;
}

/// One force per place.
MatrixXd forces_at(Index masses, const std::vector<int>& pushed) {
  MatrixXd B = MatrixXd::Zero(masses, std::ssize(pushed));
  for (std::size_t i = 0; i < pushed.size(); ++i) B(pushed[i], static_cast<Index>(i)) = 1.0;
  return B;
}

}  // namespace

test::ModalSystem row_of_masses(const VectorXd& mass, const VectorXd& spring,
                                const VectorXd& damper, const std::vector<int>& pushed) {
  return modal_system(mass, row_matrix(damper), row_matrix(spring), forces_at(mass.size(), pushed));
}

test::ModalSystem two_rows() {
  const VectorXd mass = (VectorXd(6) << 1.37, 1.91, 1.13, 1.43, 1.83, 1.19).finished();
  const Eigen::Vector4d spring(3410.0, 7230.0, 6170.0, 2890.0),
      other(3370.0, 7410.0, 5930.0, 3010.0), damper(1.31, 1.93, 1.17, 0.89),
      other_damper(1.07, 1.71, 1.41, 1.13);
  MatrixXd K = MatrixXd::Zero(6, 6), D = K;
  K.topLeftCorner<3, 3>() = row_matrix(spring);
  K.bottomRightCorner<3, 3>() = row_matrix(other);
  D.topLeftCorner<3, 3>() = row_matrix(damper);
  D.bottomRightCorner<3, 3>() = row_matrix(other_damper);
  for (Index j = 0; j < 3; ++j) {
    const double joined = 170.0 + 40.0 * static_cast<double>(j);
    K(j, j) += joined;
    K(j + 3, j + 3) += joined;
    K(j, j + 3) -= joined;
    K(j + 3, j) -= joined;
  }
  return modal_system(mass, D, K, forces_at(6, {0, 4}));
}

namespace {

/// Two sections of second order, each a double pole: its power at `corner` is a sixteenth.
class LowPass {
 public:
  LowPass(Index signals, double corner, double sample_rate)
      : share_(1.0 - std::exp(-2.0 * std::numbers::pi * corner / sample_rate)),
        states_(MatrixXd::Zero(4, signals)) {}
  VectorXd operator()(const VectorXd& u) {
    Eigen::RowVectorXd in = u.transpose();
    for (Index k = 0; k < states_.rows(); ++k) {
      states_.row(k) += share_ * (in - states_.row(k));
      in = states_.row(k);
    }
    return in.transpose();
  }

 private:
  double share_;
  MatrixXd states_;
};

/// Sample `k` of force `i`.
double swept(Index i, int k, Index forces, const ShortRecordCase& e) {
  const double slot = e.duration / static_cast<double>(forces);
  const double t = k / e.sample_rate - slot * static_cast<double>(i);
  constexpr double from = 2.0, to = 25.0;
  if (t < 0.0 || t >= slot) return 0.0;
  return std::sin(2.0 * std::numbers::pi * (from + 0.5 * (to - from) * t / slot) * t);
}

}  // namespace

data::Record short_record(const test::ModalSystem& system, const ShortRecordCase& e,
                          std::uint64_t seed) {
  test::Random random(9941 * seed + 17);
  const Index p = system.inputs(), q = system.outputs();
  const auto samples = static_cast<int>(std::llround(e.duration * e.sample_rate));
  data::Record record{.header = test::header_of(p, q, e.sample_rate), .samples = {}};
  record.samples.resize(samples, p + q);
  test::ModalRun run(system, 1.0 / e.sample_rate);
  const int before = e.from_rest || e.sweeps ? 0 : 4000;
  LowPass low_pass(p, e.band, e.sample_rate);
  for (int k = -before; k < samples; ++k) {
    VectorXd u(p), more = VectorXd::Zero(p);
    for (Index i = 0; i < p; ++i) {
      u[i] = e.sweeps ? swept(i, k, p, e) : test::normal(random);
      if (e.forces > 0.0) more[i] = e.forces * test::normal(random);
    }
    if (e.band > 0.0) u = low_pass(u);
    const VectorXd all = u + more;
    if (k >= 0) record.samples.row(k) << u.transpose(), run.output().transpose();
    run.advance(all);
  }
  const VectorXd rms =
      (record.samples.rightCols(q).colwise().squaredNorm() / static_cast<double>(samples))
          .cwiseSqrt()
          .transpose();
  const double phase = random.uniform(0.0, 2.0 * std::numbers::pi);
  for (int k = 0; k < samples; ++k)
    for (Index o = 0; o < q; ++o)
      record.samples(k, p + o) +=
          rms[o] * (e.noise * test::normal(random) +
                    e.hum * std::cos(2.0 * std::numbers::pi * 15.7 * k / e.sample_rate + phase +
                                     static_cast<double>(o)));
  return record;
}

ShortResult identified_record(const std::vector<data::Record>& records,
                              const MeasureOptions& options) {
  auto own = options;
  own.for_modes = true;
  own.whole_record = true;
  ShortResult result{.measured = measured(records, own), .found = {}};
  result.found = identify_modes(result.measured);
  return result;
}

namespace {

/// y_t from (u_t, y_(t−1), u_(t−1), …): coefficients, a row per regressor.
struct PlainVarx {
  Index order{};
  MatrixXd theta{};
  double criterion{};
};

PlainVarx plain_varx(const MatrixXd& u, const MatrixXd& y, Index order, Index longest) {
  const Index p = u.cols(), q = y.cols(), rows = y.rows() - longest, count = p + order * (p + q);
  MatrixXd X(rows, count);
  X.leftCols(p) = u.bottomRows(rows);
  for (Index lag = 1; lag <= order; ++lag) {
    X.middleCols(p + (lag - 1) * (p + q), q) = y.middleRows(longest - lag, rows);
    X.middleCols(p + (lag - 1) * (p + q) + q, p) = u.middleRows(longest - lag, rows);
  }
  const MatrixXd target = y.bottomRows(rows);
  PlainVarx model{.order = order, .theta = X.householderQr().solve(target)};
  const MatrixXd rest = target - X * model.theta;
  const MatrixXd S = rest.transpose() * rest / static_cast<double>(rows);
  model.criterion =
      static_cast<double>(rows) * std::log(S.determinant()) + 2.0 * static_cast<double>(count * q);
  return model;
}

}  // namespace

std::vector<test::FoundMode> textbook_record_modes(const data::Record& record, Index inputs,
                                                   double highest) {
  const Index q = record.samples.cols() - inputs;
  // every channel by its RMS, so that the criterion's determinant stays a number
  MatrixXd z = record.samples;
  z.rowwise() -= z.colwise().mean().eval();
  const VectorXd size = (z.colwise().squaredNorm() / static_cast<double>(z.rows())).cwiseSqrt();
  z = z * size.cwiseInverse().asDiagonal();
  const MatrixXd u = z.leftCols(inputs), y = z.rightCols(q);
  constexpr Index longest = 30, lags = 120, blocks = 50;
  PlainVarx best;
  for (Index n = 2; n <= longest && n * (inputs + q) + inputs < z.rows() / 3; n += 2)
    if (const auto model = plain_varx(u, y, n, longest);
        best.order == 0 || model.criterion < best.criterion)
      best = model;
  std::vector<MatrixXd> h{best.theta.topRows(inputs).transpose()};
  for (Index k = 1; k < lags; ++k) {
    MatrixXd next = MatrixXd::Zero(q, inputs);
    for (Index lag = 1; lag <= std::min(k, best.order); ++lag) {
      const Index at = inputs + (lag - 1) * (inputs + q);
      next += best.theta.middleRows(at, q).transpose() * h[static_cast<std::size_t>(k - lag)];
      if (lag == k) next += best.theta.middleRows(at + q, inputs).transpose();
    }
    h.push_back(next);
  }
  MatrixXd H(blocks * q, blocks * inputs);
  for (Index i = 0; i < blocks; ++i)
    for (Index j = 0; j < blocks; ++j)
      H.block(i * q, j * inputs, q, inputs) = h[static_cast<std::size_t>(i + j + 1)];
  const Eigen::BDCSVD<MatrixXd> svd(H, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& s = svd.singularValues();
  const Index order = (s.array() > 0.01 * s[0]).count();
  const MatrixXd O = svd.matrixU().leftCols(order) * s.head(order).cwiseSqrt().asDiagonal();
  const MatrixXd A =
      O.topRows((blocks - 1) * q).colPivHouseholderQr().solve(O.bottomRows((blocks - 1) * q));
  const Eigen::EigenSolver<MatrixXd> solver(A);
  std::vector<test::FoundMode> modes;
  for (Index r = 0; r < order; ++r) {
    const Complex pole = std::log(solver.eigenvalues()[r]) * record.header.sample_rate;
    if (pole.imag() <= 0.0 || pole.real() >= 0.0 || -pole.real() > 0.3 * std::abs(pole) ||
        std::abs(pole) > 2.0 * std::numbers::pi * highest)
      continue;
    const Eigen::VectorXcd shape = O.topRows(q) * solver.eigenvectors().col(r);
    modes.push_back({.pole = pole, .shape = size.tail(q).asDiagonal() * shape});
  }
  return modes;
}

}  // namespace hydrapod::identification
