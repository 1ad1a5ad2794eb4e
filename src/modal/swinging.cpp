#include "swinging.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::modal {

namespace {

using dynamics::ModelKind;
using dynamics::Vector2;
using Rows27 = Eigen::Matrix<double, 2, dynamics::leg_coordinates>;
using Rows2 = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, dynamics::max_dof>;
using Complex = std::complex<double>;

/// k + Σ κ iω/(iω + λ).
Complex with_arms(double k, const dynamics::SealArms& arms, double omega) {
  Complex sum = k;
  for (const auto& arm : arms)
    if (arm.stiffness > 0.0) sum += arm.stiffness * Complex(0.0, omega) / Complex(arm.rate, omega);
  return sum;
}

/// Stiffness of a seal in series with what bends.
Eigen::Matrix2cd in_series(const Eigen::Matrix2cd& seal, double bending) {
  if (bending == 0.0) return seal;
  return (Eigen::Matrix2cd::Identity() + bending * seal).inverse() * seal;
}

double softened(const std::optional<model::Elastomer>& elastomer, double amplitude) {
  return elastomer ? dynamics::softened(*elastomer, amplitude) : 1.0;
}

bool softens(const std::optional<model::Elastomer>& elastomer) {
  return elastomer && elastomer->softening > 0.0;
}

/// Per coordinate y.
template <int count>
auto rows_of(const LinearModel& model, int leg, const Eigen::Matrix<double, count, 7>& per_x) {
  Eigen::Matrix<double, count, Eigen::Dynamic, 0, count, dynamics::max_dof> rows(count,
                                                                                 model.dof());
  for (int k = 0; k < count; ++k) rows.row(k) = dynamics::per_coordinate(model, leg, per_x.row(k));
  return rows;
}

/// Turning of a leg's axis in its base joint along t and a2, ṅ per x of the straight leg; with
/// `rod` that of the rod, ė.
Rows27 turning(const dynamics::LegElement& leg, double l_mn, bool rod) {
  Rows27 rows = Rows27::Zero();
  for (const int k : {0, 1}) {
    const int tilt = k == 0 ? 4 : 3;  // about a2 towards t, about t away from a2
    const double sign = k == 0 ? 1.0 : -1.0;
    rows(k, k) = 1.0 / leg.l;
    rows(k, 5 + k) = -1.0 / leg.l;
    rows(k, tilt) = sign * ((rod ? 1.0 : 0.0) - l_mn / leg.l);
  }
  return rows;
}

hydraulics::Friction joint_law(const model::JointFriction& given) {
  hydraulics::Friction law;
  law.coulomb = law.breakaway = given.coulomb;
  law.smoothing_velocity = given.smoothing_rate;
  law.bristle_stiffness = given.bristle_stiffness.value_or(0.0);
  law.bristle_damping = given.bristle_damping;
  return law;
}

/// Bristles say at every amplitude how much of them sticks.
model::Machine with_bristles_alone(model::Machine machine) {
  for (auto& leg : machine.legs)
    if (leg.hydraulics.friction.bristles) leg.stick_stiffness = 0.0;
  return machine;
}

}  // namespace

Swinging::Swinging(const model::Machine& machine, const spatial::Pose& X_BP,
                   dynamics::ModelKind kind)
    : machine_(dynamics::with_pressed_seals(with_bristles_alone(machine), kind, X_BP)),
      linear_(dynamics::linear_model(machine_, X_BP, kind)),
      modes_(normal_modes(linear_)),
      arms_(linear_.arms),
      C_(modes_.shapes.transpose() * linear_.C * modes_.shapes) {
  for (auto& arm : arms_) arm.s_y = modes_.shapes.transpose() * arm.s_y;
  for (int i = 0; i < model::leg_count; ++i) add_leg(machine, i);
}

void Swinging::add_leg(const model::Machine& machine, int i) {
  const auto k = static_cast<std::size_t>(i);
  const auto& leg = linear_.legs[k];
  const auto& sleeve = machine_.legs[k].guide_sleeve;
  const auto& ring = machine_.legs[k].piston_ring;
  joints_[k] = rows_of<3>(linear_, i, Eigen::Matrix<double, 3, 7>::Identity()) * modes_.shapes;
  pistons_[k] = modes_.shapes.transpose() * dynamics::per_coordinate(linear_, i, leg.s_x);
  chords_[k] = rows_of<2>(linear_, i, leg.d_x + leg.bending * leg.F_x) * modes_.shapes;
  if (linear_.kind != ModelKind::rigid) {
    if (sleeve.elastomer)
      sleeve_arms_[k] = dynamics::seal_arms(sleeve.stiffness, *sleeve.elastomer);
    if (sleeve.gap || softens(sleeve.elastomer))
      elements_.push_back({.what = What::sleeve, .leg = k, .rows = chords_[k]});
  }
  if (linear_.kind == ModelKind::full && softens(ring->elastomer)) {
    ring_arms_[k] = dynamics::seal_arms(ring->stiffness, *ring->elastomer);
    elements_.push_back(
        {.what = What::ring, .leg = k, .rows = rows_of(linear_, i, leg.u_x) * modes_.shapes});
  }
  add_friction(machine, i);
}

void Swinging::add_friction(const model::Machine& machine, int i) {
  const auto k = static_cast<std::size_t>(i);
  const auto add = [&](const Rows2& per_q, const hydraulics::Friction& law) {
    if (law.breakaway > 0.0)
      elements_.push_back({.what = What::friction, .leg = k, .rows = per_q, .friction = law});
  };
  Rows2 piston = Rows2::Zero(2, linear_.dof());
  piston.row(0) = pistons_[k];
  if (model::leg_type(machine) == model::LegType::cylinder)
    add(piston, hydraulics::servo_axis(machine, i).friction);
  const auto law = joint_law(machine.legs[k].hydraulics.joint_friction);
  const double l_mn = machine.legs[k].rod.length;
  add(rows_of(linear_, i, turning(linear_.legs[k], l_mn, false)) * modes_.shapes, law);
  // In the platform joint that of the rod against the platform.
  const auto& R_BL = linear_.legs[k].frame.R_BL;
  const Rows2 rod = rows_of(linear_, i, turning(linear_.legs[k], l_mn, true));
  Rows2 against_platform = rod;
  const auto rotation = linear_.against_base.bottomRows<3>();
  against_platform.row(0) -= R_BL.col(1).transpose() * rotation;
  against_platform.row(1) += R_BL.col(0).transpose() * rotation;
  add(against_platform * modes_.shapes, law);
}

double Swinging::amplitude(const ModelVector& q) const {
  double largest = 0.0;
  for (const auto& joint : joints_) largest = std::max(largest, (joint * q).norm());
  return largest;
}

ModelVector Swinging::amplitude_gradient(const ModelVector& q) const {
  const auto& joint = *std::ranges::max_element(
      joints_, {}, [&](const Rows3& rows) { return (rows * q).squaredNorm(); });
  return joint.transpose() * (joint * q).normalized();
}

double Swinging::platform_share(const ModelVector& q) const {
  const spatial::Vector6 v = modes_.shapes.topRows<6>() * q;
  return v.dot(linear_.platform_mass * v) / q.squaredNorm();
}

/// With what bends in series, the amplitude of the seal, taken along the chord's, is a share of it
/// that falls as seal and guide ring grow stiffer.
Swinging::Sleeve Swinging::sleeve_at(std::size_t leg, const Vector2& chord, double omega) const {
  const auto& sleeve = machine_.legs[leg].guide_sleeve;
  const auto& element = linear_.legs[leg];
  const Complex seal = with_arms(sleeve.stiffness, sleeve_arms_[leg], omega);
  const auto at = [&](double share) -> Sleeve {
    const Vector2 amplitude = share * chord;
    return {amplitude, dynamics::guide_equivalent(sleeve, element.sleeve_offset, amplitude),
            softened(sleeve.elastomer, amplitude.norm())};
  };
  const double whole = chord.norm();
  if (element.bending == 0.0 || whole == 0.0) return at(1.0);
  const auto excess = [&](double share) {
    const auto found = at(share);
    const Vector2 along = chord / whole;
    const Complex k = found.left * seal + along.dot(found.guide.stiffness * along);
    return share * std::abs(1.0 + element.bending * k) - 1.0;
  };
  constexpr int digits = 44;  // of 53 bits
  std::uintmax_t most = 60;
  const auto ends = boost::math::tools::toms748_solve(
      excess, 0.0, 1.0, boost::math::tools::eps_tolerance<double>(digits), most);
  return at(0.5 * (ends.first + ends.second));
}

Swinging::Stiffness Swinging::of_sleeve(std::size_t leg, const Vector2& chord, double omega) const {
  const auto& element = linear_.legs[leg];
  const auto at = sleeve_at(leg, chord, omega);
  const Complex seal =
      with_arms(machine_.legs[leg].guide_sleeve.stiffness, sleeve_arms_[leg], omega);
  const Stiffness one = Stiffness::Identity();
  const Stiffness before =
      (seal + element.k_contact) * one + element.contact_root * element.contact_root.transpose();
  const Stiffness now = at.left * seal * one + at.guide.stiffness;
  return in_series(now, element.bending) - in_series(before, element.bending);
}

Swinging::Stiffness Swinging::stiffness(const Element& element, const Vector2& offset,
                                        double omega) const {
  if (element.what == What::sleeve) return of_sleeve(element.leg, offset, omega);
  const Stiffness one = Stiffness::Identity();
  if (element.what == What::ring) {
    const auto& ring = *machine_.legs[element.leg].piston_ring;
    return (softened(ring.elastomer, offset.norm()) - 1.0) *
           with_arms(ring.stiffness, ring_arms_[element.leg], omega) * one;
  }
  // A motion of less than atoms: the limit of bristles that only stick.
  constexpr double least = 1e-12;
  const auto equivalent =
      hydraulics::friction_equivalent(element.friction, std::max(offset.norm(), least), omega);
  return Complex(equivalent.stiffness, omega * equivalent.damping) * one;
}

Swinging::Matrices Swinging::at(const ModelVector& q, double omega) const {
  Matrices result{.K = modes_.omega2.asDiagonal(), .C = C_};
  for (const auto& arm : arms_) {
    result.K -= dynamics::softening_at(arm, omega) * arm.s_y * arm.s_y.transpose();
    result.C += dynamics::damper_at(arm, omega) * arm.s_y * arm.s_y.transpose();
  }
  for (const auto& element : elements_) {
    const Stiffness k = stiffness(element, element.rows * q, omega);
    result.K += element.rows.transpose() * k.real() * element.rows;
    result.C += element.rows.transpose() * (k.imag() / omega) * element.rows;
  }
  return result;
}

ModelMatrix Swinging::tangent(const ModelMatrix& K, const ModelVector& q, double omega) const {
  ModelMatrix result = K;
  for (const auto& element : elements_) {
    const Vector2 a = element.rows * q;
    const double size = a.norm();
    if (size == 0.0) continue;
    const auto slope = [&](const Vector2& step) -> Vector2 {
      const Eigen::Matrix2d change =
          stiffness(element, a + step, omega).real() - stiffness(element, a - step, omega).real();
      return change * a / (2.0 * step.norm());
    };
    constexpr double step = 1e-6;  // of the amplitude
    const Vector2 along = a / size, across(-along.y(), along.x());
    Eigen::Matrix2d change = slope(step * a) * along.transpose();
    // Rings and friction are alike in all directions, so that this is their only slope.
    if (element.what == What::sleeve) change += slope(step * size * across) * across.transpose();
    result += element.rows.transpose() * change * element.rows;
  }
  return result;
}

ModeAtAmplitude Swinging::described(const ModelVector& q, double omega) const {
  ModeAtAmplitude point{.amplitude = amplitude(q), .omega = omega, .converged = true};
  point.damping_ratio = model::modal_ratio(machine_).value +
                        q.dot(at(q, omega).C * q) / (2.0 * omega * q.squaredNorm());
  for (std::size_t k = 0; k < model::leg_count; ++k) {
    point.piston = std::max(point.piston, std::abs(pistons_[k].dot(q)));
    if (linear_.kind == ModelKind::rigid) continue;
    const auto sleeve = sleeve_at(k, chords_[k] * q, omega);
    point.sleeve = std::max(point.sleeve, sleeve.seal.norm());
    if (sleeve.guide.touches) ++point.legs_on_guide;
  }
  point.shape = modes_.shapes * q / q.norm();
  return point;
}

ModelVector most_like(const ModelVector& q, const ModelMatrix& K) {
  constexpr double together = 1e-9;  // of ω²
  const Eigen::SelfAdjointEigenSolver<ModelMatrix> modes(K);
  const ModelVector parts = modes.eigenvectors().transpose() * q;
  Eigen::Index best = 0;
  parts.cwiseAbs().maxCoeff(&best);
  const double omega2 = modes.eigenvalues()[best];
  ModelVector sum = ModelVector::Zero(q.size());
  for (Eigen::Index k = 0; k < parts.size(); ++k)
    if (std::abs(modes.eigenvalues()[k] - omega2) <= together * std::abs(omega2))
      sum += parts[k] * modes.eigenvectors().col(k);
  return sum;
}

Eigen::VectorXd balance_residual(const Swinging& swinging, const Eigen::VectorXd& u, double size,
                                 double rate, Eigen::MatrixXd& A) {
  const Eigen::Index n = u.size() - 1;
  const ModelVector q = size * u.head(n);
  const double omega = rate * u[n], unit = 1.0 / (rate * rate);
  const ModelMatrix K = swinging.at(q, omega).K;
  A.topLeftCorner(n, n) = unit * swinging.tangent(K, q, omega);
  A.diagonal().head(n).array() -= u[n] * u[n];
  constexpr double step = 1e-6;  // of ω, on which friction and elastomers depend smoothly
  const ModelMatrix change = swinging.at(q, omega * (1.0 + step)).K - K;
  A.col(n).head(n) = unit * (change * u.head(n)) / (step * u[n]) - 2.0 * u[n] * u.head(n);
  return unit * (K * u.head(n)) - u[n] * u[n] * u.head(n);
}

Eigen::VectorXd solution_of_balance(const Eigen::MatrixXd& A, const Eigen::VectorXd& right) {
  constexpr double singular = 1e-8;  // of ω²; balances are exact to 1e-12
  const Eigen::VectorXd unit = A.diagonal().cwiseAbs().cwiseMax(1.0).cwiseInverse();  // stiff seals
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors;
  factors.setThreshold(singular);
  return factors.compute(unit.asDiagonal() * A).solve(unit.cwiseProduct(right));
}

}  // namespace hydrapod::modal
