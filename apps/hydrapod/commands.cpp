#include "hydrapod/commands.hpp"

#include <string_view>

namespace hydrapod::cli {

namespace {
std::vector<std::string> line;
}  // namespace

const std::vector<std::string>& command_line() { return line; }

void set_command_line(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "-o" || argument == "--output")
      ++i;
    else if (!argument.starts_with("-o") && !argument.starts_with("--output="))
      line.emplace_back(argument);
  }
}

}  // namespace hydrapod::cli
