#include "reached_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace hydrapod::study {

namespace {

/// "m^2 rad"
std::string unit_of(const std::vector<Input>& inputs) {
  std::string text;
  for (const char* unit : {"m", "rad"}) {
    const auto power = std::ranges::count(inputs, unit, &Input::unit);
    if (power == 0) continue;
    if (!text.empty()) text += " ";
    text += power == 1 ? unit : fmt::format("{}^{}", unit, power);
  }
  return text;
}

bool ascends(const std::vector<double>& values) {
  return values.size() > 1 &&
         std::ranges::adjacent_find(values, std::greater_equal<>()) == values.end();
}

}  // namespace

std::optional<ReachedPart> reached_part(const Spool& spool, const Problem& problem,
                                        const Plan& plan) {
  const auto& inputs = problem.inputs;
  if (plan.design != Design::grid || spool.rows() != plan.samples) return std::nullopt;
  for (const auto& input : inputs)
    if (!ascends(input.distribution.list)) return std::nullopt;
  std::vector<bool> reached;
  reached.reserve(spool.rows());
  const auto status = inputs.size() + static_cast<std::size_t>(problem.status);
  spool.each_chunk([&](std::uint64_t, std::span<const double> rows) {
    for (std::size_t at = status; at < rows.size(); at += spool.width())
      reached.push_back(rows[at] != static_cast<double>(Status::out_of_reach));
  });
  ReachedPart part{.unit = unit_of(inputs)};
  std::vector<std::size_t> at(inputs.size());  // of the corner of a cell with the least values
  const std::size_t corners = std::size_t{1} << inputs.size();
  for (bool more = true; more;) {
    double size = 1.0;
    for (std::size_t k = 0; k < inputs.size(); ++k)
      size *= inputs[k].distribution.list[at[k] + 1] - inputs[k].distribution.list[at[k]];
    std::size_t count = 0;
    for (std::size_t corner = 0; corner < corners; ++corner) {
      std::size_t row = 0;
      for (std::size_t k = 0; k < inputs.size(); ++k)
        row = row * inputs[k].distribution.list.size() + at[k] + (corner >> k & 1U);
      count += reached[row] ? 1 : 0;
    }
    part.whole += size;
    if (count > 0) part.most += size;
    if (count == corners) part.least += size;
    more = false;
    for (std::size_t k = inputs.size(); k-- > 0 && !more;) {
      more = ++at[k] + 1 < inputs[k].distribution.list.size();
      if (!more) at[k] = 0;
    }
  }
  return part;
}

}  // namespace hydrapod::study
