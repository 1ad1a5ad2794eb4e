#pragma once
/// Modes of a hexapod with six equal legs, known in closed form.
///
/// Six equal legs in alternating mirror images, pose neutral, no gravity, transverse axes: the
/// heave z and the yaw rz are symmetry classes of their own, in which all legs do the same. Each is
/// then one platform coordinate and one knee, the roots of a quadratic. Written down from the plane
/// motion of one leg (case turns by ω, the rod by ω + ψ, l ω + l_mn ψ = v), not from the library.

#include <array>
#include <cmath>

#include "hydrapod/model/machine.hpp"

namespace hydrapod::test {

class SymmetricHexapod {
 public:
  /// `machine`: equal legs, as above; guide-sleeve stiffness and masses are those of leg 1.
  explicit SymmetricHexapod(const model::Machine& machine)
      : leg_(machine.legs[0]), platform_(machine.platform) {
    const spatial::Vector3 a = machine.neutral() * leg_.platform_joint;
    const spatial::Vector3 along = a - leg_.base_joint;
    l_ = along.norm();
    n_ = along / l_;
    radius_ = leg_.platform_joint.head<2>().norm();
    const spatial::Vector3 e = spatial::Vector3(-a.y(), a.x(), 0.0) / radius_;
    n_e_ = n_.dot(e);
  }

  /// ω² of heave and of yaw with rigid legs.
  [[nodiscard]] double heave_rigid() const { return rigid(platform_.mass, 1.0, n_.z()); }
  [[nodiscard]] double yaw_rigid() const { return rigid(platform_.inertia(2, 2), radius_, n_e_); }

  /// ω² with guide sleeves that give way, ascending.
  [[nodiscard]] std::array<double, 2> heave() const {
    return with_knees(platform_.mass, 1.0, n_.z());
  }
  [[nodiscard]] std::array<double, 2> yaw() const {
    return with_knees(platform_.inertia(2, 2), radius_, n_e_);
  }

  /// Knee of one leg between fixed joints: l ω = −l_mn ψ.
  [[nodiscard]] double knee_mass() const { return mass_of(-leg_.rod.length / l_, 1.0); }
  [[nodiscard]] double knee_stiffness() const {
    const double l_mh = leg_.guide_sleeve.position - (l_ - leg_.rod.length);
    return leg_.guide_sleeve.stiffness * l_mh * l_mh;
  }

 private:
  model::Leg leg_;
  model::Platform platform_;
  double l_{}, radius_{}, n_e_{};
  spatial::Vector3 n_{};

  /// 2T of a leg in a plane for ω and ψ.
  [[nodiscard]] double mass_of(double omega, double psi) const {
    const auto& tube = leg_.cylinder_case;
    const auto& rod = leg_.rod;
    const double r_a = l_ - rod.length + rod.mass_center;
    return (tube.mass * tube.mass_center * tube.mass_center + tube.transverse_inertia) * omega *
               omega +
           rod.mass * std::pow(r_a * omega + rod.mass_center * psi, 2) +
           rod.transverse_inertia * std::pow(omega + psi, 2);
  }

  /// Mass that moves with a platform coordinate whose joints move by `arm`, along the leg by `n`.
  [[nodiscard]] double rigid_mass(double platform, double arm, double n) const {
    const double axial = (leg_.rod.mass + leg_.added_axial_inertia) * n * n;
    const double across = mass_of(std::sqrt(1.0 - n * n) / l_, 0.0);
    return platform + 6.0 * arm * arm * (axial + across);
  }
  [[nodiscard]] double oil(double arm, double n) const {
    return 6.0 * *leg_.oil_spring.stiffness * arm * arm * n * n;
  }
  [[nodiscard]] double rigid(double platform, double arm, double n) const {
    return oil(arm, n) / rigid_mass(platform, arm, n);
  }

  [[nodiscard]] std::array<double, 2> with_knees(double platform, double arm, double n) const {
    const double v = arm * std::sqrt(1.0 - n * n);
    const double m_11 = rigid_mass(platform, arm, n), k_11 = oil(arm, n);
    const double m_22 = 6.0 * knee_mass(), k_22 = 6.0 * knee_stiffness();
    // 2T is a quadratic form in (v, ψ); its mixed term by polarisation
    const double fold = -leg_.rod.length / l_;
    const double m_12 = 3.0 * (mass_of(v / l_ + fold, 1.0) - mass_of(v / l_, 0.0) - knee_mass());
    // (k_11 − λ m_11)(k_22 − λ m_22) = (λ m_12)²
    const double a = m_11 * m_22 - m_12 * m_12;
    const double b = k_11 * m_22 + k_22 * m_11;
    const double root = std::sqrt(b * b - 4.0 * a * k_11 * k_22);
    return {2.0 * k_11 * k_22 / (b + root), (b + root) / (2.0 * a)};
  }
};

}  // namespace hydrapod::test
