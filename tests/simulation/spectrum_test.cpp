/// Small free vibrations of the nonlinear plant, Fourier-transformed, against the modes; and what
/// the seals do to the resonances of the platform.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "hydrapod/base/units.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support/published_machine.hpp"
#include "support/random.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::Integrator;
using simulation::Plant;

using base::two_pi;

/// Samples of the small displacement from rest: platform at C, rotation vector, flexible
/// coordinates. One column per sample.
MatrixXd free_vibration(const Plant& plant, const VectorXd& displacement, const VectorXd& velocity,
                        double interval, int samples) {
  const auto rest = plant.equilibrium(plant.machine().neutral());
  const int n = plant.layout().velocities;
  VectorXd change = VectorXd::Zero(plant.layout().tangent()), x(plant.layout().size);
  change << displacement, velocity;
  plant.displace(rest.x.data(), change.data(), x.data());
  Integrator run(plant, {.relative_tolerance = 1e-9, .absolute_tolerance = 1e-12});
  run.start(0.0, x);
  MatrixXd record(n, samples);
  for (int k = 0; k < samples; ++k) {
    run.advance(interval * k, {});
    const VectorXd& now = run.state();
    record.col(k).head<3>() = now.head<3>() - rest.x.head<3>();
    // Two quaternions near each other: twice the vector part of their quotient.
    const Eigen::Quaterniond from(rest.x[3], rest.x[4], rest.x[5], rest.x[6]);
    const Eigen::Quaterniond to(now[3], now[4], now[5], now[6]);
    record.col(k).segment<3>(3) = 2.0 * (to * from.conjugate()).vec();
    record.col(k).tail(n - 6) = now.segment(7, n - 6) - rest.x.segment(7, n - 6);
  }
  return record;
}

/// Frequency [rad/s] of the strongest line in a signal: Hann window, then the maximum between the
/// lines by the ratio of the two largest (exact for one tone in a Hann window).
double strongest_line(const VectorXd& signal, double interval) {
  const int n = static_cast<int>(signal.size());
  std::vector<double> windowed(n);
  for (int k = 0; k < n; ++k) windowed[k] = signal[k] * (1.0 - std::cos(two_pi * k / n));
  std::vector<std::complex<double>> lines;
  Eigen::FFT<double>().fwd(lines, windowed);
  int top = 1;
  for (int k = 1; k < n / 2; ++k)
    if (std::abs(lines[k]) > std::abs(lines[top])) top = k;
  const bool right = std::abs(lines[top + 1]) > std::abs(lines[top - 1]);
  const double ratio = std::abs(lines[right ? top + 1 : top - 1]) / std::abs(lines[top]);
  const double between = (2.0 * ratio - 1.0) / (ratio + 1.0);
  return two_pi * (top + (right ? between : -between)) / (n * interval);
}

/// Each mode is picked out of the motion with φᵀ M, so that modes that stand close are told apart.
void expect_modes(const model::Machine& machine, ModelKind kind) {
  const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
  const auto modes = modal::normal_modes(model);
  const int n = model.dof();
  Random random(1809);
  VectorXd amplitudes(n);
  for (int k = 0; k < n; ++k) amplitudes[k] = random.uniform(0.5, 1.0) * (k % 2 == 0 ? 1.0 : -1.0);
  const VectorXd displacement = 2e-6 * MatrixXd(modes.shapes) * amplitudes;  // micrometres
  const Plant plant(machine, kind, {.hydraulics = false});
  constexpr double interval = 7e-3;
  constexpr int samples = 2048;
  const MatrixXd record = free_vibration(plant, displacement, VectorXd::Zero(n), interval, samples);
  const MatrixXd picked = MatrixXd(modes.shapes).transpose() * MatrixXd(model.M) * record;
  for (int k = 0; k < n; ++k) {
    const double found = strongest_line(picked.row(k), interval);
    EXPECT_NEAR(found, modes.omega(k), 1e-3 * modes.omega(k)) << "mode " << k + 1;
  }
}

model::Machine undamped() {
  auto machine = published_machine();
  machine.damping.modal_ratio = 0.0;
  return machine;
}

TEST(FreeVibration, ShowsTheEighteenModesOfThePublishedMachine) {
  expect_modes(undamped(), ModelKind::guide);
}

TEST(FreeVibration, ShowsThePreloadedModesUnderGravity) {
  auto machine = undamped();
  machine.gravity = {0.0, 0.0, -9.80665};
  expect_modes(machine, ModelKind::guide);
  expect_modes(machine, ModelKind::rigid);
}

/// Lines of the free motion after a blow on the platform along `direction`, as what stands 3 dB
/// above the valleys beside it. The response to an impulse is that of a frequency response, and
/// uniform damping makes its lines as wide as a fraction of what parts them.
int resonances(model::Machine machine, ModelKind kind, int direction) {
  constexpr double decay = 0.5;  // 1/s, of C = α M
  machine.damping.rayleigh_mass = 2.0 * decay;
  const Plant plant(machine, kind, {.hydraulics = false});
  const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
  const int n = model.dof();
  const VectorXd blow = 1e-2 * MatrixXd(model.M).llt().solve(VectorXd::Unit(n, direction));
  constexpr double interval = 1e-2;
  constexpr int samples = 2048;  // 20 s: e^(−10) is left
  const MatrixXd record = free_vibration(plant, VectorXd::Zero(n), blow, interval, samples);
  std::vector<double> signal(samples);
  for (int k = 0; k < samples; ++k) signal[k] = record(direction, k);
  std::vector<std::complex<double>> lines;
  Eigen::FFT<double>().fwd(lines, signal);
  const double highest = 250.0;  // rad/s: all modes are below
  int count = 0;
  double valley = std::abs(lines[1]), peak = valley;
  bool rising = false;
  for (int k = 1; k < samples / 2 && two_pi * k / (samples * interval) < highest; ++k) {
    const double height = std::abs(lines[k]);
    const double prominence = std::sqrt(2.0);  // 3 dB
    if (rising) {
      peak = std::max(peak, height);
      if (height < peak / prominence) {
        ++count;
        rising = false;
        valley = height;
      }
    } else {
      valley = std::min(valley, height);
      if (height > valley * prominence) {
        rising = true;
        peak = height;
      }
    }
  }
  return count;
}

TEST(Resonances, ThereAreTwoInXAndYWithTheSealsAndOneWithoutTheirCompliance) {
  // Gravity, under which the seals matter; no coupling of x with ry from a mass centre that hangs
  // below the joints, so that what is counted are x's own.
  auto machine = published_machine();
  machine.gravity = {0.0, 0.0, -9.80665};
  machine.flexible_axes = model::FlexibleAxes::transverse;
  auto stiffened = machine;
  for (auto& leg : stiffened.legs) leg.guide_sleeve.stiffness *= 300.0;
  for (const int direction : {0, 1}) {
    const int rigid = resonances(machine, ModelKind::rigid, direction);
    EXPECT_EQ(resonances(machine, ModelKind::guide, direction), rigid + 1) << direction;
    EXPECT_EQ(resonances(stiffened, ModelKind::guide, direction), rigid) << direction;
  }
}

}  // namespace
}  // namespace hydrapod::test
