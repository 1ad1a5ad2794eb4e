/// A chain of masses with a spring that is not linear, struck by a hammer: peaks at sums of
/// frequencies are no modes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/identification/identify.hpp"
#include "output_only.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using Kind = identification::ModeWarning::Kind;
constexpr double rate = 200.0;

Chain three_masses() {
  return {.masses = Eigen::VectorXd{{213.0, 171.0, 291.0}},
          .springs = Eigen::VectorXd{{0.417e6, 0.451e6, 0.633e6, 0.188e6}},
          .dampers = Eigen::VectorXd{{311.0, 173.0, 296.0, 257.0}}};
}

/// Accelerations under hits of the second mass, by Runge and Kutta. The first spring has the force
/// k (x + `quadratic` x²).
data::Record struck(const Chain& chain, double quadratic, double noise) {
  constexpr int rows = 20000, apart = 3300, finer = 8;
  const Eigen::MatrixXd K = chain_matrix(chain.springs), C = chain_matrix(chain.dampers);
  const auto acceleration = [&](const Eigen::VectorXd& x, const Eigen::VectorXd& v, double force) {
    Eigen::VectorXd f = -K * x - C * v;
    f[0] -= chain.springs[0] * quadratic * x[0] * x[0];
    f[1] += force;
    return Eigen::VectorXd(f.cwiseQuotient(chain.masses));
  };
  data::Record record{.header = header_of(1, 3, rate), .samples = {}};
  record.samples.resize(rows, 4);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(3), v = x;
  const double h = 1.0 / (rate * finer);
  for (int t = 0; t < rows; ++t) {
    const int since = t % apart - 100, hit = t / apart;
    const double force =
        since >= 0 && since < 3 ? (1000.0 + 40.0 * hit) * (since == 1 ? 1.0 : 0.6) : 0.0;
    record.samples.row(t) << force, acceleration(x, v, force).transpose();
    for (int k = 0; k < finer; ++k) {
      const Eigen::VectorXd a1 = acceleration(x, v, force), v2 = v + 0.5 * h * a1;
      const Eigen::VectorXd a2 = acceleration(x + 0.5 * h * v, v2, force), v3 = v + 0.5 * h * a2;
      const Eigen::VectorXd a3 = acceleration(x + 0.5 * h * v2, v3, force), v4 = v + h * a3;
      const Eigen::VectorXd a4 = acceleration(x + h * v3, v4, force);
      x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
  }
  Random random(59);
  const double rms = std::sqrt(record.samples.rightCols(3).squaredNorm() / (3.0 * rows));
  for (double& one : record.samples.rightCols(3).reshaped()) one += noise * rms * normal(random);
  return record;
}

identification::Identification identified(const data::Record& record) {
  const TemporaryFolder folder;
  const std::string file = folder / "hits.h5";
  data::write_record(file, record, data::RecordFormat::hdf5);
  data::RecordSet records({file});
  return identification::identify_modes(
      identification::measure_responses(records, {.for_modes = true}));
}

bool names_tones(const identification::Identification& found) {
  return std::ranges::any_of(
      found.warnings, [](const auto& warning) { return warning.kind == Kind::combination_tones; });
}

TEST(CombinationTones, OfASpringThatIsNotLinearAreNoModes) {
  const auto system = modes_of(three_masses());
  const auto found = identified(struck(three_masses(), 40.0, 1e-4));
  EXPECT_TRUE(names_tones(found));
  for (const auto& mode : found.modes) {
    const bool is_true = std::ranges::any_of(system.modes, [&](const ExactMode& m) {
      return std::abs(mode.fit.omega() / std::abs(m.pole) - 1.0) < 0.005;
    });
    if (!is_true) EXPECT_LE(mode.quality(), 0.3) << mode.fit.omega() / (2.0 * std::numbers::pi);
  }
}

TEST(CombinationTones, AreNotNamedWhereAllSpringsAreLinear) {
  const auto found = identified(struck(three_masses(), 0.0, 1e-4));
  EXPECT_FALSE(names_tones(found));
  EXPECT_EQ(found.modes.size(), 3U);
  for (const auto& mode : found.modes) EXPECT_GT(mode.quality(), 0.9);
}

/// Modes of a bar, 1 : 4 : 9 : 16 : 25, of which 9 + 16 = 25, and of a string, 1 : 2 : 3 …, with
/// decay rates of their own: they are as large as one another.
TEST(CombinationTones, AreNotNamedAmongModesOfStringsAndBars) {
  for (const bool bar : {false, true}) {
    ModalSystem system;
    Random random(bar ? 5 : 6);
    for (int n = 1; n <= 5; ++n) {
      Eigen::VectorXd shape(4);
      for (double& x : shape) x = normal(random);
      const double f = 2.03 * n * (bar ? n : 1.0);
      auto mode = real_mode(f, 0.011, shape);
      mode.shape *= std::abs(mode.pole);
      system.modes.push_back(mode);
    }
    const auto record = record_of(system, {.sample_rate = 211.0,
                                           .samples = 1 << 16,
                                           .output_noise = Eigen::VectorXd::Constant(4, 0.01)});
    EXPECT_FALSE(names_tones(identified(record))) << bar;
  }
}

}  // namespace
}  // namespace hydrapod::test
