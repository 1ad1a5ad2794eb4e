/// The report's file: what goes into it, and that nothing in a machine file can become markup.

#include "hydrapod/report/json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "hydrapod/kinematics/legs.hpp"
#include "support/run_program.hpp"

namespace hydrapod::report {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* nasty =
    "</script><img src=x onerror=\"a('b')\"> & \xE2\x80\xA8 {{hydrapod-data}}";

model::MachineFile published(const std::vector<std::string>& overrides = {}) {
  return model::read_machine_file(test::source_file("models/zhang-jiang-2021.toml").string(),
                                  overrides, kinematics::check_machine);
}

std::vector<model::NamedPose> neutral(const model::MachineFile& file) {
  return {{"neutral", file.machine.neutral()}};
}

TEST(EscapeHtml, LeavesNoMarkup) {
  EXPECT_EQ(escape_html("<a href=\"x\">'&amp;'</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;amp;&#39;&lt;/a&gt;");
}

TEST(EscapeJson, HoldsNothingThatEndsAScriptAndReadsBackTheSame) {
  const Json json{{"name", nasty}, {nasty, 1.5}};
  const std::string text = escape_json(json);
  for (const char* part : {"<", ">", "&", "\xE2\x80\xA8", "\xE2\x80\xA9"})
    EXPECT_THAT(text, Not(HasSubstr(part)));
  EXPECT_EQ(Json::parse(text), json);
}

TEST(EscapeJson, ReplacesBrokenUtf8) { EXPECT_EQ(escape_json(Json("a\xFF")), "\"a\xEF\xBF\xBD\""); }

TEST(EscapeJson, KeepsEveryDigit) {
  const double value = 0.1 + 0.2;
  EXPECT_EQ(Json::parse(escape_json(Json(value))).get<double>(), value);
}

TEST(HtmlPage, HoldsTheDocumentOnceAndNoPlaceholder) {
  const std::string html = html_page({{"title", nasty}, {"poses", Json::array()}}, Theme::dark);
  EXPECT_THAT(html, HasSubstr("data-theme=\"dark\""));
  EXPECT_THAT(html, HasSubstr("<title>" + escape_html(nasty) + "</title>"));
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  EXPECT_THAT(html, Not(HasSubstr("{{hydrapod-theme}}")));
  EXPECT_THAT(html, Not(HasSubstr("<img")));
}

TEST(HtmlPage, AsksNobodyButTheStudioThatServesIt) {
  const Json document{{"title", "m"}, {"poses", Json::array()}};
  EXPECT_THAT(html_page(document), Not(HasSubstr("connect-src")));
  Json served = document;
  served["studio"] = {{"page", 1}};
  EXPECT_THAT(html_page(served), HasSubstr("form-action 'none'; connect-src 'self'\">"));
}

TEST(HtmlReport, NeedsNoNetwork) {
  const auto file = published();
  const std::string html = html_report(file, "m.toml", neutral(file));
  for (const char* part :
       {"<script src", "<link rel=\"stylesheet\"", "@import", "url(http", "<iframe"})
    EXPECT_THAT(html, Not(HasSubstr(part))) << part;
}

TEST(HtmlReport, StaysBelowTwoMegabytesWithThirtyComplexModesAndFourPoses) {
  const auto file = published({"legs.piston_ring.stiffness=2e6", "legs.guide_sleeve.damping=60",
                               "legs.oil_spring.damping=4000", "damping.modal_ratio=0.003"});
  std::vector<model::NamedPose> poses;
  for (const double x : {0.0, 0.01, 0.02, 0.03}) {
    auto pose = file.machine.neutral();
    pose.p_BP.x() += x;
    poses.push_back({"pose", pose});
  }
  const auto html = html_report(file, "m.toml", poses, {.kind = dynamics::ModelKind::full});
  EXPECT_LE(html.size(), 2'000'000U);
  EXPECT_THAT(html, HasSubstr("shape_imaginary"));
}

TEST(ReportJson, HoldsEveryNumberOfTheMachineForThePagesCore) {
  const auto file = model::read_machine_file(
      test::source_file("models/heavy-platform.toml").string(),
      {"leg.4.rod.mass=17.3", "legs.piston_ring.stiffness=1.9e7"}, kinematics::check_machine);
  const auto editable = report_json(file, "m.toml", neutral(file)).at("editable");
  EXPECT_EQ(editable.at("numbers").at("legs.rod.mass"),
            Json::parse("[[23.0],[23.0],[23.0],[17.3],[23.0],[23.0]]"));
  EXPECT_EQ(editable.at("own").at("legs.rod.mass"), 0b110111);
  EXPECT_EQ(editable.at("numbers").at("legs.piston_ring.stiffness").at(5).at(0), 1.9e7);
  EXPECT_FALSE(editable.at("numbers").contains("base.mount.mass"));
  EXPECT_EQ(editable.at("units").at("platform.mass"), Json::parse(R"({"name":"t","size":1000.0})"));
  EXPECT_EQ(editable.at("scales").at("N/m").at("kN/mm"), 1e6);
  EXPECT_FALSE(editable.at("scales").at("N/m").contains("mm"));
  EXPECT_EQ(editable.at("shown").at(0).at("of"), 0);
}

TEST(ReportJson, RefusesWhatMakesNoSense) {
  const auto file = published();
  EXPECT_THROW(report_json(file, "m.toml", {}), std::invalid_argument);
  EXPECT_THROW(report_json(file, "m.toml", neutral(file), {.modes = {19}}), std::invalid_argument);
  EXPECT_THROW(report_json(file, "m.toml", neutral(file), {.points = 1}), std::invalid_argument);
}

TEST(ReportJson, TitleIsTheMachinesNameUnlessGiven) {
  const auto file = published();
  EXPECT_EQ(report_json(file, "m.toml", neutral(file)).at("title"), "Zhang & Jiang 2021");
  EXPECT_EQ(report_json(file, "m.toml", neutral(file), {.title = "T"}).at("title"), "T");
}

void add_names(const Json& json, std::set<std::string>& names) {
  if (json.is_array()) {
    for (const auto& item : json) add_names(item, names);
  } else if (json.is_object()) {
    for (const auto& [name, value] : json.items()) {
      names.insert(name);
      add_names(value, names);
    }
  }
}

TEST(ReportJson, EveryFieldIsInTheManual) {
  const auto file =
      model::read_machine_file(test::source_file("models/heavy-platform.toml").string(),
                               {"legs.piston_ring.stiffness=1e9"}, kinematics::check_machine);
  std::set<std::string> names;
  auto document = report_json(file, "m.toml", neutral(file), {.kind = dynamics::ModelKind::full});
  for (const char* by_path : {"numbers", "words", "own", "units", "scales"})
    document.at("editable").at(by_path) = nullptr;  // paths and units, no fields
  add_names(document, names);
  EXPECT_GT(names.size(), 70U);
  const std::string manual = test::read_text(test::source_file("docs/howto/json.md"));
  for (const std::string& name : names) {
    const bool named = manual.find('`' + name + '`') != std::string::npos ||
                       manual.find('`' + name + "[]`") != std::string::npos ||
                       manual.find("machine." + name) != std::string::npos;
    EXPECT_TRUE(named) << name;
  }
}

}  // namespace
}  // namespace hydrapod::report
