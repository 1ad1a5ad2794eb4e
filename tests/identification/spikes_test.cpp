/// Hits on a cable and glitches of a converter: said, and taken as missing samples. Many seeds are
/// in spikes_long_test.cpp.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "found_pole.hpp"
#include "output_only.hpp"
#include "spiky.hpp"

namespace hydrapod::identification {
namespace {

/// All modes, each within four of its deviations.
void expect_modes(const test::ModalSystem& system, const Identification& found) {
  ASSERT_EQ(found.modes.size(), system.modes.size());
  for (std::size_t r = 0; r < system.modes.size(); ++r) {
    const auto& fit = found.modes[r].fit;
    const auto pole = system.modes[r].pole;
    EXPECT_LT(std::abs(fit.omega() - std::abs(pole)), 4.0 * fit.omega_deviation);
    EXPECT_LT(std::abs(fit.damping_ratio() + pole.real() / std::abs(pole)),
              4.0 * fit.damping_deviation);
    EXPECT_LT(std::abs(fit.omega() / std::abs(pole) - 1.0), 2e-3);
  }
}

void expect_warning(const data::ResponseWarning& warning, const std::string& channel,
                    std::int64_t count) {
  EXPECT_EQ(warning.channel, channel);
  EXPECT_EQ(warning.count, count);
  EXPECT_GT(warning.highest, 30.0);
}

TEST(Spikes, OfOutputsAreTakenOut) {
  auto record = quiet_record(3);
  record.samples(17311, 4) = 1e6 * std::abs(record.samples.col(4).maxCoeff());
  record.samples(40123, 7) -= 3.1e3 * record.samples.col(7).maxCoeff();
  record.samples(40124, 7) -= 2.3e3 * record.samples.col(7).maxCoeff();
  const auto m = gapped_measurement(record);
  const auto warnings = spike_warnings(m.responses);
  ASSERT_EQ(warnings.size(), 2U);
  expect_warning(warnings[0], "y2", 1);
  EXPECT_DOUBLE_EQ(warnings[0].value, 17311.0 / 200.0);
  expect_warning(warnings[1], "y5", 2);
  EXPECT_DOUBLE_EQ(warnings[1].value, 40123.0 / 200.0);
  expect_modes(five_masses(), identify_modes(m.responses));
}

TEST(Spikes, OfInputsAreTakenOut) {
  auto record = quiet_record(5);
  test::Random random(31);
  for (Eigen::Index c = 0; c < 3; ++c) add_spikes(c, 3, 1.7e5, random, record);
  const auto m = gapped_measurement(record);
  const auto warnings = spike_warnings(m.responses);
  ASSERT_EQ(warnings.size(), 3U);
  for (const auto& warning : warnings) EXPECT_EQ(warning.count, 6);
  expect_modes(five_masses(), identify_modes(m.responses));
}

/// One sample that has all the energy is no hit: the output does not ring.
TEST(Spikes, OfTheOnlyInputMakeNoHammerTest) {
  auto record = gapped_record(five_masses(1), {}, 11);
  record.samples(23456, 0) = 1.3e6;
  const auto m = gapped_measurement(record);
  ASSERT_EQ(spike_warnings(m.responses).size(), 1U);
  EXPECT_NE(m.reading, nullptr);
  const auto found = identify_modes(m.responses);
  expect_modes(five_masses(1), found);
}

TEST(Spikes, InALoopAreTakenOutOfAllChannels) {
  const auto plant = foreign_plant();
  auto record = foreign_loop_record(plant, {.excitation = Excitation::noise, .seed = 7});
  test::Random random(53);
  for (const Eigen::Index c : {0, 4, 8}) add_spikes(c, 2, 1e6, random, record);
  const auto m = measured({record});
  EXPECT_EQ(spike_warnings(m.responses).size(), 3U);
  expect_modes(plant, identify_modes(m.responses, foreign_band));
}

TEST(Spikes, OfOutputsAlone) {
  auto record = test::outputs_of(test::unequal_chain().system, {.seed = 5});
  const auto clean = gapped_measurement(record, true);
  EXPECT_TRUE(spike_warnings(clean.responses).empty());
  test::Random random(67);
  add_spikes(1, 2, 1e6, random, record);
  const auto m = gapped_measurement(record, true);
  EXPECT_EQ(spike_warnings(m.responses).size(), 1U);
  const auto with = identify_modes(m.responses), without = identify_modes(clean.responses);
  ASSERT_EQ(with.modes.size(), without.modes.size());
  for (std::size_t r = 0; r < with.modes.size(); ++r)
    EXPECT_LT(std::abs(with.modes[r].fit.omega() - without.modes[r].fit.omega()),
              0.3 * without.modes[r].fit.omega_deviation);
}

TEST(Spikes, OfAnOutputThatRingsAfterAHit) {
  auto record = hammer_record({}, 13);
  record.samples(4711, 2) += 190.0 * record.samples.col(2).cwiseAbs().maxCoeff();
  const auto m = measured({record});
  ASSERT_EQ(spike_warnings(m.responses).size(), 1U);
  EXPECT_EQ(spike_warnings(m.responses)[0].count, 1);
  const auto found = identify_modes(m.responses);
  ASSERT_EQ(found.modes.size(), 3U);
  const auto clean = identify_modes(measured({hammer_record({}, 13)}).responses);
  for (std::size_t r = 0; r < 3; ++r)
    EXPECT_LT(std::abs(found.modes[r].fit.omega() - clean.modes[r].fit.omega()),
              clean.modes[r].fit.omega_deviation);
}

class CleanRecords : public testing::TestWithParam<int> {};

TEST_P(CleanRecords, HaveNone) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    EXPECT_TRUE(spikes_in(clean_record(static_cast<CleanKind>(GetParam()), seed)).empty()) << seed;
}

INSTANTIATE_TEST_SUITE_P(Kinds, CleanRecords,
                         testing::Range(0, static_cast<int>(CleanKind::count)));

/// Another reading of the same records finds them again, as the first one left nothing behind.
TEST(Spikes, AreFoundAgain) {
  auto record = quiet_record(19);
  record.samples(31007, 6) = -4e5;
  const test::TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  data::write_record(file, record, data::RecordFormat::hdf5);
  data::RecordSet records({file});
  const auto first = measure_responses(records, {}), second = measure_responses(records, {});
  EXPECT_EQ(spike_warnings(first.responses).size(), 1U);
  EXPECT_EQ(spike_warnings(second.responses).size(), 1U);
  ASSERT_EQ(first.responses.lines(), second.responses.lines());
  EXPECT_EQ(first.responses.H[77], second.responses.H[77]);
}

}  // namespace
}  // namespace hydrapod::identification
