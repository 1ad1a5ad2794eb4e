#pragma once
/// Straight beams in a plane by Euler and Bernoulli: elements with cubic shapes, consistent mass
/// and geometric stiffness (Przemieniecki, Theory of Matrix Structural Analysis, 1968).

#include <Eigen/Core>
#include <array>
#include <vector>

namespace hydrapod::test {

class PlaneBeams {
 public:
  static constexpr int held = -1;

  struct Span {
    double length{};       ///< [m]
    double EI{};           ///< [N m²]
    double mu{};           ///< [kg/m]
    double compression{};  ///< [N]
  };

  /// A new deflection [m] or slope [rad].
  int freedom() { return freedoms_++; }
  /// A beam between two deflections and slopes, {w, θ, w, θ}.
  void add(const std::array<int, 4>& ends, const Span& span, int elements);
  /// A spring between two deflections.
  void add_spring(int a, int b, double k);
  void add_mass(int at, double m);

  [[nodiscard]] Eigen::MatrixXd stiffness() const { return assembled(stiffness_); }
  [[nodiscard]] Eigen::MatrixXd mass() const { return assembled(mass_); }
  /// b − a for a unit pair of forces that drives them apart.
  [[nodiscard]] double compliance(int a, int b) const;
  /// Lowest ω² of K v = ω² M v.
  [[nodiscard]] double lowest_omega2() const;

 private:
  struct Entry {
    int row{}, column{};
    double value{};
  };
  [[nodiscard]] Eigen::MatrixXd assembled(const std::vector<Entry>& entries) const;

  int freedoms_{};
  std::vector<Entry> stiffness_{}, mass_{};
};

}  // namespace hydrapod::test
