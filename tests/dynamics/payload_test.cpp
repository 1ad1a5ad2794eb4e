/// Modes of the payload in the linear models: against two masses on springs, against MuJoCo's
/// sliding bodies, and in the limit of a rigid payload.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "support/kinds.hpp"
#include "support/payload_modes.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::PayloadMode;
using spatial::Matrix3;
using spatial::Matrix6;
using spatial::Vector3;

constexpr std::array all_kinds{ModelKind::rigid, ModelKind::guide, ModelKind::full};

VectorXd frequencies_of(const model::Machine& machine, ModelKind kind) {
  return modal::normal_modes(dynamics::linear_model(machine, machine.poses.back().X_BP, kind))
      .omega2.cwiseSqrt();
}

/// Straight up on the axis of a symmetric machine: m_r on k_z, m_s on k_s upon it,
/// m_r m_s λ² − (m_r k_s + m_s (k_z + k_s)) λ + k_z k_s = 0.
TEST(PayloadMode, StraightUpIsTheUpperOfTwoMassesOnSprings) {
  auto machine = symmetric_machine();
  const auto rigid = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  const double k_z = rigid.K(2, 2), m_s = 137.3, k_s = 5.3e5, m_r = rigid.M(2, 2) - m_s;
  PayloadMode mode{.name = "roof", .frequency = std::sqrt(k_s / m_s) / base::two_pi};
  mode.mass = m_s;
  mode.position = {0.0, 0.0, 0.71};
  mode.direction = {0.0, 0.0, 2.3};
  machine.payload_modes = {mode};
  const double b = m_r * k_s + m_s * (k_z + k_s),
               root = std::sqrt(b * b - 4.0 * m_r * m_s * k_z * k_s);
  const auto found = frequencies_of(machine, ModelKind::rigid);
  ASSERT_EQ(found.size(), 7);
  for (const double sign : {-1.0, 1.0}) {
    const double expected = std::sqrt((b + sign * root) / (2.0 * m_r * m_s));
    EXPECT_LT((found.array() - expected).abs().minCoeff(), 1e-13 * expected);
  }
}

/// At 1e6 times the mechanism's frequencies a mode follows the platform: what is left is (ω/ω_k)².
TEST(PayloadMode, ThatIsRigidChangesNothing) {
  Random random(31);
  for (const auto gravity : {Gravity::none, Gravity::down})
    for (const auto kind : all_kinds) {
      auto machine = random_machine(random, {.gravity = gravity});
      const auto rigid = frequencies_of(machine, kind);
      const double far = 1e6 * rigid[5];
      put_modes_on(machine, 3, random, far, 1.5 * far);
      const auto found = frequencies_of(machine, kind);
      ASSERT_EQ(found.size(), rigid.size() + 3);
      EXPECT_LT((found.head(6) - rigid.head(6)).cwiseQuotient(rigid.head(6)).cwiseAbs().maxCoeff(),
                1e-9);
    }
}

TEST(PayloadMode, ByMassAndByParticipationAreTheSame) {
  Random random(5);
  auto machine = random_machine(random, {.gravity = Gravity::down});
  put_modes_on(machine, 4, random);
  const auto by_mass = dynamics::linear_model(machine, machine.poses[1].X_BP, ModelKind::guide);
  for (auto& mode : machine.payload_modes) mode = by_participation(mode);
  const auto by_numbers = dynamics::linear_model(machine, machine.poses[1].X_BP, ModelKind::guide);
  EXPECT_LT((by_mass.M - by_numbers.M).norm(), 1e-14 * by_mass.M.norm());
  EXPECT_LT((by_mass.K - by_numbers.K).norm(), 1e-14 * by_mass.K.norm());
}

/// What is no coordinate of the payload stays bit for bit.
TEST(PayloadMode, LeavesTheMatricesOfTheRestAsTheyAre) {
  Random random(6);
  auto machine = random_machine(random, {.gravity = Gravity::anywhere});
  machine.base_mount = model::BaseMount{.mass = 313.0, .inertia = {71.0, 73.0, 91.0}};
  machine.base_mount->stiffness = {3e8, 2e8, {}, 4e8, {}, {}};
  const auto without = dynamics::linear_model(machine, machine.poses[1].X_BP, ModelKind::full);
  put_modes_on(machine, 2, random);
  const auto with = dynamics::linear_model(machine, machine.poses[1].X_BP, ModelKind::full);
  const auto n = without.dof();
  EXPECT_EQ(with.dof(), n + 2);
  EXPECT_EQ(with.first_of_payload(), n);
  EXPECT_EQ(with.M.topLeftCorner(n, n), without.M);
  EXPECT_EQ(with.K.topLeftCorner(n, n), without.K);
  EXPECT_EQ(with.C.topLeftCorner(n, n), without.C);
  EXPECT_EQ(dynamics::degrees_of_freedom(machine, ModelKind::full), n + 2);
  const auto names =
      dynamics::coordinate_names(ModelKind::full, with.base_directions, with.payload_names);
  EXPECT_EQ(names[static_cast<std::size_t>(n)], "payload.mass1");
}

// ---- MuJoCo: a platform with bodies that slide on it ----------------------------------------

std::string text(const Vector3& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

/// Inertial of a body at `c` in a frame whose axes are those of P. MuJoCo's own diagonalisation of
/// a full tensor stops early, so it gets the principal axes.
std::string inertial(double mass, const Vector3& c, const Matrix3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> principal(inertia);
  Matrix3 axes = principal.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) = -axes.col(0);
  const Eigen::Quaterniond q(axes);
  return fmt::format(
      "<inertial pos='{}' quat='{:.17g} {:.17g} {:.17g} {:.17g}' mass='{:.17g}' diaginertia='{}'/>",
      text(c), q.w(), q.x(), q.y(), q.z(), mass, text(Vector3(principal.eigenvalues())));
}

/// A platform of total mass, centre and inertia as the machine's, of which masses slide.
class SlidingBodies {
 public:
  SlidingBodies(const model::Machine& machine, const spatial::Pose& X_BP)
      : count_(static_cast<int>(machine.payload_modes.size())) {
    const auto& platform = machine.platform;
    double mass = platform.mass;
    Vector3 moment = platform.mass * platform.mass_center;
    for (const auto& mode : machine.payload_modes) {
      mass -= *mode.mass;
      moment -= *mode.mass * mode.position;
    }
    const Vector3 center = moment / mass;
    const auto steiner = [](double m, const Vector3& r) -> Matrix3 {
      return m * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
    };
    // about the mass centre of all
    Matrix3 inertia = platform.inertia - steiner(mass, center - platform.mass_center);
    std::string bodies;
    for (const auto& mode : machine.payload_modes) {
      inertia -= steiner(*mode.mass, mode.position - platform.mass_center);
      constexpr double point = 1e-12;  // [kg m²], the least that MuJoCo takes
      bodies += fmt::format("<body pos='{}'><joint type='slide' axis='{}'/>{}</body>",
                            text(mode.position - platform.mass_center), text(mode.direction),
                            inertial(*mode.mass, Vector3::Zero(), point * Matrix3::Identity()));
    }
    const Eigen::Quaterniond q(X_BP.R_BP);
    const Vector3 C = X_BP * platform.mass_center;
    const std::string xml = fmt::format(
        "<mujoco><compiler autolimits='true' boundmass='0' boundinertia='0' "
        "balanceinertia='false'/>"
        "<option gravity='{}'/><worldbody><body pos='{}' quat='{:.17g} {:.17g} {:.17g} {:.17g}'>"
        "<freejoint/>{}{}</body></worldbody></mujoco>",
        text(machine.gravity), text(C), q.w(), q.x(), q.y(), q.z(),
        inertial(mass, center - platform.mass_center, inertia), bodies);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "payload.xml", static_cast<int>(xml.size()));
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    std::array<char, 1000> error{};
    model_.reset(mj_loadXML("payload.xml", files.get(), error.data(), error.size()));
    mj_deleteVFS(files.get());
    if (!model_) throw std::runtime_error(error.data());
    data_.reset(mj_makeData(model_.get()));
    mj_forward(model_.get(), data_.get());
    axes_ = MatrixXd::Identity(nv(), nv());
    axes_.block<3, 3>(3, 3) = X_BP.R_BP.transpose();  // MuJoCo turns about axes of the body
  }

  [[nodiscard]] int nv() const { return 6 + count_; }

  /// For translation of C and rotation in base axes, and the slides.
  [[nodiscard]] MatrixXd mass() const {
    MatrixXd M(nv(), nv());
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> full(nv(), nv());
    mj_fullM(model_.get(), full.data(), data_->qM);
    M = axes_.transpose() * full * axes_;
    return M;
  }

  /// −∂(force of gravity)/∂(displacement), by differences of fourth order.
  [[nodiscard]] MatrixXd gravity_stiffness() {
    MatrixXd K(nv(), nv());
    const VectorXd start = Eigen::Map<const VectorXd>(data_->qpos, model_->nq);
    constexpr double h = 1e-3;
    for (int k = 0; k < nv(); ++k) {
      const auto at = [&](double step) -> VectorXd {
        VectorXd q = start;
        const VectorXd change = axes_.col(k);
        mj_integratePos(model_.get(), q.data(), change.data(), step);
        return force_at(q);
      };
      K.col(k) = -(8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
    }
    force_at(start);
    return K;
  }

 private:
  /// In base axes, of the displaced body.
  VectorXd force_at(const VectorXd& q) {
    Eigen::Map<VectorXd>(data_->qpos, model_->nq) = q;
    mj_forward(model_.get(), data_.get());
    VectorXd force = -Eigen::Map<const VectorXd>(data_->qfrc_bias, nv());
    Matrix3 R;
    for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = data_->xmat[9 + i];
    force.segment<3>(3) = R * force.segment<3>(3);
    return force;
  }

  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  int count_;
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  MatrixXd axes_;  ///< MuJoCo's velocities per motion in base axes
};

/// Masses m that slide by u = ξ/√m on springs m ω², on a platform in MuJoCo; the legs are those of
/// the machine whose payload is rigid.
TEST(PayloadMode, IsABodyOfMujocoThatSlidesOnASpring) {
  Random random(77);
  for (const auto kind : all_kinds)
    for (int trial = 0; trial < 4; ++trial) {
      auto machine = random_machine(random, {.gravity = Gravity::anywhere});
      const auto& X_BP = machine.poses[1].X_BP;
      const auto legs = dynamics::linear_model(machine, X_BP, kind);
      put_modes_on(machine, 3, random);
      const auto found = dynamics::linear_model(machine, X_BP, kind);
      SlidingBodies bodies(machine, X_BP);
      const int n = legs.dof();
      MatrixXd M = MatrixXd::Zero(n + 3, n + 3), K = M, T = MatrixXd::Identity(9, 9);
      for (int k = 0; k < 3; ++k)
        T(6 + k, 6 + k) = 1.0 / std::sqrt(*machine.payload_modes[static_cast<std::size_t>(k)].mass);
      const MatrixXd M_b = T * bodies.mass() * T, K_b = T * bodies.gravity_stiffness() * T;
      std::vector<int> at{0, 1, 2, 3, 4, 5, n, n + 1, n + 2};
      M.topLeftCorner(n, n) = legs.M;
      M.topLeftCorner<6, 6>() -= legs.platform_mass;
      K.topLeftCorner(n, n) = legs.K;
      M(at, at) += M_b;
      for (int k = 0; k < 3; ++k) {
        const double omega = omega_of(machine.payload_modes[static_cast<std::size_t>(k)]);
        K(n + k, n + k) += omega * omega;
      }
      MatrixXd weight = K_b;
      weight.topLeftCorner<6, 6>()
          .setZero();  // in hydrapod's K of the legs: a weight at C has none
      K(at, at) += weight;
      EXPECT_LT((found.M - M).cwiseAbs().maxCoeff(), 1e-11 * M.cwiseAbs().maxCoeff());
      EXPECT_LT(MatrixXd(found.K - K).rightCols(3).cwiseAbs().maxCoeff(),
                1e-8 * found.K.rightCols(3).cwiseAbs().maxCoeff());
      EXPECT_LT(K_b.topLeftCorner(6, 6).cwiseAbs().maxCoeff(),
                1e-8 * machine.platform.mass * machine.gravity.norm());
    }
}

/// A base with coordinates: the payload feels the absolute motion of the platform, whose inertia
/// with the payload locked is the whole.
TEST(PayloadMode, OnABaseThatMovesIsPartOfOneFreeBody) {
  Random random(91);
  auto machine = random_machine(random, {.gravity = Gravity::none});
  machine.base_mount = model::BaseMount{.mass = 413.0, .inertia = {171.0, 143.0, 191.0}};
  machine.base_mount->stiffness.fill(1.0);  // next to free
  put_modes_on(machine, 2, random);
  const auto model = dynamics::linear_model(machine, machine.poses[1].X_BP, ModelKind::guide);
  // all moves with the base as one body: no elastic force, no motion of the modes
  const Matrix6 T = [&] {
    Matrix6 carried = Matrix6::Identity();
    carried.topRightCorner<3, 3>() = -spatial::skew(model.p_BC);
    return carried;
  }();
  MatrixXd rigid = MatrixXd::Zero(model.dof(), 6);
  rigid.topRows<6>() = T;
  rigid.middleRows(model.first_of_base(), 6).setIdentity();
  EXPECT_LT((model.K * rigid).cwiseAbs().maxCoeff(), 2.0 + 1e-9 * model.K.cwiseAbs().maxCoeff());
  // its momentum is that with a rigid payload, and what drives a mode is L
  auto stiff = machine;
  stiff.payload_modes.clear();
  const auto without = dynamics::linear_model(stiff, machine.poses[1].X_BP, ModelKind::guide);
  const auto n = without.dof();
  EXPECT_LT((rigid.transpose() * model.M * rigid -
             rigid.topRows(n).transpose() * without.M * rigid.topRows(n))
                .cwiseAbs()
                .maxCoeff(),
            1e-12 * model.M.cwiseAbs().maxCoeff());
  EXPECT_LT((model.M.bottomRows(2) * rigid - model.payload.transpose() * T).norm(),
            1e-12 * model.payload.norm());
}

TEST(PayloadMode, HasTheEnergyOfItsAbsoluteMotion) {
  auto machine = symmetric_machine();
  PayloadMode mode{.name = "cabin", .frequency = 41.0 / base::two_pi};
  mode.mass = 37.3;
  mode.position = {0.0, 0.0, 0.4};
  machine.payload_modes = {mode};
  for (const auto kind : all_kinds) {
    const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
    const auto modes = modal::normal_modes(model);
    for (const auto& energy : modal::energy_shares(model, modes.shapes)) {
      EXPECT_NEAR(energy.platform.sum() + energy.legs.sum() + energy.payload, 1.0, 1e-12);
      EXPECT_NEAR(energy.oil.sum() + energy.guide_sleeve.sum() + energy.piston_ring.sum() +
                      energy.payload_elastic,
                  1.0, 1e-12);
      EXPECT_GE(energy.payload, 0.0);
      EXPECT_GE(energy.platform.sum(), -1e-15);
    }
  }
  // the machine as one body: the mass has its share, m_s/m
  dynamics::ModelMatrix all = dynamics::ModelMatrix::Zero(7, 1);
  all(0, 0) = 1.0;
  for (auto& leg : machine.legs) {
    leg.cylinder_case = {};
    leg.rod.mass = leg.rod.transverse_inertia = 0.0;
  }
  const auto light = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  EXPECT_NEAR(modal::energy_shares(light, all).front().payload, 37.3 / machine.platform.mass,
              1e-12);
}

TEST(PayloadMode, AddsItsDamperAndRayleighs) {
  auto machine = symmetric_machine();
  machine.damping.rayleigh_mass = 0.3;
  machine.damping.rayleigh_stiffness = 2e-5;
  PayloadMode mode{.name = "cabin", .frequency = 41.0 / base::two_pi, .damping_ratio = 0.07};
  mode.mass = 37.3;
  machine.payload_modes = {mode};
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  EXPECT_NEAR(model.C(6, 6), 2.0 * 0.07 * 41.0 + 0.3 + 2e-5 * 41.0 * 41.0, 1e-12);
  EXPECT_NEAR(model.C(6, 0), 0.3 * model.M(6, 0), 1e-12);
}

}  // namespace
}  // namespace hydrapod::test
