#include "responses.hpp"

#include <algorithm>
#include <cmath>

#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::diagnosis {

namespace {

using observation::ResponseTarget;
using observation::Targets;
using Complex = std::complex<double>;

/// A measured resonance: within `width` of it, as share of ω, its damping decides.
struct Peak {
  double omega{}, damping{}, width{};
};
constexpr double apart = 0.015;  // of the frequency: nearer lines say the same

std::vector<Peak> peaks_at(const Targets& measured, const std::string& pose) {
  constexpr double half_widths = 2.0, widest = 0.1, usual = 0.02;
  std::vector<Peak> peaks;
  for (const auto& mode : measured.modes)
    if (mode.pose == pose) {
      const double damping = mode.damping.value_or(usual);
      peaks.push_back({mode.omega, damping, std::min(widest, half_widths * damping)});
    }
  return peaks;
}

/// What a response to forces is off by, as share of it, where poles are off by `frequency_error`
/// and half widths by all of themselves.
double misplaced(const std::vector<Peak>& peaks, Complex s, double frequency_error) {
  double most = 0.0;
  for (const auto& peak : peaks) {
    const Complex pole = peak.omega * Complex(-peak.damping, 1.0);
    most =
        std::max(most, std::hypot(frequency_error, peak.damping) * peak.omega / std::abs(s - pole));
  }
  return most;
}

/// Where a line would be worth most: on the flanks of measured resonances, where the machine as
/// stated has some, and then anywhere in the band.
std::vector<double> wanted_lines(const std::vector<Peak>& peaks, const model::MachineFile& file,
                                 const model::NamedPose& pose, dynamics::ModelKind kind,
                                 observation::Observed observed, double from, double to, int most) {
  constexpr double most_damped = 0.3;
  std::vector<double> omega;
  for (const auto& peak : peaks)
    for (const double side : {-1.0, 1.0})
      omega.push_back(peak.omega * (1.0 + side * (peak.width + 0.5 * apart)));
  const auto stated = observation::observe(file.machine, pose.X_BP, kind, observed);
  for (const auto& mode : stated.modes) {
    const observation::Vector6c motion = mode.motion();
    const observation::Vector6c momentum = stated.mechanics.platform_mass.cast<Complex>() * motion;
    if (mode.damping_ratio() < most_damped &&
        motion.dot(momentum).real() > observation::ObservationOptions{}.visible)
      omega.push_back(mode.omega());
  }
  for (int k = 0; k < most; ++k)
    omega.push_back(from * std::pow(to / from, (k + 0.5) / static_cast<double>(most)));
  return omega;
}

/// Largest noise of a column at a line, as share of it.
double noise_at(const ResponseTarget& all, std::size_t line) {
  return all.deviation[line].maxCoeff();
}

/// Numbers of the lines that count, ascending.
std::vector<std::size_t> lines_of(const ResponseTarget& all, double from, double to,
                                  const std::vector<Peak>& peaks,
                                  const std::vector<double>& wanted) {
  const auto off = [](double a, double b) { return std::abs(std::log(a / b)); };
  std::vector<std::size_t> good;
  for (std::size_t line = 0; line < all.s.size(); ++line) {
    const double omega = all.s[line].imag();
    if (omega >= from && omega <= to && noise_at(all, line) < worst_noise &&
        std::ranges::none_of(peaks, [&](const Peak& p) { return off(omega, p.omega) < p.width; }))
      good.push_back(line);
  }
  if (good.empty()) return {};
  std::vector<std::size_t> chosen;
  for (const double omega : wanted) {
    const auto nearest = *std::ranges::min_element(
        good, {}, [&](std::size_t line) { return off(all.s[line].imag(), omega); });
    if (off(all.s[nearest].imag(), omega) > 2.0 * apart) continue;  // nothing is known there
    const bool taken = std::ranges::any_of(chosen, [&](std::size_t line) {
      return off(all.s[line].imag(), all.s[nearest].imag()) < apart;
    });
    if (!taken) chosen.push_back(nearest);
  }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace

std::vector<ResponseTarget> chosen_lines(const model::MachineFile& file, const Targets& measured,
                                         dynamics::ModelKind kind, const DiagnoseOptions& options) {
  constexpr double below = 0.6, above = 1.4;
  constexpr int of_shape = 5;  // values
  std::vector<ResponseTarget> chosen;
  for (const auto& all : measured.responses) {
    const auto* pose = find_pose(file.machine, all.pose);
    const auto peaks = peaks_at(measured, all.pose);
    if (pose == nullptr || peaks.empty() || !can_enter(measured.observed, all.entry)) continue;
    const double from = below * std::ranges::min(peaks, {}, &Peak::omega).omega;
    const double to = above * std::ranges::max(peaks, {}, &Peak::omega).omega;
    const int most = std::max(1, most_lines / static_cast<int>(measured.responses.size()));
    const auto lines =
        lines_of(all, from, to, peaks,
                 wanted_lines(peaks, file, *pose, kind, measured.observed, from, to, most));
    ResponseTarget some{.pose = all.pose,
                        .point = all.point,
                        .against = all.against,
                        .entry = all.entry,
                        .inputs = all.inputs,
                        .window = all.window};
    const auto inputs = static_cast<double>(all.inputs.cols());
    const auto shapes = static_cast<double>(std::min(lines.size(), peaks.size()));
    for (const auto line : lines) {
      some.s.push_back(all.s[line]);
      some.H.push_back(all.H[line]);
      const double of_poles = all.entry == observation::Entry::forces
                                  ? misplaced(peaks, all.s[line], options.frequency_error)
                                  : 0.0;
      const double error = (std::pow(options.response_error, 2) + std::pow(of_poles, 2)) *
                           static_cast<double>(lines.size()) / shapes;
      some.deviation.push_back(
          (inputs * (all.deviation[line].array().square() + error)).sqrt().matrix());
    }
    some.values = of_shape * static_cast<int>(shapes);
    if (!some.s.empty()) chosen.push_back(std::move(some));
  }
  return chosen;
}

}  // namespace hydrapod::diagnosis
