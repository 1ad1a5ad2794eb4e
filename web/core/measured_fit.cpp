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

/// Variances σ²_oi of a line as noise and input factor, whose products they are, with the
/// correlation of inputs.
void add_errors(const Eigen::MatrixXd& variance, const Eigen::MatrixXcd& correlation,
                FrequencyResponses& r) {
  const Eigen::VectorXd noise = variance.rowwise().mean();
  const double whole = noise.sum();
  Eigen::VectorXd own = Eigen::VectorXd::Ones(variance.cols());
  if (whole > 0.0) own = (variance.colwise().sum().transpose() / whole).cwiseSqrt();
  r.noise.push_back(noise.cast<std::complex<double>>().asDiagonal());
  r.input_factor.push_back(own.asDiagonal() * correlation * own.asDiagonal());
}

/// Lists of one number per line, one after the other.
class Lists {
 public:
  Lists(std::span<const double> numbers, std::size_t lines) : left_(numbers), lines_(lines) {}
  std::span<const double> next() {
    const auto list = left_.first(lines_);
    left_ = left_.subspan(lines_);
    return list;
  }

 private:
  std::span<const double> left_;
  std::size_t lines_;
};

/// By line. Rounded numbers must not make it singular: a little less is taken than they say.
std::vector<Eigen::MatrixXcd> correlation_in(Lists& lists, std::size_t p, std::size_t lines,
                                             bool any) {
  constexpr double kept = 1.0 - 1e-4;
  std::vector<Eigen::MatrixXcd> correlation(lines, Eigen::MatrixXcd::Identity(p, p));
  for (std::size_t i = 0; i < p && any; ++i)
    for (std::size_t j = i + 1; j < p; ++j) {
      const auto re = lists.next(), im = lists.next();
      for (std::size_t k = 0; k < lines; ++k) {
        if (std::hypot(re[k], im[k]) > 1.0 + 1e-4) refuse("a correlation is above 1");
        correlation[k](i, j) = kept * std::complex(re[k], im[k]);
        correlation[k](j, i) = std::conj(correlation[k](i, j));
      }
    }
  return correlation;
}

FrequencyResponses responses_of(const Json& shape, std::span<const double> numbers) {
  const auto count = [&](const char* key) { return shape.at(key).get<std::uint32_t>(); };
  const std::uint64_t q = count("outputs"), p = count("inputs"), lines = count("lines");
  const bool known = shape.at("deviations").get<bool>();
  const bool correlated = shape.at("correlation").get<bool>();
  const std::size_t window = count("window");
  constexpr std::uint64_t most = 1 << 20;
  if (q == 0 || p == 0 || lines < 2 || q > most || p > most || lines > most) refuse("no lines");
  if (correlated && !known) refuse("a correlation of errors that are not known");
  const std::uint64_t lists = 1 + (known ? 3 : 2) * q * p + (correlated ? p * (p - 1) : 0);
  if (numbers.size() != lines * lists + window) refuse("another number of values");
  if (!all_finite(numbers)) refuse("not all values are finite");
  FrequencyResponses r;
  Lists all(numbers, lines);
  take_axis(shape, all.next(), r);
  take_window(shape, numbers.last(window), r);
  std::vector<Eigen::MatrixXcd> H(lines, Eigen::MatrixXcd(q, p));
  std::vector<Eigen::MatrixXd> variance(known ? lines : 0, Eigen::MatrixXd(q, p));
  for (std::size_t o = 0; o < q; ++o)
    for (std::size_t i = 0; i < p; ++i) {
      const auto re = all.next(), im = all.next();
      for (std::size_t k = 0; k < lines; ++k) H[k](o, i) = {re[k], im[k]};
      if (!known) continue;
      const auto deviation = all.next();
      for (std::size_t k = 0; k < lines; ++k) variance[k](o, i) = deviation[k] * deviation[k];
    }
  r.H = std::move(H);
  if (!known) return r;
  const auto correlation = correlation_in(all, p, lines, correlated);
  for (std::size_t k = 0; k < lines; ++k) add_errors(variance[k], correlation[k], r);
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
