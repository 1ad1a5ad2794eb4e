#pragma once
/// Man pages and the completion of the shell, from the definitions of the commands.

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace hydrapod::cli {

/// `hydrapod-record-show`
std::string page_name(const CLI::App& command);

/// The man page of one command, in the macros of man(7), UTF-8.
std::string man_page(const CLI::App& command);

/// A script for bash: commands, options and, where neither fits, files.
std::string bash_completion(const CLI::App& app);

}  // namespace hydrapod::cli
