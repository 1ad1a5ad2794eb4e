#include "commanded_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
                       const std::vector<base::Diagnostic>& errors,
                       const simulation::KeepGoing& keep_going) {
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
  for (const auto& finding : simulation::check_motion(loop.plant(), loop.parameters(),
                                                      machine.pose.X_BP, signal, until, keep_going))
    if (finding.severity == base::Severity::error) return;
  base::refuse(fmt::format("--command {}", fmt::join(wrong, ", ")),
               fmt::format("{}; did you mean \"{}\"?", errors.front().message,
                           fmt::join(changed, "\", \"")));
}

}  // namespace

std::vector<std::string> require_possible(const Machine& machine, const ClosedLoop& loop,
                                          const std::vector<std::string>& texts,
                                          const std::vector<signals::Signal>& commands,
                                          signals::Generator& signal, double until,
                                          const simulation::KeepGoing& keep_going) {
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
                                                      finer ? *finer : signal, until, keep_going)) {
    if (finding.severity == base::Severity::error)
      errors.push_back({.file = "the commanded motion", .message = finding.message});
    else
      warnings.push_back(finding.message);
  }
  if (errors.empty()) return warnings;
  refuse_with_guess(machine, loop, texts, until, errors, keep_going);
  throw base::InputError(errors);
}

}  // namespace hydrapod::tasks
