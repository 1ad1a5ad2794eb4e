/// Changing values in a machine file and nothing else.

#include "hydrapod/model/machine_file.hpp"

#include <gtest/gtest.h>

#include "hydrapod/base/error.hpp"
#include "sound_machine.hpp"

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
        Edit{"NewBelowNothing",
             "n = 1\n[a]\nb = 2\n",
             {{"leg.2.m", "3", "m"}, {"leg.5.k.c", "4", ""}},
             "n = 1\n[a]\nb = 2\n\n[leg]\n5.k.c = 4\n2.m = 3  # fit: m\n"},
        Edit{"NewBesideDottedKeys",
             "[l]\ncase.m = 1\n",
             {{"l.case.I", "3", ""}},
             "[l]\ncase.I = 3\ncase.m = 1\n"},
        Edit{"TakenOutTable",
             "[o]\nd = 1\n[o.c] # tube\nbore = 2 # m\nair = [\n 3 ]\n[q]\nx = 1\n",
             {{.path = "o.c", .taken_out = true}, {"o.k", "5", "k"}},
             "[o]\nd = 1\nk = 5  # fit: k\n# [o.c] # tube\n# bore = 2 # m\n# air = [\n#  3 "
             "]\n[q]\nx = 1\n"},
        Edit{"TakenOutOfInlineTable",
             "o = { d = 1, c = { b = 2 }, e = 4 }\np = { a = 1 }\n",
             {{.path = "o.c", .taken_out = true}, {.path = "p.a", .taken_out = true}},
             "o = { d = 1, e = 4 }\np = {}\n"},
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

/// The file says these numbers in another way: they are written out first.
TEST(FileEdit, SpellsAnArrayOutForOneOfItsElements) {
  const auto changed = parse_machine(
      edited_file(sound_machine_file, {{"leg.2.base_joint[1]", "\"310 mm\"", "moved"}}, "fit"),
      "m");
  const auto before = parse_machine(sound_machine_file, "m");
  EXPECT_EQ(changed.machine.legs[1].base_joint.y(), 0.31);
  EXPECT_EQ(changed.machine.legs[1].base_joint.x(), before.machine.legs[1].base_joint.x());
  EXPECT_EQ(changed.machine.legs[2].base_joint, before.machine.legs[2].base_joint);
}

/// A stiffness instead of a cylinder, a table over a table, strings that need quotes.
TEST(FileEdit, OverridesBecomeEditsOfWhatTheyChange) {
  const std::string text =
      "name = \"a\"\n[legs.oil_spring]\ndamping = 1\n[legs.oil_spring.cylinder]\nbore = 2\n";
  const auto result = [&](const std::vector<std::string>& overrides) {
    return edited_file(text, edits_of_overrides(text, overrides), "fit");
  };
  EXPECT_EQ(result({"legs.oil_spring.stiffness = 3e6 N/m", "name=b \"c\""}),
            "name = \"b \\\"c\\\"\"\n[legs.oil_spring]\ndamping = 1\nstiffness = \"3e6 "
            "N/m\"\n# [legs.oil_spring.cylinder]\n# bore = 2\n");
  EXPECT_EQ(result({"legs.oil_spring={cylinder = {bore = 7, rod = [1, 2]}}"}),
            "name = \"a\"\n[legs.oil_spring]\n# damping = 1\n[legs.oil_spring.cylinder]\nbore = "
            "7\nrod = [1, 2]\n");
  EXPECT_THROW(result({"name.x=3"}), base::ComputationError);
}

TEST(FileEdit, KeepsTheUnitThatIsWritten) {
  const std::string text = "a = \"35 mm\"\nb = 3\nc = \"20 cm^3\"\n";
  EXPECT_EQ(written(0.0123456, written_unit(text, "a", "m"), 4), "\"12.35 mm\"");
  EXPECT_EQ(written(0.5, written_unit(text, "b", "m"), 4), "0.5");
  EXPECT_EQ(written(3e-5, written_unit(text, "c", "m^3"), 4), "\"30 cm^3\"");
}

}  // namespace
}  // namespace hydrapod::model
