/// Findings of identification, which are codes, in words.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/report/measured_results.hpp"
#include "support/run_program.hpp"

namespace hydrapod::report {
namespace {

using testing::HasSubstr;

/// One of each kind, in the order of the kinds.
std::vector<data::ResponseWarning> response_warnings() {
  using Kind = data::ResponseWarning::Kind;
  return {{.kind = Kind::dead_output, .channel = "y2", .value = 0.7},
          {.kind = Kind::dead_input, .channel = "u2"},
          {.kind = Kind::repeated_input, .channel = "u2", .other = "u1"},
          {.kind = Kind::clipped,
           .channel = "y3",
           .value = 0.114,
           .share = 0.02,
           .lowest = -1,
           .highest = 2},
          {.kind = Kind::blocks_left_out, .count = 3, .total = 40},
          {.kind = Kind::correlated_inputs, .value = 51.0},
          {.kind = Kind::biased, .value = 0.13, .share = 0.4},
          {.kind = Kind::excited_band, .lowest = 0.5, .highest = 39.0, .count = 2},
          {.kind = Kind::interrupted, .count = 4096},
          {.kind = Kind::lines_not_finite, .count = 3, .total = 800},
          {.kind = Kind::missing_samples,
           .channel = "u2",
           .value = 0.071,
           .share = 0.083,
           .count = 640,
           .total = 8000},
          {.kind = Kind::single_block, .count = 3},
          {.kind = Kind::weak_excitation,
           .value = 3.21,
           .share = 0.642,
           .lowest = 4.712,
           .highest = 6.318},
          {.kind = Kind::spikes, .channel = "y2", .value = 12.352, .highest = 8431.7, .count = 3},
          {.kind = Kind::hits_left_out, .value = 4.137, .count = 2, .total = 9},
          {.kind = Kind::repeated_output, .channel = "a3", .other = "a2"},
          {.kind = Kind::held,
           .channel = "a2",
           .value = 60.0,
           .share = 0.5,
           .count = 30000,
           .total = 1},
          {.kind = Kind::drop_outs, .value = 0.361, .share = 0.017, .count = 1122, .total = 6},
          {.kind = Kind::slow_channel, .channel = "a3", .value = 10.0, .highest = 51.2},
          {.kind = Kind::clipped_hits, .channel = "a2", .value = 2.0, .count = 3, .total = 5},
          {.kind = Kind::delayed, .channel = "a4", .other = "a1", .value = 0.00586},
          {.kind = Kind::hum, .channel = "force", .value = 50.013, .share = 0.0213},
          {.kind = Kind::two_clocks,
           .channel = "a1",
           .other = "force",
           .value = 1.03e-4,
           .share = 0.0309,
           .count = 3,
           .total = 4},
          {.kind = Kind::exponential_window, .value = 0.35},
          {.kind = Kind::wandering_tone,
           .value = 12.371,
           .share = 0.0083,
           .lowest = 12.16,
           .highest = 12.59},
          {.kind = Kind::short_record, .value = 10.0, .share = 1.28, .count = 7, .total = 12},
          {.kind = Kind::feedback, .share = 0.31, .estimator = data::Estimator::h1},
          {.kind = Kind::motion_input, .channel = "a1", .count = 1, .total = 1},
          {.kind = Kind::sensor_changed,
           .channel = "d2",
           .other = "p2.csv",
           .value = -1.0,
           .count = 1,
           .total = 3},
          {.kind = Kind::lines_zero, .channel = "a1", .other = "F", .count = 120, .total = 800},
          {.kind = Kind::two_sided, .value = 512.0, .count = 1023, .total = 2048},
          {.kind = Kind::input_changed,
           .channel = "f2",
           .value = -1.0,
           .lowest = 150.0,
           .highest = 300.0,
           .count = 1,
           .total = 2},
          {.kind = Kind::lost_rows, .value = 12.34, .count = 10, .total = 10},
          {.kind = Kind::rings, .value = 2.239},
          {.kind = Kind::cut_sweep, .value = 20.48, .count = 2, .total = 6},
          {.kind = Kind::run_up, .share = 0.031, .lowest = 3.02, .highest = 38.4}};
}

std::vector<identification::ModeWarning> mode_warnings() {
  using Kind = identification::ModeWarning::Kind;
  return {{.kind = Kind::no_mode, .from = 1.0, .to = 20.0},
          {.kind = Kind::few_samples, .value = 5.04},
          {.kind = Kind::misfit, .value = 3.21},
          {.kind = Kind::unexplained,
           .value = 41.3,
           .from = 12.31,
           .to = 19.7,
           .smooth = 0.923,
           .share = 0.0961,
           .output = "y7",
           .input = "u1",
           .count = 3,
           .total = 26},
          {.kind = Kind::wanders,
           .value = 12.312,
           .from = 12.214,
           .to = 12.401,
           .share = 0.234,
           .count = 4},
          {.kind = Kind::short_blocks,
           .value = 16.384,
           .from = 8.5062,
           .to = 0.0575,
           .count = 2,
           .total = 9},
          {.kind = Kind::peaks_above, .value = 131.23, .from = 4.0, .to = 110.25, .count = 1},
          {.kind = Kind::conjugated, .value = 0.021, .from = 1.2, .to = 15.8, .share = 0.93},
          {.kind = Kind::window, .value = 16.0, .from = 1.0, .to = 19.0625, .window = "hann"},
          {.kind = Kind::twins, .value = 1.7, .from = 43.264, .to = 43.882, .count = 2, .total = 5},
          {.kind = Kind::moved,
           .value = 3.5,
           .from = 39.269,
           .to = 40.855,
           .share = 0.44,
           .count = 2,
           .total = 6},
          {.kind = Kind::common_poles,
           .value = 0.224,
           .from = 76.69,
           .to = 100.3,
           .count = 3,
           .total = 7},
          {.kind = Kind::set_ups,
           .value = 3,
           .from = 7.92,
           .to = 8.0004,
           .output = "y3",
           .count = 10,
           .total = 10},
          {.kind = Kind::combination_tones,
           .value = 12.54,
           .from = 3.81,
           .to = 8.715,
           .count = 4,
           .total = 9}};
}

/// Every kind has its example, and each stands word for word in docs/howto/identify.md.
template <class Warning>
void expect_documented(const std::vector<Warning>& all) {
  const std::string page = test::read_text(test::source_file("docs/howto/identify.md"));
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(static_cast<std::size_t>(all[k].kind), k);
    EXPECT_THAT(page, HasSubstr("` | " + warning_text(all[k]) + " | "));
  }
  const Warning beyond{.kind = static_cast<typename Warning::Kind>(all.size())};
  EXPECT_EQ(warning_text(beyond), "") << "a kind without an example";
}

TEST(IdentificationWords, NameTheWindowThatWasTaken) {
  for (const auto& [name, words] : {std::pair{"hann", "with a Hann window"},
                                    {"rectangular", "without a window"},
                                    {"hamming", "with a Hamming window"},
                                    {"blackman-harris", "with a Blackman-Harris window"},
                                    {"flat-top", "with a flat-top window"},
                                    {"blackman", "with a Blackman window"},
                                    {"tukey", "with a Tukey window"}})
    EXPECT_THAT(warning_text(identification::ModeWarning{
                    .kind = identification::ModeWarning::Kind::window, .window = name}),
                HasSubstr(words));
}

TEST(IdentificationWords, SayWhereTheExcitationOfOutputsEnds) {
  data::ResponseWarning warning{.kind = data::ResponseWarning::Kind::excited_band,
                                .value = 23.7,
                                .lowest = 2.013,
                                .highest = 20.04,
                                .estimator = data::Estimator::half_spectra};
  EXPECT_EQ(warning_text(warning),
            "what excites the outputs, or a filter, ends sharply at 2.013 Hz and 20.04 Hz, where "
            "their spectra "
            "have a step of 24 dB: modes elsewhere cannot be identified");
  warning.lowest = 0.0;
  EXPECT_THAT(warning_text(warning), HasSubstr("at 20.04 Hz, where their spectra have a step of 24 "
                                               "dB: modes above cannot"));
  warning.lowest = 2.013;
  warning.highest = 0.0;
  EXPECT_THAT(warning_text(warning), HasSubstr("at 2.013 Hz, where their spectra have a step of 24 "
                                               "dB: modes below cannot"));
}

TEST(IdentificationWords, EveryWarningHasAnExampleInTheHowTo) {
  expect_documented(response_warnings());
  expect_documented(mode_warnings());
}

/// Limits that differ in the fifth digit are told apart, and so are they from what lies between.
TEST(IdentificationWords, LimitsOfAClippedChannelHaveTheDigitsThatTellThemApart) {
  const data::ResponseWarning warning{.kind = data::ResponseWarning::Kind::clipped,
                                      .channel = "leg 1 length",
                                      .share = 0.0003,
                                      .lowest = 2.2351234,
                                      .highest = 2.2355};
  EXPECT_THAT(warning_text(warning), HasSubstr("are cut off at 2.2351234 or 2.2355: the channel"));
}

TEST(IdentificationWords, AModeThatWandersMayHaveALowerDampingRatio) {
  const std::string text = warning_text({.kind = identification::ModeWarning::Kind::wanders,
                                         .value = 7.28,
                                         .from = 7.27,
                                         .to = 7.5,
                                         .share = -0.17,
                                         .count = 2});
  EXPECT_THAT(text, HasSubstr("its damping ratio is 17 % lower than the mean of the parts"));
  EXPECT_THAT(text, testing::Not(HasSubstr("widens")));
}

TEST(IdentificationWords, AllOfItIsAHundredPerCentAndOneModeIsSingular) {
  using Kind = identification::ModeWarning::Kind;
  EXPECT_THAT(warning_text({.kind = Kind::conjugated, .value = 0.02, .share = 0.998}),
              HasSubstr("modes leave 100 % of the responses"));
  EXPECT_THAT(warning_text({.kind = Kind::short_blocks, .count = 1, .total = 6}),
              HasSubstr("1 of 6 modes is narrower"));
}

TEST(IdentificationWords, WhereAllOutputsChangedAnInputMayHave) {
  data::ResponseWarning warning{.kind = data::ResponseWarning::Kind::sensor_changed,
                                .channel = "d2",
                                .other = "p2.csv",
                                .value = -1.0,
                                .count = 2,
                                .total = 3};
  EXPECT_THAT(warning_text(warning), testing::HasSubstr("(2 of 3 outputs changed): its part"));
  warning.count = 3;
  EXPECT_THAT(warning_text(warning),
              testing::HasSubstr("(3 of 3 outputs changed, or an input): its part"));
}

TEST(IdentificationWords, ASweepIsNoShortRecord) {
  EXPECT_EQ(warning_text({.kind = data::ResponseWarning::Kind::short_record,
                          .value = 120.0,
                          .share = 32.0,
                          .count = 3}),
            "the excitation is a sweep, which blocks of 32 s would cut into pieces: modes are "
            "estimated from the whole record at once, by a parametric model of its spectra");
}

TEST(IdentificationWords, WhereAllInputsChangedOutputsMayHave) {
  data::ResponseWarning warning{.kind = data::ResponseWarning::Kind::input_changed,
                                .channel = "f2",
                                .other = "p2.csv",
                                .value = -1.0,
                                .count = 1,
                                .total = 3};
  EXPECT_EQ(warning_text(warning),
            "f2 of p2.csv is −1.00 times what it is in the other records: the responses to it are "
            "wrong, and modes that it excites may be missing");
  warning.count = 3;
  EXPECT_THAT(warning_text(warning),
              testing::HasSubstr("(3 of 3 inputs changed, or outputs): the responses"));
}

TEST(IdentificationWords, LostRowsThatAreNotLeftOutRaiseDamping) {
  EXPECT_EQ(
      warning_text({.kind = data::ResponseWarning::Kind::lost_rows,
                    .other = "p2.csv",
                    .value = 12.34,
                    .count = 1,
                    .total = 0}),
      "at a place, at 12.34 s of p2.csv, most outputs do not go on from where they were: rows "
      "were lost, or something struck the machine; too few blocks are without, so damping "
      "ratios may be too high");
}

TEST(IdentificationWords, OneGapIsNotCounted) {
  data::ResponseWarning warning{
      .kind = data::ResponseWarning::Kind::excited_band, .lowest = 0.5, .highest = 39.0};
  EXPECT_THAT(warning_text(warning), HasSubstr("to 39 Hz: modes elsewhere"));
  warning.count = 1;
  EXPECT_THAT(warning_text(warning), HasSubstr("to 39 Hz, with a gap: modes elsewhere"));
}

TEST(IdentificationWords, HitsThatDoNotAgreeAndSeveralInARecordAreSaid) {
  data::ResponseWarning warning{
      .kind = data::ResponseWarning::Kind::single_block, .count = 1, .total = 5};
  EXPECT_THAT(warning_text(warning), HasSubstr("the record has 5 hits: the next comes before"));
  warning.share = 1.0;
  EXPECT_THAT(warning_text(warning),
              HasSubstr("the record has 5 hits: each is taken as one block"));
  EXPECT_THAT(warning_text(warning), testing::Not(HasSubstr("agree")));
  warning.share = 0.6;
  EXPECT_THAT(warning_text(warning), HasSubstr("5 hits: some come before the last has rung down"));
  warning = {.kind = warning.kind, .channel = "acc7", .value = 0.6234, .count = 3, .total = 3};
  EXPECT_THAT(warning_text(warning), HasSubstr("each of the 3 records is a single hit: "));
  EXPECT_THAT(warning_text(warning), HasSubstr("the hits do not agree: 62 % of the power of acc7"));
}

TEST(IdentificationWords, AModeThatMayBeAnImageIsSaid) {
  identification::ModeWarning warning{.kind = identification::ModeWarning::Kind::few_samples,
                                      .value = 5.04};
  EXPECT_THAT(warning_text(warning), testing::Not(HasSubstr("image")));
  warning.value = 2.42;
  warning.to = 300.04;
  EXPECT_THAT(warning_text(warning),
              HasSubstr("use a higher sample rate; it may be the image of a mode at 300 Hz where "
                        "no anti-alias filter was used"));
  EXPECT_THAT(warning_text(warning), testing::Not(HasSubstr("modes are above")));
  warning.from = 283.6;
  warning.count = 2;
  warning.total = 7;
  EXPECT_THAT(warning_text(warning), HasSubstr("was used; 2 of 7 modes are above 283.6 Hz, where"));
  warning.count = 1;
  EXPECT_THAT(warning_text(warning), HasSubstr("1 of 7 modes is above 283.6 Hz, where"));
}

/// In a loop nothing is taken in one piece.
TEST(IdentificationWords, OfSweepsInALoop) {
  EXPECT_THAT(warning_text(data::ResponseWarning{.kind = data::ResponseWarning::Kind::cut_sweep,
                                                 .value = 16.384,
                                                 .count = 3,
                                                 .total = 8,
                                                 .estimator = data::Estimator::instrumental}),
              testing::EndsWith("their intervals; sweep more slowly, and record 8 blocks"));
}

TEST(IdentificationWords, OfPoles) {
  EXPECT_STREQ(words(identification::Objection::doubles), "repeats another pole");
  EXPECT_STREQ(words(identification::PoleStability::fresh), "new");
}

/// Outputs by what they move, in proportion to their own responses where they have several units;
/// signs against the first.
TEST(IdentificationWords, OfMotions) {
  identification::Identification found;
  found.responses.outputs = {
      {.name = "x", .unit = "m"}, {.name = "y"}, {.name = "ry", .unit = "rad"}, {.name = "z"}};
  Eigen::MatrixXcd H(4, 2);
  H << 3.0, 4.0, 0.6, 0.8, 0.0, 2.0, 5.0, 12.0;  // sizes 5, 1, 2 and 13
  found.responses.H = {H};
  identification::IdentifiedMode mode;
  const auto turn = std::polar(1.0, 0.77);
  mode.fit.shape = Eigen::VectorXcd(4);
  mode.fit.shape << 5.0 * turn, -0.43 * turn, 2.0 * 0.261 * turn, 13.0 * 0.19 * turn;
  found.modes = {mode};
  EXPECT_THAT(motion_words(found), testing::ElementsAre("x 1.00, −y 0.43, ry 0.26"));
  for (auto& output : found.responses.outputs) output.unit = "m/s²";  // now it is the shape
  EXPECT_THAT(motion_words(found), testing::ElementsAre("x 1.00, z 0.49"));
  for (auto& output : found.responses.outputs) output.unit = "";  // not known to be the same
  EXPECT_THAT(motion_words(found), testing::ElementsAre("x 1.00, −y 0.43, ry 0.26"));
  found.modes[0].repeated = 2;  // its fitted shape is some mixture
  found.modes[0].displacement = Eigen::VectorXcd(4);
  found.modes[0].displacement << 0.0, 0.0, 0.0, 0.013;
  EXPECT_THAT(motion_words(found), testing::ElementsAre("z 1.00"));
}

}  // namespace
}  // namespace hydrapod::report
