/// Mains hum and the ripple of a pump where inputs were measured: rows of
/// docs/validation/identification.md.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "foreign_loop.hpp"
#include "hall_record.hpp"
#include "many_modes.hpp"

namespace hydrapod::identification {
namespace {

constexpr std::uint64_t tone_seeds = 60;

/// H1 of the record as it is, and the textbook's search for poles.
std::vector<test::FoundMode> textbook_hall_modes(const data::Record& record, int block) {
  SpectrumEstimator estimator(record.header, {.block_length = block});
  estimator.add(record.samples);
  const auto r = estimate_responses(
      estimator.result(), {.inputs = {0, 1, 2}, .outputs = {3, 4, 5, 6}, .instruments = {}},
      Estimator::h1);
  return textbook_modes(within(r, 0.0, hall_band));
}

void judge_hall(const char* name, HallRecord e, std::size_t tones) {
  const auto plant = hall_plant();
  const auto truth = test::true_modes(plant);
  test::ClassScore ours, plain;
  int listed = 0, false_tones = 0;
  for (e.seed = 1; e.seed <= tone_seeds; ++e.seed) {
    const auto record = hall_record(plant, e).record;
    const auto m = measured({record});
    listed += m.responses.harmonics.size() == tones ? 1 : 0;
    false_tones += tones == 0 && !m.responses.harmonics.empty() ? 1 : 0;
    ours.add(truth, test::found_modes(identify_modes(m.responses, {.to = hall_band})));
    plain.add(truth, textbook_hall_modes(record, m.spectra.options.block_length));
  }
  test::print_class(name, "hydrapod", ours);
  test::print_class(name, "H1, pLSCF, orders 2 … 40, stable poles", plain);
  EXPECT_EQ(ours.found, ours.wanted);
  EXPECT_LE(ours.false_per_seed(), 0.1);
  EXPECT_GE(ours.frequency_coverage(), 0.92);
  EXPECT_GE(ours.damping_coverage(), 0.92);
  EXPECT_EQ(false_tones, 0);
  if (e.level > 10.0) {
    EXPECT_EQ(listed, static_cast<int>(tone_seeds));
  }
}

TEST(Foreign, ForcesWithoutTones) { judge_hall("forces, no tones", {}, 0); }
TEST(Foreign, ForcesWithWeakTones) {
  judge_hall("forces, three tones at the noise", {.level = 1.0, .input_level = 1.0}, 3);
}
TEST(Foreign, ForcesWithTones) {
  judge_hall("forces, three tones 100 times the noise", {.level = 100.0, .input_level = 100.0}, 3);
}
TEST(Foreign, ForcesWithStrongTonesThatWander) {
  judge_hall("forces, three tones 10⁴ times the noise, ±0.02 Hz",
             {.level = 1e4, .input_level = 100.0, .wander = 0.02}, 3);
}

void judge_loop(const char* name, double level, double wander, Excitation excitation) {
  const auto plant = foreign_plant();
  test::ClassScore ours, plain;
  for (std::uint64_t seed = 1; seed <= tone_seeds; ++seed) {
    const auto m = foreign_measurement(
        plant, loop_with_tones(level, wander, {.excitation = excitation, .seed = seed}));
    add_modes(plant, m.responses, ours);
    add_modes(plant, textbook(m), plain);
  }
  test::print_class(name, "hydrapod", ours);
  test::print_class(name, "S_yr S_ur⁻¹, same pole fit, tones taken out", plain);
  EXPECT_EQ(ours.found, ours.wanted);
  EXPECT_LE(ours.false_per_seed(), 0.1);
}

TEST(Foreign, LoopWithTones) {
  judge_loop("closed loop, noise in a band, three tones 100 times the noise", 100.0, 0.0,
             Excitation::noise);
}
TEST(Foreign, LoopWithTonesThatWander) {
  judge_loop("closed loop, noise in a band, three tones 10⁴ times the noise, ±0.02 Hz", 1e4, 0.02,
             Excitation::noise);
}

}  // namespace
}  // namespace hydrapod::identification
