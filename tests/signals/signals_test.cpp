/// Signals over time: their shapes, their rates, that they repeat.

#include "hydrapod/signals/signals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace hydrapod::signals {
namespace {

const Vector6 sizes = (Vector6() << 0.011, -0.007, 0.013, 0.021, -0.017, 0.019).finished();

Trajectory some_trajectory() {
  Trajectory trajectory{.times = {0.31, 0.52, 0.97, 1.13, 2.41}};
  for (size_t k = 0; k < trajectory.times.size(); ++k)
    trajectory.points.push_back(std::sin(1.7 * static_cast<double>(k)) * sizes);
  return trajectory;
}

std::vector<Sample> samples(const std::vector<Signal>& signals, double rate, int count) {
  Generator generator(signals, rate);
  std::vector<Sample> found;
  for (int k = 0; k < count; ++k) found.push_back(generator.next());
  return found;
}

struct Named {
  std::string name{};
  Form form{};
  double fade{};
};
void PrintTo(const Named& named, std::ostream* out) { *out << named.name; }

class EverySignal : public testing::TestWithParam<Named> {};

/// Central differences of the values give the rates: the signal is smooth where it claims to be.
TEST_P(EverySignal, HasTheRateOfItsValues) {
  constexpr double T = 1e-4;
  const auto found = samples({{sizes, GetParam().form, GetParam().fade, 7}}, 1.0 / T, 30000);
  double worst = 0.0, largest = 0.0;
  for (size_t k = 1; k + 1 < found.size(); ++k) {
    const Vector6 slope = (found[k + 1].value - found[k - 1].value) / (2.0 * T);
    worst = std::max(worst, (slope - found[k].rate).norm());
    largest = std::max(largest, found[k].rate.norm());
  }
  // Relative error of a central difference is (ωT)²/6; 6e-5 at 30 Hz.
  EXPECT_LT(worst, 1e-3 * largest);
  EXPECT_GT(largest, 1e-3);
}

TEST_P(EverySignal, BeginsAtRestAndRepeatsToTheBit) {
  Generator generator({{sizes, GetParam().form, GetParam().fade, 7}}, 1e3);
  std::vector<Sample> first;
  for (int k = 0; k < 500; ++k) first.push_back(generator.next());
  EXPECT_EQ(first.front().rate.norm(), 0.0);
  generator.restart();
  for (const auto& sample : first) {
    const Sample again = generator.next();
    ASSERT_EQ(again.value, sample.value);
    ASSERT_EQ(again.rate, sample.rate);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, EverySignal,
    testing::Values(Named{"Step", Step{0.2, 0.35}}, Named{"Sine", Sine{3.3}, 0.4},
                    Named{"LogSweep", Sweep{0.7, 29.0, 2.3, true}, 0.3},
                    Named{"LinearSweep", Sweep{0.7, 29.0, 2.3, false}, 0.3},
                    Named{"DownwardSweep", Sweep{29.0, 0.7, 2.3, true}, 0.3},
                    Named{"SweepInTurns", Sweep{0.7, 29.0, 0.4, true, 1, true}, 0.1},
                    Named{"Chirp", Chirp{0.7, 29.0, 3.1}, 0.4},
                    Named{"Multisine", Multisine{0.5, 11.0, 1.9}, 0.4},
                    Named{"SteepMultisine", Multisine{0.5, 11.0, 1.9, -6.0, true, 4}, 0.4},
                    Named{"Noise", Noise{0.5, 11.0}, 0.4}, Named{"LowNoise", Noise{0.0, 4.0}, 0.4},
                    Named{"SteepNoise", Noise{2.0, 30.0, -9.0}, 0.4},
                    Named{"Trajectory", some_trajectory()}),
    [](const auto& one) { return one.param.name; });

TEST(Step, IsThereAtItsSample) {
  const auto found = samples({{sizes, Step{0.3}}}, 1e3, 302);
  EXPECT_EQ(found[299].value.norm(), 0.0);
  EXPECT_EQ(found[300].value, sizes);
  EXPECT_EQ(found[300].rate.norm(), 0.0);
}

TEST(Sweep, PassesItsFrequenciesAtTheirTimes) {
  for (const bool logarithmic : {true, false}) {
    const auto found = samples({{sizes, Sweep{2.0, 18.0, 4.0, logarithmic}, 0.1}}, 1e4, 40001);
    // Zero crossings per second in the second around half time: 6 Hz or 10 Hz.
    int crossings = 0;
    for (size_t k = 18000; k < 22000; ++k)
      crossings += (found[k].value[0] > 0.0) != (found[k + 1].value[0] > 0.0);
    EXPECT_NEAR(crossings / 2.0 / 0.4, logarithmic ? 6.0 : 10.0, 1.3);
    EXPECT_EQ(found.back().value.norm(), 0.0);
  }
}

TEST(Noise, OfDifferentDirectionsAndSeedsIsIndependent) {
  constexpr size_t size = 40000;
  const auto one = samples({{sizes, Noise{0.0, 40.0}, 0.0, 1}}, 250.0, size);
  const auto other = samples({{sizes, Noise{0.0, 40.0}, 0.0, 2}}, 250.0, size);
  const auto correlation = [&](const auto& a, int i, const auto& b, int j) {
    double ab = 0.0, aa = 0.0, bb = 0.0;
    for (size_t k = 0; k < size; ++k) {
      ab += a[k].value[i] * b[k].value[j];
      aa += a[k].value[i] * a[k].value[i];
      bb += b[k].value[j] * b[k].value[j];
    }
    return ab / std::sqrt(aa * bb);
  };
  // 160 s of 40 Hz: 12800 independent values; 4 sigma.
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT(std::abs(correlation(one, i, other, i)), 0.036);
    for (int j = 0; j < i; ++j) EXPECT_LT(std::abs(correlation(one, i, one, j)), 0.036);
  }
}

TEST(Trajectory, PassesItsPointsAndRestsOutside) {
  const auto trajectory = some_trajectory();
  const auto found = samples({{.form = trajectory}}, 100.0, 300);
  EXPECT_EQ(found[10].value, trajectory.points.front());
  EXPECT_LT((found[97].value - trajectory.points[2]).norm(), 1e-15);
  EXPECT_EQ(found[299].value, trajectory.points.back());
  EXPECT_EQ(found[299].rate.norm(), 0.0);
}

TEST(Trajectory, FollowsAParabolaExactlyInside) {
  Trajectory trajectory;
  for (const double t : {0.0, 0.13, 0.29, 0.61, 0.8, 1.1}) {
    trajectory.times.push_back(t);
    trajectory.points.push_back((0.3 - 1.1 * t + 0.7 * t * t) * sizes);
  }
  const auto found = samples({{.form = trajectory}}, 100.0, 80);
  for (int k = 13; k <= 79; ++k) {
    const double t = 1e-2 * k;
    EXPECT_LT((found[static_cast<size_t>(k)].value - (0.3 - 1.1 * t + 0.7 * t * t) * sizes).norm(),
              1e-15);
  }
}

/// Two of a list have their own random numbers; with a seed of its own a signal is the same
/// anywhere.
TEST(Noise, OfOneListIsIndependentUnlessSeedsSayOtherwise) {
  const Signal noise{sizes, Noise{0.0, 40.0}, 0.0}, seeded{sizes, Noise{0.0, 40.0}, 0.0, 5};
  const auto one = samples({noise}, 250.0, 100);
  const auto both = samples({noise, noise}, 250.0, 100);
  const auto alone = samples({seeded}, 250.0, 100);
  const auto second = samples({noise, seeded}, 250.0, 100);
  EXPECT_NE(both[50].value, Vector6(2.0 * one[50].value));
  EXPECT_EQ(second[50].value, Vector6(one[50].value + alone[50].value));
}

TEST(Sine, HasTheLevelThatIsAskedFor) {
  EXPECT_EQ(samples({{sizes, Sine{5.0}, 0.0}}, 100.0, 6)[5].value, sizes);  // a quarter period
  EXPECT_EQ(samples({{sizes, Sine{5.0, true}, 0.0}}, 100.0, 6)[5].value,
            Vector6(std::sqrt(2.0) * sizes));
  EXPECT_EQ(period_samples({{sizes, Sine{12.5}}}, 100.0), 8);
  EXPECT_EQ(period_samples({{sizes, Sine{M_PI}}}, 100.0), std::nullopt);
}

TEST(Chirp, TogetherMovesAllDirections) {
  const auto found = samples({{sizes, Chirp{1.0, 20.0, 0.5}, 0.0}}, 1e3, 1000);
  for (size_t k = 0; k < 500; ++k) {
    ASSERT_EQ(found[k].value, found[k + 500].value);
    ASSERT_LT((found[k].value - found[k].value[0] / sizes[0] * sizes).norm(), 1e-16);
  }
}

TEST(Signals, AddUp) {
  const Signal sine{sizes, Sine{3.0}, 0.2}, step{sizes, Step{0.1, 0.1}};
  const auto one = samples({sine}, 1e3, 400);
  const auto other = samples({step}, 1e3, 400);
  const auto both = samples({sine, step}, 1e3, 400);
  for (size_t k = 0; k < both.size(); ++k)
    ASSERT_EQ(both[k].value, Vector6(one[k].value + other[k].value));
  for (const auto& sample : samples({}, 1e3, 3)) EXPECT_EQ(sample.value.norm(), 0.0);
}

TEST(Signals, ThatMakeNoSenseAreNamed) {
  const auto complaint = [](const Form& form) -> std::string {
    try {
      require_sound({sizes, form}, 1e3);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(Step{-1.0}), "step: at is -1, expected 0 s or more");
  EXPECT_EQ(
      complaint(Sine{500.0}),
      "sine: frequency is 500, expected more than 0 and less than 500 Hz, half the sample rate");
  EXPECT_EQ(complaint(Sweep{0.0, 20.0}),
            "sweep: from is 0, expected more than 0 and less than 500 Hz, half the sample rate");
  EXPECT_EQ(complaint(Noise{20.0, 20.0}), "noise: from is 20, expected less than `to`");
  EXPECT_EQ(complaint(Multisine{1.1, 1.2, 2.0}),
            "multisine: period is 2, expected one so long that a multiple of 1/period lies in the "
            "band");
  EXPECT_EQ(complaint(Multisine{1.0, 2.0, 1e9}),
            "multisine: period is 1e+09, expected two to ten million samples, in seconds");
  EXPECT_EQ(complaint(Trajectory{{0.0, 0.0}, {sizes, sizes}}),
            "trajectory: time is 0, expected more than the one before");
}

}  // namespace
}  // namespace hydrapod::signals
