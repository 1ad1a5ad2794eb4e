#include "hydrapod/suggestion.hpp"

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "hydrapod/base/nearest.hpp"

namespace hydrapod::cli {

namespace {
/// base::nearest over owned names; empty when none is near enough to be meant.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  const std::vector<std::string_view> views(candidates.begin(), candidates.end());
  return std::string(base::nearest(word, views).value_or(""));
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// `hydrapod modes`: how the command was called.
std::string call_of(const CLI::App& command) {
  const bool is_root = command.get_parent() == nullptr;
  return is_root ? "hydrapod" : call_of(*command.get_parent()) + ' ' + command.get_name();
}
}  // namespace

std::string unknown_argument(const CLI::App& command, const std::string& argument) {
  const bool is_option = argument.size() > 1 && argument.front() == '-';
  const std::string word = is_option ? argument.substr(0, argument.find('=')) : argument;
  const auto commands = command_names(command);
  const bool is_command = !is_option && !commands.empty();
  std::string message = is_option    ? fmt::format("unknown option '{}'", word)
                        : is_command ? fmt::format("unknown command '{}'", word)
                                     : fmt::format("one argument too many: '{}'", word);
  std::string best;
  if (is_option) best = nearest(word, option_names(command));
  if (is_command) best = nearest(word, commands);
  if (!best.empty()) message += fmt::format("; did you mean '{}'?", best);
  return message + fmt::format(" ('{} --help' shows what there is)", call_of(command));
}

}  // namespace hydrapod::cli
