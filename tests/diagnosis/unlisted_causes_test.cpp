/// Some cases of the series with causes that are not on the list; all of them with ./test --long.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/unlisted_causes.hpp"

namespace hydrapod::test {
namespace {

/// Of the first machine, which is the published one.
UnlistedCase published_case(const std::string& physics) {
  for (auto& one : unlisted_cases(1))
    if (one.physics.find(physics) != std::string::npos) return one;
  throw std::runtime_error("no case: " + physics);
}

class UnlistedCause : public testing::TestWithParam<const char*> {};

TEST_P(UnlistedCause, IsNotBlamedOnAListedPart) {
  const auto result = run_unlisted(published_case(GetParam()));
  const auto& d = result.diagnosis;
  EXPECT_GT(result.change, 0.005);
  EXPECT_TRUE(!result.blamed || result.right_part) << verdict(d);
  if (d.finding != diagnosis::Finding::unexplained) return;
  EXPECT_THAT(report::reason_words(d).front(), testing::HasSubstr("even the best hypothesis"));
  expect_round_trip_of({.diagnosis = d});
}

INSTANTIATE_TEST_SUITE_P(OfThePublishedMachine, UnlistedCause,
                         testing::Values("hose", "rocks", "pose wrong"));

/// A frequency that a spring to the ground adds to is that of two springs in parallel: without legs
/// that bend, K + k.
TEST(UnlistedCauses, HoseIsASpringBesideTheLegs) {
  const auto test = published_case("spring under a corner");
  const auto file = machine_file(test.basic.text(), test.basic.design);
  const auto& pose = file.machine.poses.front();
  const auto model = dynamics::linear_model(file.machine, pose.X_BP, dynamics::ModelKind::guide);
  const auto before = modes_at(file.machine, pose, dynamics::ModelKind::guide);
  const auto after = test.modes(file.machine, pose);
  // the sum of ω² is the trace of M⁻¹K, to which the spring adds k rᵀ M⁻¹ r > 0 only
  EXPECT_GT(after.omega.squaredNorm(), before.omega.squaredNorm());
  for (Eigen::Index k = 0; k < before.omega.size(); ++k)
    EXPECT_GE(after.omega[k], before.omega[k] * (1.0 - 1e-9)) << k;
  // Σ over modes of φφᵀ is M⁻¹, whatever the springs
  const auto inverse = [](const PoseModes& m) -> Eigen::MatrixXd {
    return m.motions * m.motions.transpose();
  };
  EXPECT_LT((inverse(after) - inverse(before)).norm(), 1e-9 * inverse(before).norm());
  EXPECT_EQ(after.omega.size(), model.dof());
}

/// A payload that swings adds a mode, and with a stiff spring it is rigid.
TEST(UnlistedCauses, SwingingPayloadAddsAMode) {
  const auto test = published_case("sways");
  const auto file = machine_file(test.basic.text(), test.basic.design);
  const auto& pose = file.machine.poses.front();
  const auto before = modes_at(file.machine, pose, dynamics::ModelKind::guide);
  const auto after = test.modes(file.machine, pose);
  ASSERT_EQ(after.omega.size(), before.omega.size() + 1);
  // one more coordinate: the modes interlace (Rayleigh)
  for (Eigen::Index k = 0; k < before.omega.size(); ++k) {
    EXPECT_LE(after.omega[k], before.omega[k] * (1.0 + 1e-9)) << k;
    EXPECT_GE(after.omega[k + 1], before.omega[k] * (1.0 - 1e-9)) << k;
  }
}

}  // namespace
}  // namespace hydrapod::test
