#include "hydrapod/help_pages.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>
#include <string_view>
#include <vector>

#include "hydrapod/base/version.hpp"
#include "hydrapod/help.hpp"

namespace hydrapod::cli {

namespace {

/// Letters that have a meaning in man(7): backslash, hyphen, and what begins a request.
std::string escaped(std::string_view text) {
  std::string out;
  bool begins_line = true;
  for (const char letter : text) {
    if (begins_line && (letter == '.' || letter == '\'')) out += "\\&";
    if (letter == '\\') {
      out += "\\e";
    } else if (letter == '-') {
      out += "\\-";
    } else {
      out += letter;
    }
    begins_line = letter == '\n';
  }
  return out;
}

bool is_shown(const CLI::Option& option) { return !option.get_group().empty(); }

/// `-o, --output`, bold; of an argument without a name: its name.
std::string names_of(const CLI::Option& option) {
  if (option.get_positional()) return "\\fB" + escaped(option.get_name(true)) + "\\fR";
  std::vector<std::string> names;
  for (const auto& name : option.get_snames()) names.push_back("-" + name);
  for (const auto& name : option.get_lnames()) names.push_back("--" + name);
  std::string text;
  for (const auto& name : names)
    text += (text.empty() ? "\\fB" : ", \\fB") + escaped(name) + "\\fR";
  return text;
}

void add_entry(std::string& page, const std::string& title, const std::string& text) {
  page += ".TP\n" + title + '\n' + escaped(text) + '\n';
}

void add_options(std::string& page, const CLI::App& command, bool positional) {
  CLI::Formatter formatter;
  formatter.label("REQUIRED", "(required)");
  std::string entries;
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional() == positional && is_shown(*option))
      add_entry(entries, names_of(*option) + escaped(formatter.make_option_opts(option)),
                option->get_description());
  if (!entries.empty()) page += (positional ? ".SH ARGUMENTS\n" : ".SH OPTIONS\n") + entries;
}

void add_commands(std::string& page, const CLI::App& command) {
  if (commands_of(command).empty()) return;
  page += ".SH COMMANDS\n";
  for (const CLI::App* one : commands_of(command))
    add_entry(page, "\\fB" + escaped(page_name(*one)) + "\\fR(1)", one->get_description());
}

/// "Signals (keys and defaults):" becomes a title and a line below it.
void add_title(std::string& page, std::string line) {
  line.pop_back();
  const auto bracket = line.find(" (");
  std::string title = line.substr(0, bracket);
  std::transform(title.begin(), title.end(), title.begin(), ::toupper);
  page += ".SH \"" + escaped(title) + "\"\n";
  if (bracket != line.npos && line.ends_with(')'))
    page += escaped(line.substr(bracket + 2, line.size() - bracket - 3)) + ":\n";
}

/// Examples and tables of the help. A line that ends with a colon is a title.
void add_footer(std::string& page, const CLI::App& command) {
  std::istringstream lines(command.get_footer());
  bool filled = true, examples = false;
  const auto fill = [&](bool wanted) {
    if (wanted != filled) page += wanted ? ".fi\n" : ".nf\n";
    filled = wanted;
  };
  for (std::string line; std::getline(lines, line);) {
    const bool is_indented = line.starts_with("  ");
    const auto gap = is_indented ? line.find("  ", 2) : line.npos;
    if (!is_indented && line.ends_with(':')) {
      fill(true);
      examples = line == "Examples:";
      add_title(page, line);
    } else if (examples && gap != line.npos) {
      add_entry(page, "\\fB" + escaped(line.substr(2, gap - 2)) + "\\fR",
                line.substr(line.find_first_not_of(' ', gap)));
    } else if (!line.empty()) {
      fill(!is_indented);
      page += escaped(line) + '\n';
    }
  }
  fill(true);
}

/// All options of `command` and the commands below it, separated by blanks.
std::string words_of(const CLI::App& command) {
  std::string words;
  const bool is_help = command.get_name() == "help";  // takes the names of all the others
  for (const CLI::App* one : commands_of(is_help ? *command.get_parent() : command))
    words += one->get_name() + ' ';
  for (const CLI::Option* option : command.get_options()) {
    if (!is_shown(*option) || option->get_positional()) continue;
    for (const auto& name : option->get_snames()) words += "-" + name + ' ';
    for (const auto& name : option->get_lnames()) words += "--" + name + ' ';
  }
  if (!words.empty()) words.pop_back();
  return words;
}

/// One line of the script for each command: `'record show') words='…' ;;`
void add_cases(std::string& cases, const CLI::App& command) {
  const std::string call = call_of(command);
  cases += fmt::format("    '{}') words='{}' ;;\n", call, words_of(command));
  for (const CLI::App* one : commands_of(command)) add_cases(cases, *one);
}
}  // namespace

std::string page_name(const CLI::App& command) {
  std::string name = call_of(command);
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string man_page(const CLI::App& command) {
  std::string title = page_name(command);
  std::transform(title.begin(), title.end(), title.begin(), ::toupper);
  std::string page = fmt::format(
      ".TH \"{}\" 1 \"\" \"hydrapod {}\" \"hydrapod\"\n.nh\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n",
      escaped(title), base::version, escaped(page_name(command)),
      escaped(command.get_description()));
  page += fmt::format("\\fB{}\\fR [OPTIONS]", escaped(call_of(command)));
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional())
      page += fmt::format(fmt::runtime(option->get_required() ? " {}{}" : " [{}{}]"),
                          option->get_name(true), option->get_expected_max() > 1 ? "..." : "");
  if (!commands_of(command).empty()) page += " COMMAND";
  page += '\n';
  add_options(page, command, true);
  add_options(page, command, false);
  add_commands(page, command);
  add_footer(page, command);
  if (command.get_parent() != nullptr)
    page +=
        fmt::format(".SH \"SEE ALSO\"\n\\fB{}\\fR(1)\n", escaped(page_name(*command.get_parent())));
  return page;
}

std::string bash_completion(const CLI::App& app) {
  std::string cases;
  add_cases(cases, app);
  return fmt::format(R"bash(# Completion of hydrapod {} for bash, from `hydrapod help --completion`.
_hydrapod_words() {{
  local words=
  case $1 in
{}  esac
  printf '%s' "$words"
}}

_hydrapod() {{
  local call=hydrapod current=${{COMP_WORDS[COMP_CWORD]}} word
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    if [[ $word != -* && -n $(_hydrapod_words "$call $word") ]]; then call+=" $word"; fi
  done
  mapfile -t COMPREPLY < <(compgen -W "$(_hydrapod_words "$call")" -- "$current")
}}

# Where no word fits: files.
complete -o bashdefault -o default -F _hydrapod hydrapod
)bash",
                     base::version, cases);
}

}  // namespace hydrapod::cli
