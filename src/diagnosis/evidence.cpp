#include "evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/model/section.hpp"
#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::diagnosis {

namespace {

using observation::ModeTarget;
using observation::Targets;

/// What the platform mostly does in a shape, by kinetic energy.
int main_direction(const model::Machine& machine, const ModeTarget& mode) {
  const auto* pose = find_pose(machine, mode.pose);
  if (pose == nullptr) return 0;  // said by the fit
  return observation::main_direction(
      machine, pose->X_BP, mode.shape_point.value_or(machine.platform.mass_center), *mode.shape);
}

}  // namespace

Targets weighted_targets(const model::MachineFile& file, const Targets& measured,
                         const DiagnoseOptions& options) {
  Targets targets = measured;
  targets.deviations_given = true;
  for (auto& mode : targets.modes) {
    const double own = measured.deviations_given ? mode.deviation : 0.0;
    const double model = options.frequency_error * mode.omega;
    mode.deviation = std::hypot(own, model);
    mode.common_deviation = std::sqrt(options.common_share) * model;
    if (mode.shape) {
      mode.shape_deviation = std::hypot(mode.shape_deviation, options.shape_error);
      if (mode.complex_shape)
        mode.complex_shape->deviation =
            std::hypot(mode.complex_shape->deviation, options.shape_error);
      if (!mode.direction) mode.direction = main_direction(file.machine, mode);
    }
    if (mode.damping && options.damping)
      mode.damping_deviation =
          std::hypot(mode.damping_deviation, options.damping_error * *mode.damping);
    if (!options.damping) mode.damping.reset();
  }
  return targets;
}

int values_in(const Targets& targets) {
  int count = 0;
  for (const auto& mode : targets.modes) count += 1 + (mode.damping ? 1 : 0) + (mode.shape ? 5 : 0);
  for (const auto& response : targets.responses) count += response.values;
  return count;
}

bool beyond_mechanics(const Targets& targets) {
  return targets.observed != observation::Observed::mechanics || !targets.responses.empty();
}

dynamics::ModelKind Evidence::kind_with(const std::vector<std::size_t>& causes) const {
  const bool rings =
      std::ranges::any_of(causes, [&](std::size_t k) { return causes_[k].needs_rings(); });
  return rings ? dynamics::ModelKind::full : kind_;
}

std::optional<std::string> plant_refused(const model::MachineFile& file, const Targets& targets,
                                         dynamics::ModelKind kind) {
  try {
    const auto fit = calibration::compare(file, targets, kind);
    if (fit.fitted) return std::nullopt;
    for (const auto& pose : file.machine.poses)
      if (std::ranges::count(targets.modes, pose.name, &ModeTarget::pose) > 0)
        static_cast<void>(observation::observe(file.machine, pose.X_BP, kind, targets.observed));
    return "";
  } catch (const base::InputError& error) {
    return error.diagnostics().front().message;
  } catch (const base::ComputationError& error) {
    return error.what();
  }
}

Evidence::Evidence(const model::MachineFile& file, const Targets& targets, dynamics::ModelKind kind,
                   const std::vector<Cause>& causes)
    : file_(file), targets_(targets), kind_(kind), causes_(causes) {
  stated_.kind = kind_;
  stated_.fit = calibration::compare(file_, targets_, kind_);
  if (!stated_.fit.fitted) throw base::ComputationError("the nominal machine has no modes");
  stated_.misfit = stated_.fit.misfit;
  by_mechanics_ = for_mechanics();
}

/// Each frequency times that of the mode of mechanics which is most like the plant's.
Targets Evidence::for_mechanics() const {
  Targets targets = targets_;
  targets.responses.clear();
  if (targets_.observed == observation::Observed::mechanics) return targets;
  targets.observed = observation::Observed::mechanics;
  const auto& machine = file_.machine;
  for (std::size_t p = 0; p < machine.poses.size(); ++p) {
    const auto& pose = machine.poses[p];
    std::optional<calibration::ModePoint> modes;
    for (std::size_t i = 0; i < targets.modes.size(); ++i) {
      if (targets.modes[i].pose != pose.name) continue;
      if (!modes) modes = calibration::mode_point(machine, p, kind_);
      const auto& fit = stated_.fit.targets[i];
      const double ratio = modes->omega(fit.mode) / fit.omega;
      targets.modes[i].omega *= ratio;
      targets.modes[i].damped = false;
      targets.modes[i].deviation *= ratio;
      targets.modes[i].common_deviation *= ratio;
    }
  }
  return targets;
}

Hypothesis Evidence::rigid() const {
  constexpr double like_rigid = 1e15;      // [N/m], [N m/rad]
  constexpr double stiffer_payload = 1e3;  // in frequency: 1e6 in stiffness
  Hypothesis e{.rigid = true, .kind = kind_};
  const auto set = [&](const std::string& path, double value) {
    e.changes.push_back({*find_parameter(file_, path), value});
  };
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = file_.machine.legs[static_cast<std::size_t>(i)];
    const auto path = [&](const char* rest) { return fmt::format("leg.{}.{}", i + 1, rest); };
    constexpr double stiffer = 1e6;
    if (!leg.strut) set(path("guide_sleeve.stiffness"), stiffer * leg.guide_sleeve.stiffness);
    if (leg.piston_ring) set(path("piston_ring.stiffness"), stiffer * leg.piston_ring->stiffness);
    if (leg.gimbal_stiffness) set(path("gimbal_stiffness"), like_rigid);
    if (leg.bending == model::LegBending::elastic)
      set(path("rod.youngs_modulus"), stiffer * leg.rod.youngs_modulus);
  }
  if (file_.machine.base_mount)
    for (int k = 0; k < 6; ++k)
      if (file_.machine.base_mount->stiffness[static_cast<std::size_t>(k)])
        set(fmt::format("base.mount.stiffness.{}", direction_name(k)), like_rigid);
  for (const auto& mode : file_.machine.payload_modes)
    set(fmt::format("payload_modes.{}.frequency", model::written_key(mode.name)),
        stiffer_payload * mode.frequency);
  const auto file = file_with(e);
  e.by_mechanics = beyond_mechanics(targets_) && plant_refused(file, targets_, kind_).has_value();
  e.fit = calibration::compare(file, e.by_mechanics ? by_mechanics_ : targets_, kind_);
  if (!e.fit.fitted) throw base::ComputationError("the rigid-leg model has no modes");
  e.misfit = e.fit.misfit;
  return e;
}

/// Numbers of all legs may have to be found over decades, and the pairing of modes changes on the
/// way; what is known of one cause is a good start for most others.
int Evidence::starts_for(const std::vector<std::size_t>& causes, bool known) const {
  constexpr int very_wide = 128, wide = 16, ordinary = 6, few = 3;
  const bool single_numbers = std::ranges::all_of(
      causes, [&](std::size_t k) { return causes_[k].free.size() == 1 && !causes_[k].leg; });
  const auto seals = std::ranges::count_if(causes, [&](std::size_t k) {
    const auto family = causes_[k].family();
    return family == Family::guide_sleeves || family == Family::piston_rings;
  });
  if (single_numbers && seals == 2) return very_wide;
  if (single_numbers && (causes.size() == 1 || seals == 1)) return wide;
  return known ? few : ordinary;
}

model::MachineFile Evidence::file_with(const Hypothesis& e) const {
  auto file = file_;
  model::assign(file.machine, e.changes);
  return file;
}

namespace {

/// Of what two fits let free, a number of `from` becomes that of `fit`.
void take_numbers(double calibration::FittedParameter::*number, const calibration::Candidate& from,
                  calibration::Candidate& fit) {
  for (auto& p : fit.parameters)
    for (const auto& known : from.parameters)
      if (known.paths == p.paths) p.*number = known.*number;
}

/// A fit that began elsewhere still differs from what the file states.
void keep_stated(const calibration::Candidate& from, calibration::Candidate& fit) {
  take_numbers(&calibration::FittedParameter::start, from, fit);
}

/// A fit to everything that was measured becomes that of the hypothesis.
void take(calibration::Candidate fit, Hypothesis& e) {
  keep_stated(e.fit, fit);
  e.fit = std::move(fit);
  e.misfit = e.fit.misfit;
  e.by_mechanics = false;
}

}  // namespace

Hypothesis Evidence::search(const std::vector<std::size_t>& causes, const Targets& targets,
                            const Hypothesis* known, const numerics::Progress& stop) const {
  Hypothesis e{.causes = causes, .kind = kind_with(causes)};
  calibration::Plan plan;
  constexpr int kept = 3;
  constexpr double enough = 1e-6;  // of a misfit, whose differences count from 1 on
  plan.options.starts = starts_for(causes, known != nullptr);
  plan.options.kept = plan.options.starts > 16 ? 2 * kept : kept;
  plan.options.tolerance = enough;
  plan.options.threads = 1;
  plan.options.loss = calibration::Loss::squares;
  for (const auto k : causes) {
    const auto& cause = causes_[k];
    e.changes.insert(e.changes.end(), cause.changes.begin(), cause.changes.end());
    for (auto free : cause.free) {
      if (known != nullptr)
        for (const auto& p : known->fit.parameters)
          if (p.paths == free.paths) free.start = std::clamp(p.value, p.lower, p.upper);
      plan.free.push_back(free);
    }
  }
  // a change of what is let free: the search began elsewhere than at the file's value
  e.from_nominal = std::ranges::none_of(plan.free, [&](const auto& free) {
    const auto id = find_parameter(file_, free.paths.front());
    return std::ranges::any_of(e.changes, [&](const auto& change) { return change.id == id; });
  });
  if (std::ranges::any_of(causes,
                          [&](std::size_t k) { return causes_[k].kind == Cause::Kind::air; }))
    e.air_pressure = file_with(e).machine.legs[0].oil_spring.cylinder->air->pressure;
  e.fit = calibration::calibrate(file_with(e), targets, plan, e.kind, stop).best();
  if (known != nullptr) keep_stated(known->fit, e.fit);
  e.misfit = e.fit.misfit;
  e.parameters = static_cast<int>(plan.free.size());
  e.by_mechanics = in_two_steps();
  return e;
}

calibration::Candidate Evidence::refit(const Hypothesis& e, const Targets& targets,
                                       bool from_stated, const numerics::Progress& stop) const {
  constexpr int enough = 15;
  constexpr double near_enough = 1e-4;  // of a misfit, whose differences count from 1 on
  calibration::Plan plan;
  plan.options = {.starts = 1,
                  .loss = calibration::Loss::squares,
                  .max_iterations = enough,
                  .tolerance = near_enough,
                  .threads = 1};
  std::size_t at = 0;
  for (const auto k : e.causes)
    for (auto free : causes_[k].free) {
      const auto& p = e.fit.parameters[at++];
      if (!from_stated) free.start = std::clamp(p.value, p.lower, p.upper);
      // bounds that follow from the start stay those of the search
      free.lower = p.lower;
      free.upper = p.upper;
      plan.free.push_back(free);
    }
  return calibration::calibrate(file_with(e), targets, plan, e.kind, stop).best();
}

std::optional<calibration::Candidate> Evidence::sound_refit(const Hypothesis& e,
                                                            const Targets& targets,
                                                            bool from_stated,
                                                            const numerics::Progress& stop) const {
  std::optional<calibration::Candidate> fit;
  const bool sound = if_possible([&] {
    fit = refit(e, targets, from_stated, stop);
    static_cast<void>(file_of(file_, {.changes = e.changes, .fit = *fit}));
  });
  return sound ? std::move(fit) : std::nullopt;
}

void Evidence::polish(Hypothesis& e, const Targets& targets, bool and_stated,
                      const numerics::Progress& stop) const {
  if (!beyond_mechanics(targets)) return;
  auto best = sound_refit(e, targets, false, stop);
  if (and_stated) {
    auto other = sound_refit(e, targets, true, stop);
    if (other && (!best || other->misfit < best->misfit)) best = std::move(other);
  }
  if (best) take(std::move(*best), e);
}

void Evidence::polish(Hypothesis& e, bool and_stated, const numerics::Progress& stop) const {
  polish(e, targets_, and_stated, stop);
}

std::optional<calibration::Candidate> Evidence::seen(const Hypothesis& e) const {
  calibration::Candidate fit;
  if_possible([&] { fit = calibration::compare(file_of(file_, e), targets_, e.kind); });
  return fit.fitted ? std::optional(std::move(fit)) : std::nullopt;
}

void Evidence::see(Hypothesis& e) const {
  if (!in_two_steps()) return;
  auto fit = seen(e);
  if (!fit) return;
  e.fit.targets = std::move(fit->targets);
  e.fit.responses = std::move(fit->responses);
  e.misfit = e.fit.misfit = fit->misfit;
  e.by_mechanics = false;
}

bool same_numbers(const Hypothesis& a, const Hypothesis& b) {
  constexpr double another = 0.02;
  for (const auto& p : a.fit.parameters)
    for (const auto& q : b.fit.parameters)
      if (p.paths == q.paths && std::abs(p.value - q.value) > another * std::abs(q.value))
        return false;
  return true;
}

void Evidence::learn(Hypothesis& e, const std::vector<std::vector<const Hypothesis*>>& found,
                     const numerics::Progress& stop) const {
  std::optional<Hypothesis> best;
  const auto consider = [&](const std::vector<const Hypothesis*>& from) {
    if (std::ranges::all_of(from, [&](const auto* one) { return same_numbers(*one, e); })) return;
    auto other = e;
    for (const auto* one : from)
      take_numbers(&calibration::FittedParameter::value, one->fit, other.fit);
    const auto fit = seen(other);
    if (!fit || !(fit->misfit < (best ? best->misfit : e.misfit))) return;
    other.misfit = fit->misfit;
    best = std::move(other);
  };
  std::vector<const Hypothesis*> together;
  for (const auto k : e.causes) {
    for (const auto* one : found[k]) consider({one});
    if (!found[k].empty()) together.push_back(found[k].front());
  }
  if (together.size() > 1) consider(together);
  if (!best) return;
  auto fit = sound_refit(*best, targets_, false, stop);
  if (fit && fit->misfit < e.misfit) take(std::move(*fit), e);
}

bool Evidence::has_damped_seals(const Cause& cause) const {
  const auto is_damped = [&](const model::Leg& leg) {
    const auto loses = [](const auto& seal) { return seal.damping > 0.0 || seal.elastomer; };
    if (cause.family() == Family::guide_sleeves) return loses(leg.guide_sleeve);
    return cause.family() == Family::piston_rings && leg.piston_ring && loses(*leg.piston_ring);
  };
  const auto& legs = file_.machine.legs;
  return cause.leg ? is_damped(legs[static_cast<std::size_t>(*cause.leg)])
                   : std::ranges::any_of(legs, is_damped);
}

void Evidence::scan_seals(Hypothesis& e, const numerics::Progress& stop) const {
  if (!in_two_steps() || e.causes.size() != 1 || e.fit.parameters.size() != 1 ||
      !has_damped_seals(causes_[e.causes[0]]))
    return;
  constexpr double step = 1.7, softest = 1e-3;  // a refit finds a minimum from there
  const auto& known = e.fit.parameters[0];
  std::optional<Hypothesis> best;
  for (double value = known.start; value > std::max(known.lower, softest * known.start);
       value /= step) {
    auto other = e;
    other.fit.parameters[0].value = value;
    const auto fit = seen(other);
    if (!fit || !(fit->misfit < (best ? best->misfit : e.misfit))) continue;
    other.misfit = fit->misfit;
    best = std::move(other);
  }
  if (!best) return;
  auto fit = sound_refit(*best, targets_, false, stop);
  if (fit && fit->misfit < e.misfit) take(std::move(*fit), e);
}

Hypothesis Evidence::explain(const std::vector<std::size_t>& causes, const Hypothesis* known,
                             const numerics::Progress& stop) const {
  auto e = search(causes, by_mechanics_, known, stop);
  static_cast<void>(file_of(file_, e));  // numbers that no machine has explain nothing
  return e;
}

void Evidence::widen(Hypothesis& e, double frequency_error) const {
  Targets shifted = e.by_mechanics ? by_mechanics_ : targets_;
  for (auto& mode : shifted.modes) mode.omega *= 1.0 + frequency_error;
  const auto other = refit(e, shifted, false, {});
  for (std::size_t k = 0; k < e.fit.parameters.size(); ++k) {
    auto& p = e.fit.parameters[k];
    p.deviation = std::hypot(p.deviation, other.parameters[k].value - p.value);
  }
}

std::optional<Evidence::Part> Evidence::explain_direction(std::size_t cause, int direction,
                                                          const numerics::Progress& stop) const {
  const auto of_direction = [&](const ModeTarget& mode) { return mode.direction == direction; };
  Part part{.rest = targets_};
  Targets some = targets_, some_mechanics = by_mechanics_, rest_mechanics = by_mechanics_;
  for (auto* targets : {&some, &some_mechanics})
    std::erase_if(targets->modes, [&](const auto& m) { return !of_direction(m); });
  for (auto* targets : {&part.rest, &rest_mechanics}) std::erase_if(targets->modes, of_direction);
  some.responses.clear();  // of all directions together
  part.rest.responses.clear();
  if (part.rest.modes.empty()) return std::nullopt;
  part.hypothesis = search({cause}, some_mechanics, nullptr, stop);
  polish(part.hypothesis, some, true, stop);
  if (part.hypothesis.by_mechanics) part.rest = rest_mechanics;
  part.at_rest =
      calibration::compare(file_of(file_, part.hypothesis), part.rest, part.hypothesis.kind);
  return part;
}

model::MachineFile file_of(const model::MachineFile& file, const Hypothesis& hypothesis) {
  auto changes = hypothesis.changes;
  for (const auto& p : hypothesis.fit.parameters)
    for (const auto& path : p.paths) changes.push_back({*find_parameter(file, path), p.value});
  auto changed = file;
  model::assign(changed.machine, changes);
  std::vector<base::Diagnostic> errors;
  for (const auto& finding : model::validate(changed.machine))
    if (finding.severity == base::Severity::error)
      errors.push_back({.key = finding.key, .message = finding.message});
  if (!errors.empty()) throw base::InputError(errors);
  return changed;
}

model::Machine machine_of(const model::MachineFile& file, const Hypothesis& hypothesis) {
  return file_of(file, hypothesis).machine;
}

}  // namespace hydrapod::diagnosis
