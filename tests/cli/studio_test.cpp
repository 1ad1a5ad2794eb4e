/// What the studio is made of on the command line: the page's numbers as JSON, progress as lines,
/// and what it refuses. Its page and attacks on it are in tests/web.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {
using test::run_hydrapod;
using testing::HasSubstr;

std::string machine_of_studio() {
  return test::source_file("models/zhang-jiang-2021.toml").string();
}

TEST(Studio, TheNumbersOfThePageAreThoseOfReportAsJson) {
  const test::TemporaryFolder folder;
  const test::RunOptions options{.folder = folder.path(),
                                 .variables = {{"SOURCE_DATE_EPOCH", "1700000001"}}};
  const auto printed =
      run_hydrapod({"report", machine_of_studio(), "--format", "json", "-o", "-"}, options);
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  ASSERT_EQ(run_hydrapod({"report", machine_of_studio(), "-o", "r.html"}, options).exit_code, 0);
  std::ifstream file(folder.path() / "r.html");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const auto from = page.find(begin) + begin.size();
  auto in_page = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  auto alone = nlohmann::json::parse(printed.out);
  for (auto* one : {&in_page, &alone}) one->erase("reproduction");  // names its command
  EXPECT_EQ(alone, in_page);
  EXPECT_THAT(page, testing::Not(HasSubstr("connect-src")));
  EXPECT_THAT(
      run_hydrapod({"report", machine_of_studio(), "--format", "json", "-o", "r.html"}, options)
          .err,
      HasSubstr("report --format json writes json"));
  EXPECT_THAT(run_hydrapod({"report", machine_of_studio(), "--format", "pdf"}, options).err,
              HasSubstr("accepted are html, json"));
}

TEST(Studio, ProgressComesAsLinesWhereItIsAskedFor) {
  const test::TemporaryFolder folder;
  const auto run = [&](const char* asked) {
    return run_hydrapod(
               {"rig", machine_of_studio(), "--duration", "20 s", "-o", "run.h5", "--force"},
               {.folder = folder.path(), .variables = {{"HYDRAPOD_PROGRESS", asked}}})
        .err;
  };
  double last = -1.0;
  int lines = 0;
  std::istringstream text(run("1"));
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with("progress ")) continue;
    const double share = std::stod(line.substr(9));
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1.0);
    last = share;
    ++lines;
  }
  EXPECT_GE(lines, 2);
  EXPECT_THAT(run(""), testing::Not(HasSubstr("progress ")));
}

TEST(Studio, RefusesWhatItCannotServe) {
  const test::TemporaryFolder folder;
  const auto refused = [&](std::vector<std::string> words, const char* message) {
    words.insert(words.begin(), "studio");
    words.emplace_back("--no-browser");
    const auto run = run_hydrapod(words, {.folder = folder.path()});
    EXPECT_EQ(run.exit_code, 2) << run.out;
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err, HasSubstr(message));
  };
  refused({"nowhere.toml"}, "nowhere.toml: error: cannot be opened");
  refused({"-"}, "the studio edits a file; give the path of one");
  refused({machine_of_studio(), "--set", "platform.mass=-1"},
          "--set platform.mass=-1: error: platform.mass");
  refused({machine_of_studio(), "--pose", "nowhere"}, "nowhere");
  refused({machine_of_studio(), "--bind", "0.0.0.0"}, "--bind: error: needs --key FILE");
  refused({machine_of_studio(), "--key", "key"}, "--key: error: needs --bind ADDRESS");
  refused({machine_of_studio(), "--port", "70000"}, "not in range 0 to 65535");
}

}  // namespace
}  // namespace hydrapod
