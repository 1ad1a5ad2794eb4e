/// Multibody files of machines whose joints have inertia of their own.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "hydrapod/exchange/exchange.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::exchange {
namespace {

constexpr auto axial = "added axial inertia, oil in lines";
constexpr auto crosses = "inertia of the gimbals' crosses";

bool lacks(const Machine& machine, MultibodyFormat format, const std::string& what) {
  const auto file = multibody_file(machine, machine.neutral(), dynamics::ModelKind::guide, format);
  return std::ranges::any_of(file.parity, [&](const ParityLine& line) {
    return line.held == Held::absent && line.what == what;
  });
}

TEST(MultibodyFiles, SayThatJointsHaveNoInertiaInSdfAndUrdf) {
  const auto plain = test::symmetric_machine(9.81);
  auto added = plain;
  added.legs[3].added_axial_inertia = 7.3;
  auto crossed = plain;
  crossed.flexible_axes = model::FlexibleAxes::gimbal;
  crossed.legs[1].gimbal_cross_inertia = 0.13;
  for (const auto format : {MultibodyFormat::mjcf, MultibodyFormat::sdf, MultibodyFormat::urdf}) {
    const bool named = format != MultibodyFormat::mjcf;  // it has armatures
    EXPECT_EQ(lacks(added, format, axial), named);
    EXPECT_EQ(lacks(crossed, format, crosses), named);
    EXPECT_FALSE(lacks(added, format, crosses));
    EXPECT_FALSE(lacks(plain, format, axial) || lacks(plain, format, crosses));
  }
}

}  // namespace
}  // namespace hydrapod::exchange
