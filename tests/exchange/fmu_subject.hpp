#pragma once
/// A machine, its plant and its FMU, with noise for their inputs.

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <cmath>
#include <cstring>

#include "exchange/fmu_driver.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support/loop_machine.hpp"
#include "support/random.hpp"

namespace hydrapod::test {

using exchange::FmuVersion;
using simulation::Integrator;
using simulation::machine_of;
using simulation::Plant;
using simulation::PlantInput;

inline constexpr double sample = 1e-3;

struct Case {
  FmuVersion version{};
  bool hydraulics{};
};

/// The plant, its FMU, and noise for its inputs.
struct Subject {
  explicit Subject(const Case& of, const model::Machine& on = machine_of("heavy-platform"))
      : hydraulics(of.hydraulics),
        machine(on),
        fmu(archive_of(machine, of.version, of.hydraulics)),
        plant(machine, dynamics::ModelKind::guide,
              {.hydraulics = of.hydraulics, .oil_springs = false}),
        rest(plant.equilibrium(machine.neutral())) {
    const bool drives = model::leg_type(machine) == model::LegType::screw;
    const char* suffix = !hydraulics ? ".axial_force"
                         : drives    ? ".drive_command"
                                     : ".valve_command";
    for (int i = 1; i <= 6; ++i)
      inputs.push_back(fmu.reference("leg" + std::to_string(i) + suffix));
    for (const char* name : {"fx", "fy", "fz", "mx", "my", "mz"})
      inputs.push_back(fmu.reference(std::string("wrench.") + name));
    for (const auto& name : plant.state_names()) states.push_back(fmu.reference(name));
  }

  /// Twelve numbers: about what holds the machine. Forces without springs are small, since nothing
  /// holds the platform then.
  std::vector<double> noise(Random& random) const {
    std::vector<double> values(12);
    for (int k = 0; k < 6; ++k) {
      const double held = hydraulics ? rest.input.command[k] : rest.input.axial[k];
      values[static_cast<std::size_t>(k)] =
          held + random.uniform(-1.0, 1.0) * (hydraulics ? 0.1 : 20.0);
      values[static_cast<std::size_t>(k) + 6] =
          random.uniform(-1.0, 1.0) * (hydraulics ? 2e3 : 20.0);
    }
    return values;
  }

  PlantInput input(const std::vector<double>& values) const {
    PlantInput made;
    for (int k = 0; k < 6; ++k) {
      (hydraulics ? made.command : made.axial)[k] = values[static_cast<std::size_t>(k)];
      made.wrench[k] = values[static_cast<std::size_t>(k) + 6];
    }
    return made;
  }

  bool hydraulics;
  model::Machine machine;
  Unpacked fmu;
  Plant plant;
  Plant::Rest rest;
  std::vector<unsigned> inputs{}, states{};
};

/// The largest difference of states, in shares of what each of them goes through.
class Difference {
 public:
  void add(const Eigen::VectorXd& expected, const double* got) {
    const Eigen::Map<const Eigen::VectorXd> other(got, expected.size());
    if (low_.size() == 0) {
      low_ = high_ = expected;
      worst_ = Eigen::VectorXd::Zero(expected.size());
    }
    low_ = low_.cwiseMin(expected);
    high_ = high_.cwiseMax(expected);
    worst_ = worst_.cwiseMax((other - expected).cwiseAbs());
  }
  [[nodiscard]] double relative(const Eigen::VectorXd& scales) const {
    const Eigen::VectorXd range = (high_ - low_).cwiseMax(1e-3 * scales);
    return worst_.cwiseQuotient(range).maxCoeff();
  }

 private:
  Eigen::VectorXd low_{}, high_{}, worst_{};
};

/// With differences of another order and other steps, extrapolated.
inline void expect_derivatives_of_differences(const Subject& subject, Random& random) {
  const Slave slave(subject.fmu, false);
  slave.enter_continuous_time();
  auto inputs = subject.noise(random);
  ASSERT_EQ(ok, slave.set(subject.inputs, inputs));
  std::vector<double> x(subject.rest.x.begin(), subject.rest.x.end());
  const auto scales = subject.plant.scales();
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] += 0.2 * scales[static_cast<int>(k)] * random.uniform(-1.0, 1.0);
  ASSERT_EQ(ok, slave.set_states(x));
  std::vector<unsigned> unknowns;
  for (const auto& [name, reference] : subject.fmu.references)
    if (name.starts_with("der(") || name.ends_with("length_rate") ||
        name.starts_with("acceleration") || name.starts_with("accelerometer"))
      unknowns.push_back(reference);
  const auto count = unknowns.size();
  const auto knowns = static_cast<int>(x.size() + inputs.size());
  Eigen::MatrixXd given(count, knowns), expected(count, knowns);
  const double share = 1e-4;
  for (int k = 0; k < knowns; ++k) {
    const bool is_state = k < static_cast<int>(x.size());
    const auto index = static_cast<std::size_t>(is_state ? k : k - static_cast<int>(x.size()));
    const double size = is_state ? scales[k] : subject.hydraulics && index < 6 ? 0.1 : 1e3;
    const auto column =
        slave.directional(unknowns, is_state ? subject.states[index] : subject.inputs[index]);
    const auto at = [&](double h) {
      auto moved = x, u = inputs;
      (is_state ? moved : u)[index] += h;
      EXPECT_EQ(ok, slave.set_states(moved));
      EXPECT_EQ(ok, slave.set(subject.inputs, u));
      const auto values = slave.get(unknowns);
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), values.size()));
    };
    const double h = share * size;
    const Eigen::VectorXd coarse = (at(h) - at(-h)) / (2.0 * h);
    const Eigen::VectorXd fine = (at(0.5 * h) - at(-0.5 * h)) / h;
    expected.col(k) = size * (4.0 * fine - coarse) / 3.0;
    given.col(k) = size * Eigen::Map<const Eigen::VectorXd>(column.data(), column.size());
    ASSERT_EQ(ok, slave.set_states(x));
    ASSERT_EQ(ok, slave.set(subject.inputs, inputs));
  }
  for (std::size_t u = 0; u < count; ++u) {
    const auto row = static_cast<int>(u);
    const double scale = expected.row(row).cwiseAbs().maxCoeff();
    EXPECT_LT((given - expected).row(row).cwiseAbs().maxCoeff(), 1e-6 * scale) << unknowns[u];
  }
}

/// From a saved state on, also of another instance by its bytes: to the bit.
inline void expect_saved_states_continue(const Subject& subject) {
  const Slave slave(subject.fmu, true), other(subject.fmu, true);
  const auto run = [&](const Slave& on, int from, int to) {
    Random random(static_cast<unsigned>(from));
    for (int k = from; k < to; ++k) {
      EXPECT_EQ(ok, on.set(subject.inputs, subject.noise(random)));
      EXPECT_EQ(ok, on.step(sample * k, sample));
    }
    return on.get(subject.states);
  };
  run(slave, 0, 20);
  void* state = nullptr;
  ASSERT_EQ(ok, slave.save(&state));
  const auto first = run(slave, 20, 40);
  ASSERT_EQ(ok, slave.restore(state));
  EXPECT_EQ(first, run(slave, 20, 40));

  auto bytes = slave.bytes_of(state);
  void* copy = nullptr;
  ASSERT_EQ(ok, other.state_from(bytes, &copy));
  ASSERT_EQ(ok, other.restore(copy));
  EXPECT_EQ(first, run(other, 20, 40));
  ASSERT_EQ(ok, slave.release(&state));
  ASSERT_EQ(ok, other.release(&copy));
  EXPECT_EQ(nullptr, state);

  const auto refused = [&](std::size_t at, const auto& value) {
    auto changed = bytes;
    std::memcpy(changed.data() + at, &value, sizeof value);
    return other.state_from(changed, &copy) == error;
  };
  EXPECT_TRUE(refused(0, 'x'));
  EXPECT_TRUE(refused(9, bytes[9] == '7' ? '8' : '7')) << "the token of another FMU";
  const std::size_t last = bytes.size() - sizeof(double);
  EXPECT_TRUE(refused(last, std::nan(""))) << "a state that is no number";
}

/// Co-simulation with noise, against the plant under CVODE.
inline void expect_same_motion(const Subject& subject, int steps) {
  const Slave slave(subject.fmu, true, true, 1e-10);
  Integrator reference(subject.plant, {.method = simulation::Method::cvode_adams,
                                       .relative_tolerance = 1e-11,
                                       .absolute_tolerance = 1e-11});
  reference.start(0.0, subject.rest.x);
  Random random(1);
  Difference difference;
  for (int k = 0; k < steps; ++k) {
    const auto values = subject.noise(random);
    ASSERT_EQ(ok, slave.set(subject.inputs, values));
    ASSERT_EQ(ok, slave.step(sample * k, sample * (k + 1) - sample * k));
    reference.advance(sample * (k + 1), subject.input(values));
    if (k % 10 == 9) difference.add(reference.state(), slave.get(subject.states).data());
  }
  EXPECT_LT(difference.relative(subject.plant.scales()), 1e-6);
}

/// The FMU's derivatives for CVODE.
struct Equation {
  const Slave* slave;
  static int rate(double time, N_Vector x, N_Vector rates, void* data) {
    const auto& slave = *static_cast<Equation*>(data)->slave;
    const auto n = static_cast<std::size_t>(N_VGetLength(x));
    const std::vector<double> states(N_VGetArrayPointer(x), N_VGetArrayPointer(x) + n);
    const int status = slave.call(slave.fmu().three ? "fmi3SetTime" : "fmi2SetTime", time) +
                       slave.set_states(states) + slave.derivatives(N_VGetArrayPointer(rates), n);
    return status == ok ? 0 : 1;
  }
};

/// Model exchange under CVODE with noise, against the plant.
inline void expect_same_motion_in_model_exchange(const Subject& subject, int steps) {
  const Slave slave(subject.fmu, false);
  slave.enter_continuous_time();
  const auto n = static_cast<std::size_t>(subject.rest.x.size());
  SUNContext context{};
  ASSERT_EQ(0, SUNContext_Create(nullptr, &context));
  N_Vector x = N_VNew_Serial(static_cast<sunindextype>(n), context);
  N_Vector absolute = N_VClone(x);
  ASSERT_EQ(ok, slave.states(N_VGetArrayPointer(x), n));
  constexpr double tolerance = 1e-11;
  for (std::size_t k = 0; k < n; ++k)
    N_VGetArrayPointer(absolute)[k] = tolerance * subject.plant.scales()[static_cast<int>(k)];
  Equation equation{&slave};
  void* memory = CVodeCreate(CV_ADAMS, context);
  ASSERT_EQ(0, CVodeInit(memory, &Equation::rate, 0.0, x));
  ASSERT_EQ(0, CVodeSVtolerances(memory, tolerance, absolute));
  ASSERT_EQ(0, CVodeSetUserData(memory, &equation));
  ASSERT_EQ(0, CVodeSetMaxNumSteps(memory, 100000));
  SUNNonlinearSolver solver = SUNNonlinSol_FixedPoint(x, 0, context);
  ASSERT_EQ(0, CVodeSetNonlinearSolver(memory, solver));

  Integrator reference(subject.plant, {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-10});
  reference.start(0.0, subject.rest.x);
  Random random(4);
  Difference difference;
  double time = 0.0;
  for (int k = 0; k < steps; ++k) {
    const auto values = subject.noise(random);
    ASSERT_EQ(ok, slave.set(subject.inputs, values));
    ASSERT_EQ(0, CVodeReInit(memory, time, x));
    ASSERT_EQ(0, CVodeSetStopTime(memory, sample * (k + 1)));
    while (time < sample * (k + 1))
      ASSERT_LE(0, CVode(memory, sample * (k + 1), x, &time, CV_NORMAL));
    reference.advance(time, subject.input(values));
    difference.add(reference.state(), N_VGetArrayPointer(x));
  }
  EXPECT_LT(difference.relative(subject.plant.scales()), 1e-6);
  SUNNonlinSolFree(solver);
  CVodeFree(&memory);
  N_VDestroy(absolute);
  N_VDestroy(x);
  SUNContext_Free(&context);
}

}  // namespace hydrapod::test
