#pragma once
/// A machine as other programs read it: state space, modal model, superelement, multibody files,
/// functional mock-up units.
///
/// State space. With x, u, y small changes from the operating point (`rest` of every signal),
///
///     ẋ = A x + B u,  y = C x + D u                  continuous, sample_time = 0
///     x_{k+1} = A x_k + B u_k,  y_k = C x_k + D u_k  every sample_time seconds
///
/// - mechanics: states y, ẏ of dynamics::LinearModel with the platform's coordinates at Q; inputs
///   wrench at Q and forces of the oil columns. All damping of response::damping_matrix is in it,
///   so that C (iω − A)⁻¹ B is the response of `bode`.
/// - plant: states of simulation::Plant; inputs commands of valves or of electric drives and wrench
///   at C.
/// - loop: plant, controller, Padé delay; inputs commanded pose and its rate (which is fed
///   forward), those commands, wrench.
///
/// Discretised: inputs held over a sample (zero-order hold), by the exponential of [A B; 0 0] T in
/// balanced states. The sampled loop is simulation::LinearSystem::sampled: exact, with the delay as
/// it is and past drives as states; its inputs are the commands.
///
/// Reduced: balanced truncation of a continuous system, poles that are not stable kept whole. With
/// magnitudes s_i of the outputs and q_j of the inputs (`reduction`), the response H_r of the
/// reduced system keeps, at every frequency,
///
///     |H_ij(iω) − H_r,ij(iω)| ≤ bound · s_i q_j,   bound = 2 Σ of the Hankel singular values left
///     out
///
/// Magnitudes are such that ∫|h_ij(t)|² dt ≤ (s_i q_j)² for the impulse responses h.
///
/// Modal model: shapes at the six platform joints and at C; residues are φ Lᵀ.
///
/// Superelement: M, K, C by Craig and Bampton (AIAA J. 6 (1968) 1313). Interface coordinates are
/// the platform's six at Q and those of the base; the legs' coordinates become modes η of the legs
/// with the interface held, (K_ff − ω² M_ff) Φ = 0, Φᵀ M_ff Φ = 1:
///
///     y = [1 0; −K_ff⁻¹ K_fb Φ] (q_b, η)
///
/// exact with all modes kept. Modes are left out from the highest down; ω of the first one that is
/// left out is stated. With a free base its six coordinates, about its origin, are of the interface
/// too: mount and mass of the base are left to the other program.
///
/// Multibody files (MJCF, SDF, URDF): bodies, joints and closures of the mechanism at its rest, see
/// src/exchange/mechanism.hpp. What a format holds exactly, approximately or not at all is a
/// Parity.
///
/// A payload as another program's superelement: mass and stiffness with the platform's six
/// coordinates at a stated point and inner ones, which are made modes of the payload:
/// src/exchange/payload_element.cpp.
///
/// Functional mock-up units (FMI 2.0 and 3.0): simulation::Plant in a shared object of its own, for
/// co-simulation and model exchange. Inputs are commands of valves or electric drives, or without
/// them the axial forces on the pistons, or the commands of the controller inside, and a wrench at
/// C; it begins at rest at the given pose.

#include <Eigen/Core>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/data/modal_results.hpp"
#include "hydrapod/simulation/linear_system.hpp"

namespace hydrapod::exchange {

using model::Machine;
using spatial::Pose;
using spatial::Vector3;

struct Signal {
  std::string name{};
  std::string unit{};
  double rest{};  ///< at the operating point
};

enum class SystemKind { mechanics, plant, loop };

/// What balanced truncation left out.
struct Reduction {
  int from{};                    ///< states before
  double bound{};                ///< of the error, see above
  std::vector<double> hankel{};  ///< singular values of the scaled system, all
  std::vector<double> output_scales{}, input_scales{};  ///< s_i, q_j
};

struct StateSpace {
  Eigen::MatrixXd A{}, B{}, C{}, D{};
  std::vector<Signal> states{}, inputs{}, outputs{};
  double sample_time{};  ///< [s], 0: continuous
  double delay{};        ///< that a Padé approximation of order `pade_order` stands for [s]
  int pade_order{};
  std::optional<Reduction> reduction{};
  SystemKind system{SystemKind::mechanics};
};

struct StateSpaceOptions {
  SystemKind system{SystemKind::mechanics};
  dynamics::ModelKind kind{dynamics::ModelKind::guide};
  Vector3 p_PQ{Vector3::Zero()};  ///< Q in the platform frame [m], mechanics only
  int pade_order{simulation::default_pade_order};
  double sample_time{};                          ///< [s] of the zero-order hold; 0: continuous
  bool sampled_controller{};                     ///< loop only: the sampled loop, exact
  std::vector<std::string> inputs{}, outputs{};  ///< names, in this order; empty: all
  int reduced_states{};                          ///< of a balanced truncation; 0: all are kept
};

/// Throws base::ComputationError where the machine does not stand at `X_BP`, base::InputError for a
/// name that is none of the signals, std::invalid_argument for a negative sample time.
StateSpace state_space(const Machine& machine, const Pose& X_BP, const StateSpaceOptions& options);

/// Held inputs over `sample_time` [s] > 0 of a continuous system.
StateSpace discretised(const StateSpace& system, double sample_time);

/// Balanced truncation of a continuous system. Throws base::InputError for more states than there
/// are, and for no more than there are poles that are not stable. Fewer states come back where the
/// rest does not act at all.
StateSpace reduced(const StateSpace& system, int states);

/// Names and units of numbers that belong to a file.
struct FileHead {
  std::string title{};  ///< of the machine and its pose
  std::string date{};   ///< ISO 8601; empty: none
};

nlohmann::ordered_json state_space_json(const StateSpace& system);
/// Variables A, B, C, D, sample_time, delay and lists of names, units and rest values.
void write_state_space_mat(const std::string& path, const StateSpace& system, const FileHead& head);
void write_state_space_hdf5(const std::string& path, const StateSpace& system,
                            const FileHead& head);
/// The bytes of a NumPy archive: members A.npy, B.npy, …, stored without compression.
std::string state_space_npz(const StateSpace& system, const FileHead& head);

/// Modes as tables of shapes, for Universal Files.
data::ModalResults modal_model(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                               const FileHead& head);

struct Superelement {
  Eigen::MatrixXd M{}, K{}, C{};
  std::vector<Signal> coordinates{};   ///< interface, then modes of the legs
  int platform{6};                     ///< coordinates of the platform, the first
  std::vector<int> base_directions{};  ///< then these of the base
  Vector3 p_BQ{Vector3::Zero()};       ///< where the platform's interface stands [m] in B
  double first_left_out{};             ///< [rad/s]; 0: all modes are kept
  bool is_base_free{};                 ///< neither its mount nor its mass are in the matrices
};

struct SuperelementOptions {
  dynamics::ModelKind kind{dynamics::ModelKind::guide};
  Vector3 p_PQ{Vector3::Zero()};
  int leg_modes{-1};  ///< how many are kept, the lowest; −1: all
  bool free_base{};   ///< see above
};

/// Throws base::InputError for more modes than the legs have.
Superelement superelement(const Machine& machine, const Pose& X_BP,
                          const SuperelementOptions& options);

/// The element with a free base that stands still; one without as it is.
Superelement with_base_held(const Superelement& element);

/// `matrix` (symmetric) as Matrix Market coordinate text, 17 digits; `comments` behind %.
std::string matrix_market(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                          const std::vector<std::string>& comments);

/// Numbers of grid and scalar points in the punch file.
inline constexpr int dmig_platform = 1001, dmig_base = 2001, dmig_mode = 3001;

/// GRID, SPOINT and DMIG entries K2GG, M2GG and B2GG in large-field format, 11 digits or more.
std::string dmig_punch(const Superelement& element, const FileHead& head);

/// Mass, stiffness and, where it is known, damping of a structure that is joined to the platform as
/// to one rigid body. Coordinates: x, y, z, rx, ry, rz of the interface, then inner ones.
struct PayloadElement {
  Eigen::MatrixXd M{}, K{}, C{};  ///< symmetric; C may be empty
};

/// A Matrix Market file of a real square matrix, symmetric where its head says so. Throws
/// base::InputError with line.
Eigen::MatrixXd read_matrix_market(const std::string& path);

/// K2GG, M2GG (and B2GG) of a Nastran punch file of any field format, its columns in the order of
/// their points; `grid`: number of the grid point that is the platform. Throws base::InputError.
PayloadElement read_dmig_punch(const std::string& path, int grid);

/// A superelement of a Universal File (src/exchange/universal_element.cpp): its matrices, or else
/// the modes of the free structure at `node`, which is the platform. Throws base::InputError.
PayloadElement read_universal_element(const std::string& path, int node);

struct PayloadFromElement {
  std::vector<model::PayloadMode> modes{};  ///< lowest first
  spatial::Matrix6 mass{};  ///< of the whole rigid structure about its interface, axes of P
  double first_left_out{};  ///< [rad/s]; 0: all modes are kept
  /// C couples two of the modes, and modes of a payload have dampers of their own alone: the
  /// largest |c_jk| ω_k/|ω_j² − ω_k²|, about the share of one mode in the other, and where.
  struct Coupling {
    double share{}, omega{}, other{};
  };
  Coupling coupling{};
  double rigid_stiffness{};  ///< largest stiffness against rigid motion over that of the inner part
};

struct PayloadElementOptions {
  Vector3 p_PI{Vector3::Zero()};         ///< the interface in P [m]; its axes are those of P
  int modes{model::most_payload_modes};  ///< the lowest that are kept
  double damping_ratio{};                ///< of those for which C says nothing
};

/// Fixed-interface modes (K_ii − ω² M_ii) φ = 0 and their participation L = φᵀ (M_ic − M_ii K_ii⁻¹
/// K_ic). Throws base::InputError where the inner part is not held by the interface, where the
/// structure resists rigid motion, and where a matrix has another size.
PayloadFromElement payload_modes(const PayloadElement& element,
                                 const PayloadElementOptions& options);

enum class Held { exact, approximate, absent };
struct ParityLine {
  Held held{};
  std::string what{};
  std::string how{};  ///< how it is held, or why not
};
using Parity = std::vector<ParityLine>;

/// Anything that a file without approximations cannot hold?
bool has_absent(const Parity& parity);

Parity state_space_parity(const StateSpace& system);
Parity modal_model_parity(dynamics::ModelKind kind);
Parity superelement_parity(const Machine& machine, const Superelement& element, bool nastran);

enum class MultibodyFormat { mjcf, sdf, urdf };

/// What was read back from a file, or what was written where nothing is lost, beside hydrapod's own
/// modes and responses of the machine: lines with the largest differences.
Parity measured_state_space(const Machine& machine, const Pose& X_BP,
                            const StateSpaceOptions& options, const StateSpace& held);
Parity measured_modes(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                      const data::ModalResults& held);
Parity measured_superelement(const Machine& machine, const Pose& X_BP,
                             const SuperelementOptions& options, const Superelement& held);
/// Small motions with what a multibody file holds (src/exchange/held_motion.cpp).
Parity measured_multibody(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                          MultibodyFormat format);

/// A text and what it holds of the machine.
struct MultibodyFile {
  std::string text{};
  std::string sidecar{};  ///< JSON: closures and springs that a tree cannot hold (URDF)
  Parity parity{};
};

/// The mechanism at rest at `X_BP`. Throws base::ComputationError where it does not stand there.
MultibodyFile multibody_file(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                             MultibodyFormat format);

enum class FmuVersion { fmi2, fmi3 };

/// Texts of source files by their paths.
using FmuSources = std::map<std::string, std::string>;

struct FmuOptions {
  FmuVersion version{};
  dynamics::ModelKind kind{dynamics::ModelKind::guide};
  bool hydraulics{true};  ///< actuators, electric ones too; false: mechanics moved by forces
  bool controlled{};      ///< the controller is inside; with actuators only
  std::string object{};   ///< content of the shared object, see fmu_object_file()
  std::string notices{};  ///< licences of what is linked into it
  FmuSources sources{};   ///< of the shared object; empty: the FMU has none
};

struct Fmu {
  std::string archive{};  ///< the bytes of the ZIP file
  Parity parity{};
};

/// The machine at rest at `pose`. Throws base::ComputationError where it does not stand there.
Fmu fmu(const Machine& machine, const model::NamedPose& pose, const FmuOptions& options,
        const FileHead& head);

/// The shared object of FMUs: built beside the program, or installed with it; empty: neither.
std::string fmu_object_file();
/// The sources of that shared object, which stand in a folder beside it; empty where there is none.
FmuSources fmu_sources(const std::string& object_file);

}  // namespace hydrapod::exchange
