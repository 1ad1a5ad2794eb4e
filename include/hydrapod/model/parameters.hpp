#pragma once
/// The one table of the machine file's keys, and the numbers of a machine addressed by it.
///
/// A row says what a key holds: path, unit, default, bound, meaning, and the member of the machine.
/// Reading, advice on unknown keys, range checks, the starter file, the tables of
/// docs/howto/machine-file.md, `--set` and free parameters all go by these rows. A new parameter is
/// a member of the structs in machine.hpp and one row in src/model/*_rows.cpp.
///
/// A ParameterId is one number: a row, an element of it, and the legs that it sets. Text becomes an
/// id once, where a file or a person is met; a machine takes values for ids without reading text.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/model/machine.hpp"

namespace hydrapod::model {

struct MachineFile;

/// What a key holds.
enum class Kind {
  table,   ///< further keys
  number,  ///< `numbers` of them: one, or an array
  six,     ///< one number for all six, or an array of six
  word,    ///< one of `words`
  text,    ///< a string
  tensor,  ///< { xx, yy, zz, xy, xz, yz }, or three rows of three numbers
  points,  ///< six points, one for each leg
  rows     ///< any number of rows of numbers
};

/// The values that a number may have. Every number must be finite as well.
struct Bound {
  double lowest{-std::numeric_limits<double>::infinity()};
  double highest{std::numeric_limits<double>::infinity()};
  bool more_than_lowest{};
  bool less_than_highest{};
  std::string_view expected{};  ///< instead of "more than 0", "no more than 2"
  std::string_view shown_in{};  ///< instead of the unit: "deg"
  double shown_size{1.0};       ///< of that in SI
  double usual_least{};         ///< magnitude, with usual_most; zero is always usual
  double usual_most{};          ///< 0: what is usual for the unit
};

struct ParameterRow {
  /// `legs.rod.mass`; `leg.*.base_joint` is of single legs only, `poses.*.position` of every pose.
  std::string_view path{};
  std::string_view unit{};  ///< SI; "1" for pure numbers
  Kind kind{Kind::number};
  bool required{};
  /// What holds where an optional number is left out; empty: what the struct has as its default.
  std::string_view otherwise{};
  Bound bound{};
  std::string_view meaning{};
  /// A value for the starter file, as TOML; empty: the default.
  std::string_view example{};
  bool in_use{};               ///< the starter file gives it; else it stands there as a comment
  std::string_view heading{};  ///< of a table: lines of the starter file above it
  bool mechanics{true};        ///< it, or what a table holds, enters the linear mechanical models
  bool alone{};                ///< in a sound machine, any number within the bound is sound
  bool in_code{};              ///< read and checked by code of its own: joints, gravity, poses
  /// Paths of numbers of which one must be above 0, or the number has no effect.
  std::array<std::string_view, 2> used_with{};
  std::span<const std::string_view> words{};

  int numbers{1};
  bool optional{};  ///< the member itself may be left out
  /// The number in leg or pose `index`; null where the part that would hold it is left out.
  double* (*find)(Machine&, int index, int element){};
  /// The same, with the part made where it is left out.
  double* (*make)(Machine&, int index, int element){};
  /// For numbers that are not stored as they are.
  double (*get)(const Machine&, int index, int element){};
  void (*set)(Machine&, int index, int element, double value){};
  /// What follows from numbers that have been set, in the legs of the mask.
  void (*finish)(Machine&, unsigned legs){};
  /// Its unit where it depends on a word of the machine.
  std::string_view (*other_unit)(const Machine&, std::string_view unit){};
  /// Takes away what says the same thing in another way.
  void (*instead)(Machine&, int index){};
  int (*word)(const Machine&, int index){};
  void (*set_word)(Machine&, int index, int word){};
};

/// Its unit in `machine`.
std::string_view unit_of(const Machine& machine, const ParameterRow& row);

/// "mass" of "legs.rod.mass", and "legs.rod".
std::string_view last_key(std::string_view path);
std::string_view table_of(std::string_view path);

/// Before the paths of what all legs have.
inline constexpr std::string_view of_legs = "legs.";

/// May a leg of that type have the key or table at `path` ("legs.rod.mass", "legs.rod")? Other
/// paths than those of legs belong to every machine.
bool belongs_to(LegType type, std::string_view path);

/// "hydraulic cylinder", "plain strut", "electric cylinder".
std::string_view name(LegType type);

/// What is compliant along such a leg: "oil", "struts", "screws".
std::string_view axial_part(LegType type);

/// All rows, each table followed by its keys.
std::span<const ParameterRow> parameter_table();

/// Two keys of a table that say the same thing; a machine has one of them.
struct Alternatives {
  std::string_view table{};
  std::string_view first{};
  std::string_view second{};
};
std::span<const Alternatives> alternatives();

/// An element that stands for all six numbers of a row, or for the magnitude of gravity.
inline constexpr int whole = -1;

/// The numbers that an id can stand for: a machine's own, those of all legs, of a leg, of a pose,
/// of a mode of the payload.
struct ParameterId {
  std::uint16_t row{};     ///< of parameter_table()
  std::int16_t element{};  ///< of an array, of a tensor (xx, yy, zz, xy, xz, yz); 0 or `whole`
  std::int16_t of{};       ///< leg 1…6, or 0 for all legs; 1 + number of the pose or payload mode
  std::uint16_t legs{0x3F};  ///< those that it sets, a bit each

  friend bool operator==(const ParameterId& a, const ParameterId& b) {
    return a.row == b.row && a.element == b.element && a.of == b.of;
  }
};

/// The pose of that name; null where the machine has none.
const NamedPose* find_pose(const Machine& machine, std::string_view name);

/// How the mode number `index` of the payload is called where assign() makes it: "mode_1", …. A
/// machine has names of its own; this one is of those that it does not have yet.
std::string next_payload_mode(const Machine& machine, int index);

/// A value [SI] for a parameter.
struct Assignment {
  ParameterId id{};
  double value{};
};

/// A number that stands in a machine file.
struct GivenNumber {
  ParameterId id{};
  double value{};         ///< [SI]
  unsigned line{};        ///< 0: in an override
  std::string written{};  ///< its path there, which for a tensor in rows is not that of the id
};

/// The number at `path` of a machine: "platform.mass_center[2]", "legs.rod.mass",
/// "leg.3.rod.mass", "platform.inertia.xy", "poses.neutral.position[2]",
/// "payload_modes.cabin.frequency". Whether the machine holds it is for value() to say: a mode that
/// it lacks may be named by next_payload_mode(). Nothing where no machine can have such a number.
std::optional<ParameterId> find_parameter(const Machine& machine, std::string_view path);

/// The same in a file: "legs.rod.mass" is then of those legs that have no value of their own.
/// Nothing where all of them have.
std::optional<ParameterId> find_parameter(const MachineFile& file, std::string_view path);

/// The number in a file: one of all legs is then of those that have no value of their own. Nothing
/// where all of them have.
std::optional<ParameterId> in_file(const MachineFile& file, ParameterId id);

/// The path in `file` most like `path`; empty where none is near.
std::string nearest_parameter(const MachineFile& file, std::string_view path);

const ParameterRow& row_of(const ParameterId& id);
std::string path(const Machine& machine, const ParameterId& id);
std::string_view unit(const Machine& machine, const ParameterId& id);
/// Does it enter the linear models of the mechanism? With has_chambers() leakage, valves,
/// friction along the legs and supply do too; with seals that know the pressure, what the pressures
/// at rest follow from.
bool of_mechanics(const Machine& machine, const ParameterId& id);

/// Its value [SI], in the first of its legs; nothing where the machine does not hold it.
std::optional<double> value(const Machine& machine, const ParameterId& id);

/// Every number that the machine holds: its own, those of all legs, those of single legs, poses.
std::vector<ParameterId> parameters(const Machine& machine);

/// Sets the numbers in `machine`; what stands for single legs counts before what stands for all.
/// Parts that a number belongs to are made (a piston ring, a mount, modes of the payload), and an
/// alternative to it is
/// taken away. Nothing is validated, no text is read.
void assign(Machine& machine, std::span<const Assignment> assignments);
Machine with(Machine machine, std::span<const Assignment> assignments);

/// The tables of docs/howto/machine-file.md, in Markdown.
std::string parameter_reference();

}  // namespace hydrapod::model
