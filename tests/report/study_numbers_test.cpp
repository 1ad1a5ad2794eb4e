/// Every number of the JSON of studies is the number of its field: all fields have different
/// values.

#include <gtest/gtest.h>

#include <memory>

#include "hydrapod/report/model_results.hpp"
#include "support/json_numbers.hpp"

namespace hydrapod::test {
namespace {

using report::Json;

study::OutputSummary output_with(double first, std::uint64_t row) {
  return {.count = row + 1000,
          .mean = first + 0.1,
          .deviation = first + 0.2,
          .least = first + 0.3,
          .most = first + 0.4,
          .least_row = row,
          .most_row = row + 1,
          .mean_interval = study::Interval{first + 0.5, first + 0.6},
          .quantiles = {{.probability = 0.05,
                         .value = first + 0.7,
                         .interval = study::Interval{first + 0.8, first + 0.9}},
                        {.probability = 0.5, .value = first + 0.75}}};
}

Json output_expected(double first, std::uint64_t row) {
  return {
      {"count", row + 1000},
      {"mean", first + 0.1},
      {"standard_deviation", first + 0.2},
      {"least", first + 0.3},
      {"most", first + 0.4},
      {"least_row", row},
      {"most_row", row + 1},
      {"mean_interval", {first + 0.5, first + 0.6}},
      {"quantiles",
       {{{"probability", 0.05}, {"value", first + 0.7}, {"interval", {first + 0.8, first + 0.9}}},
        {{"probability", 0.5}, {"value", first + 0.75}, {"interval", nullptr}}}}};
}

TEST(JsonNumbers, OfStudiesAreThoseOfTheirFields) {
  study::Problem problem;
  problem.inputs = {{.name = "platform.mass", .unit = "kg"},
                    {.name = "legs.rod.mass", .unit = "kg"}};
  problem.outputs = {{"status", "1", ""}, {"lowest", "Hz", ""}, {"drop", "1", ""}};
  problem.status = 0;
  auto beneath = std::make_shared<study::Problem>(problem);
  beneath->inputs.push_back(
      {.name = "rx",
       .unit = "rad",
       .distribution = {.shape = study::Shape::values, .list = {0.21, 0.22}}});
  problem.beneath = beneath;
  study::Plan plan;
  plan.samples = 61;
  plan.seed = 17;
  plan.indices = true;
  study::Summary summary{.rows = 239, .statuses = {71, 72, 73, 74, 75}};
  summary.outputs = {{}, output_with(11.0, 41), output_with(13.0, 51)};
  summary.outputs[2].between = study::WorstBetween{.value = 0.31, .inputs = {0.32, 0.33}};
  auto with_between = output_expected(13.0, 51);
  with_between["worst_between"] = {{"value", 0.31}, {"inputs", {0.32, 0.33}}};
  summary.requirements = {{.count = 81,
                           .missed = 82,
                           .probability = 0.83,
                           .interval = study::Interval{0.84, 0.85},
                           .worst = 86},
                          {.count = 91, .missed = 92, .probability = 0.93}};
  study::Indices indices{.used = 57};
  for (const double first : {0.1, 0.2}) {
    indices.first.push_back({.value = first + 0.01, .interval = {first + 0.02, first + 0.03}});
    indices.total.push_back({.value = first + 0.04, .interval = {first + 0.05, first + 0.06}});
  }
  summary.indices = {{}, indices, {}};
  summary.reached = study::ReachedPart{.least = 0.61, .most = 0.62, .whole = 0.63, .unit = "m^2"};
  const auto index = [](double first) {
    return Json{{"value", first}, {"interval", {first + 0.01, first + 0.02}}};
  };
  const auto input = [&](double first) {
    return Json{{"first_order", index(first + 0.01)}, {"total_order", index(first + 0.04)}};
  };
  expect_numbers(report::study_json(problem, plan,
                                    {{.text = "lowest >= 6 Hz"}, {.text = "drop <= 2 %"}}, summary),
                 {{"rows", 239},
                  {"rows_planned", 61 * 4},
                  {"complete", false},
                  {"samples", 61},
                  {"seed", 17},
                  {"worst_over", {{{"values", {0.21, 0.22}}}}},
                  {"reached", {{"least", 0.61}, {"most", 0.62}, {"whole", 0.63}}},
                  {"statuses",
                   {{"computed", 71},
                    {"not_allowed", 72},
                    {"out_of_reach", 73},
                    {"no_equilibrium", 74},
                    {"buckled", 75}}},
                  {"outputs", {output_expected(11.0, 41), with_between}},
                  {"requirements",
                   {{{"samples", 81},
                     {"missed", 82},
                     {"probability_of_missing", 0.83},
                     {"interval", {0.84, 0.85}},
                     {"worst_row", 86}},
                    {{"samples", 91},
                     {"missed", 92},
                     {"probability_of_missing", 0.93},
                     {"interval", nullptr},
                     {"worst_row", nullptr}}}},
                  {"indices", {{{"samples_used", 57}, {"inputs", {input(0.1), input(0.2)}}}}}});
}

}  // namespace
}  // namespace hydrapod::test
