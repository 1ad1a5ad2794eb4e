/// Findings of identification, which are codes, in words.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {
namespace {

using testing::HasSubstr;

TEST(IdentificationWords, OfResponsesNameTheChannelAndItsNumbers) {
  using Kind = data::ResponseWarning::Kind;
  EXPECT_EQ(
      warning_text(data::ResponseWarning{.kind = Kind::dead_output, .channel = "y2", .value = 0.7}),
      "y2: dead (always 0.7); left out");
  EXPECT_EQ(warning_text(data::ResponseWarning{.kind = Kind::dead_input, .channel = "u2"}),
            "input u2: dead (constant); no responses to it");
  EXPECT_THAT(warning_text(data::ResponseWarning{
                  .kind = Kind::repeated_input, .channel = "u2", .other = "u1"}),
              HasSubstr("input u2 repeats input u1: left out; the responses to u1"));
  EXPECT_THAT(
      warning_text(data::ResponseWarning{
          .kind = Kind::clipped, .channel = "y3", .share = 0.02, .lowest = -1, .highest = 2}),
      HasSubstr("y3: 2 % of the samples are -1 or 2: the channel looks clipped"));
  EXPECT_EQ(
      warning_text(data::ResponseWarning{.kind = Kind::blocks_left_out, .count = 3, .total = 40}),
      "3 of 40 blocks have missing samples and were left out");
  EXPECT_THAT(warning_text(data::ResponseWarning{.kind = Kind::correlated_inputs, .value = 51.0}),
              HasSubstr("inputs are correlated: the condition of their matrix is 51"));
  EXPECT_THAT(
      warning_text(data::ResponseWarning{.kind = Kind::biased, .value = 0.13, .share = 0.4}),
      HasSubstr("h1 is biased by the loop: it differs from the instrumental estimate by 13 % "
                "(median), outside its 95 % band at 40 % of the lines"));
  EXPECT_EQ(
      warning_text(
          data::ResponseWarning{.kind = Kind::excited_band, .lowest = 0.5, .highest = 39.0}),
      "the excitation reaches the inputs only from 0.5 Hz to 39 Hz: modes elsewhere cannot be "
      "identified");
  EXPECT_THAT(warning_text(data::ResponseWarning{
                  .kind = Kind::excited_band, .lowest = 0.5, .highest = 39.0, .count = 2}),
              HasSubstr("to 39 Hz, with 2 gaps: modes elsewhere"));
  EXPECT_EQ(warning_text(data::ResponseWarning{.kind = Kind::interrupted, .count = 4096}),
            "interrupted: the result uses the first 4096 samples");
  data::ResponseWarning missing{.kind = Kind::missing_samples,
                                .channel = "u2",
                                .value = 0.071,
                                .share = 0.083,
                                .count = 640,
                                .total = 8000};
  EXPECT_EQ(warning_text(missing),
            "8 % of the samples are missing, most in u2 (8.3 %): they were filled by prediction "
            "from the samples beside them; 7.1 % of the power of the inputs stays unknown: its "
            "response acts as noise, which the intervals include");
  missing.value = 0.0;
  EXPECT_THAT(warning_text(missing), testing::EndsWith("from the samples beside them"));
  EXPECT_EQ(
      warning_text(data::ResponseWarning{.kind = Kind::lines_not_finite, .count = 3, .total = 800}),
      "3 of 800 frequencies have a value that is no finite number and were left out");
}

TEST(IdentificationWords, OfModes) {
  using identification::ModeWarning;
  using Kind = ModeWarning::Kind;
  EXPECT_EQ(warning_text(ModeWarning{.kind = Kind::no_mode, .from = 1.0, .to = 20.0}),
            "no mode from 1 Hz to 20 Hz: there is no stable pole");
  EXPECT_THAT(warning_text(ModeWarning{.kind = Kind::few_samples, .value = 5.04}),
              HasSubstr("5.0 samples per period"));
  EXPECT_THAT(warning_text(ModeWarning{.kind = Kind::misfit, .value = 3.21}),
              HasSubstr("misses the responses by 3.2 times their noise"));
  EXPECT_THAT(warning_text(ModeWarning{.kind = Kind::unexplained,
                                       .value = 41.3,
                                       .from = 12.31,
                                       .to = 19.7,
                                       .smooth = 0.923,
                                       .share = 0.0961,
                                       .output = "y7",
                                       .input = "u1",
                                       .count = 3,
                                       .total = 26}),
              HasSubstr("3 of 26 responses; the worst is y7 to u1 from 12.31 Hz to 19.7 Hz: the "
                        "residual is 41 times its noise (mean square), 92 % of it goes on from "
                        "line to line, and it is 31 % of the response"));
  EXPECT_STREQ(words(identification::Objection::doubles), "repeats another pole");
  EXPECT_STREQ(words(identification::PoleStability::fresh), "new");
  EXPECT_EQ(warning_text(ModeWarning{.kind = Kind::wanders,
                                     .value = 12.312,
                                     .from = 12.214,
                                     .to = 12.401,
                                     .share = 0.234,
                                     .count = 4}),
            "the mode at 12.31 Hz wanders: it is from 12.21 Hz to 12.4 Hz in the 4 parts of the "
            "record; that widens its resonance, its damping ratio is 23 % higher than the mean of "
            "the parts, and its intervals cannot be trusted");
}

}  // namespace
}  // namespace hydrapod::report
