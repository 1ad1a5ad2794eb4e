/// One Jacobian of all modes by the numbers of a calibration: analytic, and by differences.

#include <benchmark/benchmark.h>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "models.hpp"

namespace {

using namespace hydrapod;
using dynamics::ModelKind;

/// The thirteen parameters of Table 2 from Table 1.
const std::vector<std::vector<std::string>> parameters{
    {"platform.inertia.xx", "platform.inertia.yy"},
    {"platform.inertia.zz"},
    {"legs.oil_spring.stiffness"},
    {"legs.case.mass"},
    {"legs.case.mass_center"},
    {"legs.case.transverse_inertia"},
    {"legs.case.axial_inertia"},
    {"legs.rod.length"},
    {"legs.rod.mass"},
    {"legs.rod.mass_center"},
    {"legs.rod.transverse_inertia"},
    {"legs.rod.axial_inertia"},
    {"legs.guide_sleeve.position"}};

calibration::VariedMachine published(const char* gravity) {
  const auto file = model::read_machine_file(model_file("zhang-jiang-2021.toml"),
                                             {std::string("environment.gravity=") + gravity},
                                             kinematics::check_machine);
  calibration::VariedMachine machine{.machine = file.machine};
  for (const auto& paths : parameters) {
    machine.parameters.emplace_back();
    for (const auto& path : paths)
      machine.parameters.back().push_back(find_number(file, path).value().id);
  }
  return machine;
}

void analytic(benchmark::State& state, const char* gravity) {
  const auto machine = published(gravity);
  const auto values = machine.values();
  for (auto _ : state) {
    auto point = calibration::mode_point(machine.at(values), 0, ModelKind::guide);
    calibration::add_derivatives(machine, values, 0, values, point);
    benchmark::DoNotOptimize(point.domega2);
  }
}

/// Central differences of the frequencies: what a general least-squares program does.
void differences(benchmark::State& state, const char* gravity) {
  const auto machine = published(gravity);
  const auto values = machine.values();
  for (auto _ : state) {
    Eigen::MatrixXd J(18, values.size());
    auto moved = values;
    for (std::size_t j = 0; j < values.size(); ++j) {
      const double h = 1e-4 * values[j];
      moved[j] = values[j] + h;
      const auto above = calibration::mode_point(machine.at(moved), 0, ModelKind::guide);
      moved[j] = values[j] - h;
      const auto below = calibration::mode_point(machine.at(moved), 0, ModelKind::guide);
      moved[j] = values[j];
      J.col(static_cast<Eigen::Index>(j)) = (above.modes.omega2 - below.modes.omega2) / (2.0 * h);
    }
    benchmark::DoNotOptimize(J);
    benchmark::DoNotOptimize(calibration::mode_point(machine.at(values), 0, ModelKind::guide));
  }
}

BENCHMARK_CAPTURE(analytic, free_of_gravity, "0")->Name("mode_jacobian");
BENCHMARK_CAPTURE(differences, free_of_gravity, "0")->Name("mode_jacobian_differences");
BENCHMARK_CAPTURE(analytic, gravity, "9.81")->Name("mode_jacobian_gravity");
BENCHMARK_CAPTURE(differences, gravity, "9.81")->Name("mode_jacobian_differences_gravity");

}  // namespace
