#pragma once
/// What follows from a machine file without solving for modes: `hydrapod check`.
///
/// Bode diagrams, rigid beside flexible: JSON, CSV and pictures.
///
/// The whole machine as one linear system, for people and programs: poles, root locus, response
/// from command to pose.
///
/// A simulated run from commands as people write them: what `hydrapod simulate` runs, prints and
/// plots.
///
/// Modes at several poses of one machine.
///
/// Studies and designs as JSON and pictures.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/realtime/realtime.hpp"
#include "hydrapod/report/json.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "hydrapod/simulation/capability.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "hydrapod/study/design.hpp"

namespace hydrapod::report {

/// One leg at a pose.
struct LegCheck {
  double length{};                       ///< l [m]
  double piston{};                       ///< l_m [m]; NaN of a strut, as is
  double guided_length{};                ///< l_mh [m]
  std::optional<double> retract_left{};  ///< stroke left inwards [m]; none without a stroke
  std::optional<double> extend_left{};   ///< and outwards [m]
  double oil_stiffness{};  ///< k_h of the leg as it is bent [N/m]; of a strut its stiffness
  double axial_force{};    ///< static, of the oil on the piston [N], positive in compression
  double tilt{};           ///< static tilt of the rod in the guide sleeve [rad]
  double sleeve_offset{};  ///< static, of the rod at the guide sleeve [m]
  std::optional<double> bending{};      ///< f of rod and case at the guide sleeve [m/N]
  std::optional<double> bow{};          ///< static, of rod and case at the guide sleeve [m]
  std::optional<double> bow_growth{};   ///< f over that without the compression of the rod
  std::optional<double> ring_offset{};  ///< static, of the piston in its ring [m]
  std::optional<double> gap{};          ///< of the guide ring [m]
  bool on_guide{};                      ///< the rod lies on its guide ring
  double base_tilt{}, platform_tilt{};  ///< joint angles from the neutral pose [rad]
  /// Chamber pressures at rest [Pa], absolute; none where the supply cannot hold the load.
  std::optional<double> cap_pressure{}, rod_pressure{};
  double largest_push{}, largest_pull{};  ///< of the oil at the supply pressure [N]
  /// Of an electric cylinder: |F| p/2π [N m] that the motor holds at rest, and its limits; what it
  /// moves the leg with is `largest_push` and `largest_pull`, infinite without a torque limit.
  std::optional<double> holding_torque{}, torque_limit{};
  std::optional<double> largest_speed{};  ///< p ω_max/2π [m/s]
  /// As a column of rod and case; none where the file does not say how thick the rod is.
  std::optional<dynamics::ColumnStrength> column{};
};

/// What a user should know of a pose.
struct PoseWarning {
  enum class Kind {
    buckled,        ///< value: mass that must come off [kg]
    near_buckling,  ///< value: payload that the legs carry [kg]; ratio: of all mass to today's
    no_equilibrium,
    little_stroke,   ///< value: stroke left [m]
    short_guide,     ///< value: length of the piston inside the guide sleeve [m]
    tilted_rod,      ///< value: static tilt [rad]
    near_singular,   ///< value: condition
    weak_supply,     ///< value: static force [N]; ratio: what the oil can give against it [N]
    air_pressure,    ///< value: mean chamber pressure at rest [Pa]; ratio: stated with the air [Pa]
    rod_buckles,     ///< value: static force [N]; ratio: what the leg bears as a column [N]
    little_reserve,  ///< value: what the leg bears as a column over the static force
    slender_rod,     ///< value: push of the oil [N]; ratio: what the leg bears as a column [N]
    rod_on_guide,    ///< value: static offset at the guide sleeve [m]; ratio: the gap [m]
    soft_oil,        ///< rigid legs do not stand either; value: mass that must come off [kg]
    weak_pump,       ///< value: flow of the pump; ratio: leakage of the valves at rest [m³/s]
    stuck,          ///< value: break-away friction [N]; ratio: what the oil has beside the load [N]
    much_friction,  ///< value: break-away friction [N]; ratio: push of the oil [N]
    soft_struts,    ///< the machine on its struts is unstable; value: mass that must come off [kg]
    soft_screws,    ///< the same of electric cylinders with rigid guides
    weak_motor,     ///< value: static force [N]; ratio: what the motor can give against it [N]
    slender_screw,  ///< value: push of the motor [N]; ratio: what the leg bears as a column [N]
    no_gap_stated   ///< value: static offset at a guide sleeve whose gap is not stated [m]
  };
  Kind kind{};
  double value{};           ///< of the worst leg
  double ratio{};           ///< what it is depends on the kind
  std::vector<int> legs{};  ///< 0…5
};

struct PoseCheck {
  model::NamedPose pose{};
  kinematics::PoseQuality quality{};
  std::array<LegCheck, model::leg_count> legs{};
  bool equilibrium{};      ///< static forces and tilts are valid
  bool buckling_sought{};  ///< not without gravity, nor for legs that cannot fold
  dynamics::Buckling buckling{};
  std::optional<double>
      lowest_at_buckling{};  ///< undamped ω of the lowest mode just below that payload [rad/s]
  std::optional<double> first_resonance{};  ///< |λ| of the lowest mode [rad/s]; none: unstable
  /// None where the machine does not stand.
  std::optional<simulation::Capability> capability{};
  std::vector<PoseWarning> warnings{};
};

/// Can the machine not stand at the pose: are its legs folded, is there no equilibrium, is the
/// supply too weak?
bool is_fatal(PoseWarning::Kind kind);
/// One text per cause for all poses together: that of the pose where it is worst, with the names of
/// the others.
std::vector<std::string> warnings_by_cause(const std::vector<PoseCheck>& poses);
bool is_sound(const PoseCheck& check);

/// Is the finding of model::unusual_numbers() about a number beyond the range of its key, as a bore
/// of 100 m is? A number that is unusual beside others only, as a light platform on heavy legs, is
/// not implausible.
bool is_implausible(const model::Machine& machine, const model::Finding& finding);

/// Sound at all poses, and without an implausible number.
bool is_sound(const std::vector<PoseCheck>& poses, const model::Machine& machine);

/// One sentence over all poses: sound, or not and why. It names unusual numbers.
std::string verdict_text(const std::vector<PoseCheck>& poses, const model::Machine& machine);

/// `hydrapod check`: legs, strokes, static forces and buckling at poses.
Json check_json(const std::vector<PoseCheck>& poses, const model::Machine& machine);
std::vector<PoseCheck> checks_from_json(const Json& json, const std::string& file);

std::string warning_text(const PoseWarning& warning);

/// "leg 3 pushes with all it has", "flow of the pump".
std::string limit_text(simulation::Limit limit);

/// What a plot says about itself.
struct PlotText {
  std::string title{};
  std::string subtitle{};  ///< pose, point, damping, gravity: what a reader must know
};

/// Bars by direction, both signs, one diagram for each of force, speed, acceleration, jerk and
/// excursion; the colour says what ends it. Throws as draw(), and base::InputError for a pose
/// without a capability.
void plot_capability(const PoseCheck& check, const PlotText& text, const std::string& path);

/// "45.92 kg", "74940 kg": four digits, and a power of ten from 1e9 kg on only.
std::string mass_text(double mass);

struct BodeOptions {
  response::Input input{response::Input::wrench};
  response::Output output{response::Output::displacement};
  std::optional<spatial::Vector3>
      p_PQ{};                    ///< the point, in P [m]; default: the platform's mass centre
  std::optional<double> from{};  ///< [rad/s]; default: a third of the lowest platform mode's
  std::optional<double> to{};    ///< [rad/s]; default: twice the highest one
  int points{2000};
};

struct Bode {
  BodeOptions options{};  ///< with every default filled in
  modal::ModeTable table{};
  std::vector<double> omega{};  ///< [rad/s], evenly spaced on a logarithmic axis
  std::vector<response::Matrix6c> real{}, rigid{};
  std::vector<response::Peak> real_peaks{}, rigid_peaks{};
};

/// "m/N", "rad/s/(N m)"; what an entry of the response is measured in.
std::string response_unit(response::Output output, int out_direction, int in_direction);

Json bode_json(const Bode& bode);
/// Reads it. Of `table` there is the model, and the labels of the modes at peaks.
Bode bode_from_json(const Json& json, const std::string& file);

/// A 6×6 response over frequency: `omega_rad_s[]`, `frequency_hz[]`, `response[output][input]` with
/// `re[]` and `im[]`; and back.
Json response_json(const std::vector<double>& omega, const std::vector<response::Matrix6c>& H);
std::vector<double> response_from_json(const Json& json, const std::string& file,
                                       std::vector<response::Matrix6c>& H);

Json peaks_json(const std::vector<response::Peak>& peaks, const modal::AnalysedModel& model);

/// Frequency in Hz and rad/s, then re and im of all 36 entries of both models, a header line with
/// units.
std::string bode_csv(const Bode& bode);

/// One entry of the 6×6 response.
struct Entry {
  int output{};
  int input{};
};

/// Magnitude and phase of `entries` as a gnuplot script that plots to `terminal` and `file`.
std::string bode_script(const Bode& bode, const std::vector<Entry>& entries, const PlotText& text,
                        const std::string& terminal, const std::string& file);

/// Runs gnuplot; the picture's format follows from the ending of `path` (.svg, .png, .pdf). The
/// file is written whole or not at all. Throws base::InputError for another ending or a folder that
/// is not there, base::ComputationError when gnuplot is missing or fails.
void plot_bode(const Bode& bode, const std::vector<Entry>& entries, const PlotText& text,
               const std::string& path);

/// What takes part in a pole, in words: "oil 41 %, controller 38 %, platform z 12 %"; parts below
/// 10 % are left out. A leg that has most of a part's share is named.
std::string participation_text(const simulation::SystemPole& pole);

/// "stable: …" or "unstable: …", by the sampled loop, with the pole that decides it.
std::string verdict_text(const simulation::SystemPoles& poles);

/// Mechanics, hydraulics and controller as one linear system.
struct System {
  bool closed{true};  ///< false: without the controller
  simulation::LinearSystem linear{};
  simulation::SystemPoles poles{};
  simulation::Tuning tuning{};  ///< of the controller; empty without one
};

/// `controller`, `stable`, `poles[]`, `sampled`, `delay`.
Json system_json(const System& system);
/// Reads it. Of `linear` there are the delay and the sample time.
System system_from_json(const Json& json, const std::string& file);
std::string system_poles_csv(const simulation::SystemPoles& poles);

/// Poles over one number of the machine file.
struct RootLocus {
  std::string key{};
  std::vector<double> values{};
  std::vector<simulation::SystemPoles> poles{};
  /// Where the sampled loop passes from stable to unstable or back between two values, bisected to
  /// 1e-4 of their distance.
  std::vector<double> limits{};
  /// Of the machine as it is, for pictures; the number too where the machine holds it.
  simulation::SystemPoles today{};
  std::optional<double> today_value{};
};
Json root_locus_json(const RootLocus& locus);
/// Reads it. Of the poles there is λ alone.
RootLocus root_locus_from_json(const Json& json, const std::string& file);
std::string root_locus_csv(const RootLocus& locus);
/// Poles in the complex plane, coloured by the value, with rays of equal damping ratio, an arrow
/// along each branch towards the last value, and a cross at the poles of today. Throws as
/// plot_bode does.
void plot_root_locus(const RootLocus& locus, const std::string& title, const std::string& subtitle,
                     const std::string& path);

/// H from the commanded to the true displacement of the pose, 6×6.
struct CommandResponse {
  std::vector<double> omega{};  ///< [rad/s]
  std::vector<response::Matrix6c> H{};
};

/// What a direct response is like.
struct CommandBandwidth {
  std::optional<double> magnitude{};  ///< −3 dB [rad/s]
  std::optional<double> phase{};      ///< −90° [rad/s]
  double peak{};                      ///< largest magnitude
  double peak_omega{};                ///< [rad/s]
};
CommandBandwidth command_bandwidth(const CommandResponse& response, int direction);

Json command_response_json(const CommandResponse& response);
CommandResponse command_response_from_json(const Json& json, const std::string& file);
std::string command_response_csv(const CommandResponse& response);
void plot_command_response(const CommandResponse& response, const std::string& title,
                           const std::string& subtitle, const std::string& path);

/// A simulated run.
struct Simulation {
  std::vector<std::string> commands{};  ///< as signals::signal_text writes them
  std::vector<std::string> wrench{};    ///< likewise: force and moment about the mass centre
  std::string damping{};                ///< as plant_damping_text() says
  std::vector<std::string> warnings{};
  double until{};
  double output_interval{};
  simulation::LoopOptions loop{};
  control::ControllerParameters controller{};
  double lowest_oil_mode{};  ///< [rad/s]
  std::array<hydraulics::Stops, model::leg_count> stops{};
  simulation::Settling settling{};
  simulation::RunSummary summary{};
  simulation::Trace trace{};
  std::string record{};  ///< file that holds it; empty: none was asked for
};

/// `model`, `actuators`, `damping`, `commands[]`, `wrench[]`, `initial`, `controller`, `run`,
/// `directions[]`, `legs[]`, `trace`.
Json simulation_json(const Simulation& simulation);
/// What a server in real time counted and measured.
Json serve_json(const realtime::ServeResult& result);
Simulation simulation_from_json(const Json& json, const std::string& file);

/// The run as the page of `hydrapod report` shows it: `pose`, `geometry` of the machine there,
/// `summary` in words, and the above. `rest`: the model at the pose at which the run began.
Json simulation_section(const Simulation& simulation, const model::Machine& machine,
                        const model::NamedPose& pose, const dynamics::LinearModel& rest);

/// The controller's numbers: `controller` of the above.
Json controller_json(const control::ControllerParameters& parameters, double lowest_oil_mode);
simulation::Tuning controller_from_json(const Json& json, const std::string& file);

/// Commanded and true motion in the six directions, and pistons and drives of the legs, over time.
/// Throws as plot_bode does.
void plot_simulation(const Simulation& simulation, const std::string& title,
                     const std::string& subtitle, const std::string& path);
/// Modes of one machine at several poses, followed from pose to pose by their shape.
struct ModesAtPoses {
  struct Followed {
    std::vector<int> mode{};  ///< per pose, index into real.modes; −1: not among them there
    std::vector<std::optional<double>> mac{};  ///< with the mode at the pose before
  };
  std::vector<model::NamedPose> poses{};
  std::vector<modal::ModeTable> tables{};  ///< one per pose
  std::vector<Followed> followed{};        ///< those with platform motion
};
/// `poses[]` with `pose` and what modes_json() has, `followed[]` with `mode[]`, `mac[]` and
/// `frequency_hz[]` by pose.
Json modes_at_poses_json(const ModesAtPoses& modes);
ModesAtPoses modes_at_poses_from_json(const Json& json, const std::string& file);
/// A line per followed mode and pose.
std::string modes_at_poses_csv(const ModesAtPoses& modes);

struct ModesAtAmplitudes {
  std::vector<double> amplitudes{};             ///< [m] of the platform joint that moves most
  std::vector<modal::AmplitudeCurve> curves{};  ///< a branch each
};
/// `amplitude_m[]`, and `curves[]` with `mode`, `direction`, `frequency_hz` where the branch
/// begins, `points[]`, `further[]`, `turning_points[]` and `end`.
Json modes_at_amplitudes_json(const ModesAtAmplitudes& modes);
ModesAtAmplitudes modes_at_amplitudes_from_json(const Json& json, const std::string& file);
/// A line per solution, branch by branch in its order.
std::string modes_at_amplitudes_csv(const ModesAtAmplitudes& modes);
/// Frequency and damping ratio over the amplitude. Needs gnuplot; see plot_bode.
void plot_modes_at_amplitudes(const ModesAtAmplitudes& modes, const std::string& title,
                              const std::string& subtitle, const std::string& path);

/// How high a resonance stands beside that of rigid legs. A force along a rigid-leg mode ψ meets a
/// mode of the flexible model that holds the share MAC of ψ. At its resonance the response along ψ
/// is MAC/(2 ζ ω²), that of the rigid-leg model 1/(2 ζ ω_r²). With equal damping ratios their
/// quotient is MAC (ω_r/ω)², which is also the mode's share of the static compliance over that of
/// rigid legs. [rad/s]; 0 where `omega` is 0, of a mode that there is not.
inline double peak_height(double mac, double omega, double omega_rigid) {
  return omega > 0.0 ? mac * (omega_rigid / omega) * (omega_rigid / omega) : 0.0;
}

/// Throws base::InputError for a picture ending that plots do not know.
void require_picture_ending(const std::string& path);

/// From now on every picture holds the text that `origin` makes when it is drawn: by which command
/// and of which files. SVG in <desc>, PNG in a text chunk "Description", PDF in comments at its
/// end. Not to be called while pictures are drawn.
void state_in_pictures(std::function<std::string()> origin);

/// `rows`, `rows_planned`, `complete`, `seed`, `inputs[]`, `statuses`, `outputs[]` with mean,
/// deviation and quantiles, `requirements[]` with the probability of missing them and its interval,
/// `indices[]` where they were asked for.
Json study_json(const study::Problem& problem, const study::Plan& plan,
                const std::vector<study::Requirement>& requirements, const study::Summary& summary);

/// A value over two inputs that form a grid, the second one fastest; NaN: no value.
struct Field {
  std::string x_name{}, y_name{};  ///< with units
  std::vector<double> x{}, y{};
  std::string name{};  ///< of the value
  std::string unit{};  ///< SI, drawn with a prefix; empty: it is in the name
  std::vector<double> values{};
  /// Of a requirement for this value; its contour is drawn, and named by the text.
  std::optional<double> bound{};
  std::string bound_text{};
  /// [m] as `values`, negative beyond the stroke: where it ends a line is drawn. Empty: none.
  std::vector<double> stroke_left{};
};

/// Heat map with contours; where there is no value the plane is grey.
void plot_field(const Field& field, const std::string& title, const std::string& subtitle,
                const std::string& path);

/// `feasible`, `evaluations`, `changes[]`, `aims[]`, `requirements[]` with what can be reached,
/// `limits[]` with prices, `front[]` of two aims.
Json design_json(const study::DesignProblem& problem, const study::DesignResult& result);

/// What a user wrote a quantity in: the machine file its numbers, a requirement its bound.
struct DesignUnits {
  std::vector<model::WrittenUnit> changes{}, requirements{}, aims{};
};

/// The curve of two aims.
void plot_trade_off(const study::DesignProblem& problem, const study::DesignResult& result,
                    const DesignUnits& units, const std::string& title, const std::string& subtitle,
                    const std::string& path);

/// Per change, what each requirement has to spare where this change alone differs from the design;
/// the design is a dashed line, what misses a requirement is grey.
void plot_design_slices(const study::DesignProblem& problem, const study::DesignResult& result,
                        const DesignUnits& units, const std::vector<study::Slice>& slices,
                        const std::string& title, const std::string& subtitle,
                        const std::string& path);

}  // namespace hydrapod::report
