#pragma once
/// Tasks on the machine near rest: modes, poles, frequency responses, statics, sensitivities.
///
///     const auto modes = tasks::modes(machine);
///     for (const auto& mode : modes.real.modes) std::printf("%.3f Hz\n", mode.mode.omega /
///     two_pi);
///
/// Tasks on other programs' files.
///
///     const auto machine = tasks::read_machine({.file = "machine.toml"});
///     tasks::export_machine(machine, {.format = tasks::ExportFormat::npz, .path = "machine.npz"});

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/tasks/machine.hpp"

namespace hydrapod::tasks {

/// Modes at the machine's pose, of its model beside the rigid-leg model. Throws
/// base::ComputationError where the machine has no equilibrium.
modal::ModeTable modes(const Machine& machine);

/// The same of the file without the overrides; none where there are no overrides. Throws
/// base::InputError and base::ComputationError where the file alone has no modes at this pose.
std::optional<modal::ModeTable> modes_without_overrides(const Machine& machine);

/// Modes at several poses, two or more, each followed by its shape from pose to pose. Those with
/// platform motion are followed: between neighbouring poses they are paired by the MAC of the
/// platform's motion in the metric of its mass (observation::pair_lists); the frequency may change
/// by a factor of three.
report::ModesAtPoses modes_at_poses(const Machine& machine,
                                    const std::vector<model::NamedPose>& poses);

/// Modes at amplitudes [m] of the platform joint that moves most, by harmonic balance. Throws
/// std::invalid_argument for amplitudes that are not above 0 or do not ascend, and
/// base::ComputationError where progress stops.
report::ModesAtAmplitudes modes_at_amplitudes(const Machine& machine,
                                              const std::vector<double>& amplitudes,
                                              const Progress& progress = {});

struct SystemOptions {
  bool closed{true};  ///< false: without the controller, the valves held
  int pade_order{simulation::default_pade_order};
};

/// Mechanics, hydraulics, controller and delay as one linear system at rest, and its poles. Throws
/// base::ComputationError where the supply cannot hold the machine at its pose.
report::System system(const Machine& machine, const SystemOptions& options = {});

struct RootLocusOptions {
  std::string key{};  ///< of the machine file: "controller.gain"
  double from{}, to{};
  int count{11};  ///< values, both ends included; 2 … most_values
  static constexpr int most_values = 1000;
  /// A limit of stability between two values is found to this share of their distance: finer than
  /// a plot shows, after 14 bisections.
  double limit_accuracy{1e-4};
  SystemOptions system{};
};

/// Poles over one number of the machine file. Throws std::invalid_argument for a range without
/// length or another count. Throws base::InputError for a key that the file does not have.
report::RootLocus root_locus(const Machine& machine, const RootLocusOptions& options,
                             const Progress& progress = {});

/// 6×6 frequency responses of the platform with flexible and with rigid legs. Throws
/// base::ComputationError when the default band cannot be found (no stable mode), and
/// std::invalid_argument for an empty band.
report::Bode bode(const Machine& machine, const report::BodeOptions& options = {});

struct CommandResponseOptions {
  std::optional<double> from{}, to{};  ///< [rad/s]; default: 0.01 and 20 times the lowest oil mode
  int points{2000};
};

/// Response of the whole machine, from the commanded to the true pose.
struct SystemResponse {
  report::System system{};
  report::CommandResponse response{};
};

SystemResponse command_response(const Machine& machine, const CommandResponseOptions& options = {});

/// When check() warns. A warning is advice: the machine can be computed on either side of it.
struct CheckOptions {
  /// min(stroke left in, out) < little_stroke · stroke: motions of a test soon reach a stop.
  double little_stroke{0.05};
  /// l_mh < short_guide · rod length: the stiffness against tilt falls with the guided length.
  double short_guide{0.05};
  /// Static tilt of a rod > large_tilt [rad]: 20 mm aside per metre of rod, a rod that leans.
  double large_tilt{0.02};
  /// Static offset of a rod at its guide sleeve > large_offset [m] where no gap is stated: guide
  /// rings are nearer than that (extrusion gaps of rod seals are some 0.2 mm).
  double large_offset{0.5e-3};
  /// Condition of the Jacobian > poor_condition: relative errors of forces grow by up to this
  /// factor, two digits, far before kinematics::singular_condition.
  double poor_condition{100.0};
  /// Mean pressure of a leg's chambers at rest and pressure of the air in its file further apart
  /// than this factor: with a few per cent of air the oil spring is then off by some tenths.
  double other_pressure{1.3};
  /// Strength as a column < column_reserve · static force: the reserve that makers of cylinders ask
  /// for, since a rod is never straight and loads are never static.
  double column_reserve{3.5};
  /// Break-away friction > much_friction · push of the oil: seals of cylinders have 2 % to 5 %.
  double much_friction{0.2};
};

/// Lengths, static forces and buckling loads of the legs, and whether the machine is sound. At
/// `poses`; none given: at the machine's own pose.
std::vector<report::PoseCheck> check(const Machine& machine,
                                     const std::vector<model::NamedPose>& poses = {},
                                     const CheckOptions& options = {});

struct SensitivityOptions {
  std::vector<std::string> parameters{};  ///< paths in the machine file; empty: all that matter
};

/// Change of each frequency per change of each number of the machine file. Throws base::InputError
/// for a path that the file does not have, and for a number that is zero.
calibration::Sensitivities sensitivity(const Machine& machine,
                                       const SensitivityOptions& options = {});

enum class ExportFormat {
  mat,
  npz,
  json,
  hdf5,
  uff,
  unv,
  matrix_market,
  dmig,
  mjcf,
  sdf,
  urdf,
  fmu2,
  fmu3
};

/// Their words on the command line, in this order.
inline constexpr std::array<std::string_view, 13> export_formats{
    "mat",  "npz",  "json", "hdf5", "uff",  "unv", "mtx",
    "dmig", "mjcf", "sdf",  "urdf", "fmu2", "fmu3"};

struct ExportOptions {
  ExportFormat format{};
  std::string path{};
  /// Of a state space or an FMU; default: the mechanics of a state space, the plant of an FMU.
  std::optional<exchange::SystemKind> system{};
  int pade_order{simulation::default_pade_order};
  double sample_time{};  ///< [s], see exchange::StateSpaceOptions
  bool sampled_controller{};
  std::vector<std::string> inputs{}, outputs{};  ///< names; empty: all
  std::optional<spatial::Vector3> p_PQ{};        ///< default: the platform's mass centre
  int reduced_states{};                          ///< of a state space; 0: all
  int leg_modes{-1};                             ///< of a superelement; −1: all
  bool free_base{};                              ///< of a superelement: the base is free too
  bool approximate{};                            ///< write also what the format holds only in part
  bool measure{true};                            ///< how far what is held is from the machine
  /// Beginning of the JSON; null: none.
  report::Json json_head{};
};

/// Files that a format writes beside or instead of `path`: three for Matrix Market (NAME.M.mtx,
/// NAME.K.mtx, NAME.C.mtx), two for URDF (the second is NAME.closures.json).
std::vector<std::string> export_files(ExportFormat format, const std::string& path);

struct Exported {
  std::vector<std::string> files{};
  exchange::Parity parity{};
};

struct AttachOptions {
  std::string stiffness{};  ///< Matrix Market; without `mass` a punch or Universal File
  std::string mass{};       ///< Matrix Market
  std::string damping{};    ///< the same; may be empty
  bool universal{};         ///< a Universal File
  /// Point of a punch file, or node of the modes in a Universal File, that is the platform.
  int grid{exchange::dmig_platform};
  spatial::Vector3 p_PI{spatial::Vector3::Zero()};  ///< the interface in P [m]
  int modes{model::most_payload_modes};
  double damping_ratio{};  ///< of modes for which no damping matrix speaks
  bool add_mass{};         ///< add the structure's mass to the platform
};

struct Attached {
  model::MachineFile file{};  ///< with the modes; `text` is what to write
  exchange::PayloadFromElement payload{};
};

/// The machine with a structure on its platform that another program has reduced to a
/// superelement. Throws base::InputError for matrices that are none, and for a payload that weighs
/// more than the platform of the file.
Attached attach_payload(const Machine& machine, const AttachOptions& options);

/// Writes the machine as a file for another program. Throws base::InputError where the format
/// cannot hold the machine and `approximate` is not set; nothing is written then.
Exported export_machine(const Machine& machine, const ExportOptions& options);

}  // namespace hydrapod::tasks
