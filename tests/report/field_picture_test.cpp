/// Heat maps: contours with labels that can be read, and the bound of a requirement.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <sstream>
#include <vector>

#include "hydrapod/report/model_results.hpp"
#include "report/gnuplot.hpp"
#include "support/picture_script.hpp"

namespace hydrapod::report {
namespace {

using testing::HasSubstr;
using testing::Not;

template <class Value>
Field field(int cells, const Value& value) {
  Field f{.x_name = "x [mm]", .y_name = "z [mm]", .name = "lowest [Hz]"};
  for (int k = 0; k < cells; ++k) {
    f.x.push_back(-100.0 + 200.0 * k / (cells - 1));
    f.y.push_back(-50.0 + 100.0 * k / (cells - 1));
  }
  for (const double x : f.x)
    for (const double y : f.y) f.values.push_back(value(x, y));
  return f;
}

std::string script_for(const Field& f) {
  return test::script_of([&](const auto& path) { plot_field(f, "Machine", "nominal", path); });
}

struct Label {
  double level, x, y;  ///< place [pixels]
};

std::vector<Label> labels_in(const std::string& script) {
  std::vector<Label> labels;
  std::istringstream lines(script);
  for (std::string line; std::getline(lines, line);) {
    Label label{};
    if (line.find("boxed") == std::string::npos) continue;
    if (std::sscanf(line.c_str(), "set label '%lf' at screen %lf,%lf", &label.level, &label.x,
                    &label.y) != 3)
      continue;
    label.x *= 860.0;
    label.y *= 720.0;
    labels.push_back(label);
  }
  return labels;
}

void expect_apart(const std::vector<Label>& labels) {
  for (std::size_t a = 0; a < labels.size(); ++a)
    for (std::size_t b = a + 1; b < labels.size(); ++b)
      EXPECT_TRUE(std::abs(labels[a].x - labels[b].x) > 40.0 ||
                  std::abs(labels[a].y - labels[b].y) > 18.0)
          << labels[a].level << " and " << labels[b].level;
}

// On a grid of 7 × 7 most contours had no label.
TEST(HeatMaps, EachContourHasItsNumberOnACoarseGrid) {
  const auto labels = labels_in(script_for(field(7, [](double x, double) { return 0.04 * x; })));
  std::map<double, int> count;
  for (const auto& label : labels) ++count[label.level];
  EXPECT_EQ(count.size(), 7U) << "−3 … 3 Hz";
  EXPECT_TRUE(count.contains(-3.0) && count.contains(0.0) && count.contains(3.0));
  expect_apart(labels);
}

// Numbers were written over each other where contours are close together.
TEST(HeatMaps, NumbersDoNotTouchWhereContoursDo) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> anywhere(4.0, 8.0);
  const auto labels =
      labels_in(script_for(field(21, [&](double, double) { return anywhere(random); })));
  EXPECT_GE(labels.size(), 7U);
  expect_apart(labels);
}

TEST(HeatMaps, TheNumberStandsOnItsContour) {
  for (const auto& label :
       labels_in(script_for(field(7, [](double x, double) { return 0.04 * x; })))) {
    // the frame goes from 95 to 714 pixels, for x from −116.7 to 116.7 mm
    const double x = -116.667 + (label.x - 95.0) / (714.0 - 95.0) * 233.333;
    EXPECT_NEAR(0.04 * x, label.level, 0.01);
  }
}

TEST(HeatMaps, ShowTheBoundOfARequirement) {
  auto f = field(9, [](double x, double) { return 5.0 + 0.01 * x; });
  EXPECT_THAT(script_for(f), Not(HasSubstr("$bound")));
  f.bound = 5.3;
  f.bound_text = "lowest >= 5.3 Hz";
  const auto script = script_for(f);
  EXPECT_THAT(script, HasSubstr("set cntrparam levels discrete 5.3\nset table $bound\n"));
  EXPECT_THAT(script, HasSubstr("title 'bound of lowest >= 5.3 Hz'"));
  f.bound = 9.0;  // nowhere
  EXPECT_THAT(script_for(f), Not(HasSubstr("$bound")));
}

TEST(HeatMaps, EndOfStrokeIsALineOfItsOwn) {
  auto f = field(9, [](double x, double) { return x > 40.0 ? std::nan("") : 6.0 + 0.01 * x; });
  EXPECT_THAT(script_for(f), Not(HasSubstr("end of stroke")));
  for (const double x : f.x)
    for (std::size_t j = 0; j < f.y.size(); ++j) f.stroke_left.push_back(60.0 - x);
  const auto script = script_for(f);
  EXPECT_THAT(script, HasSubstr("set cntrparam levels discrete 0\nset table $end\nsplot $stroke "));
  EXPECT_THAT(script, HasSubstr("title 'end of stroke'"));
  for (auto& left : f.stroke_left) left += 41.0;  // nowhere at an end
  EXPECT_THAT(script_for(f), Not(HasSubstr("end of stroke")));
}

TEST(HeatMaps, OfOneValueHaveNoContours) {
  const auto script = script_for(field(5, [](double, double) { return 3.0; }));
  EXPECT_THAT(script, Not(HasSubstr("$lines")));
  EXPECT_THAT(script, HasSubstr("with image"));
}

TEST(Titles, LongSubtitlesHaveTwoLinesAndNoLineIsCutByTheEdge) {
  const std::string words(
      "6 inputs, 6 outputs, 255 lines from 0.9766 Hz to 62.99 Hz, h1 with 26.6 independent "
      "averages");
  EXPECT_THAT(titles("T", words, 1300, 600), HasSubstr("'" + words + "'"));
  EXPECT_THAT(titles("T", words, 460, 600), HasSubstr("'.\"\\n\".'"));
  std::string longer;
  for (int k = 0; k < 9; ++k) longer += words + "; ";
  EXPECT_THAT(titles("T", longer, 460, 600), HasSubstr("…'"));
  EXPECT_THAT(titles(longer, "", 460, 600), HasSubstr("…'"));
  EXPECT_THAT(titles("T", "ä", 460, 600), HasSubstr("'ä'"));
}

/// Cells end in the middle between neighbours. They stood side by side as if all were equal, beside
/// contours that were in their places.
TEST(HeatMaps, CellsOfUnevenListsAreWhereTheyBelong) {
  const Field even = field(4, [](double x, double y) { return x + 0.3 * y; });
  EXPECT_THAT(script_for(even), HasSubstr("with image pixels"));
  Field f{.x_name = "x [mm]", .y_name = "z [mm]", .x = {-3.0, 1.0, 2.0}, .y = {10.0, 30.0, 90.0}};
  f.name = "lowest [Hz]";
  f.values = {5.0, 5.5, 6.0, 6.5, std::nan(""), 7.5, 8.0, 8.5, 9.25};
  const auto script = script_for(f);
  EXPECT_THAT(script, Not(HasSubstr("with image")));
  EXPECT_THAT(script, HasSubstr("with boxxyerror"));
  EXPECT_THAT(script, HasSubstr("set xrange [-5:2.5]\nset yrange [0:120]\n"));
  EXPECT_THAT(script, HasSubstr("\n-3 10 -5 -1 0 20 5\n-3 30 -5 -1 20 60 5.5\n"
                                "-3 90 -5 -1 60 120 6\n1 10 -1 1.5 0 20 6.5\n"
                                "1 90 -1 1.5 60 120 7.5\n2 10 1.5 2.5 0 20 8\n"));
  Field turned = f;  // the same in another order
  turned.x = {2.0, -3.0, 1.0};
  turned.y = {90.0, 10.0, 30.0};
  turned.values = {9.25, 8.0, 8.5, 6.0, 5.0, 5.5, 7.5, 6.5, std::nan("")};
  const auto of_data = [](const std::string& text) { return text.substr(text.find("$field")); };
  EXPECT_EQ(of_data(script_for(turned)), of_data(script));  // files before it have other names
}

}  // namespace
}  // namespace hydrapod::report
