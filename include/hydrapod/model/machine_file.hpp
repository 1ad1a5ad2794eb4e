#pragma once
/// The machine file: TOML in, a Machine out, every mistake with file:line:column.
///
/// The keys are listed with units and defaults in docs/howto/machine-file.md. Quantities are
/// numbers in SI or strings with a unit ("700 MPa"); see base/units.hpp.
///
/// A machine file whose numbers can be varied: what calibration and sensitivities work on.
///
/// A number is addressed by its path in the file (`legs.rod.mass`, `leg.3.oil_spring.stiffness`,
/// `platform.mass_center[2]`), so that whatever a file can say can be varied, with the file's own
/// rules for what legs share. Optional numbers that the file leaves out have their default and can
/// be varied too, and what all legs share can be varied for one of them.
///
/// No text is read: the machine takes the values by assignments (parameters.hpp).
///
/// A machine file's text with some values changed and everything else, comments included, as it
/// was.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine.hpp"
#include "hydrapod/model/parameters.hpp"
#include "hydrapod/model/validation.hpp"

namespace hydrapod::model {

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

/// A number of a machine file.
struct FileNumber {
  std::string path{};
  std::string unit{};  ///< SI: "kg", "N/m"; "1" for pure numbers
  double value{};      ///< [unit]
  bool given{};        ///< false: not in the file, `value` is the default
  unsigned line{};     ///< where it stands; 0 when it comes from an override
};

/// Several paths that hold one and the same value: a parameter, with its ties.
using TiedPaths = std::vector<std::string>;

class VariableMachine {
 public:
  /// Of `file.machine`, which need not be what the text of the file says.
  explicit VariableMachine(const MachineFile& file);
  ~VariableMachine();
  VariableMachine(VariableMachine&&) noexcept;
  VariableMachine& operator=(VariableMachine&&) noexcept;

  /// Every number that was read, in the order of the file, then defaults, then what single legs
  /// share with all.
  [[nodiscard]] const std::vector<FileNumber>& numbers() const;
  /// The number at `path`; null when there is none.
  [[nodiscard]] const FileNumber* find(const std::string& path) const;
  /// Its id. Throws std::bad_optional_access where find() knows none.
  [[nodiscard]] ParameterId id(const std::string& path) const;
  /// The path most like `path`; empty when none is near.
  [[nodiscard]] std::string nearest_path(const std::string& path) const;

  /// Says which numbers machine(…) varies; the tied ones get the same value. Throws
  /// std::invalid_argument for a path that find() does not know, or one that stands in two
  /// parameters.
  void vary(const std::vector<TiedPaths>& parameters);
  /// Values of the parameters in the file, of the first path of each [SI].
  [[nodiscard]] const std::vector<double>& values() const;
  /// Does the parameter change anything that moves, bends or weighs?
  [[nodiscard]] bool matters(std::size_t parameter) const;

  /// The machine with the parameters at `values`, not validated.
  [[nodiscard]] Machine machine(const std::vector<double>& values) const;
  /// The same into `machine`, which an earlier call with these parameters has made.
  void machine(const std::vector<double>& values, Machine& machine) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

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
