/// Rows that are the worst of all combinations of some inputs.

#include <algorithm>
#include <cmath>
#include <memory>

#include "machine_outputs.hpp"

namespace hydrapod::study {

namespace {

constexpr std::size_t numbers_at_once = std::size_t{1} << 18U;  ///< 2 MB of doubles

/// A pose out of reach before one without equilibrium or modes: what has one of the first is no
/// part of the workspace.
double worst_status(std::span<const Row> rows, std::size_t column) {
  constexpr auto out_of_reach = static_cast<double>(Status::out_of_reach);
  double worst = 0.0;
  for (const auto& row : rows) {
    const double status = row.outputs[column];
    if (status == out_of_reach) return status;
    worst = std::max(worst, status);
  }
  return worst;
}

/// What is known of the problem beneath, and every combination of its inner inputs.
struct Whole {
  Problem problem{};
  std::size_t outer{};
  std::vector<std::vector<double>> combinations{};
  std::vector<std::size_t> decides{};  ///< per column, the column whose worst value counts

  Whole(Problem beneath, std::size_t count) : problem(std::move(beneath)), outer(count) {
    combinations = {{}};
    for (std::size_t k = outer; k < problem.inputs.size(); ++k) {
      std::vector<std::vector<double>> longer;
      for (const auto& begun : combinations)
        for (const double value : problem.inputs[k].distribution.list) {
          longer.push_back(begun);
          longer.back().push_back(value);
        }
      combinations = std::move(longer);
    }
    for (std::size_t c = 0; c < problem.outputs.size(); ++c) {
      const auto& column = problem.outputs[c];
      const auto at = std::ranges::find(problem.outputs, column.worst_with, &Column::name);
      decides.push_back(
          at == problem.outputs.end() ? c : static_cast<std::size_t>(at - problem.outputs.begin()));
    }
  }

  [[nodiscard]] std::size_t width() const { return problem.inputs.size() + problem.outputs.size(); }
  [[nodiscard]] std::size_t all() const { return combinations.size(); }

  /// Inputs and outputs of every combination with these outer inputs; the inputs are set.
  void put(std::span<const double> inputs, std::span<double> numbers,
           std::vector<Row>& rows) const {
    for (std::size_t k = 0; k < all(); ++k) {
      const auto row = numbers.subspan(k * width(), width());
      std::ranges::copy(inputs, row.begin());
      std::ranges::copy(combinations[k], row.begin() + static_cast<std::ptrdiff_t>(outer));
      rows.push_back({row.first(problem.inputs.size()), row.subspan(problem.inputs.size())});
    }
  }

  /// Which of these rows is worst in a column; none: a row has no value.
  [[nodiscard]] std::optional<std::size_t> worst(std::span<const Row> rows, std::size_t c) const {
    const bool more = problem.outputs[c].worse == Worse::more;
    std::size_t found = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const double value = rows[k].outputs[c], best = rows[found].outputs[c];
      if (std::isnan(value)) return std::nullopt;
      if (more ? value > best : value < best) found = k;
    }
    return found;
  }

  void take(std::span<const Row> rows, std::span<double> outputs) const {
    std::ranges::fill(outputs, missing);
    const auto status = static_cast<std::size_t>(problem.status);
    outputs[status] = worst_status(rows, status);
    for (std::size_t c = 0; c < outputs.size(); ++c) {
      if (c == status) continue;
      if (const auto k = worst(rows, decides[c])) outputs[c] = rows[*k].outputs[c];
    }
  }
};

}  // namespace

Problem worst_over(Problem problem, std::size_t outer) {
  const auto whole = std::make_shared<const Whole>(std::move(problem), outer);
  const auto& beneath = whole->problem;
  Problem result{.inputs = {beneath.inputs.begin(),
                            beneath.inputs.begin() + static_cast<std::ptrdiff_t>(outer)},
                 .outputs = beneath.outputs,
                 .status = beneath.status,
                 .interruption = beneath.interruption};
  result.batch = [whole]() -> BatchModel {
    return [whole, batch = whole->problem.batch(), numbers = std::vector<double>(),
            inner = std::vector<Row>()](std::span<const Row> rows) mutable {
      const std::size_t each = whole->all() * whole->width();
      const std::size_t together = std::max<std::size_t>(1, numbers_at_once / each);
      std::size_t alone = 0;
      for (std::size_t from = 0; from < rows.size(); from += together) {
        const auto some = rows.subspan(from, std::min(together, rows.size() - from));
        numbers.resize(some.size() * each);
        inner.clear();
        for (std::size_t k = 0; k < some.size(); ++k)
          whole->put(some[k].inputs, std::span(numbers).subspan(k * each, each), inner);
        alone += batch(inner);
        for (std::size_t k = 0; k < some.size(); ++k)
          whole->take(std::span(inner).subspan(k * whole->all(), whole->all()), some[k].outputs);
      }
      return alone;
    };
  };
  result.model = [make = result.batch]() -> Model {
    return [batch = make()](std::span<const double> inputs, std::span<double> outputs) mutable {
      const Row row{inputs, outputs};
      batch({&row, 1});
    };
  };
  result.beneath = std::make_shared<const Problem>(beneath);
  return result;
}

std::optional<std::vector<double>> worst_row(const Problem& problem, std::span<const double> outer,
                                             int column) {
  if (!problem.beneath) return std::nullopt;
  const Whole whole(*problem.beneath, outer.size());
  std::vector<double> numbers(whole.all() * whole.width());
  std::vector<Row> rows;
  whole.put(outer, numbers, rows);
  whole.problem.batch()(rows);
  const auto worst = whole.worst(rows, whole.decides[static_cast<std::size_t>(column)]);
  if (!worst) return std::nullopt;
  const auto row = std::span<const double>(numbers).subspan(*worst * whole.width(), whole.width());
  return std::vector<double>(row.begin(), row.end());
}

}  // namespace hydrapod::study
