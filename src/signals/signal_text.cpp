#include "hydrapod/simulation/command_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/nearest.hpp"
#include "hydrapod/base/printable.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::simulation {

namespace {

constexpr std::array<std::string_view, 6> directions{"x", "y", "z", "rx", "ry", "rz"};
constexpr std::array<std::string_view, 7> kinds{"rest",      "step",  "sine", "sweep",
                                                "multisine", "noise", "file"};

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// One command's text, split into its kind and its keys.
class CommandText {
 public:
  explicit CommandText(const std::string& text) : text_(text) {
    const std::string_view all = trimmed(text_);
    const auto blank = all.find_first_of(" \t");
    kind_ = std::string(all.substr(0, blank));
    rest_ = blank == std::string_view::npos ? "" : std::string(trimmed(all.substr(blank)));
  }

  [[nodiscard]] const std::string& kind() const { return kind_; }
  [[nodiscard]] const std::string& rest() const { return rest_; }

  [[noreturn]] void reject(const std::string& message) const {
    throw base::InputError(
        {{.file = "--command " + base::printable(text_, 100), .message = message}});
  }

  /// Reads `key=value, …`; only `keys` and directions are known.
  void split(std::vector<std::string_view> keys) {
    keys.insert(keys.begin(), directions.begin(), directions.end());
    for (std::size_t begin = 0; begin < rest_.size();) {
      const std::size_t end = std::min(rest_.find(',', begin), rest_.size());
      const std::string_view part = trimmed(std::string_view(rest_).substr(begin, end - begin));
      begin = end + 1;
      const auto equals = part.find('=');
      const std::string key(trimmed(part.substr(0, equals)));
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) unknown(key, keys);
      if (equals == std::string_view::npos)
        reject(fmt::format("'{}' has no value, expected {}=…", key, key));
      if (!values_.emplace(key, trimmed(part.substr(equals + 1))).second)
        reject(fmt::format("{} is given twice", key));
    }
  }

  [[nodiscard]] double number(const std::string& key, const char* unit, double fallback) const {
    const auto at = values_.find(key);
    return at == values_.end() ? fallback : read(key, at->second, unit);
  }

  [[nodiscard]] std::uint64_t seed(std::uint64_t fallback) const {
    const auto at = values_.find("seed");
    if (at == values_.end()) return fallback;
    std::uint64_t value{};
    const auto* end = at->second.data() + at->second.size();
    const auto [stop, status] = std::from_chars(at->second.data(), end, value);
    if (status != std::errc{} || stop != end)
      reject(fmt::format("seed is '{}', expected a whole number of 0 or more",
                         base::printable(at->second)));
    return value;
  }

  /// One of two words; whether it is the first.
  [[nodiscard]] bool first_of(const std::string& key, std::string_view first,
                              std::string_view second) const {
    const auto at = values_.find(key);
    if (at == values_.end() || at->second == first) return true;
    if (at->second != second)
      reject(fmt::format("{} is '{}', expected {} or {}", key, base::printable(at->second), first,
                         second));
    return false;
  }

  /// At least one direction, which is not zero.
  [[nodiscard]] Vector6 motion() const {
    Vector6 motion = Vector6::Zero();
    for (int i = 0; i < 6; ++i)
      motion[i] = number(std::string(directions[static_cast<size_t>(i)]), i < 3 ? "m" : "rad", 0.0);
    if (motion.isZero(0.0))
      reject(
          fmt::format("moves nothing; give a size, for instance \"{} z=5 mm\" (x, y, z, rx, ry, "
                      "rz)",
                      kind_));
    return motion;
  }

 private:
  [[nodiscard]] double read(const std::string& key, const std::string& text,
                            const char* unit) const {
    const auto last = text.find_last_of("0123456789.");
    const bool plain = last != std::string::npos && last + 1 == text.size();
    const auto quantity = base::read_quantity(text, plain ? "1" : unit);
    if (!quantity.ok()) reject(fmt::format("{}: {}", key, quantity.problem));
    return quantity.value;
  }

  [[noreturn]] void unknown(const std::string& key,
                            const std::vector<std::string_view>& keys) const {
    const auto near = base::nearest(key, keys);
    reject(fmt::format("'{}' is unknown; {}", base::printable(key),
                       near && near->size() > 2
                           ? fmt::format("did you mean '{}'?", *near)
                           : fmt::format("{} takes {}", kind_, fmt::join(keys, ", "))));
  }

  std::string text_;
  std::string kind_;
  std::string rest_;
  std::map<std::string, std::string> values_{};
};

Step parse_step(CommandText& text) {
  text.split({"at", "rise"});
  const Step standard;
  return {text.motion(), text.number("at", "s", standard.at),
          text.number("rise", "s", standard.rise)};
}

Sine parse_sine(CommandText& text) {
  text.split({"frequency", "fade"});
  const Sine standard;
  return {text.motion(), text.number("frequency", "Hz", standard.frequency),
          text.number("fade", "s", standard.fade)};
}

Sweep parse_sweep(CommandText& text) {
  text.split({"from", "to", "duration", "spacing", "fade"});
  const Sweep standard;
  return {text.motion(),
          text.number("from", "Hz", standard.from),
          text.number("to", "Hz", standard.to),
          text.number("duration", "s", standard.duration),
          text.first_of("spacing", "log", "linear"),
          text.number("fade", "s", standard.fade)};
}

Multisine parse_multisine(CommandText& text, std::uint64_t seed) {
  text.split({"from", "to", "period", "seed", "fade"});
  const Multisine standard;
  return {text.motion(),
          text.number("from", "Hz", standard.from),
          text.number("to", "Hz", standard.to),
          text.number("period", "s", standard.period),
          text.seed(seed),
          text.number("fade", "s", standard.fade)};
}

Noise parse_noise(CommandText& text, std::uint64_t seed) {
  text.split({"from", "to", "seed", "fade"});
  const Noise standard;
  return {text.motion(), text.number("from", "Hz", standard.from),
          text.number("to", "Hz", standard.to), text.seed(seed),
          text.number("fade", "s", standard.fade)};
}

}  // namespace

std::optional<CommandSpec> parse_command(const std::string& text, std::uint64_t seed) {
  CommandText command(text);
  const std::string& kind = command.kind();
  if (kind == "rest" && command.rest().empty()) return std::nullopt;
  if (kind == "step") return parse_step(command);
  if (kind == "sine") return parse_sine(command);
  if (kind == "sweep") return parse_sweep(command);
  if (kind == "multisine") return parse_multisine(command, seed);
  if (kind == "noise") return parse_noise(command, seed);
  if (kind == "file") {
    if (command.rest().empty()) command.reject("names no file, expected \"file motion.csv\"");
    return read_trajectory(command.rest());
  }
  if (kind == "rest") command.reject("rest takes nothing more");
  const auto near = base::nearest(kind, kinds);
  command.reject(fmt::format("'{}' is no command; {}known are {}", base::printable(kind),
                             near ? fmt::format("did you mean '{}'? ", *near) : "",
                             fmt::join(kinds, ", ")));
}

}  // namespace hydrapod::simulation
