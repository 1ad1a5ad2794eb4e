/// Every pole of the platform in the sampled loop against the motion of the nonlinear machine under
/// the real controller.

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "near_gain_limit.hpp"

namespace hydrapod::simulation {
namespace {

/// Poles of free motions y_k (a column per run) an `interval` [s] apart: of the matrix that leads
/// from lags to the next ones (J.-N. Juang, R. S. Pappa, J. Guid. Control Dyn. 8 (1985) 620).
Eigen::VectorXcd poles_of_motions(const std::vector<Eigen::MatrixXd>& y, double interval) {
  constexpr Eigen::Index blocks = 30;
  constexpr double noise = 1e-6;  // of the largest singular value
  const Eigen::Index rows = y[0].rows(), columns = y[0].cols();
  Eigen::MatrixXd H(blocks * rows, (std::ssize(y) - blocks) * columns);
  for (Eigen::Index i = 0; i < blocks; ++i)
    for (Eigen::Index j = 0; j < std::ssize(y) - blocks; ++j)
      H.block(i * rows, j * columns, rows, columns) = y[static_cast<std::size_t>(i + j)];
  const auto svd = numerics::singular_values(H);
  const Eigen::Index order = (svd.s.array() > noise * svd.s[0]).count();
  const Eigen::MatrixXd O = svd.U.leftCols(order);
  const Eigen::VectorXcd z = numerics::eigenvalues(
      numerics::least_squares(O.topRows(O.rows() - rows), O.bottomRows(O.rows() - rows)));
  return z.array().log() / interval;
}

class PolesInMotion : public testing::TestWithParam<NearGainLimit> {};

/// Nothing but the simulated motion after kicks in all directions tells of the poles that are seen.
TEST_P(PolesInMotion, OfThePlatformAreThoseOfTheSampledLoop) {
  const auto machine = looped(GetParam());
  constexpr double begin = 0.04, end = 1.5;
  constexpr int apart = 8;  // samples
  std::vector<Eigen::MatrixXd> motions;
  double sample_time = 0.0;
  for (int direction = 0; direction < 6; ++direction) {
    ClosedLoop loop(machine, machine.neutral(), exact_until(end));
    sample_time = loop.parameters().sample_time;
    signals::Generator kick({{.form = kick_of(1e-5 * Vector6::Unit(direction))}},
                            1.0 / sample_time);
    std::size_t k = 0;
    loop.run(command_source(kick), [&](const LoopSample& sample) {
      if (sample.time < begin || std::lround(sample.time / sample_time) % apart != 0) return;
      if (k == motions.size()) motions.emplace_back(6, 6);
      motions[k++].col(direction) = displacement_between(loop.operating(), sample.plant.X_BP);
    });
  }
  const auto measured = poles_of_motions(motions, apart * sample_time);
  const auto poles = system_poles(linear_system(machine, machine.neutral()));
  int compared = 0;
  for (const auto& pole : poles.poles) {
    // of the platform, slow enough for lags of 8 ms; seals alone hardly move it
    const auto part = [&](Part which) { return pole.parts[static_cast<std::size_t>(which)]; };
    if (!pole.oscillates() || pole.omega < 10.0 || pole.omega > 300.0 || part(Part::seal) > 0.5)
      continue;
    ++compared;
    const auto off = [](std::complex<double> from) {
      return [from](std::complex<double> other) { return std::abs(other - from); };
    };
    const auto stated = *std::ranges::min_element(poles.sampled, {}, off(pole.pole));
    const auto seen = *std::ranges::min_element(measured, {}, off(stated));
    EXPECT_NEAR(seen.real(), stated.real(), 1e-3 * std::abs(stated));
    EXPECT_NEAR(seen.imag(), stated.imag(), 1e-3 * std::abs(stated));
  }
  EXPECT_GE(compared, 6);
}

INSTANTIATE_TEST_SUITE_P(, PolesInMotion, near_gain_limits(0.37, 0.997, 1.006),
                         [](const auto& test) { return fmt::format("{}", test.index); });

}  // namespace
}  // namespace hydrapod::simulation
