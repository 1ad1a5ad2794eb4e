#include "support/modes_at_amplitude.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/damped_modes.hpp"

namespace hydrapod::test {

using spatial::Vector6;

Modes modes_at_amplitude(double amplitude) {
  return [amplitude](const model::Machine& machine, const model::NamedPose& pose) {
    const auto model = dynamics::linear_model(machine, pose.X_BP, dynamics::ModelKind::guide);
    std::array<double, 7> amplitudes{};
    for (std::size_t k = 0; k < amplitudes.size(); ++k)
      amplitudes[k] = amplitude * std::pow(10.0, 0.5 * static_cast<double>(k) - 3.0);
    // the largest amplitude that a branch of this mode has a motion for
    std::map<int, std::pair<std::size_t, modal::ModeAtAmplitude>> largest;
    for (const auto& curve :
         modal::modes_at_amplitudes(machine, pose.X_BP, dynamics::ModelKind::guide, amplitudes))
      for (std::size_t k = 0; k < curve.points.size(); ++k) {
        if (!curve.points[k].converged) continue;
        const auto before = largest.find(curve.mode);
        if (before == largest.end() || before->second.first < k)
          largest[curve.mode] = {k, curve.points[k]};
      }
    std::vector<std::pair<double, Vector6>> found;
    for (const auto& [mode, at] : largest)
      found.emplace_back(at.second.omega, at.second.shape.head<6>());
    std::ranges::sort(found, {}, [](const auto& mode) { return mode.first; });
    const auto count = static_cast<Eigen::Index>(found.size());
    PoseModes all{.pose = pose.name,
                  .X_BP = pose.X_BP,
                  .p_BC = model.p_BC,
                  .platform_mass = model.platform_mass,
                  .omega = Eigen::VectorXd(count),
                  .motions = Eigen::Matrix<double, 6, Eigen::Dynamic>(6, count)};
    for (Eigen::Index k = 0; k < count; ++k) {
      all.omega[k] = found[static_cast<std::size_t>(k)].first;
      all.motions.col(k) = found[static_cast<std::size_t>(k)].second;
    }
    return all;
  };
}

}  // namespace hydrapod::test
