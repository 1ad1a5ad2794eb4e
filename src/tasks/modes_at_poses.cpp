#include <stdexcept>

#include "hydrapod/observation/pairing.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::tasks {

namespace {

/// Modes that the platform feels, and which of the table they are.
struct Felt {
  observation::ModeList list{};
  std::vector<int> number{};
};

Felt felt_modes(const modal::ModeTable& table, const spatial::Matrix6& root) {
  Felt felt;
  std::vector<Eigen::VectorXcd> shapes;
  for (std::size_t k = 0; k < table.real.modes.size(); ++k) {
    const auto& [mode, energy, moves_platform, label, rigid] = table.real.modes[k];
    if (!moves_platform || !(mode.omega > 0.0)) continue;
    Eigen::VectorXcd shape = mode.real.head<6>().cast<std::complex<double>>();
    if (mode.imaginary.size() > 0)
      shape += std::complex<double>(0.0, 1.0) * mode.imaginary.head<6>();
    shapes.emplace_back(root * shape);
    felt.list.poles.push_back(mode.pole);
    felt.number.push_back(static_cast<int>(k));
  }
  felt.list.shapes.resize(6, static_cast<Eigen::Index>(shapes.size()));
  for (std::size_t k = 0; k < shapes.size(); ++k)
    felt.list.shapes.col(static_cast<Eigen::Index>(k)) = shapes[k];
  return felt;
}

/// Goes on with every mode that has a partner at pose `k`; the others begin there.
void follow(const Felt& before, const Felt& now, std::size_t k, report::ModesAtPoses& result) {
  constexpr double wide = 0.3;  // shapes are exact, see compare_sides()
  std::vector<bool> taken(now.number.size(), false);
  for (const auto& pair :
       observation::pair_lists(before.list, now.list, {.frequency_scale = wide})) {
    const int mode = before.number[static_cast<std::size_t>(pair.first)];
    for (auto& followed : result.followed)
      if (followed.mode[k - 1] == mode) {
        followed.mode[k] = now.number[static_cast<std::size_t>(pair.second)];
        followed.mac[k] = pair.mac;
      }
    taken[static_cast<std::size_t>(pair.second)] = true;
  }
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i]) continue;
    result.followed.push_back({std::vector<int>(result.poses.size(), -1),
                               std::vector<std::optional<double>>(result.poses.size())});
    result.followed.back().mode[k] = now.number[i];
  }
}

}  // namespace

report::ModesAtPoses modes_at_poses(const Machine& machine,
                                    const std::vector<model::NamedPose>& poses) {
  if (poses.size() < 2) throw std::invalid_argument("modes_at_poses: fewer than two poses");
  report::ModesAtPoses result{.poses = poses};
  const auto& of = machine.file.machine;
  Felt before;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    result.tables.push_back(modal::mode_table(of, poses[k].X_BP, machine.kind));
    auto now = felt_modes(result.tables.back(),
                          observation::platform_metric(of, poses[k].X_BP, of.platform.mass_center));
    if (before.list.shapes.rows() == 0) before.list.shapes.resize(6, 0);
    follow(before, now, k, result);
    before = std::move(now);
  }
  return result;
}

}  // namespace hydrapod::tasks
