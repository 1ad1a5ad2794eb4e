/// What an export states of its file follows the file: numbers that are changed in it show.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/exchange/exchange.hpp"
#include "support/loop_machine.hpp"
#include "support/random_machine.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using exchange::Held;
using exchange::measured_modes;
using exchange::modal_model;
using exchange::Parity;
using exchange::state_space;
using exchange::SystemKind;

/// "within 3.1e-14 of …" of the line that begins so, or "no difference from …"; −1: there is no
/// such line.
double stated(const Parity& parity, std::string_view what) {
  for (const auto& line : parity) {
    if (!line.what.starts_with(what)) continue;
    if (line.how.starts_with("no difference from")) return 0.0;
    return std::stod(line.how.substr(line.how.find("within ") + 7));
  }
  return -1.0;
}

model::Machine ugly_machine() {
  Random random(61);
  auto machine = random_machine(random, {.gravity = Gravity::down});
  machine.damping.modal_ratio = 0.0113;
  return machine;
}

TEST(Measured, StateSpaceOfTheMechanics) {
  const auto machine = ugly_machine();
  const auto& X_BP = machine.poses[1].X_BP;
  const exchange::StateSpaceOptions options{.kind = ModelKind::guide, .p_PQ = {0.2, -0.1, 0.3}};
  auto system = state_space(machine, X_BP, options);
  const auto right = measured_state_space(machine, X_BP, options, system);
  ASSERT_EQ(right.size(), 2U);
  EXPECT_LT(stated(right, "poles"), 1e-11);
  EXPECT_LT(stated(right, "responses"), 1e-11);
  EXPECT_EQ(right[0].held, Held::exact);
  auto wrong = system;
  wrong.B.col(2) *= 1.01;
  EXPECT_LT(stated(measured_state_space(machine, X_BP, options, wrong), "poles"), 1e-11);
  EXPECT_NEAR(stated(measured_state_space(machine, X_BP, options, wrong), "responses"), 0.01,
              0.0051);
  wrong = system;
  wrong.A *= 1.003;
  EXPECT_NEAR(stated(measured_state_space(machine, X_BP, options, wrong), "poles"), 0.003, 1e-4);
  EXPECT_EQ(measured_state_space(machine, X_BP, options, wrong)[0].held, Held::approximate);

  auto held = options;
  held.sample_time = 1.7e-4;
  const auto sampled = state_space(machine, X_BP, held);
  EXPECT_LT(stated(measured_state_space(machine, X_BP, held, sampled), "poles"), 1e-9);
  auto few = options;
  few.reduced_states = 14;
  const auto reduced = state_space(machine, X_BP, few);
  const auto of_reduced = measured_state_space(machine, X_BP, few, reduced);
  EXPECT_EQ(stated(of_reduced, "poles"), -1.0);
  EXPECT_GT(stated(of_reduced, "responses"), 1e-9);
  EXPECT_LT(stated(of_reduced, "responses"), 0.3);
}

/// Of the small one, and of the large one.
std::pair<double, double> stated_motions(const model::Machine& machine,
                                         const exchange::StateSpaceOptions& options,
                                         const exchange::StateSpace& held) {
  const auto parity = measured_state_space(machine, machine.neutral(), options, held);
  const auto small = std::ranges::find_if(
      parity, [](const auto& line) { return line.what.starts_with("motion"); });
  if (parity.end() - small != 2) return {-1.0, -1.0};
  EXPECT_EQ(small->held, Held::approximate);
  return {stated({small[0]}, "motion"), stated({small[1]}, "motion")};
}

/// Small motions are those of the file; large ones show what is not linear.
TEST(Measured, MotionOfPlantAndLoop) {
  const auto machine = simulation::machine_of(
      "heavy-platform",
      {"environment.gravity=0", "legs.friction.viscous=311", "controller.output.resolution=0"});
  for (const auto system : {SystemKind::plant, SystemKind::loop})
    for (const bool sampled : {false, true}) {
      if (sampled && system != SystemKind::loop) continue;
      const exchange::StateSpaceOptions options{.system = system, .sampled_controller = sampled};
      const auto right = state_space(machine, machine.neutral(), options);
      const auto [small, large] = stated_motions(machine, options, right);
      EXPECT_GT(small, 0.0);
      EXPECT_LT(small, system == SystemKind::plant ? 1e-3 : sampled ? 3e-3 : 1e-2);
      EXPECT_GT(large, small);
      auto wrong = right;
      wrong.B *= 1.05;
      EXPECT_NEAR(stated_motions(machine, options, wrong).first, 0.05, 0.02);
    }
}

/// A of a plant is that of `modes --system` itself, but for what discretising makes of it.
TEST(Measured, PolesOfADiscretisedPlant) {
  const auto machine = simulation::machine_of("heavy-platform");
  exchange::StateSpaceOptions options{.system = SystemKind::plant};
  const auto continuous = state_space(machine, machine.neutral(), options);
  EXPECT_EQ(stated(measured_state_space(machine, machine.neutral(), options, continuous), "poles"),
            -1.0);
  options.sample_time = 0.7e-3;
  auto held = state_space(machine, machine.neutral(), options);
  EXPECT_LT(stated(measured_state_space(machine, machine.neutral(), options, held), "poles"), 3e-9);
  held.sample_time *= 1.01;
  const double stretched =
      stated(measured_state_space(machine, machine.neutral(), options, held), "poles");
  EXPECT_GT(stretched, 0.0099);  // more where a pole falls onto another one's place
  EXPECT_LT(stretched, 0.03);
}

TEST(Measured, Superelement) {
  const auto machine = ugly_machine();
  const auto& X_BP = machine.poses[1].X_BP;
  for (const bool base : {false, true}) {
    exchange::SuperelementOptions options{.kind = ModelKind::full, .free_base = base};
    const auto element = superelement(machine, X_BP, options);
    const auto right = measured_superelement(machine, X_BP, options, element);
    EXPECT_LT(stated(right, "frequencies"), 1e-9);
    EXPECT_LT(stated(right, "responses"), 1e-9);
    auto wrong = element;
    wrong.K *= 1.02;
    EXPECT_NEAR(stated(measured_superelement(machine, X_BP, options, wrong), "frequencies"),
                std::sqrt(1.02) - 1.0, 1e-4);
    wrong = element;
    wrong.C *= 1.5;
    EXPECT_LT(stated(measured_superelement(machine, X_BP, options, wrong), "frequencies"), 1e-9);
    EXPECT_GT(stated(measured_superelement(machine, X_BP, options, wrong), "responses"), 0.01);
    options.leg_modes = 3;
    const auto few = superelement(machine, X_BP, options);
    EXPECT_GT(stated(measured_superelement(machine, X_BP, options, few), "six lowest frequencies"),
              0.0);
  }
}

/// Of every number that the plant depends on, at a pose that is not the neutral one.
TEST(Measured, EquationsOfAnFmu) {
  for (const bool hydraulics : {false, true}) {
    const auto machine = simulation::machine_of("heavy-platform", {"legs.friction.coulomb=173"});
    const auto made =
        exchange::fmu(machine, machine.poses[2],
                      {.hydraulics = hydraulics, .object = "object", .notices = "none"}, {});
    const double difference = stated(made.parity, "derivatives of all states");
    EXPECT_GE(difference, 0.0);
    EXPECT_LT(difference, 1e-12);
  }
}

TEST(Measured, ModesReadBack) {
  const auto machine = ugly_machine();
  const auto& X_BP = machine.poses[1].X_BP;
  const TemporaryFolder folder;
  const auto modes = modal_model(machine, X_BP, ModelKind::guide, {.title = "ugly"});
  for (const auto dataset : {data::ModalDataset::shapes, data::ModalDataset::analysis}) {
    data::write_modal_results(folder / "m.uff", modes, dataset);
    auto read = data::read_modal_results(folder / "m.uff").results;
    const auto right = measured_modes(machine, X_BP, ModelKind::guide, read);
    EXPECT_LT(stated(right, "poles"), 1e-5);  // six digits
    EXPECT_GT(stated(right, "poles"), 0.0);
    EXPECT_LT(stated(right, "responses"), 5e-4);
    for (auto& mode : read.modes) mode.participation *= 1.1;
    EXPECT_NEAR(stated(measured_modes(machine, X_BP, ModelKind::guide, read), "responses"), 0.1,
                0.01);
    read.modes[3].pole *= 1.05;
    EXPECT_NEAR(stated(measured_modes(machine, X_BP, ModelKind::guide, read), "poles"), 0.05, 0.02);
  }
}

}  // namespace
}  // namespace hydrapod::test
