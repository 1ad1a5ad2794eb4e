#include "hydrapod/commands.hpp"

#include <fmt/format.h>

#include <algorithm>
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

Command add_command(Command app, const std::string& name, const std::string& description,
                    const std::vector<Example>& examples) {
  Command command = app.add_subcommand(name, description);
  std::size_t width = 0;
  for (const Example& example : examples) width = std::max(width, example.arguments.size());
  std::string footer = "Examples:\n";
  for (const Example& example : examples) {
    footer += fmt::format("  hydrapod {:<{}}  {}\n", example.arguments, width, example.purpose);
  }
  footer.pop_back();
  command.footer(footer);
  return command;
}

}  // namespace hydrapod::cli
