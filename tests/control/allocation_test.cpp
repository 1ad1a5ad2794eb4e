/// A sample of the controller allocates nothing. This program's malloc is wrapped by the linker
/// (tests/CMakeLists.txt), which catches Eigen's allocations and those of operator new alike.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "example_parameters.hpp"

namespace {
std::atomic<long> allocations{};
}

extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* old, std::size_t size);
void* __wrap_malloc(std::size_t size) {
  ++allocations;
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __real_calloc(count, size);
}
void* __wrap_realloc(void* old, std::size_t size) {
  ++allocations;
  return __real_realloc(old, size);
}
}

void* operator new(std::size_t size) {
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace hydrapod::control {
namespace {

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
