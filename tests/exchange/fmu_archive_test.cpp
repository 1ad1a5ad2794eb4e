/// What stands in an FMU: rules of the standard, the shared object, the structure.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "exchange/fmu_driver.hpp"
#include "exchange/fmu_interface.hpp"
#include "support/loop_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using exchange::FmuVersion;
using simulation::machine_of;

/// With everything that has states: bristles, a pump, a damped mount, compliant gimbals.
model::Machine rich_machine() {
  return machine_of(
      "heavy-platform",
      {"legs.friction.coulomb=\"300 N\"", "legs.friction.bristles.stiffness=\"20 kN/mm\"",
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
      }
  };
  add(machine_of("heavy-platform"), dynamics::ModelKind::guide);
  add(rich_machine(), dynamics::ModelKind::rigid);
  add(random_machine(random, {.gravity = Gravity::down}), dynamics::ModelKind::full);
  const auto run = run_program("/usr/bin/python3", arguments);
  EXPECT_EQ(0, run.exit_code) << run.out << run.err;
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
        .input_start = std::vector<double>(exchange::fmu_inputs, 0.1)};
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

  const auto loop = run_hydrapod({"export", model, "--to", "fmu2", "--system", "loop", "-o", file});
  EXPECT_EQ(2, loop.exit_code);
  EXPECT_THAT(loop.err, testing::HasSubstr("expected plant or mechanics"));
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
void expect_true_structure(const model::Machine& machine, bool hydraulics,
                           dynamics::ModelKind kind) {
  const Unpacked fmu(archive_of(machine, FmuVersion::fmi3, hydraulics, kind));
  const auto listed = dependencies_in(fmu.description);
  ASSERT_GT(listed.size(), 40U);
  const Slave slave(fmu, false);
  slave.enter_continuous_time();
  exchange::FmuMachine held{.machine = machine,
                            .kind = kind,
                            .hydraulics = hydraulics,
                            .input_start = std::vector<double>(exchange::fmu_inputs)};
  const simulation::Plant plant(machine, kind, held.options());
  const auto interface = exchange::fmu_interface(held, plant);
  const int n = plant.layout().size;
  const unsigned first = static_cast<unsigned>(interface.first(exchange::FmuRole::state));
  std::vector<double> rest(static_cast<std::size_t>(n));
  ASSERT_EQ(ok, slave.states(rest.data(), rest.size()));
  std::vector<unsigned> unknowns;
  for (const auto& [unknown, on] : listed) unknowns.push_back(unknown);

  Random random(7);
  std::set<std::pair<unsigned, unsigned>> seen;
  std::map<std::pair<unsigned, unsigned>, double> slopes;
  for (int state = 0; state < 6; ++state) {
    auto x = rest;
    for (int k = 0; k < n; ++k)
      x[static_cast<std::size_t>(k)] += 0.3 * plant.scales()[k] * random.uniform(-1.0, 1.0);
    std::vector<double> inputs(12);
    for (int k = 0; k < 12; ++k)
      inputs[static_cast<std::size_t>(k)] =
          random.uniform(-0.5, 0.5) * (k < 6 && hydraulics ? 1.0 : 500.0);
    const auto values_at = [&](const std::vector<double>& states, const std::vector<double>& u) {
      EXPECT_EQ(ok, slave.set_states(states));
      std::vector<unsigned> references(12);
      for (unsigned k = 0; k < 12; ++k) references[k] = 1 + k;
      EXPECT_EQ(ok, slave.set(references, u));
      return slave.get(unknowns);
    };
    const auto before = values_at(x, inputs);
    for (unsigned known = 1; known < first + static_cast<unsigned>(n); ++known) {
      auto moved_x = x, moved_u = inputs;
      const bool is_input = known < first;
      auto& moved = is_input ? moved_u[known - 1] : moved_x[known - first];
      const double change = is_input ? 0.01 * (std::abs(moved) + 1.0)
                                     : 0.01 * plant.scales()[static_cast<int>(known - first)];
      moved += change;
      const auto after = values_at(moved_x, moved_u);
      for (std::size_t u = 0; u < unknowns.size(); ++u) {
        if (after[u] == before[u]) continue;
        const auto& on = listed.at(unknowns[u]);
        const auto found = on.find(known);
        ASSERT_TRUE(found != on.end()) << interface.variables[unknowns[u]].name << " depends on "
                                       << interface.variables[known].name;
        const auto pair = std::pair{unknowns[u], known};
        seen.insert(pair);
        if (found->second != "constant") continue;
        const double slope = (after[u] - before[u]) / change;
        const double tolerance = 1e-6 * std::abs(slope);
        EXPECT_NEAR(slopes.try_emplace(pair, slope).first->second, slope, tolerance);
      }
    }
  }
  for (const auto& [unknown, on] : listed)
    for (const auto& [known, word] : on) {
      const auto& name = interface.variables[unknown].name;
      if (name.ends_with("stop_force")) continue;  // 0 off the stops
      EXPECT_TRUE(seen.contains({unknown, known}))
          << name << " never changes with " << interface.variables[known].name;
    }
}

TEST(FmuArchive, TheStructureIsTrueWithHydraulics) {
  expect_true_structure(rich_machine(), true, dynamics::ModelKind::guide);
}

TEST(FmuArchive, TheStructureIsTrueOfTheMechanics) {
  Random random(11);
  expect_true_structure(random_machine(random, {.gravity = Gravity::down}), false,
                        dynamics::ModelKind::full);
}

}  // namespace
}  // namespace hydrapod::test
