// What protects the program against damaged and hostile input is in the binary.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using testing::HasSubstr;

#if defined(__SANITIZE_ADDRESS__)
constexpr bool sanitized = true;
#elif defined(__has_feature)
constexpr bool sanitized = __has_feature(address_sanitizer);
#else
constexpr bool sanitized = false;
#endif

class Hardening : public testing::Test {
 protected:
  void SetUp() override {
    if (sanitized) GTEST_SKIP() << "sanitizers replace what is asked for here";
  }
  static std::string read(const std::string& what) {
    const auto result =
        test::run_program("readelf", {"--wide", what, test::hydrapod_program().string()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  }
};

/// The line of `text` that contains `word`.
std::string line_with(const std::string& text, const std::string& word) {
  const auto at = text.find(word);
  if (at == std::string::npos) return {};
  const auto from = text.rfind('\n', at) + 1;
  return text.substr(from, text.find('\n', at) - from);
}

TEST_F(Hardening, StandsAnywhereInMemory) {
  EXPECT_THAT(line_with(read("--file-header"), "Type:"), HasSubstr("DYN"));
  EXPECT_THAT(line_with(read("--dynamic"), "FLAGS_1"), HasSubstr("PIE"));
}

TEST_F(Hardening, TablesOfTheLinkerAreReadOnly) {
  EXPECT_THAT(read("--program-headers"), HasSubstr("GNU_RELRO"));
  EXPECT_THAT(line_with(read("--dynamic"), "FLAGS_1"), HasSubstr("NOW"));
}

TEST_F(Hardening, TheStackHoldsNoCode) {
  const auto stack = line_with(read("--program-headers"), "GNU_STACK");
  EXPECT_THAT(stack, HasSubstr(" RW "));
}

TEST_F(Hardening, StackAndBuffersAreWatched) {
  const auto symbols = read("--dyn-syms");
  EXPECT_THAT(symbols, HasSubstr("__stack_chk_fail"));
  EXPECT_THAT(symbols, testing::ContainsRegex("__(read|memcpy|snprintf|vsnprintf|memset)_chk"));
}

TEST_F(Hardening, ContainersAreWatched) {
  // what libstdc++ calls where an index is out of bounds
  EXPECT_THAT(read("--dyn-syms"), HasSubstr("__glibcxx_assert_fail"));
}

}  // namespace
}  // namespace hydrapod
