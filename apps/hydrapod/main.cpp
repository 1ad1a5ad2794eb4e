/// The program `hydrapod`. Exit codes: 0 done, 1 a computation failed, 2 a bad file or argument.

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/help.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/reproduction.hpp"
#include "hydrapod/team.hpp"
#include "hydrapod/terminal.hpp"

namespace {
using namespace hydrapod;

constexpr int done = 0;
constexpr int failed = 1;
constexpr int bad_input = 2;

void set_up(CLI::App& app) {
  app.set_version_flag("--version", fmt::format("hydrapod {}", base::version));
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.footer(
      "'hydrapod COMMAND --help' or 'hydrapod help COMMAND' shows the options of a command and "
      "examples.");
  app.get_formatter()->column_width(34);
  for (const auto add : cli::all_commands) add(cli::Command(&app));
  cli::add_help(app);
}

/// The innermost command that was understood.
const CLI::App& last_command(const CLI::App& app) {
  const auto commands = app.get_subcommands();
  return commands.empty() ? app : last_command(*commands.front());
}

int report_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = last_command(app);
  const auto extras = app.remaining(true);
  const bool is_extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !extras.empty();
  cli::print_error(is_extra ? cli::unknown_argument(command, extras.front()) : error.what());
  return bad_input;
}

/// Nothing here allocates.
int say_out_of_memory() {
  constexpr std::string_view text = "error: not enough memory\n";
  [[maybe_unused]] const ssize_t told = ::write(STDERR_FILENO, text.data(), text.size());
  return failed;
}

std::terminate_handler end_as_before = nullptr;

/// Where memory ends while an error is handled, or in a function that does not throw.
void end_for_good() {
  try {
    if (const auto error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    ::_exit(say_out_of_memory());
  } catch (...) {
    end_as_before();
  }
  std::abort();
}

int run(int argc, char** argv) {
  CLI::App app{
      "Dynamics of hydraulic hexapods: modes, Bode diagrams, effect of the seals, identification, "
      "diagnosis",
      "hydrapod"};
  set_up(app);
  cli::set_command_line(argc, argv);
  report::state_in_pictures(cli::origin_text);
  if (argc < 2) {
    std::cout << app.help();
    return cli::close_output() ? done : failed;
  }
  try {
    if (std::string_view(argv[1]) == "help")
      cli::help(app, std::vector<std::string>(argv + 2, argv + argc));
    else
      app.parse(argc, argv);
    return cli::close_output() ? done : failed;
  } catch (const CLI::Success& success) {
    app.exit(success);
    return cli::close_output() ? done : failed;
  } catch (const CLI::ParseError& error) {
    if (!cli::is_said_by_rank_0(argv[1])) return report_parse_error(app, error);
    cli::wait_for_the_rank_that_says_why();
    return bad_input;
  } catch (const base::InputError& error) {
    if (error.diagnostics().empty() || cli::is_said_by_rank_0(argv[1]))
      cli::wait_for_the_rank_that_says_why();
    else
      cli::print_diagnostics(error.diagnostics());
    return bad_input;
  } catch (const std::bad_alloc&) {
    return say_out_of_memory();
  } catch (const std::exception& error) {
    cli::print_error(error.what());
    return failed;
  }
}

/// Where a standard stream is closed, the next file that is opened would take its number, and get
/// what is meant for it.
void occupy_standard_streams() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(number, F_GETFD) == -1)
      ::open("/dev/null", number == STDERR_FILENO ? O_WRONLY : O_RDONLY);
}
}  // namespace

int main(int argc, char** argv) {
  occupy_standard_streams();
  end_as_before = std::set_terminate(end_for_good);
  std::signal(SIGPIPE, SIG_DFL);  // `hydrapod … | head` ends quietly
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    return say_out_of_memory();
  } catch (const std::exception& error) {
    cli::print_error(error.what());
    return failed;
  }
}
