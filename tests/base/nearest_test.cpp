/// Which known word was meant.

#include "hydrapod/base/text.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace hydrapod::base {
namespace {

constexpr std::array<std::string_view, 5> words{"stiffness", "damping", "mass", "mass_center", "a"};

TEST(EditDistance, CountsHalfEdits) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("", "abc"), 6);
  EXPECT_EQ(edit_distance("abc", "abc"), 0);
  EXPECT_EQ(edit_distance("abc", "abd"), 2);
  EXPECT_EQ(edit_distance("abc", "acb"), 2);
  EXPECT_EQ(edit_distance("abc", "ABC"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 6);
}

TEST(EditDistance, IsSymmetric) {
  for (const auto a : words) {
    for (const auto b : words) EXPECT_EQ(edit_distance(a, b), edit_distance(b, a));
  }
}

TEST(Nearest, FindsSlipsOfTheFinger) {
  EXPECT_EQ(nearest("stifness", words), "stiffness");
  EXPECT_EQ(nearest("Stiffness", words), "stiffness");
  EXPECT_EQ(nearest("dampign", words), "damping");
  EXPECT_EQ(nearest("MASS", words), "mass");
  EXPECT_EQ(nearest("mass_centre", words), "mass_center");
}

TEST(Nearest, DoesNotGuessWildly) {
  EXPECT_EQ(nearest("colour", words), std::nullopt);
  EXPECT_EQ(nearest("x", words), std::nullopt);
  EXPECT_EQ(nearest("", words), std::nullopt);
  EXPECT_EQ(nearest(std::string(1000, 'm'), words), std::nullopt);
  EXPECT_EQ(nearest("mass", {}), std::nullopt);
}

TEST(Nearest, PrefersTheFirstOfEquals) {
  constexpr std::array<std::string_view, 2> twins{"cat", "bat"};
  EXPECT_EQ(nearest("hat", twins), "cat");
}

}  // namespace
}  // namespace hydrapod::base
