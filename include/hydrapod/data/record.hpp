#pragma once
/// A record: what a test rig measured, as channels sampled together.
///
/// All channels share one sample rate and one start; sample k was taken at start + k / sample_rate.
/// Samples are in SI and radians: a channel's unit is a coherent SI unit ("m", "rad/s^2", "Pa",
/// "A"; "1" for pure numbers). Only a unit that the unit database does not know ("EU") or that
/// is no plain scale ("degC") stands as the file has it, and so do the samples then. A sample that
/// is missing (drop-out) is NaN.
///
/// Records are meant to stream: record_io.hpp reads and writes them in blocks. `Record` is for
/// those that fit into memory.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::data {

/// What a channel is in the experiment.
enum class Role {
  excitation,  ///< what is demanded of the machine: the signal that was planned
  drive,       ///< what the machine is driven with: valve current, command after the controller
  response,    ///< what was measured
  other
};

/// Along or about which axis of the base frame, or of which leg. The numbers −6 … 6 are the
/// direction codes of Universal Files; a negative one is a sensor mounted the other way round.
enum class Direction : std::int8_t {
  minus_rz = -6,
  minus_ry,
  minus_rx,
  minus_z,
  minus_y,
  minus_x,
  none = 0,
  x,
  y,
  z,
  rx,
  ry,
  rz,
  leg1 = 11,
  leg2,
  leg3,
  leg4,
  leg5,
  leg6
};

/// "x", "-rz", "leg 3"; empty for none.
std::string_view direction_text(Direction direction);
std::optional<Direction> direction_from_text(std::string_view text);
/// The direction of leg 1 … 6.
Direction leg_direction(int number);

/// "excitation", "drive", "response", "other".
std::string_view role_text(Role role);
std::optional<Role> role_from_text(std::string_view text);

struct Channel {
  std::string name{};     ///< unique in its record, one line of UTF-8
  std::string unit{"1"};  ///< coherent SI, see above; empty: unknown
  Direction direction{Direction::none};
  Role role{Role::other};
  int point{};           ///< number of the measuring point (node); 0: none
  std::string entity{};  ///< the part that the point belongs to; empty: none or not known
  /// What a Universal File of another program says of the channel, up to five lines.
  std::vector<std::string> id_lines{};
};

/// A measuring point whose place is known.
struct Node {
  int number{};
  Eigen::Vector3d position{};  ///< [m]
  /// Numbers of coordinate systems, of position and of motion, and a colour, as a Universal File
  /// has them.
  int position_system{}, motion_system{}, color{};
};

/// A picture of the structure: straight lines from node to node. 0 lifts the pen.
struct TraceLine {
  std::string name{};
  std::vector<int> nodes{};
  int color{};
};

/// The measuring points of a structure and how to draw it.
struct Geometry {
  std::vector<Node> nodes{};
  std::vector<TraceLine> lines{};
  [[nodiscard]] bool empty() const { return nodes.empty() && lines.empty(); }
};

/// An accelerometer or another sensor along one axis, where its place is known.
struct PlacedSensor {
  std::string name{};          ///< of its channel
  Eigen::Vector3d position{};  ///< in the platform frame [m]
  Eigen::Vector3d axis{};      ///< in the platform frame, unit vector
};

struct ExcitationNote {
  std::string entry{};                 ///< "command", "drive" or "wrench"
  std::vector<std::string> signals{};  ///< as text, one each
  std::optional<double> period{};      ///< [s]; none: does not repeat
  /// In x … rz, in the units of the entry: the root of the sum of the squared sizes of the signals.
  /// A size is an RMS value for noise, sequences and multisines, an amplitude for sine, sweep and
  /// chirp unless their RMS value was asked for, and the final value of a step.
  std::array<double, 6> level{};
};

/// How a record was made, as far as that is known.
struct Experiment {
  std::string program{};                        ///< that wrote it, "hydrapod 0.9"
  std::vector<std::string> command{};           ///< its arguments
  std::string machine{};                        ///< text of the machine file (TOML)
  std::vector<std::string> overrides{};         ///< of the machine file, "platform.mass=3 t"
  std::string pose_name{};                      ///< a pose of the machine file, or "z=10 mm"
  std::optional<std::array<double, 6>> pose{};  ///< x y z [m], rx ry rz [rad]; R = Rz Ry Rx
  std::string model{};                          ///< "rigid", "guide" or "full"
  std::optional<ExcitationNote>
      excitation{};          ///< given: by a test rig, machine under its controller
  std::string controller{};  ///< its settings
  std::vector<PlacedSensor> sensors{};
  std::optional<std::uint64_t> seed{};  ///< of the random numbers
  std::string others{};  ///< JSON object of what other programs noted; kept; empty: nothing
};

struct RecordHeader {
  std::string title{};
  std::vector<Channel> channels{};
  double sample_rate{};  ///< [Hz] > 0
  double start{};        ///< [s] time of the first sample on the experiment's own clock
  std::string date{};    ///< when it was recorded, ISO 8601 ("2026-11-20T09:00:00"); empty: unknown
  int repeat{1};         ///< number of this repetition of the experiment, from 1
  std::string notes{};   ///< any text, may have several lines
  Experiment experiment{};
  Geometry geometry{};
};

/// Samples of a record or a piece of one: one row per sample, one column per channel, stored row by
/// row.
using Samples = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Record {
  RecordHeader header{};
  Samples samples{};
};

/// Throws std::invalid_argument naming field, value and what would be accepted: no channel, names
/// that are empty or not unique, a unit that is a known scale but not coherent SI, a sample rate
/// that is not positive, a repeat below 1, text that is not UTF-8.
void validate(const RecordHeader& header);

/// The members of `experiment` that are known, but for the machine file, as a JSON object in one
/// line; empty where nothing is known. docs/howto/record.md lists them.
std::string experiment_json(const Experiment& experiment);
/// Reads that back; where `json` is empty, what records of hydrapod without it say in their notes.
/// Members that it does not know go to `others`. Throws std::invalid_argument naming what is wrong.
Experiment read_experiment(const std::string& json, const std::string& notes);

/// Nodes and lines as a JSON object in one line; empty where there are none.
std::string geometry_json(const Geometry& geometry);
/// Reads that back. Throws std::invalid_argument naming what is wrong.
Geometry read_geometry(const std::string& json);

/// The channel of that name, if there is one.
std::optional<std::size_t> find_channel(const RecordHeader& header, std::string_view name);
/// The channel with that role and direction, if there is exactly one.
std::optional<std::size_t> find_channel(const RecordHeader& header, Role role, Direction direction);

}  // namespace hydrapod::data
