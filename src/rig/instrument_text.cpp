#include "hydrapod/rig/signal_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/nearest.hpp"
#include "hydrapod/base/printable.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::rig {

namespace {

constexpr std::array<std::string_view, 6> directions{"x", "y", "z", "rx", "ry", "rz"};

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t") - first + 1));
}

/// "word key=value, key=value".
class Words {
 public:
  /// With `head`, what stands before the first key (and its comma, if any) is a word of its own.
  Words(std::string place, const std::string& text, bool head) : place_(std::move(place)) {
    std::string rest = trimmed(text);
    if (head) {
      const std::size_t end = std::min(rest.find_first_of(" ,"), rest.size());
      head_ = rest.substr(0, end);
      rest = trimmed(std::string_view(rest).substr(end));
      if (rest.starts_with(',')) rest = trimmed(std::string_view(rest).substr(1));
    }
    for (std::size_t begin = 0; begin < rest.size();) {
      const std::size_t end = std::min(rest.find(',', begin), rest.size());
      take(trimmed(std::string_view(rest).substr(begin, end - begin)));
      begin = end + 1;
    }
  }

  [[nodiscard]] const std::string& head() const { return head_; }

  [[noreturn]] void fail(const std::string& message) const {
    throw base::InputError({{.file = place_, .message = message}});
  }

  std::optional<std::string> text(const std::string& key) {
    const auto at = values_.find(key);
    if (at == values_.end()) return {};
    used_.push_back(key);
    return at->second;
  }

  /// A number in SI or a quantity.
  std::optional<double> number(const std::string& key, const char* unit) {
    const auto value = text(key);
    if (!value) return {};
    const auto plain = base::read_quantity(*value, "1");
    const bool has_unit = value->find_first_not_of("0123456789+-.eE \t") != std::string::npos;
    if (plain.ok() && !has_unit) return plain.value;
    const auto read = base::read_quantity(*value, unit);
    if (!read.ok()) fail(fmt::format("{}: {}", key, read.problem));
    return read.value;
  }

  /// The keys that are there, "from, q".
  [[nodiscard]] std::string keys() const {
    std::string all;
    for (const auto& [key, value] : values_)
      all += (all.empty() ? "" : ", ") + base::printable(key, 20);
    return all;
  }

  /// Throws for a key that was not asked for; `known` are those that could have been.
  void finish(const std::vector<std::string_view>& known) const {
    for (const auto& [key, value] : values_) {
      if (std::find(used_.begin(), used_.end(), key) != used_.end()) continue;
      const auto near = base::nearest(key, known);
      fail(fmt::format("unknown key '{}'; {}accepted are {}", base::printable(key, 20),
                       near ? fmt::format("did you mean '{}'? ", *near) : "",
                       fmt::join(known, ", ")));
    }
  }

 private:
  void take(const std::string& part) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos)
      fail(fmt::format("'{}' is no key=value, for instance \"z=1 mm\"", base::printable(part, 30)));
    const std::string key = trimmed(std::string_view(part).substr(0, equals));
    if (!values_.emplace(key, trimmed(std::string_view(part).substr(equals + 1))).second)
      fail(fmt::format("{} is given twice", base::printable(key, 20)));
  }

  std::string place_;
  std::string head_{};
  std::map<std::string, std::string> values_{};
  std::vector<std::string> used_{};
};

Vector6 levels(Words& words, Entry entry) {
  Vector6 rms = Vector6::Zero();
  const auto unit = [&](int i) {
    if (entry == Entry::drive) return "1";
    if (entry == Entry::wrench) return i < 3 ? "N" : "N m";
    return i < 3 ? "m" : "rad";
  };
  bool any = false;
  if (const auto all = words.number("all", unit(0))) {
    rms.setConstant(*all);
    any = true;
  }
  for (int i = 0; i < 6; ++i)
    if (const auto level =
            words.number(std::string(directions[static_cast<std::size_t>(i)]), unit(i))) {
      rms[i] = *level;
      any = true;
    }
  if (!any) {
    const std::string found = words.keys();
    words.fail(fmt::format("no level is given{}; for instance \"z=1 mm\", or all=0.0001",
                           found.empty() ? "" : fmt::format(", only {}", found)));
  }
  return rms;
}

bool choice(Words& words, const std::string& key, const char* yes, const char* no, bool otherwise) {
  const auto word = words.text(key);
  if (!word) return otherwise;
  if (*word != yes && *word != no)
    words.fail(fmt::format("{} is '{}'; accepted are {} and {}", key, base::printable(*word, 20),
                           yes, no));
  return *word == yes;
}

template <typename Spec>
void band(Words& words, Spec& spec) {
  spec.from = words.number("from", "Hz").value_or(spec.from);
  spec.to = words.number("to", "Hz").value_or(spec.to);
}

SignalSpec shaped_noise(Words& words) {
  ShapedNoise spec;
  band(words, spec);
  spec.slope = words.number("slope", "1").value_or(0.0);
  return spec;
}

SignalSpec multisine(Words& words) {
  Multisine spec;
  band(words, spec);
  spec.period = words.number("period", "s").value_or(spec.period);
  spec.slope = words.number("slope", "1").value_or(0.0);
  spec.low_crest = choice(words, "crest", "low", "random", false);
  if (const auto number = words.number("experiment", "1")) {
    if (*number != std::floor(*number) || *number < 1.0 || *number > 6.0)
      words.fail("experiment must be 1, 2, 3, 4, 5 or 6");
    spec.experiment = static_cast<int>(*number) - 1;
  }
  return spec;
}

SignalSpec binary(Words& words) {
  BinarySequence spec;
  spec.to = words.number("to", "Hz").value_or(spec.to);
  spec.period = words.number("period", "s").value_or(spec.period);
  return spec;
}

SignalSpec swept_sine(Words& words) {
  SweptSine spec;
  band(words, spec);
  spec.duration = words.number("duration", "s").value_or(spec.duration);
  spec.logarithmic = choice(words, "spacing", "log", "linear", true);
  return spec;
}

SignalSpec chirp(Words& words) {
  Chirp spec;
  band(words, spec);
  spec.period = words.number("period", "s").value_or(spec.period);
  const double turns = words.number("turns", "1").value_or(spec.turns);
  if (!(turns >= 1.0 && turns <= 1e6 && turns == std::floor(turns)))
    words.fail("turns must be a whole number, 1 or more");
  spec.turns = static_cast<int>(turns);
  return spec;
}

struct Kind {
  std::string_view name;
  SignalSpec (*read)(Words&);
  std::vector<std::string_view> keys;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"white", [](Words&) -> SignalSpec { return WhiteNoise{}; }, {}},
      {"noise", shaped_noise, {"from", "to", "slope"}},
      {"multisine", multisine, {"from", "to", "period", "slope", "crest", "experiment"}},
      {"binary", binary, {"to", "period"}},
      {"sweep", swept_sine, {"from", "to", "duration", "spacing"}},
      {"chirp", chirp, {"from", "to", "period", "turns"}}};
  return all;
}

}  // namespace

SignalSpec parse_signal(const std::string& text, Entry entry) {
  Words words("--excite " + base::printable(text), text, true);
  const auto kind = std::find_if(kinds().begin(), kinds().end(),
                                 [&](const Kind& k) { return k.name == words.head(); });
  if (kind == kinds().end()) {
    std::vector<std::string_view> names;
    for (const Kind& k : kinds()) names.push_back(k.name);
    const auto near = base::nearest(words.head(), names);
    words.fail(
        fmt::format("unknown signal '{}'; {}accepted are {}", base::printable(words.head(), 20),
                    near ? fmt::format("did you mean '{}'? ", *near) : "", fmt::join(names, ", ")));
  }
  const Vector6 rms = levels(words, entry);
  SignalSpec spec = kind->read(words);
  std::visit([&](auto& s) { s.rms = rms; }, spec);
  std::vector<std::string_view> known(directions.begin(), directions.end());
  known.push_back("all");
  known.insert(known.end(), kind->keys.begin(), kind->keys.end());
  words.finish(known);
  return spec;
}

model::Sensor parse_sensor(const std::string& argument, const std::string& text, const char* unit) {
  Words words(argument + " " + base::printable(text), text, false);
  model::Sensor sensor;
  sensor.resolution = words.number("resolution", unit).value_or(0.0);
  sensor.noise = words.number("noise", unit).value_or(0.0);
  sensor.low = words.number("low", unit);
  sensor.high = words.number("high", unit);
  words.finish({"resolution", "noise", "low", "high"});
  if (sensor.resolution < 0.0 || sensor.noise < 0.0)
    words.fail("resolution and noise must be 0 or more");
  if (sensor.low && sensor.high && !(*sensor.low < *sensor.high))
    words.fail("low must be less than high");
  return sensor;
}

Accelerometer parse_accelerometer(const std::string& text) {
  Words words("--accelerometer " + base::printable(text), text, true);
  Accelerometer one;
  one.name = words.head();
  if (one.name.empty()) words.fail("an accelerometer has a name");
  std::istringstream place(words.text("at").value_or("0 0 0"));
  std::string left;
  if (!(place >> one.p_P.x() >> one.p_P.y() >> one.p_P.z()) || place >> left ||
      !one.p_P.allFinite())
    words.fail("at must be three lengths in m, for instance at=0.3 0 0.1");
  const std::string along = words.text("along").value_or("z");
  const auto direction = data::direction_from_text(along);
  const int code = direction ? static_cast<int>(*direction) : 0;
  if (code == 0 || std::abs(code) > 3) words.fail("along must be x, y, z, -x, -y or -z");
  one.direction = *direction;
  one.e_P = (code > 0 ? 1.0 : -1.0) * Vector3::Unit(std::abs(code) - 1);
  one.noise_density = words.number("noise", "1").value_or(one.noise_density);
  one.bandwidth = words.number("bandwidth", "Hz").value_or(one.bandwidth);
  one.sensor.resolution = words.number("resolution", "m/s^2").value_or(one.sensor.resolution);
  if (const auto range = words.number("range", "m/s^2")) {
    one.sensor.low = -std::abs(*range);
    one.sensor.high = std::abs(*range);
  }
  one.point = static_cast<int>(words.number("point", "1").value_or(0.0));
  words.finish({"at", "along", "noise", "bandwidth", "range", "resolution", "point"});
  if (one.noise_density < 0.0 || one.bandwidth < 0.0 || one.sensor.resolution < 0.0)
    words.fail("noise, bandwidth and resolution must be 0 or more");
  return one;
}

}  // namespace hydrapod::rig
