#pragma once
/// A machine to work with: its file read and judged, one pose and one model chosen.
///
///     const auto machine = tasks::read_machine({.file = "machine.toml", .pose = "z=50 mm"});
///
/// All tasks take such a machine. A mistake in a text (a pose, a path, a quantity) throws
/// base::InputError. Its message calls the text as the command line does ("--pose up") and says
/// what would be accepted.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::tasks {

using numerics::Progress;

/// File, pose and model; see there.
using Machine = report::Subject;

struct MachineOptions {
  std::string file{};                    ///< path of a machine file; "-": the standard input
  std::optional<std::string> text{};     ///< the file's text; `file` is then its name in messages
  std::vector<std::string> overrides{};  ///< "PATH=VALUE", laid over the file
  std::string pose{"neutral"};           ///< see pose_of
  std::optional<dynamics::ModelKind> model{};  ///< see model_of
};

/// Reads the file and judges the machine at all its poses. Warnings are in `file.warnings`. Throws
/// base::InputError with all mistakes.
Machine read_machine(const MachineOptions& options);

/// A pose of the machine by its name, or displacements from the neutral pose, in SI or with units:
/// "z=50 mm, ry=5 deg". Throws base::InputError for an unknown name, for a text that cannot be
/// read, and for a pose that the legs cannot reach.
model::NamedPose pose_of(const model::Machine& machine, const std::string& text);

/// The displacement "z=5 mm, ry=0.1 deg" [m, rad] from the pose `from`. Throws base::InputError,
/// which calls the text `place`, where it cannot be read and where the legs cannot reach its end.
spatial::Vector6 displacement_of(const model::Machine& machine, const spatial::Pose& from,
                                 const std::string& text, const std::string& place);

/// The model asked for; if none was, the full one where every leg has a piston ring, the rigid one
/// of struts, else the guide model. Throws base::InputError for the full model of legs without a
/// piston ring, and for a flexible one of struts.
dynamics::ModelKind model_of(const model::Machine& machine,
                             std::optional<dynamics::ModelKind> asked = {});

/// The machine file with `pose` among its poses. Where it is none of them it is added under `name`.
/// Returns its number; `pose` gets the name that it has there. Throws base::InputError for a pose
/// that the legs cannot reach.
std::size_t add_pose(model::MachineFile& file, model::NamedPose& pose, const std::string& name);

}  // namespace hydrapod::tasks
