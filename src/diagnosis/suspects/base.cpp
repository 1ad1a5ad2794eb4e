// The base on its foundation: pushed sideways, pressed down, rocking.
#include "around.hpp"
#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::diagnosis {

namespace {

struct Way {
  const char* name;
  const char* statement;
  std::array<const char*, 2> keys;
  std::array<int, 2> directions;
};

constexpr std::array ways{Way{"lateral compliance of the base",
                              "the base is compliant in lateral directions",
                              {"x", "y"},
                              {0, 1}},
                          Way{"vertical compliance of the base",
                              "the base is compliant in the vertical direction",
                              {"z", "z"},
                              {2, 2}},
                          Way{"rocking compliance of the base",
                              "the base is compliant in rocking",
                              {"rx", "ry"},
                              {3, 4}}};

}  // namespace

std::vector<Suspect> base(const model::MachineFile& file) {
  constexpr double stiff = 50.0, factor = 500.0;
  const auto& machine = file.machine;
  const auto model = dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::rigid);
  // what the legs hold the platform with, seen at the base
  spatial::Matrix6 T = spatial::Matrix6::Identity();
  T.topRightCorner<3, 3>() = -spatial::skew(model.p_BC);
  const spatial::Matrix6 K = model.K;
  const spatial::Vector6 of_legs = (T.transpose() * K * T).diagonal();
  std::vector<Suspect> suspects;
  for (const auto& way : ways) {
    Suspect suspect{.name = way.name, .statement = way.statement, .family = "base"};
    calibration::FreeParameter free;
    for (std::size_t k = 0; k < 2; ++k) {
      if (k > 0 && way.directions[1] == way.directions[0]) break;
      const auto at = static_cast<std::size_t>(way.directions[k]);
      std::optional<double> stated;
      if (machine.base_mount) stated = machine.base_mount->stiffness[at];
      const double value = stated.value_or(stiff * std::abs(of_legs[way.directions[0]]));
      const std::string path = std::string("base.mount.stiffness.") + way.keys[k];
      if (!stated) suspect.changes.push_back(change(file, path, value));
      if (k == 0) free = within(path, value, factor);
      if (k > 0) free.paths.push_back(path);
    }
    suspect.free = {free};
    suspects.push_back(suspect);
  }
  return suspects;
}

}  // namespace hydrapod::diagnosis
