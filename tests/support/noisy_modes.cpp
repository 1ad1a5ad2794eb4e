#include "support/noisy_modes.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace hydrapod::test {

namespace {

using spatial::Vector6;

double normal(Random& random) {
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) *
         std::cos(2.0 * std::numbers::pi * random.uniform());
}

/// Motions of modes that no measurement tells apart, with what makes them seen.
struct Seen {
  double omega, strength;
  Vector6 motion;  ///< of the mass centre, unit kinetic energy of the platform
};

/// Frequencies this close are one line in a stabilisation chart.
constexpr double one_line = 3e-3;
/// Share of the platform in the kinetic energy below which a mode drowns in its neighbours.
constexpr double drowned = 2e-3;

std::vector<Seen> seen_modes(const model::Machine& machine, const spatial::Pose& X_BP,
                             dynamics::ModelKind kind) {
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  const auto modes = modal::normal_modes(model);
  const Eigen::MatrixXd weight = model.platform_mass.llt().matrixU();
  if (!(modes.omega2.minCoeff() > 0.0)) throw std::runtime_error("the legs have buckled");
  std::vector<Seen> seen;
  for (int first = 0, last = 0; first < modes.size(); first = last) {
    while (last < modes.size() && modes.omega(last) <= modes.omega(first) * (1.0 + one_line))
      ++last;
    const Eigen::MatrixXd motions = weight * modes.shapes.block(0, first, 6, last - first);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(motions, Eigen::ComputeThinU | Eigen::ComputeThinV);
    for (Eigen::Index j = 0; j < svd.singularValues().size(); ++j) {
      const double strength = std::pow(svd.singularValues()[j], 2);
      if (strength < drowned) continue;
      double omega = 0.0;
      for (int k = first; k < last; ++k)
        omega += modes.omega(k) * std::pow(svd.matrixV()(k - first, j), 2);
      seen.push_back({omega, strength, weight.lu().solve(svd.matrixU().col(j))});
    }
  }
  return seen;
}

}  // namespace

calibration::Targets noisy_modes(const model::Machine& machine,
                                 const std::vector<std::string>& poses, dynamics::ModelKind kind,
                                 const ModeNoise& noise, Random& random) {
  calibration::Targets targets{.title = "noisy modes"};
  for (const auto& pose : machine.poses) {
    if (std::find(poses.begin(), poses.end(), pose.name) == poses.end()) continue;
    const auto model = dynamics::linear_model(machine, pose.X_BP, kind);
    const Eigen::MatrixXd weight = model.platform_mass.llt().matrixU();
    const double ratio = modal::modal_ratio(machine).value;
    for (const auto& seen : seen_modes(machine, pose.X_BP, kind)) {
      Vector6 error;
      for (double& e : error) e = noise.shape / std::sqrt(6.0) * normal(random);
      Vector6 motion = seen.motion + Vector6(weight.lu().solve(error));
      // what the platform frame's origin does
      motion.head<3>() += motion.tail<3>().cross(pose.X_BP.p_BP - model.p_BC);
      calibration::ModeTarget mode{
          .name = fmt::format("{} {}", pose.name, targets.modes.size() + 1),
          .pose = pose.name,
          .omega = seen.omega * (1.0 + noise.frequency * normal(random)),
          .deviation = noise.frequency * seen.omega,
          .damping = ratio * (1.0 + noise.damping * normal(random)),
          .damping_deviation = noise.damping * ratio,
          .shape = motion,
          .shape_deviation = noise.shape,
          .shape_point = spatial::Vector3::Zero()};
      targets.modes.push_back(mode);
    }
  }
  return targets;
}

}  // namespace hydrapod::test
