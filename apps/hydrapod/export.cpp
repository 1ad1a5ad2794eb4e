#include "hydrapod/command.hpp"

#include "hydrapod/base/text.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::cli {

namespace {

using exchange::Held;

struct Arguments {
  MachineArguments machine{};
  std::string to{}, system{}, inputs{}, outputs{}, point{}, sample_time{}, output{};
  std::optional<int> pade{};
  int leg_modes{-1}, reduce{};
  bool sampled{}, free_base{}, approximate{};
};

std::vector<std::string> names(const std::string& text) {
  return text.empty() ? std::vector<std::string>{} : base::split(text, ",");
}

std::string parity_text(const exchange::Parity& parity, const TableStyle& style) {
  Table table({"<held", "<what", "<how"});
  for (const auto& line : parity)
    table.add_row({line.held == Held::exact         ? "exactly"
                   : line.held == Held::approximate ? "approximately"
                                                    : "NOT HELD",
                   line.what, line.how});
  return table.text(style);
}

bool is_state_space(tasks::ExportFormat format) { return format <= tasks::ExportFormat::hdf5; }

bool is_fmu(tasks::ExportFormat format) { return format >= tasks::ExportFormat::fmu2; }

/// Options that another format has no use for.
void refuse_idle_options(const Arguments& arguments, tasks::ExportFormat format) {
  const std::string to = "with --to " + arguments.to;
  if (!is_state_space(format)) {
    const char* what = " has no meaning: it is for state spaces (mat, npz, json, hdf5)";
    if (!arguments.system.empty() && arguments.system != "mechanics" && !is_fmu(format))
      base::refuse("--system " + arguments.system,
                   to + " has no meaning: it is for state spaces (mat, npz, json, hdf5) and FMUs");
    if (!arguments.sample_time.empty())
      base::refuse("--sample-time " + arguments.sample_time, to + what);
    if (!arguments.inputs.empty()) base::refuse("--inputs " + arguments.inputs, to + what);
    if (!arguments.outputs.empty()) base::refuse("--outputs " + arguments.outputs, to + what);
    if (arguments.sampled) base::refuse("--sampled", to + what);
    if (arguments.reduce != 0) base::refuse("--reduce", to + what);
  }
  const bool superelement =
      format == tasks::ExportFormat::matrix_market || format == tasks::ExportFormat::dmig;
  const bool of_mechanics =
      is_state_space(format) && (arguments.system.empty() || arguments.system == "mechanics");
  if (!arguments.point.empty() && !of_mechanics && !superelement)
    base::refuse("--point " + arguments.point,
                 (is_state_space(format) ? "with --system " + arguments.system : to) +
                     " has no meaning: it is for state spaces of the mechanics and superelements");
  if (arguments.pade &&
      (!is_state_space(format) || arguments.system != "loop" || arguments.sampled))
    base::refuse(fmt::format("--pade {}", *arguments.pade),
                 "is the delay of the controller in a state space; expected --system loop without "
                 "--sampled");
  if (arguments.leg_modes >= 0 && !superelement)
    base::refuse("--leg-modes", to + " has no meaning: it is for superelements (mtx, dmig)");
  if (arguments.free_base && !superelement)
    base::refuse("--free-base", to + " has no meaning: it is for superelements (mtx, dmig)");
  if (arguments.reduce != 0 && arguments.sampled)
    base::refuse("--reduce", "is for continuous systems; leave --sampled out");
  if (arguments.sampled && arguments.system != "loop")
    base::refuse("--sampled", "is the loop with its sampled controller; add --system loop");
  if (arguments.sampled && !arguments.sample_time.empty())
    base::refuse("--sampled", "has the sample time of the controller; leave --sample-time out");
}

tasks::ExportFormat format_of(const Arguments& arguments) {
  return static_cast<tasks::ExportFormat>(choose_word(
      "--to", arguments.to, {tasks::export_formats.begin(), tasks::export_formats.end()}));
}

std::vector<NamedFile> files_of(const Arguments& arguments) {
  std::vector<NamedFile> files;
  if (arguments.output == "-") return files;
  for (const auto& file : tasks::export_files(format_of(arguments), arguments.output))
    files.push_back({"-o", file});
  return files;
}

tasks::ExportOptions options_of(const Arguments& arguments) {
  tasks::ExportOptions options;
  options.format = format_of(arguments);
  options.path = arguments.output;
  refuse_idle_options(arguments, options.format);
  if (!arguments.system.empty())
    options.system = static_cast<exchange::SystemKind>(
        choose_word("--system", arguments.system, {"mechanics", "plant", "loop"}));
  options.pade_order = arguments.pade.value_or(options.pade_order);
  if (!arguments.sample_time.empty())
    options.sample_time = positive_quantity("--sample-time", arguments.sample_time, "s",
                                            "a time above 0, for instance \"1 ms\"");
  options.sampled_controller = arguments.sampled;
  options.inputs = names(arguments.inputs);
  options.outputs = names(arguments.outputs);
  if (!arguments.point.empty()) options.p_PQ = point("--point", arguments.point);
  options.reduced_states = arguments.reduce;
  options.leg_modes = arguments.leg_modes;
  options.free_base = arguments.free_base;
  options.approximate = arguments.approximate;
  return options;
}

void run(const Arguments& arguments) {
  auto options = options_of(arguments);
  if (options.path == "-") base::refuse("-o -", "an export is a file; give it a name");
  const auto machine = load(arguments.machine);
  options.json_head = head_of_model("state_space", machine);
  const auto exported = tasks::export_machine(machine, options);
  print_text(fmt::format("{}, pose {}, {} model\n\n{}\n", machine.file.machine.name,
                         machine.pose.name, dynamics::name(machine.kind),
                         parity_text(exported.parity, table_style("-"))));
  for (const auto& file : exported.files) print_written(file);
}

}  // namespace

void add_export(Command app) {
  Command command = app.add_command(
      "export", "The machine as a file for another program",
      {{"export machine.toml --to mat -o machine.mat", "state space of the mechanics, for MATLAB"},
       {"export machine.toml --to npz --system loop -o loop.npz",
        "A, B, C, D of the closed loop, for NumPy"},
       {"export machine.toml --to npz --sample-time \"1 ms\" --outputs x,y,z -o xyz.npz",
        "discretised, three outputs"},
       {"export machine.toml --to dmig -o machine.pch", "superelement for Nastran"},
       {"export machine.toml --to dmig --free-base -o machine.pch",
        "the same, to be put onto the structure of a foundation"},
       {"export machine.toml --to uff -o modes.uff", "modes for programs of modal analysis"},
       {"export machine.toml --to unv -o modes.unv", "modes for finite-element programs"},
       {"export machine.toml --to mjcf -o machine.xml", "multibody model for MuJoCo"},
       {"export machine.toml --to fmu2 -o machine.fmu",
        "nonlinear plant for simulators with FMI"}});
  auto& arguments = command.calls(&run);
  add_subject_options(command, arguments.machine);
  command.add_options(
      {{"--to", arguments.to,
        "State space: mat, npz, json, hdf5; modes: uff, unv; superelement: mtx, dmig; "
        "multibody: mjcf, sdf, urdf; nonlinear plant: fmu2, fmu3",
        required},
       {"--system", arguments.system,
        "State space of the mechanics (default), of the plant (with hydraulics or electric "
        "drives), or of the loop (with the controller); FMU of the plant (default), of the "
        "mechanics, or of the loop"},
       {"--sample-time", arguments.sample_time,
        "Discretise, inputs held over this time: s or with a unit"},
       {"--sampled", arguments.sampled,
        "The loop as it is sampled, exact, at the controller's sample time"},
       {"--pade", arguments.pade,
        "Order of the approximation of the delay, 0 (no delay) to 8; default: 2", range(0, 8)},
       {"--inputs", arguments.inputs, "Names of inputs, with commas; default: all"},
       {"--outputs", arguments.outputs, "Names of outputs, with commas; default: all"},
       {"--reduce", arguments.reduce,
        "States of a balanced reduction; the report states the bound of its error; default: all",
        range(1, 10000)},
       {"--point", arguments.point,
        "Interface on the platform, \"x,y,z\" in its frame; default: its mass centre"},
       {"--leg-modes", arguments.leg_modes,
        "Modes of the legs that a superelement keeps; default: all", range(-1, 1000)},
       {"--free-base", arguments.free_base,
        "A superelement to be joined at the base too: its six directions are "
        "coordinates; its mount and mass are left out"},
       {"--approximate", arguments.approximate,
        "Write also what the format cannot hold in full; the report lists it"},
       {"-o,--output", arguments.output, "File to write", required}});
  command.also_writes([&arguments] { return files_of(arguments); });
}

}  // namespace hydrapod::cli
