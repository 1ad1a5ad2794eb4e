/// Grids that are finer where modes cross or veer: by closed forms.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "hydrapod/base/error.hpp"
#include "hydrapod/tasks/study.hpp"

namespace hydrapod::tasks {
namespace {

using Values = std::vector<double>;

/// A grid over x and y whose modes are these functions: MAC first, then frequencies.
StudyJob grid_of(Values x, Values y, std::function<Values(double, double)> modes) {
  StudyJob job;
  const auto input = [](const char* name, Values list) {
    study::Distribution values{.shape = study::Shape::values};
    values.list = std::move(list);
    return study::Input{.name = name, .unit = "m", .distribution = values};
  };
  job.plan = {.design = study::Design::grid,
              .samples = x.size() * y.size(),
              .counts = {static_cast<int>(x.size()), static_cast<int>(y.size())}};
  job.rows = job.plan.samples;
  job.bytes = 40.0 * static_cast<double>(job.rows);
  job.problem.inputs = {input("x", std::move(x)), input("y", std::move(y))};
  job.problem.outputs = {{"mac", "1", ""}, {"mode1", "Hz", ""}, {"mode2", "Hz", ""}};
  job.problem.model = [modes] {
    return [modes](std::span<const double> at, std::span<double> to) {
      std::ranges::copy(modes(at[0], at[1]), to.begin());
    };
  };
  return job;
}

const Values& values_of(const StudyJob& job, std::size_t input) {
  return job.problem.inputs[input].distribution.list;
}

/// Interval of the list in which a number lies.
double step_at(const Values& list, double number) {
  const auto above = std::ranges::upper_bound(list, number);
  return *above - *(above - 1);
}

TEST(RefinedGrids, AreFineWhereModesCross) {
  // 5.1 + 3 x = 6.9 − 2.7 y: a line through the grid
  auto job = grid_of({-0.4, -0.1, 0.2, 0.5, 0.8}, {0.31}, [](double x, double y) {
    return Values{0.99, 5.1 + 3.0 * x, 6.9 - 2.7 * y};
  });
  const double crossing = (6.9 - 2.7 * 0.31 - 5.1) / 3.0;
  EXPECT_THAT(refine_grid(job, 4), testing::ElementsAre(4, 0));
  EXPECT_NEAR(step_at(values_of(job, 0), crossing), 0.3 / 16.0, 1e-12);
  EXPECT_NEAR(step_at(values_of(job, 0), -0.3), 0.3, 1e-12);
  for (const double asked : {-0.4, -0.1, 0.2, 0.5, 0.8})
    EXPECT_THAT(values_of(job, 0), testing::Contains(asked));
  EXPECT_EQ(job.rows, 9U);
  EXPECT_EQ(job.plan.samples, 9U);
  EXPECT_EQ(job.bytes, 40.0 * 9.0);
  EXPECT_THAT(job.plan.counts, testing::ElementsAre(9, 1));
}

/// A crossing is seen along each input, wherever on the others it is.
TEST(RefinedGrids, AreFineAlongBothInputs) {
  auto job = grid_of({0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 2.0}, [](double x, double y) {
    const bool there = x > 1.7 && x < 2.3 && y > 1.2;
    return Values{1.0, 4.0, there ? 3.0 : 5.0};
  });
  EXPECT_THAT(refine_grid(job, 1), testing::ElementsAre(2, 1));
  EXPECT_THAT(values_of(job, 0), testing::ElementsAre(0.0, 1.0, 1.5, 2.0, 2.5, 3.0));
  EXPECT_THAT(values_of(job, 1), testing::ElementsAre(0.0, 1.0, 1.5, 2.0));
}

/// Two coupled oscillators: the frequencies come near each other and do not cross. Shapes that are
/// followed change from one to the other.
TEST(RefinedGrids, AreFineWhereModesVeer) {
  Values x;
  for (int k = 0; k <= 10; ++k) x.push_back(0.1 * k);
  auto job = grid_of(x, {1.0}, [](double at, double) {
    const double off = at - 0.437, half = std::hypot(off, 0.02);
    const double branch = std::copysign(half, off);
    return Values{0.5 * (1.0 + std::abs(off) / half), 7.0 + branch, 7.0 - branch};
  });
  refine_grid(job, 3);
  EXPECT_NEAR(step_at(values_of(job, 0), 0.437), 0.1 / 8.0, 1e-12);
  EXPECT_NEAR(step_at(values_of(job, 0), 0.05), 0.1, 1e-12);
  EXPECT_NEAR(step_at(values_of(job, 0), 0.95), 0.1, 1e-12);
}

/// The MAC tells of modes that mix with others than the followed ones.
TEST(RefinedGrids, AreFineWhereTheMacChanges) {
  auto job = grid_of({0.0, 1.0, 2.0, 3.0}, {0.0, 1.0}, [](double x, double) {
    return Values{x < 1.3 ? 0.98 : x < 2.5 ? 0.87 : 0.79, 4.0, 5.0};
  });
  EXPECT_THAT(refine_grid(job, 1), testing::ElementsAre(1, 0));
  EXPECT_THAT(values_of(job, 0), testing::ElementsAre(0.0, 1.0, 1.5, 2.0, 3.0));
}

TEST(RefinedGrids, AreFineAroundAValueWhereModesAreEqual) {
  auto job = grid_of({-2.0, -1.0, 0.0, 1.0, 2.0}, {0.0}, [](double x, double) {
    return Values{1.0, 6.0 + x, 6.0 - x};
  });
  refine_grid(job, 2);
  EXPECT_THAT(values_of(job, 0),
              testing::ElementsAre(-2.0, -1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0, 2.0));
  // they touch and do not cross: symmetric machines are so in the middle
  auto touching = grid_of({-2.0, -1.0, 0.0, 1.0, 2.0}, {0.0}, [](double x, double) {
    return Values{1.0, 6.0 + x * x, 6.0};
  });
  EXPECT_THAT(refine_grid(touching, 2), testing::ElementsAre(0, 0));
}

/// Equal frequencies of symmetric machines, which differ by rounding, and poses out of reach.
TEST(RefinedGrids, StayAsTheyAreWhereNothingCrosses) {
  auto job = grid_of({0.0, 1.0, 2.0, 3.0}, {0.0, 1.0}, [](double x, double) {
    const double none = std::nan("");
    if (x > 2.5) return Values{none, none, none};
    return Values{1.0, 5.0 + x, (5.0 + x) * (1.0 + (x > 0.5 ? 1e-12 : -1e-12))};
  });
  EXPECT_THAT(refine_grid(job, 5), testing::ElementsAre(0, 0));
  EXPECT_EQ(job.rows, 8U);
}

TEST(RefinedGrids, HaveALimit) {
  auto job = grid_of({0.0, 1.0}, {0.0, 1.0}, [](double x, double y) {
    return Values{1.0, x + 10.3, y + 10.0};
  });
  try {
    refine_grid(job, 9, {}, {.most_rows = 5});
    FAIL() << job.rows;
  } catch (const base::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "--refine 9: error: the grid has 9 rows after 1 of them, and is refined up to 5; "
                 "take fewer values, or refine less often");
  }
  auto random = job;
  random.plan.design = study::Design::random;
  EXPECT_THROW(refine_grid(random, 1), std::invalid_argument);
}

/// In a list without order it is not known what lies between.
TEST(RefinedGrids, HaveValuesInOrder) {
  const auto equal = [](double x, double) { return Values{1.0, x, 0.5}; };
  auto falling = grid_of({3.0, 1.0, 0.0}, {0.0}, equal);
  EXPECT_THAT(refine_grid(falling, 1), testing::ElementsAre(1, 0));
  EXPECT_THAT(values_of(falling, 0), testing::ElementsAre(3.0, 1.0, 0.5, 0.0));
  auto mixed = grid_of({1.0, 3.0, 0.0}, {0.0}, equal);
  try {
    refine_grid(mixed, 1);
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "--refine 1: error: halves intervals between neighbours; expected the values of x "
                 "in ascending or descending order");
  }
}

TEST(RefinedGrids, CanBeInterrupted) {
  auto job = grid_of({0.0, 1.0}, {0.0}, [](double x, double) { return Values{1.0, x, 0.5}; });
  EXPECT_THROW(refine_grid(job, 1, [](double) { return true; }), base::ComputationError);
}

}  // namespace
}  // namespace hydrapod::tasks
