#pragma once
/// The machine that the studio works on: its file as read, the values changed since, and the way
/// back into the file.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hydrapod/tasks/machine.hpp"

namespace hydrapod::studio {

struct MachineChoice {
  std::string file{};  ///< absolute path
  bool is_new{};       ///< the file is a start that has no place of the user's yet
  std::vector<std::string> overrides{};  ///< of the command line
  std::vector<std::string> poses{"neutral"};
  std::optional<dynamics::ModelKind> model{};
};

/// A value that saving would write.
struct PlannedEdit {
  std::string path{}, value{};
};

class OpenMachine {
 public:
  /// Reads the file. Throws base::InputError.
  explicit OpenMachine(MachineChoice choice);

  [[nodiscard]] const std::string& file() const { return choice_.file; }
  [[nodiscard]] bool is_new() const { return choice_.is_new; }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::size_t poses() const { return choice_.poses.size(); }
  [[nodiscard]] const std::string& pose(std::size_t index) const { return choice_.poses.at(index); }

  /// `--set` of the command line, then those of the pages.
  [[nodiscard]] std::vector<std::string> overrides() const;
  [[nodiscard]] bool is_changed() const { return !overrides().empty(); }
  /// What the pages changed, as they say it: [[path, value], …].
  [[nodiscard]] const report::Json& values() const { return values_; }

  /// Lays `assignments` over the file instead of those before. Throws base::InputError and changes
  /// nothing where no machine has these values.
  void change(report::Json values, std::vector<std::string> assignments);

  /// As tasks take it; `pages`: with what the pages changed.
  [[nodiscard]] tasks::Machine machine(std::size_t pose, bool pages) const;
  /// The model asked for, "" for none.
  [[nodiscard]] std::string model_word() const;

  /// What the file on the disk says now differs from what was read.
  [[nodiscard]] bool differs_on_disk() const;
  /// Reads the file anew; the pages' values go. Throws base::InputError and changes nothing where
  /// it is no machine.
  void reload();

  [[nodiscard]] std::vector<PlannedEdit> edits() const;
  /// Writes the values into the file, comments and units kept, or into `path` where that is not
  /// empty, which then is the machine's file. Throws base::InputError where the file has changed on
  /// the disk since it was read, or where `path` exists and `replace` is not set.
  void save(const std::string& path, bool replace);

 private:
  [[nodiscard]] std::string edited_text() const;

  MachineChoice choice_;
  std::string text_;
  report::Json values_ = report::Json::array();
  std::vector<std::string> assignments_{};
};

/// Throws base::InputError where a file exists at `path` and `replace` is not set. The page knows
/// this refusal by its words, which begin with `exists_words`.
inline constexpr const char* exists_words = "a file exists there";
void refuse_existing(const std::string& path, bool replace);

}  // namespace hydrapod::studio
