#pragma once
/// The plant in real time: the virtual machine on the wall clock, with commands in and sensors out,
/// and the converse, an excitation on a machine behind a controller.
///
/// A sample of the served machine, every controller sample time T:
///     t_k    wait; sensors of t_k out; commands that have arrived in; the newest one acts
///     then   sensors, controller, drives as in simulation::ClosedLoop, plant to t_{k+1}
/// A command therefore acts at the first sample after its arrival, and `answered` of the sensors of
/// t_{k+1} is the command that acted from t_k to t_{k+1}.
///
/// Lock-step: the machine waits at t_k until a command has come, instead of for the clock. One
/// command is one step and has one answer, the sensors of t_{k+1}. A command that is sent again
/// gets the same answer again. The run is that of simulation::ClosedLoop bit for bit.
///
/// Nothing here is sent to or accepted from beyond the loopback without a key. With a key every
/// packet ends with HMAC-SHA256 of a letter for its kind ('C' command, 'S' sensors) and its bytes.
/// The server draws a session number when it starts. Commands of another session and commands
/// whose sequence number does not grow are refused, so that no packet counts twice.
///
/// Which bytes a packet has is said by a Layout: that of hydrapod, or one read from a description.
///
/// [Linux] sockets, POSIX shared memory, SCHED_FIFO.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hydrapod/rig/rig.hpp"
#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::realtime {

using spatial::Pose;
using spatial::Vector6;

/// What a command asks for.
enum class Mode : std::uint8_t {
  hello = 0,   ///< nothing; the server answers with its session and the last sequence number
  pose = 1,    ///< displacement and rate for the closed loop; `drive` is added to its drives
  valves = 2,  ///< `drive` are those of valves or motors; the controller is the client's
  leave = 3    ///< the client ends: ramp down now
};

/// Of the server.
enum class State : std::uint8_t {
  waiting = 0,    ///< for a first command, at rest
  following = 1,  ///< the commands
  holding = 2,    ///< the last command, as no new one has come
  ramping = 3,    ///< down to the rest position
  parked = 4      ///< there
};
const char* name(State state);

inline constexpr std::uint64_t next_wrench_given = 1;  ///< bit of Command::flags

struct Command {
  std::uint64_t session{};   ///< of the server; 0 is accepted without a key
  std::uint64_t sequence{};  ///< grows with every command, from 1
  std::uint64_t time{};      ///< [ns], of the client's clock; comes back as `echo`
  std::uint64_t mode{static_cast<std::uint64_t>(Mode::pose)};
  std::uint64_t flags{};
  Vector6 displacement{Vector6::Zero()};  ///< of the demanded pose from the operating one [m, rad]
  Vector6 rate{Vector6::Zero()};          ///< its rate [m/s, rad/s]
  Vector6 drive{Vector6::Zero()};         ///< per leg, shares of rated current or largest speed
  Vector6 wrench{Vector6::Zero()};        ///< about the mass centre, base axes [N, N m]
  Vector6 next_wrench{Vector6::Zero()};   ///< of the next sample, see simulation::Excitation
};

/// Of the commands that came in, since the start of the server.
struct Counters {
  std::uint64_t accepted{};
  std::uint64_t superseded{};    ///< accepted, but a newer one came before the next sample
  std::uint64_t missed{};        ///< samples without a new command while a client was followed
  std::uint64_t lost{};          ///< sequence numbers that never came
  std::uint64_t reordered{};     ///< came after a newer one; not used
  std::uint64_t duplicated{};    ///< came again, or are too old to tell; not used
  std::uint64_t malformed{};     ///< size, constants, checksum, or a number that is not finite
  std::uint64_t refused{};       ///< no or a wrong key, another session, another client's
  std::uint64_t out_of_range{};  ///< a pose that the legs cannot reach; not used
  std::uint64_t trips{};         ///< ramps down by the watchdog
};

inline constexpr int most_accelerometers = 24;

struct Sensors {
  std::uint64_t session{};
  std::uint64_t sequence{};  ///< grows by one with every sample
  std::uint64_t time{};      ///< [ns] of the machine, 0 at its start
  std::uint64_t answered{};  ///< sequence number of the last accepted command
  std::uint64_t echo{};      ///< its `time`; of a hello: that of the hello
  std::uint64_t state{};
  std::uint64_t deadline_misses{};
  Counters counters{};
  Vector6 length{Vector6::Zero()};               ///< l as the controller measures it [m]
  Vector6 cap_pressure{Vector6::Zero()};         ///< [Pa]
  Vector6 rod_pressure{Vector6::Zero()};         ///< [Pa]
  Vector6 piston_acceleration{Vector6::Zero()};  ///< where the controller uses it, else 0 [m/s²]
  Vector6 valve{Vector6::Zero()};                ///< drives at the valves or motors, shares
  Vector6 spool{Vector6::Zero()};                ///< shares of the travel
  /// Of electric cylinders, true: torque until now [N m], speed [rad/s], way of the nut [m].
  Vector6 torque{Vector6::Zero()}, motor_speed{Vector6::Zero()}, nut{Vector6::Zero()};
  Vector6 platform{Vector6::Zero()};      ///< true displacement from the operating pose
  Vector6 velocity{Vector6::Zero()};      ///< of C, and ω [m/s, rad/s]
  Vector6 acceleration{Vector6::Zero()};  ///< of C, and ω̇ [m/s², rad/s²]
  double supply_pressure{};               ///< [Pa]
  std::array<double, most_accelerometers> accelerometer{};  ///< [m/s²]
};

enum class Kind { command, sensors };
enum class ValueType { u8, u16, u32, u64, i8, i16, i32, i64, f32, f64 };
std::size_t size_of(ValueType type);

/// What stands at one place of a packet.
struct Field {
  enum class Role { value, constant, ignored, crc32, crc16 };
  Role role{Role::value};
  int entry{-1};    ///< row of the table of names, of Role::value
  int component{};  ///< of that, from 0
  ValueType type{ValueType::f64};
  double factor{1.0};  ///< value in SI = factor · number in the packet + offset
  double offset{};
  std::uint64_t number{};  ///< of a constant; the extra byte + 1 of a crc16, 0: none
  std::size_t from{};      ///< first byte that a checksum covers
  std::size_t at{};        ///< its own first byte
};

struct PacketLayout {
  std::vector<Field> fields{};
  std::size_t size{};  ///< [bytes], without HMAC
  /// Whether `name` ("session") is one of the fields.
  [[nodiscard]] bool has(Kind kind, std::string_view name) const;
};

/// Which bytes packets have. crc32 is that of zlib (IEEE 802.3); crc16 that of MAVLink (MCRF4XX).
struct Layout {
  bool big_endian{};
  PacketLayout command{}, sensors{};
};

inline constexpr std::size_t largest_packet = 1400;  ///< [bytes], one Ethernet frame
inline constexpr std::size_t mac_size = 32;          ///< [bytes]

/// That of hydrapod, version 1. Numbers are little-endian, values double. Electric cylinders have
/// torque, speed and nut of the motors in place of both pressures and the spool.
Layout native_layout(int accelerometers, model::LegType legs = model::LegType::cylinder);
/// A description in TOML; `file` is its name in messages. Throws base::InputError with all that is
/// wrong.
Layout parse_layout(const std::string& text, const std::string& file);
Layout read_layout(const std::string& path);
/// The description that reads as `layout`, with the place of each field as a comment.
std::string layout_text(const Layout& layout);

/// Writes the packet to `out` (largest_packet bytes) and returns its size. Numbers beyond an
/// integer type become its limit.
std::size_t encode(const Layout& layout, const Command& command, std::byte* out);
std::size_t encode(const Layout& layout, const Sensors& sensors, std::byte* out);
/// False: not such a packet (size, constants, checksums); of commands also: not finite. What the
/// layout does not have keeps the value that it had.
bool decode(const Layout& layout, std::span<const std::byte> bytes, Command& command);
bool decode(const Layout& layout, std::span<const std::byte> bytes, Sensors& sensors);

/// The secret of client and server. None: packets are as they are.
struct Key {
  std::string bytes{};
  [[nodiscard]] bool given() const { return !bytes.empty(); }
};
/// The bytes of a file, 16 to 4096, that nobody but its owner can read. Throws base::InputError.
Key read_key(const std::string& path);
std::array<std::byte, mac_size> authentication(const Key& key, Kind kind,
                                               std::span<const std::byte> bytes);

/// "4747", "127.0.0.1:4747", "[::1]:4747". Throws base::InputError, which calls the text `place`.
struct Address {
  std::string host{"127.0.0.1"};
  std::string port{"4747"};
};
Address parse_address(const std::string& place, const std::string& text);

/// Shares of samples that took at most so long.
struct Timing {
  long samples{};
  double p50{}, p99{}, p99_9{}, p99_99{}, worst{};  ///< [s]; worst is exact, the others + 3 %
  struct Bin {
    double up_to{};  ///< [s]
    long samples{};
  };
  std::vector<Bin> bins{};  ///< those with samples
};

/// Linux takes the processor from programs with SCHED_FIFO that never sleep (95 % of a second).
inline constexpr double longest_busy = 0.9;

struct ServeOptions {
  Address address{};
  std::string bind{};           ///< another address to listen at; needs a key
  std::string shared_memory{};  ///< name; instead of UDP
  Layout layout{};              ///< no fields: native_layout
  Key key{};
  bool lock_step{};
  bool once{};                    ///< end when the first client has gone and the platform is parked
  double hold{0.1};               ///< [s] for which the last command is held
  double ramp{1.0};               ///< [s] of the ramp down
  double patience{10.0};          ///< [s] in lock-step, by the wall clock: then the client is gone
  Vector6 rest{Vector6::Zero()};  ///< the rest position, a displacement from the operating pose
  std::optional<int> fifo{};      ///< priority of SCHED_FIFO; none: as other programs
  /// For how long before each sample the thread waits without sleeping [s], so that the processor
  /// is awake and its caches are warm; at most longest_busy of the sample time.
  double busy{};
  std::vector<rig::Accelerometer> accelerometers{};
  /// Called once when clients can come, with the place where ("127.0.0.1:4747").
  std::function<void(const std::string& place)> ready{};
};

struct ServeResult {
  simulation::RunSummary run{};
  std::vector<std::string> warnings{};  ///< of the machine as it is served: it is not stable
  std::string place{};
  bool lock_step{};
  double sample_time{};  ///< [s]
  State state{};         ///< at the end
  Counters counters{};
  std::uint64_t sent{}, not_sent{};  ///< packets of sensors
  std::string scheduling{};          ///< "SCHED_FIFO 80" or "SCHED_OTHER", and why
  std::uint64_t misses{};            ///< samples that began when the next one was due
  std::uint64_t overruns{};          ///< steps not finished when the next sample was due
  std::uint64_t shifts{};            ///< the clock was set on after a standstill of more than 0.1 s
  Timing lateness{};                 ///< begin of a sample after its time: jitter
  Timing step{};                     ///< time of a step, without waiting
  Timing step_processor{};           ///< processor time of the thread in a step
  std::uint64_t rows_lost{};         ///< rows of the record that are NaN, as the disk was too slow
};

/// Columns of the record behind those of simulation::record_channels: accelerometers; command's age
/// [s]; state; lateness [s]; deadline misses so far.
std::vector<data::Channel> serve_channels(const simulation::ClosedLoop& loop,
                                          const ServeOptions& options);

/// Opens the record when there is something to record.
using OpenRecord = std::function<data::RecordWriter&()>;

/// Serves until the loop's `until`, `keep_going` or `once`; without `record` nothing is recorded.
/// Throws base::InputError where the address, the name or the layout cannot be used. A run that
/// fails has RunSummary::message.
ServeResult serve(simulation::ClosedLoop& loop, const ServeOptions& options,
                  const OpenRecord& record = {}, const simulation::KeepGoing& keep_going = {});

/// What a real machine must not do; each is watched in every sample. Violated in two samples
/// running, the excitation is ramped down.
struct Limits {
  double length{0.05};        ///< [m] of each leg from its length at the pose
  double velocity{0.5};       ///< [m/s] of each leg, measured, below 50 Hz
  double acceleration{20.0};  ///< [m/s²] of each leg, below 50 Hz, and of each accelerometer
  double error{0.01};         ///< [m] of each leg from the commanded length
};

struct HardwareOptions {
  Address address{};
  std::string shared_memory{};
  Layout layout{};  ///< no fields: native_layout
  Key key{};
  Limits limits{};
  double ramp{1.0};           ///< [s] in which the excitation grows, and ends
  double ramp_down{0.2};      ///< [s] in an emergency
  double watchdog{0.05};      ///< [s] without sensors
  double connect{3.0};        ///< [s] to wait for a first answer
  std::optional<int> fifo{};  ///< priority of SCHED_FIFO; none: as other programs
};

struct HardwareResult {
  rig::RigResult rig{};  ///< `summary`: end, message, time, samples
  std::uint64_t received{}, lost{}, late{}, malformed{}, refused{};  ///< packets of sensors
  std::uint64_t resent{};                                            ///< commands
  bool ramped_down{};                                                ///< by an emergency
  std::string scheduling{};                                          ///< as of ServeResult
  Sensors last{};
};

/// The rig's record from a real machine: the same channels, of accelerometers those of `options`.
/// `options.entry` wrench is refused. One command is sent in answer to every packet of sensors.
/// Throws base::InputError where there is no answer, or the platform is not at the pose.
HardwareResult run_on_hardware(const model::Machine& machine, const Pose& operating,
                               const rig::RigOptions& options, const HardwareOptions& hardware,
                               const OpenRecord& record,
                               const simulation::KeepGoing& keep_going = {});

}  // namespace hydrapod::realtime
