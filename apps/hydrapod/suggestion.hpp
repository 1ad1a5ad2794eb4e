#pragma once
/// "Did you mean …?"

#include <CLI/CLI.hpp>
#include <string>

namespace hydrapod::cli {

/// What to say about an argument that `command` does not take: an unknown option, an unknown
/// subcommand or one argument too many, with the nearest name there is.
std::string unknown_argument(const CLI::App& command, const std::string& argument);

}  // namespace hydrapod::cli
