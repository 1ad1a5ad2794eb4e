/// Resonance peaks: of a chain of two masses in closed form, and those of the published machine.

#include "hydrapod/response/frequency_response.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "support/run_program.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;
using response::Peak;
using response::ResponseModel;

/// Six coordinates of unit mass on springs of their own, 100 (1 + d)² N/m, none coupled; x and ry
/// are then tied to each other by `coupling`.
ResponseModel six_masses(double coupling, double modal_ratio) {
  LinearModel model{.kind = ModelKind::rigid, .p_BC = spatial::Vector3::Zero()};
  model.platform_mass.setIdentity();
  model.M.setIdentity(6, 6);
  model.K.setZero(6, 6);
  model.C.setZero(6, 6);
  for (int d = 0; d < 6; ++d) model.K(d, d) = 100.0 * (1.0 + d) * (1.0 + d);
  model.K(0, 4) = model.K(4, 0) = coupling;
  return response::response_model(model, modal::normal_modes(model), modal_ratio,
                                  spatial::Vector3::Zero());
}

std::vector<Peak> in_direction(const std::vector<Peak>& peaks, int direction) {
  std::vector<Peak> found;
  for (const auto& peak : peaks)
    if (peak.direction == direction) found.push_back(peak);
  return found;
}

/// |H| = 1 / |ω_n² − ω² + 2 i ζ ω_n ω| has its peak at ω_n √(1 − 2ζ²), 1 / (2 ζ ω_n² √(1 − ζ²))
/// high.
TEST(Peaks, OfASingleMassAreThoseOfTheTextbook) {
  for (const double zeta : {1e-4, 0.01, 0.1, 0.5}) {
    const auto peaks = response::find_peaks(six_masses(0.0, zeta), {1.0, 1000.0});
    ASSERT_EQ(peaks.size(), 6U);
    for (int d = 0; d < 6; ++d) {
      const double omega_n = 10.0 * (1.0 + d);
      EXPECT_EQ(peaks[d].direction, d);
      EXPECT_EQ(peaks[d].mode, d);
      EXPECT_TRUE(peaks[d].own);
      EXPECT_TRUE(std::isinf(peaks[d].prominence_db)) << "nothing higher in the band";
      constexpr double flat_top = 1e-7;  // a search on values cannot see a top better than √ε
      EXPECT_NEAR(peaks[d].omega / (omega_n * std::sqrt(1.0 - 2.0 * zeta * zeta)), 1.0, flat_top);
      EXPECT_NEAR(
          peaks[d].magnitude * 2.0 * zeta * omega_n * omega_n * std::sqrt(1.0 - zeta * zeta), 1.0,
          1e-9);
    }
  }
}

TEST(Peaks, BeyondSevenTenthsOfCriticalAreNone) {
  EXPECT_TRUE(response::find_peaks(six_masses(0.0, 0.71), {1.0, 1000.0}).empty());
}

/// Velocity peaks at ω_n exactly, 1 / (2 ζ ω_n) high.
TEST(Peaks, OfTheVelocityStandAtTheUndampedFrequency) {
  const auto peaks =
      response::find_peaks(six_masses(0.0, 0.2), {1.0, 1000.0, response::Output::velocity});
  ASSERT_EQ(peaks.size(), 6U);
  EXPECT_NEAR(peaks[2].omega, 30.0, 30.0 * 1e-7);
  EXPECT_NEAR(peaks[2].magnitude, 1.0 / (2.0 * 0.2 * 30.0), 1e-12);
}

/// Two coupled coordinates: each shows the other's mode as a peak that is not its own.
TEST(Peaks, OfCoupledDirectionsBelongToTheModeOfTheOther) {
  constexpr double zeta = 0.005, coupling = 300.0;
  const auto model = six_masses(coupling, zeta);
  const auto peaks = response::find_peaks(model, {1.0, 1000.0});
  const auto x = in_direction(peaks, 0), ry = in_direction(peaks, 4);
  ASSERT_EQ(x.size(), 2U);
  ASSERT_EQ(ry.size(), 2U);
  EXPECT_TRUE(x[0].own);
  EXPECT_FALSE(x[1].own);
  EXPECT_FALSE(ry[0].own);
  EXPECT_TRUE(ry[1].own);
  EXPECT_EQ(x[1].mode, ry[1].mode);
  EXPECT_EQ(response::count_own(peaks, 0), 1);
  EXPECT_EQ(response::count_own(peaks, 4), 1);

  // H_xx of two coupled coordinates written down, and scanned finely
  const double turn = 0.5 * std::atan2(2.0 * coupling, 2500.0 - 100.0);
  const double half = std::hypot(1200.0, coupling);
  const auto H_xx = [&](double omega) {
    const auto term = [&](double lambda) {
      return 1.0 / std::complex(lambda - omega * omega, 2.0 * zeta * std::sqrt(lambda) * omega);
    };
    return std::abs(std::pow(std::cos(turn), 2) * term(1300.0 - half) +
                    std::pow(std::sin(turn), 2) * term(1300.0 + half));
  };
  constexpr double step = 1e-5;
  double valley = 1e300, top = 0.0, at_top = 0.0;
  for (double omega = 45.0; omega < 51.0; omega += step) {
    const double height = H_xx(omega);
    if (height < valley) valley = height;
    if (omega < 50.2 || height < top) continue;
    top = height;
    at_top = omega;
  }
  EXPECT_NEAR(x[1].omega, at_top, 2.0 * step);
  EXPECT_NEAR(x[1].magnitude / top, 1.0, 1e-8);
  EXPECT_TRUE(std::isinf(x[0].prominence_db));
  constexpr double sampled_valley = 0.05;  // [dB]: peaks are refined, valleys are not
  EXPECT_NEAR(x[1].prominence_db, 20.0 * std::log10(top / valley), sampled_valley);
}

/// A weak resonance between two strong ones: their terms of the modal sum are larger there, and the
/// peak is that of the weak one.
TEST(Peaks, OfAResponseBetweenTwoDirectionsBelongToTheModeAtTheirFrequency) {
  constexpr double zeta = 0.005, weak = 37.0;
  LinearModel linear{.kind = ModelKind::rigid, .p_BC = spatial::Vector3::Zero()};
  linear.platform_mass.setIdentity();
  linear.M.setIdentity(6, 6);
  linear.K.setZero(6, 6);
  linear.C.setZero(6, 6);
  for (int d = 0; d < 6; ++d) linear.K(d, d) = 100.0 * (1.0 + d) * (1.0 + d);
  linear.K(0, 4) = linear.K(4, 0) = 300.0;
  for (const int d : {0, 4}) linear.K(d, 2) = linear.K(2, d) = weak;
  const auto model =
      response::response_model(linear, modal::normal_modes(linear), zeta, spatial::Vector3::Zero());
  constexpr int own = 2;
  const double omega = model.modes.omega(own);
  ASSERT_NEAR(omega, 30.0, 0.1);
  const auto term = [&](int k) {
    const auto phi = model.modes.shapes.col(k);
    const double omega_k = model.modes.omega(k);
    return std::abs(phi[0] * phi[4]) /
           std::abs(std::complex(omega_k * omega_k - omega * omega, 2.0 * zeta * omega_k * omega));
  };
  ASSERT_LT(term(own), term(0)) << "the largest term is that of another mode";
  EXPECT_EQ(response::mode_behind(model, omega, 0, 4), own);
  EXPECT_EQ(response::mode_behind(model, omega, 4, 0), own);
  EXPECT_EQ(response::mode_behind(model, model.modes.omega(0), 0, 4), 0);
  EXPECT_EQ(response::mode_behind(model, model.modes.omega(4), 0, 4), 4);
}

TEST(Peaks, OfLinesAreThoseThatStandOutEnough) {
  const auto found = response::line_peaks({1.0, 4.0, 2.0, 3.0, 1.0, 8.0, 7.9, 8.1, 0.5}, 3.0);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].line, 1U);
  EXPECT_EQ(found[1].line, 3U);
  EXPECT_EQ(found[2].line, 7U);
  EXPECT_NEAR(found[1].prominence_db, 20.0 * std::log10(1.5), 1e-12);
  EXPECT_TRUE(std::isinf(found[2].prominence_db));
}

/// Between two higher peaks: above the higher one of the valleys on either side, wherever that is.
TEST(Peaks, AreJudgedByTheHigherOfTheValleysBesideThem) {
  constexpr double zeta = 0.01;
  LinearModel model{.kind = ModelKind::rigid, .p_BC = spatial::Vector3::Zero()};
  model.platform_mass.setIdentity();
  model.M.setIdentity(6, 6);
  model.K = 1e6 * Eigen::MatrixXd::Identity(6, 6);
  model.C.setZero(6, 6);
  model.K.topLeftCorner(3, 3) << 1093.0, -13.0, 550.0, -13.0, 1168.0, -557.0, 550.0, -557.0, 1945.0;
  const auto machine =
      response::response_model(model, modal::normal_modes(model), zeta, spatial::Vector3::Zero());
  const auto z = in_direction(response::find_peaks(machine, {5.0, 70.0}), 2);
  ASSERT_EQ(z.size(), 3U);

  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(model.K.topLeftCorner<3, 3>());
  const auto H_zz = [&](double omega) {
    std::complex<double> sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double lambda = modes.eigenvalues()[k];
      sum += std::pow(modes.eigenvectors()(2, k), 2) /
             std::complex(lambda - omega * omega, 2.0 * zeta * std::sqrt(lambda) * omega);
    }
    return std::abs(sum);
  };
  const auto lowest = [&](double from, double to) {
    double valley = 1e300;
    for (double omega = from; omega < to; omega += 1e-4) valley = std::min(valley, H_zz(omega));
    return valley;
  };
  const double left = lowest(z[0].omega, z[1].omega), right = lowest(z[1].omega, z[2].omega);
  ASSERT_GT(left, 1.5 * right);
  constexpr double sampled_valley = 0.05;  // [dB]: peaks are refined, valleys are not
  EXPECT_NEAR(z[1].prominence_db, 20.0 * std::log10(z[1].magnitude / left), sampled_valley);
}

/// A well damped peak lies below its mode, here nearer to one that moves y alone; and a shape times
/// −1 is the same mode.
TEST(Peaks, BelongToTheModeThatMakesThemNotToTheNearest) {
  constexpr double zeta = 0.2;
  LinearModel linear{.kind = ModelKind::rigid, .p_BC = spatial::Vector3::Zero()};
  linear.platform_mass.setIdentity();
  linear.M.setIdentity(6, 6);
  linear.K = 1e6 * Eigen::MatrixXd::Identity(6, 6);
  linear.C.setZero(6, 6);
  const double below = std::sqrt(1.0 - 2.0 * zeta * zeta);
  linear.K(0, 0) = 31.0 * 31.0;
  linear.K(1, 1) = std::pow(31.0 * below, 2);
  for (const double sign : {1.0, -1.0}) {
    auto model = response::response_model(linear, modal::normal_modes(linear), zeta,
                                          spatial::Vector3::Zero());
    model.modes.shapes *= sign;
    const auto x = in_direction(response::find_peaks(model, {5.0, 100.0}), 0);
    ASSERT_EQ(x.size(), 1U);
    EXPECT_NEAR(x[0].omega, 31.0 * below, 1e-6);
    EXPECT_NEAR(model.modes.omega(x[0].mode), 31.0, 1e-9);
    EXPECT_TRUE(x[0].own);
  }
}

TEST(Peaks, LowerThanAskedAreLeftOut) {
  const auto model = six_masses(300.0, 0.005);
  const auto all = in_direction(response::find_peaks(model, {1.0, 1000.0}), 0);
  ASSERT_EQ(all.size(), 2U);
  const double prominence = all[1].prominence_db;
  const auto count = [&](double least) {
    return in_direction(response::find_peaks(model, {1.0, 1000.0, {}, least}), 0).size();
  };
  EXPECT_EQ(count(prominence - 0.1), 2U);
  EXPECT_EQ(count(prominence + 0.1), 1U);
}

TEST(Peaks, OutsideTheBandAreLeftOut) {
  const auto peaks = response::find_peaks(six_masses(0.0, 0.01), {25.0, 45.0});
  ASSERT_EQ(peaks.size(), 2U);
  EXPECT_EQ(peaks[0].direction, 2);
  EXPECT_EQ(peaks[1].direction, 3);
  EXPECT_THROW(response::find_peaks(six_masses(0.0, 0.01), {45.0, 25.0}), std::invalid_argument);
}

TEST(Peaks, WithoutDampingAreUnboundedOnePerModeThatTakesPart) {
  const auto peaks = response::find_peaks(six_masses(300.0, 0.0), {1.0, 1000.0});
  EXPECT_EQ(peaks.size(), 8U);
  for (const auto& peak : peaks) {
    EXPECT_TRUE(std::isinf(peak.magnitude));
    EXPECT_FALSE(std::isnan(peak.omega));
  }
  EXPECT_EQ(response::count_own(peaks, 0), 1);
}

/// Counted from 15 rad/s, a third of the lowest mode, to twice the highest of the platform's own.
std::array<int, 6> own_resonances(const model::Machine& machine, ModelKind kind, double modal_ratio,
                                  double to = 400.0) {
  const auto linear = dynamics::linear_model(machine, machine.neutral(), kind);
  const auto modes = modal::normal_modes(linear);
  const auto model =
      response::response_model(linear, modes, modal_ratio, machine.platform.mass_center);
  const auto peaks = response::find_peaks(model, {15.0, to});
  std::array<int, 6> own{};
  for (int d = 0; d < 6; ++d) own[d] = response::count_own(peaks, d);
  return own;
}

/// The paper's Figs. 6, 7 and 9, counted.
TEST(PublishedMachine, HasTwoResonancesInXAndYAndOneElsewhere) {
  const auto machine =
      model::read_machine_file(source_file("models/zhang-jiang-2021.toml").string()).machine;
  const double ratio = modal::modal_ratio(machine).value;
  EXPECT_THAT(own_resonances(machine, ModelKind::guide, ratio),
              testing::ElementsAre(2, 2, 1, 1, 1, 1));
  EXPECT_THAT(own_resonances(machine, ModelKind::rigid, ratio), testing::Each(1));
}

/// The second resonance is the seals': it goes when they are made stiff.
TEST(PublishedMachine, HasOneResonanceEverywhereOnStiffSeals) {
  auto machine =
      model::read_machine_file(source_file("models/zhang-jiang-2021.toml").string()).machine;
  const double ratio = modal::modal_ratio(machine).value;
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= 1e4;
  EXPECT_THAT(own_resonances(machine, ModelKind::guide, ratio), testing::Each(1));
}

/// "The machine itself shows a third in x and y, from the piston ring" (section 9).
TEST(PublishedMachine, ShowsAThirdResonanceWithPistonRings) {
  auto machine =
      model::read_machine_file(source_file("models/zhang-jiang-2021.toml").string()).machine;
  const double ratio = modal::modal_ratio(machine).value;
  for (auto& leg : machine.legs) leg.piston_ring = model::PistonRing{.stiffness = 4e5};
  const auto own = own_resonances(machine, ModelKind::full, ratio, 4000.0);
  EXPECT_EQ(own[0], 3);
  EXPECT_EQ(own[1], 3);
}

}  // namespace
}  // namespace hydrapod::test
