/// The archive of an FMU.

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "fmu_description.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "measured.hpp"
#include "zip.hpp"

namespace hydrapod::exchange {

namespace {

namespace fs = std::filesystem;

/// The machine with the pose as its last one.
Machine with_reference(Machine machine, const model::NamedPose& pose) {
  auto& poses = machine.poses;
  poses.erase(poses.begin() + 1, poses.end());
  const auto& neutral = poses.front().X_BP;
  if (neutral.p_BP != pose.X_BP.p_BP || neutral.R_BP != pose.X_BP.R_BP)
    poses.push_back({pose.name == poses.front().name ? "reference" : pose.name, pose.X_BP});
  return machine;
}

/// The same for the same machine and program, another one for any other.
std::string token_of(const FmuMachine& machine, FmuVersion version) {
  const auto text =
      fmu_machine_text(machine) + base::version + (version == FmuVersion::fmi3 ? "fmi3" : "fmi2");
  const auto sum = XXH3_128bits(text.data(), text.size());
  const auto high = sum.high64, low = sum.low64;
  return fmt::format("{{{:08x}-{:04x}-{:04x}-{:04x}-{:012x}}}", high >> 32U, high >> 16U & 0xFFFFU,
                     high & 0xFFFFU, low >> 48U, low & 0xFFFFFFFFFFFFU);
}

/// A name for a file and for C.
std::string identifier_of(const std::string& name) {
  constexpr std::size_t longest = 40;
  std::string result;
  for (const char c : name.substr(0, longest)) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    const bool digit = c >= '0' && c <= '9';
    if (letter || (digit && !result.empty()))
      result += c;
    else if (!result.empty() && result.back() != '_')
      result += '_';
  }
  while (!result.empty() && result.back() == '_') result.pop_back();
  return result.empty() ? "hydrapod" : result;
}

/// Why the machine does not stay at its rest while the inputs stay as they start; empty where it
/// does, but for the drift of valves that leak.
std::string instability_of(const FmuMachine& fmu) {
  if (fmu.controlled || !fmu.hydraulics)
    return simulation::instability(fmu.machine, fmu.reference(), fmu.kind, fmu.controlled);
  const auto poles = simulation::system_poles(simulation::linear_system(
      fmu.machine, fmu.reference(), {.kind = fmu.kind, .closed = false, .sampled = false}));
  if (poles.largest_real <= simulation::slowest_growth) return {};
  return fmt::format(
      "small motions grow, the fastest by e in {:.3g} s, while the commands of the "
      "actuators stay as they start",
      1.0 / poles.largest_real);
}

Parity parity_of(const FmuMachine& fmu, const std::string& instability, bool has_sources) {
  Parity parity{
      {Held::exact, "large motions of platform and legs, seals, end stops",
       "the equations of `hydrapod simulate`, doubles"},
      {Held::exact, "numbers of the machine file that the plant depends on",
       "parameters in SI units: what changes no length can be tuned during a simulation, all "
       "else is set before the FMU is initialized"}};
  if (!instability.empty())
    parity.push_back({Held::exact, "UNSTABLE at this pose", instability + "; so it is in the FMU"});
  if (fmu.drives())
    parity.push_back({Held::exact, "motors, screws, speed loops, friction",
                      fmu.controlled ? "commands of the drives come from the controller inside"
                                     : "inputs are the commands of the drives"});
  else if (fmu.hydraulics)
    parity.push_back({Held::exact, "chambers, valves, supply, friction",
                      fmu.controlled ? "valve commands come from the controller inside"
                                     : "inputs are the valve commands"});
  else
    parity.push_back({Held::exact, "forces along the legs",
                      "inputs; they stand for all of the hydraulics, also for the oil springs"});
  if (fmu.machine.base_mount)
    parity.push_back({Held::exact, "compliant base", "states of its motion"});
  if (!fmu.machine.payload_modes.empty())
    parity.push_back({Held::exact, "modes of the payload", "two states each"});
  parity.push_back({Held::approximate, "motion in co-simulation",
                    "within the tolerance that the environment gives, 1e-6 unless it gives one"});
  parity.push_back({Held::approximate, "derivatives for the environment",
                    "differences of order 4, within 1e-6 of the largest in their row"});
  if (fmu.controlled) {
    parity.push_back({Held::exact, "controller",
                      "sampled, with its delay and limits; tuned for the parameters at the start"});
    parity.push_back({Held::approximate, "sensors", "without noise, range and resolution"});
  } else {
    parity.push_back({Held::approximate, "controller and sensors",
                      "not in the FMU: it is the machine that a controller meets"});
  }
  parity.push_back({Held::approximate, "other computers",
                    has_sources ? "x86-64 Linux with glibc as it is; sources for others to compile"
                                : "x86-64 Linux with glibc; sources are not in the FMU"});
  return parity;
}

FmuMachine machine_of(const Machine& machine, const model::NamedPose& pose,
                      const FmuOptions& options) {
  FmuMachine made{.machine = with_reference(machine, pose),
                  .kind = options.kind,
                  .hydraulics = options.hydraulics,
                  .controlled = options.controlled};
  made.input_start.assign(static_cast<std::size_t>(made.inputs()), 0.0);
  return made;
}

/// The plant that the FMU makes of its numbers beside that of the machine, where all states are a
/// little off their rest.
ParityLine measured_equations(const std::string& numbers, const Machine& machine,
                              const model::NamedPose& pose) {
  const auto held = read_fmu_machine(numbers);
  const simulation::Plant own(machine, held.kind, held.options(), pose.X_BP),
      of_numbers(held.machine, held.kind, held.options(), held.reference());
  const auto rest = own.equilibrium(pose.X_BP);
  constexpr double a_little = 1e-3;
  Eigen::VectorXd x = rest.x;
  const auto scales = own.scales();
  for (Eigen::Index k = 0; k < x.size(); ++k)
    x[k] += (k % 2 == 0 ? a_little : -a_little) * scales[k];
  Eigen::VectorXd expected(x.size()), found(x.size());
  const bool both = own.derivative(0.0, x.data(), rest.input, expected.data()) &&
                    of_numbers.derivative(0.0, x.data(), rest.input, found.data());
  if (!both)
    return {Held::approximate, "derivatives of all states by the FMU's numbers",
            "not measured: the machine cannot be beside its rest"};
  const double difference =
      ((found - expected).array() / (expected.cwiseAbs() + scales).array()).abs().maxCoeff();
  constexpr double rounding = 1e-12;
  return measured("derivatives of all states by the FMU's numbers, measured", difference,
                  "those of `simulate`", rounding);
}

}  // namespace

Fmu fmu(const Machine& machine, const model::NamedPose& pose, const FmuOptions& options,
        const FileHead& head) {
  if (options.hydraulics) hydraulics::require_actuators(machine);
  auto held = machine_of(machine, pose, options);
  const simulation::Plant plant(held.machine, held.kind, held.options(), held.reference());
  const auto rest = plant.equilibrium(held.reference());
  for (int i = 0; i < model::leg_count && !held.controlled; ++i)
    held.input_start[static_cast<std::size_t>(i)] =
        options.hydraulics ? rest.input.command[i] : rest.input.axial[i];
  held.token = token_of(held, options.version);
  const auto interface = fmu_interface(held, plant);
  const FmuContent content{.machine = held,
                           .interface = interface,
                           .plant = plant,
                           .version = options.version,
                           .identifier = identifier_of(machine.name),
                           .title = head.title,
                           .object_size = options.object.size(),
                           .instability = instability_of(held),
                           .sources = options.sources};
  const bool three = options.version == FmuVersion::fmi3;
  ZipWriter zip;
  const auto add = [&](const std::string& name, const std::string& text) {
    zip.add(name, text, ZipWriter::Method::deflated);
  };
  add("modelDescription.xml", fmu_description(content));
  add(fmt::format("binaries/{}/{}.so", three ? "x86_64-linux" : "linux64", content.identifier),
      options.object);
  const auto numbers = fmu_machine_text(held);
  add("resources/machine.json", numbers);
  if (!options.sources.empty()) add("sources/buildDescription.xml", fmu_build_description(content));
  for (const auto& [name, text] : options.sources) add("sources/" + name, text);
  add("documentation/index.html", fmu_page(content));
  add("documentation/licenses/license.txt", options.notices);
  zip.add(three ? "terminalsAndIcons/icon.png" : "model.png", fmu_icon());
  if (three)
    add("terminalsAndIcons/terminalsAndIcons.xml",
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiTerminalsAndIcons fmiVersion=\"3.0\">\n"
        "  <GraphicalRepresentation>\n"
        "    <CoordinateSystem x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\" "
        "suggestedScalingFactorTo_mm=\"0.1\"/>\n"
        "    <Icon x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\"/>\n"
        "  </GraphicalRepresentation>\n</fmiTerminalsAndIcons>\n");
  auto parity = parity_of(held, content.instability, !options.sources.empty());
  parity.push_back(measured_equations(numbers, machine, pose));
  return {zip.bytes(), std::move(parity)};
}

/// From the folder of what this code is in, upwards: a build folder has apps/fmu, an installation
/// lib/hydrapod or a folder of lib with that.
std::string fmu_object_file() {
  Dl_info here{};
  if (dladdr(reinterpret_cast<const void*>(&fmu_object_file), &here) == 0 || !here.dli_fname)
    return {};
  std::error_code none;
  fs::path program = fs::read_symlink("/proc/self/exe", none);
  const fs::path shared = fs::canonical(here.dli_fname, none);
  for (const auto& start : {shared, program})
    for (fs::path folder = start.parent_path(); folder.has_relative_path();
         folder = folder.parent_path())
      for (const auto& inside : {fs::path("apps/fmu"), fs::path(HYDRAPOD_FMU_FOLDER)})
        if (const auto file = folder / inside / "hydrapod_fmu.so"; fs::is_regular_file(file, none))
          return file.string();
  return {};
}

}  // namespace hydrapod::exchange
