#pragma once
/// `hydrapod help`: the help of a command, man pages, and completion for the shell. All three come
/// from the definitions of the commands.

#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace hydrapod::cli {

/// The commands below `command`, also those that were not called.
std::vector<const CLI::App*> commands_of(const CLI::App& command);

/// `hydrapod modes`, the words that call `command`.
std::string call_of(const CLI::App& command);

/// What to say about an argument that `command` does not take: an unknown option, an unknown
/// subcommand or one argument too many, with the nearest name there is.
std::string unknown_argument(const CLI::App& command, const std::string& argument);

/// Lists `help` among the commands of `app`. Its words are read by `help`: CLI11 would take
/// "modes" in "help modes" for a call of modes.
void add_help(CLI::App& app);

/// Does what `words`, behind "help", ask for. A wrong word is a base::InputError.
void help(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace hydrapod::cli
