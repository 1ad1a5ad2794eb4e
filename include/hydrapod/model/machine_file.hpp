#pragma once
/// The machine file: TOML in, a Machine out, every mistake with file:line:column.
///
/// The keys are listed with units and defaults in docs/howto/machine-file.md. Quantities are
/// numbers in SI or strings with a unit ("700 MPa"); see base/units.hpp.
///
/// What a description must satisfy to be a machine, whichever way it was made.
///
/// A machine file's text with some values changed and everything else, comments included, as it
/// was.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine.hpp"
#include "hydrapod/model/parameters.hpp"

namespace hydrapod::model {

/// One finding; `key` is the path in a machine file (`legs.rod.length`, `leg.3.rod.length`), so
/// that whoever read the file can add line and column.
struct Finding {
  base::Severity severity{base::Severity::error};
  std::string key{};
  std::string message{};
  bool unusual{};  ///< of unusual_numbers()
};

/// Everything that is wrong with the numbers of `machine` themselves: signs, ranges, values that
/// are not finite, an inertia tensor that no body can have, two joints in one place, an oil spring
/// with both or neither description, a guide sleeve or piston that cannot be where it is said to
/// be. What depends on a pose (leg lengths, strokes, singularity) is kinematics::check_machine. All
/// findings at once; empty when the machine is sound. Never throws.
std::vector<Finding> validate(const Machine& machine);

/// Whether every value within_bound() of that number leaves a sound machine sound: the machine has
/// the number, and validate() relates it to no other one.
bool stands_alone(const Machine& machine, const ParameterId& id);
/// Whether the value is finite and within the bound of its row.
bool within_bound(const Assignment& assignment);

/// Numbers that a machine may have and that none is known to have, as warnings: beyond what is
/// usual by their rows (Bound::usual_most) or for their unit; a platform that weighs less than a
/// twentieth of its legs; one whose inertia and mass do not go together. With a guess where another
/// unit makes the number usual: "is 1050 m, …; did you mean 1050 mm?". Never throws for a machine
/// of finite numbers.
struct UnusualNumbers {
  std::vector<Finding> findings{};
  Machine guessed{};  ///< with the numbers that were probably meant
};
UnusualNumbers unusual_numbers(const Machine& machine);

/// Judges a machine that could be read; the findings get the place in the file where `key` stands.
using Check = std::function<std::vector<Finding>(const Machine&)>;

/// A machine that is sound, with what was noticed on the way.
struct MachineFile {
  Machine machine{};
  std::vector<base::Diagnostic> warnings{};
  std::vector<GivenNumber> given{};      ///< in the order of the file, then of the overrides
  std::string text{};                    ///< the file as read
  std::vector<std::string> overrides{};  ///< `PATH=VALUE`, as given
};

/// Reads and checks the file at `path` (`-`: standard input), with `overrides` of the form
/// `PATH=VALUE` laid over it before checking, for instance `legs.guide_sleeve.stiffness=2e6 N/m`.
/// Throws base::InputError with all mistakes of the file and the overrides together.
MachineFile read_machine_file(const std::string& path,
                              const std::vector<std::string>& overrides = {},
                              const Check& check = validate);

/// The same from text; `file_name` is what messages call it.
MachineFile parse_machine(const std::string& text, const std::string& file_name,
                          const std::vector<std::string>& overrides = {},
                          const Check& check = validate);

/// A commented machine file to start from; it is sound and describes a plausible motion platform.
std::string starter_machine_file();

/// A number of a machine file: one that it gives, one that has its default, or one of a single leg
/// that shares it with all.
struct FileNumber {
  std::string path{};
  std::string unit{};  ///< SI: "kg", "N/m"; "1" for pure numbers
  double value{};      ///< [unit]
  ParameterId id{};
};

/// The number of `id` in `file.machine`, which need not be what the text of the file says; nothing
/// where the machine does not hold it.
std::optional<FileNumber> number_of(const MachineFile& file, const ParameterId& id);

/// The number at `path`, likewise.
std::optional<FileNumber> find_number(const MachineFile& file, std::string_view path);

/// A value to put at `path`, as TOML ("7.2", "\"7.2 kg\"", "[0, 0, 1]").
struct FileEdit {
  std::string path{};
  std::string value{};
  std::string remark{};  ///< goes to the comment at the end of the line; may be empty
  bool taken_out{};      ///< its lines become comments instead; `value` is of no use
};

/// What laying `overrides` (PATH=VALUE) over the file changes in it, value by value: a table that
/// an override gives is compared key by key, and what it or the other way of saying the same thing
/// (a cylinder instead of a stiffness) leaves out is taken out. Throws base::ComputationError for
/// overrides that cannot be laid over this file.
std::vector<FileEdit> edits_of_overrides(const std::string& text,
                                         const std::vector<std::string>& overrides);

/// `text` with the edits made, one after the other. A path that is not there is added to its
/// table, and one that is taken out stays as a comment where it has lines of its own. Remarks of
/// one line are joined after "`label`: "; such a comment of an earlier run is replaced. Throws
/// base::ComputationError when the place of a path cannot be edited (a whole table).
std::string edited_file(const std::string& text, const std::vector<FileEdit>& edits,
                        const std::string& label);

/// The unit written at `path` with its size in SI ("mm", 1e-3); empty with 1 where a plain number
/// or nothing stands.
struct WrittenUnit {
  std::string name{};
  double size{1.0};
};
WrittenUnit written_unit(const std::string& text, const std::string& path, const std::string& si);

/// `value` [SI] as TOML in that unit: `"35.2 kg"`, or a plain number. `digits`: significant ones.
std::string written(double value, const WrittenUnit& unit, int digits);

}  // namespace hydrapod::model
