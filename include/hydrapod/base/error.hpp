#pragma once
/// What goes wrong, and how it is said.
///
/// A caller's mistake throws std::invalid_argument and names parameter, value and limit. A mistake
/// in a file or on the command line is an InputError: it carries every diagnostic found in one go.
/// A computation that cannot give a result is a ComputationError. Non-convergence that a caller can
/// act on is a status in a result, not an exception.

#include <stdexcept>
#include <string>
#include <vector>

namespace hydrapod::base {

enum class Severity { error, warning };

/// One finding about an input. `line` and `column` count from 1; 0 means "not in a file", and
/// `file` then says where the value came from (for instance `--set platform.mass=-3`).
struct Diagnostic {
  Severity severity{Severity::error};
  std::string file{};
  unsigned line{};
  unsigned column{};
  std::string key{};      ///< dotted path in the file, for instance `legs.rod.length`
  std::string message{};  ///< what was found and what would be accepted

  /// `file:line:column: error: key: message`
  [[nodiscard]] std::string text() const;
};

/// A bad file or argument: exit code 2 on the command line.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Diagnostic> diagnostics);
  [[nodiscard]] const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// Throws an InputError of one finding; `where`: the file, or the argument as it was written.
[[noreturn]] void refuse(const std::string& where, const std::string& message);

/// The input was fine and the computation failed: exit code 1 on the command line.
class ComputationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace hydrapod::base
