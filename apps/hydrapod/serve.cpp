#include "hydrapod/command.hpp"
#include "hydrapod/realtime_arguments.hpp"
#include "hydrapod/reproduction.hpp"

#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::string udp{"4747"}, bind{}, shared_memory{}, key{}, layout{};
  bool lock_step{}, once{}, print_layout{};
  std::string hold{"100 ms"}, ramp{"1 s"}, patience{"10 s"}, rest{}, duration{}, busy{};
  std::optional<int> fifo{};
  std::vector<std::string> accelerometers{};
  std::string integrator{"exponential"}, step{"0.2 ms"};
  double tolerance{1e-6};
  std::uint64_t seed{1};
  bool ideal_sensors{};
  std::string record{}, format{"table"};
};

double seconds(const char* option, const std::string& text) {
  return positive_quantity(option, text, "s", "must be positive");
}

realtime::ServeOptions server_of(const Arguments& arguments, const model::Machine& machine) {
  realtime::ServeOptions options;
  if (!arguments.shared_memory.empty() && !arguments.bind.empty())
    base::refuse("--bind", "shared memory has no address, expected --shm or --bind");
  options.address = realtime::parse_address("--udp", arguments.udp);
  options.bind = arguments.bind;
  options.shared_memory = arguments.shared_memory;
  options.layout = layout_of(arguments.layout);
  options.key = key_of(arguments.key);
  options.lock_step = arguments.lock_step;
  options.once = arguments.once;
  options.hold = seconds("--hold", arguments.hold);
  options.ramp = seconds("--ramp", arguments.ramp);
  options.patience = seconds("--patience", arguments.patience);
  options.fifo = arguments.fifo;
  if (!arguments.busy.empty()) options.busy = seconds("--busy", arguments.busy);
  options.accelerometers = rig::default_accelerometers(machine);
  if (!arguments.accelerometers.empty()) options.accelerometers.clear();
  for (const auto& text : arguments.accelerometers)
    if (text != "none") options.accelerometers.push_back(rig::parse_accelerometer(text));
  return options;
}

simulation::LoopOptions loop_of(const Arguments& arguments) {
  constexpr std::array methods{simulation::Method::exponential, simulation::Method::fixed,
                               simulation::Method::adaptive, simulation::Method::cvode_adams,
                               simulation::Method::cvode_bdf};
  simulation::LoopOptions loop;
  loop.integrator.method = methods[choose_word(
      "--integrator", arguments.integrator, {"exponential", "fixed", "adaptive", "adams", "bdf"})];
  loop.integrator.fixed_step = seconds("--step", arguments.step);
  if (!(arguments.tolerance >= 1e-13 && arguments.tolerance <= 1e-2))
    base::refuse(fmt::format("--tolerance {}", arguments.tolerance), "expected 1e-13 to 0.01");
  loop.integrator.relative_tolerance = loop.integrator.absolute_tolerance = arguments.tolerance;
  loop.seed = arguments.seed;
  loop.ideal_sensors = arguments.ideal_sensors;
  return loop;
}

void add_timing(Table& table, const char* what, const realtime::Timing& timing) {
  const auto us = [](double s) { return fmt::format("{:.{}f}", 1e6 * s, s < 1e-4 ? 1 : 0); };
  table.add_row({what, us(timing.p50), us(timing.p99), us(timing.p99_9), us(timing.p99_99),
                 us(timing.worst)});
}

std::string result_text(const realtime::ServeResult& r, const TableStyle& style) {
  const auto& c = r.counters;
  std::string text = fmt::format("{:.6g} s, {} samples of {:g} ms; {}; platform {}\n", r.run.time,
                                 r.run.samples, 1e3 * r.sample_time,
                                 r.lock_step ? "lock-step" : r.scheduling, realtime::name(r.state));
  text += fmt::format(
      "commands: {} accepted ({} superseded), {} samples without one, {} lost, {} reordered, "
      "{} duplicated, {} malformed, {} refused, {} out of range; {} ramps down by the watchdog\n",
      c.accepted, c.superseded, c.missed, c.lost, c.reordered, c.duplicated, c.malformed, c.refused,
      c.out_of_range, c.trips);
  text += fmt::format("sensors: {} packets sent, {} not sent\n", r.sent, r.not_sent);
  if (r.rows_lost > 0) text += fmt::format("record: {} rows lost\n", r.rows_lost);
  if (!r.lock_step)
    text += fmt::format(
        "deadline misses: {} of {} samples ({} steps not finished in time, {} "
        "standstills)\n",
        r.misses, r.run.samples, r.overruns, r.shifts);
  if (r.step.samples == 0) return text;
  Table table({"<µs", "p50", "p99", "p99.9", "p99.99", "worst"});
  if (!r.lock_step) add_timing(table, "begin of a sample after its time", r.lateness);
  add_timing(table, "one step", r.step);
  add_timing(table, "processor time of a step", r.step_processor);
  return text + '\n' + table.text(style);
}

void run(const Arguments& arguments) {
  choose_word("--format", arguments.format, {"table", "json"});
  if (!arguments.record.empty()) data::format_of_ending(arguments.record);
  const auto machine = load(arguments.machine);
  tasks::ServeOptions options{.server = server_of(arguments, machine.file.machine),
                              .rest = arguments.rest,
                              .loop = loop_of(arguments),
                              .record = arguments.record,
                              .origin = record_origin()};
  if (arguments.print_layout) {
    const auto& own = options.server.layout;
    const auto& layout =
        own.command.fields.empty()
            ? realtime::native_layout(static_cast<int>(options.server.accelerometers.size()),
                                      model::leg_type(machine.file.machine))
            : own;
    return base::write_file_whole("-", realtime::layout_text(layout));
  }
  if (!arguments.duration.empty()) options.duration = seconds("--duration", arguments.duration);
  options.warn = [](const std::string& warning) { print_warning(warning); };
  options.server.ready = [](const std::string& place) { print_note("listening at " + place); };
  const auto served = with_progress(
      "serving", [&](const auto& progress) { return tasks::serve(machine, options, progress); });
  if (!served.record.empty()) print_written(served.record);
  const auto& run = served.result.run;
  if (options.server.fifo && !served.result.scheduling.starts_with("SCHED_FIFO"))
    print_warning(served.result.scheduling, "--fifo");
  print_text(arguments.format == "json"
                 ? json_text(report::head_json("serve", machine), report::serve_json(served.result))
                 : result_text(served.result, table_style("-")));
  if (run.end == simulation::RunEnd::failed ||
      (run.end == simulation::RunEnd::stopped && options.duration))
    throw base::ComputationError(
        fmt::format("the run ended at {:.6g} s: {}", run.time,
                    run.end == simulation::RunEnd::stopped ? "interrupted" : run.message));
}

void add_transport_options(Command command, Arguments& arguments) {
  command.add_options(
      {{"--udp", arguments.udp, "Port, or ADDRESS:PORT of the loopback; 0: any free one",
        shown_as("PORT")},
       {"--bind", arguments.bind, "Listen at another address than the loopback; needs --key",
        shown_as("ADDRESS")},
       {"--key", arguments.key,
        "File with 16 or more secret bytes: packets are authenticated (HMAC-SHA256)", reads},
       {"--shm", arguments.shared_memory, "POSIX shared memory of that name, instead of UDP",
        shown_as("NAME")},
       {"--layout", arguments.layout, "Description of the packets (TOML); default: hydrapod's",
        reads},
       {"--print-layout", arguments.print_layout,
        "Print the description of the packets, byte by byte, and end"},
       {"--lock-step", arguments.lock_step,
        "The client's clock: every command is one step and has one answer"},
       {"--hold", arguments.hold, "How long the last command is held when none come"},
       {"--ramp", arguments.ramp, "Time of the ramp down to the rest position after that"},
       {"--rest", arguments.rest,
        "Rest position, a displacement from the pose: \"z=-20 mm\" [the pose]"},
       {"--patience", arguments.patience,
        "In lock-step, by the wall clock: how long to wait for a client before the ramp down"},
       {"--once", arguments.once, "End when the first client has gone and the platform is at rest"},
       {"--fifo", arguments.fifo, "Real-time priority (SCHED_FIFO), where it is permitted",
        range(1, 99)},
       {"--busy", arguments.busy,
        "On the wall clock, how long to wait without sleeping before each sample: caches stay "
        "warm, and one "
        "processor is taken for that time [0]"}});
}

}  // namespace

void add_serve(Command app) {
  Command command = app.add_command(
      "serve",
      "The virtual machine in real time: commands in, sensors out, by UDP or shared memory",
      {{"serve machine.toml --udp 0 --duration 2",
        "two seconds at the controller's sample rate, on any free port of the loopback"},
       {"serve machine.toml --udp 0 --duration 2 -o run.h5 --format json",
        "with a record, and times and counters as JSON"},
       {"serve machine.toml --print-layout", "what stands where in the packets"},
       {"serve machine.toml --udp 0 --duration 1 --set controller.sample_time=\"2 ms\"",
        "500 samples per second"}},
      "\n\nThe rate is that of the controller (controller.sample_time). Without --duration it "
      "serves until Ctrl-C.\nClients in C, Python and shell: examples/realtime. Format and safety: "
      "docs/howto/realtime.md.");
  auto& arguments = command.calls(&run);
  add_subject_options(command, arguments.machine);
  add_transport_options(command, arguments);
  command.add_options(
      {{"--duration", arguments.duration, "Time of the machine; default: until Ctrl-C"},
       {"-o,--output", arguments.record,
        "Record to write, with lateness and deadline misses: .h5, .mat, .csv, .uff or .rpc",
        writes},
       {"--accelerometer", arguments.accelerometers,
        "As for rig; none: no accelerometer; default: three axes at the joints of legs 1, 3, 5",
        one_each},
       {"--integrator", arguments.integrator,
        "exponential (spools in closed form, Dormand-Prince 5(4)), fixed (Runge-Kutta 4, equal "
        "work "
        "in every step), adaptive, adams or bdf"},
       {"--step", arguments.step, "Step of the fixed integrator"},
       {"--tolerance", arguments.tolerance, "Of the other integrators, relative"},
       {"--seed", arguments.seed, "Seed of the sensors' noise"},
       {"--ideal-sensors", arguments.ideal_sensors, "Sensors without noise, resolution and range"},
       {"--format", arguments.format, "table or json"}});
}

}  // namespace hydrapod::cli
