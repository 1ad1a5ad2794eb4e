// Numbers of a machine file that have no effect without another one.
#include <fmt/format.h>

#include <algorithm>

#include "machine_reader.hpp"

namespace hydrapod::model {

namespace {

/// The row at `path` of the table; null for an empty path.
const ParameterRow* row_at(std::string_view path) {
  const auto table = parameter_table();
  const auto found = std::ranges::find(table, path, &ParameterRow::path);
  return path.empty() || found == table.end() ? nullptr : &*found;
}

/// Does the machine hold a number above 0 there, in leg `leg`?
bool in_use(Machine& machine, const ParameterRow& row, int leg) {
  const double* number = row.find(machine, leg, 0);
  return number != nullptr && *number > 0.0;
}

/// The path of `row`, in leg `of` where the number stands for a single one.
std::string written(const ParameterRow& row, int of) {
  if (of == 0 || !row.path.starts_with(of_legs)) return std::string(row.path);
  return fmt::format("leg.{}.{}", of, row.path.substr(of_legs.size()));
}

}  // namespace

std::vector<Finding> without_effect(const ReadMachine& read) {
  Machine machine = read.machine;  // rows find numbers in machines that may be changed
  std::vector<Finding> findings;
  for (const auto& number : read.given) {
    const auto& row = row_of(number.id);
    const auto *one = row_at(row.used_with[0]), *other = row_at(row.used_with[1]);
    if (one == nullptr || number.id.legs == 0) continue;
    bool used = false;
    for (int leg = 0; leg < leg_count; ++leg)
      if ((number.id.legs >> leg & 1) != 0)
        used |= in_use(machine, *one, leg) || (other != nullptr && in_use(machine, *other, leg));
    if (used) continue;
    std::string needed = written(*one, number.id.of);
    if (other != nullptr) needed += fmt::format("` or `{}", written(*other, number.id.of));
    findings.push_back({base::Severity::warning, number.written,
                        fmt::format("has no effect without `{}`", needed)});
  }
  return findings;
}

}  // namespace hydrapod::model
