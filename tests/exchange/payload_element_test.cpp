/// A mast of beam elements on the platform: its superelement as modes of the payload.

#include "hydrapod/exchange/exchange.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "support/beam_payload.hpp"
#include "support/calibration_machine.hpp"

namespace hydrapod::test {
namespace {

using Eigen::MatrixXd;
using exchange::PayloadElement;
using spatial::Vector3;
using testing::HasSubstr;

const Mast mast{};

PayloadElement physical() {
  const auto [M, K] = mast_matrices(mast);
  return {M, K, {}};
}

/// After Craig and Bampton, `kept` modes.
PayloadElement reduced(int kept) {
  const auto all = physical();
  const auto n = all.K.rows() - 6;
  const MatrixXd K_ii = all.K.bottomRightCorner(n, n), M_ii = all.M.bottomRightCorner(n, n);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(K_ii, M_ii);
  MatrixXd T = MatrixXd::Zero(n + 6, 6 + kept);
  T.topLeftCorner(6, 6).setIdentity();
  T.bottomLeftCorner(n, 6) = -K_ii.ldlt().solve(all.K.bottomLeftCorner(n, 6));
  T.bottomRightCorner(n, kept) = solver.eigenvectors().leftCols(kept);
  return {T.transpose() * all.M * T, T.transpose() * all.K * T, {}};
}

/// First bending of a cantilever: ω = 1.8751041² √(EI/μL⁴), with 61.3076 % of its mass.
TEST(PayloadElement, OfAMastHasTheModesOfACantilever) {
  const auto payload = exchange::payload_modes(physical(), {});
  ASSERT_EQ(payload.modes.size(), 6U);
  const double along_x = std::pow(1.875104068711961, 2) *
                         std::sqrt(mast.EI_x / (mast.mass_per_length * std::pow(mast.length, 4)));
  const double along_y = along_x * std::sqrt(mast.EI_y / mast.EI_x);
  const double mass = mast.mass_per_length * mast.length;
  // eight elements: the frequency is good to (element/wave)⁴
  EXPECT_NEAR(base::two_pi * payload.modes[0].frequency, along_y, 1e-5 * along_y);
  EXPECT_NEAR(base::two_pi * payload.modes[1].frequency, along_x, 1e-5 * along_x);
  const Vector3 l = *payload.modes[1].participation;
  EXPECT_NEAR(l.squaredNorm() / mass, 0.613076, 1e-5);
  EXPECT_NEAR(std::abs(l.x()), l.norm(), 1e-9 * l.norm());
  // where the force acts: ∫ z φ / ∫ φ = 0.726477 L
  EXPECT_NEAR(payload.modes[1].participation_moment.y() / l.x(), 0.726477 * mast.length,
              1e-5 * mast.length);
  EXPECT_NEAR(payload.mass(0, 0), mass, 1e-9 * mass);
  EXPECT_NEAR(payload.mass(4, 4), mass * mast.length * mast.length / 3.0, 1e-9 * mass);
}

TEST(PayloadElement, IsTheSameAfterCraigAndBampton) {
  const auto by_nodes = exchange::payload_modes(physical(), {});
  const auto by_modes = exchange::payload_modes(reduced(12), {});
  for (std::size_t k = 0; k < 6; ++k) {
    const auto &a = by_nodes.modes[k], &b = by_modes.modes[k];
    EXPECT_NEAR(a.frequency, b.frequency, 1e-9 * a.frequency);
    const auto A = model::participation(a), B = model::participation(b);
    EXPECT_LT(std::min((A - B).norm(), (A + B).norm()), 1e-7 * A.norm());
  }
}

model::MachineFile machine() {
  Random random(8);
  return machine_file(random_machine_text(random, false));
}

/// The machine with all of the mast's nodes on it, six modes of the mast's instead: frequencies
/// below those that are left out.
TEST(PayloadElement, GivesTheMachineTheFrequenciesOfTheWholeStructure) {
  auto file = machine();
  const Vector3 p_PI(0.11, -0.07, 0.23);
  const auto rigid =
      dynamics::linear_model(file.machine, file.machine.neutral(), dynamics::ModelKind::rigid);
  const auto all = physical();
  const auto n = all.K.rows() - 6;
  // the foot moves as the platform does
  MatrixXd T = MatrixXd::Zero(n + 6, n + 6);
  T.setIdentity();
  T.block<3, 3>(0, 3) = -spatial::skew(Vector3(p_PI - file.machine.platform.mass_center));
  MatrixXd M = T.transpose() * all.M * T, K = T.transpose() * all.K * T;
  M.topLeftCorner<6, 6>() += rigid.M;
  K.topLeftCorner<6, 6>() += rigid.K;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> whole(K, M);

  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("hydrapod-mast-{}", ::getpid());
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, const MatrixXd& A) {
    const auto path = (folder / name).string();
    std::ofstream(path) << exchange::matrix_market(A, {"mast"});
    return path;
  };
  tasks::Machine subject{.file = file, .pose = file.machine.poses[0]};
  const auto attached = tasks::attach_payload(subject, {.stiffness = write("K.mtx", all.K),
                                                        .mass = write("M.mtx", all.M),
                                                        .p_PI = p_PI,
                                                        .add_mass = true});
  const auto read = model::parse_machine(attached.file.text, "attached.toml");
  ASSERT_EQ(read.machine.payload_modes.size(), 6U);
  const auto modes = modal::normal_modes(
      dynamics::linear_model(read.machine, read.machine.neutral(), dynamics::ModelKind::rigid));
  for (int k = 0; k < 6; ++k) {
    const double expected = std::sqrt(whole.eigenvalues()[k]);
    // what is left out is rigid: (ω/ω_7)² of a few per cent of the mass
    EXPECT_NEAR(modes.omega(k), expected, 2e-3 * expected) << k;
  }
  std::filesystem::remove_all(folder);
}

/// With every mode of it, the whole structure exactly: two modes of a mass on two springs.
TEST(PayloadElement, IsExactWithAllOfItsModes) {
  auto file = machine();
  PayloadElement element{MatrixXd::Zero(8, 8), MatrixXd::Zero(8, 8), {}};
  const double masses[]{83.1, 61.7}, springs[]{2.3e5, 4.1e5}, height = 0.83;
  const Vector3 directions[]{{1.0, 0.0, 0.0}, {0.0, 0.6, 0.8}};
  for (int k = 0; k < 2; ++k) {  // physical coordinates: absolute motion along the direction
    spatial::Vector6 d;
    d << directions[k], Vector3(0.0, 0.0, height).cross(directions[k]);
    Eigen::VectorXd stretch = Eigen::VectorXd::Zero(8);
    stretch.head<6>() = -d;
    stretch[6 + k] = 1.0;
    element.K += springs[k] * stretch * stretch.transpose();
    element.M(6 + k, 6 + k) = masses[k];
  }
  const spatial::Vector6 own = (spatial::Vector6() << 31.0, 31.0, 31.0, 7.0, 8.0, 9.0).finished();
  element.M.topLeftCorner<6, 6>() += spatial::Matrix6(own.asDiagonal());
  const auto payload = exchange::payload_modes(element, {});
  ASSERT_EQ(payload.modes.size(), 2U);
  auto& machine = file.machine;
  const auto rigid = dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::rigid);
  MatrixXd T = MatrixXd::Identity(8, 8), K = MatrixXd::Zero(8, 8), M = K;
  T.block<3, 3>(0, 3) = -spatial::skew(Vector3(-machine.platform.mass_center));
  K.topLeftCorner<6, 6>() = rigid.K;
  M.topLeftCorner<6, 6>() = rigid.M;
  K += T.transpose() * element.K * T;
  M += T.transpose() * element.M * T;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> whole(K, M);
  // its mass on the platform, about C
  const spatial::Matrix6 T_6 = T.topLeftCorner<6, 6>();
  machine.payload_modes = payload.modes;
  machine.payload_modes[0].name = "a";
  machine.payload_modes[1].name = "b";
  auto linear = dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::rigid);
  linear.M.topLeftCorner<6, 6>() += T_6.transpose() * payload.mass * T_6;
  const auto modes = modal::normal_modes(linear);
  for (int k = 0; k < 8; ++k)
    EXPECT_NEAR(modes.omega2[k], whole.eigenvalues()[k], 1e-9 * whole.eigenvalues()[k]) << k;
}

TEST(PayloadElement, IsReadFromAPunchFileOfNastran) {
  const auto element = reduced(9);
  exchange::Superelement written;
  written.M = element.M;
  written.K = element.K;
  written.C = 1e-4 * element.K;
  const auto path =
      (std::filesystem::temp_directory_path() / fmt::format("hydrapod-mast-{}.pch", ::getpid()))
          .string();
  std::ofstream(path) << exchange::dmig_punch(written, {"mast"});
  const auto read = exchange::read_dmig_punch(path, exchange::dmig_platform);
  constexpr double digits = 1e-10;
  EXPECT_LT((read.M - element.M).cwiseAbs().maxCoeff(), digits * element.M.cwiseAbs().maxCoeff());
  EXPECT_LT((read.K - element.K).cwiseAbs().maxCoeff(), digits * element.K.cwiseAbs().maxCoeff());
  const auto payload = exchange::payload_modes(read, {});
  for (const auto& mode : payload.modes)
    EXPECT_NEAR(mode.damping_ratio, 0.5e-4 * base::two_pi * mode.frequency, 1e-9);
  EXPECT_THROW(
      {
        try {
          exchange::read_dmig_punch(path, 77);
        } catch (const base::InputError& error) {
          EXPECT_THAT(error.what(), HasSubstr("grid point 77"));
          throw;
        }
      },
      base::InputError);
  std::filesystem::remove(path);
}

/// All heads first, as some writers have them: one matrix by its lower triangle, one as a whole.
TEST(PayloadElement, IsReadWithEveryMatrixInTheFormThatItsHeadStates) {
  auto element = reduced(2);
  element.K = (0.5 * (element.K + element.K.transpose())).eval();  // to the last bit
  const auto path =
      (std::filesystem::temp_directory_path() / fmt::format("hydrapod-heads-{}.pch", ::getpid()))
          .string();
  std::ofstream file(path);
  file << "DMIG,K2GG,0,6,2,0,,,2\nDMIG,M2GG,0,1,2,0,,,2\n";
  const auto coordinate = [](Eigen::Index i) {
    return i < 6 ? fmt::format("{},{}", exchange::dmig_platform, i + 1)
                 : fmt::format("{},0", exchange::dmig_mode + i);
  };
  for (Eigen::Index j = 0; j < element.K.cols(); ++j)
    for (Eigen::Index i = 0; i < element.K.rows(); ++i) {
      const auto add = [&](const char* name, double value) {
        file << fmt::format("DMIG,{},{},,{},{:.16e}\n", name, coordinate(j), coordinate(i), value);
      };
      if (i >= j) add("K2GG", element.K(i, j));
      add("M2GG", element.M(i, j));
    }
  file.close();
  const auto read = exchange::read_dmig_punch(path, exchange::dmig_platform);
  EXPECT_LT((read.K - element.K).cwiseAbs().maxCoeff(), 1e-15 * element.K.cwiseAbs().maxCoeff());
  EXPECT_LT((read.M - element.M).cwiseAbs().maxCoeff(), 1e-15 * element.M.cwiseAbs().maxCoeff());
  std::ofstream(path) << "DMIG,K2GG,1001,1,,1001,1,3.1\nDMIG,K2GG,0,6,2,0\n";
  try {
    exchange::read_dmig_punch(path, exchange::dmig_platform);
    ADD_FAILURE() << "expected an error";
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("K2GG has terms before its head"));
  }
  std::filesystem::remove(path);
}

std::string refusal(const PayloadElement& element) {
  try {
    exchange::payload_modes(element, {});
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PayloadElement, ThatIsNoneIsRefused) {
  auto held = physical();
  held.K(0, 0) += 1e7;  // stands on something else, too
  EXPECT_THAT(refusal(held), HasSubstr("resists a rigid motion"));
  auto loose = physical();
  loose.K.bottomRows(6).setZero();
  loose.K.rightCols(6).setZero();
  EXPECT_THAT(refusal(loose), HasSubstr("not held by the interface"));
  auto other = physical();
  other.M = MatrixXd::Identity(3, 3);
  EXPECT_THAT(refusal(other), HasSubstr("M has 3 rows"));
  auto light = physical();
  light.M.bottomRows(6).setZero();
  light.M.rightCols(6).setZero();
  EXPECT_THAT(refusal(light), HasSubstr("not positive definite"));
}

/// Two masses on springs at 6.0 and 6.2 Hz with a damper between them: a payload's modes cannot
/// hold it, and it is said.
TEST(PayloadElement, DampersBetweenModesAreNamed) {
  constexpr double masses[]{83.0, 71.0}, hertz[]{6.0, 6.2}, damper = 37.0;
  PayloadElement element{MatrixXd::Zero(8, 8), MatrixXd::Zero(8, 8), MatrixXd::Zero(8, 8)};
  element.M.diagonal().head<6>() << 11.0, 11.0, 11.0, 3.0, 5.0, 7.0;
  MatrixXd to = MatrixXd::Zero(2, 8);  // offsets of the springs
  for (int k = 0; k < 2; ++k) {
    to(k, k) = -1.0;
    to(k, 6 + k) = 1.0;
    element.M(6 + k, 6 + k) = masses[k];
    const double omega = base::two_pi * hertz[k];
    element.K += masses[k] * omega * omega * to.row(k).transpose() * to.row(k);
  }
  const Eigen::RowVectorXd between = to.row(1) - to.row(0);
  element.C = damper * between.transpose() * between;
  const auto coupling = exchange::payload_modes(element, {}).coupling;
  const double a = base::two_pi * hertz[0], b = base::two_pi * hertz[1];
  EXPECT_NEAR(coupling.share, damper / std::sqrt(masses[0] * masses[1]) * b / (b * b - a * a),
              1e-9);
  EXPECT_NEAR(coupling.omega, b, 1e-9 * b);
  EXPECT_NEAR(coupling.other, a, 1e-9 * a);
  element.C = MatrixXd::Zero(8, 8);
  for (int k = 0; k < 2; ++k) element.C += 41.0 * to.row(k).transpose() * to.row(k);
  EXPECT_LT(exchange::payload_modes(element, {}).coupling.share, 1e-12);
}

std::string refusal_to_attach(const model::MachineFile& file, int modes) {
  try {
    (void)tasks::attach_payload({.file = file, .pose = file.machine.poses[0]}, {.modes = modes});
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(AttachedPayload, HasOneToSixModesWithThoseOfTheFile) {
  auto file = machine();
  for (const int modes : {-1, 0, 7})
    EXPECT_THAT(refusal_to_attach(file, modes), HasSubstr("expected 1 to 6")) << modes;
  while (file.machine.payload_modes.size() < 6)
    file.machine.payload_modes.push_back(
        {.name = fmt::format("m{}", file.machine.payload_modes.size()), .frequency = 7.3});
  for (const int modes : {-1, 0, 1})
    EXPECT_THAT(refusal_to_attach(file, modes), HasSubstr("has 6 modes already")) << modes;
  file.machine.payload_modes.resize(4);
  EXPECT_THAT(refusal_to_attach(file, 3), HasSubstr("expected 1 to 2"));
}

}  // namespace
}  // namespace hydrapod::test
