#include "measured_fit.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "identification/fixed_poles.hpp"

namespace hydrapod::page {

namespace {

using Eigen::Index;
using identification::FrequencyResponses;
using report::Json;

[[noreturn]] void refuse(const char* what) {
  throw std::invalid_argument(std::string("measured responses: ") + what);
}

bool all_finite(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

/// Lines, shift and window.
void take_axis(const Json& shape, std::span<const double> frequency, FrequencyResponses& r) {
  r.shift = shape.at("shift").get<double>();
  if (!std::isfinite(r.shift) || r.shift < 0.0) refuse("the shift is no number from 0 on");
  r.frequency.assign(frequency.begin(), frequency.end());
  for (std::size_t k = 0; k < frequency.size(); ++k)
    if (k > 0 ? frequency[k] <= frequency[k - 1] : !(frequency[k] > 0.0))
      refuse("frequencies do not ascend from above 0");
}

void take_window(const Json& shape, std::span<const double> values, FrequencyResponses& r) {
  if (values.empty()) return;
  const double duration = shape.at("duration").get<double>();
  if (!std::isfinite(duration) || !(duration > 0.0)) refuse("the window has no duration");
  r.taper = Eigen::VectorXd::Map(values.data(), static_cast<Index>(values.size())).array() + 1.0;
  r.sample_rate = static_cast<double>(values.size()) / duration;
}

/// Variances σ²_oi of a line as noise and input factor, whose products they are.
void add_errors(const Eigen::MatrixXd& variance, FrequencyResponses& r) {
  const Eigen::VectorXd noise = variance.rowwise().mean();
  const double whole = noise.sum();
  const Eigen::VectorXd factor = whole > 0.0 ? Eigen::VectorXd(variance.colwise().sum() / whole)
                                             : Eigen::VectorXd::Ones(variance.cols());
  r.noise.push_back(noise.cast<std::complex<double>>().asDiagonal());
  r.input_factor.push_back(factor.cast<std::complex<double>>().asDiagonal());
}

FrequencyResponses responses_of(const Json& shape, std::span<const double> numbers) {
  const auto count = [&](const char* key) { return shape.at(key).get<std::uint32_t>(); };
  const std::uint64_t q = count("outputs"), p = count("inputs"), lines = count("lines");
  const bool known = shape.at("deviations").get<bool>();
  const std::size_t kinds = known ? 3 : 2, window = count("window");
  constexpr std::size_t most = 1 << 20;
  if (q == 0 || p == 0 || lines < 2 || q > most || p > most || lines > most) refuse("no lines");
  if (numbers.size() != lines * (1 + kinds * q * p) + window) refuse("another number of values");
  if (!all_finite(numbers)) refuse("not all values are finite");
  FrequencyResponses r;
  take_axis(shape, numbers.first(lines), r);
  take_window(shape, numbers.last(window), r);
  for (std::size_t k = 0; k < lines; ++k) {
    Eigen::MatrixXcd H(q, p);
    Eigen::MatrixXd variance(q, p);
    for (std::size_t o = 0; o < q; ++o)
      for (std::size_t i = 0; i < p; ++i) {
        const double* entry = &numbers[lines * (1 + kinds * (o * p + i)) + k];
        H(o, i) = {entry[0], entry[lines]};
        if (known) variance(o, i) = entry[2 * lines] * entry[2 * lines];
      }
    r.H.push_back(std::move(H));
    if (known) add_errors(variance, r);
  }
  return r;
}

identification::FitOptions options_of(const Json& shape) {
  identification::FitOptions options;
  if (const int terms = shape.at("residual_terms").get<int>(); terms > 0 && terms < 16)
    options.highest_residual_power = identification::lowest_residual_power + terms - 1;
  return options;
}

Eigen::VectorXcd vector_of(const Json& parts) {
  const auto re = parts.at("re").get<std::vector<double>>(),
             im = parts.at("im").get<std::vector<double>>();
  if (re.size() != im.size()) throw std::invalid_argument("a participation has two lengths");
  Eigen::VectorXcd vector(re.size());
  for (std::size_t i = 0; i < re.size(); ++i) vector[static_cast<Index>(i)] = {re[i], im[i]};
  return vector;
}

identification::PoleEstimate pole_of(const Json& given, Index inputs) {
  identification::PoleEstimate estimate;
  estimate.pole = {given.at("pole").at("re").get<double>(),
                   given.at("pole").at("im").get<double>()};
  estimate.participation = vector_of(given.at("participation"));
  if (!std::isfinite(std::abs(estimate.pole)) || estimate.participation.size() != inputs ||
      !estimate.participation.allFinite() || estimate.participation.isZero(0.0))
    throw std::invalid_argument("no pole with a participation of every input");
  return estimate;
}

}  // namespace

MeasuredFit::MeasuredFit(const Json& shape, std::span<const double> numbers)
    : responses_(responses_of(shape, numbers)), system_(responses_, options_of(shape)) {}

std::vector<double> MeasuredFit::fit(const Json& request) {
  std::vector<identification::PoleEstimate> poles;
  for (const auto& given : request.at("poles")) poles.push_back(pole_of(given, system_.inputs()));
  last_ = system_.solved(identification::shared_parameters(poles, system_.inputs()), &last_);
  const auto model = identification::model_of(system_, responses_, last_);
  std::vector<double> numbers{model.error};
  const auto add = [&](std::complex<double> value) {
    numbers.push_back(value.real());
    numbers.push_back(value.imag());
  };
  for (const auto& mode : model.modes)
    for (const auto& element : mode.shape) add(element);
  for (Index o = 0; o < system_.outputs(); ++o)
    for (Index i = 0; i < system_.inputs(); ++i)
      for (Index k = 0; k < system_.lines(); ++k)
        add(responses_.H[static_cast<std::size_t>(k)](o, i) -
            last_.residual(k, o * system_.inputs() + i));
  if (!all_finite(numbers)) throw std::invalid_argument("the fit has no finite values");
  return numbers;
}

}  // namespace hydrapod::page
