/// Events within steps of co-simulation, values within steps, parameters that are tuned.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "exchange/fmu_subject.hpp"
#include "hydrapod/model/parameters.hpp"

namespace hydrapod::test {
namespace {

/// Valves wholly open until the pistons reach their stops.
class EarlyReturn : public testing::Test {
 protected:
  EarlyReturn() : subject_({FmuVersion::fmi3, true}) {}

  [[nodiscard]] std::unique_ptr<Slave> opened(const Importer& importer) const {
    auto slave = std::make_unique<Slave>(subject_.fmu, true, true, 1e-10, importer);
    if (importer.event_mode) {
      EXPECT_EQ(ok, slave->call("fmi3EnterStepMode"));
    }
    for (int i = 1; i <= 6; ++i)
      EXPECT_EQ(ok, slave->set("leg" + std::to_string(i) + ".valve_command", opening(i)));
    return slave;
  }
  static double opening(int leg) { return leg == 3 ? 1.0 : 0.93; }

  /// When the first piston reaches its stop, as CVODE's root finding has it.
  [[nodiscard]] simulation::EventRecord expected() const {
    Integrator reference(subject_.plant, {.method = simulation::Method::cvode_adams,
                                          .relative_tolerance = 1e-11,
                                          .absolute_tolerance = 1e-11});
    reference.start(0.0, subject_.rest.x);
    PlantInput input;
    for (int i = 1; i <= 6; ++i) input.command[i - 1] = opening(i);
    double time = 0.0;
    while (reference.events().empty() && time < 10.0) reference.advance(time += 0.01, input);
    EXPECT_FALSE(reference.events().empty());
    return reference.events().front();
  }

  Subject subject_;
};

TEST_F(EarlyReturn, IsAtTheEvent) {
  const auto event = expected();
  ASSERT_EQ(Plant::Event::extended, event.event);
  const auto slave = opened({.event_mode = true, .early_return = true});
  Reached reached;
  ASSERT_EQ(ok, slave->step(0.0, 10.0, reached));
  EXPECT_TRUE(reached.early);
  EXPECT_TRUE(reached.event);
  EXPECT_FALSE(reached.terminate);
  EXPECT_NEAR(event.time, reached.time, 1e-7);
  EXPECT_EQ(reached.time, slave->get("time"));
  const auto indicator = "leg" + std::to_string(event.leg + 1) + ".event.extended";
  EXPECT_LT(slave->get(indicator), 0.0);
  EXPECT_GT(slave->get(indicator), -1e-8);
  EXPECT_EQ(ok, slave->call("fmi3EnterEventMode"));
  EXPECT_EQ(ok, slave->call("fmi3EnterStepMode"));
  const double before = reached.time;
  ASSERT_EQ(ok, slave->step(before, 0.5e-3, reached));  // and on from there
  EXPECT_GT(reached.time, before);
}

TEST_F(EarlyReturn, IsNotDoneWhereItIsNotAllowed) {
  const double time = expected().time;
  const auto slave = opened({.event_mode = true});
  Reached reached;
  ASSERT_EQ(ok, slave->step(0.0, time + 0.01, reached));
  EXPECT_FALSE(reached.early);
  EXPECT_FALSE(reached.event);
  EXPECT_NEAR(time + 0.01, reached.time, 1e-12);
  const auto without_events = opened({.early_return = true});
  ASSERT_EQ(ok, without_events->step(0.0, time + 0.01, reached));
  EXPECT_TRUE(reached.early);
  EXPECT_FALSE(reached.event);  // there is no event mode to handle it
}

/// A ramp of the wrench, given within one long step.
struct Ramp {
  const Slave* slave{};
  unsigned reference{};
  std::optional<double> stop{};
  std::vector<double> heights{};
  static double force(double time) { return 3e5 * time + 17.0; }
  static void update(void* self, double time, bool set, bool get, bool finished, bool early,
                     bool* requested, double* until) {
    auto& ramp = *static_cast<Ramp*>(self);
    EXPECT_TRUE(set && get && finished);
    ramp.heights.push_back(ramp.slave->get("pose.z"));
    EXPECT_EQ(ok, ramp.slave->set(std::vector{ramp.reference}, {force(time)}));
    if (!ramp.stop || time < 0.004) return;
    EXPECT_TRUE(early);
    *requested = true;
    *until = *ramp.stop;
  }
};

TEST(IntermediateUpdate, TakesInputsWithinAStep) {
  const Subject subject({FmuVersion::fmi3, true});
  const auto force = subject.fmu.reference("wrench.fz"), height = subject.fmu.reference("pose.z");
  Ramp ramp{.reference = force};
  const Slave slave(subject.fmu, true, true, 1e-9,
                    {.early_return = true,
                     .intermediate_variables = {force, height},
                     .intermediate_update = &Ramp::update,
                     .environment = &ramp});
  ramp.slave = &slave;
  ASSERT_EQ(ok, slave.set("wrench.fz", Ramp::force(0.0)));
  Reached reached;
  ASSERT_EQ(ok, slave.step(0.0, 0.02, reached));
  EXPECT_FALSE(reached.early);
  ASSERT_EQ(20U, ramp.heights.size());

  const Slave steps(subject.fmu, true, true, 1e-9);
  for (int k = 0; k < 20; ++k) {
    ASSERT_EQ(ok, steps.set("wrench.fz", Ramp::force(sample * k)));
    ASSERT_EQ(ok, steps.step(sample * k, sample));
    EXPECT_NEAR(steps.get("pose.z"), ramp.heights[static_cast<std::size_t>(k)], 1e-13);
  }
  EXPECT_NE(ramp.heights.front(), ramp.heights.back());

  ramp.stop = 0.0243;
  ASSERT_EQ(ok, slave.step(0.02, 0.02, reached));
  EXPECT_TRUE(reached.early);
  EXPECT_NEAR(0.0243, reached.time, 1e-12);
  EXPECT_FALSE(reached.event || reached.terminate);
}

TEST(IntermediateUpdate, ReachesNothingThatWasNotAskedFor) {
  const Subject subject({FmuVersion::fmi3, true});
  const auto update = [](void* self, double, bool, bool, bool, bool, bool*, double*) {
    EXPECT_EQ(error, (*static_cast<const Slave**>(self))->set("wrench.fx", 1.0));
  };
  const Slave* self = nullptr;
  const Slave slave(subject.fmu, true, true, 1e-6,
                    {.intermediate_update = update, .environment = &self});
  self = &slave;
  EXPECT_EQ(error, slave.step(0.0, 1e-3));
  const auto& fmu = subject.fmu;
  const unsigned parameter = fmu.reference("platform.mass");  // not of those that can be asked for
  EXPECT_EQ(nullptr, fmu.call<void*>("fmi3InstantiateCoSimulation", "one", fmu.token.c_str(),
                                     fmu.resources().c_str(), false, false, false, false,
                                     &parameter, std::size_t{1}, static_cast<void*>(nullptr),
                                     &ignore_message_3, static_cast<IntermediateUpdate>(update)));
}

/// Machines that differ in what their parameters mean for lengths at rest.
std::vector<model::Machine> machines_to_tune() {
  return {machine_of("heavy-platform"),
          machine_of("heavy-platform", {"legs.gimbal_stiffness=\"200 kN/mm\""}),
          machine_of(
              "heavy-platform",
              {"base.mount.stiffness.x=\"800 kN/mm\"", "base.mount.stiffness.z=\"900 kN/mm\"",
               "base.mount.mass=\"5 t\"", "base.mount.inertia=[4000, 4000, 4000]",
               "legs.friction.coulomb=\"300 N\"", "legs.friction.bristles.stiffness=\"20 kN/mm\"",
               "supply.pump_flow=\"400 l/min\""}),
          machine_of("zhang-jiang-2021-transverse")};
}

/// Their names in the model description of FMI 3.0.
std::vector<std::string> tunable(const Unpacked& fmu) {
  std::vector<std::string> names;
  const std::regex one("name=\"([^\"]*)\"[^>]*variability=\"tunable\"");
  for (std::sregex_iterator at(fmu.description.begin(), fmu.description.end(), one), end; at != end;
       ++at)
    names.push_back((*at)[1]);
  return names;
}

/// Where a piston or the platform stands, what pressures and spools are, and the oil's force must
/// not jump with any parameter that can be tuned; what the springs and masses do must change.
TEST(FmuTuning, MovesNothingAtOnce) {
  for (const auto& machine : machines_to_tune()) {
    const Unpacked fmu(archive_of(machine, FmuVersion::fmi3, true));
    const auto names = tunable(fmu);
    EXPECT_GT(names.size(), 80U);
    std::vector<unsigned> kept, moving;
    for (const auto& [name, reference] : fmu.references) {
      const auto has = [&](const char* end) { return name.ends_with(end); };
      if (name.starts_with("pose.") || has(".length") || has(".piston") || has(".p_cap") ||
          has(".spool") || has(".oil_force") || has(".event.extended"))
        kept.push_back(reference);
      if (name.starts_with("der(")) moving.push_back(reference);
    }
    const Slave slave(fmu, true);
    Random random(9);
    for (int i = 1; i <= 6; ++i)
      ASSERT_EQ(ok,
                slave.set("leg" + std::to_string(i) + ".valve_command", random.uniform(-0.3, 0.3)));
    for (int k = 0; k < 50; ++k) ASSERT_EQ(ok, slave.step(sample * k, sample));
    const auto before = slave.get(kept), rates = slave.get(moving);
    int effective = 0;
    for (const auto& name : names) {
      const double value = slave.get(name);
      const double other = value != 0.0 ? 1.003 * value : 1e-3;
      const int status = slave.set(name, other);
      if (status == discard) continue;  // an inertia or a breakaway force that needs its partner
      ASSERT_EQ(ok, status) << name;
      const auto after = slave.get(kept);
      for (std::size_t k = 0; k < kept.size(); ++k)
        EXPECT_NEAR(before[k], after[k], 1e-11 * std::max(1.0, std::abs(before[k]))) << name;
      if (slave.get(moving) != rates) ++effective;
      ASSERT_EQ(ok, slave.set(name, value));
      EXPECT_EQ(rates, slave.get(moving)) << name;
    }
    EXPECT_GT(effective, 60) << machine.name;
  }
}

/// From the present state on, it is the plant with the other numbers; a saved state brings them
/// along.
TEST(FmuTuning, ContinuesAsTheMachineWithTheOtherNumbers) {
  const Subject subject({FmuVersion::fmi2, true});
  const Slave slave(subject.fmu, true, true, 1e-10), other(subject.fmu, true);
  Random random(12);
  const auto inputs = subject.noise(random);
  ASSERT_EQ(ok, slave.set(subject.inputs, inputs));
  for (int k = 0; k < 30; ++k) ASSERT_EQ(ok, slave.step(sample * k, sample));
  const auto x = slave.get(subject.states);
  const std::vector<std::pair<std::string, std::string>> changes{
      {"platform.mass", "platform.mass"},
      {"leg2.valve.natural_frequency", "leg.2.valve.natural_frequency"},
      {"leg5.guide_sleeve.stiffness", "leg.5.guide_sleeve.stiffness"},
      {"supply.pressure", "supply.pressure"}};
  std::vector<model::Assignment> assignments;
  for (const auto& [name, path] : changes) {
    const auto id = *model::find_parameter(subject.machine, path);
    assignments.push_back({id, 1.07 * *model::value(subject.machine, id)});
    ASSERT_EQ(ok, slave.set(name, assignments.back().value));
  }
  EXPECT_EQ(x, slave.get(subject.states));
  void* state = nullptr;
  ASSERT_EQ(ok, slave.call("fmi2GetFMUstate", &state));
  ASSERT_EQ(ok, other.call("fmi2SetFMUstate", state));
  const Plant changed(model::with(subject.machine, assignments), dynamics::ModelKind::guide,
                      {.oil_springs = false});
  Integrator reference(changed, {.method = simulation::Method::cvode_adams,
                                 .relative_tolerance = 1e-11,
                                 .absolute_tolerance = 1e-11});
  reference.start(sample * 30, Eigen::Map<const Eigen::VectorXd>(x.data(), changed.layout().size));
  Difference difference;
  for (int k = 30; k < 130; ++k) {
    ASSERT_EQ(ok, slave.step(sample * k, sample));
    ASSERT_EQ(ok, other.step(sample * k, sample));
    reference.advance(sample * (k + 1), subject.input(inputs));
    difference.add(reference.state(), slave.get(subject.states).data());
  }
  EXPECT_LT(difference.relative(changed.scales()), 1e-6);
  EXPECT_EQ(slave.get(subject.states), other.get(subject.states));
  EXPECT_EQ(slave.get("platform.mass"), other.get("platform.mass"));
  ASSERT_EQ(ok, slave.call("fmi2FreeFMUstate", &state));
}

}  // namespace
}  // namespace hydrapod::test
