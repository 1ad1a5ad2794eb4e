// A hammer test: a structure of unequal masses that is hit once, and rings down.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exact/modal_system.hpp"
#include "found_pole.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/identification/responses.hpp"
#include "support/identification_score.hpp"
#include "support/run_program.hpp"

namespace hydrapod::identification {
namespace {

using Kind = data::ResponseWarning::Kind;

test::ModalSystem beam() {
  return pushed_at_first({test::real_mode(23.71, 0.0113, Eigen::Vector3d(0.61, -0.83, 0.29)),
                          test::real_mode(61.37, 0.0171, Eigen::Vector3d(0.44, 0.52, -0.97)),
                          test::real_mode(118.3, 0.0062, Eigen::Vector3d(-0.73, 0.38, 0.66))},
                         1);
}

struct Hit {
  double seconds{4.0}, at{0.113};  ///< of the record, of the hit [s]
  double width{1.3e-3};            ///< of a half sine [s]
  double noise{3e-4};              ///< of the largest output
  double offset{};                 ///< of all channels, of the largest output
};

constexpr double rate = 2048.0;

data::Record hit_record(const Hit& hit, std::uint64_t seed) {
  const auto system = beam();
  test::Random random(seed);
  data::Record record{.header = test::header_of(1, 3, rate), .samples = {}};
  const auto samples = static_cast<Eigen::Index>(hit.seconds * rate);
  record.samples.resize(samples, 4);
  test::ModalRun run(system, 1.0 / rate);
  for (Eigen::Index k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) / rate - hit.at;
    const Eigen::VectorXd force = Eigen::VectorXd::Constant(
        1, t >= 0.0 && t < hit.width ? 870.0 * std::sin(std::numbers::pi * t / hit.width) : 0.0);
    record.samples(k, 0) = force[0];
    record.samples.row(k).tail(3) = run.output();
    run.advance(force);
  }
  const double largest = record.samples.rightCols(3).cwiseAbs().maxCoeff();
  for (double& y : record.samples.rightCols(3).reshaped())
    y += largest * (hit.noise * test::normal(random) + hit.offset);
  for (double& u : record.samples.col(0).reshaped()) u += 0.4 * test::normal(random) + 3.1;
  return record;
}

Measurement measured(const std::vector<data::Record>& records, const MeasureOptions& options = {}) {
  const test::TemporaryFolder folder;
  std::vector<std::string> files;
  for (const auto& record : records) {
    files.push_back(folder / ("hit" + std::to_string(files.size()) + ".h5"));
    data::write_record(files.back(), record, data::RecordFormat::hdf5);
  }
  data::RecordSet set(files);
  return measure_responses(set, options);
}

/// Responses of held samples are late by half a sample: less than a hundredth in damping here.
void expect_beam(const Identification& found) {
  const auto truth = beam();
  ASSERT_EQ(found.modes.size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) {
    SCOPED_TRACE(r);
    const auto& fit = found.modes[r].fit;
    const TruePole pole(truth.modes[r].pole);
    EXPECT_NEAR(fit.omega() / pole.omega, 1.0, 5e-4);
    EXPECT_NEAR(fit.damping_ratio() / pole.ratio, 1.0, 0.03);
    expect_within_deviations(fit, pole, 1e-5, 1e-3);
    EXPECT_GT(mac(fit.shape, truth.modes[r].shape), 0.999);
  }
}

TEST(Hits, OneRecordOfOneHitGivesAllModes) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    const auto m = measured({hit_record({}, seed)});
    ASSERT_THAT(m.responses.warnings, testing::SizeIs(1));
    EXPECT_EQ(m.responses.warnings[0].kind, Kind::single_block);
    EXPECT_GT(m.responses.shift, 0.0);
    expect_beam(identify_modes(m.responses));
  }
}

TEST(Hits, WhatHasNotRungDownAndOffsetsDoNotChangeDamping) {
  // e^(−ζωT) is 0.2 for the first mode
  expect_beam(identify_modes(measured({hit_record({.seconds = 1.0, .offset = 0.3}, 7)}).responses));
}

TEST(Hits, SeveralRecordsAreAveraged) {
  std::vector<data::Record> records;
  for (std::uint64_t seed = 11; seed <= 14; ++seed)
    records.push_back(
        hit_record({.at = 0.07 + 0.01 * static_cast<double>(seed), .noise = 2e-3}, seed));
  const auto m = measured(records);
  EXPECT_EQ(m.responses.warnings.at(0).count, 4);
  EXPECT_EQ(m.responses.averages, 4.0);
  expect_beam(identify_modes(m.responses));
}

TEST(Hits, ResponsesAreThoseOfTheSystemBesideTheAxisAndOnIt) {
  const auto system = beam();
  const auto r =
      measured({hit_record({.seconds = 7.0}, 23), hit_record({.seconds = 7.0, .at = 0.171}, 24)})
          .responses;
  ASSERT_EQ(r.on_axis.size(), r.lines());
  ASSERT_GT(r.lines(), 1000U);
  double largest = 0.0, beside = 0.0, on_axis = 0.0;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const Eigen::MatrixXcd H = system.sampled_response(r.frequency[k], 1.0 / rate);
    const double size = H.cwiseAbs().maxCoeff();
    largest = std::max(largest, size);
    on_axis = std::max(on_axis, (r.on_axis[k] - H).cwiseAbs().maxCoeff());
    beside =
        std::max(beside, (r.H[k] - system.sampled_response(r.frequency[k], 1.0 / rate, r.shift))
                             .cwiseAbs()
                             .maxCoeff());
  }
  EXPECT_LT(on_axis, 0.02 * largest);
  EXPECT_LT(beside, 0.02 * largest);
}

TEST(Hits, BlocksThatAreAskedForAndNoiseAreNoHits) {
  const auto record = hit_record({}, 3);
  EXPECT_THAT(measured({record}, {.block_length = 512}).responses.warnings,
              testing::Not(testing::Contains(
                  testing::Field(&data::ResponseWarning::kind, Kind::single_block))));
  const auto noise = test::record_of(beam(), {.sample_rate = rate, .samples = 1 << 14});
  for (const auto& warning : measured({noise}).responses.warnings)
    EXPECT_NE(warning.kind, Kind::single_block);
}

}  // namespace
}  // namespace hydrapod::identification
