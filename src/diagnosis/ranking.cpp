#include "ranking.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "evidence.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::diagnosis {

namespace {

/// Are the causes of one hypothesis among those of another?
bool holds(const Hypothesis& pair, const Hypothesis& single) {
  return single.causes.size() < pair.causes.size() &&
         std::includes(pair.causes.begin(), pair.causes.end(), single.causes.begin(),
                       single.causes.end());
}

/// As many numbers as values: it explains any values.
bool explains_anything(const Diagnosis& d, const Hypothesis& e) {
  return e.parameters >= std::max(1, d.values);
}

/// Does it meet the data no better than some of its causes alone, or than the nominal machine?
/// Those are then judged in its place, also where they do not explain the data: what it adds is not
/// shown.
bool repeats(const Diagnosis& d, const Hypothesis& e) {
  return std::ranges::any_of(d.hypotheses, [&](const Hypothesis& other) {
    return !other.rigid && other.bic <= d.best().bic + same && holds(e, other);
  });
}

/// What is compared as mechanics says nothing about responses: it is taken to meet them as well as
/// the one that meets them best.
void add_unseen_responses(Diagnosis& d) {
  if (d.targets.responses.empty()) return;
  const double least = least_response_misfit(d);
  for (auto& e : d.hypotheses)
    if (e.fit.responses.empty()) e.misfit = e.fit.misfit + least;
}

}  // namespace

double least_scatter(const Diagnosis& d) {
  int lines = 0;
  for (const auto& response : d.targets.responses) lines += response.values;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& e : d.hypotheses) {
    if (explains_anything(d, e)) continue;
    const double responses = e.response_misfit();
    const double degrees = std::max(1, d.values - lines - e.parameters);
    least = std::min(least, std::max((e.misfit - responses) / degrees,
                                     responses / static_cast<double>(std::max(1, lines))));
  }
  return std::sqrt(least);
}

double hypothesis_penalty(std::size_t causes, std::size_t held) {
  const auto n = static_cast<double>(causes);
  if (held == 0 || n < 2.0) return 0.0;
  return 2.0 * std::log(held == 1 ? n : n * (n - 1.0) / 2.0);
}

void rank(Diagnosis& d) {
  add_unseen_responses(d);
  d.scatter = std::max(1.0, least_scatter(d));
  for (auto& e : d.hypotheses)
    e.bic = e.misfit / (d.scatter * d.scatter) + e.parameters * std::log(d.values) +
            hypothesis_penalty(d.causes.size(), e.causes.size());
  std::ranges::stable_sort(d.hypotheses, {}, &Hypothesis::bic);
}

namespace {

/// Is its misfit one that the deviations account for?
bool explains(const Diagnosis& d, const Hypothesis& e) {
  return goodness(d, e).probability >=
         (e.causes.size() > 1 ? least_probability_of_pair : least_probability);
}

/// Are the frequencies those of the nominal machine, though the shapes are not? Every cause that
/// moves shapes moves frequencies too, so that the shapes are in doubt: places, signs or directions
/// of sensors. Leakage moves damping ratios and responses alone.
bool only_shapes_differ(const Diagnosis& d) {
  const bool more = !d.targets.responses.empty() ||
                    std::ranges::any_of(d.targets.modes,
                                        [](const auto& mode) { return mode.damping.has_value(); });
  return !more && goodness(d, d.nominal()).frequencies.probability() >= usual_frequencies;
}

/// No candidate is shown to be the cause, and the nominal machine meets the data as it is, shapes
/// included.
bool needs_no_cause(const Diagnosis& d) {
  const bool none_shown =
      d.unexplained == Unexplained::unlisted || d.unexplained == Unexplained::shapes_only;
  return none_shown && goodness(d, d.nominal()).probability >= usual_frequencies;
}

std::size_t index_of_nominal(const Diagnosis& d) {
  return static_cast<std::size_t>(&d.nominal() - d.hypotheses.data());
}

/// Could frequencies have refuted it?
bool is_tested(const Diagnosis& d, const Hypothesis& e) {
  if (static_cast<int>(d.targets.modes.size()) - e.parameters < tested_by) return false;
  return e.causes.size() < 2 || moved_frequencies(d) > e.parameters;
}

}  // namespace

int moved_frequencies(const Diagnosis& d) {
  return static_cast<int>(std::ranges::count_if(d.nominal().fit.targets, [](const auto& target) {
    return std::abs(target.difference) > moved_by;
  }));
}

std::optional<Unexplained> why_unexplained(const Diagnosis& d, const Hypothesis& e) {
  if (d.scatter > no_explanation) return Unexplained::scatter;
  if (only_shapes_differ(d)) return Unexplained::shapes_only;
  if (e.bic > unlisted_bic(d) - over_unlisted) return Unexplained::unlisted;
  if (!explains(d, e)) return Unexplained::misfit;
  if (!is_tested(d, e)) return Unexplained::untested;
  const bool held = std::ranges::any_of(
      e.fit.parameters, [](const auto& p) { return p.verdict == calibration::Verdict::at_bound; });
  return held ? std::optional(Unexplained::at_bound) : std::nullopt;
}

const Hypothesis& Diagnosis::judged() const {
  const auto found = std::ranges::find_if(hypotheses, [&](const Hypothesis& e) {
    return !explains_anything(*this, e) && !repeats(*this, e);
  });
  return found == hypotheses.end() ? best() : *found;
}

void judge(Diagnosis& d) {
  if (d.scatter > no_explanation) {
    const bool anything = std::ranges::any_of(d.hypotheses, [&](const auto& e) {
      return explains_anything(d, e) && e.misfit <= no_explanation * no_explanation * d.values;
    });
    if (anything) {
      d.finding = Finding::cannot_tell;
      return;
    }
    d.finding = d.scatter > another_machine ? Finding::do_not_belong : Finding::unexplained;
    d.unexplained = Unexplained::scatter;
    return;
  }
  const double limit = d.best().bic + same;
  for (const bool rigid : {true, false})
    for (std::size_t k = 0; k < d.hypotheses.size(); ++k) {
      const auto& e = d.hypotheses[k];
      if (!e.causes.empty() || e.rigid != rigid || e.bic > limit || !explains(d, e)) continue;
      d.finding = rigid ? Finding::nothing_to_blame : Finding::nominal;
      d.equivalent = {k};
      return;
    }
  for (std::size_t k = 0; k < d.hypotheses.size(); ++k)
    if (d.hypotheses[k].bic <= limit) d.equivalent.push_back(k);
  std::erase_if(d.equivalent, [&](std::size_t k) {
    return explains_anything(d, d.hypotheses[k]) || repeats(d, d.hypotheses[k]);
  });
  if (d.equivalent.empty()) {
    d.finding = Finding::cannot_tell;
    return;
  }
  // beside one that explains the data, one of nearly the same BIC is no less likely because the
  // data refute it by a little more
  const auto why_not = [&](std::size_t k) { return why_unexplained(d, d.hypotheses[k]); };
  const bool any = !std::ranges::all_of(d.equivalent,
                                        [&](std::size_t k) { return why_not(k).has_value(); });
  std::erase_if(d.equivalent, [&](std::size_t k) {
    const auto why = why_not(k);
    return why && !(any && why == Unexplained::misfit);
  });
  if (d.equivalent.empty()) {
    d.unexplained = why_unexplained(d, d.judged());
    if (needs_no_cause(d)) {
      d.finding = Finding::nominal;
      d.equivalent = {index_of_nominal(d)};
      d.unexplained.reset();
    } else {
      d.finding = Finding::unexplained;
    }
    return;
  }
  // a second cause whose parameter the data do not determine is not identified
  const auto open = [&](std::size_t k) {
    const auto& e = d.hypotheses[k];
    return e.causes.size() > 1 &&
           std::ranges::any_of(e.fit.parameters, [](const calibration::FittedParameter& p) {
             return p.verdict == calibration::Verdict::undetermined;
           });
  };
  if (std::ranges::all_of(d.equivalent, open)) {
    d.equivalent.clear();
    d.finding = Finding::cannot_tell;
    return;
  }
  d.finding = d.equivalent.size() == 1 ? Finding::identified : Finding::undecided;
}

namespace {

/// Mode of the rigid-leg model, of the nominal machine, of which a mode holds most: its
/// frequency and share. A hypothesis may weigh the platform differently.
double motion_mac(const spatial::Matrix6& metric, const spatial::Vector6& a,
                  const spatial::Vector6& b) {
  const spatial::Vector6 u = metric * a, v = metric * b;
  const double product = u.dot(v);
  return product * product / (u.squaredNorm() * v.squaredNorm());
}

constexpr double same_motion = 0.5;  ///< least MAC

/// The mode of rigid legs of which the mode `phi` holds most. `seen`: the resonances of the rigid
/// legs in the plant or the system that was measured; none:
/// mechanics was.
int find_rigid(const model::Machine& stated, const model::NamedPose& pose,
               const std::vector<observation::Resonance>* seen,
               const dynamics::LinearModel& flexible, const dynamics::ModelVector& phi,
               MeasuredMode& mode) {
  const auto rigid = dynamics::linear_model(without_mount_and_gimbals(stated), pose.X_BP,
                                            dynamics::ModelKind::rigid);
  const auto modes = modal::normal_modes(rigid);
  int most = 0;
  for (int r = 0; r < 6; ++r) {
    const double mac = rigid_share(flexible, modes.shapes.col(r), phi);
    if (mac <= mode.rigid_mac) continue;
    mode.rigid_mac = mac;
    mode.omega_rigid = modes.omega(most = r);
  }
  if (seen == nullptr) return most;
  const auto metric = observation::platform_metric(stated, pose.X_BP, stated.platform.mass_center);
  double alike = 0.0;
  for (const auto& resonance : *seen) {
    const double mac = motion_mac(metric, resonance.motion, modes.shapes.col(most).head<6>());
    if (mac <= alike) continue;
    alike = mac;
    mode.omega_rigid = resonance.omega;
  }
  if (alike < same_motion) mode.rigid_mac = 0.0;  // no resonance to compare with
  return most;
}

/// `rigid`: of each mode, the mode of rigid legs of which it holds most.
void find_resonances(std::vector<MeasuredMode>& modes, const std::vector<int>& rigid) {
  for (std::size_t i = 0; i < modes.size(); ++i) {
    double largest = 0.0, left = 1.0;
    for (std::size_t j = 0; j < modes.size(); ++j) {
      if (modes[j].pose != modes[i].pose || rigid[j] != rigid[i]) continue;
      largest = std::max(largest, modes[j].rigid_mac);
      left -= modes[j].rigid_mac;
    }
    const double enough = ResonanceOptions{}.of_largest * std::max(largest, left);
    modes[i].resonance = modes[i].rigid_mac >= std::max(enough, resonance_mac);
  }
}

}  // namespace

void trace_modes(const model::MachineFile& file, Diagnosis& d) {
  const auto& best = d.equivalent.empty() ? d.best() : d.hypotheses[d.equivalent.front()];
  const auto& stated = d.nominal();
  const auto machine = machine_of(file, best);
  const auto rigid = without_mount_and_gimbals(file.machine);
  Predictions predictions(file, d.targets, stated.kind);
  std::map<std::string, std::vector<observation::Resonance>> seen;
  if (d.targets.observed != observation::Observed::mechanics)
    for (const auto& target : d.targets.modes)
      if (!seen.contains(target.pose))
        if_possible([&] {
          seen[target.pose] = predictions.of(rigid, dynamics::ModelKind::rigid,
                                             *find_pose(file.machine, target.pose));
        });
  d.modes.clear();
  std::vector<int> rigid_modes;
  for (std::size_t i = 0; i < d.targets.modes.size(); ++i) {
    const auto& target = d.targets.modes[i];
    MeasuredMode mode{.pose = target.pose,
                      .direction = target.direction.value_or(-1),
                      .amplitude = target.amplitude,
                      .omega = target.omega,
                      .deviation = target.deviation,
                      .common_deviation = target.common_deviation,
                      .omega_stated = stated.fit.targets[i].omega,
                      .omega_best = best.fit.targets[i].omega,
                      .shape_mac = best.fit.targets[i].shape_mac,
                      .mode_direction = best.fit.targets[i].mode_direction.value_or(-1)};
    const auto* pose = find_pose(machine, target.pose);
    const auto model = dynamics::linear_model(machine, pose->X_BP, best.kind);
    const auto modes = modal::normal_modes(model);
    const dynamics::ModelVector phi = modes.shapes.col(best.fit.targets[i].mode);
    const auto at = seen.find(target.pose);
    rigid_modes.push_back(find_rigid(file.machine, *pose, at == seen.end() ? nullptr : &at->second,
                                     model, phi, mode));
    const auto energy = modal::energy_shares(model, phi).front();
    mode.oil = energy.oil.sum();
    mode.leg_type = energy.leg_type;
    mode.guide_sleeves = energy.guide_sleeve.sum();
    mode.piston_rings = energy.piston_ring.sum();
    mode.base = energy.base_mount;
    mode.payload = energy.payload_elastic;
    mode.bending = energy.bending.sum();
    d.modes.push_back(mode);
  }
  find_resonances(d.modes, rigid_modes);
}

namespace {

using observation::Resonance;

/// Those of two machines that are the same resonance: together the nearest in frequency and in the
/// motion of the platform. A resonance that has no counterpart moves the platform otherwise than
/// what is left for it.
std::vector<std::pair<const Resonance*, const Resonance*>> same_resonances(
    const std::vector<Resonance>& a, const std::vector<Resonance>& b,
    const spatial::Matrix6& metric) {
  if (a.empty() || b.empty()) return {};
  const bool turned = a.size() > b.size();
  const auto& rows = turned ? b : a;
  const auto& columns = turned ? a : b;
  const auto mac = [&](const Resonance& x, const Resonance& y) {
    return motion_mac(metric, x.motion, y.motion);
  };
  Eigen::MatrixXd cost(rows.size(), columns.size());
  for (Eigen::Index i = 0; i < cost.rows(); ++i)
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      const auto &x = rows[static_cast<std::size_t>(i)], &y = columns[static_cast<std::size_t>(j)];
      cost(i, j) = std::abs(std::log(x.omega / y.omega)) + 1.0 - mac(x, y);
    }
  std::vector<std::pair<const Resonance*, const Resonance*>> pairs;
  const auto column_of = numerics::assign(cost);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto &x = rows[i], &y = columns[static_cast<std::size_t>(column_of[i])];
    if (mac(x, y) >= same_motion) pairs.emplace_back(turned ? &y : &x, turned ? &x : &y);
  }
  return pairs;
}

}  // namespace

std::optional<Discriminator> discriminate(Predictions& predictions, const Diagnosis& d,
                                          std::size_t other,
                                          const std::vector<model::NamedPose>& poses,
                                          double frequency_error) {
  const auto& best = d.hypotheses[d.equivalent.front()];
  const auto& rival = d.hypotheses[other];
  const auto& machine = predictions.machine();
  Discriminator found{.other = other};
  for (const auto& pose : poses) {
    std::vector<Resonance> in_a, in_b;
    const bool both = if_possible([&] {  // or one of them folds there
      in_a = predictions.at(best, pose);
      in_b = predictions.at(rival, pose);
    });
    if (!both) continue;
    const auto metric =
        observation::platform_metric(machine, pose.X_BP, machine.platform.mass_center);
    for (const auto& [x, y] : same_resonances(in_a, in_b, metric)) {
      const double deviations =
          std::abs(std::log(x->omega / y->omega)) / (std::sqrt(2.0) * frequency_error);
      if (deviations <= found.deviations) continue;
      found = {other, pose.name, x->direction, x->omega, y->omega, deviations};
    }
  }
  if (found.pose.empty()) return std::nullopt;
  return found;
}

}  // namespace hydrapod::diagnosis
