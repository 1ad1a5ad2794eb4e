/// Machines on the rig that give way where the rigid calculation does not expect it: their records
/// show the modes of the linear models.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/loop_machine.hpp"
#include "support/rig_record.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using base::two_pi;

/// Frequencies [Hz] of the linear model's lowest modes.
Eigen::VectorXd calculated(const model::Machine& machine, dynamics::ModelKind kind) {
  const auto modes = modal::normal_modes(dynamics::linear_model(machine, machine.neutral(), kind));
  return modes.omega2.cwiseSqrt() / two_pi;
}

/// The identified frequency next to `frequency` [Hz].
double nearest(const identification::Identification& found, double frequency) {
  double best = 0.0;
  for (const auto& mode : found.modes) {
    const double f = mode.fit.omega() / two_pi;
    if (std::abs(f - frequency) < std::abs(best - frequency)) best = f;
  }
  return best;
}

/// MAC of the identified modes with those of the model.
std::vector<double> compared(const identification::Identification& found,
                             const std::vector<observation::ObservedMode>& model,
                             const observation::ComparisonFrame& frame) {
  std::vector<double> likeness;
  const auto modes = identification::modal_results(found);
  for (const auto& pair : observation::compare_modes(modes, model, frame).pairs)
    likeness.push_back(pair.mac.value());
  return likeness;
}

}  // namespace

TEST(RigWithSoftGimbals, ShowsTheLowerFrequencies) {
  auto machine = simulation::machine_of("zhang-jiang-2021", simulation::smooth);
  const auto rigid = calculated(machine, dynamics::ModelKind::rigid);
  const double k_h = *machine.legs[0].oil_spring.stiffness;
  for (auto& leg : machine.legs) leg.gimbal_stiffness = 1.9 * k_h;
  const auto soft = calculated(machine, dynamics::ModelKind::rigid);
  const auto found = identified_on_rig(machine, {.kind = dynamics::ModelKind::rigid,
                                                 .X_BP = machine.neutral(),
                                                 .duration = 60.0,
                                                 .level = 1.7e-4,
                                                 .seed = 21});
  for (int k = 0; k < 4; ++k) {
    ASSERT_LT(soft[k], 0.85 * rigid[k]);
    // a minute of record; the valves hold the pistons a little
    EXPECT_NEAR(nearest(found, soft[k]), soft[k], 7e-3 * soft[k]);
  }
}

/// A heavy base, whose own resonances lie not far above: against the poles of the plant, which has
/// them, and which moving_base_test.cpp holds against a system that was built apart from it.
TEST(RigOnABaseThatGivesWay, ShowsTheLowerFrequencies) {
  auto machine = simulation::machine_of("zhang-jiang-2021", simulation::smooth);
  const auto rigid = calculated(machine, dynamics::ModelKind::rigid);
  const double k = 3.0 * *machine.legs[0].oil_spring.stiffness;
  machine.base_mount = model::BaseMount{.mass = 310.0, .inertia = {43.0, 47.0, 61.0}};
  machine.base_mount->stiffness = {k, k, 2.0 * k, 0.7 * k, 0.7 * k, 0.5 * k};
  const auto soft = calculated(machine, dynamics::ModelKind::rigid);
  const auto poles = simulation::system_poles(simulation::linear_system(
      machine, machine.neutral(), {.kind = dynamics::ModelKind::rigid, .closed = false}));
  const auto found = identified_on_rig(machine, {.kind = dynamics::ModelKind::rigid,
                                                 .X_BP = machine.neutral(),
                                                 .duration = 40.0,
                                                 .level = 1.7e-4,
                                                 .seed = 22});
  for (int i = 0; i < 4; ++i) {
    ASSERT_LT(soft[i], 0.97 * rigid[i]);
    const auto pole = std::ranges::min_element(poles.poles, {}, [&](const auto& one) {
      return one.oscillates() ? std::abs(one.omega / two_pi - soft[i]) : 1e9;
    });
    const double frequency = pole->omega / two_pi;
    EXPECT_NEAR(frequency, soft[i], 7e-3 * soft[i]);  // the valves hold the pistons a little
    EXPECT_NEAR(nearest(found, frequency), frequency, 7e-3 * frequency);
  }
  // leg lengths show shapes against the base
  const observation::ComparisonFrame frame{machine, machine.neutral(),
                                           kinematics::mass_center(machine, machine.neutral())};
  auto modes = observation::observe(machine, machine.neutral(), dynamics::ModelKind::rigid,
                                    observation::Observed::plant)
                   .modes;
  const auto right = compared(found, modes, frame);
  ASSERT_EQ(right.size(), found.modes.size());
  EXPECT_GT(std::ranges::min(right), 0.995);
  for (auto& mode : modes) mode.against_base = mode.motion();
  const auto wrong = compared(found, modes, frame);
  EXPECT_LT(std::ranges::min(wrong), 0.6);
}

/// An accelerometer feels where its point goes against the ground, and gravity as it tilts with
/// platform and base: from second differences of poses.
TEST(RigOnABaseThatGivesWay, HasAccelerometersThatFeelTheGround) {
  auto machine = simulation::machine_of("zhang-jiang-2021", {"environment.gravity=9.80665"});
  machine.base_mount = model::BaseMount{.mass = 400.0, .inertia = {50.0, 60.0, 70.0}};
  machine.base_mount->stiffness = {9e5, 8e5, 2e6, 1.7e5, 1.5e5, 2e5};
  rig::RigOptions options;
  options.entry = rig::Entry::wrench;
  spatial::Vector6 rms;
  rms << 310.0, 250.0, 190.0, 70.0, 50.0, 60.0;
  options.signals = {{rms, signals::Multisine{1.0, 1.0, 1.0}}};
  options.settling = 0.0;
  options.duration = 2.0;
  options.rate = 1000.0;  // the controller's: the record holds every value of the wrench
  options.oversampling = 1;
  options.instruments.anti_alias = false;
  rig::Accelerometer sensor{.name = "a",
                            .p_P = {0.31, -0.22, 0.13},
                            .e_P = spatial::Vector3(0.6, -0.3, 0.2).normalized(),
                            .noise_density = 0.0,
                            .bandwidth = 0.0};
  sensor.sensor = {};
  options.instruments.accelerometers = {sensor};
  options.loop.kind = dynamics::ModelKind::rigid;
  options.loop.ideal_sensors = true;
  options.loop.integrator.relative_tolerance = options.loop.integrator.absolute_tolerance = 1e-9;
  simulation::ClosedLoop loop(machine, machine.neutral(), rig::loop_options(options));
  const TemporaryFolder folder;
  const std::string path = folder / "run.h5";
  const auto writer = data::open_record_writer(
      path, {.channels = rig::rig_channels(options), .sample_rate = options.rate});
  const auto run = rig::run_rig(loop, options, *writer);
  ASSERT_EQ(run.summary.end, simulation::RunEnd::finished) << run.summary.message;
  writer->close();
  const auto record = data::read_record(path).record;

  std::vector<spatial::Vector3> places, axes, axes_on_base;  // against the ground
  const auto excitation = record.samples.leftCols(6);
  Eigen::Index row = 0;
  loop.run(
      [&](double, simulation::Excitation& out) {
        const auto last = excitation.rows() - 1;
        out.wrench = excitation.row(std::min(row++, last)).transpose();
        out.next_wrench = excitation.row(std::min(row, last)).transpose();
      },
      [&](const simulation::LoopSample& sample) {
        const auto& base = sample.plant.base.motion;
        const auto turn = [&](const spatial::Vector3& v) -> spatial::Vector3 {
          return v + spatial::Vector3(base.tail<3>()).cross(v);
        };
        places.push_back(base.head<3>() + turn(sample.plant.X_BP * sensor.p_P));
        axes_on_base.push_back(sample.plant.X_BP.R_BP * sensor.e_P);
        axes.push_back(turn(axes_on_base.back()));
      });
  const double h = 1.0 / options.rate;
  double largest = 0.0, worst = 0.0, by_tilt = 0.0;
  for (std::size_t k = 400; k < 1800; ++k) {
    const spatial::Vector3 a = (places[k + 1] - 2.0 * places[k] + places[k - 1]) / (h * h);
    const double felt = axes[k].dot(a - machine.gravity) + axes[0].dot(machine.gravity);
    const double seen = record.samples(static_cast<Eigen::Index>(k), 30);
    largest = std::max(largest, std::abs(felt));
    worst = std::max(worst, std::abs(seen - felt));
    by_tilt = std::max(by_tilt, std::abs((axes[k] - axes_on_base[k]).dot(machine.gravity)));
  }
  EXPECT_GT(largest, 0.05);
  EXPECT_GT(by_tilt, 0.05 * largest);
  EXPECT_LT(worst, 0.01 * largest);
}

}  // namespace hydrapod::test
