// What a machine file states that has no effect without another part of it.
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

/// Piston rings of some legs only: the model has them in all legs or in none.
void add_lone_rings(const Machine& machine, std::vector<Finding>& findings) {
  std::vector<int> with, without;
  for (int leg = 0; leg < leg_count; ++leg)
    (machine.legs[leg].piston_ring ? with : without).push_back(leg + 1);
  if (with.empty() || without.empty()) return;
  findings.push_back(
      {base::Severity::warning, fmt::format("leg.{}.piston_ring", with.front()),
       fmt::format("has no effect, since leg{} {} {} no piston ring: the model is that of the "
                   "guide sleeves alone; give all legs a ring (legs.piston_ring), a stiff one "
                   "where there is none, or take this one out",
                   without.size() > 1 ? "s" : "", fmt::join(without, ", "),
                   without.size() > 1 ? "have" : "has")});
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
  add_lone_rings(machine, findings);
  return findings;
}

}  // namespace hydrapod::model
