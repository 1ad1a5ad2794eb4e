/// Responses at iω for other programs, whatever the record.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "exact/modal_system.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

/// A hit on something that does not vibrate: the outputs follow the force, in noise.
data::Record hit_without_modes() {
  constexpr double rate = 1024.0;
  data::Record record;
  record.header.channels = {{"force", "N", data::Direction::z, data::Role::excitation, 0},
                            {"a 1", "m/s^2", data::Direction::z, data::Role::response, 1},
                            {"a 2", "m/s^2", data::Direction::x, data::Role::response, 2}};
  record.header.sample_rate = rate;
  record.samples.resize(3071, 3);
  Random random(5);
  for (Eigen::Index k = 0; k < record.samples.rows(); ++k) {
    const double t = static_cast<double>(k) / rate - 0.131;
    const double force = t >= 0.0 && t < 4e-3 ? 640.0 * std::sin(std::numbers::pi * t / 4e-3) : 0.0;
    record.samples.row(k) << force + 0.2 * normal(random), 0.037 * force + 0.11 * normal(random),
        -0.011 * force + 0.09 * normal(random);
  }
  return record;
}

TEST(SharedResponses, OfHitsWithoutAModeAreThePlainRatio) {
  const TemporaryFolder folder;
  data::write_record(folder / "hit.h5", hit_without_modes(), data::RecordFormat::hdf5);
  const auto measured = tasks::frf({.files = {folder / "hit.h5"}});
  ASSERT_GT(measured.responses().shift, 0.0);
  ASSERT_TRUE(identification::identify_modes(measured.responses()).modes.empty());
  const auto shared = tasks::shared_responses(measured);
  ASSERT_EQ(shared.on_axis.size(), shared.lines());
  const auto r = data::brought_to_axis(shared);
  for (std::size_t k = 0; k < r.lines() && r.frequency[k] < 100.0; ++k) {
    EXPECT_NEAR(r.H[k](0, 0).real(), 0.037, 0.02);
    EXPECT_NEAR(r.H[k](1, 0).real(), -0.011, 0.02);
  }
  // what is written is read again
  const auto table = data::response_table(shared);
  write_text(folder / "hit.csv", table);
  const auto again = tasks::frf({.files = {folder / "hit.csv"}});
  EXPECT_EQ(again.responses().on_axis.size(), shared.lines());
}

}  // namespace
}  // namespace hydrapod::test
