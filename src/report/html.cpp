#include "hydrapod/report/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "editable_machine.hpp"
#include "hydrapod/base/error.hpp"
#include "page.hpp"
#include "pose_report.hpp"

namespace hydrapod::report {

namespace {

/// What the page holds where something is to be put in; each stands in it once.
constexpr std::string_view policy_mark = "{{hydrapod-policy}}";
constexpr std::string_view title_mark = "{{hydrapod-title}}";
constexpr std::string_view theme_mark = "{{hydrapod-theme}}";
constexpr std::string_view summary_mark = "{{hydrapod-summary}}";
constexpr std::string_view data_mark = "{{hydrapod-data}}";

constexpr std::array theme_names{"auto", "light", "dark"};

/// `page` up to `mark`, which it loses together with what stands before it.
std::string_view cut(std::string_view& page, std::string_view mark) {
  const size_t at = page.find(mark);
  if (at == std::string_view::npos)
    throw std::logic_error(fmt::format("the built-in page has no {}", mark));
  const std::string_view before = page.substr(0, at);
  page.remove_prefix(at + mark.size());
  return before;
}

/// Throws std::invalid_argument for modes that the model does not have.
Json shown_pose(const model::Machine& machine, const model::NamedPose& pose,
                const HtmlOptions& options) {
  const auto table = modal::mode_table(machine, pose.X_BP, options.kind);
  const int count = static_cast<int>(table.real.modes.size());
  for (const int mode : options.modes)
    if (mode < 1 || mode > count)
      throw std::invalid_argument(
          fmt::format("modes: there is no mode {}; the model has 1 to {}", mode, count));
  return pose_report(machine, pose, table, options.points);
}

using Replacement = std::pair<std::string_view, std::string_view>;

/// `text` with what stands first in `replacements` replaced by what stands second.
std::string replaced(std::string_view text, std::initializer_list<Replacement> replacements) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const auto* found = std::ranges::find_if(
        replacements, [&](const Replacement& one) { return text.starts_with(one.first); });
    const bool kept = found == replacements.end();
    result += kept ? text.substr(0, 1) : found->second;
    text.remove_prefix(kept ? 1 : found->first.size());
  }
  return result;
}

/// What a reader without JavaScript gets.
std::string plain_summary(const Json& document) {
  std::string text;
  for (const auto& pose : document.value("poses", Json::array()))
    if (const auto& answer = pose.at("answer"); answer.is_object())
      text += fmt::format("<p>{}: {}</p>", escape_html(pose.at("pose").value("name", "")),
                          escape_html(answer.value("text", "")));
  return text;
}

}  // namespace

std::string escape_html(std::string_view text) {
  return replaced(text,
                  {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"'", "&#39;"}});
}

std::string escape_json(const Json& json) {
  return replaced(json.dump(-1, ' ', false, Json::error_handler_t::replace),
                  {{"<", "\\u003c"},
                   {">", "\\u003e"},
                   {"&", "\\u0026"},
                   {"\xE2\x80\xA8", "\\u2028"},
                   {"\xE2\x80\xA9", "\\u2029"}});
}

Json report_json(const model::MachineFile& file, const std::string& path,
                 const std::vector<model::NamedPose>& poses, const HtmlOptions& options) {
  if (poses.empty()) throw std::invalid_argument("poses: a report needs at least one");
  if (options.points < 2)
    throw std::invalid_argument(fmt::format("points = {}: at least 2", options.points));
  const auto& name = file.machine.name;
  Json document{{"kind", "report"},
                {"title", !options.title.empty() ? options.title
                          : name.empty()         ? path
                                                 : name},
                {"machine", machine_json(file, path)},
                {"assumptions", assumptions_json(file.machine)},
                {"pictured_modes", options.modes},
                {"poses", Json::array()}};
  document["machine"]["text"] = file.text;
  document["machine"]["warnings"] = Json::array();
  for (const auto& warning : file.warnings)
    document["machine"]["warnings"].push_back(warning.text());
  for (const auto& pose : poses)
    document["poses"].push_back(shown_pose(file.machine, pose, options));
  document["editable"] = editable_json(file, poses, options.kind);
  return document;
}

std::string html_page(const Json& document, Theme theme) {
  std::string_view page = page_template();
  if (page.empty())
    throw base::ComputationError(
        fmt::format("this program was built without the report's page: {}", why_no_page()));
  std::string html;
  const auto put = [&](std::string_view mark, std::string_view text) {
    html += cut(page, mark);
    html += text;
  };
  put(theme_mark, theme_names.at(static_cast<std::size_t>(theme)));
  // a page of the studio asks the server that it came from, and nobody else
  put(policy_mark, document.contains("studio") ? "; connect-src 'self'" : "");
  put(title_mark, escape_html(document.value("title", "hydrapod")));
  put(summary_mark, plain_summary(document));
  put(data_mark, escape_json(document));
  html += page;
  return html;
}

std::string html_report(const model::MachineFile& file, const std::string& path,
                        const std::vector<model::NamedPose>& poses, const HtmlOptions& options) {
  return html_page(report_json(file, path, poses, options), options.theme);
}

}  // namespace hydrapod::report
