#include "support/mujoco_hexapod.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::test {

namespace {

using spatial::Pose;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// 17 digits: what MuJoCo reads is the very number.
std::string text(double x) { return fmt::format("{:.17g}", x); }
std::string text(const Vector3& v) { return text(v.x()) + " " + text(v.y()) + " " + text(v.z()); }
std::string text(const Matrix3& R) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  return text(q.w()) + " " + text(Vector3(q.vec()));
}

/// MuJoCo's own diagonalisation of a full tensor stops early, so it gets the principal axes.
std::string platform_inertial(const model::Platform& platform) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> principal(platform.inertia);
  Matrix3 axes = principal.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) = -axes.col(0);
  return fmt::format("<inertial pos='{}' quat='{}' mass='{}' diaginertia='{}'/>",
                     text(platform.mass_center), text(axes), text(platform.mass),
                     text(Vector3(principal.eigenvalues())));
}

std::string leg_inertial(double mass, double center, double transverse, double axial) {
  return fmt::format("<inertial pos='0 0 {}' mass='{}' diaginertia='{} {} {}'/>", text(center),
                     text(mass), text(transverse), text(transverse), text(axial));
}

std::string joint(const char* type, const Vector3& axis, double armature = 0.0) {
  return fmt::format("<joint type='{}' axis='{}' armature='{}'/>", type, text(axis),
                     text(armature));
}

/// Case axes of a straight leg. Without axial inertia any two normals will do, so it takes odd
/// ones.
Matrix3 straight_axes(const model::Leg& leg, const Vector3& n, bool gimbal, int number) {
  Vector3 a2 = n.cross(leg.gimbal_axis).normalized();
  if (!gimbal) a2 = Eigen::AngleAxisd(0.7 * number, n) * n.unitOrthogonal();
  Matrix3 R;
  R << a2.cross(n), a2, n;
  return R;
}

std::string leg_text(const model::Machine& machine, int i, const Vector3& L, ModelKind kind,
                     const PistonAxes* piston_axes) {
  constexpr double least_inertia = 1e-13;
  const auto& leg = machine.legs[i];
  const bool gimbal = machine.flexible_axes == model::FlexibleAxes::gimbal;
  const Matrix3 R = straight_axes(leg, L.normalized(), gimbal, i);
  const Vector3 first = gimbal ? Vector3(R.transpose() * leg.gimbal_axis) : Vector3::UnitX();
  const auto axial = [&](double inertia) { return gimbal ? inertia : least_inertia; };

  std::string out = fmt::format("<body pos='{}' quat='{}'>", text(leg.base_joint), text(R));
  out += joint("hinge", first, gimbal ? leg.gimbal_cross_inertia : 0.0) +
         joint("hinge", Vector3::UnitY());
  const auto& tube = leg.cylinder_case;
  out +=
      leg_inertial(tube.mass, tube.mass_center, tube.transverse_inertia, axial(tube.axial_inertia));
  out += fmt::format("<body name='rod{}' pos='0 0 {}'>", i, text(L.norm() - leg.rod.length));
  out += joint("slide", Vector3::UnitZ(), leg.added_axial_inertia);
  if (kind == ModelKind::full)
    out += joint("slide", Vector3::UnitX()) + joint("slide", Vector3::UnitY());
  if (kind != ModelKind::rigid)
    out += joint("hinge", gimbal && piston_axes ? (*piston_axes)[i] : first) +
           joint("hinge", Vector3::UnitY());
  const auto& rod = leg.rod;
  out += leg_inertial(rod.mass, rod.mass_center, rod.transverse_inertia, axial(rod.axial_inertia));
  return out + "</body></body>\n";
}

std::string machine_text(const model::Machine& machine, const Pose& X_BP, ModelKind kind,
                         const PistonAxes* piston_axes) {
  std::string out = fmt::format(
      "<mujoco><compiler angle='radian' balanceinertia='false' boundmass='0' boundinertia='0'/>\n"
      "<option gravity='{}' jacobian='dense'/>\n<worldbody>\n"
      "<body name='platform' pos='{}' quat='{}'><freejoint/>{}</body>\n",
      text(machine.gravity), text(X_BP.p_BP), text(X_BP.R_BP), platform_inertial(machine.platform));
  if (machine.base_mount) {
    const auto& base = *machine.base_mount;
    out += fmt::format(
        "<body name='base'><freejoint/><inertial pos='0 0 0' mass='{}' diaginertia='{}'/>\n",
        text(base.mass), text(base.inertia));
  }
  for (int i = 0; i < model::leg_count; ++i)
    out += leg_text(machine, i, X_BP * machine.legs[i].platform_joint - machine.legs[i].base_joint,
                    kind, piston_axes);
  if (machine.base_mount) out += "</body>";
  out += "</worldbody><equality>\n";
  for (int i = 0; i < model::leg_count; ++i)
    out += fmt::format("<connect body1='rod{}' body2='platform' anchor='0 0 {}'/>\n", i,
                       text(machine.legs[i].rod.length));
  return out + "</equality></mujoco>\n";
}

/// MuJoCo reads files only, but takes them from memory.
mjModel* load(const std::string& text) {
  mju_user_warning = [](const char* message) { throw std::runtime_error(message); };
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "hexapod.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  std::array<char, 1000> error{};
  mjModel* model = mj_loadXML("hexapod.xml", files.get(), error.data(), error.size());
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(error.data());
  return model;
}

Vector3 vector_at(const mjtNum* numbers, int i) { return Vector3(numbers + 3 * i); }

}  // namespace

MujocoHexapod::MujocoHexapod(const model::Machine& machine, const Pose& X_BP, ModelKind kind,
                             const PistonAxes* piston_axes)
    : machine_(machine),
      kind_(kind),
      model_(load(machine_text(machine, X_BP, kind, piston_axes))),
      data_(mj_makeData(model_.get())) {
  update();
}

void MujocoHexapod::update() {
  mj_fwdPosition(model_.get(), data_.get());
  mj_fwdVelocity(model_.get(), data_.get());
  if (data_->nefc != 18) throw std::runtime_error("MuJoCo made other constraints than 18");
}

VectorXd MujocoHexapod::qpos() const { return Eigen::Map<const VectorXd>(data_->qpos, model_->nq); }

void MujocoHexapod::move(const VectorXd& from, const VectorXd& displacement) {
  Eigen::Map<VectorXd>(data_->qpos, model_->nq) = from;
  mj_integratePos(model_.get(), data_->qpos, displacement.data(), 1.0);
  update();
}

void MujocoHexapod::step_and_return() {
  std::array<mjtNum, 200> before;
  std::copy_n(data_->qpos, model_->nq, before.data());
  mj_step(model_.get(), data_.get());
  std::copy_n(before.data(), model_->nq, data_->qpos);
  std::fill_n(data_->qvel, nv(), 0.0);
}

void MujocoHexapod::set_velocity(const VectorXd& velocity) {
  Eigen::Map<VectorXd>(data_->qvel, nv()) = velocity;
  update();
}

MujocoHexapod::BodyMotion MujocoHexapod::body_motion(int body) const {
  std::array<mjtNum, 6> velocity{}, acceleration{};  // rotation first
  mj_objectVelocity(model_.get(), data_.get(), mjOBJ_XBODY, body, velocity.data(), 0);
  mj_objectAcceleration(model_.get(), data_.get(), mjOBJ_XBODY, body, acceleration.data(), 0);
  const Vector3 gravity = vector_at(model_->opt.gravity, 0);  // MuJoCo lets the world fall upwards
  return {vector_at(data_->xpos, body), vector_at(velocity.data(), 1),
          vector_at(acceleration.data(), 1) + gravity, vector_at(velocity.data(), 0),
          vector_at(acceleration.data(), 0)};
}

std::array<MujocoHexapod::LegBodies, model::leg_count> MujocoHexapod::leg_bodies(
    const VectorXd& acceleration) {
  Eigen::Map<VectorXd>(data_->qacc, nv()) = acceleration;
  mj_rnePostConstraint(model_.get(), data_.get());
  std::array<LegBodies, model::leg_count> legs;
  for (int i = 0; i < model::leg_count; ++i)
    legs[i] = {body_motion(case_body(i)), body_motion(rod_body(i))};
  return legs;
}

VectorXd MujocoHexapod::constraint_bias() {
  const auto legs = leg_bodies(VectorXd::Zero(nv()));
  const BodyMotion platform = body_motion(1);
  const auto acceleration_at = [](const BodyMotion& body, const Vector3& point) -> Vector3 {
    const Vector3 arm = point - body.position;
    return body.acceleration + body.alpha.cross(arm) + body.omega.cross(body.omega.cross(arm));
  };
  VectorXd bias(18);
  for (int i = 0; i < model::leg_count; ++i) {
    const Vector3 joint = legs[i].rod.position + machine_.legs[i].rod.length * rod_direction(i);
    bias.segment<3>(3 * i) = acceleration_at(legs[i].rod, joint) - acceleration_at(platform, joint);
  }
  return bias;
}

double MujocoHexapod::extension(int i) const { return data_->qpos[extension_of(i) + 1]; }

spatial::Vector6 MujocoHexapod::momentum() {
  mj_subtreeVel(model_.get(), data_.get());
  const Vector3 linear = model_->body_subtreemass[0] * vector_at(data_->subtree_linvel, 0);
  spatial::Vector6 momentum;
  momentum << linear,
      vector_at(data_->subtree_angmom, 0) + vector_at(data_->subtree_com, 0).cross(linear);
  return momentum;
}

spatial::Matrix6 MujocoHexapod::locked_inertia() const {
  spatial::Matrix6 sum = spatial::Matrix6::Zero();
  for (int body = 1; body < model_->nbody; ++body) {
    const Vector3 c = vector_at(data_->xipos, body);
    const double m = model_->body_mass[body];
    using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const Matrix3 R = Eigen::Map<const Rotation>(data_->ximat + 9 * body);
    const Vector3 moments = vector_at(model_->body_inertia, body);
    sum.topLeftCorner<3, 3>() += m * Matrix3::Identity();
    sum.topRightCorner<3, 3>() -= m * spatial::skew(c);
    sum.bottomLeftCorner<3, 3>() += m * spatial::skew(c);
    sum.bottomRightCorner<3, 3>() += R * moments.asDiagonal() * R.transpose() +
                                     m * spatial::skew(c) * spatial::skew(c).transpose();
  }
  return sum;
}

MatrixXd MujocoHexapod::mass() const {
  RowMajor M(nv(), nv());
  mj_fullM(model_.get(), M.data(), data_->qM);
  return M;
}

MatrixXd MujocoHexapod::constraint_jacobian() const {
  return Eigen::Map<const RowMajor>(data_->efc_J, 18, nv());
}

VectorXd MujocoHexapod::constraint_error() const {
  return Eigen::Map<const VectorXd>(data_->efc_pos, 18);
}

MatrixXd MujocoHexapod::allowed_motions() const {
  const MatrixXd J = constraint_jacobian();
  const int flexible = dynamics::flexible_per_leg(kind_);
  MatrixXd N = MatrixXd::Zero(nv(), dof());
  const int free = 6 + of_base();
  N.topLeftCorner(free, free).setIdentity();
  for (int i = 0; i < model::leg_count; ++i) {
    N.block(flexible_of(i), free + i * flexible, flexible, flexible).setIdentity();
    const auto rows = J.middleRows<3>(3 * i);
    N.middleRows<3>(theta_of(i)) =
        -rows.middleCols<3>(theta_of(i)).partialPivLu().solve(MatrixXd(rows * N));
  }
  return N;
}

MatrixXd MujocoHexapod::point_jacobian(const Vector3& point, int body) const {
  RowMajor J(3, nv());
  mj_jac(model_.get(), data_.get(), J.data(), nullptr, point.data(), body);
  return J;
}

MatrixXd MujocoHexapod::stiffness_without_preload() const {
  MatrixXd K = MatrixXd::Zero(nv(), nv());
  const auto add_spring = [&](int i, const Vector3& point, double k, const Matrix3& projection) {
    const MatrixXd offset =
        projection * (point_jacobian(point, rod_body(i)) - point_jacobian(point, case_body(i)));
    K += k * offset.transpose() * offset;
  };
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine_.legs[i];
    const Vector3 n = rod_direction(i);
    const Matrix3 along = n * n.transpose(), across = Matrix3::Identity() - along;
    const double l_m = (piston(i) - leg.base_joint).norm();
    add_spring(i, piston(i), hydraulics::oil_stiffness(leg, l_m), along);
    if (kind_ == ModelKind::rigid) continue;
    add_spring(i, leg.base_joint + leg.guide_sleeve.position * n, leg.guide_sleeve.stiffness,
               across);
    if (kind_ == ModelKind::full) add_spring(i, piston(i), leg.piston_ring->stiffness, across);
  }
  for (int k = 0; k < of_base(); ++k)
    K(6 + k, 6 + k) += machine_.base_mount->stiffness[static_cast<std::size_t>(k)].value_or(0.0);
  return K;
}

/// Velocity of the rod's point there relative to the case, 3 × nv.
MatrixXd MujocoHexapod::rates_seen_by_case(int i, const Vector3& point) const {
  MatrixXd rates = point_jacobian(point, rod_body(i)) - point_jacobian(point, case_body(i));
  if (machine_.flexible_axes == model::FlexibleAxes::gimbal) return rates;
  RowMajor rotation(3, nv());
  mj_jac(model_.get(), data_.get(), nullptr, rotation.data(), point.data(), case_body(i));
  const Vector3 n = case_axes(i).col(2);
  rates += n.cross(point - machine_.legs[i].base_joint) * (n.transpose() * rotation);
  return rates;
}

MatrixXd MujocoHexapod::damping() const {
  MatrixXd C = MatrixXd::Zero(nv(), nv());
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine_.legs[i];
    const auto add = [&](double c, const MatrixXd& rates) { C += c * rates.transpose() * rates; };
    const Vector3 n = case_axes(i).col(2), e = rod_direction(i);
    const MatrixXd at_piston = rates_seen_by_case(i, piston(i));
    add(leg.oil_spring.damping, n.transpose() * at_piston);
    if (kind_ == ModelKind::rigid) continue;
    const Vector3 sleeve = leg.base_joint + leg.guide_sleeve.position * n;
    const Vector3 point = piston(i) + n.dot(sleeve - piston(i)) / n.dot(e) * e;
    // The point where the rod's axis pierces the sleeve's plane stays in that plane.
    const Matrix3 along_rod = Matrix3::Identity() - e * n.transpose() / n.dot(e);
    add(leg.guide_sleeve.damping, along_rod * rates_seen_by_case(i, point));
    if (kind_ == ModelKind::full)
      add(leg.piston_ring->damping, (Matrix3::Identity() - n * n.transpose()) * at_piston);
  }
  return C;
}

Matrix3 MujocoHexapod::case_axes(int i) const {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data_->xmat +
                                                                        9 * case_body(i));
}

Vector3 MujocoHexapod::rod_direction(int i) const {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data_->xmat +
                                                                        9 * rod_body(i))
      .col(2);
}

Vector3 MujocoHexapod::piston(int i) const { return vector_at(data_->xpos, rod_body(i)); }

Vector3 MujocoHexapod::piston_offset(int i) const {
  const Vector3 n = case_axes(i).col(2);
  const Vector3 from_base = piston(i) - machine_.legs[i].base_joint;
  return from_base - n * n.dot(from_base);
}

VectorXd MujocoHexapod::gravity_force() const {
  return -Eigen::Map<const VectorXd>(data_->qfrc_bias, nv());
}

void MujocoHexapod::add_pair(int i, const Vector3& force, const Vector3& point,
                             VectorXd& generalised) const {
  generalised +=
      (point_jacobian(point, rod_body(i)) - point_jacobian(point, case_body(i))).transpose() *
      force;
}

}  // namespace hydrapod::test
