#include "curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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

/// |H_oi| at the lines.
std::vector<double> sizes(const std::vector<response::Matrix6c>& H, int output, int input) {
  std::vector<double> size;
  for (const auto& at : H) size.push_back(std::abs(at(output, input)));
  return size;
}

double largest(const std::vector<double>& size) {
  return *std::max_element(size.begin(), size.end());
}

/// Where a direction is not coupled to another one the response between them is rounding.
bool is_coupled(double most, double output, double input) {
  constexpr double rounding = 1e-9;
  return most > rounding * std::sqrt(output * input);
}

void add_marks(const response::ResponseModel& model, const modal::AnalysedModel& analysed, int legs,
               const std::vector<double>& lines, const std::vector<response::Matrix6c>& H,
               std::vector<double>& numbers) {
  std::array<double, 6> direct{};
  for (int d = 0; d < 6; ++d) direct[d] = largest(sizes(H, d, d));
  for (int output = 0; output < 6; ++output)
    for (int input = 0; input < 6; ++input) {
      if (input == output) continue;  // find_peaks() has those
      const auto size = sizes(H, output, input);
      if (!is_coupled(largest(size), direct[output], direct[input])) continue;
      for (const auto& peak :
           response::line_peaks(size, response::PeakOptions{}.min_prominence_db)) {
        const int behind = response::mode_behind(model, lines[peak.line], output, input);
        numbers.insert(numbers.end(),
                       {double(legs), double(output), double(input), static_cast<double>(peak.line),
                        double(analysed.tabled_of_normal.at(behind) + 1)});
      }
    }
}

}  // namespace

response::ResponseModel responses_at(const modal::AnalysedModel& model,
                                     const modal::ModeTable& table, const spatial::Vector3& p_PQ) {
  return response::response_model(model.linear, model.normal, table.ratio.value, p_PQ);
}

response::DampedShapes damped_shapes(const modal::AnalysedModel& model) {
  const auto n = static_cast<Eigen::Index>(model.modes.size());
  if (n != model.normal.size()) return {};
  response::DampedShapes damped{.real = dynamics::ModelMatrix(n, n),
                                .imaginary = dynamics::ModelMatrix(n, n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& mode = model.modes[static_cast<std::size_t>(k)].mode;
    if (!(mode.pole.imag() > 0.0)) return {};
    damped.poles.push_back(mode.pole);
    damped.real.col(k) = mode.real;
    damped.imaginary.col(k) = mode.imaginary;
  }
  return damped;
}

void add_responses(std::span<const response::Matrix6c> H, std::vector<double>& numbers) {
  for (const auto& at : H)
    for (int output = 0; output < 6; ++output)
      for (int input = 0; input < 6; ++input) {
        numbers.push_back(at(output, input).real());
        numbers.push_back(at(output, input).imag());
      }
}

void add_direct_responses(std::span<const response::DirectLine> H, std::vector<double>& numbers) {
  const auto* first = reinterpret_cast<const double*>(H.data());  // re, im, re, im, …
  numbers.insert(numbers.end(), first, first + 12 * H.size());
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
  numbers.reserve(146 * lines.size());
  numbers.insert(numbers.end(), lines.begin(), lines.end());
  add_responses(H_flexible, numbers);
  add_responses(H_rigid, numbers);
  add_marks(flexible, table.real, 0, lines, H_flexible, numbers);
  add_marks(rigid, table.rigid, 1, lines, H_rigid, numbers);
  return numbers;
}

}  // namespace hydrapod::page
