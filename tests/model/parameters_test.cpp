/// The table of parameters: every number of a machine once, reached by its path, and the manual and
/// the starter file as the table says.

#include "hydrapod/model/parameters.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

#include "hydrapod/model/machine_file.hpp"
#include "sound_machine.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod::model {
namespace {

/// A machine with every part that may be left out and that a hydraulic cylinder can have.
Machine whole_machine() {
  Machine machine = parse_machine(sound_machine_file, "m.toml").machine;
  for (const auto& row : parameter_table())
    for (int leg = 0;
         leg < leg_count && row.make != nullptr && belongs_to(LegType::cylinder, row.path); ++leg)
      for (int k = 0; k < row.numbers; ++k)
        row.make(machine, row.path.starts_with("leg") ? leg : 0, k);
  return machine;
}

/// Numbers of the machine's own, of single legs, and of poses: all but those that legs share.
std::vector<ParameterId> single_parameters(const Machine& machine) {
  auto ids = parameters(machine);
  std::erase_if(ids, [](const ParameterId& id) {
    return id.of == 0 && row_of(id).path.starts_with("legs.");
  });
  return ids;
}

/// Rotations are nine numbers that follow from three; a circle lays out joints.
bool is_derived(const ParameterId& id) {
  return row_of(id).find == nullptr || row_of(id).path.ends_with("gimbal_axis");
}

TEST(Parameters, EveryNumberIsFoundByItsPathAndNoTwoAreOne) {
  const Machine machine = whole_machine();
  std::set<std::string> paths;
  std::set<const double*> places;
  for (const auto& id : single_parameters(machine)) {
    const auto text = path(machine, id);
    EXPECT_TRUE(paths.insert(text).second) << text;
    const auto found = find_parameter(machine, text);
    ASSERT_TRUE(found) << text;
    EXPECT_EQ(*found, id) << text;
    if (row_of(id).find == nullptr) continue;
    const int index = id.of > 0 ? id.of - 1 : 0;
    EXPECT_TRUE(
        places.insert(row_of(id).find(const_cast<Machine&>(machine), index, id.element)).second)
        << text;
  }
}

/// A Machine is numbers, words and texts; every byte that is a number's is reached by a row. What
/// is not reached: rotations, and the elements of the tensor below its diagonal.
TEST(Parameters, EveryDoubleOfAMachineIsReachedByOneRow) {
  Machine machine = whole_machine();
  const auto inside = [&](const void* begin, std::size_t size,
                          const std::set<const double*>& places) {
    return std::count_if(places.begin(), places.end(), [&](const double* place) {
      const auto* at = reinterpret_cast<const char*>(place);
      return at >= begin && at < static_cast<const char*>(begin) + size;
    });
  };
  std::set<const double*> places;
  for (const auto& id : single_parameters(machine))
    if (row_of(id).find != nullptr)
      places.insert(row_of(id).find(machine, id.of > 0 ? id.of - 1 : 0, id.element));
  // bytes of the struct are doubles, but for words and the marks of optional parts, 8 bytes each
  const auto& leg = machine.legs[0];
  constexpr std::size_t marks_of_a_leg =
      1 /* ring */ + 2 /* oil spring */ + 3 /* cylinder */ + 1 /* stroke */ + 2 /* limits */ +
      1 /* gimbals */ + 2 /* valve */ + 1 /* leakage */ + 4 /* friction */ + 1 /* stops */ +
      1 /* area */ + 2 /* section of the case */ + 2 /* of the rod */ + 1 /* gap */ +
      2 /* elastomers */ + 8 /* what they follow from */ + 1 /* bending */ +
      1 /* bristles of the joints */ + sizeof(std::optional<Strut>) / sizeof(double) +
      sizeof(std::optional<Screw>) / sizeof(double);
  EXPECT_EQ(inside(&leg, sizeof(Leg), places) + marks_of_a_leg, sizeof(Leg) / sizeof(double));
  EXPECT_EQ(inside(&machine.platform, sizeof(Platform), places) + 3,
            sizeof(Platform) / sizeof(double));
  EXPECT_EQ(inside(&machine.base_mount, sizeof(BaseMount), places) + 6,
            sizeof(BaseMount) / sizeof(double));
  EXPECT_EQ(inside(&machine.damping, sizeof(Damping), places) + 2,
            sizeof(Damping) / sizeof(double));
  EXPECT_EQ(inside(&machine.sensors, sizeof(Sensors), places) + 6,
            sizeof(Sensors) / sizeof(double));
  EXPECT_EQ(inside(&machine.hydraulics, sizeof(Hydraulics), places) + 2,
            sizeof(Hydraulics) / sizeof(double));
}

TEST(Parameters, ANumberThatIsSetIsRead) {
  Machine machine = whole_machine();
  test::Random random(3);
  for (const auto& id : parameters(machine)) {
    if (is_derived(id)) continue;
    const double number = random.uniform(0.1, 0.9);
    // of two ways to say one thing, the last one stays
    const Machine changed = with(machine, std::array{Assignment{id, number}});
    EXPECT_EQ(value(changed, id), number) << path(machine, id);
  }
}

/// Paths, units, defaults, circles, rotations, single legs: what the file says with that value.
TEST(Parameters, AnAssignmentIsTheFileReadWithThatValue) {
  const auto file = read_machine_file(test::source_file("models/heavy-platform.toml"));
  test::Random random(11);
  int tried = 0;
  for (const auto& every : parameters(file.machine)) {
    const auto text = path(file.machine, every);
    const auto id = find_parameter(file, text);
    if (!id) continue;  // every leg has its own
    const double before = *value(file.machine, *id);
    const double number = before * random.uniform(0.93, 1.06) + (before == 0.0) * 0.01;
    MachineFile expected;
    try {
      expected = parse_machine(file.text, "t", {fmt::format("{}={:.17g}", text, number)}, {});
    } catch (const base::InputError&) {
      continue;  // not a machine with this value
    }
    const Machine machine = with(file.machine, std::array{Assignment{*id, number}});
    for (const auto& other : parameters(expected.machine))
      EXPECT_NEAR(*value(machine, other), *value(expected.machine, other),
                  1e-12 * (1.0 + std::abs(*value(machine, other))))
          << text << " changes " << path(file.machine, other);
    ++tried;
  }
  EXPECT_GE(tried, 250);
}

TEST(Parameters, OfAllLegsLeaveWhatOneLegSays) {
  const auto file = parse_machine(sound_machine_file, "m.toml");
  const auto id = find_parameter(file, "legs.guide_sleeve.stiffness");
  const auto own = find_parameter(file, "leg.5.guide_sleeve.stiffness");
  ASSERT_TRUE(id && own);
  const Machine machine =
      with(file.machine, std::array{Assignment{*own, 3.0}, Assignment{*id, 2.0}});
  EXPECT_EQ(machine.legs[0].guide_sleeve.stiffness, 2.0);
  EXPECT_EQ(machine.legs[2].guide_sleeve.stiffness, 4e6);  // as the file says of leg 3
  EXPECT_EQ(machine.legs[4].guide_sleeve.stiffness, 3.0);
}

TEST(Parameters, OfPartsThatAreLeftOutMakeThem) {
  const auto file = parse_machine(sound_machine_file, "m.toml");
  const auto set = [&](const char* path, double number) {
    return with(file.machine, std::array{Assignment{*find_parameter(file, path), number}});
  };
  EXPECT_FALSE(value(file.machine, *find_parameter(file, "legs.piston_ring.stiffness")));
  EXPECT_EQ(set("legs.piston_ring.stiffness", 7.0).legs[5].piston_ring.value().stiffness, 7.0);
  EXPECT_EQ(set("base.mount.stiffness.rz", 8.0).base_mount.value().stiffness[5], 8.0);
  const Machine spring = set("leg.2.oil_spring.stiffness", 9.0);
  EXPECT_EQ(spring.legs[1].oil_spring.stiffness, 9.0);
  EXPECT_FALSE(spring.legs[1].oil_spring.cylinder);
  EXPECT_TRUE(spring.legs[0].oil_spring.cylinder);
}

/// One number for a row of six goes to all six.
TEST(Parameters, OfAWholeRowGoToAllItsNumbers) {
  const auto file = parse_machine(sound_machine_file, "m.toml");
  const auto id = find_parameter(file, "controller.gain");
  ASSERT_TRUE(id);
  const Machine machine = with(file.machine, std::array{Assignment{*id, 7.3}});
  for (int k = 0; k < 6; ++k) {
    const auto one = find_parameter(file, fmt::format("controller.gain[{}]", k));
    ASSERT_TRUE(one);
    EXPECT_EQ(value(machine, *one), 7.3) << k;
  }
}

TEST(Parameters, OfACircleMoveTheJointsThatStandOnIt) {
  const auto file = parse_machine(
      edited({{"[leg.3.guide", "[leg.3]\nbase_joint = [1, 2, 3]\n[leg.3.guide"}}), "m.toml");
  const auto id = find_parameter(file, "base.joints.circle.radius");
  ASSERT_TRUE(id);
  const Machine machine = with(file.machine, std::array{Assignment{*id, 1.3}});
  EXPECT_DOUBLE_EQ(machine.legs[0].base_joint.norm(), 1.3);
  EXPECT_EQ(machine.legs[2].base_joint, Vector3(1, 2, 3));
}

TEST(Parameters, AreTheNumbersThatTheFileGives) {
  const auto file = parse_machine(sound_machine_file, "m.toml", {"legs.rod.mass=21 kg"});
  std::vector<std::string> given;
  for (const auto& number : file.given) {
    EXPECT_EQ(value(file.machine, number.id), number.value) << number.written;
    given.push_back(fmt::format("{}:{}", path(file.machine, number.id), number.line));
  }
  EXPECT_THAT(given, testing::IsSupersetOf({"environment.gravity:3", "base.joints.circle.radius:5",
                                            "platform.inertia.zz:11", "legs.gimbal_axis[1]:13",
                                            "leg.3.guide_sleeve.stiffness:36",
                                            "poses.tilted.rotation[0]:43", "legs.rod.mass:0"}));
  EXPECT_EQ(given.back(), "legs.rod.mass:0");
  EXPECT_EQ(find_parameter(file, "legs.rod.mas"), std::nullopt);
  EXPECT_EQ(nearest_parameter(file, "legs.rod.mas"), "legs.rod.mass");
}

/// What a row says of a key that is left out is what the machine has then.
TEST(Parameters, DefaultsInTheStarterFileAreThoseOfTheStructs) {
  std::string text = starter_machine_file();
  for (const auto& row : parameter_table()) {
    if (row.required || row.optional || row.in_use || row.in_code || row.find == nullptr) continue;
    const auto file = parse_machine(text, "starter.toml");
    const std::string key{row.path.substr(row.path.rfind('.') + 1)};
    SCOPED_TRACE(row.path);
    Machine fresh;
    row.make(fresh, 0, 0);
    if (row.example.empty()) continue;
    const auto set =
        parse_machine(text, "starter.toml", {fmt::format("{}={}", row.path, row.example)}, {});
    EXPECT_DOUBLE_EQ(*row.find(const_cast<Machine&>(set.machine), 0, 0), *row.make(fresh, 0, 0));
  }
}

/// Every table that the command prints stands in the manual, word by word.
TEST(Manual, HasTheTablesThatTheCommandPrints) {
  const std::string manual = test::read_text(test::source_file("docs/howto/machine-file.md"));
  std::istringstream lines(parameter_reference());
  std::string heading, table;
  int tables = 0;
  const auto check = [&] {
    if (table.empty()) return;
    EXPECT_NE(manual.find("\n" + table + "\n"), std::string::npos)
        << "docs/howto/machine-file.md, " << heading
        << "\nis not as `hydrapod init --reference` prints it:\n"
        << table;
    ++tables;
    table.clear();
  };
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("|")) {
      table += line + "\n";
    } else if (!line.empty()) {
      check();
      heading = line;
    }
  }
  check();
  EXPECT_GE(tables, 25);
}

}  // namespace
}  // namespace hydrapod::model
