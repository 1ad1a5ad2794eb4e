/// Tables stay aligned whatever stands in their cells.

#include "hydrapod/terminal.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace hydrapod::cli {
namespace {

TEST(DisplayWidth, CountsColumnsNotBytes) {
  EXPECT_EQ(display_width("abc"), 3u);
  EXPECT_EQ(display_width("ω²φ"), 3u);
  EXPECT_EQ(display_width("x\u0302"), 1u) << "a combining mark takes no column";
  EXPECT_EQ(display_width("六足"), 4u) << "wide characters take two";
  EXPECT_EQ(display_width("\033[1;31mred\033[0m"), 3u) << "escape sequences take none";
}

TEST(DisplayWidth, SurvivesBytesThatAreNotUtf8) {
  EXPECT_EQ(display_width("\xff\xfe"), 2u);
  EXPECT_EQ(display_width("\xe2\x82"), 2u) << "cut short";
  EXPECT_EQ(display_width("\033["), 0u);
}

TEST(Table, AlignsItsColumns) {
  Table table({"<mode", "ω [rad/s]"});
  table.add_row({"x", "58.31"});
  table.add_row({styled("knee", Style::red, true), "160.2"});
  EXPECT_EQ(table.text(),
            "mode  ω [rad/s]\n"
            "x         58.31\n"
            "\033[1;31mknee\033[0m      160.2\n");
}

TEST(Table, LeavesNoTrailingBlanks) {
  Table table({"<a", "<b"});
  table.add_row({"1", "long"});
  table.add_row({"2"});
  EXPECT_EQ(table.text(), "a  b\n1  long\n2\n");
}

TEST(Table, TooWideComesInPartsThatBeginWithTheFirstColumn) {
  Table table({"mode", "Hz", "<label", "MAC"});
  table.add_row({"1", "7.4", "x, oil springs", "0.99"});
  table.add_row({"2", "8.5", "seals"});
  EXPECT_EQ(table.text({false, 26}),
            "mode   Hz  label\n"
            "   1  7.4  x, oil springs\n"
            "   2  8.5  seals\n"
            "\n"
            "mode   MAC\n"
            "   1  0.99\n"
            "   2\n");
  EXPECT_EQ(table.text({false, 31}), table.text()) << "it just fits";
  EXPECT_EQ(table.text({false, 3}), table.text({false, 1})) << "never less than two columns";
}

TEST(Table, InBriefIsTheFirstPartAndSaysHowMuchIsLeft) {
  Table table({"mode", "Hz", "<label", "MAC"});
  table.add_row({"1", "7.4", "x, oil springs", "0.99"});
  table.add_row({"2", "8.5", "seals"});
  EXPECT_EQ(table.text({.width = 26, .rows = 1, .brief = true}),
            "mode   Hz  label\n"
            "   1  7.4  x, oil springs\n"
            "… and 1 more row and 1 more column; --all shows them\n");
  EXPECT_EQ(table.text({.width = 31, .brief = true}), table.text()) << "it just fits";
}

TEST(Table, OfManyRowsShowsTheFirstOnesAndSaysHowManyAreLeft) {
  Table table({"mode", "Hz"});
  for (int k = 1; k <= 5; ++k) table.add_row({std::to_string(k), std::to_string(10 * k)});
  EXPECT_EQ(table.text({.rows = 2}),
            "mode  Hz\n   1  10\n   2  20\n… and 3 more rows; --all shows them\n");
  EXPECT_EQ(table.text({.rows = 5}), table.text()) << "it just fits";
}

TEST(Table, OfOneColumnIsOnePart) {
  Table table({"<name"});
  table.add_row({"longer than the terminal"});
  EXPECT_EQ(table.text({false, 10}), "name\nlonger than the terminal\n");
}

TEST(Table, RefusesARowWithTooManyCells) {
  Table table({"a"});
  EXPECT_THROW(table.add_row({"1", "2"}), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::cli
