#include "support/noisy_modes.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "hydrapod/observation/observation.hpp"

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

std::vector<Seen> seen_modes(const PoseModes& all) {
  const Eigen::MatrixXd weight = all.platform_mass.llt().matrixU();
  const auto count = static_cast<int>(all.omega.size());
  std::vector<Seen> seen;
  for (int first = 0, last = 0; first < count; first = last) {
    while (last < count && all.omega[last] <= all.omega[first] * (1.0 + one_line)) ++last;
    const Eigen::MatrixXd motions = weight * all.motions.middleCols(first, last - first);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(motions, Eigen::ComputeThinU | Eigen::ComputeThinV);
    for (Eigen::Index j = 0; j < svd.singularValues().size(); ++j) {
      const double strength = std::pow(svd.singularValues()[j], 2);
      if (strength < drowned) continue;
      double omega = 0.0;
      for (int k = first; k < last; ++k)
        omega += all.omega[k] * std::pow(svd.matrixV()(k - first, j), 2);
      seen.push_back({omega, strength, weight.lu().solve(svd.matrixU().col(j))});
    }
  }
  return seen;
}

}  // namespace

PoseModes modes_at(const model::Machine& machine, const model::NamedPose& pose,
                   dynamics::ModelKind kind) {
  const auto model = dynamics::linear_model(machine, pose.X_BP, kind);
  const auto modes = modal::normal_modes(model);
  if (!(modes.omega2.minCoeff() > 0.0)) throw std::runtime_error("the legs have buckled");
  PoseModes all{.pose = pose.name,
                .X_BP = pose.X_BP,
                .p_BC = model.p_BC,
                .platform_mass = model.platform_mass,
                .omega = Eigen::VectorXd(modes.size()),
                .motions = modes.shapes.topRows(6)};
  for (int k = 0; k < modes.size(); ++k) all.omega[k] = modes.omega(k);
  return all;
}

observation::Targets noisy_modes(const std::vector<PoseModes>& poses, double damping,
                                 const ModeNoise& noise, Random& random) {
  observation::Targets targets{.title = "noisy modes"};
  for (const auto& pose : poses) {
    const Eigen::MatrixXd weight = pose.platform_mass.llt().matrixU();
    for (const auto& seen : seen_modes(pose)) {
      Vector6 error;
      for (double& e : error) e = noise.shape / std::sqrt(6.0) * normal(random);
      Vector6 motion = seen.motion + Vector6(weight.lu().solve(error));
      // what the platform frame's origin does
      motion.head<3>() += motion.tail<3>().cross(pose.X_BP.p_BP - pose.p_BC);
      observation::ModeTarget mode{
          .name = fmt::format("{} {}", pose.pose, targets.modes.size() + 1),
          .pose = pose.pose,
          .omega = seen.omega * (1.0 + noise.frequency * normal(random)),
          .deviation = noise.frequency * seen.omega,
          .damping = damping * (1.0 + noise.damping * normal(random)),
          .damping_deviation = noise.damping * damping,
          .shape = motion,
          .shape_deviation = noise.shape,
          .shape_point = spatial::Vector3::Zero()};
      targets.modes.push_back(mode);
    }
  }
  return targets;
}

observation::Targets noisy_modes(const model::Machine& machine,
                                 const std::vector<std::string>& poses, dynamics::ModelKind kind,
                                 const ModeNoise& noise, Random& random) {
  std::vector<PoseModes> all;
  for (const auto& pose : machine.poses)
    if (std::find(poses.begin(), poses.end(), pose.name) != poses.end())
      all.push_back(modes_at(machine, pose, kind));
  return noisy_modes(all, modal::modal_ratio(machine).value, noise, random);
}

namespace {

using Complex = std::complex<double>;

struct SeenPole {
  Complex pole{};
  observation::Vector6c motion{};  ///< of the mass centre, unit kinetic energy of the platform
};

std::vector<SeenPole> seen_poles(const observation::Observation& plant) {
  constexpr double most_damped = 0.3, within_decay = 0.5;
  const Eigen::Matrix<double, 6, 6> weight = plant.mechanics.platform_mass.llt().matrixU();
  std::vector<const observation::ObservedMode*> left;
  for (const auto& mode : plant.modes)
    if (mode.damping_ratio() < most_damped && mode.omega() > 1.0) left.push_back(&mode);
  std::vector<SeenPole> seen;
  while (!left.empty()) {
    const Complex first = left.front()->pole;
    std::vector<const observation::ObservedMode*> group;
    std::erase_if(left, [&](const auto* mode) {
      const double decay = std::min(-first.real(), -mode->pole.real());
      const bool one = std::abs(mode->pole - first) <=
                       std::max(one_line * std::abs(first), within_decay * decay);
      if (one) group.push_back(mode);
      return one;
    });
    Eigen::MatrixXcd residues = Eigen::MatrixXcd::Zero(6, 6), moment = residues;
    for (const auto* mode : group) {
      const Eigen::MatrixXcd residue = weight.cast<Complex>() * mode->motion() * mode->input;
      residues += residue;
      moment += (mode->pole - first) * residue;
    }
    // strongest directions of the residues, and where on the way from pole to pole they lie
    const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(residues,
                                                 Eigen::ComputeThinU | Eigen::ComputeThinV);
    const auto felt = [](const Eigen::VectorXcd& motion) { return motion.squaredNorm(); };
    double strongest = 0.0;
    for (const auto* mode : group)
      strongest = std::max(strongest, felt(weight.cast<Complex>() * mode->motion()));
    for (Eigen::Index j = 0; j < svd.singularValues().size() && j < std::ssize(group); ++j) {
      const double share = svd.singularValues()[j] / svd.singularValues()[0];
      if (strongest * share < drowned) continue;
      const Complex shift =
          svd.matrixU().col(j).dot(moment * svd.matrixV().col(j)) / svd.singularValues()[j];
      seen.push_back({first + shift, weight.cast<Complex>().lu().solve(svd.matrixU().col(j))});
    }
  }
  return seen;
}

}  // namespace

observation::Targets noisy_plant_modes(const model::Machine& machine,
                                       const std::vector<std::string>& poses,
                                       dynamics::ModelKind kind, const ModeNoise& noise,
                                       Random& random, observation::Observed observed) {
  observation::Targets targets{.title = "noisy modes of the plant", .observed = observed};
  for (const auto& pose : machine.poses) {
    if (std::find(poses.begin(), poses.end(), pose.name) == poses.end()) continue;
    const auto plant = observation::observe(machine, pose.X_BP, kind, observed);
    const Eigen::Matrix<double, 6, 6> weight = plant.mechanics.platform_mass.llt().matrixU();
    const spatial::Vector3 arm = pose.X_BP.p_BP - plant.mechanics.p_BC;
    for (const auto& seen : seen_poles(plant)) {
      observation::Vector6c error;
      for (Complex& e : error)
        e = noise.shape / std::sqrt(12.0) * Complex(normal(random), normal(random));
      observation::Vector6c motion = seen.motion + weight.cast<Complex>().lu().solve(error);
      motion.head<3>() -= spatial::skew(arm).cast<Complex>() * motion.tail<3>();
      motion *= std::polar(1.0, -0.5 * std::arg(motion.cwiseProduct(motion).sum()));
      const Vector6 lost = weight * Vector6(motion.imag());
      const double omega = std::abs(seen.pole);
      targets.modes.push_back({.name = pose.name + " " + std::to_string(targets.modes.size() + 1),
                               .pose = pose.name,
                               .omega = omega * (1.0 + noise.frequency * normal(random)),
                               .deviation = noise.frequency * omega,
                               .shape = motion.real(),
                               .shape_deviation = std::hypot(noise.shape, lost.norm()),
                               .shape_point = spatial::Vector3::Zero(),
                               .complex_shape = observation::ComplexShape{motion, noise.shape}});
    }
  }
  return targets;
}

}  // namespace hydrapod::test
