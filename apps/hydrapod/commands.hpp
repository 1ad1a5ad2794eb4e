#pragma once
/// The subcommands of the program `hydrapod`, one file each.
///
/// To add one: write `<name>.cpp` with `void add_<name>(CLI::App& app)`, declare it here and put it
/// into `all_commands`. The callback returns when all went well and throws otherwise:
/// base::InputError for a bad file or argument (exit code 2), base::ComputationError or any other
/// exception for a computation that failed (exit code 1).

#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <vector>

namespace hydrapod::cli {

/// One line of the examples below the help of a command.
struct Example {
  std::string arguments{};  ///< without the program's name: `modes machine.toml --pose up`
  std::string purpose{};    ///< what it does, in a few words
};

/// A subcommand whose help ends with `examples`.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::vector<Example>& examples);

void add_init(CLI::App& app);
void add_check(CLI::App& app);
void add_modes(CLI::App& app);
void add_bode(CLI::App& app);
void add_simulate(CLI::App& app);
void add_sensitivity(CLI::App& app);
void add_calibrate(CLI::App& app);
void add_frf(CLI::App& app);
void add_identify(CLI::App& app);
void add_diagnose(CLI::App& app);
void add_report(CLI::App& app);
void add_rig(CLI::App& app);
void add_record(CLI::App& app);
void add_demo(CLI::App& app);

/// In the order of the help.
inline constexpr std::array all_commands{
    &add_demo,     &add_init,        &add_check,     &add_modes, &add_bode,
    &add_simulate, &add_sensitivity, &add_calibrate, &add_rig,   &add_record,
    &add_frf,      &add_identify,    &add_diagnose,  &add_report};

}  // namespace hydrapod::cli
