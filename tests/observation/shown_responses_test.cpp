/// What a model shows on the channels of measured responses.

#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "hydrapod/base/units.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "support/published_machine.hpp"

namespace hydrapod::observation {
namespace {

using data::Direction;
using spatial::Matrix6;
using spatial::Vector3;
using testing::HasSubstr;

data::FrequencyResponses at(double frequency, std::vector<data::Channel> inputs,
                            std::vector<data::Channel> outputs) {
  return {.inputs = std::move(inputs), .outputs = std::move(outputs), .frequency = {frequency}};
}

/// Motion of a point of the platform per motion of the mass centre.
Matrix6 motion_of(const Vector3& from_center) {
  Matrix6 point = Matrix6::Identity();
  point.topRightCorner<3, 3>() = -spatial::skew(from_center);
  return point;
}

struct Subject {
  model::Machine machine{test::published_machine()};
  spatial::Pose X_BP{machine.neutral()};
  Observation seen{observe(machine, X_BP, dynamics::ModelKind::rigid, Observed::mechanics)};
  ComparisonFrame frame{machine, X_BP, X_BP* Vector3(0.31, -0.17, 0.23)};
  Vector3 p_BF{X_BP * Vector3(-0.41, 0.29, 0.13)};
};

/// Far below the modes the platform yields as its stiffness says, which knows nothing of poles.
TEST(ShownResponses, OfSlowForcesAreTheCompliance) {
  const Subject of;
  const double f = 1e-4;
  const auto measured = at(f,
                           {{.name = "Fx", .unit = "N", .direction = Direction::x},
                            {.name = "-My", .unit = "N m", .direction = Direction::minus_ry}},
                           {{.name = "z", .unit = "m", .direction = Direction::z},
                            {.name = "-ry", .unit = "rad", .direction = Direction::minus_ry},
                            {.name = "leg", .unit = "m", .direction = data::leg_direction(3)},
                            {.name = "a", .unit = "m/s^2", .direction = Direction::x},
                            {.name = "p", .unit = "Pa", .direction = data::leg_direction(3)}});
  const auto shown = shown_responses(measured, of.frame, of.seen, of.p_BF);
  ASSERT_EQ(shown.why_not, "");
  const auto& model = of.seen.mechanics;
  Eigen::Matrix<double, 6, 2> forces = Eigen::Matrix<double, 6, 2>::Zero();
  forces(0, 0) = 1.0;
  forces(4, 1) = -1.0;
  const Eigen::Matrix<double, 6, 2> yield = model.K.topLeftCorner<6, 6>().inverse() *
                                            motion_of(of.p_BF - model.p_BC).transpose() * forces;
  const Eigen::Matrix<double, 6, 2> at_Q = motion_of(of.frame.p_BQ - model.p_BC) * yield;
  const auto J =
      kinematics::leg_jacobian(kinematics::inverse_kinematics(of.machine, of.X_BP), model.p_BC);
  Eigen::Matrix<double, 4, 2> expected;
  expected << at_Q.row(2), -at_Q.row(4), J.row(2) * yield,
      -std::pow(base::two_pi * f, 2) * at_Q.row(0);
  for (int o = 0; o < 4; ++o)
    for (int i = 0; i < 2; ++i)
      EXPECT_LT(std::abs(shown.H[0](o, i) - expected(o, i)), 1e-4 * expected.row(o).norm());
  EXPECT_TRUE(std::isnan(shown.H[0](4, 0).real()));
}

TEST(ShownResponses, SayWhyThereAreNone) {
  const Subject of;
  const data::Channel z{.name = "z", .unit = "m", .direction = Direction::z};
  const auto why_not = [&](const data::Channel& input, const data::Channel& output) {
    return shown_responses(at(1.0, {input}, {output}), of.frame, of.seen, of.p_BF).why_not;
  };
  const data::Channel Fz{.name = "Fz", .unit = "N", .direction = Direction::z};
  EXPECT_EQ(why_not(Fz, z), "");
  EXPECT_THAT(why_not({.name = "F", .unit = "N"}, z), HasSubstr("direction"));
  EXPECT_THAT(why_not({.name = "u", .unit = "V"}, z), HasSubstr("neither drives nor forces"));
  EXPECT_THAT(why_not({.name = "z command", .unit = "m", .direction = Direction::z}, z),
              HasSubstr("which only a controlled machine has"));
  EXPECT_THAT(why_not({.name = "valve", .unit = "1", .role = data::Role::drive}, z),
              HasSubstr("which only the plant has"));
  EXPECT_THAT(why_not(Fz, {.name = "p", .unit = "Pa"}), HasSubstr("no output is a motion"));
  auto averaged = at(1.0, {Fz}, {z});
  averaged.estimator = data::Estimator::half_spectra;
  EXPECT_THAT(shown_responses(averaged, of.frame, of.seen, of.p_BF).why_not,
              HasSubstr("excitation was not measured"));
}

}  // namespace
}  // namespace hydrapod::observation
