/// Modes in Universal Files (dataset 55) and results in MAT files.

#include "hydrapod/data/modal_results.hpp"

#include <gmock/gmock.h>

#include <map>
#include <memory>
#include <sstream>

#include "hydrapod/data/record_io.hpp"
#include "mat_variables.hpp"
#include "support/run_program.hpp"

namespace hydrapod::data {
namespace {

using Complex = std::complex<double>;
using testing::HasSubstr;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// |aᴴ b|² over the squared norms, written out.
TEST(Shapes, CorrelateByTheSquareOfTheirProduct) {
  const Eigen::Vector2cd a(1.0, Complex(0.0, 2.0)), b(2.0, 1.0);
  EXPECT_NEAR(mac(a, b), std::norm(Complex(2.0, -2.0)) / 25.0, 1e-15);
  EXPECT_NEAR(mac(a, Complex(-0.3, 1.7) * a), 1.0, 1e-15);
}

/// ((λ1 − λ2)/(λ1 + λ2))² of the scatter of the real and imaginary parts.
TEST(Shapes, PhaseCollinearityIsThatOfTheScatterOfTheParts) {
  const Eigen::Vector3cd shape(Complex(3.0, 1.0), Complex(-2.0, 2.0), 0.5);
  const double rr = 9.0 + 4.0 + 0.25, ii = 1.0 + 4.0, ri = 3.0 - 4.0;
  const double apart = std::sqrt((rr - ii) * (rr - ii) + 4.0 * ri * ri);  // λ1 − λ2
  EXPECT_NEAR(modal_phase_collinearity(shape), std::pow(apart / (rr + ii), 2), 1e-15);
  EXPECT_NEAR(modal_phase_collinearity(Eigen::Vector2cd(1.0, Complex(0.0, 1.0))), 0.0, 1e-15);
}

/// Two equal elements 0.23 rad on either side of a line, and one on it, weighed by their sizes.
TEST(Shapes, MeanPhaseDeviationIsThatFromTheLineThatFitsBest) {
  for (const double line : {0.7, -1.3, 2.9}) {
    const Eigen::Vector3cd shape(std::polar(1.7, line + 0.23), std::polar(1.7, line - 0.23),
                                 -std::polar(0.9, line));
    EXPECT_NEAR(mean_phase_deviation(shape), 0.23 * 3.4 / 4.3, 1e-12) << line;
  }
}

ModalResults sample() {
  ModalResults all{.title = "Bench 7", .date = "2026-11-20T09:00:00"};
  all.outputs = {{.name = "surge, x", .unit = "m", .direction = Direction::x, .point = 3},
                 {.name = "tilt", .unit = "rad", .direction = Direction::minus_ry, .point = 3},
                 {.name = "leg", .unit = "m", .direction = Direction::leg2},
                 {.name = "second x", .unit = "m", .direction = Direction::x, .point = 3}};
  for (int r = 0; r < 2; ++r) {
    ModalResult mode{.pole = {-1.2345678 - r, 30.5 + 7.0 * r}};
    mode.shape.resize(4);
    mode.shape << Complex(1.25, -0.5), Complex(-3.5e-3, 2e-4 * (r + 1)), Complex(0.125, 0.0),
        Complex(-1.0 / 3.0, 1e-7);
    all.modes.push_back(mode);
  }
  return all;
}

TEST(ModalResults, AreWrittenInTheColumnsOfDataset55) {
  const test::TemporaryFolder folder;
  write_modal_results(folder / "modes.uff", sample());
  const auto lines = lines_of(test::read_text(folder.path() / "modes.uff"));
  std::vector<std::size_t> at;
  for (std::size_t k = 0; k < lines.size(); ++k)
    if (lines[k] == "    55") at.push_back(k);
  ASSERT_EQ(at.size(), 2U);
  const auto line = [&](std::size_t k) { return lines[at[1] + k]; };
  EXPECT_EQ(lines[at[1] - 1], "    -1");
  for (std::size_t id = 1; id <= 5; ++id) EXPECT_EQ(line(id).size(), 80U);
  EXPECT_THAT(line(1), HasSubstr("Bench 7"));
  // record 6, 6I10: structure, complex eigenvalue, six directions, displacement, complex, six
  EXPECT_EQ(line(6), "         1         3         3         8         5         6");
  // record 7, I10: 2 integers, 6 real numbers, load case 1, mode 2
  EXPECT_EQ(line(7), "         2         6         1         2");
  // record 8, 6E13.5: eigenvalue, modal A, modal B = −λ
  EXPECT_EQ(line(8),
            " -2.23457E+00  3.75000E+01  1.00000E+00  0.00000E+00  2.23457E+00 -3.75000E+01");
  // record 9 and 10: node, six complex numbers on two lines; −ry turned round
  EXPECT_EQ(line(9), "         3");
  EXPECT_EQ(line(10),
            "  1.25000E+00 -5.00000E-01  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00");
  EXPECT_EQ(line(11),
            "  0.00000E+00  0.00000E+00  3.50000E-03 -4.00000E-04  0.00000E+00  0.00000E+00");
  EXPECT_EQ(line(12), "         4");
  EXPECT_EQ(line(15), "         5");
  EXPECT_EQ(line(18), "    -1");
}

TEST(ModalResults, ComeBackToSixDigits) {
  const test::TemporaryFolder folder;
  const auto written = sample();
  write_modal_results(folder / "modes.uff", written);
  const auto read = read_modal_results(folder / "modes.uff");
  EXPECT_TRUE(read.notes.empty());
  EXPECT_EQ(read.results.title, written.title);
  EXPECT_EQ(read.results.date, written.date);
  ASSERT_EQ(read.results.outputs.size(), 4U);
  for (std::size_t o = 0; o < 4; ++o) {
    EXPECT_EQ(read.results.outputs[o].name, written.outputs[o].name);
    EXPECT_EQ(read.results.outputs[o].unit, written.outputs[o].unit);
    EXPECT_EQ(read.results.outputs[o].direction, written.outputs[o].direction);
    EXPECT_EQ(read.results.outputs[o].point, written.outputs[o].point);
  }
  ASSERT_EQ(read.results.modes.size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    const auto& a = written.modes[r];
    const auto& b = read.results.modes[r];
    EXPECT_LT(std::abs(a.pole - b.pole), 5e-6 * std::abs(a.pole));
    EXPECT_LT((a.shape - b.shape).norm(), 5e-6 * a.shape.norm());
  }
}

/// What another program makes of the text: eigenvalue, modal A and numbers at nodes.
struct ForeignMode {
  Complex pole, modal_a;
  std::map<std::pair<int, int>, Complex> psi;  // (node, component)
};

std::vector<ForeignMode> foreign_modes(const std::string& text) {
  std::vector<ForeignMode> modes;
  const auto lines = lines_of(text);
  const auto number = [](const std::string& line, std::size_t k) {
    return std::stod(line.substr(13 * k, 13));
  };
  const auto two = [&](const std::string& line, std::size_t k) {
    return Complex(number(line, 2 * k), number(line, 2 * k + 1));
  };
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k] != "    55") continue;
    const int per_node = std::stoi(lines[k + 6].substr(50));
    ForeignMode mode{two(lines[k + 8], 0), two(lines[k + 8], 1), {}};
    for (std::size_t at = k + 9; lines[at] != "    -1";
         at += 1 + static_cast<std::size_t>(per_node) / 3)
      for (int c = 0; c < per_node; ++c)
        mode.psi[{std::stoi(lines[at]), c}] =
            two(lines[at + 1 + static_cast<std::size_t>(c) / 3], static_cast<std::size_t>(c) % 3);
    modes.push_back(mode);
  }
  return modes;
}

using Place = std::pair<int, int>;

/// H from the text alone.
Complex synthesised(const std::vector<ForeignMode>& modes, Place output, Place input, Complex s) {
  Complex H = 0.0;
  for (const auto& mode : modes) {
    const Complex product = mode.psi.at(output) * mode.psi.at(input);
    H += product / (mode.modal_a * (s - mode.pole)) +
         std::conj(product) / (std::conj(mode.modal_a) * (s - std::conj(mode.pole)));
  }
  return H;
}

Complex exact(const ModalResults& all, Eigen::Index output, Eigen::Index input, Complex s) {
  Complex H = 0.0;
  for (const auto& mode : all.modes) {
    const Complex residue = mode.shape[output] * mode.participation[input];
    H += residue / (s - mode.pole) + std::conj(residue) / (s - std::conj(mode.pole));
  }
  return H;
}

/// Displacements of a reciprocal system by forces where outputs 0 (x at 3) and 1 (−ry at 3) are.
ModalResults driven_sample(bool reciprocal) {
  auto all = sample();
  all.inputs = {{.name = "moment", .unit = "N m", .direction = Direction::ry, .point = 3},
                {.name = "force", .unit = "N", .direction = Direction::x, .point = 3}};
  for (auto& mode : all.modes) {
    const Complex scale(0.013, -0.021);
    mode.participation.resize(2);
    mode.participation << -scale * mode.shape[1], scale * mode.shape[0];
    if (!reciprocal) mode.participation[0] *= Complex(1.7, -0.9);
  }
  return all;
}

/// Of driven_sample() in a file that says `said`, in which the inputs are at these places.
void expect_synthesis(const ModalResults& all, const std::string& said,
                      const std::vector<Place>& inputs) {
  const test::TemporaryFolder folder;
  write_modal_results(folder / "modes.uff", all);
  const auto text = test::read_text(folder.path() / "modes.uff");
  EXPECT_THAT(text, HasSubstr(said));
  const std::vector<Place> outputs{{3, 0}, {3, 4}, {4, 0}, {5, 0}};
  const std::vector<double> signs{1.0, -1.0, 1.0, 1.0};
  const auto modes = foreign_modes(text);
  ASSERT_EQ(modes.size(), all.modes.size());
  for (const auto& mode : modes) EXPECT_EQ(mode.modal_a, 1.0);
  for (std::size_t i = 0; i < inputs.size(); ++i)
    for (std::size_t o = 0; o < outputs.size(); ++o)
      for (const double omega : {3.0, 29.9, 31.0, 38.0, 70.0}) {
        const Complex s(0.0, omega),
            H = exact(all, static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(i), s),
            other = signs[o] * synthesised(modes, outputs[o], inputs[i], s);
        // three numbers of six digits, near a pole
        EXPECT_LT(std::abs(other - H), 1e-4 * std::abs(H)) << o << " from " << i << " at " << omega;
      }
}

TEST(ModalResults, ResponsesToForcesFollowFromTheShapesAlone) {
  expect_synthesis(driven_sample(true), "shape as displacement, SI; forces at nodes 3ry 3x",
                   {{3, 4}, {3, 0}});
}

/// Of a controlled machine, say: no shape holds both sides, so inputs get nodes of their own.
TEST(ModalResults, ResponsesThatAreNotReciprocalFollowFromNodesOfTheInputs) {
  auto not_forces = driven_sample(true);
  not_forces.inputs[1].unit = "V";
  for (const auto& all : {driven_sample(false), not_forces})
    expect_synthesis(all, "shape as displacement, SI; inputs at nodes 6x 7x", {{6, 0}, {7, 0}});
}

TEST(ModalResults, ParticipationsComeBack) {
  const test::TemporaryFolder folder;
  for (const bool reciprocal : {true, false}) {
    const auto written = driven_sample(reciprocal);
    write_modal_results(folder / "modes.uff", written);
    const auto read = read_modal_results(folder / "modes.uff").results;
    ASSERT_EQ(read.outputs.size(), 4U);
    ASSERT_EQ(read.inputs.size(), 2U);
    EXPECT_EQ(read.inputs[0].name, "moment");
    for (std::size_t r = 0; r < 2; ++r) {
      const auto &a = written.modes[r], &b = read.modes[r];
      const Eigen::MatrixXcd sent = a.shape * a.participation.transpose(),
                             got = b.shape * b.participation.transpose();
      EXPECT_LT((got - sent).norm(), 2e-5 * sent.norm());
      EXPECT_NEAR(b.participation.cwiseAbs().maxCoeff(), 1.0, 1e-15);
    }
  }
}

TEST(ModalResults, NormalModesOfOtherProgramsAreRead) {
  const test::TemporaryFolder folder;
  test::write_text(folder.path() / "fe.unv", R"(    -1
    55
some program
NONE
NONE
NONE
NONE
         1         2         2         8         2         3
         2         4         1         1
  1.27000E+01  1.00000E+00  2.50000E-02  0.00000E+00
        11
  1.00000E+00  0.00000E+00 -5.00000D-01
        12
  0.00000E+00  2.00000E+00  0.00000E+00
    -1
)");
  const auto read = read_modal_results(folder / "fe.unv");
  ASSERT_EQ(read.results.modes.size(), 1U);
  const auto& mode = read.results.modes[0];
  EXPECT_NEAR(std::abs(mode.pole) / (2.0 * M_PI), 12.7, 1e-12);
  EXPECT_NEAR(-mode.pole.real() / std::abs(mode.pole), 0.025, 1e-12);
  ASSERT_EQ(read.results.outputs.size(), 3U);
  EXPECT_EQ(read.results.outputs[0].name, "node 11 x");
  EXPECT_EQ(read.results.outputs[1].name, "node 11 z");
  EXPECT_EQ(read.results.outputs[2].name, "node 12 y");
  EXPECT_EQ(mode.shape[1], -0.5);
}

TEST(ModalResults, DamagedFilesAreRefusedWithTheLine) {
  const test::TemporaryFolder folder;
  write_modal_results(folder / "modes.uff", sample());
  const std::string text = test::read_text(folder.path() / "modes.uff");
  const auto refused = [&](const std::string& damaged) {
    test::write_text(folder.path() / "bad.uff", damaged);
    try {
      read_modal_results(folder / "bad.uff");
    } catch (const base::InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refused("    -1\n    58\n    -1\n"), HasSubstr("no modes"));
  EXPECT_THAT(refused(text.substr(0, text.rfind("         5\n") + 20)), HasSubstr("no number"));
  EXPECT_THAT(refused(text.substr(0, text.rfind("         5\n") + 11)),
              HasSubstr("ends too early"));
  std::string wrong = text;
  wrong.replace(wrong.find("  1.25000E+00"), 13, "  one         ");
  EXPECT_THAT(refused(wrong), HasSubstr("no number"));
  EXPECT_THAT(refused(""), HasSubstr("no Universal File"));
}

TEST(ModalResults, LinesBehindBinaryDataHaveNoNumber) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "bad.uff";
  const auto refused = [&](const std::string& text) {
    test::write_text(path, text);
    try {
      read_modal_results(path);
    } catch (const base::InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const std::string mode =
      "    -1\n    55\nNONE\nNONE\nNONE\nNONE\nNONE\n"
      "         1         2         2         8         2         4\n    -1\n";
  const std::string problem = "error: dataset 55: 4 values per node: expected 3 or 6";
  EXPECT_EQ(refused(mode), path + ":8:1: " + problem);
  Record record;
  record.header.channels = {{.name = "x", .unit = "m"}};
  record.header.sample_rate = 10.0;
  record.samples = Samples::Constant(3, 1, 0.1);
  write_record(folder / "binary.uff", record, RecordFormat::uff);
  const std::string binary = test::read_text(folder / "binary.uff");
  EXPECT_EQ(refused(binary + mode), path + ": " + problem);
}

TEST(MatVariables, AreReadByMatio) {
  const test::TemporaryFolder folder;
  std::vector<Eigen::MatrixXcd> pages(3, Eigen::MatrixXcd(2, 4));
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 2; ++i) pages[k](i, j) = Complex(100.0 * k + 10.0 * j + i, -1.5 * k);
  const Eigen::MatrixXd real = Eigen::MatrixXd::Random(5, 2);
  write_mat_variables(folder / "all.mat", {mat_pages("H", pages), mat_array("M", real),
                                           mat_list("names", {"y1", "größe"}),
                                           mat_text("title", "a run"), mat_number("rate", 0.1)});
  const test::MatFile file(Mat_Open((folder / "all.mat").c_str(), MAT_ACC_RDONLY));
  ASSERT_TRUE(file);
  const auto read = [&](const char* name) { return test::Variable(Mat_VarRead(file.get(), name)); };
  const auto H = read("H");
  ASSERT_TRUE(H);
  ASSERT_EQ(H->rank, 3);
  EXPECT_EQ(H->dims[0], 2U);
  EXPECT_EQ(H->dims[1], 4U);
  EXPECT_EQ(H->dims[2], 3U);
  ASSERT_TRUE(H->isComplex);
  const auto* parts = static_cast<const mat_complex_split_t*>(H->data);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 2; ++i) {
        const int at = i + 2 * (j + 4 * k);
        EXPECT_EQ(static_cast<const double*>(parts->Re)[at], pages[k](i, j).real());
        EXPECT_EQ(static_cast<const double*>(parts->Im)[at], pages[k](i, j).imag());
      }
  const auto M = read("M");
  ASSERT_TRUE(M);
  ASSERT_EQ(M->dims[0], 5U);
  EXPECT_EQ(std::memcmp(M->data, real.data(), 10 * sizeof(double)), 0);
  const auto rate = read("rate");
  ASSERT_TRUE(rate);
  EXPECT_EQ(*static_cast<const double*>(rate->data), 0.1);
  const auto names = read("names");
  ASSERT_TRUE(names);
  EXPECT_EQ(names->class_type, MAT_C_CELL);
  EXPECT_EQ(names->dims[1], 2U);
  ASSERT_TRUE(read("title"));
}

TEST(MatVariables, BadNamesAndSizesAreRefused) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(write_mat_variables(folder / "x.mat", {mat_number("1st", 1.0)}),
               std::invalid_argument);
  MatVariable wrong = mat_number("n", 1.0);
  wrong.size = {2, 2};
  EXPECT_THROW(write_mat_variables(folder / "x.mat", {wrong}), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "x.mat"));
}

}  // namespace
}  // namespace hydrapod::data
