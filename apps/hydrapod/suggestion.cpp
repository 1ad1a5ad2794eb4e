#include "hydrapod/suggestion.hpp"

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "hydrapod/base/text.hpp"

namespace hydrapod::cli {

namespace {
/// base::nearest over owned names; empty when none is near enough to be meant.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  const std::vector<std::string_view> views(candidates.begin(), candidates.end());
  return std::string(base::nearest(word, views).value_or(""));
}
}  // namespace

std::string unknown_argument(const Choices& choices, const std::string& argument) {
  const bool is_option = argument.size() > 1 && argument.front() == '-';
  const std::string word = is_option ? argument.substr(0, argument.find('=')) : argument;
  const bool is_command = !is_option && !choices.commands.empty();
  std::string message = is_option    ? fmt::format("unknown option '{}'", word)
                        : is_command ? fmt::format("unknown command '{}'", word)
                                     : fmt::format("one argument too many: '{}'", word);
  std::string best;
  if (is_option) best = nearest(word, choices.options);
  if (is_command) best = nearest(word, choices.commands);
  if (!best.empty()) message += fmt::format("; did you mean '{}'?", best);
  return message + fmt::format(" ('{} --help' lists the options)", choices.call);
}

}  // namespace hydrapod::cli
