#pragma once
/// The linear model with the springs and dampers that stand for its legs at their amplitudes
/// (harmonic balance, docs/theory/amplitude.md). Private to the module.
///
/// All of it is in the coordinates of the linear modes, y = Φ q: there M is 1 and K is diag(ω_k²).

#include <vector>

#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/modal/damped_modes.hpp"

namespace hydrapod::modal {

class Swinging {
 public:
  Swinging(const model::Machine& machine, const spatial::Pose& X_BP, dynamics::ModelKind kind);

  [[nodiscard]] const LinearModel& linear() const { return linear_; }
  [[nodiscard]] const NormalModes& modes() const { return modes_; }

  /// Of the platform joint that moves most [m], and its gradient by q.
  [[nodiscard]] double amplitude(const ModelVector& q) const;
  [[nodiscard]] ModelVector amplitude_gradient(const ModelVector& q) const;

  /// Of the kinetic energy, without that of the payload's modes against the platform.
  [[nodiscard]] double platform_share(const ModelVector& q) const;

  /// K and C at the motion q and ω.
  struct Matrices {
    ModelMatrix K{}, C{};
  };
  [[nodiscard]] Matrices at(const ModelVector& q, double omega) const;
  /// ∂(K q)/∂q. `K`: that at q and ω.
  [[nodiscard]] ModelMatrix tangent(const ModelMatrix& K, const ModelVector& q, double omega) const;

  /// What is told of the motion q at ω.
  [[nodiscard]] ModeAtAmplitude described(const ModelVector& q, double omega) const;

 private:
  using Vector2 = dynamics::Vector2;
  using Rows2 = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, dynamics::max_dof>;
  using Rows3 = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, dynamics::max_dof>;
  using Stiffness = Eigen::Matrix2cd;
  enum class What { sleeve, ring, friction };
  /// What of a leg is not linear, at an offset or a turning of two components.
  struct Element {
    What what{};
    std::size_t leg{};
    Rows2 rows{};                     ///< offset per q
    hydraulics::Friction friction{};  ///< of pistons and joints
  };
  /// The guide sleeve where the rod's chord swings by some amplitude.
  struct Sleeve {
    Vector2 seal{};  ///< amplitude at the seal
    dynamics::GuideEquivalent guide{};
    double left{1.0};  ///< share of the seal's stiffness that softening leaves
  };

  void add_leg(const model::Machine& machine, int i);
  void add_friction(const model::Machine& machine, int i);
  [[nodiscard]] Sleeve sleeve_at(std::size_t leg, const Vector2& chord, double omega) const;
  [[nodiscard]] Stiffness of_sleeve(std::size_t leg, const Vector2& chord, double omega) const;
  /// What comes on top of the linear model.
  [[nodiscard]] Stiffness stiffness(const Element& element, const Vector2& offset,
                                    double omega) const;

  model::Machine machine_;
  LinearModel linear_;
  NormalModes modes_;
  std::vector<dynamics::RelaxingArm> arms_{};  ///< of the linear model, per q
  ModelMatrix C_{};                            ///< of the linear model, without its arms
  std::vector<Element> elements_{};
  std::array<dynamics::SealArms, model::leg_count> sleeve_arms_{}, ring_arms_{};
  std::array<Rows2, model::leg_count> chords_{};         ///< of rods at their guide sleeves, per q
  std::array<ModelVector, model::leg_count> pistons_{};  ///< along the cases
  std::array<Rows3, model::leg_count> joints_{};         ///< of the platform
};

/// The mode of K most like q, with those that hardly differ in frequency: any combination of these
/// is a mode.
ModelVector most_like(const ModelVector& q, const ModelMatrix& K);

/// (K − ω²) q over |q| ω_0² at u = (q/size, ω/rate), and its derivatives by u into the first rows
/// of A. `size`: |q| of the unit of u, `rate`: ω_0.
Eigen::VectorXd balance_residual(const Swinging& swinging, const Eigen::VectorXd& u, double size,
                                 double rate, Eigen::MatrixXd& A);
/// A⁻¹ right, of these derivatives above one further row. Where modes repeat A is singular: any
/// combination of them is balanced, and none is sought.
Eigen::VectorXd solution_of_balance(const Eigen::MatrixXd& A, const Eigen::VectorXd& right);

/// The linear modes per q, where branches begin: pairs of repeated ones are turned to those of
/// their combinations that stay balanced as amplitudes grow.
ModelMatrix shapes_to_begin_with(const Swinging& swinging);

}  // namespace hydrapod::modal
