#pragma once
/// The machine file: TOML in, a Machine out, every mistake with file:line:column.
///
/// The keys are listed with units and defaults in docs/howto/machine-file.md. Quantities are
/// numbers in SI or strings with a unit ("700 MPa"); see base/units.hpp.

#include <functional>
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

}  // namespace hydrapod::model
