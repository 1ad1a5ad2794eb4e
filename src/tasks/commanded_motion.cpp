#include "commanded_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>

#include "hydrapod/base/error.hpp"

namespace hydrapod::tasks {

namespace {

using simulation::ClosedLoop;

bool is_trajectory(const signals::Signal& signal) {
  return std::holds_alternative<signals::Trajectory>(signal.form);
}

/// The same at any sample rate, and as smooth between samples as it is at them.
bool is_function_of_time(const signals::Signal& signal) {
  return is_trajectory(signal) || std::holds_alternative<signals::Step>(signal.form) ||
         std::holds_alternative<signals::Sine>(signal.form) ||
         std::holds_alternative<signals::Sweep>(signal.form);
}

/// The command with millimetres and degrees where its sizes have no unit: "step z=5 mm" of
/// "step z=5".
std::string in_millimetres(const std::string& command) {
  static const std::regex size(
      R"(\b(r?)([xyz])(\s*=\s*)([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*(?=,|$))");
  std::string meant;
  auto rest = command.begin();
  for (std::sregex_iterator found(command.begin(), command.end(), size), none; found != none;
       ++found) {
    meant.append(rest, (*found)[0].first);
    meant += found->str(1) + found->str(2) + found->str(3) + found->str(4) +
             (found->length(1) == 0 ? " mm" : " deg");
    rest = (*found)[0].second;
  }
  return meant.append(rest, command.end());
}

/// Where the motion can be in millimetres and degrees, and its sizes have no units, that is the
/// likely cause of all `errors`: one message then.
void refuse_with_guess(const Machine& machine, const ClosedLoop& loop,
                       const std::vector<std::string>& texts, double until,
                       const std::vector<base::Diagnostic>& errors) {
  std::vector<std::string> meant, changed, wrong;
  for (const auto& text : texts) {
    meant.push_back(in_millimetres(text));
    if (meant.back() == text) continue;
    changed.push_back(meant.back());
    wrong.push_back(text);
  }
  if (changed.empty()) return;
  const double rate = 1.0 / loop.parameters().sample_time;
  signals::Generator signal(signals::read_signals(meant, {.rate = rate}), rate);
  for (const auto& finding :
       simulation::check_motion(loop.plant(), loop.parameters(), machine.pose.X_BP, signal, until))
    if (finding.severity == base::Severity::error) return;
  base::refuse(fmt::format("--command {}", fmt::join(wrong, ", ")),
               fmt::format("{}; did you mean \"{}\"?", errors.front().message,
                           fmt::join(changed, "\", \"")));
}

/// "x=3 mm, ry=0.5 deg".
std::string displacement_text(const spatial::Vector6& value) {
  constexpr double degrees = 180.0 / std::numbers::pi, smallest = 1e-6;
  std::vector<std::string> parts;
  for (int d = 0; d < 6; ++d)
    if (std::abs(value[d]) > smallest)
      parts.push_back(fmt::format("{}={:.3g} {}", spatial::direction_names.at(d),
                                  value[d] * (d < 3 ? 1e3 : degrees), d < 3 ? "mm" : "deg"));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

std::vector<std::string> require_possible(const Machine& machine, const ClosedLoop& loop,
                                          const std::vector<std::string>& texts,
                                          const std::vector<signals::Signal>& commands,
                                          signals::Generator& signal, double until) {
  auto parameters = loop.parameters();
  std::optional<signals::Generator> finer;
  // a trajectory with a point per sample may be at rest at all of them and fast between them
  if (std::ranges::any_of(commands, is_trajectory) &&
      std::ranges::all_of(commands, is_function_of_time)) {
    parameters.sample_time /= 4.0;
    finer.emplace(commands, 1.0 / parameters.sample_time);
  }
  std::vector<base::Diagnostic> errors;
  std::vector<std::string> warnings;
  for (const auto& finding : simulation::check_motion(loop.plant(), parameters, machine.pose.X_BP,
                                                      finer ? *finer : signal, until)) {
    if (finding.severity == base::Severity::error)
      errors.push_back({.file = "the commanded motion", .message = finding.message});
    else
      warnings.push_back(finding.message);
  }
  if (errors.empty()) return warnings;
  refuse_with_guess(machine, loop, texts, until, errors);
  throw base::InputError(errors);
}

std::optional<std::string> loss_of_rest(const Machine& machine, const ClosedLoop& loop,
                                        signals::Generator& signal, double until) {
  const auto& of = machine.file.machine;
  if (machine.kind == dynamics::ModelKind::rigid || of.gravity.isZero(0.0)) return {};
  const auto falls = [&](const spatial::Pose& X_BP, bool controlled) {
    try {
      return !simulation::instability(of, X_BP, machine.kind, controlled, &loop.parameters())
                  .empty();
    } catch (const base::ComputationError&) {  // no equilibrium at all
      return true;
    }
  };
  const double T = loop.parameters().sample_time;
  const long samples = std::lround(until / T),
             every = std::max(std::lround(0.01 / T), samples / 500);
  signal.restart();
  std::optional<std::string> found;
  for (long k = 0; k <= samples && !found; ++k) {
    const auto command = signal.next();
    if (k % std::max(every, 1L) != 0 || command.value.isZero(0.0)) continue;
    const auto X_BP = simulation::command_at(machine.pose.X_BP, command).X_BP;
    if (falls(X_BP, false) && falls(X_BP, true))
      found = fmt::format(
          "the legs buckle where the command is at {:.3g} s, {}: the platform does "
          "not stay there; `hydrapod check` of that pose states the load that the "
          "legs carry",
          static_cast<double>(k) * T, displacement_text(command.value));
  }
  signal.restart();
  return found;
}

}  // namespace hydrapod::tasks
