#include "hydrapod/report/system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/constants.hpp"

namespace hydrapod::report {

namespace {

using simulation::LinearSystem;
using simulation::Part;
using simulation::SystemPole;
using simulation::SystemPoles;

using base::two_pi;
constexpr double least_named = 0.1;  // participation
constexpr double most_of_it = 0.75;  // of a leg's share
constexpr double bisection = 1e-4;   // of the distance of two values

Json complex_json(std::complex<double> value) {
  return {{"re", value.real()}, {"im", value.imag()}};
}

Json pole_json(const SystemPole& pole) {
  Json parts;
  for (int i = 0; i < simulation::part_count; ++i)
    parts[simulation::name(static_cast<Part>(i))] = pole.parts[static_cast<std::size_t>(i)];
  return {{"pole", complex_json(pole.pole)},     {"omega_rad_s", pole.omega},
          {"frequency_hz", pole.omega / two_pi}, {"damping_ratio", pole.damping_ratio},
          {"stable", pole.pole.real() < 0.0},    {"group", pole.group},
          {"label", participation_text(pole)},   {"participation", std::move(parts)},
          {"participation_of_legs", pole.legs}};
}

std::string csv_row(const SystemPole& pole) {
  std::string text =
      fmt::format("{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}", pole.pole.real(), pole.pole.imag(),
                  pole.omega, pole.omega / two_pi, pole.damping_ratio);
  for (const double share : pole.parts) text += fmt::format(",{:.6g}", share);
  return text + "\n";
}

std::string csv_head() {
  std::string text = "re_1_s,im_1_s,omega_rad_s,frequency_hz,damping_ratio";
  for (int i = 0; i < simulation::part_count; ++i)
    text += fmt::format(",{}", simulation::name(static_cast<Part>(i)));
  return text + "\n";
}

}  // namespace

std::string participation_text(const SystemPole& pole) {
  std::vector<int> order(simulation::part_count);
  for (int i = 0; i < simulation::part_count; ++i) order[static_cast<std::size_t>(i)] = i;
  const auto share = [&](int i) { return pole.parts[static_cast<std::size_t>(i)]; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return share(a) > share(b); });
  std::string text;
  for (const int i : order) {
    if (share(i) < least_named && !text.empty()) break;
    text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ",
                        simulation::name(static_cast<Part>(i)), 100.0 * share(i));
  }
  double of_legs = 0.0;
  for (const double leg : pole.legs) of_legs += leg;
  const auto most = std::max_element(pole.legs.begin(), pole.legs.end());
  if (of_legs > least_named && *most > most_of_it * of_legs)
    text += fmt::format(" (leg {})", most - pole.legs.begin() + 1);
  return text;
}

std::string verdict_text(const LinearSystem& system, const SystemPoles& poles) {
  const auto& first = poles.poles.front();
  const double rate = poles.sampled.empty() ? poles.largest_real : poles.sampled.front().real();
  const double omega =
      poles.sampled.empty() ? first.pole.imag() : std::abs(poles.sampled.front().imag());
  const bool stable = system.sampled.size() > 0 ? poles.sampled_stable : poles.stable;
  const std::string motion =
      omega > 0.0 ? fmt::format("oscillation at {:.4g} Hz", omega / two_pi) : "motion";
  const char* article = omega > 0.0 ? "an" : "a";
  std::string text =
      stable ? fmt::format("stable: the slowest {} decays with {:.3g} 1/s", motion, -rate)
             : fmt::format("UNSTABLE: {} {} grows with {:.3g} 1/s", article, motion, rate);
  if (system.sampled.size() > 0)
    text += fmt::format(" (sampled loop, exact: largest |z| {:.6f})", poles.largest_modulus);
  if (system.sampled.size() > 0 && poles.stable != poles.sampled_stable)
    text +=
        fmt::format("; the continuous approximation says {}", poles.stable ? "stable" : "unstable");
  return text;
}

Json system_poles_json(const LinearSystem& system, const SystemPoles& poles) {
  Json list = Json::array(), sampled = Json::array();
  for (const auto& pole : poles.poles) list.push_back(pole_json(pole));
  for (const auto& pole : poles.sampled) sampled.push_back(complex_json(pole));
  return {{"stable", system.sampled.size() > 0 ? poles.sampled_stable : poles.stable},
          {"verdict", verdict_text(system, poles)},
          {"delay", {{"seconds", system.delay}, {"pade_order", system.pade_order}}},
          {"poles", std::move(list)},
          {"sampled",
           {{"sample_time_s", system.sample_time},
            {"largest_modulus", poles.largest_modulus},
            {"stable", poles.sampled_stable},
            {"poles", std::move(sampled)}}}};
}

std::string system_poles_csv(const SystemPoles& poles) {
  std::string text = csv_head();
  for (const auto& pole : poles.poles) text += csv_row(pole);
  return text;
}

RootLocus root_locus(const std::string& key, const std::vector<double>& values,
                     const std::function<LinearSystem(double)>& system_at,
                     const std::function<void(double)>& progress) {
  RootLocus locus{.key = key, .values = values};
  for (const double value : values) {
    locus.poles.push_back(simulation::system_poles(system_at(value)));
    if (progress)
      progress(static_cast<double>(locus.poles.size()) / static_cast<double>(values.size()));
  }
  for (std::size_t k = 0; k + 1 < values.size(); ++k) {
    const bool stable = locus.poles[k].sampled_stable;
    if (stable == locus.poles[k + 1].sampled_stable) continue;
    double low = values[k], high = values[k + 1];
    while (std::abs(high - low) > bisection * std::abs(values[k + 1] - values[k])) {
      const double middle = 0.5 * (low + high);
      const bool same = simulation::system_poles(system_at(middle)).sampled_stable == stable;
      (same ? low : high) = middle;
    }
    locus.limits.push_back(0.5 * (low + high));
  }
  return locus;
}

Json root_locus_json(const RootLocus& locus) {
  Json points = Json::array();
  for (std::size_t k = 0; k < locus.values.size(); ++k) {
    Json list = Json::array(), sampled = Json::array();
    for (const auto& pole : locus.poles[k].poles) list.push_back(complex_json(pole.pole));
    for (const auto& pole : locus.poles[k].sampled) sampled.push_back(complex_json(pole));
    points.push_back({{"value", locus.values[k]},
                      {"stable", locus.poles[k].sampled_stable},
                      {"largest_modulus", locus.poles[k].largest_modulus},
                      {"poles", std::move(list)},
                      {"sampled", std::move(sampled)}});
  }
  return {{"key", locus.key}, {"limits", locus.limits}, {"points", std::move(points)}};
}

std::string root_locus_csv(const RootLocus& locus) {
  std::string text = "value," + csv_head();
  for (std::size_t k = 0; k < locus.values.size(); ++k)
    for (const auto& pole : locus.poles[k].poles)
      text += fmt::format("{:.17g},{}", locus.values[k], csv_row(pole));
  return text;
}

}  // namespace hydrapod::report
