/// The mode table: labels, rigid counterparts, and who is who in two tables.

#include "hydrapod/modal/mode_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/model/machine_file.hpp"
#include "support/random_machine.hpp"
#include "support/run_program.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using modal::ModeTable;
using testing::HasSubstr;

model::Machine machine_of(const std::string& name) {
  return model::read_machine_file(source_file("models/" + name).string()).machine;
}

ModeTable table_of(const model::Machine& machine, ModelKind kind) {
  return modal::mode_table(machine, machine.neutral(), kind);
}

std::vector<std::string> labels(const std::vector<modal::TabledMode>& modes) {
  std::vector<std::string> list;
  for (const auto& entry : modes) list.push_back(entry.label);
  return list;
}

TEST(Labels, OfThePublishedMachineNameMotionAndCompliance) {
  const auto table = table_of(machine_of("zhang-jiang-2021.toml"), ModelKind::guide);
  const auto found = labels(table.real.modes);
  EXPECT_EQ(found[0], "x, oil springs of all legs");
  EXPECT_EQ(found[1], "y, oil springs of all legs");
  EXPECT_EQ(found[2], "local seal mode");
  EXPECT_EQ(found[12], "x, guide sleeves of all legs");
  EXPECT_EQ(found[13], "y, guide sleeves of all legs");
  EXPECT_EQ(found[14], "rz, oil springs of all legs");
  EXPECT_EQ(found[15], "z, oil springs of all legs");
  EXPECT_EQ(found[16], "ry, oil springs of all legs");
  EXPECT_EQ(found[17], "rx, oil springs of all legs");
}

TEST(Labels, OfTheHeavyMachineBlameTheKnees) {
  const auto machine = machine_of("heavy-platform.toml");
  const auto table = table_of(machine, ModelKind::guide);
  const auto& lowest = table.real.modes[0];
  EXPECT_THAT(lowest.label, HasSubstr("guide sleeves"));
  ASSERT_TRUE(lowest.rigid);
  EXPECT_LT(lowest.rigid->shift, -0.25) << "a third, as in the case that is told";
  EXPECT_GT(lowest.rigid->shift, -0.45);
}

modal::EnergyShares shares_of(const spatial::Vector6& platform) {
  modal::EnergyShares shares;
  shares.platform = platform;
  shares.oil.setConstant(1.0 / 6.0);
  return shares;
}

TEST(Labels, NameDirectionsByTheirSharesAndLegsByWhatTheyHold) {
  auto shares = shares_of({0.5, 0.0, 0.0, 0.0, 0.3, 0.0});
  EXPECT_EQ(modal::platform_directions(shares), "x + ry");
  EXPECT_EQ(modal::mode_label(shares, true), "x + ry, oil springs of all legs");
  shares.oil << 0.0, 0.0, 0.1, 0.0, 0.0, 0.0;
  shares.guide_sleeve << 0.0, 0.4, 0.0, 0.45, 0.05, 0.0;
  EXPECT_EQ(modal::mode_label(shares, true), "x + ry, guide sleeves of legs 2 and 4");
  shares.guide_sleeve << 0.0, 0.0, 0.0, 0.0, 0.0, 0.9;
  EXPECT_EQ(modal::mode_label(shares, false),
            "unstable (buckling): x + ry, guide sleeves of leg 6");
  shares.guide_sleeve.setZero();
  shares.piston_ring << 0.3, 0.3, 0.3, 0.0, 0.0, 0.0;
  EXPECT_EQ(modal::mode_label(shares, true), "x + ry, piston rings of legs 1, 2 and 3");
  shares.platform.setZero();
  EXPECT_EQ(modal::mode_label(shares, true), "local piston-ring mode");
}

/// The share of a rigid mode that is found in a flexible one sums to one over all of them, because
/// the flexible modes are a complete basis.
TEST(RigidCounterpart, SharesSumToOneOverAllModes) {
  Random random(31);
  for (int i = 0; i < 20; ++i) {
    const auto kind = i % 2 == 0 ? ModelKind::guide : ModelKind::full;
    auto machine = random_machine(random, {.gravity = i % 4 < 2 ? Gravity::none : Gravity::down});
    const auto table = table_of(machine, kind);
    const auto& M = table.real.linear.M;
    const auto& rigid = table.rigid.normal.shapes;
    for (int r = 0; r < 6; ++r) {
      const spatial::Vector6 psi = rigid.col(r);
      const double norm = psi.dot(M.topLeftCorner<6, 6>() * psi);
      double sum = 0.0;
      for (int k = 0; k < table.real.normal.size(); ++k)
        sum += std::pow(psi.dot(M.topRows<6>() * table.real.normal.shapes.col(k)), 2) / norm;
      EXPECT_NEAR(sum, 1.0, 1e-12);
    }
  }
}

/// With seals a thousand times stiffer than the oil every rigid mode has its own counterpart.
TEST(RigidCounterpart, OfStiffSealsIsTheModeItself) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness = 1e11;
  const auto table = table_of(machine, ModelKind::guide);
  for (int k = 0; k < 6; ++k) {
    const auto& rigid = table.real.modes[k].rigid;
    ASSERT_TRUE(rigid);
    EXPECT_EQ(rigid->mode, k);
    EXPECT_NEAR(rigid->mac, 1.0, 1e-3);
    EXPECT_NEAR(rigid->shift, 0.0, 1e-3);
  }
}

/// One strong damper makes the rigid modes complex. On stiff seals the flexible mode is the rigid
/// one, a + ib, and of it the share of a is (aᵀMa)²/(aᵀMa) + (aᵀMb)²/(aᵀMa), however long a is.
TEST(RigidCounterpart, OfAComplexModeIsTheShareOfItsRealPart) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness = 1e11;
  machine.legs[1].oil_spring.damping = 3.1e4;
  machine.legs[2].oil_spring.damping = 1.7e4;
  const auto table = table_of(machine, ModelKind::guide);
  const auto& M = table.rigid.linear.M;
  double shortest = 1.0;
  for (int k = 0; k < 6; ++k) {
    const auto& rigid = table.real.modes[static_cast<std::size_t>(k)].rigid;
    ASSERT_TRUE(rigid);
    EXPECT_EQ(rigid->mode, k);
    const auto& mode = table.rigid.modes[static_cast<std::size_t>(k)].mode;
    const double own = mode.real.dot(M * mode.real), other = mode.real.dot(M * mode.imaginary);
    EXPECT_NEAR(rigid->mac, own + other * other / own, 1e-3) << k;
    shortest = std::min(shortest, own);
  }
  EXPECT_LT(shortest, 0.9);
}

TEST(RigidCounterpart, HasOnlyWhatThePlatformFeels) {
  const auto table = table_of(symmetric_machine(), ModelKind::guide);
  int unfelt = 0;
  for (const auto& entry : table.real.modes) {
    EXPECT_EQ(entry.rigid.has_value(), entry.moves_platform);
    unfelt += !entry.moves_platform;
  }
  EXPECT_GE(unfelt, 6) << "those of symmetry, and those that it feels less than 1e-4";
  for (const auto& entry : table_of(symmetric_machine(), ModelKind::rigid).real.modes)
    EXPECT_FALSE(entry.rigid);
}

TEST(MatchModes, FindsEveryModeInItself) {
  Random random(33);
  for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full}) {
    const auto table = table_of(random_machine(random), kind);
    const auto match = modal::match_modes(table.real, table.real);
    for (int k = 0; k < static_cast<int>(match.size()); ++k) EXPECT_EQ(match[k], k);
  }
}

/// A shape times −1, or turned in phase, is the same mode.
TEST(MatchModes, SignsAndPhasesOfShapesDoNotCount) {
  Random random(35);
  const auto table = table_of(random_machine(random), ModelKind::guide);
  auto turned = table.real;
  for (std::size_t k = 0; k < turned.modes.size(); ++k) {
    auto& mode = turned.modes[k].mode;
    if (k % 3 == 0) mode.real *= -1.0;
    if (k % 3 == 1) {
      mode.imaginary = 0.8 * mode.real;
      mode.real *= -0.6;
    }
  }
  const auto match = modal::match_modes(turned, table.real);
  for (int k = 0; k < static_cast<int>(match.size()); ++k)
    EXPECT_EQ(match[static_cast<std::size_t>(k)], k);
}

/// Of transverse axes a gimbal axis states the components of tilts, and nothing else.
TEST(MatchModes, ModesAreTheSameBesideAnotherAxis) {
  Random random(36);
  for (const auto kind : {ModelKind::guide, ModelKind::full}) {
    auto machine = random_machine(random, {.axes = model::FlexibleAxes::transverse});
    const auto before = table_of(machine, kind);
    for (auto& leg : machine.legs) leg.gimbal_axis = random.direction();
    const auto now = table_of(machine, kind);
    const auto match = modal::match_modes(now.real, before.real);
    for (std::size_t k = 0; k < match.size(); ++k) {
      ASSERT_EQ(match[k], static_cast<int>(k));
      EXPECT_NEAR(now.real.modes[k].mode.omega / before.real.modes[k].mode.omega, 1.0, 1e-9);
    }
  }
}

TEST(MatchModes, PairsOneToOneAcrossKinds) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs) leg.piston_ring->stiffness = 1e9;  // hardly changes the others
  const auto guide = table_of(machine, ModelKind::guide), full = table_of(machine, ModelKind::full);
  const auto match = modal::match_modes(full.real, guide.real);
  std::vector<int> used(18, 0);
  int without = 0;
  for (const int before : match) before < 0 ? ++without : ++used[before];
  EXPECT_EQ(without, 12) << "the piston-ring modes are new";
  EXPECT_THAT(used, testing::Each(1));
  for (int k = 0; k < 18; ++k) {
    const auto& before = guide.real.modes[match[k]];
    EXPECT_NEAR(full.real.modes[k].mode.omega / before.mode.omega, 1.0, 1e-3);
    EXPECT_EQ(full.real.modes[k].moves_platform, before.moves_platform);
  }
  EXPECT_EQ(match[0], 0);
  EXPECT_EQ(match[1], 1);
}

TEST(LowestFelt, IsMinusOneWhereThereIsNone) {
  auto table = table_of(symmetric_machine(), ModelKind::guide);
  EXPECT_EQ(modal::lowest_platform_mode(table.real.modes), 0);
  for (auto& entry : table.real.modes) entry.moves_platform = false;
  EXPECT_EQ(modal::lowest_platform_mode(table.real.modes), -1);
}

/// Heavy dampers change the order of modes; the table still says which undamped mode became which.
TEST(TabledOfNormal, FindsEachUndampedModeInTheTable) {
  Random random(34);
  auto machine = random_machine(random);
  const auto table = table_of(machine, ModelKind::guide);
  std::vector<int> seen = table.real.tabled_of_normal;
  std::sort(seen.begin(), seen.end());
  for (int k = 0; k < static_cast<int>(seen.size()); ++k) EXPECT_EQ(seen[k], k);
}

}  // namespace
}  // namespace hydrapod::test
