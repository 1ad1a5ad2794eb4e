#include "hydrapod/study_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <numbers>
#include <span>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::cli {

namespace {

/// The unit behind the numbers of a range, "2:20:10 kN/mm", else that of the machine file.
model::WrittenUnit unit_of_range(const std::string& range, const std::string& path,
                                 const std::string& machine_text, const std::string& si) {
  for (std::size_t k = 1; k + 1 < range.size(); ++k) {
    if (range[k] != ' ' || std::isdigit(static_cast<unsigned char>(range[k - 1])) == 0) continue;
    const std::string unit(base::trimmed(range.substr(k)));
    if (unit.empty() || std::isdigit(static_cast<unsigned char>(unit[0])) != 0) continue;
    if (const auto one = base::read_quantity("1 " + unit, si); one.ok()) return {unit, one.value};
  }
  const auto in_file = model::written_unit(machine_text, path, si);
  return in_file.name.empty() ? model::WrittenUnit{si, 1.0} : in_file;
}

/// "worst over rx, ry; ", of a map that is one.
std::string worst_over_text(const tasks::StudyJob& job) {
  if (!job.problem.beneath) return {};
  std::vector<std::string_view> names;
  for (const auto& input :
       std::span(job.problem.beneath->inputs).subspan(job.problem.inputs.size()))
    names.push_back(input.name);
  return fmt::format("worst over {}; ", fmt::join(names, ", "));
}

}  // namespace

void plot_map(const tasks::StudyJob& job, const std::vector<std::string>& ranges,
              const std::string& value, const StudyRows& rows, const std::string& path) {
  const auto found = std::ranges::find(job.problem.outputs, value, &study::Column::name);
  const auto axis = [&](std::size_t k, std::vector<double>& along) {
    const auto& input = job.problem.inputs[k];
    auto unit =
        unit_of_range(ranges.at(k), job.poses ? "" : input.name, job.machine.file.text, input.unit);
    if (job.poses)
      unit = input.unit == "rad" ? model::WrittenUnit{"°", std::numbers::pi / 180.0}
                                 : model::WrittenUnit{"mm", 1e-3};
    for (const double one : input.distribution.list) along.push_back(one / unit.size);
    return fmt::format("{} [{}]", input.name, unit.name);
  };
  const std::string kind =
      found->unit == "Hz" ? ", " + study::frequency_kind(job.machine.file.machine) : "";
  report::Field field{.name = found->name + kind,
                      .unit = found->unit,
                      .values = rows.values(),
                      .stroke_left = rows.stroke_left()};
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  field.values.resize(job.rows, unknown);
  if (!field.stroke_left.empty()) field.stroke_left.resize(job.rows, unknown);
  field.x_name = axis(0, field.x);
  field.y_name = axis(1, field.y);
  const auto output = static_cast<int>(found - job.problem.outputs.begin());
  if (const auto wanted = std::ranges::find(job.requirements, output, &study::Requirement::output);
      wanted != job.requirements.end()) {
    field.bound = wanted->bound;
    field.bound_text = wanted->text;
  }
  report::plot_field(
      field, fmt::format("{}: {}", job.machine.file.machine.name, found->meaning),
      fmt::format("pose {}, {} model; machine: {}; {}grey: no value", job.machine.pose.name,
                  dynamics::name(job.machine.kind), report::mechanics_state_text(job.machine.file),
                  worst_over_text(job)),
      path);
}

}  // namespace hydrapod::cli
