/// A sample of the controller allocates nothing.

#include <gtest/gtest.h>

#include <memory>

#include "allocations/allocations.hpp"
#include "example_parameters.hpp"

namespace hydrapod::control {
namespace {

using test::allocations;

TEST(Allocation, IsSeen) {
  const long before = allocations;
  const auto number = std::make_unique<double>(1.0);
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Constant(3, 3, *number);
  EXPECT_EQ(allocations - before, 2) << matrix;
}

TEST(Controller, AllocatesNothingInASample) {
  const auto machine = test::published_machine();
  for (const auto space : {model::ControlSpace::pose, model::ControlSpace::leg}) {
    auto parameters = test::example_parameters();
    parameters.space = space;
    Controller controller(machine, parameters);
    auto measured = test::exact_measurement(machine, parameters, machine.neutral());
    controller.reset(machine.neutral(), measured);
    const Command command{.X_BP = machine.neutral()};
    Vector6 drives = Vector6::Zero();
    const long before = allocations;
    for (int k = 0; k < 100; ++k) {
      measured.length[k % 6] += 1e-4;
      drives += controller.step(measured, command);
    }
    measured.length[0] = 9.0;  // no pose
    drives += controller.step(measured, command);
    EXPECT_EQ(allocations - before, 0);
    EXPECT_GT(drives.norm(), 0.0);
  }
}

}  // namespace
}  // namespace hydrapod::control
