#pragma once
/// Commands and their options, declared as tables. The header of CLI11 costs more to compile than a
/// command does, so only options.cpp, main.cpp and those of the help include it.
///
///     command.add_options({
///         {"--points", arguments.points, "Frequencies", range(2, 100000)},
///         {"--linear", arguments.linear, "Spaced linearly"}});
///
/// An option of another type, or another word of CLI11, is one more line here and in options.cpp.

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace hydrapod::cli {

struct NamedFile;

/// What an option puts its text into; of a flag it is a bool. The variable must live as long as the
/// command. The help shows the value that it has now, unless that is empty or 0.
using OptionValue =
    std::variant<bool*, std::string*, std::vector<std::string>*, int*, std::uint64_t*, double*,
                 std::optional<int>*, std::optional<double>*>;

/// What the value of an option is to the command, see output_files.hpp.
enum class FileUse { none, input, output };

/// What else holds for an option.
struct OptionRule {
  bool required{};
  bool one_each{};          ///< of a list: one value each time it is given
  bool shows_zero{};        ///< as default in the help
  bool hidden{};            ///< not in the help: an earlier name of another option
  const char* type_name{};  ///< in the help, instead of TEXT, INT, …
  FileUse file{};
  /// Both ends are allowed.
  std::variant<std::monostate, std::pair<int, int>, std::pair<double, double>,
               std::pair<std::uint64_t, std::uint64_t>>
      range{};
};

inline constexpr OptionRule required{.required = true};
inline constexpr OptionRule one_each{.one_each = true};
inline constexpr OptionRule hidden{.hidden = true};
/// A file that is read, or a text that may name one.
inline constexpr OptionRule reads{.file = FileUse::input};
inline constexpr OptionRule reads_required{.required = true, .file = FileUse::input};
/// A file that is written; the command gets --force.
inline constexpr OptionRule writes{.file = FileUse::output};

constexpr OptionRule shown_as(const char* type_name) { return {.type_name = type_name}; }
constexpr OptionRule one_each_as(const char* type_name) {
  return {.one_each = true, .type_name = type_name};
}
constexpr OptionRule reads_each_as(const char* type_name) {
  return {.one_each = true, .type_name = type_name, .file = FileUse::input};
}
template <class Number>
constexpr OptionRule range(Number least, Number most) {
  return {.range = std::pair(least, most)};
}

struct OptionRow {
  template <class Value>
  OptionRow(std::string option_names, Value& option_value, const char* text, OptionRule more = {})
      : names(std::move(option_names)), value(&option_value), description(text), rule(more) {}

  std::string names;  ///< "--points", "-o,--output", or "FILE" for an argument without a name
  OptionValue value;
  const char* description;
  OptionRule rule;
};

/// One line of the examples below the help of a command.
struct Example {
  std::string arguments{};  ///< without the program's name: `modes machine.toml --pose up`
  std::string purpose{};    ///< what it does, in a few words
};

/// A handle to a command, or to the program, of which the commands are a part.
class Command {
 public:
  explicit Command(CLI::App* app);

  void add_options(std::initializer_list<OptionRow> rows);

  /// --force, for files whose names follow from several options; `files` is asked for them when the
  /// command line was understood. `force`: whether it was given.
  void also_writes(std::function<std::vector<NamedFile>()> files, bool* force = nullptr);

  /// --brief and --all of a command that prints tables: see Extent.
  void add_extent_options();

  /// A subcommand whose help ends with `examples`, and `after` behind them.
  Command add_command(const std::string& name, const std::string& description,
                      const std::vector<Example>& examples, const std::string& after = {});
  void require_subcommand(int count);

  /// When the command was called and understood, `run` gets what this returns, filled in.
  template <class Arguments>
  Arguments& calls(void (*run)(const Arguments&)) {
    auto arguments = std::make_shared<Arguments>();
    callback([arguments, run, files = files_] {
      check_files(*files);
      run(*arguments);
    });
    return *arguments;
  }

 private:
  struct Files;
  void callback(std::function<void()> run);
  void add_force();
  static void check_files(const Files& files);

  CLI::App* app_;
  std::shared_ptr<Files> files_;
};

}  // namespace hydrapod::cli
