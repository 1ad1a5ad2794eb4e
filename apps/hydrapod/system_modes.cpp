#include "hydrapod/system_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/interrupt.hpp"
#include "hydrapod/kinematics/check_machine.hpp"
#include "hydrapod/report/simulation.hpp"
#include "hydrapod/report/system.hpp"
#include "hydrapod/simulation/tuning.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

using simulation::LinearSystem;
using simulation::SystemPoles;

using base::two_pi;
constexpr int most_values = 1000;

struct LocusRange {
  std::string key{};
  std::vector<double> values{};
};

LocusRange locus_range(const std::string& text) {
  const std::string argument = "--root-locus " + text;
  const auto reject = [&](const std::string& found) {
    bad_argument(argument, found +
                               ", expected KEY=from:to:count with numbers in SI, for instance "
                               "controller.gain=5:80:16");
  };
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) reject("no key");
  std::array<double, 3> numbers{0.0, 0.0, 11.0};
  std::size_t count = 0;
  for (std::size_t begin = equals + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const auto number = plain_number(part);
    if (count == numbers.size()) reject("more than three numbers");
    if (!number) reject(fmt::format("'{}' is no plain number", part));
    numbers[count++] = *number;
    begin = end + 1;
  }
  if (count < 2) reject("only one number");
  const int steps = static_cast<int>(std::clamp(numbers[2], -1.0, 1e6));
  if (steps != numbers[2] || steps < 2 || steps > most_values)
    reject(fmt::format("the count is {:g}; it must be a whole number from 2 to {}", numbers[2],
                       most_values));
  if (numbers[0] == numbers[1]) reject("both ends are equal");
  LocusRange range{text.substr(0, equals), {}};
  for (int k = 0; k < steps; ++k)
    range.values.push_back(numbers[0] + (numbers[1] - numbers[0]) * k / (steps - 1));
  return range;
}

/// Slower than this a pole is a drift [rad/s].
constexpr double drift = 1e-2;

/// Without a controller drifting is what a platform on valves does, and no fault.
std::string open_verdict(const LinearSystem& linear, const SystemPoles& poles) {
  const double rate = poles.largest_real;
  if (rate < -drift || rate > drift) return report::verdict_text(linear, poles);
  constexpr double none = 1e-9;
  return rate > none ? fmt::format(
                           "without a controller nothing holds the pose: the platform "
                           "drifts away with {:.2g} 1/s",
                           rate)
                     : std::string("without a controller nothing holds the pose");
}

/// Table of poles, ascending in frequency.
std::string pole_table(const SystemPoles& poles, bool closed, bool colour, std::size_t width) {
  std::vector<const simulation::SystemPole*> order;
  for (const auto& pole : poles.poles) order.push_back(&pole);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto* a, const auto* b) { return a->omega < b->omega; });
  Table table({{"pole"},
               {"Hz"},
               {"rad/s"},
               {"damping"},
               {"Re 1/s"},
               {"", Align::left},
               {"what takes part", Align::left}});
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto& pole = *order[k];
    const bool stable = pole.pole.real() < 0.0;
    const bool drifts = !closed && pole.omega < drift;
    table.add_row(
        {std::to_string(k + 1),
         pole.oscillates() && !drifts ? fmt::format("{:.3f}", pole.omega / two_pi) : "–",
         fmt::format("{:.4g}", pole.omega),
         pole.oscillates() && !drifts ? fmt::format("{:.2f} %", 100.0 * pole.damping_ratio) : "–",
         fmt::format("{:.4g}", pole.pole.real()),
         drifts   ? "drift"
         : stable ? ""
                  : "UNSTABLE",
         report::participation_text(pole)});
  }
  return table.text(colour, width);
}

std::string system_heading(const model::Machine& machine, const report::PoseChoice& pose,
                           dynamics::ModelKind kind, const LinearSystem& system, bool closed,
                           bool colour) {
  if (!closed)
    return fmt::format(
        "{}, pose {}: {} model with hydraulics, without controller, {} states\n"
        "the valves are held where the machine rests; measured from the drives on these are the "
        "poles\n",
        styled(machine.name, Style::bold, colour), pose.name, dynamics::name(kind),
        system.A.rows());
  return fmt::format(
      "{}, pose {}: {} model with hydraulics and controller, {} states\n"
      "sampled every {:.4g} ms; delay and hold of {:.4g} ms as Padé {}/{} (the verdict is that of "
      "the sampled loop)\n",
      styled(machine.name, Style::bold, colour), pose.name, dynamics::name(kind), system.A.rows(),
      1e3 * system.sample_time, 1e3 * system.delay, system.pade_order, system.pade_order);
}

/// Of the oscillations that the platform takes part in.
const simulation::SystemPole* least_damped(const SystemPoles& poles) {
  constexpr double felt = 0.05;  // participation of the platform
  const simulation::SystemPole* least = nullptr;
  for (const auto& pole : poles.poles) {
    double platform = 0.0;
    for (int i = 0; i < 6; ++i) platform += pole.parts[static_cast<std::size_t>(i)];
    if (!pole.oscillates() || platform < felt) continue;
    if (least == nullptr || pole.damping_ratio < least->damping_ratio) least = &pole;
  }
  return least;
}

std::string locus_table(const report::RootLocus& locus, bool colour, std::size_t width) {
  Table table({{locus.key},
               {"stable", Align::left},
               {"largest |z|"},
               {"largest Re 1/s"},
               {"Hz"},
               {"least damping felt"},
               {"Hz"},
               {"what takes part", Align::left}});
  for (std::size_t k = 0; k < locus.values.size(); ++k) {
    const auto& poles = locus.poles[k];
    const auto* least = least_damped(poles);
    const auto& first = poles.poles.front();
    table.add_row({fmt::format("{:.6g}", locus.values[k]), poles.sampled_stable ? "yes" : "NO",
                   fmt::format("{:.6f}", poles.largest_modulus),
                   fmt::format("{:.4g}", first.pole.real()),
                   fmt::format("{:.3f}", first.pole.imag() / two_pi),
                   least != nullptr ? fmt::format("{:.3f} %", 100.0 * least->damping_ratio) : "–",
                   least != nullptr ? fmt::format("{:.3f}", least->omega / two_pi) : "–",
                   least != nullptr ? report::participation_text(*least) : ""});
  }
  std::string text = table.text(colour, width);
  for (const double limit : locus.limits)
    text += fmt::format("\nlimit of stability: {} = {:.6g}\n", locus.key, limit);
  return text;
}

report::RootLocus computed_locus(const MachineArguments& arguments, const LocusRange& range,
                                 const model::MachineFile& file, const report::PoseChoice& pose,
                                 const simulation::LinearSystemOptions& options) {
  ProgressLine progress("root locus");
  return report::root_locus(
      range.key, range.values,
      [&](double value) {
        auto overrides = arguments.overrides;
        overrides.push_back(fmt::format("{}={:.17g}", range.key, value));
        const auto changed =
            model::parse_machine(file.text, arguments.file, overrides, kinematics::check_machine);
        return simulation::linear_system(changed.machine, pose.X_BP, options);
      },
      [&](double fraction) { progress.update(fraction); });
}

report::Json json_head(const char* kind, const MachineArguments& arguments,
                       const model::MachineFile& file, const report::PoseChoice& pose,
                       dynamics::ModelKind model) {
  return {{"kind", kind},
          {"machine", report::machine_json(file, arguments.file)},
          {"assumptions", report::assumptions_json(file.machine)},
          {"pose", report::pose_json(pose)},
          {"model", dynamics::name(model)}};
}

}  // namespace

void add_system_options(Command command, SystemArguments& arguments) {
  command.add_flag("--system", arguments.system,
                   "Poles of everything: mechanics, hydraulics, controller, delay");
  command.add_flag("--open-loop", arguments.open_loop,
                   "The same without the controller: the poles that are seen from the drives on");
  command
      .add_option("--root-locus", arguments.root_locus,
                  "KEY=from:to:count: those poles over one number of the file (SI)")
      .type_name("KEY=from:to:count");
  command
      .add_option("--pade", arguments.pade,
                  "Order of the approximation of the delay, 0 (no delay) to 8")
      .range(0, 8)
      .capture_default_str();
  command.add_option("--plot", arguments.plot,
                     "Picture of the root locus, .svg, .png or .pdf (needs gnuplot)");
}

std::string system_modes_text(const MachineArguments& arguments, const SystemArguments& system,
                              std::size_t format, bool colour, std::size_t width) {
  const bool is_locus = !system.root_locus.empty();
  const auto range = is_locus ? locus_range(system.root_locus) : LocusRange{};
  if (!system.plot.empty()) report::require_picture_ending(system.plot);
  const auto file = load(arguments);
  const auto pose = choose_pose(file.machine, arguments.pose);
  const simulation::LinearSystemOptions options{.kind = choose_model(file.machine, arguments.model),
                                                .pade_order = system.pade,
                                                .closed = !system.open_loop};
  if (is_locus) {
    const auto locus = computed_locus(arguments, range, file, pose, options);
    if (!system.plot.empty()) {
      report::plot_root_locus(locus, file.machine.name,
                              fmt::format("root locus over {}; pose {}, {} model", locus.key,
                                          pose.name, dynamics::name(options.kind)),
                              system.plot);
      fmt::print(stderr, "wrote {}\n", system.plot);
    }
    if (format == 2) return report::root_locus_csv(locus);
    if (format == 0)
      return fmt::format("{}, pose {}: poles over {}\n\n",
                         styled(file.machine.name, Style::bold, colour), pose.name, locus.key) +
             locus_table(locus, colour, width);
    auto json = json_head("root_locus", arguments, file, pose, options.kind);
    json.update(report::root_locus_json(locus));
    return json.dump() + "\n";
  }
  const auto linear = simulation::linear_system(file.machine, pose.X_BP, options);
  const auto poles = simulation::system_poles(linear);
  if (format == 2) return report::system_poles_csv(poles);
  if (format == 0)
    return system_heading(file.machine, pose, options.kind, linear, options.closed, colour) + "\n" +
           pole_table(poles, options.closed, colour, width) + "\n" +
           (options.closed ? report::verdict_text(linear, poles) : open_verdict(linear, poles)) +
           "\n";
  auto json = json_head("system", arguments, file, pose, options.kind);
  if (options.closed) {
    const auto tuning = simulation::tune_controller(file.machine, pose.X_BP);
    json["controller"] = report::controller_json(tuning.parameters, tuning.lowest_oil_mode);
  }
  json.update(report::system_poles_json(linear, poles));
  return json.dump(1) + "\n";
}

}  // namespace hydrapod::cli
