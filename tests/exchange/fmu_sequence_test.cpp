/// Every call at every place of the call sequence: allowed or answered by an error, as the tables
/// of FMI 2.0.4 (3.2.3, 4.2.4) and the state machines of FMI 3.0 (2.3, 3.2, 4.2) say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>

#include "exchange/fmu_driver.hpp"
#include "support/loop_machine.hpp"

namespace hydrapod::test {
namespace {

using exchange::FmuVersion;
using simulation::machine_of;

/// Places, as letters of a table: Instantiated, iNitialization, Event, Continuous, Step, eVent mode
/// of co-simulation (FMI 3.0), Terminated, Failed (after an error).
struct Row {
  const char* function;
  std::string allowed;  ///< elsewhere it is an error
  std::function<int(const Slave&, const char*)> call;
};

class Sequence : public testing::TestWithParam<FmuVersion> {
 protected:
  static const Unpacked& fmu(FmuVersion version) {
    static const Unpacked two(archive_of(machine_of("heavy-platform"), FmuVersion::fmi2, true));
    static const Unpacked three(archive_of(machine_of("heavy-platform"), FmuVersion::fmi3, true));
    return version == FmuVersion::fmi2 ? two : three;
  }
  [[nodiscard]] const Unpacked& fmu() const { return fmu(GetParam()); }
  [[nodiscard]] bool three() const { return GetParam() == FmuVersion::fmi3; }

  /// An instance at that place.
  [[nodiscard]] std::unique_ptr<Slave> at(char place) const {
    const bool co_simulation = place == 'S' || place == 'V';
    auto made = std::make_unique<Slave>(fmu(), co_simulation, false, 1e-6,
                                        Importer{.event_mode = place == 'V'});
    const auto expect = [&](int status) { EXPECT_EQ(ok, status) << place; };
    if (place == 'I') return made;
    if (place == 'N') {
      expect(three() ? made->call("fmi3EnterInitializationMode", false, 0.0, 0.0, false, 0.0)
                     : made->call("fmi2EnterInitializationMode"));
      return made;
    }
    made->begin(1e-6);
    if (place == 'C') made->enter_continuous_time();
    if (place == 'T') expect(made->call(three() ? "fmi3Terminate" : "fmi2Terminate"));
    if (place == 'F') made->set("pose.x", 1.0);  // an output cannot be set
    return made;
  }

  void expect_table(const std::vector<Row>& table) const {
    for (const auto& row : table)
      for (const char place : std::string(three() ? "INECSVTF" : "INECSTF")) {
        const auto slave = at(place);
        const int expected = row.allowed.find(place) != std::string::npos ? ok : error;
        EXPECT_EQ(expected, row.call(*slave, row.function)) << row.function << " at " << place;
      }
  }
};

int plain(const Slave& slave, const char* function) { return slave.call(function); }

int get_one(const Slave& slave, const char* function) {
  const unsigned reference = slave.fmu().reference("pose.z");
  double value{};
  return slave.fmu().three
             ? slave.call(function, &reference, std::size_t{1}, &value, std::size_t{1})
             : slave.call(function, &reference, std::size_t{1}, &value);
}

int set_input(const Slave& slave, const char*) { return slave.set("wrench.fx", 1.0); }
int set_state(const Slave& slave, const char*) { return slave.set("vx", 0.01); }
int set_fixed(const Slave& slave, const char*) { return slave.set("leg1.rod.length", 1.151); }
int set_tunable(const Slave& slave, const char*) {
  return slave.set("leg1.guide_sleeve.stiffness", 0.83e6);
}
int count_states(const Slave& slave, const char* function) {
  std::size_t count{};
  return slave.call(function, &count);
}

int save(const Slave& slave, const char* function) {
  void* state = nullptr;
  const int status = slave.call(function, &state);
  slave.call(slave.fmu().three ? "fmi3FreeFMUState" : "fmi2FreeFMUstate", &state);
  return status;
}

int derivative(const Slave& slave, const char*) {
  const unsigned unknown = slave.fmu().reference("acceleration.x");
  const unsigned known = slave.fmu().reference("wrench.fx");
  const double seed = 1.0;
  double result{};
  return slave.fmu().three
             ? slave.call("fmi3GetDirectionalDerivative", &unknown, std::size_t{1}, &known,
                          std::size_t{1}, &seed, std::size_t{1}, &result, std::size_t{1})
             : slave.call("fmi2GetDirectionalDerivative", &unknown, std::size_t{1}, &known,
                          std::size_t{1}, &seed, &result);
}

/// Of the plant of the heavy platform with the guide model: y 19, v 18, pressures and spools 24.
constexpr std::size_t states = 61, indicators = 30;

int list_of_states(const Slave& slave, const char* function) {
  std::vector<double> list(states);
  return slave.call(function, list.data(), list.size());
}
int list_of_indicators(const Slave& slave, const char* function) {
  std::vector<double> list(indicators);
  return slave.call(function, list.data(), list.size());
}
int set_the_states(const Slave& slave, const char*) {
  const Slave other(slave.fmu(), false);
  std::vector<double> x(states);
  other.states(x.data(), x.size());
  return slave.set_states(x);
}
int set_time(const Slave& slave, const char* function) { return slave.call(function, 0.5); }
int step(const Slave& slave, const char*) { return slave.step(0.0, 1e-3); }
int completed_2(const Slave& slave, const char* function) {
  int enter{}, terminate{};
  return slave.call(function, 1, &enter, &terminate);
}
int completed_3(const Slave& slave, const char* function) {
  bool enter{}, terminate{};
  return slave.call(function, true, &enter, &terminate);
}
int discrete_2(const Slave& slave, const char* function) {
  struct {
    int flags[5];
    double next;
  } info{};
  return slave.call(function, static_cast<void*>(&info));
}
int discrete_3(const Slave& slave, const char* function) {
  bool flags[5]{};
  double next{};
  return slave.call(function, &flags[0], &flags[1], &flags[2], &flags[3], &flags[4], &next);
}

TEST_P(Sequence, AnswersEveryCallAsTheStandardSays) {
  const auto in = [&](const char* two, const char* in_three) { return three() ? in_three : two; };
  std::vector<Row> table{
      {in("fmi2ExitInitializationMode", "fmi3ExitInitializationMode"), "N", plain},
      {in("fmi2Terminate", "fmi3Terminate"), "ECSV", plain},
      {in("fmi2Reset", "fmi3Reset"), "INECSVTF", plain},
      {in("fmi2GetReal", "fmi3GetFloat64"), three() ? "INECSVTF" : "NECSTF", get_one},
      {"input", "INECSV", set_input},
      {"state", three() ? "EC" : "", set_state},
      {"fixed parameter", "IN", set_fixed},
      {"tunable parameter", "INESV", set_tunable},
      {in("fmi2GetFMUstate", "fmi3GetFMUState"), "INECSVTF", save},
      {"directional derivative", "NECSVTF", derivative},
      {in("fmi2EnterEventMode", "fmi3EnterEventMode"), three() ? "C" : "EC", plain},
      {in("fmi2EnterContinuousTimeMode", "fmi3EnterContinuousTimeMode"), "E", plain},
      {in("fmi2NewDiscreteStates", "fmi3UpdateDiscreteStates"), "EV",
       three() ? discrete_3 : discrete_2},
      {in("fmi2CompletedIntegratorStep", "fmi3CompletedIntegratorStep"), "C",
       three() ? completed_3 : completed_2},
      {in("fmi2SetTime", "fmi3SetTime"), three() ? "C" : "EC", set_time},
      {"continuous states", "C", set_the_states},
      {in("fmi2GetContinuousStates", "fmi3GetContinuousStates"), "NECTF", list_of_states},
      {in("fmi2GetDerivatives", "fmi3GetContinuousStateDerivatives"), three() ? "NECTF" : "ECTF",
       list_of_states},
      {in("fmi2GetEventIndicators", "fmi3GetEventIndicators"), "NECTF", list_of_indicators},
      {in("fmi2GetNominalsOfContinuousStates", "fmi3GetNominalsOfContinuousStates"),
       three() ? "NECTF" : "IECTF", list_of_states},
      {"step", "S", step}};
  if (!three()) {
    table.push_back({"fmi2EnterInitializationMode", "I", plain});
    table.push_back({"fmi2CancelStep", "", plain});
  } else {
    table.push_back({"fmi3EnterStepMode", "V", plain});
    table.push_back({"fmi3EvaluateDiscreteStates", "", plain});
    table.push_back({"fmi3EnterConfigurationMode", "", plain});
    table.push_back({"fmi3GetNumberOfContinuousStates", "INEC", count_states});
    table.push_back({"fmi3GetNumberOfEventIndicators", "INEC", count_states});
  }
  expect_table(table);
}

TEST_P(Sequence, AfterAnErrorOnlyASavedStateOrAResetGoesOn) {
  const Slave slave(fmu(), true);
  void* state = nullptr;
  ASSERT_EQ(ok, slave.call(three() ? "fmi3GetFMUState" : "fmi2GetFMUstate", &state));
  EXPECT_EQ(error, slave.step(0.0, -1.0));
  EXPECT_EQ(error, slave.step(0.0, 1e-3));
  EXPECT_EQ(ok, slave.call(three() ? "fmi3SetFMUState" : "fmi2SetFMUstate", state));
  EXPECT_EQ(ok, slave.step(0.0, 1e-3));
  EXPECT_EQ(error, slave.step(0.0, 1e-3));  // the FMU is at 1 ms
  EXPECT_EQ(ok, slave.call(three() ? "fmi3Reset" : "fmi2Reset"));
  EXPECT_EQ(error, slave.step(0.0, 1e-3));  // not initialized
  EXPECT_EQ(ok, slave.call(three() ? "fmi3FreeFMUState" : "fmi2FreeFMUstate", &state));
}

TEST_P(Sequence, WrongArgumentsAreErrors) {
  const auto fails = [&](const std::function<int(const Slave&)>& call) {
    const Slave slave(fmu(), true);
    EXPECT_EQ(error, call(slave));
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  fails([](const Slave& slave) { return slave.set(std::vector<unsigned>{99999}, {0.0}); });
  fails([](const Slave& slave) { return slave.set("wrench.fx", nan); });
  fails([](const Slave& slave) { return slave.set("time", 1.0); });
  fails([](const Slave& slave) { return slave.set("leg1.p_cap", 1e6); });
  fails([](const Slave& slave) { return slave.step(0.0, nan); });
  fails([](const Slave& slave) { return slave.step(0.0, 0.0); });
  fails([](const Slave& slave) { return slave.step(0.1, 1e-3); });
  fails([&](const Slave& slave) {
    return slave.call(three() ? "fmi3SetFMUState" : "fmi2SetFMUstate", static_cast<void*>(nullptr));
  });
  fails([&](const Slave& slave) {
    return slave.call(three() ? "fmi3GetFMUState" : "fmi2GetFMUstate", static_cast<void*>(nullptr));
  });
  EXPECT_EQ(error,
            fmu().call(three() ? "fmi3Terminate" : "fmi2Terminate", static_cast<void*>(nullptr)));
  if (!three()) {
    const Slave slave(fmu(), false, false);
    EXPECT_EQ(error, slave.call("fmi2SetupExperiment", 1, -1.0, 0.0, 0, 0.0));
  }
}

TEST_P(Sequence, StepsAndTimesEndAtTheStopTime) {
  const Slave slave(fmu(), true, false);
  if (three()) {
    ASSERT_EQ(ok, slave.call("fmi3EnterInitializationMode", false, 0.0, 1.0, true, 1.002));
    ASSERT_EQ(ok, slave.call("fmi3ExitInitializationMode"));
  } else {
    ASSERT_EQ(ok, slave.call("fmi2SetupExperiment", 0, 0.0, 1.0, 1, 1.002));
    ASSERT_EQ(ok, slave.call("fmi2EnterInitializationMode"));
    ASSERT_EQ(ok, slave.call("fmi2ExitInitializationMode"));
  }
  EXPECT_EQ(ok, slave.step(1.0, 1e-3));
  EXPECT_EQ(ok, slave.step(1.001, 1e-3));
  EXPECT_NEAR(1.002, slave.get("time"), 1e-12);
  EXPECT_EQ(error, slave.step(1.002, 1e-3));
}

/// A wrench that tears the platform off, until the model has no state to go on from. FMI 2.0 keeps
/// what was computed of the step; in FMI 3.0 the instance is what it was before.
TEST_P(Sequence, AStepThatCannotBeCompletedIsDiscarded) {
  const Slave slave(fmu(), true);
  ASSERT_EQ(ok, slave.set("wrench.fz", 1e9));
  int status = ok;
  double time = 0.0, height = 0.0;
  for (int k = 0; k < 1000 && status == ok; ++k) {
    time = slave.get("time");
    height = slave.get("pose.z");
    status = slave.step(time, 0.01);
  }
  ASSERT_EQ(discard, status);
  if (three()) {
    EXPECT_EQ(time, slave.get("time"));
    EXPECT_EQ(height, slave.get("pose.z"));
    EXPECT_EQ(ok, slave.step(time, 1e-6));  // a smaller one can be
  } else {
    EXPECT_GE(slave.get("time"), time);
    EXPECT_LT(slave.get("time"), time + 0.01);
    constexpr int step_status = 0, last_time = 2, is_terminated = 3;
    double last{};
    int terminated{}, of_step{};
    EXPECT_EQ(ok, slave.call("fmi2GetRealStatus", last_time, &last));
    EXPECT_EQ(slave.get("time"), last);
    EXPECT_EQ(ok, slave.call("fmi2GetBooleanStatus", is_terminated, &terminated));
    EXPECT_EQ(1, terminated);
    EXPECT_EQ(ok, slave.call("fmi2GetStatus", step_status, &of_step));
    EXPECT_EQ(discard, of_step);
  }
  EXPECT_EQ(ok, slave.call(three() ? "fmi3Terminate" : "fmi2Terminate"));
}

/// Out of its bounds, or what no machine can have: the value is not taken and all goes on.
TEST_P(Sequence, ValuesThatCannotBeAreDiscarded) {
  const Slave slave(fmu(), true);
  const auto reference = slave.fmu().reference("wrench.fy");
  const auto stiffness = slave.fmu().reference("leg2.guide_sleeve.stiffness");
  const double before = slave.get("leg2.guide_sleeve.stiffness");
  EXPECT_EQ(discard, slave.set(std::vector{reference, stiffness}, {5.0, -1.0}));
  EXPECT_EQ(0.0, slave.get("wrench.fy"));
  EXPECT_EQ(before, slave.get("leg2.guide_sleeve.stiffness"));
  EXPECT_EQ(discard, slave.set("platform.inertia.xx", 1e9));  // an inertia that no body has
  EXPECT_EQ(ok, slave.step(0.0, 1e-3));
}

int messages = 0;
std::string last_category;
void count_message(void*, int status, const char* category, const char*) {
  ++messages;
  last_category = category;
  EXPECT_GE(status, discard);
}

/// Discards are said where logging is on for them, errors always.
TEST(FmuLogging, FollowsTheCategories) {
  const Unpacked fmu(archive_of(machine_of("heavy-platform"), FmuVersion::fmi3, true));
  const Slave slave(fmu, true, true, 1e-6, {.log = &count_message});
  messages = 0;
  const auto refused = [&] { return slave.set("leg2.guide_sleeve.stiffness", -1.0); };
  EXPECT_EQ(discard, refused());
  EXPECT_EQ(0, messages);
  const char* category = "logStatusDiscard";
  EXPECT_EQ(ok, slave.call("fmi3SetDebugLogging", true, std::size_t{1}, &category));
  EXPECT_EQ(discard, refused());
  EXPECT_EQ(1, messages);
  EXPECT_EQ(category, last_category);
  EXPECT_EQ(ok, slave.call("fmi3SetDebugLogging", false, std::size_t{0},
                           static_cast<const char**>(nullptr)));
  EXPECT_EQ(discard, refused());
  EXPECT_EQ(1, messages);
  EXPECT_EQ(error, slave.step(7.0, 1e-3));
  EXPECT_EQ(2, messages);
  EXPECT_EQ("logStatusError", last_category);
}

TEST_P(Sequence, AnEventModeIsForInstancesThatWereMadeForIt) {
  if (!three()) GTEST_SKIP() << "FMI 2.0 has none in co-simulation";
  const Slave plain_one(fmu(), true);
  EXPECT_EQ(error, plain_one.call("fmi3EnterEventMode"));
  const Slave slave(fmu(), true, true, 1e-6, {.event_mode = true});
  EXPECT_EQ(ok, discrete_3(slave, "fmi3UpdateDiscreteStates"));
  EXPECT_EQ(ok, slave.call("fmi3EnterStepMode"));
  EXPECT_EQ(ok, slave.step(0.0, 1e-3));
  EXPECT_EQ(ok, slave.call("fmi3EnterEventMode"));
  EXPECT_EQ(ok, slave.set("wrench.fx", 100.0));
  EXPECT_EQ(ok, slave.call("fmi3EnterStepMode"));
  EXPECT_EQ(ok, slave.step(1e-3, 1e-3));
}

INSTANTIATE_TEST_SUITE_P(Fmu, Sequence, testing::Values(FmuVersion::fmi2, FmuVersion::fmi3),
                         [](const auto& of) {
                           return std::string(of.param == FmuVersion::fmi2 ? "Fmi2" : "Fmi3");
                         });

/// Forward and adjoint derivatives are the same matrix.
TEST(FmuAdjoint, IsTheTransposedDerivative) {
  const Unpacked fmu(archive_of(machine_of("heavy-platform"), FmuVersion::fmi3, true));
  const Slave slave(fmu, false);
  const std::vector<unsigned> unknowns{fmu.reference("acceleration.x"),
                                       fmu.reference("der(leg1.p_cap)")};
  const std::vector<unsigned> knowns{fmu.reference("wrench.fx"), fmu.reference("leg1.spool"),
                                     fmu.reference("vx")};
  const std::vector<double> seed{2.0, -3.0};
  std::vector<double> result(3);
  ASSERT_EQ(ok,
            slave.call("fmi3GetAdjointDerivative", unknowns.data(), unknowns.size(), knowns.data(),
                       knowns.size(), seed.data(), seed.size(), result.data(), result.size()));
  for (std::size_t k = 0; k < knowns.size(); ++k) {
    const auto column = slave.directional(unknowns, knowns[k]);
    EXPECT_DOUBLE_EQ(2.0 * column[0] - 3.0 * column[1], result[k]);
  }
}

}  // namespace
}  // namespace hydrapod::test
