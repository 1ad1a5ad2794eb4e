#pragma once
/// The subcommands of the program `hydrapod`, one file each.
///
/// To add one: write `<name>.cpp` with `void add_<name>(Command app)`, declare it here and put it
/// into `all_commands`. What it takes is said with options.hpp. The callback returns when all went
/// well and throws otherwise: base::InputError for a bad file or argument (exit code 2),
/// base::ComputationError or any other exception for a computation that failed (exit code 1).

#include <array>

#include "hydrapod/options.hpp"

namespace hydrapod::cli {

void add_init(Command app);
void add_check(Command app);
void add_modes(Command app);
void add_bode(Command app);
void add_simulate(Command app);
void add_sensitivity(Command app);
void add_calibrate(Command app);
void add_frf(Command app);
void add_identify(Command app);
void add_diagnose(Command app);
void add_compare(Command app);
void add_report(Command app);
void add_rig(Command app);
void add_record(Command app);
void add_serve(Command app);
void add_demo(Command app);
void add_export(Command app);
void add_attach(Command app);
void add_montecarlo(Command app);
void add_sweep(Command app);
void add_map(Command app);
void add_design(Command app);
void add_evaluate(Command app);
void add_studio(Command app);

/// In the order of the help.
inline constexpr std::array all_commands{
    &add_demo,        &add_init,      &add_check,   &add_modes,      &add_bode,   &add_simulate,
    &add_sensitivity, &add_calibrate, &add_rig,     &add_serve,      &add_record, &add_frf,
    &add_identify,    &add_diagnose,  &add_compare, &add_montecarlo, &add_sweep,  &add_map,
    &add_design,      &add_evaluate,  &add_report,  &add_studio,     &add_export, &add_attach};

}  // namespace hydrapod::cli
