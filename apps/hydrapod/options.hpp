#pragma once
/// Commands and their options, in the words of CLI11. Its header costs more to compile than a
/// command does, so only options.cpp and main.cpp include it.
///
///   command.add_option("--points", arguments.points, "Frequencies").range(2, 100000);
///
/// An option of another type, or another word of CLI11, is one more line here and in options.cpp.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace hydrapod::cli {

/// A handle to an option; what is called on it says more about the option.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  Option capture_default_str();  ///< the help shows the value that the variable has now
  Option type_name(const std::string& name);  ///< in the help, instead of TEXT, INT, …
  Option allow_extra_args(bool allow);        ///< of a list; false: one value each time it is given
  Option range(int least, int most);          ///< both are allowed
  Option range(double least, double most);
  Option range(std::uint64_t least, std::uint64_t most);

 private:
  CLI::Option* option_;
};

/// A handle to a command, or to the program, of which the commands are a part.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  /// `names`: "--points", "-o,--output", or "FILE" for an argument without a name. What is given
  /// on the command line is put into `value`, which must live until then.
  Option add_option(const std::string& names, std::string& value, const std::string& description);
  Option add_option(const std::string& names, std::vector<std::string>& value,
                    const std::string& description);
  Option add_option(const std::string& names, int& value, const std::string& description);
  Option add_option(const std::string& names, std::uint64_t& value, const std::string& description);
  Option add_option(const std::string& names, double& value, const std::string& description);
  Option add_option(const std::string& names, std::optional<int>& value,
                    const std::string& description);
  Option add_option(const std::string& names, std::optional<double>& value,
                    const std::string& description);
  void add_flag(const std::string& names, bool& value, const std::string& description);

  Command add_subcommand(const std::string& name, const std::string& description);
  void require_subcommand(int count);
  void footer(const std::string& text);  ///< what stands below the help
  std::string get_footer() const;
  void callback(std::function<void()> run);  ///< when the command was called and understood

 private:
  CLI::App* app_;
};

}  // namespace hydrapod::cli
