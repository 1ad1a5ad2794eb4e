#include "hydrapod/numerics/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace hydrapod::numerics {
namespace {

TEST(ParallelFor, CallsEachTaskOnce) {
  for (const int threads : {0, 1, 2, 5}) {
    std::vector<std::atomic<int>> calls(103);
    EXPECT_TRUE(parallel_for(calls.size(), threads, [&](std::size_t i) { ++calls[i]; }));
    for (const auto& count : calls) EXPECT_EQ(count, 1);
  }
  EXPECT_TRUE(parallel_for(0, 3, [](std::size_t) { FAIL(); }));
}

TEST(ParallelFor, TellsProgressThatGrowsToOne) {
  std::vector<double> shares;
  parallel_for(
      7, 3, [](std::size_t) {},
      [&](double share) {
        shares.push_back(share);
        return false;
      });
  ASSERT_EQ(shares.size(), 14u);
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

TEST(ParallelFor, StopsWhenAsked) {
  std::atomic<int> calls{0};
  EXPECT_FALSE(parallel_for(
      1000, 2, [&](std::size_t) { ++calls; }, [](double share) { return share > 0.01; }));
  EXPECT_LT(calls, 20);
}

TEST(ParallelFor, BeginsNothingWhenAskedToStopAtOnce) {
  EXPECT_FALSE(parallel_for(
      5, 2, [](std::size_t) { FAIL(); }, [](double) { return true; }));
}

TEST(ParallelFor, WatchRemembersTheLargestShareAndTheStop) {
  std::vector<double> shares;
  Watch watch([&](double share) {
    shares.push_back(share);
    return share > 0.5;
  });
  EXPECT_FALSE(watch.at(0.4));
  EXPECT_FALSE(watch.stopped());
  EXPECT_TRUE(watch.at(0.6));
  EXPECT_TRUE(watch.stopped());
  EXPECT_EQ(shares, (std::vector<double>{0.4, 0.4, 0.6}));
}

TEST(ParallelFor, ThrowsWhatATaskThrows) {
  for (const int threads : {1, 4})
    EXPECT_THROW(parallel_for(50, threads,
                              [](std::size_t i) {
                                if (i == 13) throw std::runtime_error("13");
                              }),
                 std::runtime_error);
}

TEST(ParallelFor, PartOfMapsTheShare) {
  double seen = -1.0;
  const auto part = part_of(
      [&](double share) {
        seen = share;
        return share > 0.5;
      },
      0.25, 0.75);
  EXPECT_FALSE(part(0.5));
  EXPECT_EQ(seen, 0.5);
  EXPECT_TRUE(part(0.75));
  EXPECT_FALSE(static_cast<bool>(part_of({}, 0.0, 1.0)));
}

}  // namespace
}  // namespace hydrapod::numerics
