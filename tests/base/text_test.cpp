#include "hydrapod/base/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydrapod::base {
namespace {

using testing::ElementsAre;

TEST(Text, TrimmedTakesBlanksOffBothEnds) {
  EXPECT_EQ(trimmed(" \ta b\r\n"), "a b");
  EXPECT_EQ(trimmed(""), "");
  EXPECT_EQ(trimmed(" \t "), "");
}

TEST(Text, LowerCaseChangesAsciiLettersOnly) { EXPECT_EQ(lower_case("HzÄ9z"), "hzÄ9z"); }

TEST(Text, SplitTrimsEveryPart) {
  EXPECT_THAT(split("1 .. 2", ".."), ElementsAre("1", "2"));
  EXPECT_THAT(split("a, b,,", ","), ElementsAre("a", "b", "", ""));
  EXPECT_THAT(split("", ","), ElementsAre(""));
}

TEST(Text, HasEndingIgnoresCase) {
  EXPECT_TRUE(has_ending("run.UFF", {".unv", ".uff"}));
  EXPECT_FALSE(has_ending("run.uff.txt", {".unv", ".uff"}));
}

}  // namespace
}  // namespace hydrapod::base
