/// Universal Files of other programs: points, lines, units and lines of text are kept. The files
/// are written here column by column.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "said.hpp"
#include "sample_record.hpp"
#include "support/run_program.hpp"
#include "uff_reference.hpp"

namespace hydrapod::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string dataset(int number, const std::string& lines) {
  return fmt::format("    -1\n{:6}\n{}    -1\n", number, lines);
}

/// Dataset 164 as it is described: I10,20A1,I10, then 3D25.17 and D25.17.
std::string units(int code, const std::string& name, const std::string& length,
                  const std::string& force, const std::string& temperature = "1.0D+00",
                  const std::string& offset = "2.7315D+02") {
  return dataset(164, fmt::format("{:10}{:20}{:10}\n{:>25}{:>25}{:>25}\n{:>25}\n", code, name, 2,
                                  length, force, temperature, offset));
}
std::string millimetres() { return units(5, "MM: mm (milli newto", "1.0D+03", "1.0D+03"); }

constexpr const char* header_151 =
    "    -1\n   151\nwing_7.mdl\nleft wing on bungees\nAnalyser 12.3\n"
    "03-FEB-24 11:12:13           2         0         0\n"
    "03-FEB-24 11:12:13  \nAnalyser 12.3\n"
    "03-FEB-24 11:12:13      0    0    0    0    0\n    -1\n";

std::string nodes_15() {
  return dataset(
      15,
      "        12         1         2        11  1.25000E+02 -3.75000E+01  0.00000E+00\n"
      "         7         1         2         8  0.00000E+00  4.12500E+02 -1.50000E+00\n");
}
std::string trace_82() {
  return dataset(
      82,
      "         1        10         3\nleading edge\n"
      "        12         7         0         7        12         0        12         7\n"
      "        12         7\n");
}

struct Curve {
  std::array<std::string, 5> id{"NONE", "NONE", "NONE", "NONE", "NONE"};
  int type{1};
  std::string response{"WING"}, reference{"NONE"};  ///< entities
  int response_node{}, response_direction{}, reference_node{}, reference_direction{};
  std::string ordinate{"        12    1    0    0 Acceleration         NONE"};
  std::string denominator{"         0    0    0    0 NONE                 NONE"};
  std::string values{"  1.00000E+00 -2.00000E+00  3.50000E+00\n"};
  bool is_complex{};
};

std::string curve(const Curve& c) {
  std::string text;
  for (const std::string& line : c.id) text += line + "\n";
  text += fmt::format("{:5}{:10}{:5}{:10} {:10}{:10}{:4} {:10}{:10}{:4}\n", c.type, 0, 1, 0,
                      c.response, c.response_node, c.response_direction, c.reference,
                      c.reference_node, c.reference_direction);
  text += fmt::format("{:10}{:10}{:10}{:>13}{:>13}{:>13}\n", c.is_complex ? 5 : 2, 3, 1,
                      c.is_complex ? "2.50000E+00" : "0.00000E+00", "1.25000E-01", "0.00000E+00");
  text += c.is_complex ? "        18    0    0    0 Frequency            Hz\n"
                       : "        17    0    0    0 Time                 s\n";
  text += c.ordinate + "\n" + c.denominator + "\n";
  text += "         0    0    0    0 NONE                 NONE\n" + c.values;
  return dataset(58, text);
}

Curve at(int node, int direction) {
  Curve c;
  c.response_node = node;
  c.response_direction = direction;
  return c;
}

std::string foreign_record() {
  Curve first = at(12, 3), second = at(7, -1);
  first.id = {"run 3, flap 5 deg", "WING:12:+Z", "03-Feb-24 11:12:13", "Time", "NONE"};
  return header_151 + millimetres() + nodes_15() + trace_82() + curve(first) + curve(second);
}

class UffGeometry : public testing::Test {
 protected:
  std::string file(const std::string& text) {
    write_text(folder_ / "a.uff", text);
    return folder_ / "a.uff";
  }
  data::ReadRecordResult record(const std::string& text) { return data::read_record(file(text)); }
  [[nodiscard]] std::string path(const char* name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
};
constexpr std::array formats{data::RecordFormat::hdf5,  data::RecordFormat::mat5,
                             data::RecordFormat::mat73, data::RecordFormat::csv,
                             data::RecordFormat::uff,   data::RecordFormat::rpc};

TEST_F(UffGeometry, OfAFileInMillimetresIsInMetres) {
  const auto [record, notes] = this->record(foreign_record());
  EXPECT_THAT(messages(notes),
              ElementsAre(HasSubstr("\"Acceleration, WING node 12 z\": converted to \"m/s^2\""),
                          HasSubstr("\"Acceleration, WING node 7 -x\": converted to \"m/s^2\"")));
  const auto& g = record.header.geometry;
  ASSERT_EQ(g.nodes.size(), 2U);
  EXPECT_EQ(g.nodes[0].number, 12);
  EXPECT_TRUE(g.nodes[0].position.isApprox(Eigen::Vector3d(0.125, -0.0375, 0.0), 1e-15));
  EXPECT_TRUE(g.nodes[1].position.isApprox(Eigen::Vector3d(0.0, 0.4125, -0.0015), 1e-15));
  EXPECT_EQ(g.nodes[1].position_system, 1);
  EXPECT_EQ(g.nodes[1].motion_system, 2);
  EXPECT_EQ(g.nodes[1].color, 8);
  ASSERT_EQ(g.lines.size(), 1U);
  EXPECT_EQ(g.lines[0].name, "leading edge");
  EXPECT_EQ(g.lines[0].color, 3);
  EXPECT_THAT(g.lines[0].nodes, ElementsAre(12, 7, 0, 7, 12, 0, 12, 7, 12, 7));
  ASSERT_EQ(record.header.channels.size(), 2U);
  const auto& c = record.header.channels[0];
  EXPECT_EQ(c.entity, "WING");
  EXPECT_EQ(c.point, 12);
  EXPECT_EQ(c.direction, data::Direction::z);
  EXPECT_THAT(c.id_lines,
              ElementsAre("run 3, flap 5 deg", "WING:12:+Z", "03-Feb-24 11:12:13", "Time"));
  EXPECT_THAT(record.header.channels[1].id_lines, IsEmpty());
  EXPECT_EQ(record.header.date, "2024-02-03T11:12:13");
  EXPECT_EQ(record.header.title, "wing_7.mdl");
  EXPECT_EQ(record.header.notes, "left wing on bungees\nprogram: Analyser 12.3\n");
  EXPECT_DOUBLE_EQ(record.samples(2, 0), 0.0035);
}

TEST_F(UffGeometry, IsWrittenAsItWasRead) {
  const auto foreign = record(foreign_record()).record;
  data::write_record(path("b.uff"), foreign, data::RecordFormat::uff_ascii);
  const auto b = uff::Reader(read_text(path("b.uff"))).read();
  EXPECT_THAT(b.datasets, ElementsAre(151, 164, 99001, 15, 82, 58, 58));
  ASSERT_EQ(b.nodes.size(), 2U);
  EXPECT_EQ(b.nodes[0].number, 12);
  EXPECT_EQ(b.nodes[0].systems[1], 2);
  EXPECT_EQ(b.nodes[0].color, 11);
  EXPECT_EQ(b.nodes[1].x[1], 0.4125);
  ASSERT_EQ(b.lines.size(), 1U);
  EXPECT_EQ(b.lines[0].name, "leading edge");
  EXPECT_THAT(b.lines[0].nodes, ElementsAre(12, 7, 0, 7, 12, 0, 12, 7, 12, 7));
  EXPECT_EQ(b.functions[0].id[0], "run 3, flap 5 deg");
  EXPECT_EQ(b.functions[0].id[1], "WING:12:+Z");
  EXPECT_EQ(b.functions[0].id[4], "NONE");
  EXPECT_EQ(b.functions[0].response_entity, "WING");
  EXPECT_EQ(b.functions[0].response_node, 12);
  EXPECT_EQ(b.functions[1].response_direction, -1);
  const auto [again, notes] = data::read_record(path("b.uff"));
  EXPECT_THAT(notes, IsEmpty());
  expect_same_header(again.header, foreign.header);
}

/// Six digits are not enough for a third; a peer that knows dataset 2411 gets all of them.
TEST_F(UffGeometry, OfMoreThanSixDigitsIsWrittenInDoublePrecision) {
  data::Record sent = sample_record(3);
  sent.header.channels[4].entity = "Flügel 2";
  sent.header.channels[4].id_lines = {"a1 +X, \"left\"", "NONE", "20-NOV-26 09:00:00"};
  sent.header.geometry = {
      .nodes = {{7, {0.1, -1.0 / 3.0, 1e-17}, 1, 2, 11}, {-2, {0.0, 5e6, -0.25}}},
      .lines = {{"rim; \"upper\"", {7, -2, 0, 7}, 3}, {"", {}, 0}}};
  data::write_record(path("c.uff"), sent, data::RecordFormat::uff);
  const auto c = uff::Reader(read_text(path("c.uff"))).read();
  ASSERT_EQ(c.nodes.size(), 2U);
  EXPECT_EQ(c.datasets[3], 2411);
  EXPECT_EQ(c.nodes[0].number, 7);
  EXPECT_EQ(c.nodes[0].x[1], -1.0 / 3.0);
  EXPECT_EQ(c.nodes[0].x[2], 1e-17);
  EXPECT_EQ(c.nodes[1].x[1], 5e6);
  for (const auto format : formats) {
    SCOPED_TRACE(data::format_text(format));
    data::write_record(path("x"), sent, format);
    expect_same_header(data::read_record(path("x")).record.header, sent.header);
  }
}

TEST_F(UffGeometry, OfDataset2411IsRead) {
  const auto g = record(millimetres() +
                        dataset(2411,
                                "       101         0         0        11\n"
                                "   3.3333333333333331D+02  -1.2500000000000000D-02"
                                "   0.0000000000000000D+00\n") +
                        curve(at(101, 1)))
                     .record.header.geometry;
  ASSERT_EQ(g.nodes.size(), 1U);
  EXPECT_EQ(g.nodes[0].number, 101);
  EXPECT_DOUBLE_EQ(g.nodes[0].position.x(), 0.33333333333333331);
  EXPECT_DOUBLE_EQ(g.nodes[0].position.y(), -1.25e-5);
}

TEST_F(UffGeometry, GoesThroughEveryFormat) {
  const auto foreign = record(foreign_record()).record;
  for (const auto format : formats) {
    SCOPED_TRACE(data::format_text(format));
    data::write_record(path("x"), foreign, format);
    expect_same_header(data::read_record(path("x")).record.header, foreign.header);
  }
}

TEST_F(UffGeometry, ThatIsDamagedIsSaid) {
  const auto [record, notes] = this->record(
      dataset(15,
              "        12         1         2        11  1.2x000E+02  0.0000E+00  0.00000E+00\n") +
      curve(at(1, 1)));
  EXPECT_THAT(messages(notes), testing::Contains(HasSubstr("a coordinate is \"1.2x000E+02\"")));
  EXPECT_THAT(record.header.geometry.nodes, IsEmpty());
}

// units

/// A units code and factors that say different things: nobody knows which holds.
TEST_F(UffGeometry, InUnitsThatContradictThemselvesIsLeftOut) {
  const auto [record, notes] =
      this->record(units(1, "SI units", "3.28083989501312334D+00", "2.2480894309971D-01") +
                   nodes_15() + curve(at(12, 3)));
  EXPECT_THAT(messages(notes),
              testing::Contains(HasSubstr("dataset 164 contradicts itself: units code 1 means 1 "
                                          "units of length in a metre and 1 of force")));
  EXPECT_THAT(messages(notes), testing::Contains(HasSubstr("the nodes are left out")));
  EXPECT_THAT(record.header.geometry.nodes, IsEmpty());
  EXPECT_EQ(record.header.channels[0].unit, "");  // unknown
  EXPECT_EQ(record.samples(0, 0), 1.0);
}

TEST_F(UffGeometry, FactorsThatAreNotThereFollowFromTheCode) {
  const std::string inches = dataset(164, "         7IN: Inch (pound f)          2\n");
  const auto g = record(inches + nodes_15() + curve(at(12, 3))).record;
  EXPECT_DOUBLE_EQ(g.header.geometry.nodes[0].position.x(), 125.0 * 0.0254);
  EXPECT_DOUBLE_EQ(g.samples(1, 0), -2.0 * 0.0254);
  const auto [unknown, notes] =
      record(dataset(164, "         9US\n  0.0D+00  0.0D+00\n") + nodes_15() + curve(at(12, 3)));
  EXPECT_THAT(messages(notes), testing::Contains(HasSubstr("not two positive numbers")));
  EXPECT_EQ(unknown.header.channels[0].unit, "");
}

TEST_F(UffGeometry, WithoutUnitsIsTakenAsMetresAndSaid) {
  const auto [record, notes] = this->record(nodes_15() + curve(at(12, 3)));
  EXPECT_THAT(messages(notes),
              ElementsAre("the file states no units (dataset 164): coordinates are taken as metres",
                          "a function has no unit label, and the file states no units (dataset "
                          "164): taken as SI"));
  EXPECT_EQ(record.header.geometry.nodes[0].position.x(), 125.0);
}

/// Two files one behind the other: each function has the units that stand before it.
TEST_F(UffGeometry, UnitsHoldForWhatFollowsThem) {
  const auto record = this->record(units(1, "SI: Meter (newton)", "1.0D+00", "1.0D+00") +
                                   curve(at(1, 1)) + millimetres() + curve(at(2, 1)))
                          .record;
  EXPECT_EQ(record.samples(2, 0), 3.5);
  EXPECT_DOUBLE_EQ(record.samples(2, 1), 0.0035);
}

// frequency responses

std::string response(int node, int direction, const std::array<std::string, 5>& id,
                     const std::string& values) {
  Curve c = at(node, direction);
  c.id = id;
  c.type = 4;
  c.is_complex = true;
  c.reference = "WING";
  c.reference_node = 3;
  c.reference_direction = -3;
  c.denominator = "        13    0    1    0 Force                NONE";
  c.values = values;
  return curve(c);
}
constexpr const char* six =
    "  1.00000E+00 -2.00000E+00  3.50000E+00  4.00000E+00  5.00000E+00  6.25000E+00\n";

TEST_F(UffGeometry, AndLinesOfTextOfResponsesAreKept) {
  const std::string text =
      header_151 + millimetres() + nodes_15() + trace_82() +
      response(12, 3, {"FRF 12Z/3Z-", "H1, 20 averages", "NONE", "burst", "last"}, six) +
      response(7, -1, {"NONE", "NONE", "NONE", "NONE", "NONE"}, six) +
      response(7, -1, {"again", "NONE", "NONE", "NONE", "NONE"}, six);
  const auto [got, notes] = data::read_frequency_responses(file(text));
  EXPECT_THAT(messages(notes),
              testing::Contains("dataset 7 is a second response of the same output to the same "
                                "input: left out"));
  ASSERT_EQ(got.outputs.size(), 2U);
  ASSERT_EQ(got.inputs.size(), 1U);
  EXPECT_EQ(got.outputs[0].name, "Acceleration, WING node 12 z");
  EXPECT_EQ(got.inputs[0].name, "Force");
  EXPECT_EQ(got.inputs[0].direction, data::Direction::minus_z);
  EXPECT_EQ(got.inputs[0].entity, "WING");
  EXPECT_EQ(got.outputs[0].unit, "m/s^2");
  EXPECT_EQ(got.H[1](0, 0), std::complex<double>(3.5, 4.0));  // mm by mN
  ASSERT_EQ(got.id_lines.size(), 2U);
  EXPECT_THAT(got.id_lines[0],
              ElementsAre("FRF 12Z/3Z-", "H1, 20 averages", "NONE", "burst", "last"));
  EXPECT_THAT(got.id_lines[1], IsEmpty());
  data::write_frequency_responses(path("h.uff"), got);
  const auto h = uff::Reader(read_text(path("h.uff"))).read();
  ASSERT_EQ(h.functions.size(), 2U);
  EXPECT_EQ(h.functions[0].id[1], "H1, 20 averages");
  EXPECT_EQ(h.functions[0].reference_entity, "WING");
  EXPECT_EQ(h.functions[0].reference_node, 3);
  EXPECT_EQ(h.functions[0].reference_direction, -3);
  EXPECT_EQ(h.nodes.size(), 2U);
  for (const char* name : {"h.uff", "h.csv", "h.mat", "h.h5"}) {
    SCOPED_TRACE(name);
    if (name == std::string("h.csv")) write_text(path(name), data::response_table(got));
    if (name == std::string("h.mat"))
      data::write_mat_variables(path(name), data::response_arrays(got));
    if (name == std::string("h.h5"))
      data::write_hdf5_variables(path(name), data::response_arrays(got));
    const auto again = data::read_frequency_responses(path(name)).responses;
    EXPECT_EQ(again.id_lines, got.id_lines);
    expect_same_geometry(again.geometry, got.geometry);
    EXPECT_EQ(again.outputs[1].name, got.outputs[1].name);
    EXPECT_EQ(again.outputs[1].entity, "WING");
    EXPECT_EQ(again.H, got.H);
  }
}

/// A coherence names its channel by part and place; it has no unit.
TEST_F(UffGeometry, CoherenceBelongsToTheResponseOfThePlace) {
  Curve coherence = at(12, 3);
  coherence.id = {"COH", "NONE", "NONE", "NONE", "NONE"};
  coherence.type = 26;
  coherence.reference = "NONE";
  coherence.is_complex = true;
  coherence.ordinate = "         0    0    0    0 Coherence            NONE";
  coherence.values =
      "  8.75000E-01  0.00000E+00  1.00000E+00  0.00000E+00  5.00000E-01  0.00000E+00\n";
  const auto [got, notes] = data::read_frequency_responses(
      file(header_151 + millimetres() + nodes_15() +
           response(12, 3, {"H", "NONE", "NONE", "NONE", "NONE"}, six) +
           response(7, -1, {"H", "NONE", "NONE", "NONE", "NONE"}, six) + curve(coherence)));
  EXPECT_THAT(messages(notes), testing::Not(testing::Contains(HasSubstr("without its response"))));
  ASSERT_EQ(got.multiple_coherence.size(), 3U);
  EXPECT_EQ(got.multiple_coherence[0][0], 0.875);
  EXPECT_EQ(got.multiple_coherence[2][0], 0.5);
}

// modes

/// A normal mode at 7.25 Hz with 2 %, six numbers per node, in inches, as accelerations.
TEST_F(UffGeometry, ShapesInInchesAndAsAccelerationsAreDisplacementsInMetres) {
  const std::string mode =
      dataset(55,
              "first bending\nmode 1\n03-FEB-24\nNONE\nAnalyser\n"
              "         1         2         3        12         2         6\n"
              "         2         4         1         1\n"
              "  7.25000E+00  1.00000E+00  2.00000E-02  0.00000E+00\n"
              "        12\n"
              "  1.00000E+02  0.00000E+00  0.00000E+00  0.00000E+00  2.00000E+00  0.00000E+00\n");
  const auto [got, notes] = data::read_modal_results(
      file(units(7, "IN: Inch (pound f)", "3.93700787401574814D+01", "2.2480894309971D-01") +
           nodes_15() + mode));
  EXPECT_THAT(messages(notes), ElementsAre(HasSubstr("the shapes are accelerations")));
  ASSERT_EQ(got.modes.size(), 1U);
  ASSERT_EQ(got.outputs.size(), 2U);
  EXPECT_EQ(got.outputs[0].name, "node 12 x");
  EXPECT_EQ(got.outputs[1].name, "node 12 ry");
  const auto pole = got.modes[0].pole;
  EXPECT_LT(std::abs(got.modes[0].shape[0] - 100.0 * 0.0254 / (pole * pole)), 1e-12);
  EXPECT_LT(std::abs(got.modes[0].shape[1] - 2.0 / (pole * pole)), 1e-12);
  EXPECT_THAT(got.modes[0].id_lines,
              ElementsAre("first bending", "mode 1", "03-FEB-24", "NONE", "Analyser"));
  ASSERT_EQ(got.geometry.nodes.size(), 2U);
  EXPECT_DOUBLE_EQ(got.geometry.nodes[0].position.x(), 125.0 * 0.0254);
  data::write_modal_results(path("m.uff"), got);
  const std::string text = read_text(path("m.uff"));
  EXPECT_THAT(text, HasSubstr("    55\nfirst bending"));
  expect_same_geometry(data::read_modal_results(path("m.uff")).results.geometry, got.geometry);
}

TEST_F(UffGeometry, ShapesWithAnglesInUnknownLengthsAreRefused) {
  const std::string mode = dataset(
      55,
      "NONE\nNONE\nNONE\nNONE\nNONE\n         1         2         3         8         2         6\n"
      "         2         4         1         1\n  7.25000E+00  1.00000E+00  2.00000E-02  0.0E+00\n"
      "        12\n  1.00000E+02  0.00000E+00  0.00000E+00  0.00000E+00  2.00000E+00  0.0E+00\n");
  const std::string path = file(units(1, "SI", "1.0D+03", "1.0D+03") + mode);
  EXPECT_THAT(refusal_of([&] { data::read_modal_results(path); }).message,
              HasSubstr("lengths and angles, and the unit of the lengths is unknown"));
}

}  // namespace
}  // namespace hydrapod::test
