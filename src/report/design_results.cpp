#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gnuplot.hpp"
#include "hydrapod/report/model_results.hpp"
#include "prefix.hpp"

namespace hydrapod::report {

namespace {

constexpr std::array<const char*, 6> line_colours{"#0072b2", "#d55e00", "#009e73",
                                                  "#cc79a7", "#e69f00", "#56b4e9"};

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json limit_json(const study::DesignProblem& problem, const study::Limit& limit) {
  constexpr std::array kinds{"requirement", "lower_bound", "upper_bound", "jump"};
  Json json{{"kind", kinds.at(static_cast<std::size_t>(limit.kind))}};
  json["requirement"] =
      limit.requirement < 0
          ? Json(nullptr)
          : Json(problem.requirements[static_cast<std::size_t>(limit.requirement)].text);
  json["path"] = limit.change < 0
                     ? Json(nullptr)
                     : Json(problem.changes[static_cast<std::size_t>(limit.change)].name);
  json["pose"] = limit.pose < 0 ? Json(nullptr)
                                : Json(problem.poses[static_cast<std::size_t>(limit.pose)].name);
  json["price"] = limit.price ? number_or_null(*limit.price) : Json(nullptr);
  if (limit.kind == study::Limit::Kind::jump) json["beyond"] = number_or_null(limit.beyond);
  return json;
}

/// `values` [SI] in a unit; where no unit was written and the numbers are large, in the SI unit
/// with a prefix.
model::WrittenUnit readable(const model::WrittenUnit& unit, double largest) {
  constexpr double few = 1e4;  // as much as ticks hold without running into each other
  const bool takes_prefix = unit.name == "N/m" || unit.name == "Pa" || unit.name == "N m/rad" ||
                            unit.name == "N s/m" || unit.name == "N";
  if (!takes_prefix || largest / unit.size < few) return unit;
  const auto prefix = prefix_of(largest / unit.size);
  return {prefix.name + unit.name, unit.size * prefix.size};
}

Json requirements_json(const study::DesignProblem& problem, const study::DesignResult& result) {
  Json all = Json::array();
  for (std::size_t k = 0; k < problem.requirements.size(); ++k) {
    const auto& wanted = problem.requirements[k];
    const double value = result.best.worst[k];
    Json one{{"requirement", wanted.text},
             {"unit", problem.outputs[static_cast<std::size_t>(wanted.output)].unit},
             {"meaning", problem.outputs[static_cast<std::size_t>(wanted.output)].meaning},
             {"bound", wanted.bound},
             {"present", number_or_null(result.present.worst[k])},
             {"value", number_or_null(value)},
             {"pose", problem.poses[static_cast<std::size_t>(result.best.pose[k])].name},
             {"met", wanted.at_least ? value >= wanted.bound : value <= wanted.bound}};
    if (!result.reach.empty())
      one["reach"] = {{"value", number_or_null(result.reach[k].value)},
                      {"enough", result.reach[k].enough},
                      {"values", result.reach[k].values}};
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

Json design_json(const study::DesignProblem& problem, const study::DesignResult& result) {
  Json json{{"feasible", result.best.feasible},
            {"interrupted", result.interrupted},
            {"evaluations", result.evaluations},
            {"samples", result.samples},
            {"feasible_samples", result.feasible_samples}};
  constexpr std::array statuses{"computed", "not_allowed", "out_of_reach", "no_equilibrium",
                                "buckled"};
  for (std::size_t k = 0; k < statuses.size(); ++k)
    json["statuses"][statuses[k]] = result.statuses[k];
  json["poses"] = Json::array();
  for (const auto& pose : problem.poses) json["poses"].push_back(pose_json(pose));
  json["changes"] = Json::array();
  for (std::size_t k = 0; k < problem.changes.size(); ++k) {
    const auto& change = problem.changes[k];
    json["changes"].push_back({{"path", change.name},
                               {"unit", change.unit},
                               {"from", change.distribution.a},
                               {"to", change.distribution.b},
                               {"present", result.present.values[k]},
                               {"value", result.best.values[k]}});
  }
  json["aims"] = Json::array();
  for (std::size_t k = 0; k < problem.aims.size(); ++k) {
    const auto& aim = problem.aims[k];
    Json one{{"aim", aim.text}, {"unit", aim.unit}};
    if (aim.output >= 0)
      one["meaning"] = problem.outputs[static_cast<std::size_t>(aim.output)].meaning;
    one["present"] = number_or_null(result.present.aims[k]);
    one["value"] = number_or_null(result.best.aims[k]);
    json["aims"].push_back(std::move(one));
  }
  json["requirements"] = requirements_json(problem, result);
  json["limits"] = Json::array();
  for (const auto& limit : result.limits) json["limits"].push_back(limit_json(problem, limit));
  json["front"] = Json::array();
  for (const auto& point : result.front)
    json["front"].push_back({{"aims", point.aims}, {"values", point.values}});
  return json;
}

void plot_trade_off(const study::DesignProblem& problem, const study::DesignResult& result,
                    const DesignUnits& units, const std::string& title, const std::string& subtitle,
                    const std::string& path) {
  constexpr int width = 860, height = 620;
  std::array<model::WrittenUnit, 2> unit;
  for (std::size_t k = 0; k < unit.size(); ++k) {
    double largest = 0.0;
    for (const auto& point : result.front) largest = std::max(largest, std::abs(point.aims[k]));
    unit.at(k) = readable(units.aims[k], largest);
  }
  const auto row = [&](const std::vector<double>& aims) {
    return fmt::format("{:.9g} {:.9g}\n", aims[0] / unit[0].size, aims[1] / unit[1].size);
  };
  std::string front;
  for (const auto& point : result.front) front += row(point.aims);
  const auto axis = [&](std::size_t k) {
    return quoted(fmt::format("{} [{}]", problem.aims[k].name, unit.at(k).name));
  };
  std::string script =
      titles(title, subtitle, width, height) + thin_axes + thin_grid + block_of("front", front) +
      block_of("best", row(result.best.aims)) +
      at_screen({0.13, 0.97, 1.0 - 96.0 / height, 60.0 / height}) + key_below_titles(height) +
      fmt::format("set xlabel {}\nset ylabel {}\n", axis(0), axis(1)) +
      "plot $front using 1:2 with linespoints lw 2 pt 7 ps 0.8 lc rgb '#0072b2' title 'trade-off', "
      "$best using 1:2 with points pt 6 ps 2.2 lw 2 lc rgb "
      "'#d55e00' title 'nearest to both ends'";
  if (result.present.feasible) {
    script = block_of("present", row(result.present.aims)) + script +
             ", $present using 1:2 with points pt 2 ps 1.6 lw 2 lc rgb '#444444' title 'present "
             "machine'";
  }
  draw(path, width, height, script + "\n");
}

namespace {

/// What is to spare of a requirement [% of its bound], per point.
std::vector<double> spare_of(const study::Requirement& wanted, const std::vector<double>& worst) {
  const double size = wanted.bound != 0.0 ? std::abs(wanted.bound) : 1.0;
  std::vector<double> spare;
  for (const double value : worst)
    spare.push_back((wanted.at_least ? 1.0 : -1.0) * (value - wanted.bound) / size * 100.0);
  return spare;
}

/// Of the axes of all slices: ±60 %, and all of a requirement that is farther away everywhere.
std::pair<double, double> spare_shown(const study::DesignProblem& problem,
                                      const std::vector<study::Slice>& slices) {
  constexpr double usual = 60.0, room = 1.05;
  double low = -usual, high = usual;
  for (std::size_t r = 0; r < problem.requirements.size(); ++r) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const auto& slice : slices)
      for (const double spare : spare_of(problem.requirements[r], slice.worst[r]))
        if (std::isfinite(spare)) {
          least = std::min(least, spare);
          most = std::max(most, spare);
        }
    if (least > most) continue;  // no value anywhere
    if (least > usual) high = std::max(high, room * most);
    if (most < -usual) low = std::min(low, room * least);
  }
  return {low, high};
}

/// Columns: the changed number in `unit`, and of each requirement what is to spare.
std::string slice_rows(const study::DesignProblem& problem, const study::Slice& slice,
                       const model::WrittenUnit& unit) {
  std::vector<std::vector<double>> spare;
  for (std::size_t r = 0; r < slice.worst.size(); ++r)
    spare.push_back(spare_of(problem.requirements[r], slice.worst[r]));
  std::string rows;
  for (std::size_t i = 0; i < slice.values.size(); ++i) {
    rows += fmt::format("{:.9g}", slice.values[i] / unit.size);
    for (const auto& one : spare)
      rows += std::isfinite(one[i]) ? fmt::format(" {:.9g}", one[i]) : " NaN";
    rows += '\n';
  }
  return rows;
}

/// Axis of a changed number, logarithmic over a decade and more.
std::string slice_axis(const study::Input& change, const study::Slice& slice,
                       const model::WrittenUnit& unit) {
  constexpr double decade = 10.0;
  const auto& range = change.distribution;
  const double from = slice.values.front() / unit.size, to = slice.values.back() / unit.size;
  const bool ratios = range.a > 0.0 && range.b >= decade * range.a;
  return (ratios ? logarithmic_axis(from, to)
                 : fmt::format("unset logscale x\nset xrange [{:.9g}:{:.9g}]\n"
                               "set xtics autofreq\n",
                               from, to)) +
         fmt::format("set xlabel {}\n", quoted(fmt::format("{} [{}]", change.name, unit.name)));
}

}  // namespace

void plot_design_slices(const study::DesignProblem& problem, const study::DesignResult& result,
                        const DesignUnits& units, const std::vector<study::Slice>& slices,
                        const std::string& title, const std::string& subtitle,
                        const std::string& path) {
  const auto [low, high] = spare_shown(problem, slices);
  const CellGrid grid(slices.size());
  const double last_label = 12.0 / grid.width();  // half of what stands at the end of an axis
  std::string script = titles(title, subtitle, grid.width(), grid.height()) + thin_axes +
                       thin_grid + "set multiplot\n" + key_below_titles(grid.height());
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const auto& slice = slices[k];
    const auto unit = readable(units.changes[k], std::abs(slice.values.back()));
    const std::string name = fmt::format("slice{}", k);
    auto cell = grid[k];
    cell.right -= last_label;
    script += block_of(name, slice_rows(problem, slice, unit)) + at_screen(cell) +
              slice_axis(problem.changes[k], slice, unit) +
              fmt::format("set yrange [{:.4g}:{:.4g}]\nset ylabel 'to spare, % of the bound'\n",
                          low, high) +
              "set object 1 rectangle from graph 0, first -1000 to graph 1, "
              "first 0 behind fc rgb '#eeeeee' fs solid noborder\n" +
              fmt::format(
                  "set arrow 1 from first {0:.9g}, graph 0 to first {0:.9g}, graph 1 "
                  "nohead lw 1.5 dt 2 lc rgb '#444444'\n",
                  result.best.values[k] / unit.size);
    if (k > 0) script += "unset key\nunset label 101\nunset label 102\n";  // drawn once
    script += "plot ";
    for (std::size_t r = 0; r < slice.worst.size(); ++r)
      script += fmt::format("{}${} using 1:{} with lines lw 2 lc rgb '{}' title {}",
                            r > 0 ? ", " : "", name, r + 2, line_colours[r % line_colours.size()],
                            quoted(problem.requirements[r].text));
    script += ", NaN with lines lw 1.5 dt 2 lc rgb '#444444' title 'design'\n";
  }
  draw(path, grid.width(), grid.height(), script + "unset multiplot\n");
}

}  // namespace hydrapod::report
