#pragma once
/// A machine file whose numbers can be varied: what calibration and sensitivities work on.
///
/// A number is addressed by its path in the file (`legs.rod.mass`, `leg.3.oil_spring.stiffness`,
/// `platform.mass_center[2]`), so that whatever a file can say can be varied, with the file's own
/// rules for what legs share. Optional numbers that the file leaves out have their default and can
/// be varied too, and what all legs share can be varied for one of them.
///
/// No text is read: the machine takes the values by assignments (parameters.hpp).

#include <memory>
#include <string>
#include <vector>

#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::model {

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

}  // namespace hydrapod::model
