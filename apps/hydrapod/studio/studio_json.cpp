#include "hydrapod/studio/studio_json.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "hydrapod/base/error.hpp"

namespace hydrapod::studio {

namespace {
using report::Json;
constexpr std::size_t most_values = 5000;
constexpr std::size_t longest_name = 100;
}  // namespace

Json job_json(const Job& job) {
  constexpr std::array states{"waiting", "running", "done", "failed", "cancelled"};
  Json json{{"id", job.id},
            {"kind", job.plan.kind},
            {"title", job.plan.title},
            {"state", states.at(static_cast<std::size_t>(job.state))},
            {"fraction", job.fraction},
            {"seconds", job.seconds},
            {"section", job.plan.section},
            {"output", job.plan.output},
            {"has_result", job.plan.section.empty() && !job.result.is_null()},
            {"messages", job.messages}};
  json["seconds_left"] = job.seconds_left ? Json(*job.seconds_left) : Json();
  return json;
}

Json whole_job_json(const Job& job) {
  auto json = job_json(job);
  json["arguments"] = job.plan.arguments;
  json["result"] = job.result;
  json["picture"] = job.drawn;
  return json;
}

Json edits_json(const std::vector<PlannedEdit>& edits) {
  Json json = Json::array();
  for (const auto& edit : edits) json.push_back({{"path", edit.path}, {"value", edit.value}});
  return json;
}

ValueChange values_in(const Json& asked) {
  const auto& values = asked.at("values");
  const auto& assignments = asked.at("assignments");
  if (!values.is_array() || !assignments.is_array() || values.size() > most_values ||
      assignments.size() > most_values)
    base::refuse("values", fmt::format("expected lists of at most {} values", most_values));
  for (const auto& one : values)
    if (!one.is_array() || one.size() != 2 || !one[0].is_string() || !one[1].is_number() ||
        !std::isfinite(one[1].get<double>()))
      base::refuse("values", "expected pairs of a path and a number");
  ValueChange change;
  change.values = values;
  change.from = asked.value("from", std::string());
  if (change.from.size() > longest_name) base::refuse("from", "is too long");
  for (const auto& one : assignments) change.assignments.push_back(one.get<std::string>());
  return change;
}

std::uint64_t number_in(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  return status == std::errc() && end == text.data() + text.size() ? number : 0;
}

std::string decoded(std::string_view text) {
  std::string result;
  for (std::size_t k = 0; k < text.size(); ++k) {
    unsigned value = 0;
    if (text[k] == '%' && k + 2 < text.size() &&
        std::from_chars(text.data() + k + 1, text.data() + k + 3, value, 16).ptr ==
            text.data() + k + 3) {
      result += static_cast<char>(value);
      k += 2;
    } else {
      result += text[k];
    }
  }
  return result;
}

}  // namespace hydrapod::studio
