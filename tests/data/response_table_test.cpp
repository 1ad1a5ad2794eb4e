/// Frequency responses as tables of text.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/data/record_io.hpp"
#include "said.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::FileKind;
using testing::HasSubstr;

class ResponseTable : public testing::Test {
 protected:
  [[nodiscard]] std::string written(const std::string& text) const {
    write_text(folder_ / "h.csv", text);
    return folder_ / "h.csv";
  }
  [[nodiscard]] data::FrequencyResponses read(const std::string& text) const {
    const std::string path = written(text);
    EXPECT_EQ(data::file_kind(path), FileKind::frequency_responses);
    auto all = data::read_frequency_responses(path).responses;
    data::validate(all);
    return all;
  }
  [[nodiscard]] base::Diagnostic refusal(const std::string& text) const {
    return refusal_of([&] { data::read_frequency_responses(written(text)); });
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(ResponseTable, RealAndImaginaryPartsPerPair) {
  const auto all = read(
      "Frequency [Hz],re a1/F [g/N],im a1/F [g/N],re a2/F [g/N],im a2/F [g/N]\n"
      "1,0.5,-0.25,3,4\n1.5,7,8,9,-10\n");
  ASSERT_EQ(all.outputs.size(), 2U);
  ASSERT_EQ(all.inputs.size(), 1U);
  EXPECT_EQ(all.outputs[1].name, "a2");
  EXPECT_EQ(all.outputs[1].unit, "m/s^2");
  EXPECT_EQ(all.inputs[0].name, "F");
  EXPECT_EQ(all.inputs[0].unit, "N");
  EXPECT_EQ(all.frequency, (std::vector<double>{1.0, 1.5}));
  EXPECT_EQ(all.H[1](1, 0), std::complex<double>(9.0, -10.0) * 9.80665);
}

TEST_F(ResponseTable, TheUnitMayStandBeforeThePart) {
  const auto all = read("f [Hz],d1 [mm/N] re,d1 [mm/N] im\n1,2,3\n2,6,7\n");
  ASSERT_EQ(all.outputs.size(), 1U);
  EXPECT_EQ(all.outputs[0].name, "d1");
  EXPECT_EQ(all.outputs[0].unit, "m");
  EXPECT_EQ(all.H[1](0, 0), std::complex<double>(6.0, 7.0) * 0.001);
}

TEST_F(ResponseTable, JerkInGravitiesPerSecond) {
  const auto all = read("Frequency [Hz],re a1/F [g/s/kN],im a1/F [g/s/kN]\n1,0.5,-0.25\n2,3,4\n");
  ASSERT_EQ(all.outputs.size(), 1U);
  EXPECT_EQ(all.outputs[0].unit, "m/s^3");
  EXPECT_EQ(all.inputs[0].unit, "N");
  EXPECT_NEAR(std::abs(all.H[1](0, 0) - std::complex<double>(3.0, 4.0) * 9.80665e-3), 0.0, 1e-15);
}

TEST_F(ResponseTable, MagnitudeAndPhaseInDegreesAndRadians) {
  for (const char* titles : {"f (Hz);Magnitude (m/N);Phase (deg)", "Freq\tMag [m/N]\tPhase [°]",
                             "Hz,|H| amplitude [m/N],phase_deg"}) {
    std::string text = titles;
    const char separator = text.find(';') != std::string::npos    ? ';'
                           : text.find('\t') != std::string::npos ? '\t'
                                                                  : ',';
    text += fmt::format("\n2{0}3{0}-90\n4{0}1{0}45\n", separator);
    const std::string title = titles;
    if (title.find("|H|") != std::string::npos) {
      EXPECT_THAT(refusal(text).message, HasSubstr("no table of frequency responses"));
      continue;  // the magnitude is called "|H|", the phase nothing: no pair
    }
    const auto all = read(text);
    EXPECT_NEAR(std::abs(all.H[0](0, 0) - std::complex<double>(0.0, -3.0)), 0.0, 1e-15) << titles;
    EXPECT_NEAR(std::arg(all.H[1](0, 0)), std::numbers::pi / 4.0, 1e-15) << titles;
  }
  const auto radians = read("frequency [rad/s],mag,phase[rad]\n1,2,0.5\n2,2,-3\n");
  EXPECT_NEAR(radians.frequency[1], 1.0 / std::numbers::pi, 1e-16);
  EXPECT_NEAR(std::arg(radians.H[0](0, 0)), 0.5, 1e-15);
}

TEST_F(ResponseTable, DecibelsAndPhasesUpTo180) {
  const auto all = read(
      "Hz,H11 magnitude (dB),H11 phase,H12 magnitude (dB),H12 phase\n"
      "1,20,0,0,170\n2,-20,-175,6,10\n");
  EXPECT_NEAR(std::abs(all.H[0](0, 0)), 10.0, 1e-14);
  EXPECT_NEAR(std::abs(all.H[1](0, 0)), 0.1, 1e-16);
  EXPECT_NEAR(std::arg(all.H[1](0, 0)), -175.0 / 180.0 * std::numbers::pi, 1e-14);
  EXPECT_EQ(all.outputs[0].name, "output 1");
  EXPECT_EQ(all.inputs[1].name, "input 2");
  EXPECT_EQ(all.inputs[1].point, 2);
}

TEST_F(ResponseTable, APhaseThatMayBeAnythingIsRefused) {
  const auto refused = refusal("Hz,mag,phase\n1,2,0.5\n2,2,-3\n");
  EXPECT_THAT(refused.message, HasSubstr("may be degrees or radians"));
  EXPECT_EQ(refused.line, 1U);
  EXPECT_EQ(refused.column, 8U);
}

TEST_F(ResponseTable, ReOfAndARowOfUnits) {
  const auto all = read("f;Re(a/F);Im(a/F)\nkHz;mm/N;mm/N\n0,001;1;2\n0,002;3;4\n");
  EXPECT_EQ(all.outputs[0].name, "a");
  EXPECT_EQ(all.outputs[0].unit, "m");
  EXPECT_DOUBLE_EQ(all.frequency[0], 1.0);
  EXPECT_EQ(all.H[1](0, 0), std::complex<double>(3.0, 4.0) * 0.001);
}

TEST_F(ResponseTable, PlacesAreNamed) {
  const auto missing = refusal("Hz,re H,im H\n1,2,3\n2,,5\n");
  EXPECT_THAT(missing.message, HasSubstr("a response needs a value at every frequency"));
  EXPECT_EQ(missing.line, 3U);
  EXPECT_EQ(missing.column, 3U);
  const auto order = refusal("Hz,re H,im H\n1,2,3\n0.5,4,5\n");
  EXPECT_THAT(order.message, HasSubstr("the frequency 0.5 Hz does not ascend"));
  EXPECT_EQ(order.line, 3U);
  EXPECT_THAT(refusal("Hz,re a/F1,im a/F1,re b/F2,im b/F2\n1,1,1,1,1\n").message,
              HasSubstr("the response of a to F2 stands nowhere"));
}

TEST_F(ResponseTable, TablesOfModesAndRecordsAreNone) {
  EXPECT_EQ(data::file_kind(written("frequency [Hz],direction\n16.9,x\n")), FileKind::mode_table);
  EXPECT_EQ(data::file_kind(written("time [s],real x,imag x\n1,2,3\n2,3,4\n")), FileKind::record);
}

TEST_F(ResponseTable, AsARecordItPointsToIdentify) {
  const std::string path = written("Hz,re H,im H\n1,2,3\n2,4,5\n");
  EXPECT_THAT(refusal_of([&] { data::read_record(path); }).message,
              HasSubstr("holds frequency responses, no samples over time; `hydrapod identify`"));
}

TEST_F(ResponseTable, OmegaIsInRadiansPerSecond) {
  for (const char* title : {"omega", "omega [rad/s]", "Omega [1/s]", "omega (s^-1)", "w", "ω"}) {
    const auto all = read(fmt::format("{},re a/F,im a/F\n10,1,2\n20,3,4\n", title));
    EXPECT_NEAR(all.frequency[1], 10.0 / std::numbers::pi, 1e-14) << title;
  }
  EXPECT_EQ(read("omega [Hz],re a/F,im a/F\n10,1,2\n20,3,4\n").frequency[1], 20.0);
  EXPECT_THAT(refusal("frequency [1/s],re a/F,im a/F\n10,1,2\n20,3,4\n").message,
              HasSubstr("the unit \"1/s\" of the frequencies may mean Hz or rad/s"));
}

TEST_F(ResponseTable, PhasesAreInTheUnitOfTheirTitle) {
  for (const auto& [unit, turn] : {std::pair{"deg", 360.0},
                                   {"DEG", 360.0},
                                   {"Deg", 360.0},
                                   {"deg.", 360.0},
                                   {"Degrees", 360.0},
                                   {"°", 360.0},
                                   {"º", 360.0},
                                   {"Grad", 360.0},
                                   {"gon", 400.0},
                                   {"grad", 400.0},
                                   {"rad", 2.0 * std::numbers::pi},
                                   {"RAD", 2.0 * std::numbers::pi}}) {
    const auto all = read(fmt::format("Hz,mag a/F,phase a/F [{}]\n1,2,{}\n2,1,{}\n", unit,
                                      0.25 * turn, -0.125 * turn));
    EXPECT_NEAR(std::arg(all.H[0](0, 0)), 0.5 * std::numbers::pi, 1e-14) << unit;
    EXPECT_NEAR(std::arg(all.H[1](0, 0)), -0.25 * std::numbers::pi, 1e-14) << unit;
  }
  for (const char* unit : {"grd", "m", "GRAD"}) {
    const auto refused = refusal(fmt::format("Hz,mag a/F,phase a/F [{}]\n1,2,90\n", unit));
    EXPECT_EQ(refused.message,
              fmt::format("the unit \"{}\" of the phase \"a/F\" is unknown; accepted are deg, rad "
                          "and gon",
                          unit));
    EXPECT_EQ(refused.line, 1U);
  }
}

TEST_F(ResponseTable, AMagnitudeBelowZeroIsRefused) {
  const auto refused = refusal("Hz,mag a/F [m/N],phase a/F [deg]\n1,2,10\n2,-17.5,20\n");
  EXPECT_THAT(refused.message, HasSubstr("the magnitude \"a/F\" is -17.5, and must not be below 0; "
                                         "is it in dB? Title it [dB]"));
  EXPECT_EQ(refused.line, 3U);
  EXPECT_NEAR(std::abs(read("Hz,mag a/F [dB],phase a/F [deg]\n1,2,10\n2,-20,20\n").H[1](0, 0)), 0.1,
              1e-15);
}

TEST_F(ResponseTable, WithoutImaginaryPartsIsRefused) {
  EXPECT_THAT(refusal("Hz,re a/F,im a/F\n1,2,0\n2,3,0\n").message,
              HasSubstr("all imaginary parts are 0"));
  EXPECT_EQ(read("Hz,re a/F,im a/F\n1,2,0\n2,3,-1\n").H[0](0, 0), 2.0);
}

TEST_F(ResponseTable, FrequenciesBelowZeroAreNamedTwoSided) {
  const auto refused = refusal("Hz,re a/F,im a/F\n-2,1,-1\n-1,1,-1\n0,1,0\n1,1,1\n2,1,1\n");
  EXPECT_THAT(refused.message, HasSubstr("the frequency is -2 Hz, below 0 as in two-sided "
                                         "responses; expected are those from 0 Hz on alone"));
  EXPECT_EQ(refused.line, 2U);
}

TEST_F(ResponseTable, PoundsAreForces) {
  const std::string path = written("Hz,re a/F [g/lb],im a/F [g/lb]\n1,2,1\n2,3,-1\n");
  const auto [all, notes] = data::read_frequency_responses(path);
  EXPECT_EQ(all.inputs[0].unit, "N");
  EXPECT_NEAR(all.H[0](0, 0).real(), 2.0 * 9.80665 / 4.4482216152605, 1e-12);
  EXPECT_THAT(messages(notes), testing::Contains("\"lb\" is taken for lbf, pounds of force"));
}

}  // namespace
}  // namespace hydrapod::test
