#pragma once
/// The machine that a controller meets: nonlinear mechanics and actuators as one ordinary
/// differential equation ẋ = f(x, input). Actuators are chambers, valves and supply, or the drives
/// of electric cylinders (docs/theory/actuators.md, "Drives").
///
/// State x, in this order (StateLayout; units in state_units()):
///     y    position of C [m], quaternion of R_BP (w, x, y, z), per leg φ1, φ2 [rad] (, u1, u2
///     [m]),
///          ξ of the payload's modes [m]
///     v    velocity of C [m/s], ω in base axes [rad/s], rates of the flexible coordinates, of ξ
///     p    per leg the cap-side and the rod-side pressure [Pa, absolute]
///     w    per leg spool position [of the travel] and its rate [1/s]
///          (in place of p and w of electric cylinders: s_n, ṡ_n, T_i per leg, the way of the nut
///          [m], its rate [m/s], the integral part of the torque [N m])
///     p_s  supply pressure [Pa], with a limited pump only
///     z    per leg the bristles' bend [m], with LuGre friction in any leg only
///     p, q per line with waves (a length and `lines.segments` N) its pressures from the valve on
///          [Pa] and its flows towards the chamber [m³/s], see hydraulics::SegmentedLine: leg 1 cap
///          side, leg 1 rod side, leg 2 cap side, …; with `lines.modes` N those of its modes, see
///          hydraulics::ModalLine
///     z    per leg the bend of the bristles in its joints [rad], with `joint_friction.coulomb` and
///          `bristle_stiffness` in any leg only: of the base joint along t and a2, of the platform
///          joint along the directions of dynamics::LegJoints
///     q_b  motion of the base against the ground [m, rad], in the compliant directions only
///     v_b  its rates
///     η    per arm of seals that are elastomers two [m], along t and a2: of the guide sleeve's
///     arms
///          of all legs, then of the piston rings'
///     w, d̄  per seal whose stiffness large amplitudes take away (`softening`) the square of the
///          amplitude over that of `softening_amplitude`, and its mean offset along t and a2 [m]:
///          running means, see PlantOptions::softening
/// With `hydraulics = false` there are y and v only, and each leg is held by the linear model's oil
/// spring, at rest at the reference pose: it pulls with f + k_h (s − s_0) + c_h ṡ. There is no
/// friction of the seals along the leg then, and there are end stops only with a given stroke.
/// With `oil_springs = false` as well, the input's axial forces alone act on the pistons.
///
/// Compliant gimbals (`gimbal_stiffness` k_j, along the leg) are a spring without mass in series
/// with the oil; they add no state. The piston stands at s_p = s + (F − F_0)/k_j with F the oil's
/// force and F_0 that of rest at the reference pose, where the file's lengths hold; it moves at
///     ṡ_p = (ṡ + q/k_j) / (1 + k/k_j)     q: Ḟ by flows alone, k: stiffness of both chambers
/// Chambers see s_p and ṡ_p; seals' friction and end stops act beside oil and gimbals, on s and ṡ.
///
/// A compliant base (`base.mount`) moves as dynamics/nonlinear.hpp says. Poses, lengths and
/// everything else is then against the base, in its axes, unless it says otherwise.
///
/// Input: commands of the valves, or of the motors' speeds as shares of the largest one, in
/// [−1, 1] (+: the leg extends), and a wrench on the platform.
///
/// Damping. Seals, joints and hydraulics damp by their own laws. Of `[damping]`, Rayleigh's α acts
/// as −α v on the accelerations, β as a damper β k beside every spring; model::modal_ratio goes to
/// the guide sleeves and piston rings, on top of the dampers that they have: c = 2 ζ k / ω,
/// ω² = k l_mh² / M_φφ of a sleeve and k / M_uu of a ring at the reference pose. It is added to the
/// ratios of the payload's modes.
/// With hydraulics, `oil_spring.damping` is not used: leakage, valves and friction stand for it.
/// report::plant_damping_text says so in words.

#include <memory>
#include <string>
#include <vector>

#include "hydrapod/dynamics/nonlinear.hpp"
#include "hydrapod/hydraulics/lines.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::simulation {

using dynamics::ModelKind;
using spatial::Pose;
using spatial::Vector3;
using spatial::Vector6;

enum class Friction {
  all,
  /// No Coulomb and Stribeck parts: what a linearisation about rest should have. Joints with
  /// bristles stick: springs from the reference pose on, without states.
  viscous,
  none
};

struct PlantOptions {
  bool hydraulics{true};  ///< the actuators: valves and oil, or electric drives
  Friction friction{Friction::all};
  bool oil_springs{true};  ///< without hydraulics; false: PlantInput::axial holds the legs
  /// Of electric drives; false: commands do nothing, and motors turn freely about the torques that
  /// hold them at rest.
  bool speed_loops{true};
  /// Elastomers soften under large amplitudes (docs/theory/elastomers.md); false: as a
  /// linearisation about rest should have it, which they do not change.
  bool softening{true};
};

/// Of a linearisation at rest.
inline constexpr PlantOptions small_motions{.friction = Friction::viscous, .softening = false};

struct PlantInput {
  Vector6 command{Vector6::Zero()};  ///< of valves or motors, clipped to [−1, 1]
  Vector6 wrench{Vector6::Zero()};   ///< force [N] and moment [N m] about C, base axes
  /// On the pistons along the legs [N], + pushes the leg out; `oil_springs = false` only.
  Vector6 axial{Vector6::Zero()};
};

/// Where things stand in x; −1 for what is not there.
struct StateLayout {
  int positions{};    ///< length of y; y begins at 0
  int velocities{};   ///< length of v; v begins at `positions`
  int payload{};      ///< modes of the payload: as many last ones of y and of v
  int pressures{-1};  ///< first of 12: leg 1 cap, leg 1 rod, leg 2 cap, …
  int spools{-1};     ///< first of 12: leg 1 position, leg 1 rate, leg 2 position, …
  int nuts{-1};       ///< first of 18: leg 1 s_n, ṡ_n, T_i, leg 2 s_n, …
  int supply{-1};
  int bristles{-1};   ///< first of 6
  int line_states{};  ///< of one line, 2 N; 0: no lines with waves
  /// First state of each line, in the order of the pressures; −1 where it has no waves.
  std::array<int, 2 * model::leg_count> lines{-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  int joints{-1};  ///< first of 24, four per leg: bend of the joints' bristles
  int base{-1};    ///< first of q_b, then as many of v_b
  int arms{-1};    ///< first of the seals' η
  /// Per leg the first η of its guide sleeve and of its piston ring, arm by arm along t and a2; −1
  /// where the seal is no elastomer.
  std::array<int, model::leg_count> sleeve_arms{-1, -1, -1, -1, -1, -1};
  std::array<int, model::leg_count> ring_arms{-1, -1, -1, -1, -1, -1};
  /// Per leg the w of its guide sleeve and of its piston ring, before d̄; −1 where nothing softens.
  std::array<int, model::leg_count> sleeve_softening{-1, -1, -1, -1, -1, -1};
  std::array<int, model::leg_count> ring_softening{-1, -1, -1, -1, -1, -1};
  int size{};
  /// States of the arms of one seal, and of its softening.
  static constexpr int arm_states = 2 * static_cast<int>(dynamics::arms_per_seal);
  static constexpr int softening_states = 3;
  bool operator==(const StateLayout&) const = default;
  [[nodiscard]] int velocity() const { return positions; }
  [[nodiscard]] int tangent() const { return size - 1; }  ///< length of a small change of x
  [[nodiscard]] int cap(int leg) const { return pressures + 2 * leg; }
  [[nodiscard]] int rod(int leg) const { return pressures + 2 * leg + 1; }
  [[nodiscard]] int spool(int leg) const { return spools + 2 * leg; }
  [[nodiscard]] int nut(int leg) const { return nuts + 3 * leg; }
  /// First of two, of a joint.
  [[nodiscard]] int joint(int leg, bool platform) const {
    return joints + 4 * leg + (platform ? 2 : 0);
  }
};

struct LegOutput {
  double length{}, length_rate{};         ///< l [m], l̇ [m/s]
  double piston{}, piston_rate{};         ///< in the cylinder: s_p [m], ṡ_p [m/s]
  double cap_pressure{}, rod_pressure{};  ///< [Pa]
  double spool{}, spool_rate{};
  double cap_flow{}, rod_flow{};  ///< from the valve towards the chambers [m³/s]
  double cap_valve_pressure{}, rod_valve_pressure{};  ///< at the valve's ports [Pa]
  double cap_inflow{}, rod_inflow{};    ///< out of the lines into the chambers [m³/s]
  double supply_flow{}, return_flow{};  ///< of the valve [m³/s]
  double internal_leakage{};            ///< cap side to rod side [m³/s]
  double external_leakage{};            ///< out of both chambers [m³/s]
  double oil_force{};       ///< of oil, or of the screw, on the piston, + pushes the leg out [N]
  double friction_force{};  ///< on the rod along s [N]
  double stop_force{};      ///< [N]
  dynamics::Vector4 flexible{dynamics::Vector4::Zero()};       ///< φ1, φ2, u1, u2
  dynamics::Vector2 sleeve_offset{dynamics::Vector2::Zero()};  ///< d_s [m]
  double nut{}, motor_speed{}, torque{};  ///< s_n [m], θ̇ [rad/s], T [N m] of an electric drive
};

/// The base against the ground, at the origin of B; all zero where it is rigid.
struct BaseOutput {
  Vector6 motion{Vector6::Zero()};        ///< q_b [m, rad]
  Vector6 rate{Vector6::Zero()};          ///< v_b
  Vector6 acceleration{Vector6::Zero()};  ///< a_b
  double kinetic_energy{};                ///< what it adds to that of platform and legs [J]
  double elastic_energy{};                ///< of its springs [J]
};

/// Motions are against the base, in its axes.
struct PlantOutput {
  Pose X_BP{};
  Vector3 p_BC{Vector3::Zero()};
  Vector6 twist{Vector6::Zero()};         ///< velocity of C, ω
  Vector6 acceleration{Vector6::Zero()};  ///< of C, ω̇
  /// Of C and ω̇, against the ground: what accelerometers measure.
  Vector6 ground_acceleration{Vector6::Zero()};
  BaseOutput base{};
  std::array<LegOutput, model::leg_count> legs{};
  double supply_pressure{};
  double pump_flow{}, supply_flow{}, return_flow{};  ///< [m³/s]; supply: drawn by the valves
  dynamics::Energies energies{};                     ///< of the mechanism
  /// [J], with `hydraulics = false` from the reference pose; of the screws (and gimbals) that
  /// electric drives turn; else 0.
  double oil_spring_energy{};
  double motor_energy{};   ///< [J], kinetic, of the rotors of electric drives
  double motor_power{};    ///< [W], Σ T θ̇: what the motors put in
  double gimbal_energy{};  ///< [J], with hydraulics: Σ F²/2k_j; else part of the oil springs'
  /// [J], of the arms of seals that are elastomers, less what softening takes from their springs.
  double seal_arms_energy{};
  double joint_bristles_energy{};  ///< [J], of the bristles in the legs' joints
  /// [W]: seals, joints, friction, dampers, mount; not the hydraulics. Seals that recover from
  /// softening give back for a while what softening took.
  double dissipation{};
  double line_kinetic_energy{};  ///< [J], of the oil in lines with waves
  double line_dissipation{};     ///< [W], by the viscosity of that oil
};

/// δẋ = A δx + B δu, δy = C δx + D δu. δx is a small change of x with the quaternion replaced by
/// the rotation vector in base axes (length layout.tangent()); δu = (commands 6, wrench 6); outputs
/// are those of linear_output_names().
struct LinearPlant {
  Eigen::MatrixXd A{}, B{}, C{}, D{};
};

/// The controller of a motor's speed: torque k_p (e + ∫e dt/t_i) for an error e of the speed.
struct SpeedLoop {
  double bandwidth{};      ///< k_p/J [rad/s]: of a rotor without load
  double gain{};           ///< k_p [N m s/rad]
  double integral_time{};  ///< t_i [s]
};

/// As the screw says; t_i is 4/bandwidth where it says none, so that both poles of the free rotor
/// are at half the bandwidth.
SpeedLoop speed_loop(const model::Screw& screw);

struct OilState;  // private to the sources, as are
struct OilRates;
struct Drives;

class Plant {
 public:
  /// `X_reference` is where the legs' frames are chosen, see NonlinearModel; default: neutral.
  Plant(const model::Machine& machine, ModelKind kind, const PlantOptions& options = {});
  Plant(const model::Machine& machine, ModelKind kind, const PlantOptions& options,
        const Pose& X_reference);

  [[nodiscard]] const model::Machine& machine() const { return machine_; }
  [[nodiscard]] ModelKind kind() const { return mechanics_.kind(); }
  [[nodiscard]] const PlantOptions& options() const { return options_; }
  [[nodiscard]] const dynamics::NonlinearModel& mechanics() const { return mechanics_; }
  /// Its chambers do not contain what lines with waves hold.
  [[nodiscard]] const hydraulics::ServoAxis& axis(int leg) const { return axes_[leg]; }
  [[nodiscard]] const dynamics::MovingBase& base() const { return base_; }  ///< `count` 0: still

  [[nodiscard]] const StateLayout& layout() const { return layout_; }
  [[nodiscard]] std::vector<std::string> state_names() const;  ///< "x", …, "leg1.p_cap", …
  [[nodiscard]] std::vector<std::string> state_units() const;
  /// Names of δx: as state_names(), with "rx", "ry", "rz" for the quaternion.
  [[nodiscard]] std::vector<std::string> tangent_names() const;
  /// Magnitudes that matter of each state; absolute tolerances are multiples of them.
  [[nodiscard]] Eigen::VectorXd scales() const;
  /// Steps of each state for differences of order 4, as linearise() takes them for δx.
  [[nodiscard]] Eigen::VectorXd steps() const;

  /// The state that rests at a pose, held by the valves, and the commands that hold it. Throws
  /// base::ComputationError where there is none: legs past buckling, piston outside its stops, a
  /// load beyond the supply.
  struct Rest {
    Eigen::VectorXd x{};
    PlantInput input{};
  };
  [[nodiscard]] Rest equilibrium(const Pose& X_BP) const;

  /// f(x, input) into `rate`, both of layout().size. False when x is no state: a leg that does not
  /// close, or a number that is not finite.
  bool derivative(double t, const double* x, const PlantInput& input, double* rate) const;

  [[nodiscard]] PlantOutput outputs(const double* x, const PlantInput& input) const;
  [[nodiscard]] Pose pose(const double* x) const;
  /// Leg lengths l [m] at x: what transducers see.
  [[nodiscard]] Vector6 leg_lengths(const double* x) const;

  /// Torques of electric drives at x [N m], limits included; zero without drives.
  [[nodiscard]] Vector6 motor_torques(const double* x, const Vector6& command) const;

  /// x ⊕ δx: adds a small change; the rotation acts from the left (base axes).
  void displace(const double* x, const double* change, double* result) const;
  [[nodiscard]] LinearPlant linearise(const Eigen::VectorXd& x, const PlantInput& input) const;
  /// "x", …, "rz" of the platform at C, "leg1.l", …, "leg1.l_rate", …, "leg1.p_cap", "leg1.p_rod",
  /// … (of electric drives "leg1.torque", "leg1.motor_speed", …), "ax", …, "arz" (accelerations of
  /// C and ω̇ against the ground; all else against the base).
  [[nodiscard]] std::vector<std::string> linear_output_names() const;

  /// Event functions; each changes its sign when something happens.
  enum class Event {
    retracted,       ///< piston at the stop on the base side
    extended,        ///< at the other
    cavitation_cap,  ///< cap-side pressure at the cavitation pressure
    cavitation_rod,
    unguided  ///< the piston leaves the guide sleeve (l_mh = 0): the model ends here
  };
  static constexpr int events_per_leg = 5;
  [[nodiscard]] int event_count() const { return model::leg_count * events_per_leg; }
  /// Positive on the ordinary side; [m] and [Pa].
  void events(const double* x, double* values) const;
  static const char* name(Event event);

 private:
  struct OilSpring {
    double force{}, stiffness{}, damping{}, s{};
  };
  /// Joints whose bristles only stick: directions at the reference pose.
  struct StuckJoints {
    bool any{};
    std::array<Vector3, model::leg_count> axis{};  ///< n in B
    std::array<Vector3, model::leg_count> rod{};   ///< e in P
  };
  struct Joint;  ///< a joint with bristles as it stands
  template <class Each>
  void for_joints(const double* x, const dynamics::Motion& motion, const Each& each) const;
  struct Gimbals {
    double compliance{};  ///< 1/k_j [m/N], 0: they are rigid
    double force{};       ///< F_0 [N]
  };
  struct Work;  ///< intermediate results of one evaluation
  bool evaluate(const double* x, const PlantInput& input, double* rate, Work& work) const;
  struct OilConstants;
  void set_oil_constants(const Pose& X_reference);
  OilState oil_state(const dynamics::Motion& motion, const double* x,
                     const PlantInput& input) const;
  OilRates oil_rates(const OilState& state) const;
  void oil_side(const double* x, const PlantInput& input, double* rate, Vector6& axial,
                Work& work) const;
  static LegOutput oil_output(int leg, const Work& work);
  double spring_side(int leg, const dynamics::LegMotion& motion, const PlantInput& input,
                     LegOutput& out) const;
  void supply_side(const double* x, double* rate, Work& work) const;
  void set_drives();
  [[nodiscard]] double screw_stretch(int leg, double nut, double s) const;
  void drives_side(const double* x, const PlantInput& input, double* rate, Vector6& axial,
                   Work& work) const;
  void drives_outputs(const double* x, const Work& work, PlantOutput& out) const;
  void hold_by_drives(const dynamics::StaticEquilibrium& statics, const dynamics::Motion& now,
                      Rest& rest) const;
  void set_lines();
  void lines_side(const double* x, double* rate, const Work& work) const;
  void lines_outputs(const double* x, PlantOutput& out) const;
  void lines_at_rest(int leg, const hydraulics::HydraulicRest& oil,
                     const hydraulics::PortFlows& flows, Eigen::VectorXd& x) const;
  /// each(line, chamber, first state) of the lines with waves, segmented or modal; `chamber` as in
  /// StateLayout::lines.
  template <class Each>
  void for_lines(const Each& each) const;
  [[nodiscard]] Eigen::VectorXd tangent_rates(const Eigen::VectorXd& x, const Eigen::VectorXd& x_0,
                                              const PlantInput& input) const;
  [[nodiscard]] dynamics::Motion motion(const double* x) const;
  double hold(const dynamics::StaticEquilibrium& statics, const model::Supply& supply,
              Rest& rest) const;
  [[nodiscard]] Eigen::VectorXd mechanics_at_rest(const Pose& X_BP) const;
  [[nodiscard]] dynamics::Motion motion_at_rest(const Pose& X_BP) const;
  void set_base(const Pose& X_reference);
  [[nodiscard]] Vector6 base_part(const double* x, int first) const;
  void base_outputs(const double* x, const Work& work, PlantOutput& out) const;
  void base_side(const double* x, const dynamics::Loads& loads, double* rate, Work& work) const;
  void set_gimbals(const Pose& X_reference);
  /// What large amplitudes take from a seal.
  struct Softening {
    double share{}, amplitude{}, time{};                ///< of the file; share 0: nothing
    double stiffness{};                                 ///< k [N/m]
    double series{};                                    ///< f/(1 + f k) of rod and case that bend
    dynamics::Vector2 rest{dynamics::Vector2::Zero()};  ///< offset at the reference pose [m]
  };
  struct Seal;          ///< an elastomer as it stands
  struct SoftenedSeal;  ///< what it presses with
  void set_arms(const Pose& X_reference);
  void set_softening(const Pose& X_reference, const Vector6& bending);
  /// each(seal) of every elastomer.
  template <class Each>
  void for_seals(const dynamics::Motion& motion, const Each& each) const;
  void arms_side(const double* x, double* rate, dynamics::Loads& loads, const Work& work) const;
  void arms_outputs(const double* x, const Work& work, PlantOutput& out) const;
  void arms_at_rest(Eigen::VectorXd& x) const;
  void set_joints(const Pose& X_reference);
  void joints_side(const double* x, double* rate, dynamics::Loads& loads, const Work& work) const;
  void joints_outputs(const double* x, const Work& work, PlantOutput& out) const;
  void set_springs(const Pose& X_reference);

  model::Machine machine_;
  dynamics::NonlinearModel mechanics_;
  PlantOptions options_;
  std::array<hydraulics::ServoAxis, model::leg_count> axes_{};
  std::array<hydraulics::LegLines, model::leg_count> lines_{};
  std::array<OilSpring, model::leg_count> springs_{};
  std::array<Gimbals, model::leg_count> gimbals_{};
  StuckJoints stuck_joints_{};
  /// Of the seals that are elastomers.
  std::array<dynamics::SealArms, model::leg_count> sleeve_arms_{}, ring_arms_{};
  std::array<Softening, model::leg_count> sleeve_softening_{}, ring_softening_{};
  std::shared_ptr<const OilConstants> oil_constants_{};  ///< all legs side by side
  std::shared_ptr<const Drives> drives_{};               ///< null without electric drives
  dynamics::MovingBase base_{};                          ///< `count` 0: stands still
  StateLayout layout_{};
};

}  // namespace hydrapod::simulation
