#pragma once
/// A machine, its plant and its FMU, with noise for their inputs.

#include <cmath>

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
  explicit Subject(const Case& of)
      : hydraulics(of.hydraulics),
        machine(machine_of("heavy-platform")),
        fmu(archive_of(machine, of.version, of.hydraulics)),
        plant(machine, dynamics::ModelKind::guide,
              {.hydraulics = of.hydraulics, .oil_springs = false}),
        rest(plant.equilibrium(machine.neutral())) {
    const char* suffix = hydraulics ? ".valve_command" : ".axial_force";
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

/// Co-simulation with noise, against the plant under CVODE.
inline void expect_same_motion(const Case& of, int steps) {
  const Subject subject(of);
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

}  // namespace hydrapod::test
