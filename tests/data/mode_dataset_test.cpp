/// Modes in dataset 2414, as finite-element programs keep them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "support/run_program.hpp"

namespace hydrapod::data {
namespace {

using Complex = std::complex<double>;
using testing::HasSubstr;
using testing::SizeIs;

/// Card by card after the description of the format: a normal mode at two nodes of three values.
std::string analysis(int location, int kind) {
  const std::string type = std::string(9, ' ') + std::to_string(kind);
  return "    -1\n  2414\n         7\nMODE 7                                  \n" +
         std::string(9, ' ') + std::to_string(location) +
         "\nboom of a crane\nNONE\nNONE\nNONE\nNONE\n"
         "         1" +
         type +
         "         2         8         2         3\n"
         "         0         0         1         0         1         7         0         0\n"
         "         0         0\n"
         "  0.00000E+00  1.25000E+01  6.16850E+03  4.00000E+00  2.50000E-02  0.00000E+00\n"
         "  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00\n"
         "        31\n  1.00000E+00 -2.00000E+00  5.00000E-01\n"
         "        32\n  0.00000E+00  4.00000E-01  0.00000E+00\n"
         "    -1\n";
}

const std::string mesh =
    "    -1\n  2411\n        31         1         1        11\n"
    "   1.0000000000000000D+00   2.0000000000000000D+00   3.0000000000000000D+00\n"
    "        32         1         1        11\n"
    "   1.5000000000000000D+00   2.0000000000000000D+00   3.0000000000000000D+00\n    -1\n"
    "    -1\n  2412\n"
    "         1        11         1         1         7         2\n"
    "         0         1         1\n        31        32\n"
    "         2        94         1         1         7         4\n"
    "        31        32        31        32\n    -1\n";

ReadModalResultsResult read(const std::string& text) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "m.unv", text);
  return read_modal_results(folder / "m.unv");
}

TEST(AnalysisDataset, OfAnotherProgramIsRead) {
  const auto [modes, notes] = read(mesh + analysis(1, 2));
  ASSERT_THAT(modes.modes, SizeIs(1));
  const auto& mode = modes.modes[0];
  EXPECT_NEAR(mode.omega(), base::two_pi * 12.5, 1e-9);
  EXPECT_NEAR(mode.damping_ratio(), 0.025, 1e-12);
  EXPECT_EQ(mode.modal_mass, 4.0);
  ASSERT_THAT(modes.outputs, SizeIs(4));
  EXPECT_EQ(modes.outputs[1].name, "node 31 y");
  EXPECT_EQ(mode.shape[1], Complex(-2.0));
  EXPECT_EQ(modes.outputs[3].name, "node 32 y");
  EXPECT_EQ(mode.shape[3], Complex(0.4));
  EXPECT_EQ(mode.id_lines[0], "boom of a crane");
  ASSERT_THAT(modes.geometry.nodes, SizeIs(2));
  EXPECT_EQ(modes.geometry.nodes[1].position, Eigen::Vector3d(1.5, 2.0, 3.0));
  ASSERT_THAT(modes.geometry.lines, SizeIs(1));  // rods; shells have no line
  EXPECT_THAT(modes.geometry.lines[0].nodes, testing::ElementsAre(31, 32, 0));
}

TEST(AnalysisDataset, ThatIsNoModeIsLeftOut) {
  const auto [modes, notes] = read(analysis(1, 2) + analysis(1, 1) + analysis(2, 2));
  EXPECT_THAT(modes.modes, SizeIs(1));
  ASSERT_FALSE(notes.empty());
  EXPECT_THAT(notes.back().message, HasSubstr("2 datasets 55 and 2414 that are no modes"));
}

/// A mode that is in both is one mode.
TEST(AnalysisDataset, BesideDatasets55IsLeftOut) {
  const std::string shape =
      "    -1\n    55\nNONE\nNONE\nNONE\nNONE\nNONE\n"
      "         1         2         2         8         2         3\n"
      "         2         4         1         7\n"
      "  1.25000E+01  4.00000E+00  2.50000E-02  0.00000E+00\n"
      "        31\n  1.00000E+00 -2.00000E+00  5.00000E-01\n    -1\n";
  const auto [modes, notes] = read(shape + analysis(1, 2));
  EXPECT_THAT(modes.modes, SizeIs(1));
  EXPECT_THAT(notes.back().message, HasSubstr("1 datasets 2414 left out"));
}

TEST(AnalysisDataset, CutOffSaysWhere) {
  const auto refused = [](const std::string& text) {
    try {
      read(text);
    } catch (const base::InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const auto text = analysis(1, 2);
  EXPECT_THAT(refused(text.substr(0, text.find("  0.00000E+00  1.25"))),
              HasSubstr("dataset 2414: ends too early"));
  EXPECT_THAT(refused(text.substr(0, text.find("        32") + 11)),
              HasSubstr("dataset 2414: ends too early"));
  auto wrong = text;
  wrong.replace(wrong.find("  1.25000E+01"), 13, "  twelve     ");
  EXPECT_THAT(refused(wrong), HasSubstr(":14:1: error: dataset 2414: field 2 is no number"));
  EXPECT_THAT(refused(analysis(1, 1)), HasSubstr("no modes (datasets 55 or 2414)"));
}

/// Two masses on three springs, pushed where they are measured: φ, ω, ζ, L.
ModalResults two_masses(bool complex) {
  ModalResults all{.title = "two masses"};
  for (int i = 0; i < 2; ++i) {
    all.outputs.push_back({.name = "mass " + std::to_string(i + 1),
                           .unit = "m",
                           .direction = Direction::x,
                           .point = i + 1});
    all.inputs.push_back({.name = "force " + std::to_string(i + 1),
                          .unit = "N",
                          .direction = Direction::x,
                          .point = i + 1});
    all.geometry.nodes.push_back({.number = i + 1, .position = {0.7 * i, 0.0, 0.1}});
  }
  all.geometry.lines = {{.name = "bar", .nodes = {1, 2}}};
  for (int r = 0; r < 2; ++r) {
    ModalResult mode{.pole = {-0.31 - r, 17.3 + 11.9 * r}};
    mode.shape.resize(2);
    mode.shape << 0.41, (r == 0 ? 0.57 : -0.83);
    const double mass = 3.7 + r;
    mode.participation = mode.shape / (Complex(0.0, 2.0) * mode.pole.imag() * mass);
    if (complex) {
      mode.shape[1] *= Complex(1.0, 0.2);
      mode.participation[1] *= Complex(1.0, 0.2);
    }
    all.modes.push_back(mode);
  }
  return all;
}

TEST(AnalysisDataset, ComesBackAsItWasWritten) {
  for (const bool complex : {false, true}) {
    const test::TemporaryFolder folder;
    const auto written = two_masses(complex);
    write_modal_results(folder / "m.unv", written, ModalDataset::analysis);
    const auto text = test::read_text(folder / "m.unv");
    EXPECT_THAT(text, HasSubstr("\n  2411\n"));
    EXPECT_THAT(text, HasSubstr("\n  2412\n         1        11"));
    EXPECT_EQ(text.find("\n    55\n"), std::string::npos);
    EXPECT_EQ(text.find("3.70000E+00") != std::string::npos, !complex);  // modal mass
    const auto [read, notes] = read_modal_results(folder / "m.unv");
    EXPECT_TRUE(notes.empty()) << notes.front().message;
    ASSERT_EQ(read.modes.size(), 2U);
    ASSERT_EQ(read.inputs.size(), 2U);
    EXPECT_EQ(read.geometry.lines.front().nodes, written.geometry.lines.front().nodes);
    for (std::size_t r = 0; r < 2; ++r) {
      const auto &a = written.modes[r], &b = read.modes[r];
      EXPECT_LT(std::abs(a.pole - b.pole), 1e-5 * std::abs(a.pole));
      const Eigen::Matrix2cd residue = a.shape * a.participation.transpose(),
                             same = b.shape * b.participation.transpose();
      EXPECT_LT((residue - same).norm(), 2e-5 * residue.norm());
    }
  }
}

/// No node without a place: inputs elsewhere are not held.
TEST(AnalysisDataset, LeavesOutInputsElsewhere) {
  auto modes = two_masses(true);
  modes.inputs[0].point = 9;
  const test::TemporaryFolder folder;
  write_modal_results(folder / "m.unv", modes, ModalDataset::analysis);
  const auto read = read_modal_results(folder / "m.unv").results;
  EXPECT_TRUE(read.inputs.empty());
  EXPECT_EQ(read.modes.size(), 2U);
}

}  // namespace
}  // namespace hydrapod::data
