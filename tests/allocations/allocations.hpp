#pragma once
/// How often the program has asked for memory. Only for test programs whose malloc is wrapped by
/// the linker (tests/CMakeLists.txt), which catches Eigen's allocations and those of operator new
/// alike.

#include <atomic>

namespace hydrapod::test {

extern std::atomic<long> allocations;

}  // namespace hydrapod::test
