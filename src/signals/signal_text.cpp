#include "hydrapod/signals/signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "sources.hpp"

namespace hydrapod::signals {

namespace {

using base::KeyValues;

/// A key, the member that it stands for, and a number's unit or the words for true and false.
struct Key {
  using Member =
      std::variant<double*, bool*, int*, std::optional<int>*, std::optional<std::uint64_t>*>;
  const char* name;
  Member member;
  const char* unit{};  ///< or the word for true
  const char* otherwise{};
};
using Keys = std::vector<Key>;

/// Every signal's keys: what it is read and written from.
Keys keys(Signal& signal) {
  return std::visit(
      [&]<typename T>(T& s) {
        Keys all;
        if constexpr (requires { s.at; }) all.push_back({"at", &s.at, "s"});
        if constexpr (requires { s.rise; }) all.push_back({"rise", &s.rise, "s"});
        if constexpr (requires { s.frequency; }) all.push_back({"frequency", &s.frequency, "Hz"});
        if constexpr (requires { s.from; }) all.push_back({"from", &s.from, "Hz"});
        if constexpr (requires { s.to; }) all.push_back({"to", &s.to, "Hz"});
        if constexpr (requires { s.duration; }) all.push_back({"duration", &s.duration, "s"});
        if constexpr (requires { s.period; }) all.push_back({"period", &s.period, "s"});
        if constexpr (requires { s.slope; }) all.push_back({"slope", &s.slope, "1"});
        if constexpr (requires { s.logarithmic; })
          all.push_back({"spacing", &s.logarithmic, "log", "linear"});
        if constexpr (requires { s.turns; }) all.push_back({"turns", &s.turns});
        if constexpr (requires { s.rms; }) all.push_back({"level", &s.rms, "rms", "amplitude"});
        if constexpr (requires { s.low_crest; })
          all.push_back({"crest", &s.low_crest, "low", "random"});
        if constexpr (requires { s.experiment; }) all.push_back({"experiment", &s.experiment});
        if (!std::is_same_v<T, Step>) all.push_back({"fade", &signal.fade, "s"});
        if (is_random<T>) all.push_back({"seed", &signal.seed});
        return all;
      },
      signal.form);
}

void read(KeyValues& text, const Key& key) {
  struct Read {
    KeyValues& text;
    const Key& key;
    void operator()(double* m) const { *m = text.number(key.name, key.unit).value_or(*m); }
    void operator()(bool* m) const {
      *m = text.choice(key.name, key.unit, key.otherwise).value_or(*m);
    }
    void operator()(int* m) const { *m = text.whole(key.name, 0, 1'000'000).value_or(*m); }
    void operator()(std::optional<int>* m) const { *m = text.whole(key.name, 1, 6); }
    void operator()(std::optional<std::uint64_t>* m) const { *m = text.seed(key.name); }
  };
  std::visit(Read{text, key}, key.member);
}

std::string number_text(double value, std::string_view unit) {
  return unit == "1" ? fmt::format("{:.9g}", value) : fmt::format("{:.9g} {}", value, unit);
}

/// Lengths in mm; angles in degrees or milliradians, whichever is shorter.
std::string size_text(double value, std::string_view unit) {
  if (unit == "m") return number_text(1e3 * value, "mm");
  if (unit != "rad") return number_text(value, unit);
  const auto degrees = number_text(value * 180.0 / std::numbers::pi, "deg");
  const auto milliradians = number_text(1e3 * value, "mrad");
  return milliradians.size() < degrees.size() ? milliradians : degrees;
}

/// None: there is nothing to write.
std::optional<std::string> value_text(const Key& key) {
  return std::visit(
      [&](const auto* m) -> std::optional<std::string> {
        using T = std::decay_t<decltype(*m)>;
        if constexpr (std::is_same_v<T, double>)
          return number_text(*m, key.unit);
        else if constexpr (std::is_same_v<T, bool>)
          return *m ? key.unit : key.otherwise;
        else if constexpr (std::is_same_v<T, int>)
          return fmt::to_string(*m);
        else
          return *m ? std::optional(fmt::to_string(**m)) : std::nullopt;
      },
      key.member);
}

/// The form of that name with the defaults of the place.
Form form_of(std::size_t kind, const TextPlace& place) {
  const bool rms = place.excitation;
  const std::array<Form, kinds.size()> defaults{Step{},
                                                Sine{.rms = rms},
                                                Sweep{.turns = rms ? 1 : 0, .rms = rms},
                                                Chirp{.turns = rms ? 10 : 0, .rms = rms},
                                                Multisine{},
                                                White{},
                                                Noise{},
                                                Binary{},
                                                Trajectory{}};
  return defaults[kind];
}

void read_sizes(KeyValues& text, const Units& units, Signal& signal) {
  bool any = false;
  const auto read_size = [&](const char* key, const char* unit, auto&& take) {
    if (const auto size = text.number(key, unit)) {
      take(*size);
      any = true;
    }
  };
  read_size("all", units[0], [&](double size) { signal.size.setConstant(size); });
  for (int i = 0; i < 6; ++i)
    read_size(spatial::direction_name(i), units[static_cast<std::size_t>(i)],
              [&](double size) { signal.size[i] = size; });
  for (const Key& key : keys(signal)) read(text, key);
  text.finish();
  if (!any) text.fail("no size is given; for instance \"z=1 mm\", or all=0.0001");
}

std::optional<Signal> read_signal(std::string_view text, const TextPlace& place) {
  const std::string name = place.argument + " " + base::printable(text, 100);
  const auto whole = base::trimmed(text);
  const auto end = std::min(whole.find_first_of(" \t,"), whole.size());
  const auto word = whole.substr(0, end);
  auto rest = base::trimmed(whole.substr(end));
  if (rest.starts_with(',')) rest.remove_prefix(1);
  if (word == "rest") {
    if (!rest.empty()) KeyValues(name, "").fail("rest has no keys");
    return {};
  }
  const auto kind = static_cast<std::size_t>(std::ranges::find(kinds, word) - kinds.begin());
  Signal signal;
  if (kind == kinds.size()) {
    const auto near = base::nearest(word, kinds);
    KeyValues(name, "").fail(
        fmt::format("unknown signal '{}'; {}accepted are rest, {}", base::printable(word, 20),
                    near ? fmt::format("did you mean '{}'? ", *near) : "", fmt::join(kinds, ", ")));
  }
  signal.form = form_of(kind, place);
  if (std::holds_alternative<Trajectory>(signal.form)) {
    if (rest.empty()) KeyValues(name, "").fail("names no file, expected \"file motion.csv\"");
    signal.form = read_trajectory(std::string(rest), place.units);
    return signal;
  }
  KeyValues values(name, rest);
  read_sizes(values, place.units, signal);
  try {
    require_sound(signal, place.rate);
  } catch (const std::invalid_argument& error) {
    values.fail(error.what());
  }
  return signal;
}

}  // namespace

std::vector<Signal> read_signals(const std::vector<std::string>& texts, const TextPlace& place) {
  std::vector<Signal> signals;
  for (const auto& text : texts)
    if (auto signal = read_signal(text, place)) signals.push_back(std::move(*signal));
  return signals;
}

std::string signal_text(const Signal& signal, const Units& units) {
  const auto kind = kinds[signal.form.index()];
  if (const auto* trajectory = std::get_if<Trajectory>(&signal.form))
    return fmt::format("{} {}", kind, trajectory->source);
  std::vector<std::string> parts;
  for (int i = 0; i < 6; ++i)
    if (signal.size[i] != 0.0)
      parts.push_back(fmt::format("{}={}", spatial::direction_name(i),
                                  size_text(signal.size[i], units[static_cast<std::size_t>(i)])));
  if (parts.empty()) parts.emplace_back("all=0");
  Signal copy = signal;
  for (const Key& key : keys(copy))
    if (const auto value = value_text(key)) parts.push_back(fmt::format("{}={}", key.name, *value));
  return fmt::format("{} {}", kind, fmt::join(parts, ", "));
}

}  // namespace hydrapod::signals
