#pragma once
/// Tasks over time: the machine moves as it is commanded, or is excited and measured.
///
///     const auto run = tasks::simulate(machine, {.commands = {"step z=5 mm"}, .record =
///     "run.h5"}); tasks::rig(machine, {.record = "test.h5"});

#include "hydrapod/realtime/realtime.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/rig/rig.hpp"
#include "hydrapod/tasks/machine.hpp"

namespace hydrapod::tasks {

/// Of a record that is written.
struct Origin {
  std::string program{};               ///< name, version, commit; empty: this library's version
  std::vector<std::string> command{};  ///< its arguments
  struct Input {
    std::string path{};
    std::string sha256{};  ///< hexadecimal digits
  };
  std::vector<Input> inputs{};  ///< files that were read
};

struct SimulateOptions {
  std::vector<std::string> commands{};  ///< see signals/signals.hpp; they add up; none: rest
  std::vector<std::string> wrench{};  ///< likewise, on the platform about its mass centre [N, N m]
  /// Where the platform stands at time 0, as a displacement from the pose, "x=1 mm, ry=0.1 deg";
  /// empty: at the pose.
  std::string initial{};
  std::optional<double> until{};  ///< [s]; default: what the commands need, and a little more
  /// `kind`, `until`, `initial` and `records_wrench` are not used. Without a controller
  /// (`actuators`) there are no commands.
  simulation::LoopOptions loop{};
  std::size_t trace_samples{3000};
  std::string record{};  ///< file to write (data/record_io.hpp); empty: none
  Origin origin{};       ///< what the record says of its origin
};

/// Time simulation: mechanics, hydraulics, controller. A run that ends early has everything up to
/// there, and so has its record. `progress` that asks to
/// stop ends the run. Throws base::InputError for commands that cannot be read, make no sense, or
/// lead out of the workspace; base::ComputationError where the machine does not stand at the pose.
report::Simulation simulate(const Machine& machine, const SimulateOptions& options,
                            const Progress& progress = {});

struct RigOptions {
  rig::RigOptions test{};  ///< `loop.kind` is not used; `signals` empty: rig::default_signals
  int averages{};          ///< periods of a periodic excitation, instead of `duration`; 0: none
  std::string record{};    ///< file to write; empty: only the levels are checked
  bool force{};            ///< run though the levels do not fit
  Origin origin{};         ///< what the record says of its origin
  /// A real machine in place of the simulated one, behind its controller.
  std::optional<realtime::HardwareOptions> hardware{};
};

struct Rig {
  rig::RigOptions options{};                  ///< as used
  std::vector<rig::LevelFinding> findings{};  ///< of the levels
  rig::RigResult result{};
  std::optional<realtime::HardwareResult> hardware{};
  std::string record{};  ///< file that holds it, see data::RecordWriter::close
};

/// Test rig, simulated or real: excites the machine in six directions and writes a record. Throws
/// base::InputError for levels that do not fit, unless `force` is set. A run that ends early
/// leaves its record.
Rig rig(const Machine& machine, const RigOptions& options, const Progress& progress = {});

/// Limits of a real machine in a text, "length=20 mm, velocity=0.3 m/s, acceleration=10 m/s^2,
/// error=5 mm"; what it does not say has its default. Throws base::InputError, which calls the text
/// `place`.
realtime::Limits limits_of(const std::string& place, const std::string& text);

struct ServeOptions {
  realtime::ServeOptions server{};  ///< `rest` and, without accelerometers, theirs are set here
  std::string rest{};  ///< the rest position as a displacement from the pose, "z=-20 mm"; empty: 0
  std::optional<double> duration{};  ///< [s] of the machine; none: until stopped
  simulation::LoopOptions loop{};    ///< `kind`, `until`, `output_interval` are not used
  std::string record{};              ///< file to write; empty: none
  Origin origin{};
  /// Called with each of ServeResult::warnings before clients can come.
  std::function<void(const std::string& warning)> warn{};
};

struct Served {
  realtime::ServeResult result{};
  std::string record{};
};

/// The machine in real time: commands in, sensors out, by UDP or shared memory. See
/// realtime/realtime.hpp. Throws base::InputError for addresses, layouts and keys that cannot be
/// used. `progress` that asks to stop ends it; its
/// share is 0 without a duration.
Served serve(const Machine& machine, const ServeOptions& options, const Progress& progress = {});

}  // namespace hydrapod::tasks
