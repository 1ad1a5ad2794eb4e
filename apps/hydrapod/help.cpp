/// `hydrapod help`.

#include "hydrapod/help.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/help_pages.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

std::string call_of(const CLI::App& command) {
  const bool is_root = command.get_parent() == nullptr;
  return is_root ? "hydrapod" : call_of(*command.get_parent()) + ' ' + command.get_name();
}

std::vector<const CLI::App*> commands_of(const CLI::App& command) {
  return command.get_subcommands([](const CLI::App*) { return true; });
}

std::string unknown_argument(const CLI::App& command, const std::string& argument) {
  const bool is_option = argument.size() > 1 && argument.front() == '-';
  const std::string word = is_option ? argument.substr(0, argument.find('=')) : argument;
  std::vector<std::string> known;
  if (is_option)
    for (const CLI::Option* option : command.get_options())
      for (const auto& name : option->get_lnames()) known.push_back("--" + name);
  else
    for (const CLI::App* one : commands_of(command)) known.push_back(one->get_name());
  std::string message = is_option        ? fmt::format("unknown option '{}'", word)
                        : !known.empty() ? fmt::format("unknown command '{}'", word)
                                         : fmt::format("one argument too many: '{}'", word);
  const std::vector<std::string_view> names(known.begin(), known.end());
  if (const auto near = base::nearest(word, names))
    message += fmt::format("; did you mean '{}'?", *near);
  return message + fmt::format(" ('{} --help' lists the options)", call_of(command));
}

namespace {

[[noreturn]] void refuse(const std::string& message) { base::refuse({}, message); }

/// The command that `words` name.
const CLI::App& command_of(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  for (const auto& word : words) {
    const CLI::App* inner = nullptr;
    for (const CLI::App* one : commands_of(*command))
      if (one->get_name() == word) inner = one;
    if (inner == nullptr) refuse(unknown_argument(*command, word));
    command = inner;
  }
  return *command;
}

/// How many.
int write_man_pages(const CLI::App& command, const std::filesystem::path& folder) {
  base::write_file_whole(folder / (page_name(command) + ".1"), man_page(command));
  int written = 1;
  for (const CLI::App* one : commands_of(command)) written += write_man_pages(*one, folder);
  return written;
}
}  // namespace

void add_help(CLI::App& app) {
  CLI::App* help = app.add_subcommand("help", "Help on a command; man pages; completion for bash");
  help->add_option("COMMAND")->description("Command, for instance: record show");
  help->add_option("--man")->type_name("FOLDER")->description(
      "Write the man pages of all commands into this folder");
  help->add_flag("--completion")->description("Print the completion of the command line for bash");
  help->footer(
      "Examples:\n"
      "  hydrapod help record show               options and examples of a command\n"
      "  hydrapod help --man .                   man pages: man ./hydrapod-modes.1\n"
      "  hydrapod help --completion > hydrapod   for ~/.local/share/bash-completion/completions");
}

void help(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App& own = command_of(app, {"help"});
  const std::string first = words.empty() ? "" : words.front();
  if (first == "-h" || first == "--help") return help(app, {"help"});
  if (first == "--completion" || first == "--man") {
    const std::size_t taken = first == "--man" ? 2 : 1;
    if (words.size() < taken) refuse("--man needs a folder, for instance: hydrapod help --man .");
    if (words.size() > taken) refuse(fmt::format("one argument too many: '{}'", words[taken]));
    if (first == "--completion") {
      std::cout << bash_completion(app);
      return;
    }
    if (!std::filesystem::is_directory(words[1]))
      refuse(fmt::format("--man: '{}' is not a folder", words[1]));
    const int pages = write_man_pages(app, words[1]);
    print_note(fmt::format("wrote {} man pages into {}", pages, words[1]));
    return;
  }
  if (first.starts_with('-')) refuse(unknown_argument(own, first));
  const CLI::App& command = command_of(app, words);
  const CLI::App* parent = command.get_parent();
  std::cout << command.help(parent == nullptr ? "" : call_of(*parent));
}

}  // namespace hydrapod::cli
