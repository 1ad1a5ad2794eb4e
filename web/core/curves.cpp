#include "curves.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hydrapod::page {

namespace {

/// φᵀ C φ of every mode, modal ratio included.
dynamics::ModelVector modal_damping(const response::ResponseModel& model) {
  const auto& Phi = model.modes.shapes;
  return (Phi.transpose() * response::damping_matrix(model) * Phi).diagonal();
}

/// Lines within a few half-power bandwidths of every mode. An undamped machine has no value at its
/// frequencies.
void add_lines_around_modes(const response::ResponseModel& model, std::vector<double>& lines) {
  const auto damping = modal_damping(model);
  for (int k = 0; k < model.modes.size(); ++k) {
    const double omega = model.modes.omega(k);
    const double half_band = std::max(0.5 * damping[k], 1e-6 * omega);
    if (damping[k] > 0.0) lines.push_back(omega);
    for (const double steps : {0.15, 0.35, 0.6, 1.0, 1.6, 2.6, 4.5, 8.0})
      for (const double side : {-1.0, 1.0}) lines.push_back(omega + side * steps * half_band);
  }
}

/// Does it fall by 3 dB on both sides of line `k` before it rises above that?
bool is_peak(const std::vector<double>& size, std::size_t k) {
  const double low = size[k] / std::numbers::sqrt2;
  const auto falls = [&](int step) {
    for (std::size_t i = k + step; i < size.size(); i += step) {  // below 0 it is large
      if (size[i] > size[k]) return false;
      if (size[i] < low) return true;
    }
    return false;
  };
  return size[k] > size[k - 1] && size[k] >= size[k + 1] && falls(-1) && falls(1);
}

/// The mode with the largest term in the modal sum at `omega`.
int leading_mode(const response::ResponseModel& model, const dynamics::ModelVector& damping,
                 int output, int input, double omega) {
  const auto& [omega2, Phi, group] = model.modes;
  int leader = 0;
  double largest = -1.0;
  for (int k = 0; k < model.modes.size(); ++k) {
    const double term = std::abs(Phi(output, k) * Phi(input, k)) /
                        std::hypot(omega2[k] - omega * omega, damping[k] * omega);
    if (!(term > largest)) continue;
    leader = k;
    largest = term;
  }
  return leader;
}

void add_marks(const response::ResponseModel& model, const modal::AnalysedModel& analysed, int legs,
               const std::vector<double>& lines, const std::vector<response::Matrix6c>& H,
               std::vector<double>& numbers) {
  const auto damping = modal_damping(model);
  std::vector<double> size(lines.size());
  for (int output = 0; output < 6; ++output)
    for (int input = 0; input < 6; ++input) {
      if (input == output) continue;  // find_peaks() has those
      for (std::size_t k = 0; k < size.size(); ++k) size[k] = std::abs(H[k](output, input));
      for (std::size_t k = 1; k + 1 < size.size(); ++k) {
        if (!is_peak(size, k)) continue;
        const auto mode =
            analysed.tabled_of_normal.at(leading_mode(model, damping, output, input, lines[k]));
        numbers.insert(numbers.end(), {double(legs), double(output), double(input),
                                       static_cast<double>(k), double(mode + 1)});
      }
    }
}

}  // namespace

response::ResponseModel responses_at(const modal::AnalysedModel& model,
                                     const modal::ModeTable& table, const spatial::Vector3& p_PQ) {
  return response::response_model(model.linear, model.normal, table.ratio.value, p_PQ);
}

void add_responses(std::span<const response::Matrix6c> H, std::vector<double>& numbers) {
  for (const auto& at : H)
    for (int output = 0; output < 6; ++output)
      for (int input = 0; input < 6; ++input) {
        numbers.push_back(at(output, input).real());
        numbers.push_back(at(output, input).imag());
      }
}

std::vector<double> bode_curves(const modal::ModeTable& table, const spatial::Vector3& p_PQ,
                                double from, double to, int points) {
  const auto flexible = responses_at(table.real, table, p_PQ);
  const auto rigid = responses_at(table.rigid, table, p_PQ);
  auto lines = response::log_space(from, to, points);
  add_lines_around_modes(flexible, lines);
  add_lines_around_modes(rigid, lines);
  std::erase_if(lines, [&](double line) { return line < from || line > to; });
  std::sort(lines.begin(), lines.end());
  const auto same = [](double a, double b) { return b <= a * (1.0 + 1e-9); };
  lines.erase(std::unique(lines.begin(), lines.end(), same), lines.end());

  const auto H_flexible = response::frequency_response(flexible, lines);
  const auto H_rigid = response::frequency_response(rigid, lines);
  std::vector<double> numbers{static_cast<double>(lines.size())};
  numbers.insert(numbers.end(), lines.begin(), lines.end());
  add_responses(H_flexible, numbers);
  add_responses(H_rigid, numbers);
  add_marks(flexible, table.real, 0, lines, H_flexible, numbers);
  add_marks(rigid, table.rigid, 1, lines, H_rigid, numbers);
  return numbers;
}

}  // namespace hydrapod::page
