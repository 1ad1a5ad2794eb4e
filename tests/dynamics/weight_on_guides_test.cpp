/// Machines whose weight lays their rods on guide rings, by potential and kinetic energy alone:
/// complex arithmetic, derivatives by complex steps, loads increased from zero. Nothing of the
/// library but the numbers of the machine and the stiffness of its oil springs.
/// `build/test/tests/dynamics --gtest_filter=*WeightOnGuides*` prints the first table of
/// docs/validation/guide-contact.md.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <iostream>
#include <numbers>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "support/calibration_machine.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using Complex = std::complex<double>;
using Vector3c = Eigen::Vector3cd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using spatial::Matrix3;
using spatial::Vector3;

/// Of complex numbers without conjugation, so that it is analytic.
Complex times(const Vector3c& a, const Vector3c& b) { return (a.transpose() * b).value(); }

/// A leg whose piston stays on the axis of the case (no piston ring).
struct EnergyLeg {
  Vector3c n{}, e{}, rod_center{};  ///< directions of case and rod; mass centre of the rod [m]
  Complex s{}, offset2{};           ///< extension [m]; square of the offset at the sleeve [m²]
};

/// Platform (translation, rotation vector), then per leg two components of the direction of the
/// case across that of the straight leg. `rigid`: straight legs, six coordinates.
class EnergyMachine {
 public:
  EnergyMachine(const model::Machine& machine, bool rigid)
      : machine_(machine), rigid_(rigid), q_(VectorXd::Zero(rigid ? 6 : 18)) {
    for (int i = 0; i < model::leg_count; ++i) {
      const auto& leg = machine.legs[static_cast<std::size_t>(i)];
      Matrix3 axes;
      axes.col(2) = (machine.neutral() * leg.platform_joint - leg.base_joint).normalized();
      axes.col(0) = axes.col(2).cross(Vector3(0.3, -0.7, 0.1)).normalized();
      axes.col(1) = axes.col(2).cross(axes.col(0));
      axes_.push_back(axes);
    }
  }

  /// Loads increased from zero, the platform held by the forces of the oil.
  void stand() {
    constexpr int steps = 60, newton = 50;
    constexpr double still = 1e-12;  // [rad]
    for (int step = 1; step <= steps; ++step) {
      load_ = static_cast<double>(step) / steps;
      for (int k = 0; k < newton; ++k) {
        const auto n = q_.size();
        MatrixXd rates(n, n);
        rates.leftCols(n - 6) = hessian(true).rightCols(n - 6);
        for (int i = 0; i < model::leg_count; ++i)
          rates.col(n - 6 + i) = gradient([&](const VectorXcd& q) { return leg(i, q).s; });
        const VectorXd change = rates.lu().solve(slope(q_, true));
        q_.tail(n - 6) -= change.head(n - 6);
        force_ -= change.tail(6);
        if (n == 6 || change.head(n - 6).norm() < still) break;
      }
    }
    for (int i = 0; i < model::leg_count; ++i) s_0_[i] = leg(i, q_.cast<Complex>()).s.real();
  }

  [[nodiscard]] double largest_offset() const {
    double largest = 0.0;
    for (int i = 0; i < model::leg_count; ++i)
      largest = std::max(largest, std::sqrt(leg(i, q_.cast<Complex>()).offset2.real()));
    return largest;
  }

  [[nodiscard]] MatrixXd stiffness() const { return hessian(false); }

  [[nodiscard]] MatrixXd mass() const {
    MatrixXd M = MatrixXd::Zero(q_.size(), q_.size());
    const auto add = [&](double mass, const auto& point) {
      for (int k = 0; k < 3; ++k) {
        const VectorXd rate = gradient([&](const VectorXcd& q) { return Complex(point(q)[k]); });
        M += mass * rate * rate.transpose();
      }
    };
    add(machine_.platform.mass, [&](const VectorXcd& q) { return center(q); });
    const Matrix3& R = machine_.neutral().R_BP;
    M.block<3, 3>(3, 3) += R * machine_.platform.inertia * R.transpose();
    for (int i = 0; i < model::leg_count; ++i) {
      const auto& m = machine_.legs[static_cast<std::size_t>(i)];
      add(m.cylinder_case.mass * std::pow(m.cylinder_case.mass_center, 2) +
              m.cylinder_case.transverse_inertia,
          [&](const VectorXcd& q) { return leg(i, q).n; });
      add(m.rod.mass, [&](const VectorXcd& q) { return leg(i, q).rod_center; });
      add(m.rod.transverse_inertia, [&](const VectorXcd& q) { return leg(i, q).e; });
      const VectorXd rate = gradient([&](const VectorXcd& q) { return leg(i, q).s; });
      M += m.added_axial_inertia * rate * rate.transpose();
    }
    return M;
  }

  /// A motion of rigid legs in the coordinates of this machine: cases turn with the joints.
  [[nodiscard]] VectorXd with_cases_along(const VectorXd& platform) const {
    VectorXd all = VectorXd::Zero(q_.size());
    all.head<6>() = platform;
    for (int i = 0; i < model::leg_count; ++i)
      for (int k = 0; k < 2; ++k) {
        const VectorXd rate = gradient([&](const VectorXcd& q) {
          const Vector3c L = between_joints(i, q);
          return Complex(times(axes_[static_cast<std::size_t>(i)].col(k).cast<Complex>(), L) /
                         std::sqrt(times(L, L)));
        });
        all[6 + 2 * i + k] = rate.head<6>().dot(platform);
      }
    return all;
  }

 private:
  [[nodiscard]] Vector3c turned(const Vector3c& r, const VectorXcd& q) const {
    const auto by = [&](const Vector3c& a) {
      return Vector3c(q[4] * a[2] - q[5] * a[1], q[5] * a[0] - q[3] * a[2],
                      q[3] * a[1] - q[4] * a[0]);
    };
    return r + by(r) + 0.5 * by(by(r)) + by(by(by(r))) / 6.0;  // of the exponential
  }
  [[nodiscard]] Vector3c on_platform(const Vector3& p_P, const VectorXcd& q) const {
    const auto& X = machine_.neutral();
    return X.p_BP.cast<Complex>() + q.head<3>() + turned((X.R_BP * p_P).cast<Complex>(), q);
  }
  [[nodiscard]] Vector3c center(const VectorXcd& q) const {
    return on_platform(machine_.platform.mass_center, q);
  }
  [[nodiscard]] Vector3c between_joints(int i, const VectorXcd& q) const {
    const auto& leg = machine_.legs[static_cast<std::size_t>(i)];
    return on_platform(leg.platform_joint, q) - leg.base_joint.cast<Complex>();
  }

  [[nodiscard]] EnergyLeg leg(int i, const VectorXcd& q) const {
    const auto& of = machine_.legs[static_cast<std::size_t>(i)];
    const auto& axes = axes_[static_cast<std::size_t>(i)];
    const Vector3c L = between_joints(i, q);
    EnergyLeg leg;
    if (rigid_) {
      leg.n = leg.e = L / std::sqrt(times(L, L));
      leg.s = std::sqrt(times(L, L)) - of.rod.length;
    } else {
      const Complex t = q[6 + 2 * i], u = q[7 + 2 * i];
      leg.n = axes.cast<Complex>() * Vector3c(t, u, std::sqrt(1.0 - t * t - u * u));
      const Complex along = times(leg.n, L);
      leg.s = along - std::sqrt(of.rod.length * of.rod.length - times(L, L) + along * along);
      leg.e = (L - leg.s * leg.n) / of.rod.length;
      const Complex c = times(leg.e, leg.n);
      const Vector3c d = (of.guide_sleeve.position - leg.s) * (leg.e - c * leg.n) / c;
      leg.offset2 = times(d, d);
    }
    leg.rod_center = of.base_joint.cast<Complex>() + leg.s * leg.n + of.rod.mass_center * leg.e;
    return leg;
  }

  /// Of a ring whose force is k_c h(|d| − gap), h the ramp with its corner rounded over ± gap/10.
  static Complex ring_energy(const model::GuideSleeve& sleeve, const Complex& offset2) {
    if (!sleeve.gap) return 0.0;
    const double gap = *sleeve.gap, w = 0.1 * gap;
    const double sharp = std::sqrt(std::max(0.0, offset2.real())) - gap;
    if (sharp <= -w) return 0.0;
    const Complex beyond = std::sqrt(offset2) - gap, x = beyond / w + 1.0;
    if (sharp >= w) return 0.5 * sleeve.guide_stiffness * beyond * beyond;
    return sleeve.guide_stiffness * w * w * (std::pow(x, 4) - std::pow(x, 5) / 5.0) / 16.0;
  }

  [[nodiscard]] Complex potential(const VectorXcd& q, bool held) const {
    const Vector3c g = (load_ * machine_.gravity).cast<Complex>();
    Complex V = -machine_.platform.mass * times(g, center(q));
    for (int i = 0; i < model::leg_count; ++i) {
      const auto& of = machine_.legs[static_cast<std::size_t>(i)];
      const auto leg = this->leg(i, q);
      const Complex stretch = leg.s - s_0_[i];
      V += force_[i] * leg.s + 0.5 * of.guide_sleeve.stiffness * leg.offset2 +
           ring_energy(of.guide_sleeve, leg.offset2) -
           of.cylinder_case.mass * of.cylinder_case.mass_center * times(g, leg.n) -
           of.rod.mass * times(g, leg.rod_center);
      if (!held) V += 0.5 * hydraulics::oil_stiffness(of, s_0_[i]) * stretch * stretch;
    }
    return V;
  }

  template <class Function>
  [[nodiscard]] VectorXd gradient(const Function& f, const VectorXd& at) const {
    constexpr double h = 1e-30;
    VectorXd g(at.size());
    for (Eigen::Index k = 0; k < at.size(); ++k) {
      VectorXcd q = at.cast<Complex>();
      q[k] += Complex(0.0, h);
      g[k] = f(q).imag() / h;
    }
    return g;
  }
  template <class Function>
  [[nodiscard]] VectorXd gradient(const Function& f) const {
    return gradient(f, q_);
  }
  [[nodiscard]] VectorXd slope(const VectorXd& at, bool held) const {
    return gradient([&](const VectorXcd& q) { return potential(q, held); }, at);
  }
  [[nodiscard]] MatrixXd hessian(bool held) const {
    constexpr double h = 1e-7;
    MatrixXd H(q_.size(), q_.size());
    for (Eigen::Index k = 0; k < q_.size(); ++k) {
      VectorXd ahead = q_, behind = q_;
      ahead[k] += h;
      behind[k] -= h;
      H.col(k) = (slope(ahead, held) - slope(behind, held)) / (2.0 * h);
    }
    return 0.5 * (H + H.transpose());
  }

  const model::Machine& machine_;
  bool rigid_;
  VectorXd q_;
  std::vector<Matrix3> axes_{};
  double load_{1.0};
  Eigen::Matrix<double, 6, 1> force_{Eigen::Matrix<double, 6, 1>::Zero()},
      s_0_{Eigen::Matrix<double, 6, 1>::Zero()};
};

struct EnergyModes {
  VectorXd omega{};
  MatrixXd shapes{};  ///< φᵀ M φ = 1
};

EnergyModes modes_of(const MatrixXd& M, const MatrixXd& K) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(K, M);
  return {solver.eigenvalues().cwiseSqrt(), solver.eigenvectors()};
}

/// Of the mode of rigid legs that moves the mass centre along x: how much of it is at which
/// frequencies; modes that repeat hold it together.
struct AlongX {
  double rigid_hz{}, offset{};
  std::vector<std::pair<double, double>> shares{};  ///< frequency [Hz], share
};

constexpr double hertz_per_rad = 0.5 / std::numbers::pi;

AlongX along_x(const model::Machine& machine) {
  EnergyMachine rigid(machine, true), flexible(machine, false);
  rigid.stand();
  flexible.stand();
  const auto rigid_modes = modes_of(rigid.mass(), rigid.stiffness());
  const MatrixXd M = flexible.mass();
  const auto modes = modes_of(M, flexible.stiffness());
  EXPECT_LT((modes.omega - modal::normal_modes(dynamics::linear_model(machine, machine.neutral(),
                                                                      dynamics::ModelKind::guide))
                               .omega2.cwiseSqrt())
                .cwiseQuotient(modes.omega)
                .cwiseAbs()
                .maxCoeff(),
            machine.legs[0].guide_sleeve.gap ? 1e-4 : 1e-5);
  Eigen::Index x = 0;
  (rigid_modes.shapes.row(0).cwiseAbs2()).maxCoeff(&x);
  AlongX found{.rigid_hz = hertz_per_rad * rigid_modes.omega[x],
               .offset = flexible.largest_offset()};
  const VectorXd psi = flexible.with_cases_along(rigid_modes.shapes.col(x));
  for (Eigen::Index k = 0; k < modes.omega.size(); ++k) {
    const double share = std::pow(psi.dot(M * modes.shapes.col(k)), 2) / psi.dot(M * psi);
    const double hz = hertz_per_rad * modes.omega[k];
    if (!found.shares.empty() && std::abs(hz / found.shares.back().first - 1.0) < 1e-3)
      found.shares.back().second += share;
    else
      found.shares.emplace_back(hz, share);
  }
  std::erase_if(found.shares, [](const auto& one) { return one.second < 0.1; });
  return found;
}

/// A row of the page.
struct WeightRow {
  const char* machine;
  bool gravity, gap;
  double offset;  ///< [mm]
  double rigid_hz;
  std::vector<std::pair<double, double>> shares;
};

/// The page has damped frequencies, to the digits that are written.
TEST(WeightOnGuides, IsTheTableOfThePage) {
  const char *published = "zhang-jiang-2021-transverse", *heavy = "heavy-platform";
  const std::vector<WeightRow> rows{
      {published, false, false, 0.0, 7.455, {{7.445, 0.99}}},
      {published, true, false, 0.821, 7.438, {{4.993, 0.17}, {7.850, 0.83}}},
      {published, true, true, 0.191, 7.438, {{7.437, 1.00}}},
      {heavy, false, false, 0.0, 6.121, {{6.117, 1.00}}},
      {heavy, true, false, 3.42, 6.112, {{4.10, 0.39}, {7.15, 0.60}}},
      {heavy, true, true, 0.211, 6.112, {{6.112, 1.00}}}};
  std::cout
      << "| machine | gravity | gap | offset at the sleeve | x with rigid legs | x with seals "
         "|\n| --- | --- | --- | ---: | ---: | --- |\n";
  for (const auto& row : rows) {
    std::vector<std::string> changes{
        fmt::format("environment.gravity={}", row.gravity ? 9.80665 : 0.0)};
    if (row.gap)
      changes.insert(changes.end(),
                     {"legs.guide_sleeve.gap=0.2 mm", "legs.guide_sleeve.guide_stiffness=5e7"});
    const auto file =
        machine_file(read_text(source_file(fmt::format("models/{}.toml", row.machine))), changes);
    const auto found = along_x(file.machine);
    std::string shares;
    for (const auto& [hz, share] : found.shares)
      shares += fmt::format("{}{:.3f} Hz, {:.0f} %, {:.2f}", shares.empty() ? "" : ", and ", hz,
                            100.0 * share, share * std::pow(found.rigid_hz / hz, 2));
    std::cout << fmt::format("| {} | {} | {} | {:.3f} mm | {:.3f} Hz | {} |\n", row.machine,
                             row.gravity ? "yes" : "no", row.gap ? "0.2 mm" : "none",
                             1e3 * found.offset, found.rigid_hz, shares);
    constexpr double damped = 2e-3, written = 6e-3;
    EXPECT_NEAR(1e3 * found.offset, row.offset, written) << row.machine;
    EXPECT_NEAR(found.rigid_hz, row.rigid_hz, damped * row.rigid_hz);
    ASSERT_EQ(found.shares.size(), row.shares.size()) << shares;
    for (std::size_t k = 0; k < row.shares.size(); ++k) {
      EXPECT_NEAR(found.shares[k].first, row.shares[k].first, damped * row.shares[k].first);
      EXPECT_NEAR(found.shares[k].second, row.shares[k].second, 1.1e-2);
    }
  }
}

}  // namespace
}  // namespace hydrapod::test
