#include "hydrapod/dynamics/linear_model.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

#include "base_mount.hpp"
#include "elastomers.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "oil_chambers.hpp"
#include "payload.hpp"
#include "statics_search.hpp"
#include "straight_leg.hpp"

namespace hydrapod::dynamics {

namespace {

Matrix6 platform_mass(const model::Platform& platform, const Matrix3& R_BP) {
  Matrix6 M = Matrix6::Zero();
  M.diagonal().head<3>().setConstant(platform.mass);
  M.bottomRightCorner<3, 3>() = R_BP * platform.inertia * R_BP.transpose();
  return M;
}

/// Joint velocity in leg axes per platform twist: R_BLᵀ [I, −(a − C)^×].
Eigen::Matrix<double, 3, 6> joint_jacobian(const Matrix3& R_BL, const Vector3& arm) {
  Eigen::Matrix<double, 3, 6> J;
  J.leftCols<3>() = R_BL.transpose();
  J.rightCols<3>() = -R_BL.transpose() * spatial::skew(arm);
  return J;
}

/// Adds a leg's 7×7 matrix, brought to y, to a model matrix.
void add_leg(const Matrix7& A, const Eigen::Matrix<double, 3, 6>& J, int at, int flexible,
             ModelMatrix& sum) {
  const Eigen::Matrix<double, 3, 6> A_aa_J = A.topLeftCorner<3, 3>() * J;
  sum.topLeftCorner<6, 6>().noalias() += J.transpose() * A_aa_J;
  const auto add_flexible = [&]<int n>(std::integral_constant<int, n>) {
    const Eigen::Matrix<double, 6, n> A_rf = J.transpose() * A.template block<3, n>(0, 3);
    sum.template block<6, n>(0, at) += A_rf;
    sum.template block<n, 6>(at, 0) += A_rf.transpose();
    sum.template block<n, n>(at, at) = A.template block<n, n>(3, 3);
  };
  if (flexible == 2) add_flexible(std::integral_constant<int, 2>{});
  if (flexible == 4) add_flexible(std::integral_constant<int, 4>{});
}

/// λ·∂²a/∂w² for a joint at `arm` from C that carries λ: the platform's rotation moves it on a
/// sphere.
Matrix3 rotation_curvature(const Vector3& lambda, const Vector3& arm) {
  return 0.5 * (lambda * arm.transpose() + arm * lambda.transpose()) -
         lambda.dot(arm) * Matrix3::Identity();
}

const char* reason(StaticsStatus status) {
  switch (status) {
    case StaticsStatus::singular:
      return "singular";
    case StaticsStatus::folded:
      return "a leg folds up";
    default:
      return "not converged";
  }
}

void require_equilibrium(const StaticEquilibrium& statics, ModelKind kind) {
  if (statics.status == StaticsStatus::converged) return;
  throw base::ComputationError(
      fmt::format("no static equilibrium of the {} model at this pose: {} after {} iterations, "
                  "residual {:.2g} of "
                  "the weight; the legs may be past buckling (see `hydrapod check`)",
                  name(kind), reason(statics.status), statics.iterations, statics.residual));
}

/// The legs with preload; adds the platform's share of the geometric stiffness to K.
void bend_legs(const std::array<BentLeg, model::leg_count>& bent,
               const kinematics::LegGeometries& geometry, LinearModel& model) {
  for (int i = 0; i < model::leg_count; ++i) {
    model.legs[i] = bent[i].element;
    model.K.block<3, 3>(3, 3) +=
        rotation_curvature(bent[i].joint_force, geometry[i].a - model.p_BC);
  }
}

}  // namespace

void require_kind(const model::Machine& machine, ModelKind kind) {
  if (kind != ModelKind::rigid && model::leg_type(machine) == model::LegType::strut)
    throw std::invalid_argument("plain struts have the rigid model alone");
  if (kind != ModelKind::full) return;
  for (int i = 0; i < model::leg_count; ++i)
    if (!machine.legs[i].piston_ring)
      throw std::invalid_argument(
          fmt::format("the full model needs legs.piston_ring.stiffness; leg {} has none", i + 1));
}

const char* name(ModelKind kind) {
  return kind == ModelKind::rigid ? "rigid" : kind == ModelKind::guide ? "guide" : "full";
}

namespace {

/// Does a base that moves carry inertia of this leg?
bool has_inertia(const model::Leg& leg) {
  const auto& tube = leg.cylinder_case;
  const auto& rod = leg.rod;
  return tube.mass + tube.transverse_inertia + rod.mass + rod.transverse_inertia > 0.0;
}

}  // namespace

std::vector<int> base_directions(const model::Machine& machine) {
  if (!machine.base_mount) return {};
  const auto& mount = *machine.base_mount;
  const bool inert = mount.mass > 0.0 || !mount.inertia.isZero(0.0) ||
                     std::ranges::any_of(machine.legs, has_inertia);
  if (!inert) return {};
  std::vector<int> directions;
  for (int k = 0; k < 6; ++k)
    if (mount.stiffness[static_cast<std::size_t>(k)]) directions.push_back(k);
  return directions;
}

int degrees_of_freedom(const model::Machine& machine, ModelKind kind) {
  return degrees_of_freedom(kind) + static_cast<int>(base_directions(machine).size()) +
         static_cast<int>(machine.payload_modes.size());
}

std::vector<std::string> coordinate_names(ModelKind kind, const std::vector<int>& base_directions,
                                          const std::vector<std::string>& payload) {
  std::vector<std::string> names(spatial::direction_names.begin(), spatial::direction_names.end());
  constexpr std::array<const char*, 4> flexible{"phi1", "phi2", "u1", "u2"};
  for (int leg = 1; leg <= model::leg_count; ++leg)
    for (int k = 0; k < flexible_per_leg(kind); ++k)
      names.push_back(fmt::format("leg{}.{}", leg, flexible[k]));
  for (const int k : base_directions)
    names.push_back(fmt::format("base.{}", spatial::direction_name(k)));
  for (const auto& mode : payload) names.push_back("payload." + mode);
  return names;
}

namespace {

/// The legs' part of M, K or C.
void add_legs(Matrix7 LegElement::*part, const LinearModel& model, ModelMatrix& sum) {
  for (int i = 0; i < model::leg_count; ++i)
    add_leg(model.legs[i].*part, model.J[i], model.first_of_leg(i), flexible_per_leg(model.kind),
            sum);
}

LegsOnBase legs_on_base(const model::Machine& machine, const kinematics::LegGeometries& geometry,
                        const StaticEquilibrium& statics) {
  LegsOnBase legs;
  for (int i = 0; i < model::leg_count; ++i)
    legs[i] = leg_on_base(machine.legs[i], geometry[i].a, machine.flexible_axes, statics.legs[i]);
  return legs;
}

void find_equilibrium(const model::Machine& machine, const kinematics::LegGeometries& geometry,
                      const StaticsSearch& search, LinearModel& model) {
  std::array<BentLeg, model::leg_count> bent;
  model.statics = static_equilibrium(machine, model.X_BP, model.kind, search, bent);
  require_equilibrium(model.statics, model.kind);
  bend_legs(bent, geometry, model);
}

/// `base`: its directions that are coordinates.
LinearModel assembled(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                      const std::vector<int>& base, const StaticsSearch& search) {
  require_kind(machine, kind);
  LinearModel model;  // an initialiser list would set all of its 60 kB to zero
  model.kind = kind;
  model.leg_type = model::leg_type(machine);
  model.X_BP = X_BP;
  model.p_BC = kinematics::mass_center(machine, X_BP);
  model.base_directions = base;
  const auto geometry = kinematics::inverse_kinematics(machine, X_BP);
  const int dof = degrees_of_freedom(kind);
  model.platform_mass = platform_mass(machine.platform, X_BP.R_BP);
  const Matrix6 M_platform = model.platform_mass;  // with what swings
  set_payload(machine, model);
  model.against_base = PlatformRows::Identity(6, model.dof());
  model.M.setZero(dof, dof);
  model.K.setZero(dof, dof);
  model.C.setZero(dof, dof);
  model.M.topLeftCorner<6, 6>() = M_platform;

  if (machine.gravity.isZero(0.0)) {
    model.statics.status = StaticsStatus::converged;
    for (int i = 0; i < model::leg_count; ++i)
      set_straight_leg(machine.legs[i], geometry[i], machine.flexible_axes, model.legs[i]);
  } else {
    find_equilibrium(machine, geometry, search, model);
  }
  for (int i = 0; i < model::leg_count; ++i)
    model.J[i] = joint_jacobian(model.legs[i].frame.R_BL, geometry[i].a - model.p_BC);
  const bool chambers = model::has_chambers(machine);
  if (chambers) fill_chambers(machine, model);
  const bool elastomers = model::has_elastomers(machine);
  if (elastomers) fill_seal_arms(machine, model);
  if (machine.base_mount && base.empty()) condense_base(*machine.base_mount, model);
  add_legs(&LegElement::M, model, model.M);
  add_legs(&LegElement::K, model, model.K);
  add_legs(&LegElement::C, model, model.C);
  if (!base.empty()) {
    ModelMatrix M_legs = ModelMatrix::Zero(dof, dof);
    add_legs(&LegElement::M, model, M_legs);
    add_base_coordinates(*machine.base_mount, legs_on_base(machine, geometry, model.statics),
                         M_legs, model);
  }
  add_payload(machine, model);
  if (!model.arms.empty()) point_arms(model);
  if (elastomers) require_slow_stiffness(model);
  if (chambers && !base.empty()) damp_mount(machine, model);
  const auto& damping = machine.damping;
  const double beta = chambers ? 0.0 : damping.rayleigh_stiffness;  // springs have it as dampers
  if (damping.rayleigh_mass != 0.0 || beta != 0.0)
    model.C += damping.rayleigh_mass * model.M + beta * model.K;
  return model;
}

/// With chambers, what damps is what damps in simulations: seals have dampers of their own.
LinearModel assembled_for(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                          const std::vector<int>& base, const StaticsSearch& search) {
  if (kind != ModelKind::rigid && model::has_pressed_seals(machine))
    return assembled_for(with_pressed_seals(machine, kind, X_BP), X_BP, kind, base, search);
  if (!model::has_chambers(machine)) return assembled(machine, X_BP, kind, base, search);
  auto damped = with_seal_dampers(machine, kind, X_BP);
  for (auto& leg : damped.legs) leg.oil_spring.damping = 0.0;
  damped.damping.oil = model::OilDamping::chambers;
  return assembled(damped, X_BP, kind, base, search);
}

}  // namespace

LinearModel linear_model(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                         const StaticEquilibrium* start) {
  return assembled_for(machine, X_BP, kind, base_directions(machine), {.start = start});
}

LinearModel neighbour_model(const model::Machine& machine, const spatial::Pose& X_BP,
                            const LinearModel& center) {
  // Newton's step does not know how the compression of rods that bend changes their compliance:
  // what is left after one is of first order.
  const double first_order = model::has_elastic_legs(machine) ? StaticsOptions{}.tolerance : 1e-6;
  return assembled_for(machine, X_BP, center.kind, center.base_directions,
                       {.tolerance_after_step = first_order, .start = &center.statics});
}

}  // namespace hydrapod::dynamics
