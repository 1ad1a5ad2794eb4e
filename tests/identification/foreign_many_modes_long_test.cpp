/// Many modes, few references, many outputs, over 60 seeds.

#include <gtest/gtest.h>

#include "many_modes.hpp"

namespace hydrapod::identification {
namespace {

struct Case {
  std::string name;
  ManyModes made;
  double least_found{0.99};  ///< of all modes; close pairs with one reference are hard
};

class ManyModesOfOthers : public testing::TestWithParam<Case> {};

TEST_P(ManyModesOfOthers, AreAllFoundAndNoOther) {
  const auto& [name, made, least_found] = GetParam();
  const auto score = score_of_many(made, 60);
  test::print_class(name, "hydrapod", score.ours);
  test::print_class(name, "pLSCF, orders 2 … 40, stable poles", score.textbook);
  EXPECT_GE(score.ours.found_share(), least_found);
  EXPECT_LE(score.ours.false_per_seed(), 0.1);
  EXPECT_GE(score.ours.frequency_coverage(), 0.92);
  EXPECT_GE(score.ours.damping_coverage(), 0.92);
  EXPECT_GE(score.ours.shape_coverage(), 0.92);
  EXPECT_LE(score.unexplained, 3);
}

INSTANTIATE_TEST_SUITE_P(
    Foreign, ManyModesOfOthers,
    testing::Values(
        Case{"12 modes, 26 outputs, 1 reference, 5 % noise, no variances", {}},
        Case{"the same with variances", {.known = true}},
        Case{"20 modes, 26 outputs, 1 reference, 5 % noise, no variances", {.modes = 20}},
        Case{"20 modes, 26 outputs, 2 references, 5 % noise, no variances",
             {.modes = 20, .references = 2}},
        Case{"20 modes, 26 outputs, 3 references, 5 % noise, variances",
             {.modes = 20, .references = 3, .known = true}},
        Case{"12 modes, every third of a close pair, 2 references, variances",
             {.references = 2, .known = true, .close_pairs = true}},
        Case{"12 modes, every third of a close pair, 1 reference, no variances",
             {.close_pairs = true},
             0.97},
        Case{"chain of 20 masses, 1 reference, no variances",
             {.modes = 20, .outputs = 20, .masses = true}},
        Case{"chain of 12 masses, 2 references, variances",
             {.modes = 12, .outputs = 12, .references = 2, .known = true, .masses = true}}),
    [](const auto& info) { return "Case" + std::to_string(info.index + 1); });

}  // namespace
}  // namespace hydrapod::identification
