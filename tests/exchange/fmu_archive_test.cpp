/// What stands in an FMU: rules of the standard, the shared object, the structure.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "exchange/fmu_driver.hpp"
#include "exchange/fmu_interface.hpp"
#include "support/bending_machine.hpp"
#include "support/electric_platform.hpp"
#include "support/loop_machine.hpp"
#include "support/payload_modes.hpp"
#include "support/random_machine.hpp"
#include "support/softening_machine.hpp"

namespace hydrapod::test {
namespace {

using exchange::FmuVersion;
using simulation::machine_of;

/// With everything that has states: bristles of seals and joints, a pump, a damped mount, compliant
/// gimbals.
model::Machine rich_machine() {
  return machine_of(
      "heavy-platform",
      {"legs.friction.coulomb=\"300 N\"", "legs.friction.bristles.stiffness=\"20 kN/mm\"",
       "legs.joint_friction.coulomb=40", "leg.2.joint_friction.bristle_stiffness=3e5",
       "leg.5.joint_friction.bristle_stiffness=2e5", "leg.5.joint_friction.bristle_damping=70",
       "supply.pump_flow=\"400 l/min\"", "legs.gimbal_stiffness=\"200 kN/mm\"",
       "base.mount.stiffness.x=\"800 kN/mm\"", "base.mount.stiffness.rz=\"900 MN m/rad\"",
       "base.mount.mass=\"5 t\"", "damping.modal_ratio=0.01",
       "base.mount.inertia=[4000, 4000, 4000]"});
}

TEST(FmuArchive, KeepsTheRulesOfTheStandards) {
  Random random(23);
  TemporaryFolder folder;
  std::vector<std::string> arguments{source_file("tests/exchange/fmu_rules.py").string()};
  const auto add = [&](const model::Machine& machine, dynamics::ModelKind kind) {
    for (const auto version : {FmuVersion::fmi2, FmuVersion::fmi3})
      for (const bool hydraulics : {true, false}) {
        arguments.push_back((folder / std::to_string(arguments.size())).string() + ".fmu");
        base::write_file_whole(arguments.back(), archive_of(machine, version, hydraulics, kind));
        if (!hydraulics) continue;
        arguments.push_back((folder / std::to_string(arguments.size())).string() + ".fmu");
        base::write_file_whole(
            arguments.back(),
            archive_of(machine, {.version = version,
                                 .kind = kind,
                                 .controlled = true,
                                 .sources = exchange::fmu_sources(exchange::fmu_object_file())}));
      }
  };
  add(machine_of("heavy-platform"), dynamics::ModelKind::guide);
  add(rich_machine(), dynamics::ModelKind::rigid);
  add(electric_platform(), dynamics::ModelKind::guide);
  add(random_machine(random, {.gravity = Gravity::down}), dynamics::ModelKind::full);
  const auto run = run_program("/usr/bin/python3", arguments);
  EXPECT_EQ(0, run.exit_code) << run.out << run.err;
}

/// Names of the machine file are free, those of variables are not.
TEST(FmuArchive, CountsModesOfThePayloadWhoseNamesAreNoIdentifiers) {
  Random random(29);
  auto machine = machine_of("heavy-platform");
  put_modes_on(machine, 3, random);
  machine.payload_modes[0].name = "mode_2";
  machine.payload_modes[1].name = "mast \xC3\xB6";
  machine.payload_modes[2].name = "a.b";
  TemporaryFolder folder;
  const auto file = (folder / "named.fmu").string();
  const auto archive = archive_of(machine, FmuVersion::fmi2, true);
  base::write_file_whole(file, archive);
  const auto run =
      run_program("/usr/bin/python3", {source_file("tests/exchange/fmu_rules.py").string(), file});
  EXPECT_EQ(0, run.exit_code) << run.out << run.err;
  const Unpacked fmu(archive);
  for (const char* name :
       {"payload.mode_2", "payload.mode_2_", "payload.mode_3_rate", "payload_modes.mode_2.mass",
        "payload_modes.mode_2_.position[1]", "payload_modes.mode_3.frequency"})
    EXPECT_EQ(1U, fmu.references.count(name)) << name;
}

TEST(FmuArchive, TheSharedObjectNeedsTheCLibraryAloneAndShowsTheInterfaceAlone) {
  const auto object = exchange::fmu_object_file();
  std::istringstream dynamic(run_program("readelf", {"-dW", object}).out);
  std::set<std::string> needed;
  for (std::string line; std::getline(dynamic, line);)
    if (line.find("(NEEDED)") != std::string::npos)
      needed.insert(line.substr(line.find('[') + 1, line.find(']') - line.find('[') - 1));
  // the loader is a part of glibc, which thread-local variables ask for their place
  const std::set<std::string> expected{"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2"};
  EXPECT_TRUE(std::ranges::includes(expected, needed)) << testing::PrintToString(needed);
  EXPECT_TRUE(needed.contains("libc.so.6"));

  std::istringstream symbols(run_program("nm", {"-D", "--defined-only", object}).out);
  int shown = 0;
  for (std::string line; std::getline(symbols, line); ++shown)
    EXPECT_THAT(line, testing::ContainsRegex(" fmi[23][A-Z]"));
  EXPECT_GT(shown, 100);
}

TEST(FmuArchive, EqualMachinesGiveEqualBytesAndAnyOtherAnotherToken) {
  const auto machine = machine_of("heavy-platform");
  EXPECT_EQ(archive_of(machine, FmuVersion::fmi2, true),
            archive_of(machine, FmuVersion::fmi2, true));
  auto other = machine;
  other.platform.mass = std::nextafter(other.platform.mass, 1e9);
  const Unpacked one(archive_of(machine, FmuVersion::fmi2, true));
  const Unpacked two(archive_of(other, FmuVersion::fmi2, true));
  EXPECT_NE(one.token, two.token);
  void* instance =
      two.call<void*>("fmi2Instantiate", "one", 1, one.token.c_str(), two.resources().c_str(),
                      static_cast<const Callbacks*>(nullptr), 0, 0);
  EXPECT_EQ(nullptr, instance);
}

TEST(FmuArchive, ItsMachineIsThatOfTheFile) {
  Random random(5);
  for (int k = 0; k < 10; ++k) {
    const exchange::FmuMachine fmu{
        .machine =
            k == 0 ? rich_machine()
                   : random_machine(random, {.axes = k % 2 == 0 ? model::FlexibleAxes::gimbal
                                                                : model::FlexibleAxes::transverse,
                                             .piston_ring = k % 3 == 0}),
        .token = "token",
        .input_start = std::vector<double>(12, 0.1)};
    const auto text = exchange::fmu_machine_text(fmu);
    const auto back = exchange::read_fmu_machine(text);
    EXPECT_EQ(text, exchange::fmu_machine_text(back));
    const simulation::Plant given(fmu.machine, fmu.kind), read(back.machine, back.kind);
    const auto rest = given.equilibrium(fmu.machine.neutral());
    EXPECT_EQ(rest.x, read.equilibrium(back.machine.neutral()).x);
  }
}

TEST(FmuArchive, IsWhatTheProgramWrites) {
  const TemporaryFolder folder;
  const auto model = source_file("models/heavy-platform.toml").string();
  const auto file = (folder / "machine.fmu").string();
  const auto run =
      run_hydrapod({"export", model, "--to", "fmu3", "--system", "mechanics", "-o", file});
  ASSERT_EQ(0, run.exit_code) << run.err;
  EXPECT_THAT(run.out, testing::HasSubstr("forces along the legs"));
  const Unpacked fmu(read_text(file));
  EXPECT_EQ(1U, fmu.references.count("leg6.axial_force"));
  const Slave slave(fmu, true);
  EXPECT_EQ(ok, slave.step(0.0, 1e-3));

  const auto loop =
      run_hydrapod({"export", model, "--to", "fmu2", "--system", "loop", "-o", file, "--force"});
  ASSERT_EQ(0, loop.exit_code) << loop.err;
  EXPECT_THAT(loop.out, testing::HasSubstr("without noise, range and resolution"));
  const Unpacked controlled(read_text(file));
  EXPECT_EQ(1U, controlled.references.count("command_rate.rz"));
  EXPECT_TRUE(std::filesystem::exists(controlled.folder() + "/sources/fmu/loop.cpp"));
  const auto sampled = run_hydrapod({"export", model, "--to", "fmu2", "--sampled", "-o", file});
  EXPECT_EQ(2, sampled.exit_code);
}

/// The environment's schemas, where a developer has them: FMI_SCHEMAS names a folder with fmi2 and
/// fmi3, in which the files of the standards stand.
TEST(FmuArchive, KeepsTheSchemasOfTheStandards) {
  const char* schemas = std::getenv("FMI_SCHEMAS");
  if (schemas == nullptr) GTEST_SKIP() << "FMI_SCHEMAS is not set";
  const auto sources = exchange::fmu_sources(exchange::fmu_object_file());
  const auto validate = [&](const std::string& schema, const std::string& file) {
    const auto run =
        run_program("xmllint", {"--noout", "--schema", std::string(schemas) + "/" + schema, file});
    EXPECT_EQ(0, run.exit_code) << run.err.substr(0, 2000);
  };
  for (const bool controlled : {false, true}) {
    const Unpacked two(
        archive_of(rich_machine(),
                   {.version = FmuVersion::fmi2, .controlled = controlled, .sources = sources}));
    validate("fmi2/fmi2ModelDescription.xsd", two.folder() + "/modelDescription.xml");
    const Unpacked three(
        archive_of(rich_machine(),
                   {.version = FmuVersion::fmi3, .controlled = controlled, .sources = sources}));
    validate("fmi3/fmi3ModelDescription.xsd", three.folder() + "/modelDescription.xml");
    validate("fmi3/fmi3BuildDescription.xsd", three.folder() + "/sources/buildDescription.xml");
    validate("fmi3/fmi3TerminalsAndIcons.xsd",
             three.folder() + "/terminalsAndIcons/terminalsAndIcons.xml");
  }
}

/// FMPy's rules, and a run of both kinds by it, where a developer has it for python3.
TEST(FmuArchive, IsTakenByFmpy) {
  if (run_program("python3", {"-c", "import fmpy"}).exit_code != 0)
    GTEST_SKIP() << "there is no FMPy";
  const std::string script = R"(
import sys, fmpy
from fmpy.validation import validate_fmu
problems = validate_fmu(sys.argv[1])
runs = [fmpy.simulate_fmu(sys.argv[1], fmi_type=kind, solver='Euler', step_size=1e-4, stop_time=0.01,
                          output_interval=1e-3, output=['pose.z']) for kind in ('CoSimulation', 'ModelExchange')]
if problems or abs(runs[0][-1][1] - runs[1][-1][1]) > 1e-6:
    sys.exit('\n'.join(problems) + str(runs))
)";
  TemporaryFolder folder;
  const auto file = (folder / "machine.fmu").string();
  for (const auto version : {FmuVersion::fmi2, FmuVersion::fmi3})
    for (const bool controlled : {false, true}) {
      base::write_file_whole(file, archive_of(machine_of("heavy-platform"),
                                              {.version = version, .controlled = controlled}));
      const auto run = run_program("python3", {"-c", script, file});
      EXPECT_EQ(0, run.exit_code) << run.out << run.err;
    }
}

/// Dependencies of the elements in `text`, as value references.
std::map<unsigned, std::map<unsigned, std::string>> dependencies_in(const std::string& text) {
  std::map<unsigned, std::map<unsigned, std::string>> all;
  const std::regex element(
      "<(?:Output|ContinuousStateDerivative|EventIndicator) valueReference=\"(\\d+)\" "
      "dependencies=\"([^\"]*)\"(?: dependenciesKind=\"([^\"]*)\")?");
  for (std::sregex_iterator at(text.begin(), text.end(), element), end; at != end; ++at) {
    auto& of = all[static_cast<unsigned>(std::stoul((*at)[1]))];
    std::istringstream on((*at)[2].str()), kinds((*at)[3].str());
    unsigned reference{};
    for (std::string kind; on >> reference && kinds >> kind;) of[reference] = kind;
  }
  return all;
}

/// By changing every known at many states: what changes must be listed, what is listed must change
/// somewhere, and a constant factor must be the same everywhere.
class Structure {
 public:
  Structure(const model::Machine& machine, bool hydraulics, dynamics::ModelKind kind)
      : hydraulics_(hydraulics),
        fmu_(archive_of(machine, FmuVersion::fmi3, hydraulics, kind)),
        listed_(dependencies_in(fmu_.description)),
        slave_(fmu_, false),
        held_{.machine = machine,
              .kind = kind,
              .hydraulics = hydraulics,
              .input_start = std::vector<double>(12)},
        plant_(machine, kind, held_.options()),
        interface_(exchange::fmu_interface(held_, plant_)),
        first_(static_cast<unsigned>(interface_.first(exchange::FmuRole::state))),
        rest_(static_cast<std::size_t>(plant_.layout().size)) {
    slave_.enter_continuous_time();
    EXPECT_EQ(ok, slave_.states(rest_.data(), rest_.size()));
    EXPECT_GT(listed_.size(), 40U);
    for (const auto& [unknown, on] : listed_) unknowns_.push_back(unknown);
  }

  /// At another state.
  void probe(Random& random) {
    auto x = rest_;
    for (std::size_t k = 0; k < x.size(); ++k)
      x[k] += 0.3 * plant_.scales()[static_cast<int>(k)] * random.uniform(-1.0, 1.0);
    std::vector<double> inputs(12);
    for (std::size_t k = 0; k < inputs.size(); ++k)
      inputs[k] = random.uniform(-0.5, 0.5) * (k < 6 && hydraulics_ ? 1.0 : 500.0);
    const auto before = values_at(x, inputs);
    for (unsigned known = 1; known < first_ + x.size(); ++known) {
      auto moved_x = x, moved_inputs = inputs;
      const bool is_input = known < first_;
      auto& moved = is_input ? moved_inputs[known - 1] : moved_x[known - first_];
      const double change = is_input ? 0.01 * (std::abs(moved) + 1.0)
                                     : 0.01 * plant_.scales()[static_cast<int>(known - first_)];
      moved += change;
      compare(known, change, before, values_at(moved_x, moved_inputs));
    }
  }

  void expect_all_seen() const {
    for (const auto& [unknown, on] : listed_)
      for (const auto& [known, word] : on) {
        if (name(unknown).ends_with("stop_force")) continue;  // 0 off the stops
        if (turns_with_leg(name(unknown)) && is_speed(name(known))) continue;
        if (unknown_is_limited(name(unknown), name(known))) continue;
        EXPECT_TRUE(seen_.contains({unknown, known}))
            << name(unknown) << " never changes with " << name(known);
      }
  }

 private:
  /// States of seals have components in a frame that turns with the leg. All speeds of the leg are
  /// listed for them; some do not turn it, as that of the piston along t.
  static bool turns_with_leg(const std::string& name) {
    return name.find(".sleeve_") != std::string::npos || name.find(".ring_") != std::string::npos;
  }
  /// The integral of a speed loop stops where the torque is at its limit, which it is a part of.
  static bool unknown_is_limited(const std::string& unknown, const std::string& known) {
    return unknown.ends_with(".torque_integral)") && known.ends_with(".torque_integral");
  }
  static bool is_speed(const std::string& name) {
    return name.ends_with("_rate") || name == "vx" || name == "vy" || name == "vz";
  }
  [[nodiscard]] const std::string& name(unsigned reference) const {
    return interface_.variables[reference].name;
  }

  [[nodiscard]] std::vector<double> values_at(const std::vector<double>& x,
                                              const std::vector<double>& inputs) const {
    std::vector<unsigned> references(inputs.size());
    for (unsigned k = 0; k < references.size(); ++k) references[k] = 1 + k;
    EXPECT_EQ(ok, slave_.set_states(x));
    EXPECT_EQ(ok, slave_.set(references, inputs));
    return slave_.get(unknowns_);
  }

  void compare(unsigned known, double change, const std::vector<double>& before,
               const std::vector<double>& after) {
    for (std::size_t u = 0; u < unknowns_.size(); ++u) {
      if (after[u] == before[u]) continue;
      const auto& on = listed_.at(unknowns_[u]);
      const auto found = on.find(known);
      ASSERT_TRUE(found != on.end()) << name(unknowns_[u]) << " depends on " << name(known);
      const auto pair = std::pair{unknowns_[u], known};
      seen_.insert(pair);
      if (found->second != "constant") continue;
      const double slope = (after[u] - before[u]) / change;
      EXPECT_NEAR(slopes_.try_emplace(pair, slope).first->second, slope, 1e-6 * std::abs(slope));
    }
  }

  bool hydraulics_;
  Unpacked fmu_;
  std::map<unsigned, std::map<unsigned, std::string>> listed_;
  Slave slave_;
  exchange::FmuMachine held_;
  simulation::Plant plant_;
  exchange::FmuInterface interface_;
  unsigned first_;
  std::vector<double> rest_;
  std::vector<unsigned> unknowns_{};
  std::set<std::pair<unsigned, unsigned>> seen_{};
  std::map<std::pair<unsigned, unsigned>, double> slopes_{};
};

void expect_true_structure(const model::Machine& machine, bool hydraulics,
                           dynamics::ModelKind kind) {
  Structure structure(machine, hydraulics, kind);
  Random random(7);
  for (int state = 0; state < 6; ++state) structure.probe(random);
  structure.expect_all_seen();
}

TEST(FmuArchive, TheStructureIsTrueWithHydraulics) {
  expect_true_structure(rich_machine(), true, dynamics::ModelKind::guide);
}

/// Torques below their limits, with and without gimbals in series with the screws.
TEST(FmuArchive, TheStructureIsTrueWithElectricDrives) {
  auto machine = electric_platform();
  for (auto& leg : machine.legs) leg.screw->torque_limit = 2e4;
  expect_true_structure(machine, true, dynamics::ModelKind::guide);
  for (auto& leg : machine.legs) leg.gimbal_stiffness = 190e6;
  expect_true_structure(machine, true, dynamics::ModelKind::rigid);
}

/// Flows of lines, which leg 4 has none of, stand between valves and chambers.
TEST(FmuArchive, TheStructureIsTrueWithLines) {
  for (const auto& [gimbals, lines] : {std::pair{"", "lines.segments=2"},
                                       {"", "lines.modes=3"},
                                       {"legs.gimbal_stiffness=\"200 kN/mm\"", "lines.segments=2"},
                                       {"legs.gimbal_stiffness=\"200 kN/mm\"", "lines.modes=2"}}) {
    std::vector<std::string> overrides{lines,
                                       "legs.friction.coulomb=210 N",
                                       "supply.pump_flow=\"310 l/min\"",
                                       "legs.oil_spring.cylinder.cap_line_length=2.7",
                                       "leg.3.oil_spring.cylinder.rod_line_length=1.9",
                                       "leg.4.oil_spring.cylinder.cap_line_length=0"};
    if (*gimbals != '\0') overrides.emplace_back(gimbals);
    expect_true_structure(machine_of("heavy-platform", overrides), true,
                          dynamics::ModelKind::rigid);
  }
}

TEST(FmuArchive, TheStructureIsTrueOfTheMechanics) {
  Random random(11);
  expect_true_structure(random_machine(random, {.gravity = Gravity::down}), false,
                        dynamics::ModelKind::full);
}

TEST(FmuArchive, TheStructureIsTrueOfPayloadsThatVibrate) {
  Random random(31);
  auto machine = random_machine(random, {.gravity = Gravity::down});
  put_modes_on(machine, 2, random);
  expect_true_structure(machine, false, dynamics::ModelKind::guide);
}

/// Arms of the seals, and what says how soft they are: also where rods and cases bend in series.
TEST(FmuArchive, TheStructureIsTrueOfElastomers) {
  Random random(29);
  for (const auto axes : {model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal}) {
    const auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::down});
    expect_true_structure(with_softening(machine, 1.9e-4, 0.41), false, dynamics::ModelKind::full);
    const auto bending = bending_machine(random, {.axes = axes, .gravity = Gravity::down});
    expect_true_structure(with_softening(bending, 1.9e-4, 0.41), false, dynamics::ModelKind::guide);
  }
}

}  // namespace
}  // namespace hydrapod::test
