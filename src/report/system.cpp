#include "hydrapod/report/model_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fields.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::report {

namespace {

using simulation::Part;
using simulation::SystemPole;
using simulation::SystemPoles;

using base::two_pi;
constexpr double least_named = 0.1;  // participation
constexpr double most_of_it = 0.75;  // of a leg's share

/// As many parts as every machine has; those of the payload's modes and of lines follow.
constexpr auto common_parts = static_cast<std::size_t>(Part::payload);

/// Parts that stand in tables: up to the last one that the machine has.
int tabled_parts(const SystemPoles& poles) {
  std::size_t count = simulation::part_count;
  const auto any = [&poles](std::size_t part) {
    return std::ranges::any_of(poles.poles,
                               [part](const SystemPole& pole) { return pole.parts[part] != 0.0; });
  };
  while (count > common_parts && !any(count - 1)) --count;
  return static_cast<int>(count);
}

std::string csv_row(const SystemPole& pole, int parts) {
  return fmt::format("{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.6g}\n", pole.pole.real(),
                     pole.pole.imag(), pole.omega, pole.omega / two_pi, pole.damping_ratio,
                     fmt::join(pole.parts.begin(), pole.parts.begin() + parts, ","));
}

std::string csv_head(int parts) {
  std::string text = "re_1_s,im_1_s,omega_rad_s,frequency_hz,damping_ratio";
  for (int i = 0; i < parts; ++i)
    text += fmt::format(",{}", simulation::name(static_cast<Part>(i)));
  return text + "\n";
}

}  // namespace

std::string participation_text(const SystemPole& pole) {
  std::vector<int> order(simulation::part_count);
  std::iota(order.begin(), order.end(), 0);
  const auto share = [&](int i) { return pole.parts[static_cast<std::size_t>(i)]; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return share(a) > share(b); });
  std::string text;
  for (const int i : order) {
    if (share(i) < least_named && !text.empty()) break;
    text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ",
                        simulation::name(static_cast<Part>(i)), 100.0 * share(i));
  }
  const double of_legs = std::accumulate(pole.legs.begin(), pole.legs.end(), 0.0);
  const auto most = std::max_element(pole.legs.begin(), pole.legs.end());
  if (of_legs > least_named && *most > most_of_it * of_legs)
    text += fmt::format(" (leg {})", most - pole.legs.begin() + 1);
  return text;
}

std::string verdict_text(const SystemPoles& poles) {
  const bool sampled = !poles.sampled.empty();
  const double rate = sampled ? poles.sampled.front().real() : poles.largest_real;
  const double omega =
      sampled ? std::abs(poles.sampled.front().imag()) : poles.poles.front().pole.imag();
  const bool stable = sampled ? poles.sampled_stable : poles.stable;
  const std::string motion =
      omega > 0.0 ? fmt::format("oscillation at {:.4g} Hz", omega / two_pi) : "motion";
  const char* article = omega > 0.0 ? "an" : "a";
  std::string text =
      stable && omega > 0.0 && std::abs(rate) <= simulation::rounded_growth * omega
          ? fmt::format("stable: nothing grows, and nothing damps the {}", motion)
      : stable ? fmt::format("stable: the slowest {} decays with {:.3g} 1/s", motion, -rate)
               : fmt::format("UNSTABLE: {} {} grows with {:.3g} 1/s", article, motion, rate);
  if (sampled)
    text += fmt::format(" (sampled loop, exact: largest |z| {:.6f})", poles.largest_modulus);
  if (sampled && poles.stable != poles.sampled_stable)
    text += fmt::format("; the continuous approximation would be {}",
                        poles.stable ? "stable" : "unstable");
  return text;
}

template <class Fields>
void describe(Fields& f, SystemPole& pole) {
  f("pole", pole.pole);
  f("omega_rad_s", pole.omega);
  f.derived("frequency_hz", pole.omega / two_pi);
  f("damping_ratio", pole.damping_ratio);
  f("stable", pole.stable);
  f("group", pole.group);
  f.derived("label", participation_text(pole));
  f.object("participation", [&](auto& parts) {
    for (std::size_t i = 0; i < common_parts; ++i)
      parts(simulation::name(static_cast<Part>(i)), pole.parts[i]);
    for (std::size_t i = common_parts; i < simulation::part_count; ++i)
      parts.unless(0.0, simulation::name(static_cast<Part>(i)), pole.parts[i]);
  });
  f("participation_of_legs", pole.legs);
}

template <class Fields>
void describe(Fields& f, System& system) {
  auto& linear = system.linear;
  auto& poles = system.poles;
  f.derived("stable", poles.sampled.empty() ? poles.stable : poles.sampled_stable);
  f.derived("verdict", Fields::reads ? "" : verdict_text(poles));
  f.object("delay", [&](auto& delay) {
    delay("seconds", linear.delay);
    delay("pade_order", linear.pade_order);
  });
  f("poles", poles.poles);
  f.object("sampled", [&](auto& sampled) {
    sampled("sample_time_s", linear.sample_time);
    sampled("largest_modulus", poles.largest_modulus);
    sampled("stable", poles.sampled_stable);
    sampled("poles", poles.sampled);
  });
}

Json system_json(const System& system) {
  Json json = Json::object();
  if (system.closed)
    json["controller"] = controller_json(system.tuning.parameters, system.tuning.lowest_oil_mode);
  json.update(written(system));
  return json;
}

System system_from_json(const Json& json, const std::string& file) {
  auto system = read<System>(json, file);
  system.closed = json.contains("controller");
  if (system.closed) system.tuning = controller_from_json(json["controller"], file);
  auto& poles = system.poles;
  poles.stable = std::ranges::none_of(
      poles.poles, [](const SystemPole& pole) { return simulation::grows(pole.pole); });
  if (!poles.poles.empty()) poles.largest_real = poles.poles.front().pole.real();
  return system;
}

std::string system_poles_csv(const SystemPoles& poles) {
  const int parts = tabled_parts(poles);
  std::string text = csv_head(parts);
  for (const auto& pole : poles.poles) text += csv_row(pole, parts);
  return text;
}

namespace {

struct LocusPoint {
  double value{};
  SystemPoles poles{};
};

}  // namespace

template <class Fields>
void describe(Fields& f, LocusPoint& point) {
  std::vector<std::complex<double>> poles;
  for (const auto& pole : point.poles.poles) poles.push_back(pole.pole);
  f("value", point.value);
  f("stable", point.poles.sampled_stable);
  f("largest_modulus", point.poles.largest_modulus);
  f("poles", poles);
  f("sampled", point.poles.sampled);
  if constexpr (Fields::reads)
    for (const auto& pole : poles)
      point.poles.poles.push_back({.pole = pole, .omega = std::abs(pole)});
}

template <class Fields>
void describe(Fields& f, RootLocus& locus) {
  std::vector<LocusPoint> points;
  for (std::size_t k = 0; k < locus.values.size(); ++k)
    points.push_back({locus.values[k], locus.poles[k]});
  f("key", locus.key);
  f("limits", locus.limits);
  f("points", points);
  if constexpr (Fields::reads)
    for (auto& point : points) {
      locus.values.push_back(point.value);
      locus.poles.push_back(std::move(point.poles));
    }
}

Json root_locus_json(const RootLocus& locus) { return written(locus); }

RootLocus root_locus_from_json(const Json& json, const std::string& file) {
  return read<RootLocus>(json, file);
}

std::string root_locus_csv(const RootLocus& locus) {
  int parts = 0;
  for (const auto& poles : locus.poles) parts = std::max(parts, tabled_parts(poles));
  std::string text = "value," + csv_head(parts);
  for (std::size_t k = 0; k < locus.values.size(); ++k)
    for (const auto& pole : locus.poles[k].poles)
      text += fmt::format("{:.17g},{}", locus.values[k], csv_row(pole, parts));
  return text;
}

}  // namespace hydrapod::report
