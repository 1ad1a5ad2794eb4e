#include "hydrapod/commands.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hydrapod::cli {

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
