#include "channel_roles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::data {

namespace {

struct RoleWord {
  std::string_view word;
  Role role;
  bool whole;  ///< a word of its own, not a part of one
};

/// The first that is in a name decides: a demanded force is demanded, the response of a force
/// sensor a response.
constexpr std::array role_words{
    RoleWord{"demand", Role::excitation, false},    RoleWord{"command", Role::excitation, false},
    RoleWord{"cmd", Role::excitation, true},        RoleWord{"setpoint", Role::excitation, false},
    RoleWord{"reference", Role::excitation, false}, RoleWord{"soll", Role::excitation, true},
    RoleWord{"sollwert", Role::excitation, true},   RoleWord{"excit", Role::excitation, false},
    RoleWord{"valve", Role::drive, false},          RoleWord{"ventil", Role::drive, false},
    RoleWord{"drive", Role::drive, false},          RoleWord{"response", Role::response, false},
    RoleWord{"output", Role::response, false},      RoleWord{"reaction", Role::response, false},
    RoleWord{"hammer", Role::excitation, false},    RoleWord{"impact", Role::excitation, false},
    RoleWord{"shaker", Role::excitation, false},    RoleWord{"input", Role::excitation, true},
    RoleWord{"force", Role::excitation, false},     RoleWord{"kraft", Role::excitation, false},
    RoleWord{"acc", Role::response, true},          RoleWord{"accel", Role::response, false},
    RoleWord{"beschl", Role::response, false},      RoleWord{"vel", Role::response, true},
    RoleWord{"veloc", Role::response, false},       RoleWord{"disp", Role::response, true},
    RoleWord{"displ", Role::response, false},       RoleWord{"weg", Role::response, true},
    RoleWord{"strain", Role::response, false},      RoleWord{"pressure", Role::response, false}};

struct RoleUnit {
  const char* unit;
  Role role;
};
constexpr std::array role_units{
    RoleUnit{"N", Role::excitation},   RoleUnit{"N m", Role::excitation},
    RoleUnit{"m/s^2", Role::response}, RoleUnit{"m/s", Role::response},
    RoleUnit{"m", Role::response},     RoleUnit{"rad", Role::response},
    RoleUnit{"rad/s", Role::response}, RoleUnit{"rad/s^2", Role::response},
    RoleUnit{"Pa", Role::response}};

/// Is `word` in `name`, with no letter beside it where it must be whole?
bool has_word(const std::string& name, const RoleWord& word) {
  const auto is_small = [](char c) { return c >= 'a' && c <= 'z'; };
  for (std::size_t at = name.find(word.word); at != name.npos; at = name.find(word.word, at + 1)) {
    const std::size_t end = at + word.word.size();
    const bool alone =
        (at == 0 || !is_small(name[at - 1])) && (end == name.size() || !is_small(name[end]));
    if (alone || !word.whole) return true;
  }
  return false;
}

std::optional<Role> unit_role(const std::string& unit) {
  if (unit.empty() || unit == "1") return {};
  for (const RoleUnit& known : role_units)
    if (base::read_quantity("1 " + unit, known.unit).ok()) return known.role;
  return {};
}

/// "a1", "v 3", "d12x", "y2": letters for motions with a number, as sensors are counted. "f", "u",
/// "f1" and "data.u": letters for forces and inputs, where a number need not be.
std::optional<Role> letter_role(std::string_view name) {
  constexpr std::string_view motions = "avdy", inputs = "fu", axes = "xyz";
  name.remove_prefix(name.find_last_of("./") + 1);
  if (name.empty()) return {};
  const bool input = inputs.find(name[0]) != inputs.npos;
  if (!input && motions.find(name[0]) == motions.npos) return {};
  const Role role = input ? Role::excitation : Role::response;
  std::string_view rest = name.substr(1);
  if (input && rest.empty()) return role;
  rest.remove_prefix(std::min(rest.find_first_not_of(" _-:"), rest.size()));
  const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
  if (digits == 0) return {};
  rest.remove_prefix(digits);
  rest.remove_prefix(std::min(rest.find_first_not_of(" _-+:"), rest.size()));
  if (rest.empty() || (rest.size() == 1 && axes.find(rest[0]) != axes.npos)) return role;
  return {};
}

std::optional<Role> told_role(const Channel& channel) {
  const std::string name = base::lower_case(channel.name);
  const auto word =
      std::ranges::find_if(role_words, [&](const RoleWord& w) { return has_word(name, w); });
  const auto by_unit = unit_role(channel.unit);
  // what is measured at a valve or a drive in Pa or m does not drive it
  const bool measured =
      by_unit == Role::response && word != role_words.end() && word->role == Role::drive;
  if (word != role_words.end() && !measured) return word->role;
  return by_unit ? by_unit : letter_role(name);
}

/// "r", "r2", "u_1": the letter alone or with a number.
bool is_numbered(const std::string& name, char letter) {
  const std::string lower = base::lower_case(name);
  std::string_view rest(lower);
  rest.remove_prefix(rest.find_last_of("./") + 1);
  if (rest.empty() || rest[0] != letter) return false;
  rest.remove_prefix(1);
  rest.remove_prefix(std::min(rest.find_first_not_of(" _-:"), rest.size()));
  return rest.find_first_not_of("0123456789") == rest.npos;
}

/// r, u and y, as many r as u: the reference, input and output of a loop, whatever their units are.
void tell_loop(const std::vector<Channel>& channels, std::vector<std::optional<Role>>& told) {
  const auto count = [&](char letter) {
    return std::ranges::count_if(
        channels, [&](const Channel& channel) { return is_numbered(channel.name, letter); });
  };
  if (count('r') == 0 || count('r') != count('u') || count('y') == 0) return;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (is_numbered(channels[c].name, 'r')) told[c] = Role::excitation;
    if (is_numbered(channels[c].name, 'u')) told[c] = Role::drive;
    if (is_numbered(channels[c].name, 'y')) told[c] = Role::response;
  }
}

/// "force, a1, a2 and 9 more".
std::string some_names(const std::vector<Channel>& channels, Role role) {
  constexpr std::size_t shown = 6;
  std::string text;
  std::size_t count = 0;
  for (const Channel& channel : channels) {
    if (channel.role != role || ++count > shown) continue;
    text += (text.empty() ? "" : ", ") + base::printable(channel.name, 30);
  }
  return count > shown ? text + fmt::format(" and {} more", count - shown) : text;
}

}  // namespace

void guess_roles(std::vector<Channel>& channels, Notes& notes) {
  std::vector<std::optional<Role>> told;
  for (const Channel& channel : channels) told.push_back(told_role(channel));
  tell_loop(channels, told);
  const bool driven = std::ranges::any_of(told, [](const std::optional<Role>& role) {
    return role == Role::excitation || role == Role::drive;
  });
  bool changed = false;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const Role role = told[c].value_or(driven ? Role::other : channels[c].role);
    changed = changed || role != channels[c].role;
    channels[c].role = role;
  }
  if (!changed) return;
  std::string text;
  for (const Role role : {Role::excitation, Role::drive, Role::response, Role::other})
    if (const std::string names = some_names(channels, role); !names.empty())
      text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", role_text(role), names);
  notes.add("roles by the names and units of the channels: " + text +
            "; --inputs and --outputs name others");
}

void tell_measured_inputs(std::vector<Channel>& inputs) {
  const auto is_commanded = [](const std::string& name) {
    for (const RoleWord& word : role_words) {
      if (word.word == "response") return false;  // behind it come words of sensors
      // an axis of a response may be called the reference; at a drive motions are measured
      if (word.role == Role::excitation && word.word != "reference" && has_word(name, word))
        return true;
    }
    return false;
  };
  for (Channel& channel : inputs)
    if (unit_role(channel.unit) == Role::response && !is_commanded(base::lower_case(channel.name)))
      channel.role = Role::response;
}

}  // namespace hydrapod::data
