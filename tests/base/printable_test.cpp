/// Text from outside, made fit for a message.

#include "hydrapod/base/text.hpp"

#include <gtest/gtest.h>

#include <string>

namespace hydrapod::base {
namespace {

TEST(Printable, KeepsOrdinaryText) {
  EXPECT_EQ(printable("kg·m² – 12°"), "kg·m² – 12°");
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, ReplacesControlsAndBrokenBytes) {
  EXPECT_EQ(printable("a\x1b[31m\nb\x7f"), "a?[31m?b?");
  EXPECT_EQ(printable("\xff\xc3"), "??");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
  EXPECT_EQ(printable("\xC2\x85"), "?");  // a control character beyond ASCII
}

TEST(Printable, CutsBetweenCharacters) {
  EXPECT_EQ(printable("abcdef", 6), "abcdef");
  EXPECT_EQ(printable("abcdefg", 6), "abcdef...");
  EXPECT_EQ(printable("abcde²", 6), "abcde...");
}

TEST(Utf8, IsCheckedAsTheStandardSays) {
  EXPECT_EQ(first_invalid_utf8("kg·m² 𝛗"), std::string_view::npos);
  EXPECT_EQ(first_invalid_utf8("ab\xff"), 2u);
  EXPECT_EQ(first_invalid_utf8("ab\xc3"), 2u);            // cut off
  EXPECT_EQ(first_invalid_utf8("\xc0\x80"), 0u);          // overlong
  EXPECT_EQ(first_invalid_utf8("\xe0\x80\x80"), 0u);      // overlong
  EXPECT_EQ(first_invalid_utf8("\xed\xa0\x80"), 0u);      // surrogate
  EXPECT_EQ(first_invalid_utf8("\xf4\x90\x80\x80"), 0u);  // beyond U+10FFFF
}

}  // namespace
}  // namespace hydrapod::base
