#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "hydrapod/base/units.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "prefix.hpp"

namespace hydrapod::report {

namespace {

using namespace diagnosis;

using base::two_pi;
constexpr double bar = 1e5;  // [Pa]

/// Of all legs or of none; of one leg, whose number is {}.
struct CauseWords {
  const char* name;
  const char* statement;
  const char* name_of_leg;
  const char* statement_of_leg;
};

/// In the order of Cause::Kind.
constexpr std::array cause_words{
    CauseWords{"guide sleeves of all legs",
               "the stiffness of the guide sleeves of all legs differs from the nominal value",
               "guide sleeve of leg {}",
               "the stiffness of the guide sleeve of leg {} differs from the nominal value"},
    CauseWords{"piston rings of all legs", "the piston rings of all legs are compliant",
               "piston ring of leg {}",
               "the stiffness of the piston ring of leg {} differs from the nominal value"},
    CauseWords{"bulk modulus of the oil",
               "the oil stiffness of all legs differs from the nominal value", "", ""},
    CauseWords{
        "oil springs of all legs", "the oil stiffness of all legs differs from the nominal value",
        "oil spring of leg {}", "the oil stiffness of leg {} differs from the nominal value"},
    CauseWords{"entrained air in all legs",
               "the air content of the oil of all legs differs from the nominal value", "", ""},
    CauseWords{"cap-side chamber or line volume of all legs",
               "the oil volume on the cap side of all legs differs from the nominal value",
               "cap-side chamber or line volume of leg {}",
               "the oil volume on the cap side of leg {} differs from the nominal value"},
    CauseWords{"rod-side chamber or line volume of all legs",
               "the oil volume on the rod side of all legs differs from the nominal value",
               "rod-side chamber or line volume of leg {}",
               "the oil volume on the rod side of leg {} differs from the nominal value"},
    CauseWords{"gimbals of all legs", "the gimbals of all legs are compliant or have free play",
               "gimbals of leg {}", "a gimbal of leg {} is compliant or has free play"},
    CauseWords{"sticking cylinder seals of all legs",
               "the seals of all cylinders stick instead of sliding at the measured amplitude: a "
               "spring parallel to the oil",
               "sticking cylinder seals of leg {}",
               "the cylinder seals of leg {} stick instead of sliding at the measured amplitude: a "
               "spring parallel to the oil"},
    CauseWords{"payload (platform mass)",
               "the mass of platform and payload differs from the nominal mass", "", ""},
    CauseWords{"payload at another height",
               "mass and height of the payload differ from the nominal values", "", ""},
    CauseWords{"platform inertia",
               "the moments of inertia of the platform differ from the nominal values", "", ""},
    CauseWords{"platform mass and inertia",
               "mass and moments of inertia of the platform differ from the nominal values", "",
               ""},
    CauseWords{"mass centre", "the mass centre differs from the nominal position", "", ""},
    CauseWords{"lateral compliance of the base", "the base is compliant in lateral directions", "",
               ""},
    CauseWords{"vertical compliance of the base", "the base is compliant in the vertical direction",
               "", ""},
    CauseWords{"rocking compliance of the base", "the base is compliant in rocking", "", ""},
    CauseWords{
        "oil in the lines",
        "oil in the lines adds inertia to the pistons, more than lines with closed valves have",
        "oil in the lines of leg {}", "oil in the lines adds inertia to the piston of leg {}"},
    CauseWords{"leakage past the pistons of all legs",
               "the leakage past the pistons of all legs differs from the nominal value",
               "leakage past the piston of leg {}",
               "the leakage past the piston of leg {} differs from the nominal value"},
    CauseWords{"payload that sways",
               "a part of the payload is not rigid: it swings in lateral directions", "", ""},
    CauseWords{"payload that heaves",
               "a part of the payload is not rigid: it swings in the vertical direction", "", ""},
    CauseWords{"modes of the payload",
               "the frequencies of the payload's modes differ from the nominal values", "", ""},
    CauseWords{"rods of all legs that bend",
               "the bending stiffness of the rods of all legs differs from the nominal value",
               "rod of leg {} that bends",
               "the bending stiffness of the rod of leg {} differs from the nominal value"},
    CauseWords{"dynamic stiffening of the guide sleeves' elastomers",
               "the ratio of dynamic to static stiffness of the guide sleeves' elastomers differs "
               "from the nominal value",
               "", ""},
    CauseWords{"loss factor of the guide sleeves' elastomers",
               "the loss factor of the guide sleeves' elastomers differs from the nominal value",
               "", ""},
    CauseWords{"struts of all legs",
               "the stiffness of the struts of all legs differs from the nominal value",
               "strut of leg {}",
               "the stiffness of the strut of leg {} differs from the nominal value"},
    CauseWords{"screws of all legs",
               "the stiffness of the screws of all legs differs from the nominal value",
               "screw of leg {}",
               "the stiffness of the screw of leg {} differs from the nominal value"},
    CauseWords{"gap at the guide rings of all legs",
               "the gap between rods and guide rings of all legs differs from the nominal value",
               "gap at the guide ring of leg {}",
               "the gap between rod and guide ring of leg {} differs from the nominal value"}};

std::string of_cause(const Cause& cause, const char* CauseWords::*all,
                     const char* CauseWords::*of_leg) {
  const auto& words = cause_words.at(static_cast<std::size_t>(cause.kind));
  return cause.leg ? fmt::format(fmt::runtime(words.*of_leg), *cause.leg + 1) : words.*all;
}

/// The prefix that leaves one to four digits before the point.
Prefix scale_of(double value, const std::string& unit) {
  const bool prefixed = unit == "N/m" || unit == "Pa" || unit == "N m/rad" || unit == "N s/m";
  const double size = std::abs(value);
  if (unit == "m" && size < 1.0) return {1e-3, "m"};
  if (unit == "m^3" && size < 1.0) return {1e-3, ""};
  if (!prefixed) return {1.0, ""};
  return prefix_of(std::max(size, 1.0));
}

const char* number_word(int count) {
  constexpr std::array words{"no", "one", "two", "three", "four", "five", "six"};
  return words.at(static_cast<std::size_t>(std::clamp(count, 0, 6)));
}

std::string at_pose(const Diagnosis& d, const std::string& pose) {
  const bool several =
      std::ranges::any_of(d.targets.modes, [&](const auto& m) { return m.pose != pose; });
  return several ? fmt::format(" at pose {}", pose) : "";
}

/// "predicts z at 8.52 Hz, 0.31 Hz higher than measured".
std::string contradiction_text(const Diagnosis& d, const Contradiction& c) {
  using Kind = Contradiction::Kind;
  std::vector<std::string> places;
  for (const auto& place : c.places)
    places.push_back((place.direction < 0 ? place.mode : direction_name(place.direction)) +
                     at_pose(d, place.pose));
  const double frequency = c.omega / two_pi, off = std::abs(c.difference) / two_pi;
  switch (c.kind) {
    case Kind::resonances:
      return fmt::format("predicts {} resonance{} in {}, {} {} measured", number_word(c.predicted),
                         c.predicted == 1 ? "" : "s", fmt::join(places, ", "),
                         number_word(c.measured), c.measured == 1 ? "was" : "were");
    case Kind::frequency:
      return fmt::format("predicts {} at {:.2f} Hz, {:.2f} Hz {} than measured", places.front(),
                         frequency, off, c.difference > 0.0 ? "higher" : "lower");
    case Kind::shape:
      return fmt::format("mode shape differs from the measured one in {} at {:.2f} Hz (MAC {:.2f})",
                         places.front(), frequency, c.mac);
    case Kind::drives:
      return fmt::format(
          "shape of the response to drives differs from the measured one at {:.2f} Hz{} (MAC "
          "{:.2f})",
          frequency, places.front(), c.mac);
    case Kind::forces:
      return fmt::format("differs from the response to forces at {:.2f} Hz{} by {:.0f} %",
                         frequency, places.front(), 100.0 * c.missed);
    case Kind::value:
      break;
  }
  return fmt::format("the value that explains {} ({}) contradicts {} by {:.2g} Hz",
                     direction_name(c.direction), amount_text(c.value, c.deviation, c.unit),
                     places.front(), off);
}

std::string objection_text(const Objection& objection) {
  using Kind = Objection::Kind;
  constexpr std::array slips{"", "; possible reason: a unit wrong by 1000 in the frequencies",
                             "; possible reason: rad/s taken for Hz",
                             "; possible reason: cycles per minute taken for Hz",
                             "; possible reason: a mass or a stiffness wrong by 1000 in the "
                             "machine file"};
  switch (objection.kind) {
    case Kind::few_modes:
      return fmt::format("{} measured; with fewer than {} every candidate cause explains them",
                         objection.count == 1 ? "only one mode was"
                                              : fmt::format("only {} modes were", objection.count),
                         fewest_modes);
    case Kind::no_directions:
      return "the measured modes have neither directions nor shapes; frequencies alone fit many "
             "machines (give x … rz, or a shape, with every mode)";
    case Kind::few_directions:
      return fmt::format(
          "the measured modes move the platform in {} of its six directions only; at least {} are "
          "needed",
          objection.count, fewest_directions);
    case Kind::frequencies:
      break;
  }
  return fmt::format(
      "the measured frequencies are {:.3g} times those of this machine, direction by direction "
      "(median){}",
      objection.ratio, slips.at(static_cast<std::size_t>(objection.slip)));
}

}  // namespace

std::string direction_words(const std::string& direction) {
  return direction.empty() ? "every direction" : direction;
}

const char* finding_word(Finding finding) {
  constexpr std::array words{"no cause",    "nominal machine", "cause identified", "undecided",
                             "unexplained", "mismatch",        "too few values",   "interrupted"};
  return words.at(static_cast<std::size_t>(finding));
}

std::string cause_name(const Cause& cause) {
  return of_cause(cause, &CauseWords::name, &CauseWords::name_of_leg);
}

std::string cause_statement(const Cause& cause) {
  return of_cause(cause, &CauseWords::statement, &CauseWords::statement_of_leg);
}

std::string hypothesis_name(const Diagnosis& d, const Hypothesis& e) {
  if (e.rigid) return "rigid-leg model";
  if (e.causes.empty()) return "nominal machine";
  std::vector<std::string> names;
  for (const auto k : e.causes) names.push_back(cause_name(d.causes[k]));
  return fmt::format("{}", fmt::join(names, " and "));
}

std::string part_name(const Part& part) {
  constexpr std::array one{"guide sleeve", "piston ring", "gimbals", "", "", "rod and case"};
  constexpr std::array all{"guide sleeves of all legs", "piston rings of all legs",
                           "gimbals of all legs",       "base mount",
                           "modes of the payload",      "bending of rods and cases of all legs"};
  const auto what = static_cast<std::size_t>(part.what);
  return part.leg ? fmt::format("{} of leg {}", one.at(what), *part.leg + 1) : all.at(what);
}

std::string amount_text(double value, double deviation, const std::string& unit) {
  const auto scale = scale_of(value, unit);
  std::string name = unit == "1" ? "" : fmt::format(" {}{}", scale.name, unit);
  if (unit == "m^3" && scale.size != 1.0) name = " l";
  const double shown = value / scale.size, spread = std::abs(deviation) / scale.size;
  if (!(spread > 0.0) || !std::isfinite(spread)) return fmt::format("{:.4g}{}", shown, name);
  constexpr int most = 9;
  const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(spread))));
  if (decimals > most) {  // leakage, 1e-12 m³/(s Pa)
    const auto exponent =
        static_cast<int>(std::floor(std::log10(std::max(std::abs(shown), spread))));
    const int digits = std::clamp(decimals + exponent, 0, most);
    const double power = std::pow(10.0, exponent);
    return fmt::format("({:.{}f} ± {:.{}f})e{}{}", shown / power, digits, spread / power, digits,
                       exponent, name);
  }
  return fmt::format("{:.{}f} ± {:.{}f}{}", shown, decimals, spread, decimals, name);
}

std::string range_text(double least, double greatest, const std::string& unit) {
  const auto from = amount_text(least, 0.0, unit), to = amount_text(greatest, 0.0, unit);
  return from == to ? from : from + " to " + to;
}

std::string sleeves_text(const RemedyPoint& point) {
  return range_text(point.softest.value_or(point.stiffness), point.stiffness, "N/m");
}

namespace {

/// What the file states: one value, or those of legs that differ.
std::string nominal_text(const calibration::FittedParameter& p) {
  const auto [least, greatest] = p.stated.value_or(std::array{p.start, p.start});
  return range_text(least, greatest, p.unit);
}

}  // namespace

std::vector<std::string> parameter_words(const Hypothesis& e) {
  using calibration::Verdict;
  std::vector<std::string> words;
  for (const auto& p : e.fit.parameters) {
    const bool bound = p.verdict == Verdict::at_bound, open = p.verdict == Verdict::undetermined;
    const std::string value =
        fmt::format("{} {}{}", fmt::join(p.paths, ", "),
                    amount_text(p.value, bound || open ? 0.0 : p.deviation, p.unit),
                    bound  ? ", at its bound"
                    : open ? ", not determined"
                           : "");
    // with overrides the search began elsewhere than at the file's value
    const std::string nominal = e.from_nominal ? fmt::format(" (nominal {})", nominal_text(p)) : "";
    // what a share of air does to the oil depends on how much it is compressed
    const bool air = e.air_pressure && p.paths.front().ends_with("air.fraction");
    words.push_back(
        value + nominal +
        (air ? fmt::format(" at {:.3g} bar chamber pressure", *e.air_pressure / bar) : ""));
  }
  return words;
}

std::vector<std::string> contradiction_words(const Diagnosis& d, const Hypothesis& e) {
  std::vector<std::string> words;
  for (const auto& contradiction : e.wrong) words.push_back(contradiction_text(d, contradiction));
  return words;
}

const Hypothesis* fits_anything(const Diagnosis& d) {
  const auto found = std::ranges::find_if(
      d.hypotheses, [&](const Hypothesis& e) { return e.parameters >= d.values; });
  return found == d.hypotheses.end() ? nullptr : &*found;
}

namespace {

/// Which kind of values the hypothesis misses most.
std::string worst_kind_text(const Goodness& g) {
  const auto* worst = &g.frequencies;
  const char* of = "frequencies";
  if (g.shapes.probability() < worst->probability())
    std::tie(worst, of) = std::tuple(&g.shapes, "shapes");
  if (g.responses.probability() < worst->probability())
    std::tie(worst, of) = std::tuple(&g.responses, "responses");
  return fmt::format("{} χ² {:.3g} with {} degrees of freedom: probability {:.1g}", of, worst->sum,
                     worst->degrees, g.probability);
}

/// Why the best hypothesis is none.
std::string unexplained_text(const Diagnosis& d) {
  const auto& e = d.judged();
  const auto best = fmt::format("even the best hypothesis ({})", hypothesis_name(d, e));
  switch (d.unexplained.value_or(why_unexplained(d, e).value_or(Unexplained::scatter))) {
    case Unexplained::scatter:
      return fmt::format("{} differs from the measured values by {:.{}f} σ", best, d.scatter,
                         d.scatter < 10.0 ? 1 : 0);
    case Unexplained::shapes_only:
      return "the frequencies are those of the nominal machine, and shapes or other values are "
             "not; check places, signs and directions of the sensors";
    case Unexplained::unlisted:
      return best +
             " explains the measured values no better than a change of each mode by an amount of "
             "its own would";
    case Unexplained::misfit:
      return fmt::format("{} misses the measured values by more than the uncertainties allow ({})",
                         best, worst_kind_text(goodness(d, e)));
    case Unexplained::untested:
      if (static_cast<int>(d.modes.size()) - e.parameters >= diagnosis::tested_by)
        return fmt::format(
            "{} fits {} numbers, and only {} frequencies are not those of the nominal machine",
            best, e.parameters, moved_frequencies(d));
      return fmt::format(
          "{} fits {} numbers to {} frequencies, and so many numbers fit most "
          "frequencies",
          best, e.parameters, d.modes.size());
    case Unexplained::at_bound:
      break;
  }
  return fmt::format("{} has a parameter at the bound of its range ({})", best,
                     fmt::join(parameter_words(e), "; "));
}

}  // namespace

std::vector<std::string> reason_words(const Diagnosis& d) {
  std::vector<std::string> words;
  for (const auto& objection : d.objections) words.push_back(objection_text(objection));
  if (!words.empty() || !d.equivalent.empty() || d.finding == Finding::interrupted) return words;
  if (d.finding == Finding::cannot_tell) {
    if (const auto* e = fits_anything(d)) {
      words.push_back(fmt::format(
          "{} fits {} numbers to {} measured values, and so many numbers fit any values",
          hypothesis_name(d, *e), e->parameters, d.values));
      words.push_back(
          "no candidate cause with fewer numbers explains them; measure more modes, "
          "shapes or poses");
      return words;
    }
    words.push_back(fmt::format("{} fits best: {}", hypothesis_name(d, d.best()),
                                fmt::join(parameter_words(d.best()), "; ")));
    words.push_back("one cause alone fits clearly worse; measure more modes, shapes or poses");
    return words;
  }
  words.push_back(unexplained_text(d));
  for (const auto& wrong : d.judged().wrong) {
    using Kind = Contradiction::Kind;
    const bool of_shape = wrong.kind == Kind::shape || wrong.kind == Kind::drives;
    const std::string_view subject = wrong.kind == Kind::value ? "" : of_shape ? "its " : "it ";
    words.push_back(fmt::format("{}{}", subject, contradiction_text(d, wrong)));
  }
  words.push_back(
      "possible reasons: a cause that is not a candidate, more than two causes, another pose, "
      "payload or machine, a model uncertainty above the allowed one");
  return words;
}

namespace {

/// Of the modes of the best hypothesis.
std::vector<std::string> direction_warnings(const Diagnosis& d) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < d.modes.size(); ++i) {
    const auto& mode = d.modes[i];
    if (mode.mode_direction < 0) continue;
    words.push_back(fmt::format(
        "the direction {} stated for {:.2f} Hz{} contradicts the mode paired with it, which mainly "
        "moves the platform in {}; check the directions of the measurement",
        direction_name(mode.direction), mode.omega / two_pi, at_pose(d, mode.pose),
        direction_name(mode.mode_direction)));
  }
  return words;
}

}  // namespace

namespace {

/// One sentence for all causes that were not tested for the same reason. Pairs are in JSON alone.
std::vector<std::string> untested_words(const Diagnosis& d) {
  constexpr std::size_t shown = 6;
  std::vector<std::pair<std::string, std::vector<std::string>>> by_error;
  for (const auto& [causes, error] : d.untested) {
    if (causes.size() > 1) continue;
    auto group = std::ranges::find(by_error, error, [](const auto& one) { return one.first; });
    if (group == by_error.end()) group = by_error.insert(group, {error, {}});
    group->second.push_back(hypothesis_name(d, {.causes = causes}));
  }
  std::vector<std::string> words;
  for (auto& [error, names] : by_error) {
    const std::size_t more = names.size() > shown ? names.size() - shown : 0;
    names.resize(names.size() - more);
    words.push_back(fmt::format("not tested: {}{}: {}", fmt::join(names, ", "),
                                more > 0 ? fmt::format(" and {} more", more) : "", error));
  }
  return words;
}

}  // namespace

namespace {

std::string mode_text(const Diagnosis& d, const MeasuredMode& mode) {
  return fmt::format(
      "{:.2f} Hz{}{}", mode.omega / two_pi,
      mode.direction < 0 ? "" : fmt::format(" in {}", direction_name(mode.direction)),
      at_pose(d, mode.pose));
}

/// Modes that are there twice, one mode that does not belong to the others, another pose.
std::vector<std::string> slip_words(const Diagnosis& d) {
  std::vector<std::string> words;
  const bool settled = d.finding == Finding::nominal || d.finding == Finding::nothing_to_blame;
  for (std::size_t i = 0; i < d.modes.size() && !settled; ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const auto &one = d.modes[k], &other = d.modes[i];
      if (one.pose != other.pose || one.direction != other.direction || one.direction < 0 ||
          one.omega != other.omega)
        continue;
      words.push_back(fmt::format("the mode at {} is listed twice (modes {} and {})",
                                  mode_text(d, one), k + 1, i + 1));
    }
  if (d.odd_mode > 0 && static_cast<std::size_t>(d.odd_mode) <= d.modes.size())
    words.push_back(fmt::format(
        "without the mode at {} the nominal machine explains the measurement; check this mode",
        mode_text(d, d.modes[static_cast<std::size_t>(d.odd_mode) - 1])));
  if (!d.nominal_at.empty() && !d.modes.empty())
    words.push_back(
        fmt::format("the measured modes are those of the nominal machine at pose {}; "
                    "check the pose, which is stated as {}",
                    fmt::join(d.nominal_at, " or "), d.modes.front().pose));
  return words;
}

}  // namespace

std::vector<std::string> note_words(const Diagnosis& d) {
  auto words = slip_words(d);
  std::ranges::copy(direction_warnings(d), std::back_inserter(words));
  std::ranges::copy(untested_words(d), std::back_inserter(words));
  if (!d.substitution) return words;
  const auto& [measured, error] = *d.substitution;
  words.push_back(fmt::format(
      "compared with mechanics on oil springs, though the {} was measured: the nominal machine "
      "with its hydraulics: {}",
      measured == observation::Observed::plant ? "plant from the drives of the valves"
                                               : "machine under its controller",
      error.empty() ? "there are fewer computed than measured modes" : error));
  return words;
}

}  // namespace hydrapod::report
