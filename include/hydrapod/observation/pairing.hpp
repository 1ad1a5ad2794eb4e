#pragma once
/// Which observed mode is which target, and how much their shapes have in common.
///
/// Metric. Shapes are compared as motions of the platform in the metric of its mass M, as the
/// vectors U q with UᵀU = M: |U q|² is the platform's share of the kinetic energy of a mode
/// scaled to φᴴ M φ = 1, and lengths and angles weigh as they do in the machine.
///
/// Groups. A measurement shows of modes with nearly the same pole any mixture. The group of mode a
/// are the modes b with
///
///     |λ_a − λ_b| ≤ max(same_frequency |λ_a|, same_decay min(|Re λ_a|, |Re λ_b|)).
///
/// Undamped modes have the decay 0.
///
/// MAC of a measured shape u, |u| = 1, with a group. A: the motions that the group shows, a column
/// per undamped mode; of damped modes the sum of their residues for the six inputs of the system,
/// since poles that nearly coincide have vectors that are nearly one and only the sum is well
/// determined. With w = weak and ε = w max |a_k|²
///
///     MAC = uᴴ P u,   P = (1 + w) A (AᴴA + ε)⁻¹ Aᴴ
///
/// For one mode that is the usual MAC; members of a group that the platform hardly feels beside the
/// others count little.
///
/// Pairs. Each target gets a mode of its own, so that the sum of
///
///     (ln(ω/ω_t) / frequency_scale)² + wrong_shape (1 − MAC) + wrong_member (1 − e m)
///
/// is smallest (Hungarian method): m is the MAC with the mode alone and e its energy in the
/// platform over the largest in its group. A target with a direction instead of a shape has
/// wrong_shape (1 − share of the platform's kinetic energy in that direction) in their place, one
/// with neither the frequency alone. Where the first term exceeds `hopeless` shapes are not
/// computed.

#include <optional>
#include <span>

#include "hydrapod/observation/observation.hpp"

namespace hydrapod::observation {

struct ObservationOptions {
  /// 0.5 %: closer resonances are separated by no record of usual length, and the shapes of modes
  /// that are closer change into each other with the smallest change of the machine.
  double same_frequency{5e-3};
  /// A fifth: peaks of half width σ whose centres are σ/5 apart add up to one peak.
  double same_decay{0.2};
  /// 3 % of the energy of the strongest motion of a group: what is weaker disappears in the noise
  /// of its shape (deviations of measured shapes are 0.05 to 0.1 of their length).
  double weak{0.03};
  /// A resonance is visible where the platform has at least this share of its kinetic energy.
  double visible{2e-3};
  double frequency_scale{0.1};  ///< a tenth: models of real machines are off by some per cent
  /// A mode of the wrong shape (MAC 0) is as bad as one whose frequency is off by half.
  double wrong_shape{25.0};
  double wrong_member{1.0};  ///< only decides within a group
  double hopeless{100.0};    ///< a factor e off
  /// Cost of a mode that has no partner: pairs are at most 40 % apart, and MAC is at least 0.36.
  double no_partner{16.0};
  /// Modes damped more than this are no resonances that a target could be.
  double overdamped{0.5};
  /// A target's direction contradicts its mode where the platform has less than this share of its
  /// kinetic energy in it. Who sees a mode takes for its direction what moves most: with a quarter
  /// of the energy a direction has half the amplitude of all others together and may be taken for
  /// the main one, with less it is another mode's.
  double contradicting{0.25};
};

/// U for motions of the point Q (`p_PQ`, in P) of the platform, in base axes.
spatial::Matrix6 platform_metric(const model::Machine& machine, const spatial::Pose& X_BP,
                                 const spatial::Vector3& p_PQ);

/// The direction 0…5 in which the platform mostly moves, by kinetic energy; `mass`:
/// LinearModel::platform_mass, for motions of the mass centre, or of the machine for those of Q.
int main_direction(const spatial::Matrix6& mass, const Vector6& motion);
int main_direction(const model::Machine& machine, const spatial::Pose& X_BP,
                   const spatial::Vector3& p_PQ, const Vector6& motion);

/// Per mode the members of its group, ascending.
std::vector<std::vector<int>> group_of_each(std::span<const std::complex<double>> poles,
                                            const ObservationOptions& options = {});

/// Every mode once: modes that a chain of groups joins are together, ascending.
std::vector<std::vector<int>> groups_of(std::span<const std::complex<double>> poles,
                                        const ObservationOptions& options = {});

/// (1 + w) A (AᴴA + ε)⁻¹: P = A times the adjoint of this.
template <class Matrix>
Matrix regularised(const Matrix& A, double weak = ObservationOptions{}.weak);

/// Motion of the target's point per motion of the mass centre.
spatial::Matrix6 to_target_point(const dynamics::LinearModel& model, const ModeTarget& target);

/// The target's shape: complex if it was measured so.
Vector6c shape_of(const ModeTarget& target);

/// P u of a group of modes, `root` being the metric of motions of the target's point. Where the
/// target's shape is real, the columns of residues are turned to real.
Vector6c shown_part(const Observation& seen, const std::vector<int>& group,
                    const ModeTarget& target, const spatial::Matrix6& root, const Vector6c& u);

/// MAC of the target's shape with a group of modes.
double shown_mac(const Observation& seen, const std::vector<int>& group, const ModeTarget& target);

/// Share of the platform's kinetic energy in mode k that is motion in `direction`; 0 for modes that
/// the platform cannot feel.
double direction_share(const Observation& seen, int k, int direction);

/// The direction in which the platform mostly moves in mode k, where `direction` contradicts it and
/// every other mode of its group; none where it does not, or where the platform cannot be seen to
/// move.
std::optional<int> contradicted_direction(const Observation& seen, int k,
                                          const std::vector<int>& group, int direction,
                                          const ObservationOptions& options = {});

/// What is observed at one pose.
struct SeenPoint {
  Observation seen{};
  std::vector<int> mode_of{};  ///< per target of the problem; −1: the target is at another pose
  std::vector<std::vector<int>> group_of_mode{};

  /// Modes that the one of this target cannot be told from, with itself.
  [[nodiscard]] const std::vector<int>& group_of(std::size_t target) const {
    return group_of_mode[static_cast<std::size_t>(mode_of[target])];
  }
};

/// Pairs the targets `here` (numbers in `targets`) with modes that are not overdamped. False where
/// there are fewer of those.
bool pair_seen(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
               SeenPoint& point, const ObservationOptions& options = {});

/// Pairs again within the groups of `point`, whose modes have moved or have another basis.
bool pair_again(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
                SeenPoint& point, const ObservationOptions& options = {});

struct Resonance {
  int direction{};    ///< 0…5, x … rz: what the platform mostly does
  double omega{};     ///< mean of the group, weighted with its motion [rad/s]
  double strength{};  ///< the platform's share of the kinetic energy
  Vector6 motion{};   ///< of the mass centre, scaled to unit kinetic energy of the platform
};

/// Resonances of the undamped mechanics as a measurement of the platform shows them: a group of
/// modes is one resonance in every direction in which it moves the platform. With the platform's
/// motions u_k in the metric of its mass, these are the eigenvectors of Σ u uᵀ, and the eigenvalues
/// are their strengths. Ascending in ω, group by group. Throws base::ComputationError where the
/// machine has no equilibrium.
std::vector<Resonance> visible_resonances(const model::Machine& machine, const spatial::Pose& X_BP,
                                          dynamics::ModelKind kind,
                                          const ObservationOptions& options = {});

/// The same of what is observed of a plant or of a machine under control: ω is |λ|, shapes are
/// turned to real, and modes that are overdamped are no resonances.
std::vector<Resonance> visible_resonances(const Observation& seen,
                                          const ObservationOptions& options = {});

struct ModePair {
  int measured{}, model{};        ///< indices
  double frequency_difference{};  ///< ω/ω_model − 1
  double damping_difference{};    ///< ζ/ζ_model − 1
  std::optional<double> mac{};    ///< with the group; none where shapes cannot be compared
};

/// Why a mode of the model has no partner.
enum class Unpaired {
  not_found,
  not_felt,  ///< by the platform
  not_seen   ///< by the outputs
};

struct ModelModeLeft {
  int model{};
  Unpaired reason{};
};

struct ModeComparison {
  std::vector<ObservedMode> model{};  ///< all of them
  std::vector<ModePair> pairs{};      ///< ascending in the measured mode
  std::vector<int> measured_left{};
  std::vector<ModelModeLeft> model_left{};  ///< in the band, less damped than a mode may be
  std::vector<int> outputs{};               ///< on which shapes were compared
  Eigen::MatrixXd mac{};  ///< measured × model, single shapes; empty without comparable outputs
};

/// Where the measurement was made.
struct ComparisonFrame {
  model::Machine machine{};
  spatial::Pose X_BP{};
  spatial::Vector3 p_BQ{};  ///< the point whose directions the outputs x … rz are [m]
};

/// What each output sees of the motion of the mass centre: outputs × 6; NaN rows for those that see
/// something else (pressures, sensors without a direction, directions of several points).
Eigen::MatrixXd output_map(const std::vector<data::Channel>& outputs, const ComparisonFrame& frame);

/// What a model shows on the channels of measured responses.
struct ShownResponses {
  /// Per line outputs × inputs, in units of the channels; NaN at 0 Hz, and in the rows of outputs
  /// that see something else than the platform (see output_map()).
  std::vector<Eigen::MatrixXcd> H{};
  std::string why_not{};  ///< where there is none: "its inputs are …"
};

/// Responses of the observed system at the lines of `measured`, widened as that estimate widens
/// them. Their size counts: that of forces, of commanded displacements, and of drives as shares of
/// the range of single legs (unit 1) or brought to directions of the platform at Q as lengths of
/// legs are (1, 1/m). `p_BF`: the point that forces act at [m].
ShownResponses shown_responses(const data::FrequencyResponses& measured,
                               const ComparisonFrame& frame, const Observation& seen,
                               const spatial::Vector3& p_BF);

/// Identified modes beside those of a model, each with a partner or none.
///
/// The model's motion q of the mass centre gives what an output sees: a direction of Q, a leg
/// length J_l_q q; q against the ground for accelerometers, else against the base. The metric of
/// the outputs y = S q is that of the least kinetic energy with which the platform can show y,
/// (S M⁻¹ Sᵀ)⁻¹; for six directions it is that of the platform's mass. Every mode counts with a
/// column of length one: identification has separated the modes, so that a strong one hides no weak
/// one. Without comparable outputs frequencies alone decide. `highest_damping`: poles of the model
/// above it are left out, as in identification.
ModeComparison compare_modes(const data::ModalResults& measured, std::vector<ObservedMode> model,
                             const ComparisonFrame& frame, double highest_damping = 0.3,
                             const ObservationOptions& options = {});

/// Two lists of modes that are equals, such as those of a machine before and after a repair.
///
/// Shapes are compared on the same outputs in one metric; MAC of a pair is that of either mode with
/// the group of the other, the larger of both. Every mode of the first list gets a partner or none
/// so that the sum of the costs of pairs is smallest, as in compare_modes().
struct ModeList {
  std::vector<std::complex<double>> poles{};  ///< λ [1/s]
  Eigen::MatrixXcd shapes{};  ///< outputs × modes, in units of the metric; without rows: none known
};

struct ListedPair {
  int first{}, second{};
  std::optional<double> mac{};
};

/// Ascending in the first list. Throws std::invalid_argument where shapes are of different outputs
/// or not as many as poles.
std::vector<ListedPair> pair_lists(const ModeList& first, const ModeList& second,
                                   const ObservationOptions& options = {});

/// Root of (S M⁻¹ Sᵀ)⁻¹, the metric of outputs y = S q (`map`, a row each) of the motion q of the
/// mass centre; of the pseudoinverse where outputs repeat what others see. `root`: of M, see
/// platform_metric().
Eigen::MatrixXd output_metric(const Eigen::MatrixXd& map, const spatial::Matrix6& root);

}  // namespace hydrapod::observation
