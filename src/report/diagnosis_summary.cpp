#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "hydrapod/base/units.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::report {

namespace {

using namespace diagnosis;

using base::two_pi;
constexpr double notable_drop = 0.01;
constexpr const char* interrupted = "Interrupted before all results were computed.";

std::string frequency_text(double omega) {
  return fmt::format("{:.{}f} Hz", omega / two_pi, omega < 10.0 * two_pi ? 2 : 1);
}

std::string share_text(double share) {
  return fmt::format("{:.{}f} %", 100.0 * share, std::abs(share) < 0.1 ? 1 : 0);
}

std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 32);
  return text;
}

/// Of a mode with rigid legs, how much of its motion a resonance holds and how high it stands.
std::string weight_text(double mac, double omega, double omega_rigid) {
  return fmt::format("{:.0f} % of the motion, peak {:.2f} times as high at equal damping ratios",
                     100.0 * mac, report::peak_height(mac, omega, omega_rigid));
}

/// First measured resonance of every direction at a pose.
void add_drops(const Diagnosis& d, std::vector<std::string>& words) {
  std::map<std::pair<std::string, int>, const MeasuredMode*> first;
  for (const auto& mode : d.modes) {
    if (mode.direction < 0 || mode.mode_direction >= 0 || !mode.resonance) continue;
    auto& lowest = first[{mode.pose, mode.direction}];
    if (lowest == nullptr || mode.omega < lowest->omega) lowest = &mode;
  }
  // directions with equal drops are reported together
  std::vector<std::pair<const MeasuredMode*, std::vector<std::string>>> groups;
  for (const auto& entry : first) {
    const MeasuredMode* mode = entry.second;
    if (mode->drop() < notable_drop) continue;
    const auto same_as = std::ranges::find_if(groups, [&](const auto& group) {
      return group.first->pose == mode->pose &&
             std::abs(std::log(group.first->omega / mode->omega)) < notable_drop &&
             std::abs(group.first->drop() - mode->drop()) < notable_drop;
    });
    if (same_as == groups.end())
      groups.push_back({mode, {direction_name(mode->direction)}});
    else
      same_as->second.push_back(direction_name(mode->direction));
  }
  std::ranges::stable_sort(
      groups, [](const auto& a, const auto& b) { return a.first->drop() > b.first->drop(); });
  constexpr std::size_t most = 3;
  for (std::size_t k = 0; k < std::min(most, groups.size()); ++k) {
    const auto& [mode, names] = groups[k];
    words.push_back(fmt::format(
        "At pose {} the {} {} measured at {} {} {} below the rigid-leg model ({}; {}).", mode->pose,
        fmt::join(names, " and "), names.size() > 1 ? "resonances" : "resonance",
        frequency_text(mode->omega), names.size() > 1 ? "lie" : "lies", share_text(mode->drop()),
        frequency_text(mode->omega_rigid),
        weight_text(mode->rigid_mac, mode->omega, mode->omega_rigid)));
  }
  if (groups.empty() && !d.modes.empty())
    words.push_back(
        "No measured first resonance of a direction lies 1 % or more below the rigid-leg model.");
}

/// Which compliance a measured resonance comes from, when it is not the platform on its oil.
void add_origins(const Diagnosis& d, std::vector<std::string>& words) {
  constexpr double main_part = 0.4;
  struct Origin {
    const char* part;
    double MeasuredMode::*share;
  };
  constexpr std::array origins{Origin{"guide sleeves", &MeasuredMode::guide_sleeves},
                               Origin{"piston rings", &MeasuredMode::piston_rings},
                               Origin{"base", &MeasuredMode::base},
                               Origin{"modes of the payload", &MeasuredMode::payload},
                               Origin{"bending of rods and cases", &MeasuredMode::bending}};
  for (const auto& origin : origins) {
    std::vector<std::string> modes;
    for (const auto& mode : d.modes) {
      const double share = mode.*origin.share;
      const bool is_most = std::ranges::all_of(
          origins, [&](const Origin& other) { return share >= mode.*other.share; });
      if (share < main_part || !is_most || mode.direction < 0) continue;
      const auto text =
          fmt::format("{} at {}", direction_name(mode.direction), frequency_text(mode.omega));
      if (std::ranges::count(modes, text) == 0) modes.push_back(text);
    }
    constexpr std::size_t shown = 6;
    if (modes.empty()) continue;
    const std::size_t more = modes.size() > shown ? modes.size() - shown : 0;
    modes.resize(modes.size() - more);
    words.push_back(fmt::format(
        "From the {} {} the {} in {}{}.", origin.part, modes.size() + more > 1 ? "come" : "comes",
        modes.size() + more > 1 ? "resonances" : "resonance", fmt::join(modes, ", "),
        more > 0 ? fmt::format(" and {} more", more) : ""));
  }
}

/// Causes that are not it, one of each family, with why.
void add_innocents(const Diagnosis& d, std::vector<std::string>& words) {
  if (d.finding == Finding::nothing_to_blame || d.finding == Finding::nominal) return;
  std::set<Family> told;
  for (const auto k : d.equivalent)
    for (const auto s : d.hypotheses[k].causes) told.insert(d.causes[s].family());
  constexpr std::size_t most = 3;
  std::size_t count = 0;
  for (const auto& e : d.hypotheses) {
    if (e.causes.size() != 1 || e.wrong.empty() || count == most) continue;
    const auto& cause = d.causes[e.causes.front()];
    if (cause.leg || !told.insert(cause.family()).second) continue;
    words.push_back(
        fmt::format("Excluded: {}: {}.", hypothesis_name(d, e), contradiction_words(d, e).front()));
    ++count;
  }
}

std::string equivalent_words(const Diagnosis& d) {
  constexpr std::size_t shown = 4;
  const std::size_t count = d.equivalent.size();
  std::string names;
  for (std::size_t k = 0; k < std::min(shown, count); ++k) {
    const bool last = k > 0 && k + 1 == count;
    names += (k == 0 ? ""
              : last ? " and "
                     : ", ") +
             hypothesis_name(d, d.hypotheses[d.equivalent[k]]);
  }
  if (count > shown) names += fmt::format(" and {} more", count - shown);
  return names;
}

void add_discriminators(const Diagnosis& d, std::vector<std::string>& words) {
  constexpr std::size_t most = 3;
  constexpr double enough = 3.0;
  for (std::size_t k = 0; k < std::min(most, d.discriminators.size()); ++k) {
    const auto& x = d.discriminators[k];
    const auto best = hypothesis_name(d, d.hypotheses[d.equivalent.front()]);
    const auto other = hypothesis_name(d, d.hypotheses[x.other]);
    if (x.deviations < enough)
      words.push_back(
          fmt::format("No offered pose distinguishes {} from {}: their resonances differ by at "
                      "most {:.1f} σ of a measurement.",
                      best, other, x.deviations));
    else
      words.push_back(
          fmt::format("A measurement at pose {} in direction {} distinguishes {} ({}) from {} "
                      "({}): the difference is {:.0f} σ.",
                      x.pose, direction_name(x.direction), best, frequency_text(x.omega_best),
                      other, frequency_text(x.omega_other), x.deviations));
  }
}

/// Which machine attribution and remedy are of.
const char* machine_word(const CaseFile& file) { return file.fitted ? "fitted" : "nominal"; }

/// Those of the machine, and of a fitted machine what the file states beside them.
std::string sleeve_words(const CaseFile& file) {
  const auto present = sleeves_text(file.remedy->today);
  const auto& [stiffest, softest] = file.nominal_sleeves;
  const auto nominal = range_text(softest.value_or(stiffest), stiffest, "N/m");
  if (!file.fitted || !(stiffest > 0.0) || nominal == present) return present;
  return fmt::format("{} (nominal {})", present, nominal);
}

/// Of which modes the calculated frequencies are. Where the measurement was not of mechanics,
/// frequencies of mechanics are others.
std::string alone_words(const CaseFile& file) {
  const auto kind = study::frequency_kind(file.machine);
  const bool other =
      file.diagnosis && file.diagnosis->targets.observed != observation::Observed::mechanics;
  return other ? fmt::format(" (mechanics alone, {} modes, at the pressures in the file)", kind)
               : fmt::format(" ({} modes)", kind);
}

/// Modes below the first resonances, which hold a smaller share: those with the highest peaks. True
/// where there are any.
bool add_lower_modes(const CaseFile& file, std::vector<std::string>& words) {
  constexpr std::size_t most = 3;
  const auto peak = [](const FirstResonance* r) {
    return report::peak_height(r->below->mac, r->below->omega, r->omega_rigid);
  };
  std::vector<const FirstResonance*> all;
  for (const auto& drop : file.drops)
    if (drop.resonance.below && drop.resonance.below->omega < drop.resonance.omega_rigid)
      all.push_back(&drop.resonance);
  std::ranges::stable_sort(all, [&](const auto* a, const auto* b) { return peak(a) > peak(b); });
  for (std::size_t k = 0; k < std::min(most, all.size()); ++k) {
    const auto& r = *all[k];
    words.push_back(fmt::format(
        "Calculated at pose {} for the {} machine{}: a mode at {}, {} below the rigid-leg model, "
        "holds a smaller part of {} ({}). The {} resonance is at {} ({}).",
        file.pose, machine_word(file), alone_words(file), frequency_text(r.below->omega),
        share_text(1.0 - r.below->omega / r.omega_rigid), r.direction,
        weight_text(r.below->mac, r.below->omega, r.omega_rigid), r.direction,
        frequency_text(r.omega), weight_text(r.mac, r.omega, r.omega_rigid)));
  }
  return !all.empty();
}

void add_attribution(const CaseFile& file, bool brief, std::vector<std::string>& words) {
  constexpr std::size_t most = 3;
  if (std::ranges::any_of(file.drops, [](const auto& d) { return d.resonance.omega == 0.0; })) {
    words.push_back(fmt::format("Calculated at pose {} for the {} machine{}: the legs fold.",
                                file.pose, machine_word(file), alone_words(file)));
    return;
  }
  std::vector<const AttributedDrop*> drops;
  for (const auto& drop : file.drops)
    if (drop.resonance.drop() >= notable_drop && !drop.parts.empty()) drops.push_back(&drop);
  std::ranges::stable_sort(drops, [](const auto* a, const auto* b) {
    return a->resonance.drop() > b->resonance.drop();
  });
  for (std::size_t k = 0; k < std::min(most, drops.size()); ++k) {
    const auto& drop = *drops[k];
    std::vector<std::string> parts;
    constexpr double told = 0.05;
    for (const auto& part : drop.parts)
      if (!part.part.leg && std::abs(part.share) >= told)
        parts.push_back(fmt::format("{} {}", part_name(part.part), share_text(part.share)));
    words.push_back(fmt::format(
        "Calculated at pose {} for the {} machine{}: the {} resonance is at {}, {} below "
        "its rigid-leg model ({}). Share of the frequency drop: {}.",
        file.pose, machine_word(file), alone_words(file), drop.resonance.direction,
        frequency_text(drop.resonance.omega), share_text(drop.resonance.drop()),
        weight_text(drop.resonance.mac, drop.resonance.omega, drop.resonance.omega_rigid),
        parts.empty() ? "no part alone" : fmt::format("{}", fmt::join(parts, ", "))));
  }
  const bool lower = (!brief || drops.empty()) && add_lower_modes(file, words);
  if (drops.empty() && !lower && !file.drops.empty())
    words.push_back(fmt::format(
        "Calculated at pose {} for the {} machine{}: rigid seals, gimbals and base would raise no "
        "resonance by 1 %.",
        file.pose, machine_word(file), alone_words(file)));
}

/// Of sleeves that will do today: stiffer ones may put their own resonances where they do harm.
std::string stiffer_words(const CaseFile& file) {
  const auto& r = *file.remedy;
  const RemedyPoint *from = nullptr, *to = nullptr;
  for (const auto& point : r.curve) {
    const bool misses =
        file.goal.drop ? point.drop > *file.goal.drop : point.omega < file.goal.omega.value_or(0.0);
    if (point.factor <= 1.0 || !misses) continue;
    if (from == nullptr || point.factor < from->factor) from = &point;
    if (to == nullptr || point.factor > to->factor) to = &point;
  }
  if (to == nullptr) return "";
  if (r.today.softest)
    return fmt::format(" Stiffer guide sleeves, from about {:.3g} to {:.3g} times, miss the goal.",
                       from->factor, to->factor);
  return fmt::format(" Stiffer guide sleeves, from about {} to {}, miss the goal.",
                     sleeves_text(*from), sleeves_text(*to));
}

/// Where rods and cases bend: what stiffer sleeves cannot get beyond.
std::string bending_words(const Remedy& r) {
  if (!r.limit_without_bending) return "";
  const auto& without = *r.limit_without_bending;
  const auto small = [](double drop) { return fmt::format("{:.2g} %", 100.0 * drop); };
  return fmt::format(
      " Bending of rods and cases limits what stiffer guide sleeves give to {} and a drop of {} "
      "({}); with rods and cases that do not bend, rigid guide sleeves would give {} and {}.",
      frequency_text(r.limit.omega), small(r.limit.drop),
      weight_text(r.limit.mac, 1.0 - r.limit.drop, 1.0), frequency_text(without.omega),
      small(without.drop));
}

std::string remedy_words(const CaseFile& file) {
  const auto& r = *file.remedy;
  const std::string goal = goal_words(file.goal);
  const auto stiffness = sleeves_text(r.needed);
  const auto present = sleeve_words(file);
  if (r.status == RemedyStatus::out_of_reach)
    return fmt::format(
        "No stiffness of the guide sleeves reaches {}: rigid guide sleeves give {} and a drop of "
        "{} of a resonance with {} (pose {}, {}).{}",
        goal, frequency_text(r.limit.omega), share_text(r.limit.drop),
        weight_text(r.limit.mac, 1.0 - r.limit.drop, 1.0), r.pose, direction_words(r.direction),
        bending_words(r));
  constexpr double far = 0.01;
  if (r.status == RemedyStatus::met_already) {
    const bool softer = r.needed.factor < far;
    const auto enough =
        softer ? "much less is sufficient" : "at least " + stiffness + " is required";
    return fmt::format(
        "The stiffness of the guide sleeves of the {} machine, {}, is sufficient for {}; {}.{}{}",
        machine_word(file), present, goal, enough, stiffer_words(file), bending_words(r));
  }
  return fmt::format(
      "Required stiffness of the guide sleeves for {}: at least {}, {:.3g} times that of the {} "
      "machine, {}; highest demand at pose {} in {}.{}",
      goal, stiffness, r.needed.factor, machine_word(file), present, r.pose,
      direction_words(r.direction), bending_words(r));
}

std::string finding_sentence(const Diagnosis& d) {
  switch (d.finding) {
    case Finding::nothing_to_blame:
      return "No cause: the rigid-leg model explains the measurement.";
    case Finding::nominal:
      return "The nominal machine explains the measurement: the frequency drop comes from the "
             "compliances in the file.";
    case Finding::identified: {
      const auto& best = d.hypotheses[d.equivalent.front()];
      std::vector<std::string> statements;
      for (const auto s : best.causes) statements.push_back(cause_statement(d.causes[s]));
      return fmt::format("Identified cause: {}; {}.", fmt::join(statements, ", and "),
                         fmt::join(parameter_words(best), "; "));
    }
    case Finding::undecided:
      return fmt::format("{} explain the data equally well.", capital(equivalent_words(d)));
    case Finding::unexplained:
      return "No candidate cause explains the measurement; no cause is identified.";
    case Finding::cannot_tell:
      if (fits_anything(d) == nullptr)
        return "The data cannot tell the cause: the hypothesis that fits best contains a number "
               "that they leave open.";
      return fmt::format(
          "The data cannot tell the cause: {} measured values are too few for the candidate causes "
          "that explain them.",
          d.values);
    case Finding::interrupted:
      return fmt::format(
          "Interrupted: not all hypotheses were tried; no cause is identified. The {} that were "
          "tried are listed, best first.",
          d.hypotheses.size());
    case Finding::do_not_belong:
      break;
  }
  return "Measurement and machine file do not match; no cause is identified.";
}

/// Why there is neither attribution nor remedy; of the machine alone, without a measurement.
std::string nothing_to_attribute(const CaseFile& file) {
  const bool struts = model::leg_type(file.machine) == model::LegType::strut;
  return fmt::format(
      "There is no frequency drop to attribute and no stiffness of guide sleeves to require: {}. "
      "Other causes are sought with a measurement (--measured).",
      struts ? "plain struts have no seals" : "the legs of the rigid model do not bend");
}

}  // namespace

std::string goal_words(const RemedyGoal& goal) {
  const std::string where =
      goal.direction ? fmt::format(" in {}", direction_name(*goal.direction)) : "";
  if (goal.drop) return fmt::format("a drop of at most {}{}", share_text(*goal.drop), where);
  return fmt::format("at least {}{}", frequency_text(goal.omega.value_or(0.0)), where);
}

std::vector<std::string> summary(const CaseFile& file, bool brief) {
  std::vector<std::string> words;
  if (file.diagnosis) {
    const auto& d = *file.diagnosis;
    words.push_back(finding_sentence(d));
    if (d.equivalent.empty()) {
      for (const auto& reason : reason_words(d)) words.push_back(capital(reason) + ".");
      if (d.finding == Finding::unexplained || d.finding == Finding::cannot_tell)
        add_drops(d, words);
      for (const auto& note : note_words(d)) words.push_back(capital(note) + ".");
      return words;
    }
    if (d.finding == Finding::undecided)
      for (std::size_t k = 0; k < std::min<std::size_t>(4, d.equivalent.size()); ++k) {
        const auto& e = d.hypotheses[d.equivalent[k]];
        words.push_back(fmt::format("{}: {}.", capital(hypothesis_name(d, e)),
                                    fmt::join(parameter_words(e), "; ")));
      }
    for (const auto& note : note_words(d)) words.push_back(capital(note) + ".");
    add_discriminators(d, words);
    add_drops(d, words);
    add_origins(d, words);
    add_innocents(d, words);
    if (d.targets.observed != observation::Observed::mechanics && !d.equivalent.empty() &&
        d.hypotheses[d.equivalent.front()].by_mechanics)
      words.push_back(
          "This machine cannot be computed with its hydraulics. It was fitted as mechanics on oil "
          "springs. The measured frequencies were multiplied by the ratio of mechanics to measured "
          "system of the nominal machine.");
    if (d.interrupted) words.push_back(interrupted);
  }
  if (!file.diagnosis && file.kind == dynamics::ModelKind::rigid)
    words.push_back(nothing_to_attribute(file));
  if (!brief || !file.diagnosis) add_attribution(file, brief, words);
  if (file.remedy) words.push_back(remedy_words(file));
  return words;
}

}  // namespace hydrapod::report
