/// Channels that stand still for a part of a record: what was not measured, and what is meant so.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hammer.hpp"

namespace hydrapod::identification {
namespace {

using Kind = data::ResponseWarning::Kind;

std::vector<data::ResponseWarning> warnings_of(const FrequencyResponses& r, Kind kind) {
  std::vector<data::ResponseWarning> found;
  for (const auto& warning : r.warnings)
    if (warning.kind == kind) found.push_back(warning);
  return found;
}

constexpr Eigen::Index rows = 41000;

/// White noise moves the beam; an input and three outputs.
data::Record shaken(std::uint64_t seed) {
  return test::record_of(beam(), {.sample_rate = hammer_rate,
                                  .samples = static_cast<int>(rows),
                                  .output_noise = Eigen::Vector3d(1e-5, 2e-5, 1e-5),
                                  .seed = seed});
}

/// Half of a record of a channel is left, or less.
void expect_beam_of(const FrequencyResponses& responses) {
  const auto truth = beam();
  const auto found = identify_modes(responses);
  ASSERT_EQ(found.modes.size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) {
    SCOPED_TRACE(r);
    EXPECT_NEAR(found.modes[r].fit.omega() / std::abs(truth.modes[r].pole), 1.0, 2e-3);
    EXPECT_GT(mac(found.modes[r].fit.shape, truth.modes[r].shape), 0.995);
  }
}

TEST(Held, AnOutputWhoseCableWasOffForHalfOfTheRecordIsMissingThere) {
  for (std::uint64_t seed = 3; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    auto record = shaken(seed);
    const Eigen::Index off = 20317;
    record.samples.col(2).tail(rows - off).setConstant(0.0137);
    const auto r = measured({record}).responses;
    const auto held = warnings_of(r, Kind::held);
    ASSERT_EQ(held.size(), 1U);
    EXPECT_EQ(held[0].channel, "y2");
    EXPECT_EQ(held[0].count, rows - off);
    EXPECT_EQ(held[0].total, 1);
    EXPECT_NEAR(held[0].share, 0.5045, 1e-4);
    EXPECT_NEAR(held[0].value, static_cast<double>(rows - off) / hammer_rate, 1e-9);
    expect_beam_of(r);
  }
}

TEST(Held, ALooseContactIsMissingInEachOfItsRuns) {
  auto record = shaken(11);
  for (const Eigen::Index from : {1203, 9871, 23417, 31999})
    record.samples.col(3).segment(from, 613).setConstant(-1.7e-3);
  const auto r = measured({record}).responses;
  const auto held = warnings_of(r, Kind::held);
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].channel, "y3");
  EXPECT_EQ(held[0].total, 4);
  EXPECT_EQ(held[0].count, 4 * 613);
  expect_beam_of(r);
}

TEST(Held, AnOutputThatIsHardlyEverThereIsLeftOut) {
  auto record = shaken(13);
  record.samples.col(1).tail(rows - 3511).setZero();
  const auto r = measured({record}).responses;
  EXPECT_EQ(warnings_of(r, Kind::held).size(), 1U);
  ASSERT_EQ(r.outputs.size(), 2U);
  EXPECT_EQ(r.outputs[0].name, "y2");
}

TEST(Held, AForceWhoseCableWasOffIsMissingWhileTheOutputsMove) {
  auto record = shaken(17);
  record.samples.col(0).segment(15013, 9007).setConstant(0.31);
  const auto r = measured({record}).responses;
  const auto held = warnings_of(r, Kind::held);
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].channel, "u1");
  expect_beam_of(r);
}

/// A recorder that lost all channels at once writes zeros, or its last values.
TEST(Held, DropOutsOfAllChannelsAreMissing) {
  for (const bool zeros : {true, false}) {
    SCOPED_TRACE(zeros);
    auto record = shaken(41);
    std::int64_t lost = 0;
    for (const Eigen::Index from : {1203, 9871, 17017, 23417, 31999}) {
      const Eigen::Index length = 83 + from % 271;
      lost += length;
      for (Eigen::Index k = 0; k < length; ++k)
        record.samples.row(from + k) =
            zeros ? Eigen::RowVectorXd::Zero(4) : record.samples.row(from).eval();
    }
    const auto r = measured({record}).responses;
    const auto found = warnings_of(r, Kind::drop_outs);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].total, 5);
    EXPECT_EQ(found[0].count, lost);
    EXPECT_NEAR(found[0].share, static_cast<double>(lost) / static_cast<double>(rows), 1e-12);
    EXPECT_THAT(warnings_of(r, Kind::held), testing::IsEmpty());
    expect_beam_of(r);
  }
}

/// A force in bursts, and a machine that comes to rest within the resolution.
TEST(Held, ARestBetweenBurstsIsNoDropOut) {
  auto record = shaken(43);
  Eigen::VectorXd decay = Eigen::VectorXd::Ones(rows);
  for (Eigen::Index k = 0; k < rows; ++k)
    if (k % 1711 > 700) {
      record.samples(k, 0) = 0.0;
      decay[k] = std::exp(-0.05 * static_cast<double>(k % 1711 - 700));
    }
  for (Eigen::Index c = 1; c < 4; ++c) {
    const double step = record.samples.col(c).cwiseAbs().maxCoeff() / 400.0;
    record.samples.col(c) =
        ((record.samples.col(c).cwiseProduct(decay) / step).array().round() * step).eval();
  }
  EXPECT_THAT(warnings_of(measured({record}).responses, Kind::drop_outs), testing::IsEmpty());
}

/// No channel of these was lost.
TEST(Held, WhatStandsStillWithTheExcitationIsMeantSo) {
  auto begins_late = shaken(19), coarse = shaken(23), slow = shaken(29), pulses = shaken(31);
  begins_late.samples.topRows(7013).setZero();
  // 5 steps to either side
  const double step = 0.2 * coarse.samples.rightCols(3).cwiseAbs().maxCoeff();
  coarse.samples.rightCols(3) =
      ((coarse.samples.rightCols(3) / step).array().round() * step).eval();
  // a sensor that is read 300 times for each of its values
  for (Eigen::Index k = 0; k < rows; ++k) slow.samples(k, 2) = slow.samples(k - k % 300, 2);
  // a force in bursts, without noise
  for (Eigen::Index k = 0; k < rows; ++k)
    if (k % 1711 > 700) pulses.samples(k, 0) = 0.0;
  for (const auto* record : {&begins_late, &coarse, &slow, &pulses})
    EXPECT_THAT(warnings_of(measured({*record}).responses, Kind::held), testing::IsEmpty());
}

TEST(Held, AnOutputThatRepeatsAnotherIsSaid) {
  auto record = shaken(37);
  EXPECT_THAT(warnings_of(measured({record}).responses, Kind::repeated_output), testing::IsEmpty());
  record.samples.col(3) = record.samples.col(1);
  auto hit = hammer_record({}, 41);
  hit.samples.col(3) = hit.samples.col(1);
  for (const auto* own : {&record, &hit}) {
    const auto repeated = warnings_of(measured({*own}).responses, Kind::repeated_output);
    ASSERT_EQ(repeated.size(), 1U);
    EXPECT_EQ(repeated[0].channel, "y3");
    EXPECT_EQ(repeated[0].other, "y1");
  }
}

// tops that are cut off

std::vector<std::string> clipped_of(const data::Record& record) {
  std::vector<std::string> names;
  for (const auto& warning : warnings_of(measured({record}).responses, Kind::clipped))
    names.push_back(warning.channel);
  return names;
}

TEST(Clipped, AForceOfAHammerThatIsCutOffIsSaidHoweverShortItIs) {
  for (std::uint64_t seed = 51; seed <= 55; ++seed) {
    SCOPED_TRACE(seed);
    auto record = hammer_record({}, seed);
    EXPECT_THAT(clipped_of(record), testing::IsEmpty());
    record.samples.col(0) =
        record.samples.col(0).cwiseMin(0.53 * record.samples.col(0).maxCoeff()).eval();
    EXPECT_THAT(clipped_of(record), testing::ElementsAre("u1"));
  }
}

TEST(Clipped, FirstSwingsOfAnOutputThatAreCutOffAreSaid) {
  auto record = hammer_record({.noise = 1e-3}, 61);
  const double limit = 0.59 * record.samples.col(2).cwiseAbs().maxCoeff();
  record.samples.col(2) = record.samples.col(2).cwiseMin(limit).cwiseMax(-limit).eval();
  EXPECT_THAT(clipped_of(record), testing::ElementsAre("y2"));
}

TEST(Clipped, StepsOfTheResolutionAndHeldSamplesAreNoTopsThatAreCutOff) {
  for (const double levels : {5.0, 17.0, 127.0, 2047.0}) {
    SCOPED_TRACE(levels);
    auto record = hammer_record({.noise = 1e-3}, 71);
    for (Eigen::Index c = 0; c < record.samples.cols(); ++c) {
      const double step = record.samples.col(c).cwiseAbs().maxCoeff() / levels;
      record.samples.col(c) = ((record.samples.col(c) / step).array().round() * step).eval();
    }
    EXPECT_THAT(clipped_of(record), testing::IsEmpty());
  }
  auto held = hammer_record({}, 73);
  for (Eigen::Index k = 0; k < held.samples.rows(); ++k)
    held.samples.row(k) = held.samples.row(k - k % 4).eval();
  EXPECT_THAT(clipped_of(held), testing::IsEmpty());
}

}  // namespace
}  // namespace hydrapod::identification
