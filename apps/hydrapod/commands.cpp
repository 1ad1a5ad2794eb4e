#include "hydrapod/commands.hpp"

#include <string_view>

namespace hydrapod::cli {

namespace {
std::vector<std::string> line, whole;
}  // namespace

const std::vector<std::string>& command_line() { return line; }
const std::vector<std::string>& whole_command_line() { return whole; }

void set_command_line(int argc, const char* const* argv) {
  if (argc > 1) whole.assign(argv + 1, argv + argc);
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "-o" || argument == "--output")
      ++i;
    else if (!argument.starts_with("-o") && !argument.starts_with("--output="))
      line.emplace_back(argument);
  }
}

}  // namespace hydrapod::cli
