/// Rows that a logger lost without a trace: they are found, and cost blocks instead of damping.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>

#include "foreign_loop.hpp"
#include "gapped.hpp"
#include "measured_records.hpp"
#include "output_only.hpp"

namespace hydrapod::identification {
namespace {

using Kind = data::ResponseWarning::Kind;

std::vector<data::ResponseWarning> said(const Measurement& m) {
  std::vector<data::ResponseWarning> found;
  for (const auto& warning : m.responses.warnings)
    if (warning.kind == Kind::lost_rows) found.push_back(warning);
  return found;
}

struct Loss {
  Eigen::Index row{}, count{};
};

constexpr Loss losses[] = {{3011, 7},   {9120, 17},  {14003, 39}, {21777, 5},  {26001, 28},
                           {33333, 12}, {38500, 33}, {44044, 9},  {51700, 21}, {56123, 8}};

/// Without the rows of the first so many `losses`; the others follow each other.
data::Record without_rows(const data::Record& whole, std::size_t count = std::size(losses)) {
  data::Record record{.header = whole.header,
                      .samples = data::Samples(whole.samples.rows(), whole.samples.cols())};
  Eigen::Index from = 0, to = 0;
  const auto copy = [&](Eigen::Index end) {
    record.samples.middleRows(to, end - from) = whole.samples.middleRows(from, end - from);
    to += end - from;
  };
  for (const auto& loss : std::span(losses).first(count)) {
    copy(loss.row);
    from = loss.row + loss.count;
  }
  copy(whole.samples.rows());
  record.samples = record.samples.topRows(to).eval();
  return record;
}

void expect_poles(const test::ModalSystem& system, const std::vector<IdentifiedMode>& modes) {
  ASSERT_EQ(modes.size(), system.modes.size());
  for (std::size_t r = 0; r < modes.size(); ++r) {
    const auto pole = system.modes[r].pole;
    EXPECT_NEAR(modes[r].fit.omega() / std::abs(pole), 1.0, 1e-3) << r;
    EXPECT_NEAR(modes[r].fit.damping_ratio() * std::abs(pole) / -pole.real(), 1.0, 0.1) << r;
  }
}

TEST(LostRows, AreSaidAndLeftOut) {
  const auto system = five_masses();
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(seed);
    const auto m = gapped_measurement(without_rows(gapped_record(system, {}, seed)));
    const auto found = said(m);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].count, std::ssize(losses));
    EXPECT_EQ(found[0].total, std::ssize(losses));
    EXPECT_NEAR(found[0].value, 3011.0 / 200.0, 1.5 / 200.0);
    expect_poles(system, identify_modes(m.responses).modes);
  }
}

/// Samples that are kept are looked through beside the spectra, others after them.
TEST(LostRows, AreTheSameOnAThreadOfTheirOwn) {
  const auto record = without_rows(gapped_record(five_masses(), {}, 4));
  const auto beside = measured({record}), after = measured({record}, {.most_kept = 0});
  ASSERT_EQ(said(beside).size(), 1U);
  ASSERT_EQ(said(after).size(), 1U);
  EXPECT_EQ(said(beside)[0].count, said(after)[0].count);
  EXPECT_EQ(said(beside)[0].value, said(after)[0].value);
  EXPECT_EQ(beside.responses.H, after.responses.H);
}

TEST(LostRows, InAllBlocksLowerQuality) {
  const auto system = five_masses();
  auto whole = gapped_record(system, {}, 7);
  data::Record record{.header = whole.header, .samples = data::Samples(48000, 8)};
  for (Eigen::Index piece = 0; piece < 40; ++piece)  // every 6 s
    record.samples.middleRows(piece * 1200, 1200) = whole.samples.middleRows(piece * 1219, 1200);
  const auto m = gapped_measurement(record);
  const auto found = said(m);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(found[0].count, 30);
  ASSERT_EQ(found[0].total, 0);
  for (const auto& mode : identify_modes(m.responses).modes) EXPECT_LT(mode.quality(), 0.4);
}

TEST(LostRows, AreNotMissingInTheFile) {
  const auto m = gapped_measurement(without_rows(gapped_record(five_masses(), {}, 1)));
  for (const auto& warning : m.responses.warnings) {
    EXPECT_NE(warning.kind, Kind::missing_samples);
    EXPECT_NE(warning.kind, Kind::blocks_left_out);
  }
}

/// 18 s with one of the places. Without losses such a record is identified in one piece.
TEST(LostRows, OfAShortRecordAreLeftOut) {
  const auto system = five_masses();
  auto record = without_rows(gapped_record(system, {}, 8));
  record.samples = record.samples.middleRows(2400, 3600).eval();
  const auto m = gapped_measurement(record);
  const auto found = said(m);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].count, 1);
  EXPECT_EQ(found[0].total, 1);
  const auto modes = identify_modes(m).modes;
  ASSERT_FALSE(modes.empty());
  for (const auto& mode : modes) {
    const auto error = [&](const test::ExactMode& own) {
      return std::abs(mode.fit.damping_ratio() + own.pole.real() / std::abs(own.pole)) /
             mode.fit.damping_deviation;
    };
    const auto nearest = std::ranges::min_element(system.modes, {}, [&](const auto& own) {
      return std::abs(std::abs(own.pole) - mode.fit.omega());
    });
    EXPECT_LT(error(*nearest), 3.0) << mode.fit.omega() << ' ' << mode.quality();
  }
}

TEST(LostRows, OfOutputsAloneAreLeftOut) {
  auto record = test::outputs_of(test::unequal_chain().system, {.seed = 5});
  const auto sound = gapped_measurement(record, true);
  EXPECT_THAT(said(sound), testing::IsEmpty());
  const auto m = gapped_measurement(without_rows(record), true);
  const auto found = said(m);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GE(found[0].count, 3);
  EXPECT_LE(found[0].count, std::ssize(losses));
  EXPECT_EQ(found[0].total, found[0].count);
}

TEST(LostRows, OfALoopAreLeftOut) {
  const auto plant = foreign_plant();
  const auto whole = foreign_loop_record(plant, {.excitation = Excitation::noise, .seed = 7});
  EXPECT_THAT(said(measured({whole})), testing::IsEmpty());
  const auto m = measured({without_rows(whole, 3)});
  const auto found = said(m);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].count, 3);
  EXPECT_EQ(found[0].total, 3);
  expect_poles(plant, identify_modes(m.responses, foreign_band).modes);
}

TEST(LostRows, SoundRecordsHaveNone) {
  const auto system = five_masses();
  EXPECT_THAT(said(gapped_measurement(gapped_record(system, {}, 3))), testing::IsEmpty());
  EXPECT_THAT(said(gapped_measurement(gapped_record(system, {.share = 0.01, .gaps = 60}, 4))),
              testing::IsEmpty());
}

TEST(LostRows, SpikesOfAnOutputAreNone) {
  auto record = gapped_record(five_masses(), {}, 5);
  // too small to be left out as spikes
  const double size = 5.0 * std::sqrt(record.samples.col(5).array().square().mean());
  for (const auto& loss : losses) record.samples(loss.row, 5) += size;
  EXPECT_THAT(said(gapped_measurement(record)), testing::IsEmpty());
}

TEST(LostRows, AStepOfTheExcitationIsNone) {
  const auto system = five_masses();
  auto record = gapped_record(system, {}, 6);
  test::ModalRun run(system, 1.0 / 200.0);
  test::Random random(6);
  const Eigen::Index rows = record.samples.rows();
  for (Eigen::Index t = 0; t < rows; ++t) {
    const double level = (t / 5000) % 2 == 0 ? 1.0 : 6.0;
    const Eigen::VectorXd u = level * record.samples.row(t).head(3).transpose();
    record.samples.row(t) << u.transpose(), run.output().transpose();
    run.advance(u);
  }
  add_output_noise(0.01, 3, random, record);
  EXPECT_THAT(said(gapped_measurement(record)), testing::IsEmpty());
}

/// What was before the first rows that are predicted is not known: a record that begins in a
/// transient has lost nothing.
TEST(LostRows, BesideTheBeginningAreNone) {
  const auto whole = gapped_record(five_masses(), {}, 7);
  const auto without = [&](Eigen::Index row) {
    auto record = whole;
    const Eigen::Index after = whole.samples.rows() - row - 9;
    record.samples.middleRows(row, after) = whole.samples.bottomRows(after);
    record.samples = record.samples.topRows(row + after).eval();
    return record;
  };
  for (const Eigen::Index row : {16, 20})
    EXPECT_THAT(said(gapped_measurement(without(row))), testing::IsEmpty()) << row;
  EXPECT_THAT(said(gapped_measurement(without(60))), testing::SizeIs(1));
}

}  // namespace
}  // namespace hydrapod::identification
