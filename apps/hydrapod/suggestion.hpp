#pragma once
/// "Did you mean …?"

#include <string>
#include <vector>

namespace hydrapod::cli {

/// What a command takes.
struct Choices {
  std::string call{};                   ///< how it was called: `hydrapod record show`
  std::vector<std::string> commands{};  ///< its subcommands
  std::vector<std::string> options{};   ///< `--format`
};

/// What to say about an argument that a command does not take: an unknown option, an unknown
/// subcommand or one argument too many, with the nearest name there is.
std::string unknown_argument(const Choices& choices, const std::string& argument);

}  // namespace hydrapod::cli
