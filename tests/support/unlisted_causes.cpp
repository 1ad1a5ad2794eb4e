#include "support/unlisted_causes.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <ranges>

#include "diagnosis/planted_faults.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::test {

namespace {

using spatial::Matrix3;
using spatial::Matrix6;
using spatial::Vector3;
using spatial::Vector6;

PoseModes modes_of_matrices(const dynamics::LinearModel& model, const std::string& pose,
                            const Eigen::MatrixXd& M, const Eigen::MatrixXd& K) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, M);
  return {.pose = pose,
          .X_BP = model.X_BP,
          .p_BC = model.p_BC,
          .platform_mass = model.platform_mass,
          .omega = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt(),
          .motions = solver.eigenvectors().topRows(6)};
}

Matrix3 turned_by(const Vector3& angles) {
  return Eigen::AngleAxisd(angles.norm(), angles.normalized()).toRotationMatrix();
}

/// Motion of the mass centre (linear and angular) that moves the point `p_PQ` of the platform.
Eigen::Matrix<double, 3, 6> to_point(const dynamics::LinearModel& model, const Vector3& p_PQ) {
  Eigen::Matrix<double, 3, 6> J;
  J << Matrix3::Identity(), -spatial::skew(model.X_BP * p_PQ - model.p_BC);
  return J;
}

/// A hose, a bellows or an obstacle: a spring between the ground and a point of the platform.
Modes ground_spring(double stiffness, const Vector3& p_PQ, const Vector3& direction) {
  return [=](const model::Machine& machine, const model::NamedPose& pose) {
    const auto model = dynamics::linear_model(machine, pose.X_BP, dynamics::ModelKind::guide);
    const Vector6 row = to_point(model, p_PQ).transpose() * direction.normalized();
    Eigen::MatrixXd K = model.K;
    K.topLeftCorner<6, 6>() += stiffness * row * row.transpose();
    return modes_of_matrices(model, pose.name, model.M, K);
  };
}

/// A part of the platform's mass, at p_PQ in P, that swings on a spring along `direction`, or about
/// `axis` through a hinge `height` below it: motion field φ, M ξ̈ + Lᵀ q̈ + M ω² ξ = 0, M q̈ + L ξ̈ + …
struct Swinging {
  double mass{}, omega{};
  Vector3 p_PQ{}, direction{};
  double height{}, inertia{};  ///< of the rocking; 0: it sways
};
Modes swinging(const Swinging& s) {
  return [s](const model::Machine& machine, const model::NamedPose& pose) {
    const auto model = dynamics::linear_model(machine, pose.X_BP, dynamics::ModelKind::guide);
    const Matrix3& R = pose.X_BP.R_BP;
    const Vector3 along = R * s.direction.normalized();
    const Vector3 motion =
        s.height > 0.0 ? Vector3(along.cross(R * Vector3(0, 0, s.height))) : along;
    Vector6 L = to_point(model, s.p_PQ).transpose() * (s.mass * motion);
    L.tail<3>() += s.height > 0.0 ? Vector3(s.inertia * along) : Vector3::Zero();
    const double own = s.mass * motion.squaredNorm() + (s.height > 0.0 ? s.inertia : 0.0);
    const Eigen::Index n = model.dof();
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + 1, n + 1), K = M;
    M.topLeftCorner(n, n) = model.M;
    K.topLeftCorner(n, n) = model.K;
    M.col(n).head<6>() = L;
    M.row(n).head<6>() = L.transpose();
    M(n, n) = own;
    K(n, n) = own * s.omega * s.omega;
    return modes_of_matrices(model, pose.name, M, K);
  };
}

/// The mount of a base whose springs act `depth` below its frame: x couples with ry, y with rx.
Modes deep_mount(double depth) {
  return [depth](const model::Machine& machine, const model::NamedPose& pose) {
    const auto model = dynamics::linear_model(machine, pose.X_BP, dynamics::ModelKind::guide);
    Eigen::MatrixXd K = model.K;
    Matrix6 T = Matrix6::Identity();
    T.topRightCorner<3, 3>() = -spatial::skew(Vector3(0, 0, -depth));
    const Matrix6 k = model.k_mount.asDiagonal();
    K.bottomRightCorner<6, 6>() += T.transpose() * k * T - k;
    return modes_of_matrices(model, pose.name, model.M, K);
  };
}

/// The machine stands elsewhere than the measurement says.
Modes at_another_pose(const Vector3& shift, const Vector3& angles) {
  return [=](const model::Machine& machine, const model::NamedPose& pose) {
    auto there = pose;
    there.X_BP.p_BP += shift;
    there.X_BP.R_BP = turned_by(angles) * pose.X_BP.R_BP;
    return modes_at(machine, there, dynamics::ModelKind::guide);
  };
}

/// Sizes of a machine from which those of effects follow.
struct Scales {
  model::MachineFile file{};
  double mass{}, k_h{}, k_s{}, height{}, radius{}, gyration{}, omega_x{};
  /// Amplitudes at the guide sleeve and of the piston in the lowest mode, for 1 mm of the platform.
  double sleeve{}, piston{}, sag{};
};

Scales scales_of(const model::MachineFile& file) {
  const auto& m = file.machine;
  const auto& leg = m.legs[0];
  const auto lengths = kinematics::leg_lengths(m, m.neutral());
  Scales s{.file = file, .mass = m.platform.mass, .k_s = leg.guide_sleeve.stiffness};
  s.k_h = hydraulics::oil_stiffness(leg, lengths[0] - leg.rod.length);
  s.height = m.neutral().p_BP.z();
  s.radius = leg.platform_joint.norm();
  s.gyration = std::sqrt(m.platform.inertia.trace() / (3.0 * m.platform.mass));
  const auto model = dynamics::linear_model(m, m.neutral(), dynamics::ModelKind::guide);
  const std::array small{1e-6};
  const auto curves = modal::modes_at_amplitudes(m, m.neutral(), dynamics::ModelKind::guide, small);
  s.omega_x = curves.front().omega;
  s.sleeve = 1e3 * curves.front().points.front().sleeve;
  s.piston = 1e3 * curves.front().points.front().piston;
  for (const auto& one : model.legs) s.sag = std::max(s.sag, one.sleeve_offset.norm());
  return s;
}

std::string set(const std::string& path, double value) {
  return fmt::format("{}={:.12g}", path, value);
}

std::string set(const std::string& path, const Vector3& value) {
  return fmt::format("{}=[{:.12g}, {:.12g}, {:.12g}]", path, value.x(), value.y(), value.z());
}

constexpr double amplitude = 1e-3;  // [m] of the platform where effects depend on it

void add_seals(const Scales& s, double f, std::vector<UnlistedCase>& all) {
  const double gap = s.sag + 0.4 * f * s.sleeve * amplitude / 1e-3;
  all.push_back({.physics = fmt::format("rods on guide rings, gap {:.3g} mm, at 1 mm", 1e3 * gap),
                 .basic = {.fault = {set("legs.guide_sleeve.gap", gap),
                                     "legs.guide_sleeve.guide_stiffness=5e7"}},
                 .modes = modes_at_amplitude(amplitude),
                 .same_parts = {"guide sleeve"}});
  const double ratio = 1.0 + 0.8 * f, softening = std::min(0.8, 0.4 * f);
  all.push_back(
      {.physics =
           fmt::format("O-rings as elastomers: ratio {:.2f}, loss 0.2, softened by {:.0f} %, "
                       "at 1 mm",
                       ratio, 100.0 * softening),
       .basic = {.fault = {fmt::format("legs.guide_sleeve.elastomer={{ dynamic_ratio = {:.4f}, "
                                       "loss_factor = 0.2, frequency = {:.6g}, softening = {:.4f}, "
                                       "softening_amplitude = {:.6g} }}",
                                       ratio, s.omega_x, softening, s.sleeve)}},
       .modes = modes_at_amplitude(amplitude),
       .same_parts = {"guide sleeve"}});
  const double sigma = 0.25 * f * s.k_h, force = 0.7 * sigma * s.piston;
  all.push_back(
      {.physics = fmt::format("bristles of the cylinders' seals, {:.3g} N, at 1 mm", force),
       .basic = {.fault = {set("legs.friction.coulomb", force),
                           set("legs.friction.breakaway", force), "legs.friction.viscous=0",
                           set("legs.friction.bristles.stiffness", sigma)},
                 .planted = {sticking_seals}},
       .modes = modes_at_amplitude(amplitude),
       // springs along the legs, of which the data cannot always tell one from the other
       .same_parts = {"sticking cylinder seals", "oil spring", "bulk modulus", "entrained air",
                      "chamber or line volume", "gimbals"}});
}

void add_payload(const Scales& s, double f, std::vector<UnlistedCase>& all) {
  const double share = std::min(0.45, 0.25 * f);
  const Vector3 at = s.file.machine.platform.mass_center + Vector3(0.11, -0.07, -0.31) * s.gyration;
  all.push_back({.physics = fmt::format("{:.0f} % of the platform's mass sways at {:.3g} Hz",
                                        100.0 * share, 1.7 * s.omega_x / base::two_pi),
                 .modes = swinging({.mass = share * s.mass,
                                    .omega = 1.7 * s.omega_x,
                                    .p_PQ = at,
                                    .direction = {0.8, 0.6, 0.0}}),
                 .same_parts = {"payload that"}});
  all.push_back({.physics = fmt::format("{:.0f} % of the platform's mass rocks at {:.3g} Hz",
                                        100.0 * share, 2.3 * s.omega_x / base::two_pi),
                 .modes = swinging({.mass = share * s.mass,
                                    .omega = 2.3 * s.omega_x,
                                    .p_PQ = at,
                                    .direction = {0.28, 0.96, 0.0},
                                    .height = 0.6 * s.gyration,
                                    .inertia = 0.2 * share * s.mass * s.gyration * s.gyration}),
                 .same_parts = {"payload that"}});
}

void add_masses(const Scales& s, double f, std::vector<UnlistedCase>& all) {
  const auto& platform = s.file.machine.platform;
  const double m_I = s.mass * s.gyration * s.gyration;
  const double rod = 0.07 * f * s.mass;
  const auto& leg = s.file.machine.legs[0];
  all.push_back(
      {.physics = fmt::format("rods of legs 2 and 3 heavier by {:.3g} kg at the platform", rod),
       .basic = {.fault = {set("leg.2.rod.mass", leg.rod.mass + rod),
                           set("leg.3.rod.mass", leg.rod.mass + rod),
                           set("leg.2.rod.mass_center", 0.9 * leg.rod.length),
                           set("leg.3.rod.mass_center", 0.9 * leg.rod.length)}}});
  const double xz = 0.14 * f, yz = -0.09 * f;
  all.push_back(
      {.physics = fmt::format("products of inertia of the platform, {:.0f} % and {:.0f} %",
                              100.0 * xz, 100.0 * yz),
       .basic = {.fault = {set("platform.inertia.xz", platform.inertia(0, 2) - xz * m_I),
                           set("platform.inertia.yz", platform.inertia(1, 2) - yz * m_I)}},
       .same_parts = {"inertia"}});
}

void add_geometry(const Scales& s, double f, std::vector<UnlistedCase>& all) {
  const auto& legs = s.file.machine.legs;
  const double off = 0.06 * f * s.radius;
  all.push_back({.physics = fmt::format("base joint of leg 1 off by {:.0f} mm", 1e3 * off),
                 .basic = {.fault = {set("leg.1.base_joint",
                                         legs[0].base_joint + off * Vector3(0.64, 0.48, -0.6))}},
                 // the guided length changes with the joint, and the tilt stiffness is k_s l_mh²
                 .same_parts = {"guide sleeve of leg 1"}});
  all.push_back(
      {.physics = fmt::format("platform joints of legs 3 and 4 off by {:.0f} mm", 1e3 * off),
       .basic = {.fault = {set("leg.3.platform_joint",
                               legs[2].platform_joint + off * Vector3(-0.36, 0.48, 0.8)),
                           set("leg.4.platform_joint",
                               legs[3].platform_joint + off * Vector3(0.6, -0.64, 0.48))}},
       .same_parts = {"guide sleeve of leg 3", "guide sleeve of leg 4"}});
  const double up = 0.035 * f * s.height, tilt = 0.03 * f;
  all.push_back(
      {.physics = fmt::format("pose wrong by {:.0f} mm and {:.1f}°", 1e3 * up,
                              tilt * 180.0 / std::numbers::pi),
       .modes = at_another_pose({0.3 * up, -0.4 * up, 0.87 * up}, {0.0, tilt, 0.5 * tilt})});
}

void add_surroundings(const Scales& s, double f, std::vector<UnlistedCase>& all) {
  const double K = 6.0 * s.k_h;
  const double k = 0.05 * f * K;
  all.push_back(
      {.physics = fmt::format("hose beside the platform, {:.3g} kN/mm, sideways", 1e-6 * k),
       .modes = ground_spring(k, {0.7 * s.radius, 0.4 * s.radius, 0.1}, {0.6, 0.8, 0.0})});
  all.push_back(
      {.physics = fmt::format("spring under a corner of the platform, {:.3g} kN/mm", 2e-6 * k),
       .modes = ground_spring(2.0 * k, {-0.8 * s.radius, 0.5 * s.radius, 0.0}, {0.1, -0.1, 1.0})});
  const double stiff = 3.0 / f, h2 = s.height * s.height;
  all.push_back(
      {.physics =
           fmt::format("foundation of 0.8 times the platform's mass, its springs deep below"),
       .basic = {.fault = {set("base.mount.mass", 0.8 * s.mass),
                           set("base.mount.inertia", Vector3(0.3, 0.3, 0.4) * s.mass * h2),
                           set("base.mount.stiffness.x", 2.0 * stiff * K),
                           set("base.mount.stiffness.y", 2.7 * stiff * K),
                           set("base.mount.stiffness.z", 5.0 * stiff * K),
                           set("base.mount.stiffness.rx", 3.0 * stiff * K * h2),
                           set("base.mount.stiffness.ry", 2.4 * stiff * K * h2),
                           set("base.mount.stiffness.rz", 4.0 * stiff * K * h2)}},
       .modes = deep_mount(0.6 * s.height),
       .same_parts = {"compliance of the base"}});
  if (s.sag > 0.0) {
    const double left = std::max(0.0, 1.0 - 0.4 * f);
    const double g = s.file.machine.gravity.norm();
    all.push_back(
        {.physics = fmt::format("{:.0f} % of the weight on a counterbalance", 100.0 * (1.0 - left)),
         .basic = {.fault = {set("environment.gravity", left * g)}},
         // at one pose the data determine k_s l_mh² − F l_m l_mn/l
         .same_parts = {"guide sleeves of all legs"}});
  }
}

void add_others(const Scales& s, double f, std::vector<UnlistedCase>& all) {
  const auto& leg = s.file.machine.legs[0];
  const bool cylinder = leg.oil_spring.cylinder.has_value();
  const double oil = cylinder ? leg.oil_spring.cylinder->bulk_modulus : s.k_h;
  const std::string path = cylinder ? "oil_spring.cylinder.bulk_modulus" : "oil_spring.stiffness";
  const double less = std::min(0.5, 0.22 * f);
  all.push_back(
      {.physics = fmt::format("three causes: oil of legs 2, 3 and 5 softer by {:.0f}, {:.0f} and "
                              "{:.0f} %, with the mass centre off",
                              100.0 * less, 60.0 * less, 130.0 * less),
       .basic = {.fault = {set("leg.2." + path, (1.0 - less) * oil),
                           set("leg.3." + path, (1.0 - 0.6 * less) * oil),
                           set("leg.5." + path, (1.0 - 1.3 * less) * oil),
                           set("platform.mass_center[0]",
                               s.file.machine.platform.mass_center.x() + 0.2 * f * s.gyration)}},
       // two of the three are no error for those who look there
       .same_parts = {"oil spring of leg 2", "oil spring of leg 3", "oil spring of leg 5",
                      "mass centre"}});
  const double turned = 0.25 * f;
  all.push_back({.physics = fmt::format("sensors turned by {:.0f}° about z",
                                        turned * 180.0 / std::numbers::pi),
                 .misread = [turned](observation::Targets& targets) {
                   const Matrix3 R = turned_by({0, 0, turned});
                   for (auto& mode : targets.modes)
                     *mode.shape << R * mode.shape->head<3>(), R * mode.shape->tail<3>();
                 }});
}

/// Largest relative change of the six modes that move the platform most.
double change_of(const PoseModes& before, const PoseModes& after) {
  const Matrix6 root = before.platform_mass.llt().matrixU();
  std::vector<std::pair<double, Eigen::Index>> energy;
  for (Eigen::Index k = 0; k < before.omega.size(); ++k)
    energy.emplace_back(-(root * before.motions.col(k)).squaredNorm(), k);
  std::ranges::sort(energy);
  const auto rows = std::min<Eigen::Index>(6, after.omega.size());
  Eigen::MatrixXd cost(rows, after.omega.size());
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      const auto k = energy[static_cast<std::size_t>(i)].second;
      const Vector6 u = root * before.motions.col(k), v = root * after.motions.col(j);
      cost(i, j) = 10.0 * std::abs(std::log(after.omega[j] / before.omega[k])) + 1.0 -
                   std::pow(u.dot(v), 2) / (u.squaredNorm() * v.squaredNorm()) +
                   (v.squaredNorm() < 0.1 ? 1.0 : 0.0);
    }
  const auto column = numerics::assign(cost);
  double most = 0.0;
  for (std::size_t i = 0; i < column.size(); ++i)
    most = std::max(most, std::abs(after.omega[column[i]] / before.omega[energy[i].second] - 1.0));
  return most;
}

model::MachineFile truth_of(const UnlistedCase& test) {
  auto overrides = test.basic.design;
  overrides.insert(overrides.end(), test.basic.fault.begin(), test.basic.fault.end());
  return machine_file(test.basic.text(), overrides);
}

/// Throws where the machine cannot be built, or its legs fold.
std::vector<PoseModes> modes_of(const UnlistedCase& test, const model::Machine& truth) {
  std::vector<PoseModes> poses;
  for (const auto& name : test.basic.poses) {
    const auto* pose = model::find_pose(truth, name);
    poses.push_back(test.modes ? test.modes(truth, *pose)
                               : modes_at(truth, *pose, dynamics::ModelKind::guide));
    if (poses.back().omega.size() == 0 || !(poses.back().omega.minCoeff() > 0.0))
      throw std::runtime_error("no mode at this amplitude, or the legs have buckled");
  }
  return poses;
}

observation::Targets measured_modes(const UnlistedCase& test, const std::vector<PoseModes>& poses) {
  const auto design = machine_file(test.basic.text(), test.basic.design);
  Random random(7919U * static_cast<std::uint64_t>(test.basic.repetition) + 17U);
  auto measured = noisy_modes(
      poses, modal::modal_ratio(design.machine).value,
      {.frequency = test.basic.noise, .shape = std::min(0.05, 30.0 * test.basic.noise)}, random);
  if (test.misread) test.misread(measured);
  return measured;
}

bool stands(const UnlistedCase& test) {
  try {
    static_cast<void>(modes_of(test, truth_of(test).machine));
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

std::vector<UnlistedCase> unlisted_cases(std::size_t machines, unsigned draw) {
  constexpr unsigned apart = 7919;
  std::vector<UnlistedCase> all;
  for (auto setting : settings() | std::views::take(machines)) {
    constexpr std::string_view random = "random ";
    if (setting.machine.starts_with(random))
      setting.machine = fmt::format(
          "{}{}", random,
          100 * draw + static_cast<unsigned>(std::stoi(setting.machine.substr(random.size()))));
    const BlindCase basic{.machine = setting.machine,
                          .design = setting.design,
                          .poses = setting.poses,
                          .noise = setting.noise};
    const auto scales = scales_of(machine_file(basic.text(), setting.design));
    for (const auto add :
         {add_seals, add_payload, add_masses, add_geometry, add_surroundings, add_others}) {
      Random numbers(5003U + 101U * all.size() + apart * draw);
      double size = numbers.log_uniform(0.4, 2.0);
      std::vector<UnlistedCase> some;
      constexpr double smallest = 0.05;
      for (bool stand = false; !stand && size > smallest; size *= 0.5) {
        some.clear();
        add(scales, size, some);
        for (auto& one : some) {
          const auto of_case = one.basic;
          one.basic = basic;
          one.basic.fault = of_case.fault;
          one.basic.planted = of_case.planted;
        }
        stand = std::ranges::all_of(some, stands);
      }
      std::erase_if(some, [](const auto& one) { return !stands(one); });
      for (auto& one : some) {
        one.basic.repetition = 5000 + static_cast<int>(all.size() + 3U * apart * draw);
        all.push_back(std::move(one));
      }
    }
  }
  return all;
}

std::vector<UnlistedCase> sticking_cases() {
  auto all = unlisted_cases();
  std::erase_if(all, [](const auto& one) { return one.basic.planted.empty(); });
  const std::size_t count = all.size();
  constexpr double small = 0.1 * amplitude;
  for (std::size_t k = 0; k < count; ++k) {
    auto& one = all[k];
    one.basic.size = one.physics;
    auto less = one;
    less.basic.size.replace(less.basic.size.find("at 1 mm"), std::string::npos, "at 0.1 mm");
    less.basic.repetition += 1000;
    less.modes = modes_at_amplitude(small);
    all.push_back(std::move(less));
  }
  return all;
}

observation::Targets measure_unlisted(const UnlistedCase& test) {
  return measured_modes(test, modes_of(test, truth_of(test).machine));
}

UnlistedResult run_unlisted(const UnlistedCase& test, const diagnosis::DiagnoseOptions& options) {
  const auto design = machine_file(test.basic.text(), test.basic.design);
  const auto truth = truth_of(test);
  const auto poses = modes_of(test, truth.machine);
  UnlistedResult result;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const auto* pose = model::find_pose(design.machine, test.basic.poses[k]);
    const auto stated = modes_at(design.machine, *pose, dynamics::ModelKind::guide);
    result.change = std::max(result.change, change_of(stated, poses[k]));
  }
  const auto measured = measured_modes(test, poses);
  try {
    result.diagnosis = diagnosis::diagnose(design, measured, dynamics::ModelKind::guide,
                                           design.machine.poses, options);
  } catch (const base::InputError& error) {
    result.refused = error.diagnostics().front().message;
    return result;
  }
  const auto& d = result.diagnosis;
  result.blamed =
      d.finding == diagnosis::Finding::identified || d.finding == diagnosis::Finding::undecided;
  const auto is_same = [&](std::size_t cause) {
    const auto name = report::cause_name(d.causes[cause]);
    return std::ranges::any_of(test.same_parts, [&](const std::string& part) {
      return name.find(part) != std::string::npos;
    });
  };
  result.right_part = result.blamed && std::ranges::all_of(d.equivalent, [&](std::size_t k) {
                        return std::ranges::all_of(d.hypotheses[k].causes, is_same);
                      });
  return result;
}

}  // namespace hydrapod::test
