#include "hydrapod/observation/pairing.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "observation/pair_cost.hpp"
#include "support/calibration_machine.hpp"

namespace hydrapod::observation {
namespace {

/// What all moves in one phase is real once that phase is taken out, and as large as before.
TEST(TurnedToReal, KeepsTheSizeOfAMotionOfOnePhase) {
  spatial::Vector6 real;
  real << 0.31, -1.7, 0.052, 0.9, -0.41, 2.3;
  for (const double phase : {-2.9, -1.1, 0.0, 0.37, 1.57, 3.1}) {
    const Vector6c turned =
        turned_to_real(std::polar(1.3, phase) * real.cast<std::complex<double>>());
    EXPECT_TRUE(turned.imag().isZero(0.0));
    const double sign = turned[5].real() > 0.0 ? 1.0 : -1.0;
    EXPECT_LE((turned.real() - sign * 1.3 * real).norm(), 1e-14 * real.norm()) << phase;
  }
}

/// Else the part that is largest in the mean square is kept: the other is smaller.
TEST(TurnedToReal, KeepsTheLargestPart) {
  Vector6c motion;
  motion << std::complex<double>(0.4, 0.11), std::complex<double>(-1.2, 0.3),
      std::complex<double>(0.2, -0.5), std::complex<double>(0.9, 0.08),
      std::complex<double>(0.1, 0.2), std::complex<double>(-0.3, -0.6);
  const double kept = turned_to_real(motion).norm();
  double most = 0.0;
  for (int k = 0; k < 1000; ++k)
    most = std::max(most, (motion * std::polar(1.0, 0.00314159 * k)).real().norm());
  EXPECT_NEAR(kept, most, 1e-5 * most);
}

/// Undamped poles by their distance, damped ones by their decay too; the group of a mode does not
/// go on to its neighbours' neighbours.
TEST(Groups, AreWhatNoMeasurementSeparates) {
  using Pole = std::complex<double>;
  const std::vector<Pole> undamped{{0, 10.0}, {0, 10.04}, {0, 10.08}, {0, 10.2}};
  EXPECT_EQ(group_of_each(undamped),
            (std::vector<std::vector<int>>{{0, 1}, {0, 1, 2}, {1, 2}, {3}}));
  EXPECT_EQ(groups_of(undamped), (std::vector<std::vector<int>>{{0, 1, 2}, {3}}));
  const std::vector<Pole> damped{{-1.0, 10.0}, {-0.9, 30.0}, {-1.1, 10.15}, {-0.1, 10.4}};
  EXPECT_EQ(groups_of(damped), (std::vector<std::vector<int>>{{0, 2}, {1}, {3}}));
  EXPECT_EQ(groups_of(damped, {.same_decay = 0.05}).size(), 4U);
}

/// A direction contradicts a mode where it has less than a quarter of the platform's energy, and no
/// mode of its group has more.
TEST(Directions, ContradictModesThatMoveOtherwise) {
  Observation seen;
  seen.mechanics.platform_mass = Vector6(2.0, 2.0, 2.0, 0.7, 0.7, 0.7).asDiagonal();
  const auto mode = [&](const Vector6& energy) {
    ObservedMode made;
    made.shape = energy.cwiseQuotient(seen.mechanics.platform_mass.diagonal())
                     .cwiseSqrt()
                     .cast<std::complex<double>>() *
                 std::polar(1.0, 0.77);
    seen.modes.push_back(made);
  };
  mode({0.61, 0.0, 0.13, 0.0, 0.26, 0.0});
  mode({0.0, 0.97, 0.0, 0.01, 0.0, 0.0});
  mode({0.0, 0.0, 0.0011, 0.0, 0.0, 0.0003});
  const auto contradicted = [&](int k, const std::vector<int>& group, int direction) {
    return contradicted_direction(seen, k, group, direction);
  };
  EXPECT_FALSE(contradicted(0, {0}, 0));
  EXPECT_FALSE(contradicted(0, {0}, 4)) << "26 % of the energy";
  EXPECT_EQ(contradicted(0, {0}, 2), 0) << "13 % of the energy";
  EXPECT_EQ(contradicted(0, {0}, 1), 0);
  EXPECT_FALSE(contradicted(0, {0, 1}, 1)) << "a measurement shows any mixture of the two";
  EXPECT_FALSE(contradicted(2, {2}, 0)) << "it can hardly be seen to move the platform";
}

/// Two frequencies that have crossed: names tell them apart, order does not.
TEST(Pairing, FollowsNamesThroughACrossing) {
  test::Random random(3);
  const auto file = test::machine_file(test::random_machine_text(random, false));
  const auto model =
      dynamics::linear_model(file.machine, file.machine.neutral(), dynamics::ModelKind::rigid);
  const auto modes = modal::normal_modes(model);
  auto targets = test::modes_of(file, "neutral", dynamics::ModelKind::rigid);
  std::vector<int> labelled;
  for (int k = 0; k < 6; ++k)
    if (targets[k].direction) labelled.push_back(k);
  ASSERT_GE(labelled.size(), 2U);
  const int a = labelled[0], b = labelled[1];
  ASSERT_NE(targets[a].direction, targets[b].direction);
  std::swap(targets[a].omega, targets[b].omega);
  SeenPoint point{.seen = {.mechanics = model, .modes = undamped_modes(model, modes)}};
  const auto paired = [&] {
    EXPECT_TRUE(pair_seen(targets, {0, 1, 2, 3, 4, 5}, point));
    return point.mode_of;
  };
  EXPECT_EQ(paired()[a], a);
  EXPECT_EQ(paired()[b], b);
  for (auto& target : targets) target.direction.reset();
  EXPECT_EQ(paired()[a], b);
  // a measured shape says the same as a name
  for (int k = 0; k < 6; ++k) targets[k].shape = modes.shapes.col(k).head<6>();
  EXPECT_EQ(paired()[a], a);
}

}  // namespace
}  // namespace hydrapod::observation
