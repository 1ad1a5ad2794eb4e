/// Commanded motions: their shapes, their rates, their spectra, that they repeat.

#include "hydrapod/simulation/command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

namespace hydrapod::simulation {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

const Vector6 sizes = (Vector6() << 0.011, -0.007, 0.013, 0.021, -0.017, 0.019).finished();

Trajectory some_trajectory() {
  Trajectory trajectory{.times = {0.31, 0.52, 0.97, 1.13, 2.41}};
  for (size_t k = 0; k < trajectory.times.size(); ++k)
    trajectory.points.push_back(std::sin(1.7 * static_cast<double>(k)) * sizes);
  return trajectory;
}

std::vector<Displacement> samples(const std::vector<CommandSpec>& specs, double sample_time,
                                  int count) {
  const auto signal = make_signal(specs, sample_time);
  std::vector<Displacement> found;
  for (int k = 0; k < count; ++k) found.push_back(signal->next());
  return found;
}

struct Named {
  std::string name{};
  CommandSpec spec{};
};
void PrintTo(const Named& named, std::ostream* out) { *out << named.name; }

class EverySignal : public testing::TestWithParam<Named> {};

/// Central differences of the values give the rates: the signal is smooth where it claims to be.
TEST_P(EverySignal, HasTheRateOfItsValues) {
  constexpr double T = 1e-4;
  const auto found = samples({GetParam().spec}, T, 30000);
  double worst = 0.0, largest = 0.0;
  for (size_t k = 1; k + 1 < found.size(); ++k) {
    const Vector6 slope = (found[k + 1].value - found[k - 1].value) / (2.0 * T);
    worst = std::max(worst, (slope - found[k].rate).norm());
    largest = std::max(largest, found[k].rate.norm());
  }
  // Relative error of a central difference is (ωT)²/6; 6e-5 at 30 Hz. Noise has power above its
  // band.
  EXPECT_LT(worst, 1e-3 * largest);
  EXPECT_GT(largest, 1e-3);
}

TEST_P(EverySignal, BeginsAtRestAndRepeatsToTheBit) {
  const auto signal = make_signal({GetParam().spec}, 1e-3);
  std::vector<Displacement> first;
  for (int k = 0; k < 500; ++k) first.push_back(signal->next());
  EXPECT_EQ(first.front().rate.norm(), 0.0);
  signal->restart();
  for (const auto& sample : first) {
    const Displacement again = signal->next();
    ASSERT_EQ(again.value, sample.value);
    ASSERT_EQ(again.rate, sample.rate);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, EverySignal,
    testing::Values(Named{"Step", Step{sizes, 0.2, 0.35}}, Named{"Sine", Sine{sizes, 3.3, 0.4}},
                    Named{"LogSweep", Sweep{sizes, 0.7, 29.0, 2.3, true, 0.3}},
                    Named{"LinearSweep", Sweep{sizes, 0.7, 29.0, 2.3, false, 0.3}},
                    Named{"Multisine", Multisine{sizes, 0.5, 11.0, 1.9, 7, 0.4}},
                    Named{"Noise", Noise{sizes, 0.5, 11.0, 7, 0.4}},
                    Named{"LowNoise", Noise{sizes, 0.0, 4.0, 7, 0.4}},
                    Named{"Trajectory", some_trajectory()}),
    [](const auto& one) { return one.param.name; });

TEST(Step, IsThereAtItsSample) {
  const auto found = samples({Step{sizes, 0.3, 0.0}}, 1e-3, 302);
  EXPECT_EQ(found[299].value.norm(), 0.0);
  EXPECT_EQ(found[300].value, sizes);
  EXPECT_EQ(found[300].rate.norm(), 0.0);
}

TEST(Sweep, PassesItsFrequenciesAtTheirTimes) {
  constexpr double T = 1e-4;
  for (const bool logarithmic : {true, false}) {
    const Sweep sweep{sizes, 2.0, 18.0, 4.0, logarithmic, 0.1};
    const auto found = samples({sweep}, T, 40001);
    // Zero crossings per second in the second around half time: 6 Hz or 10 Hz.
    int crossings = 0;
    for (size_t k = 18000; k < 22000; ++k)
      crossings += (found[k].value[0] > 0.0) != (found[k + 1].value[0] > 0.0);
    EXPECT_NEAR(crossings / 2.0 / 0.4, logarithmic ? 6.0 : 10.0, 1.3);
    EXPECT_EQ(found.back().value.norm(), 0.0);
  }
}

/// Coefficient of `frequency` in the samples of one direction.
std::complex<double> line(const std::vector<Displacement>& found, size_t begin, size_t count,
                          double cycles, int direction) {
  std::complex<double> sum;
  for (size_t k = 0; k < count; ++k)
    sum += found[begin + k].value[direction] *
           std::polar(1.0, -two_pi * cycles * static_cast<double>(k) / static_cast<double>(count));
  return 2.0 * sum / static_cast<double>(count);
}

TEST(Multisine, HasEqualLinesInItsBandAndNothingElse) {
  constexpr double T = 2e-3, period = 4.0;
  constexpr size_t size = 2000;
  const Multisine spec{sizes, 2.0, 9.0, period, 20261120, 0.5};
  const auto found = samples({spec}, T, 3 * size);
  const int lines = (9 - 2) * 4 + 1;
  for (int direction = 0; direction < 6; ++direction) {
    const double amplitude = std::abs(sizes[direction]) * std::sqrt(2.0 / lines);
    for (int cycles = 1; cycles < 60; ++cycles) {
      const double expected = cycles >= 8 && cycles <= 36 ? amplitude : 0.0;
      EXPECT_NEAR(std::abs(line(found, size, size, cycles, direction)), expected, 1e-14);
    }
    double square = 0.0;
    for (size_t k = 0; k < size; ++k)
      square += std::pow(found[size + k].value[direction], 2) / size;
    EXPECT_NEAR(std::sqrt(square), std::abs(sizes[direction]), 1e-14);
  }
  for (size_t k = 0; k < size; ++k) ASSERT_EQ(found[size + k].value, found[2 * size + k].value);
}

TEST(Noise, HasItsLevelAndKeepsToItsBand) {
  constexpr double T = 4e-3;
  constexpr size_t size = 50000;  // 200 s
  const Noise spec{sizes, 2.0, 12.0, 5, 0.0};
  const auto found = samples({spec}, T, size);
  // 200 s of 10 Hz bandwidth: 4000 independent values, RMS known to 1/√8000 = 1.1 %; 4 sigma.
  for (int direction = 0; direction < 6; ++direction) {
    double square = 0.0, sum = 0.0;
    for (const auto& sample : found) {
      square += sample.value[direction] * sample.value[direction];
      sum += sample.value[direction];
    }
    EXPECT_NEAR(std::sqrt(square / size) / std::abs(sizes[direction]), 1.0, 0.045);
    EXPECT_LT(std::abs(sum / size), 0.01 * std::abs(sizes[direction]));
  }
  // Power per band of 2 Hz, over 1 s pieces, against the middle of the band: −3 dB at the corners.
  const auto power = [&](double from, double to) {
    double sum = 0.0;
    int count = 0;
    for (size_t begin = 0; begin + 250 <= size; begin += 250)
      for (double cycles = from; cycles < to; ++cycles, ++count)
        sum += std::norm(line(found, begin, 250, cycles, 0));
    return sum / count;
  };
  const double inside = power(5.0, 8.0);
  EXPECT_NEAR(power(12.0, 13.0) / inside, 0.5, 0.15);
  EXPECT_LT(power(30.0, 40.0) / inside, 0.01);
  EXPECT_LT(power(0.0, 1.0) / inside, 0.15);
}

TEST(Noise, OfDifferentDirectionsAndSeedsIsIndependent) {
  constexpr size_t size = 40000;
  const auto one = samples({Noise{sizes, 0.0, 40.0, 1, 0.0}}, 4e-3, size);
  const auto other = samples({Noise{sizes, 0.0, 40.0, 2, 0.0}}, 4e-3, size);
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
  const auto found = samples({trajectory}, 1e-2, 300);
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
  const auto found = samples({trajectory}, 1e-2, 80);
  for (int k = 13; k <= 79; ++k) {
    const double t = 1e-2 * k;
    EXPECT_LT((found[static_cast<size_t>(k)].value - (0.3 - 1.1 * t + 0.7 * t * t) * sizes).norm(),
              1e-15);
  }
}

TEST(Signals, AddUp) {
  const Sine sine{sizes, 3.0, 0.2};
  const Step step{sizes, 0.1, 0.1};
  const auto one = samples({sine}, 1e-3, 400);
  const auto other = samples({step}, 1e-3, 400);
  const auto both = samples({sine, step}, 1e-3, 400);
  for (size_t k = 0; k < both.size(); ++k)
    ASSERT_EQ(both[k].value, Vector6(one[k].value + other[k].value));
  for (const auto& sample : samples({}, 1e-3, 3)) EXPECT_EQ(sample.value.norm(), 0.0);
}

/// The twist of the commanded pose against differences of the pose, rotated and about an operating
/// pose that is itself rotated.
TEST(CommandAt, HasTheTwistOfItsPose) {
  const Pose operating{spatial::rotation_from_rpy({0.3, -0.2, 0.5}), {0.1, 0.2, 0.9}};
  const Displacement now{(Vector6() << 0.1, 0.2, -0.1, 0.4, -0.7, 0.6).finished(),
                         (Vector6() << 0.3, -0.1, 0.2, 0.9, 1.1, -0.8).finished()};
  constexpr double h = 1e-6;
  const auto at = [&](double t) {
    return command_at(operating, {now.value + t * now.rate, now.rate});
  };
  const auto before = at(-h), after = at(h);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(after.X_BP.R_BP * before.X_BP.R_BP.transpose()));
  Vector6 twist;
  twist << (after.X_BP.p_BP - before.X_BP.p_BP) / (2.0 * h), turn.angle() * turn.axis() / (2.0 * h);
  EXPECT_LT((twist - at(0.0).velocity).norm(), 1e-9);
  EXPECT_LT((command_at(operating, {}).X_BP.R_BP - operating.R_BP).norm(), 1e-15);
}

TEST(Signals, ThatMakeNoSenseAreNamed) {
  const auto complaint = [](const CommandSpec& spec) -> std::string {
    try {
      make_signal({spec}, 1e-3);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(Step{sizes, -1.0}), "step: at is -1, expected 0 s or more");
  EXPECT_EQ(complaint(Sine{sizes, 500.0}),
            "sine: frequency is 500, expected more than 0 and less than 500 Hz, half the "
            "controller's sample "
            "rate");
  EXPECT_EQ(complaint(Sweep{sizes, 0.0, 20.0}), "sweep: from is 0, expected more than 0 Hz");
  EXPECT_EQ(complaint(Noise{sizes, 30.0, 20.0}), "noise: from is 30, expected less than `to`");
  EXPECT_EQ(complaint(Multisine{sizes, 1.1, 1.2, 2.0}),
            "multisine: period is 2, expected one so long that a multiple of 1/period lies in the "
            "band");
  EXPECT_EQ(complaint(Multisine{sizes, 1.0, 2.0, 1e9}),
            "multisine: period is 1e+09, expected two samples to ten million samples");
  EXPECT_EQ(complaint(Trajectory{{0.0, 0.0}, {sizes, sizes}}),
            "trajectory: time is 0, expected more than the one before");
}

}  // namespace
}  // namespace hydrapod::simulation
