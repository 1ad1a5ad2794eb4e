/// Changing values in a machine file and nothing else.

#include "hydrapod/model/file_edit.hpp"

#include <gtest/gtest.h>

#include "hydrapod/base/error.hpp"

namespace hydrapod::model {
namespace {

struct Edit {
  const char* name;
  const char* before;
  std::vector<FileEdit> edits;
  const char* after;
};

class FileEdits : public testing::TestWithParam<Edit> {};

TEST_P(FileEdits, ChangeWhatTheyNameAlone) {
  const auto& edit = GetParam();
  EXPECT_EQ(edited_file(edit.before, edit.edits, "fit"), edit.after);
}

INSTANTIATE_TEST_SUITE_P(
    All, FileEdits,
    testing::Values(
        Edit{"Number",
             "# top\n[a]\nb = 1e3   # kg\nc = 2\n",
             {{"a.b", "7.5", "b 7.5"}},
             "# top\n[a]\nb = 7.5   # kg; fit: b 7.5\nc = 2\n"},
        Edit{"StringWithHash",
             "a = \"1 # kg\" # x\n",
             {{"a", "\"2 kg\"", "r"}},
             "a = \"2 kg\" # x; fit: r\n"},
        Edit{"InlineTable",
             "[p]\ni = { xx = 1, yy = 2 }\n",
             {{"p.i.xx", "10.25", "xx"}, {"p.i.yy", "20", "yy"}},
             "[p]\ni = { xx = 10.25, yy = 20 }  # fit: xx, yy\n"},
        Edit{"ArrayElement", "m = [0, 0.5, -1]\n", {{"m[1]", "8", ""}}, "m = [0, 8, -1]\n"},
        Edit{"ArrayOfLines",
             "m = [\n  1, # one\n  2,\n]\n",
             {{"m[1]", "9", "r"}},
             "m = [\n  1, # one\n  9,  # fit: r\n]\n"},
        Edit{"WholeArray", "m = [1, [2, 3]] # c\n", {{"m", "[4]", ""}}, "m = [4] # c\n"},
        Edit{"AfterUmlauts",
             "t = \"Größe\" \n[a]\n\"ä\" = { b = 1 }\n",
             {{"a.\"ä\".b", "2", ""}},
             "t = \"Größe\" \n[a]\n\"ä\" = { b = 2 }\n"},
        Edit{"NewKey",
             "[a]\nb = 1\n\n[c]\nd = 2\n",
             {{"a.e", "3", "new"}},
             "[a]\nb = 1\ne = 3  # fit: new\n\n[c]\nd = 2\n"},
        Edit{"NewTable", "[a]\nb = 1\n", {{"a.c.d", "3", ""}}, "[a]\nb = 1\nc.d = 3\n"},
        Edit{"NewInInlineTable", "a = { b = 1 }\n", {{"a.c", "3", ""}}, "a = { c = 3, b = 1 }\n"},
        Edit{"NewBesideImplicitTable",
             "[l.case]\nm = 1\n",
             {{"l.x", "3", ""}},
             "[l.case]\nm = 1\n\n[l]\nx = 3\n"},
        Edit{"NewAtTheTop", "n = 1\n[a]\nb = 2\n", {{"c", "3", ""}}, "n = 1\nc = 3\n[a]\nb = 2\n"},
        Edit{"EarlierRemark",
             "b = 1 # kg; fit: b 1 (was 0)\n",
             {{"b", "2", "b 2 (was 1)"}},
             "b = 2 # kg; fit: b 2 (was 1)\n"},
        Edit{"OnlyAnEarlierRemark",
             "b = 1  # fit: b 1\n",
             {{"b", "2", "b 2"}},
             "b = 2  # fit: b 2\n"},
        Edit{"WindowsLines", "[a]\r\nb = 1\r\n", {{"a.b", "2", "r"}}, "[a]\r\nb = 2  # fit: r\r\n"},
        Edit{"NoLineAtTheEnd", "b = 1", {{"b", "2", "r"}}, "b = 2  # fit: r"}),
    [](const auto& info) { return info.param.name; });

TEST(FileEdit, RefusesAWholeTable) {
  EXPECT_THROW(edited_file("[a]\nb = 1\n", {{"a", "2", ""}}, "fit"), base::ComputationError);
}

TEST(FileEdit, KeepsTheUnitThatIsWritten) {
  const std::string text = "a = \"35 mm\"\nb = 3\nc = \"20 cm^3\"\n";
  EXPECT_EQ(written(0.0123456, written_unit(text, "a", "m"), 4), "\"12.35 mm\"");
  EXPECT_EQ(written(0.5, written_unit(text, "b", "m"), 4), "0.5");
  EXPECT_EQ(written(3e-5, written_unit(text, "c", "m^3"), 4), "\"30 cm^3\"");
}

}  // namespace
}  // namespace hydrapod::model
