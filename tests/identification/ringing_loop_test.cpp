/// A closed loop that is nearly unstable rings for longer than a block lasts, or than the record.
/// What rings is no tone: to take it out as one raises the damping ratio of the mode beside it.
///
/// The loop is that of foreign_loop.hpp with more integral gain: its pole at 6.38 Hz decays by
/// 0.064 1/s at 4.0, 0.019 at 4.15, 0.0035 at 4.2. Blocks have 16 s.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foreign_loop.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::identification {
namespace {

using testing::Contains;
using testing::Field;

const auto rings = Field(&data::ResponseWarning::kind, data::ResponseWarning::Kind::rings);

Measurement ringing(double integral, Excitation excitation, std::uint64_t seed) {
  return foreign_measurement(foreign_plant(),
                             {.excitation = excitation, .integral = integral, .seed = seed});
}

/// Where it is named no mode is certain; where it is not, its mode is right or uncertain.
TEST(RingingLoops, GiveNoWrongModeBesideThemWithConfidence) {
  const auto plant = foreign_plant();
  const auto exact = plant.modes.front().pole;
  int named = 0;
  for (const double integral : {4.15, 4.2})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const auto m = ringing(integral, Excitation::noise, seed);
      const auto at = std::ranges::find(m.responses.warnings, data::ResponseWarning::Kind::rings,
                                        &data::ResponseWarning::kind);
      const bool is_named = at != m.responses.warnings.end();
      if (is_named) {
        ++named;
        EXPECT_NEAR(at->value, 6.376, 0.02) << seed;
      }
      for (const auto& mode : identify_modes(m.responses, foreign_band).modes) {
        if (is_named) EXPECT_LE(mode.quality(), 0.3);
        if (mode.quality() < 0.5 || mode.fit.omega() > 1.05 * std::abs(exact)) continue;
        EXPECT_NEAR(mode.fit.damping_ratio(), -exact.real() / std::abs(exact),
                    4.0 * mode.fit.damping_deviation)
            << integral << " " << seed;
      }
    }
  EXPECT_GE(named, 3);
}

TEST(RingingLoops, WithRoomToInstabilityAreNotNamed) {
  for (const double integral : {1.0, 2.5})
    EXPECT_THAT(ringing(integral, Excitation::noise, 4).responses.warnings,
                testing::Not(Contains(rings)));
}

/// A mode that rings for a sixth of the record under forces: decay 0.075 1/s, 80 s. Its half width
/// is the resolution of the record.
TEST(RingingModes, AreNoTones) {
  const Eigen::Matrix3d M = Eigen::Vector3d(3.17, 2.41, 5.03).asDiagonal();
  Eigen::Matrix3d K;
  K << 7300.0, -3100.0, 0.0, -3100.0, 8400.0, -5300.0, 0.0, -5300.0, 5300.0;
  // damping in proportion to M: 2 ζ ω = 0.149 1/s for all modes
  const auto system = masses_and_springs(M, 0.149 * M, K);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    test::Random random(seed);
    data::Record record;
    record.header.sample_rate = foreign_rate;
    for (const char* name : {"F1", "F2", "y1", "y2", "y3"})
      record.header.channels.push_back(
          {.name = name,
           .unit = name[0] == 'F' ? "N" : "m",
           .role = name[0] == 'F' ? data::Role::excitation : data::Role::response});
    record.samples.resize(20000, 5);
    test::ModalRun run(system, 1.0 / foreign_rate);
    for (Eigen::Index k = 0; k < record.samples.rows(); ++k) {
      const Eigen::Vector2d force(test::normal(random), test::normal(random));
      Eigen::Vector3d y = run.output();
      for (double& x : y) x += 2e-6 * test::normal(random);
      record.samples.row(k) << force.transpose(), y.transpose();
      run.advance(Eigen::Vector3d(force[0], force[1], 0.0));
    }
    const auto m = measured({record});
    EXPECT_TRUE(m.responses.harmonics.empty()) << seed;
    const auto found = identify_modes(m);
    ASSERT_FALSE(found.modes.empty()) << seed;
    const auto& lowest = found.modes.front().fit;
    const std::complex<double> exact = system.modes.front().pole;
    EXPECT_NEAR(lowest.omega(), std::abs(exact), 4.0 * lowest.omega_deviation) << seed;
    EXPECT_NEAR(lowest.damping_ratio(), -exact.real() / std::abs(exact),
                4.0 * lowest.damping_deviation)
        << seed;
  }
}

}  // namespace
}  // namespace hydrapod::identification
