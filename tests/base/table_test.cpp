#include "hydrapod/base/file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/run_program.hpp"

namespace hydrapod::base {
namespace {

using testing::ElementsAre;

std::vector<std::string> texts(const std::vector<TableCell>& cells) {
  std::vector<std::string> all;
  for (const auto& cell : cells) all.push_back(cell.text);
  return all;
}

std::vector<std::string> texts(std::string_view line, char separator) {
  return texts(table_cells(line, separator));
}

TEST(Table, CellsMayBeQuotedAndHoldSeparatorsThen) {
  EXPECT_THAT(texts(" a ,\"b, c\" , \"say \"\"d\"\"\",,5 \"in\"", ','),
              ElementsAre("a", "b, c", "say \"d\"", "", "5 \"in\""));
  EXPECT_THAT(texts("a;\"never closed; b", ';'), ElementsAre("a", "\"never closed; b"));
  EXPECT_THAT(texts("\t\tx\t\"\"", '\t'), ElementsAre("", "", "x", ""));
  EXPECT_THAT(texts("  1.0 \t 2.0  ", ' '), ElementsAre("1.0", "2.0"));
  for (const std::string text : {"plain", "a, b", "\"", "; ", " x", "say \"d\""})
    EXPECT_THAT(texts(quoted_cell(text) + ",end", ','), ElementsAre(text, "end"));
}

TEST(Table, NumbersMayHaveADecimalComma) {
  EXPECT_EQ(table_number("-2,5e-1", true), -0.25);
  EXPECT_EQ(table_number("2.5", true), 2.5);
  EXPECT_EQ(table_number("+2.5", false), 2.5);
  EXPECT_EQ(table_number("1e999", false), INFINITY);
  EXPECT_EQ(table_number("-1e999", false), -INFINITY);
  for (const char* tiny : {"1e-999", "-3.7E-412"}) EXPECT_EQ(table_number(tiny, false), 0.0);
  for (const char* missing : {"", "NaN", "N/A", "na"}) {
    EXPECT_TRUE(std::isnan(table_number(missing, false).value())) << missing;
    EXPECT_TRUE(std::isnan(table_number(missing, true).value())) << missing;
  }
  for (const char* text : {"2,5", "2.5 mm", "x", "1 2"}) EXPECT_FALSE(table_number(text, false));
  EXPECT_EQ(with_decimal_point("4,2 Hz"), "4.2 Hz");
  for (const char* text : {"1,2,3", "sway, yaw", "a1,5", "1,234.5"})
    EXPECT_EQ(with_decimal_point(text), text);
}

TEST(Table, TitlesHaveNamesAndUnits) {
  TableReader table("\xEF\xBB\xBF# of June\r\n\r\np [bar]; v (mm/s) ;t / s;plain\r\n1;2;3;4\r\n",
                    "june.csv");
  const auto titles = table.titles();
  ASSERT_EQ(titles.size(), 4U);
  EXPECT_EQ(titles[0].name, "p");
  EXPECT_EQ(titles[0].unit, "bar");
  EXPECT_EQ(titles[1].unit, "mm/s");
  EXPECT_EQ(titles[1].column, 10U);
  EXPECT_EQ(titles[1].unit_column, 13U);
  EXPECT_EQ(titles[2].unit, "s");
  EXPECT_EQ(titles[3].name, "plain");
  EXPECT_EQ(table.fault(10, "v", "is wrong").text(), "june.csv:3:10: error: v: is wrong");
  EXPECT_EQ(table.fault(0, "", "is wrong").text(), "june.csv: error: is wrong");
}

/// From a file and from memory, with every line end.
TEST(Table, GoesBackToAPlace) {
  const test::TemporaryFolder folder;
  const std::string text = "a,b\n1,2\r\n\r,\n% 3,4\n5,6";
  test::write_text(folder / "t.csv", text);
  for (const bool from_file : {true, false}) {
    auto table = from_file ? TableReader(folder / "t.csv") : TableReader(text, "t.csv");
    EXPECT_EQ(table.titles().size(), 2U);
    std::vector<TableCell> cells;
    ASSERT_TRUE(table.row(cells));
    const auto first = table.line_place();
    for (int pass = 0; pass < 2; ++pass) {
      EXPECT_THAT(texts(cells), ElementsAre("1", "2"));
      EXPECT_EQ(table.line(), 2U);
      ASSERT_TRUE(table.row(cells));
      EXPECT_THAT(texts(cells), ElementsAre("5", "6"));
      EXPECT_EQ(table.line(), 6U);
      EXPECT_FALSE(table.line_was_ended());
      EXPECT_FALSE(table.row(cells));
      table.go_to(first);
      ASSERT_TRUE(table.row(cells));
    }
  }
}

TEST(Table, ALineHasALimit) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "t.csv", "a\n" + std::string((16U << 20U) + 1, '1'));
  TableReader table(folder / "t.csv");
  EXPECT_EQ(table.titles().size(), 1U);
  std::vector<TableCell> cells;
  EXPECT_THROW(table.row(cells), InputError);
}

}  // namespace
}  // namespace hydrapod::base
