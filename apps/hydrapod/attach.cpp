#include <cmath>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/command.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::string stiffness{}, mass{}, damping{}, punch{}, uff{}, at{"0,0,0"}, damping_ratio{},
      output{};
  int grid{exchange::dmig_platform}, modes{};
  bool add_mass{};
};

tasks::AttachOptions options_of(const Arguments& arguments, std::size_t there) {
  tasks::AttachOptions options;
  const std::string& one_file = arguments.punch.empty() ? arguments.uff : arguments.punch;
  if (int(!arguments.stiffness.empty()) + int(!arguments.punch.empty()) +
          int(!arguments.uff.empty()) !=
      1)
    base::refuse("attach",
                 "expected --stiffness and --mass (Matrix Market), or --punch (Nastran), or --uff "
                 "(Universal File)");
  if (!arguments.stiffness.empty() && arguments.mass.empty())
    base::refuse("--stiffness " + arguments.stiffness, "needs --mass, the mass matrix");
  if (!one_file.empty() && !(arguments.mass.empty() && arguments.damping.empty()))
    base::refuse((arguments.punch.empty() ? "--uff " : "--punch ") + one_file,
                 "has mass and damping in it; leave --mass and "
                 "--damping out");
  options.stiffness = one_file.empty() ? arguments.stiffness : one_file;
  options.universal = !arguments.uff.empty();
  options.mass = arguments.mass;
  options.damping = arguments.damping;
  options.grid = arguments.grid;
  options.p_PI = point("--at", arguments.at);
  options.modes =
      arguments.modes > 0 ? arguments.modes : model::most_payload_modes - static_cast<int>(there);
  if (!arguments.damping_ratio.empty())
    options.damping_ratio = plain_or_quantity("--damping-ratio", arguments.damping_ratio, "1");
  options.add_mass = arguments.add_mass;
  return options;
}

std::string attached_text(const tasks::Attached& attached, const TableStyle& style) {
  Table table({"<mode", "Hz", "damping", "mass kg", "<along"});
  const auto& payload = attached.payload;
  const double rounding = 1e-9 * payload.mass(0, 0);
  for (const auto& mode : payload.modes) {
    const spatial::Vector3& l = *mode.participation;
    const double size = l.norm();
    const auto part = [&](double value) { return std::round(1e3 * value / size) / 1e3 + 0.0; };
    const bool turns = size * size < rounding;
    table.add_row(
        {mode.name, fmt::format("{:.3f}", mode.frequency),
         fmt::format("{:.2f} %", 100.0 * mode.damping_ratio),
         fmt::format("{:.4g}", turns ? 0.0 : size * size),
         turns ? "rotation"
               : fmt::format("{:.3f}, {:.3f}, {:.3f}", part(l.x()), part(l.y()), part(l.z()))});
  }
  std::string text = table.text(style);
  text += fmt::format("mass of the structure: {:.5g} kg\n", payload.mass(0, 0));
  if (payload.first_left_out > 0.0)
    text +=
        fmt::format("modes from {:.4g} Hz on are left out: their mass moves with the platform\n",
                    payload.first_left_out / base::two_pi);
  constexpr double notable = 0.05;
  if (payload.coupling.share > notable)
    text += fmt::format(
        "Mind: the damping matrix couples the modes at {:.4g} Hz and {:.4g} Hz, and the file has "
        "dampers of single modes alone; their damping ratios are not those of the structure\n",
        std::min(payload.coupling.omega, payload.coupling.other) / base::two_pi,
        std::max(payload.coupling.omega, payload.coupling.other) / base::two_pi);
  return text;
}

void run(const Arguments& arguments) {
  if (arguments.output == "-") base::refuse("-o -", "the report goes to the standard output");
  require_ending("-o of attach", arguments.output, ".toml");
  const auto machine = load(arguments.machine);
  const auto options = options_of(arguments, machine.file.machine.payload_modes.size());
  const auto attached = tasks::attach_payload(machine, options);
  print_text(fmt::format("{}\n\n{}\n", machine.file.machine.name,
                         attached_text(attached, table_style("-"))));
  write_output(arguments.output, attached.file.text);
}

}  // namespace

void add_attach(Command app) {
  Command command = app.add_command(
      "attach", "Put a flexible payload of a finite-element program on the platform",
      {{"attach machine.toml --stiffness cabin.K.mtx --mass cabin.M.mtx --add-mass -o cabin.toml",
        "a superelement in Matrix Market files, whose mass the file does not contain"},
       {"attach machine.toml --punch cabin.pch --at \"0,0,0.3\" -o cabin.toml",
        "a Nastran punch file, its interface 0.3 m above the joints"},
       {"attach machine.toml --uff cabin.unv --grid 11 -o cabin.toml",
        "a Universal File: matrices, or modes of cabin and free platform, which is node 11"}});
  auto& arguments = command.calls(&run);
  add_machine_options(command, arguments.machine);
  command.add_options(
      {{"--stiffness",
        arguments.stiffness,
        "Stiffness matrix, Matrix Market: x, y, z, rx, ry, rz of the interface, then inner "
        "coordinates",
        {.file = FileUse::input}},
       {"--mass", arguments.mass, "Mass matrix of the same coordinates", {.file = FileUse::input}},
       {"--damping",
        arguments.damping,
        "Viscous damping matrix of the same coordinates",
        {.file = FileUse::input}},
       {"--punch",
        arguments.punch,
        "Nastran punch file with DMIG matrices K…, M… and B…",
        {.file = FileUse::input}},
       {"--uff",
        arguments.uff,
        "Universal File with matrices of a superelement (dataset 252 or 2453), or with normal "
        "modes of structure and free platform (dataset 55 or 2414)",
        {.file = FileUse::input}},
       {"--grid", arguments.grid,
        "Grid point of a punch file, or node of the modes in a Universal File, that is the "
        "platform",
        range(1, 99999999)},
       {"--at", arguments.at,
        "Interface on the platform, \"x,y,z\" in its frame; default: its "
        "origin"},
       {"--modes", arguments.modes, "Modes that are kept, the lowest; default: six in all",
        range(1, model::most_payload_modes)},
       {"--damping-ratio", arguments.damping_ratio,
        "Of modes whose damping the files do not state: 0.02 or \"2 %\""},
       {"--add-mass", arguments.add_mass,
        "Add mass and inertia of the structure to those of the platform"},
       {"-o,--output",
        arguments.output,
        "Machine file to write",
        {.required = true, .file = FileUse::output}}});
}

}  // namespace hydrapod::cli
