/// Tables of other programs.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>

#include "hydrapod/data/record_io.hpp"
#include "said.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

data::ReadRecordResult read(const std::string& text, const data::ReadOptions& options = {}) {
  const TemporaryFolder folder;
  write_text(folder / "r.csv", text);
  return data::read_record(folder / "r.csv", options);
}

constexpr int many_columns = 10'000;

/// A table of two rows, whose titles are `title(k)`.
template <class Title>
std::string wide_table(Title title) {
  std::string titles = "time [s]", row;
  for (int k = 0; k < many_columns; ++k) {
    titles += ',' + title(k);
    row += ",1";
  }
  return titles + "\n0" + row + "\n0.5" + row + "\n";
}

/// Processor time to open a table: other programs may keep this one waiting.
std::clock_t ticks_to_open(const std::string& text) {
  const TemporaryFolder folder;
  write_text(folder / "r.csv", text);
  const auto began = std::clock();
  const data::RecordSet record({folder / "r.csv"});
  return std::clock() - began;
}

std::string repeated_title(int column) { return column == 4 ? "a (3) [m]" : "a [m]"; }

/// 25'000 columns of one name took a minute, 10'000 ten seconds: each was compared with all numbers
/// before it. Names that differ already take a third of a second; the ratio holds on slow machines
/// too.
TEST(Csv, ManyColumnsOfOneNameTakeAsLongAsOthers) {
  const auto others = ticks_to_open(wide_table([](int k) { return fmt::format("a{} [m]", k); }));
  EXPECT_LT(ticks_to_open(wide_table(repeated_title)), 5 * others);
}

TEST(Csv, ColumnsOfOneNameGetNumbers) {
  const TemporaryFolder folder;
  write_text(folder / "r.csv", wide_table(repeated_title));
  const data::RecordSet record({folder / "r.csv"});
  const auto& channels = record.header().channels;
  ASSERT_EQ(channels.size(), many_columns);
  EXPECT_EQ(channels[0].name, "a");
  EXPECT_EQ(channels[1].name, "a (2)");
  EXPECT_EQ(channels[2].name, "a (3)");
  EXPECT_EQ(channels[4].name, "a (3) (2)");
  EXPECT_EQ(channels[many_columns - 1].name, fmt::format("a ({})", many_columns - 1));
}

TEST(Csv, FieldsThatAShortLineDoesNotHaveAreMissing) {
  const auto record =
      read("time [s],a,b\n0.0,1.5,2.5\n0.25,3.5\n0.5,4.5,5.5\n0.75,6.5,7.5\n").record;
  ASSERT_EQ(record.samples.rows(), 4);
  EXPECT_EQ(record.samples(1, 0), 3.5);
  EXPECT_TRUE(std::isnan(record.samples(1, 1)));
  EXPECT_EQ(record.samples(2, 1), 5.5);
}

/// As text books call them, whatever their units are. Without as many r as u they are told by
/// units.
TEST(Csv, ReferenceInputAndOutputAreThoseOfALoop) {
  const auto roles = [](const std::string& names) {
    std::vector<data::Role> list;
    for (const auto& channel :
         read("time [s]," + names + "\n0,1,2,3\n0.5,1,2,4\n").record.header.channels)
      list.push_back(channel.role);
    return list;
  };
  using enum data::Role;
  EXPECT_EQ(roles("r [m],U_1 [N],y1 [m]"), (std::vector{excitation, drive, response}));
  EXPECT_EQ(roles("y [V],test.u [V],test.r [V]"), (std::vector{response, drive, excitation}));
  EXPECT_EQ(roles("r1 [m],r2 [m],u1 [N]"), (std::vector{response, response, excitation}));
  EXPECT_EQ(roles("r1 [m],u1 [N],x [m]"), (std::vector{response, excitation, response}));
}

TEST(Csv, SemicolonsDecimalCommasAndALineOfUnits) {
  const auto [record, notes] = read(
      "Prüfung 7\nZeit;Weg;Druck\n(s);(mm);(bar)\n"
      "0,00;1,5;20\n0,02;-2,5;21\n0,04;;22\n");
  ASSERT_EQ(notes.size(), 4U);
  EXPECT_EQ(notes[0].message, "skipped \"Prüfung 7\"");
  EXPECT_EQ(notes[1].message, "channel \"Weg\": \"mm\" converted to \"m\", times 0.001");
  EXPECT_EQ(notes[3].message,
            "roles by the names and units of the channels: response: Weg, Druck; --inputs and "
            "--outputs name others");
  EXPECT_EQ(record.header.sample_rate, 50.0);
  ASSERT_EQ(record.samples.rows(), 3);
  EXPECT_EQ(record.samples(1, 0), -2.5 * 0.001);
  EXPECT_EQ(record.samples(1, 1), 21.0 * 1e5);
  EXPECT_TRUE(std::isnan(record.samples(2, 0)));
}

TEST(Csv, DecimalCommasBetweenCommasAreRefused) {
  const auto refused = [](const std::string& text) {
    return refusal_of([&] { read(text, {.sample_rate = 200.0}); });
  };
  const auto found = refused("t,a,F\n0,0000,-0,0032,-0,0000\n0,0050,0,0055,-0,0003\n");
  EXPECT_EQ(found.message,
            "6 fields for 3 titles: decimal commas together with commas between fields; write "
            "decimal points, or semicolons between fields");
  EXPECT_EQ(found.line, 2U);
  // names of two of four columns of other numbers
  EXPECT_EQ(refused("a,b\n0.5,1,2,3\n0.25,1,2,4\n").message, "");
}

/// 12 and 345 are two fields of a line, and no number.
TEST(Csv, MarksOfThousandsAreNamed) {
  const auto note_of = [](const std::string& rows) {
    for (const auto& text : messages(read("t [s];F [N]\n" + rows).notes))
      if (text.find("is not a number") != text.npos) return text;
    return std::string();
  };
  EXPECT_EQ(note_of("0.0;1\n0.5;-5,054.94\n1.0;12,345\n"),
            "\"-5,054.94\" is not a number, as it has marks of thousands; write it without them; "
            "the sample is taken as missing, and 1 more like it");
  for (const char* written : {"5.054,94", "1.005.054,9", "5'054,94", "5 054,94", "5\u00a0054"})
    EXPECT_THAT(note_of(fmt::format("0,0;1\n0,5;{}\n1,0;2\n", written)),
                testing::HasSubstr("has marks of thousands"))
        << written;
  for (const char* written : {"5,05,4", "5054,94,2", "abc", "5,054,94"})
    EXPECT_THAT(note_of(fmt::format("0.0;1\n0.5;{}\n1.0;2\n", written)),
                testing::HasSubstr("is not a number; the sample"))
        << written;
}

TEST(Csv, TabulatorsTimesInMillisecondsAndUnitsInBrackets) {
  const auto record = read("% by a logger\nt [ms]\ta [g]\n10\t1\n10.5\t2\n11\t3\n").record;
  EXPECT_EQ(record.header.sample_rate, 2000.0);
  EXPECT_NEAR(record.header.start, 0.01, 1e-18);
  EXPECT_EQ(record.header.channels[0].unit, "m/s^2");
  EXPECT_EQ(record.samples(2, 0), 3.0 * 9.80665);
}

TEST(Csv, ColumnsApartByBlanksWithARateFromOutside) {
  const auto record = read("  1.0   2.0\n -3.5e2  4\n", {.sample_rate = 250.0}).record;
  EXPECT_EQ(record.header.sample_rate, 250.0);
  EXPECT_EQ(record.header.channels[0].name, "channel 1");
  EXPECT_EQ(record.samples(1, 0), -350.0);
}

TEST(Csv, LatinOneAndMarksOfByteOrderAreNoObstacle) {
  const auto record = read(
                          "\xEF\xBB\xBFtime,\"Pr\xFC"
                          "fling, links\"\n0,1\n1,2\n")
                          .record;
  EXPECT_EQ(record.header.channels[0].name, "Prüfling, links");
  EXPECT_EQ(record.header.sample_rate, 1.0);
}

TEST(Csv, Utf16IsRefusedWithARemedy) {
  for (const std::string& text :
       {std::string("\xff\xfet\0,\0a\0\n\0", 10), std::string("\xfe\xff\0t\0,\0a\0\n", 10),
        std::string("t\0,\0a\0\n\0", 8)})
    EXPECT_EQ(refusal_of([&] { read(text); }).message, "UTF-16 text; save the file as UTF-8");
}

TEST(Csv, UnitsInLatinOneAreSaidAsTheyWereUnderstood) {
  const auto said = messages(read("t [s],a [\xB5m/s\xB2]\n0,1\n0.5,2\n").notes);
  EXPECT_THAT(
      said, testing::Contains(testing::HasSubstr("\"µm/s²\" converted to \"m/s^2\", times 1e-06")));
}

TEST(Csv, ARecordOfALaterVersionIsNotGuessedAt) {
  const auto said =
      refusal_of([] { read("# hydrapod record 9\n# sample_rate_hz: 50\ntime,x\n0,1\n0.02,2\n"); });
  EXPECT_EQ(said.message, "the file is a hydrapod record 9; this program reads version 1");
  EXPECT_EQ(said.line, 1U);
}

TEST(Csv, TimesOfSixDigitsGiveTheRateThatWasMeant) {
  std::string text = "time,x\n";
  for (int k = 0; k < 3000; ++k) text += std::to_string(k / 1024.0) + ",1\n";  // six decimals
  const auto [record, notes] = read(text);
  EXPECT_EQ(record.header.sample_rate, 1024.0);
  EXPECT_THAT(notes, testing::IsEmpty());
  EXPECT_EQ(record.samples.rows(), 3000);
}

}  // namespace
}  // namespace hydrapod::test
