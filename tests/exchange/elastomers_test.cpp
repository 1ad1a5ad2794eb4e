/// Multibody files of machines whose seals are elastomers: springs of slow motions.

#include <gtest/gtest.h>

#include <algorithm>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::exchange {
namespace {

constexpr double growth = 2.7e-8;  // [1/Pa]

Machine machine_with_elastomers() {
  auto machine = test::symmetric_machine(9.81);
  machine.damping.modal_ratio = 0.0;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[i];
    leg.hydraulics.equivalent_cylinder = {.area_ratio = 0.53, .area = 1.3e-3};
    if (i != 4)
      leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.7,
                                    .loss_factor = 0.21,
                                    .frequency = 13.0,
                                    .pressure_stiffening = growth};
  }
  return machine;
}

/// Springs as stiff as the pressures make them, without a word about elastomers.
Machine with_ideal_springs(const Machine& machine) {
  auto ideal = machine;
  const auto pressed =
      dynamics::with_pressed_seals(machine, dynamics::ModelKind::guide, machine.neutral());
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    ideal.legs[i].guide_sleeve.elastomer.reset();
    ideal.legs[i].guide_sleeve.stiffness = pressed.legs[i].guide_sleeve.stiffness;
  }
  EXPECT_GT(ideal.legs[0].guide_sleeve.stiffness, 1.01 * machine.legs[0].guide_sleeve.stiffness);
  EXPECT_EQ(ideal.legs[4].guide_sleeve.stiffness, machine.legs[4].guide_sleeve.stiffness);
  return ideal;
}

TEST(MultibodyFilesOfElastomers, SayThatTheyHoldSpringsOfSlowMotions) {
  const auto machine = machine_with_elastomers();
  const auto kind = dynamics::ModelKind::guide;
  for (const auto format : {MultibodyFormat::mjcf, MultibodyFormat::sdf, MultibodyFormat::urdf}) {
    const auto named = [&](const Machine& of) {
      const auto file = multibody_file(of, of.neutral(), kind, format);
      return std::ranges::any_of(file.parity, [](const ParityLine& line) {
        return line.held == Held::absent && line.what == "elastomer seals" &&
               line.how.find("slow motions") != std::string::npos;
      });
    };
    EXPECT_TRUE(named(machine));
    EXPECT_FALSE(named(with_ideal_springs(machine)));
  }
}

/// With and without oil that relaxes: the arms of the seals are no dampers beside the oil.
TEST(MultibodyFilesOfElastomers, AreThoseOfSpringsUnderPressure) {
  for (const auto oil : {model::OilDamping::viscous, model::OilDamping::chambers}) {
    auto machine = machine_with_elastomers();
    machine.damping.oil = oil;
    const auto text = [&](const Machine& of) {
      return multibody_file(of, of.neutral(), dynamics::ModelKind::guide, MultibodyFormat::sdf)
          .text;
    };
    EXPECT_EQ(text(machine), text(with_ideal_springs(machine)));
  }
}

}  // namespace
}  // namespace hydrapod::exchange
