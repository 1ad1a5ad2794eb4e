#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <tuple>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

namespace {

/// In double: long double, Boost's default, takes ten times as long for half an epsilon.
using Normal = boost::math::normal_distribution<
    double, boost::math::policies::policy<boost::math::policies::promote_double<false>>>;

double inverse_normal(double u) { return boost::math::quantile(Normal(), u); }
double normal_probability(double x) { return boost::math::cdf(boost::math::normal(), x); }

struct LogNormal {
  double mean, deviation;  ///< of the logarithm
};

LogNormal log_normal(const Distribution& d) {
  const double variance = std::log1p(std::pow(d.b / d.a, 2));
  return {std::log(d.a) - 0.5 * variance, std::sqrt(variance)};
}

double untruncated(const Distribution& d, double u) {
  switch (d.shape) {
    case Shape::normal:
      return d.a + d.b * inverse_normal(u);
    case Shape::lognormal: {
      const auto [mean, deviation] = log_normal(d);
      return std::exp(mean + deviation * inverse_normal(u));
    }
    case Shape::uniform:
      return d.a + (d.b - d.a) * u;
    case Shape::triangular: {
      const double split = (d.c - d.a) / (d.b - d.a);
      return u < split ? d.a + std::sqrt(u * (d.b - d.a) * (d.c - d.a))
                       : d.b - std::sqrt((1.0 - u) * (d.b - d.a) * (d.b - d.c));
    }
    case Shape::values:
      break;
  }
  const auto count = static_cast<double>(d.list.size());
  return d.list[static_cast<std::size_t>(std::min(std::floor(u * count), count - 1.0))];
}

/// F(x) of what is not truncated.
double probability(const Distribution& d, double x) {
  switch (d.shape) {
    case Shape::normal:
      return normal_probability((x - d.a) / d.b);
    case Shape::lognormal: {
      const auto [mean, deviation] = log_normal(d);
      return x > 0.0 ? normal_probability((std::log(x) - mean) / deviation) : 0.0;
    }
    case Shape::uniform:
      return std::clamp((x - d.a) / (d.b - d.a), 0.0, 1.0);
    case Shape::triangular:
      if (x <= d.a) return 0.0;
      if (x >= d.b) return 1.0;
      return x < d.c ? std::pow(x - d.a, 2) / ((d.b - d.a) * (d.c - d.a))
                     : 1.0 - std::pow(d.b - x, 2) / ((d.b - d.a) * (d.b - d.c));
    case Shape::values:
      break;
  }
  return x;
}

constexpr const char* expected =
    "expected \"normal 5 kN/mm ± 10 %\", \"lognormal 5 kN/mm ± 0.5 kN/mm\", "
    "\"uniform 4 .. 6 kN/mm\" or \"triangular 4 .. 5 .. 6 kN/mm\", with the units of the number";

/// Reads the numbers of one distribution.
struct Reader {
  std::string_view unit;
  std::string place;

  [[noreturn]] void fail(const std::string& found) const {
    base::refuse(place, fmt::format("{}; {}", found, expected));
  }
  [[nodiscard]] double number(const std::string& text) const {
    const auto read = base::read_plain_or_quantity(text, unit);
    if (!read.ok())
      base::refuse(place, fmt::format("'{}': {}", base::printable(text), read.problem));
    return read.value;
  }
  /// "4 .. 5 .. 6 kN/mm": numbers without a unit take that of the last one.
  [[nodiscard]] std::vector<double> range(std::string_view text, std::size_t count) const {
    const auto parts = base::split(text, "..");
    if (parts.size() != count)
      fail(fmt::format("'{}' has {} numbers instead of {}", base::printable(text), parts.size(),
                       count));
    const auto blank = parts.back().find(' ');
    const std::string last = blank == std::string::npos ? "" : parts.back().substr(blank);
    std::vector<double> values;
    for (const auto& part : parts)
      values.push_back(number(part.find(' ') == std::string::npos ? part + last : part));
    for (std::size_t k = 1; k < count; ++k)
      if (!(values[k - 1] < values[k]))
        base::refuse(place, fmt::format("'{}' does not ascend: a distribution needs spread",
                                        base::printable(text)));
    return values;
  }
  /// "5 kN/mm ± 10 %": middle and half width or deviation.
  [[nodiscard]] std::pair<double, double> spread(std::string_view text, double nominal) const {
    std::string_view sign = "±";
    auto at = text.find(sign);
    if (at == std::string_view::npos) at = text.find(sign = "+-");
    if (at == std::string_view::npos)
      fail(fmt::format("'{}' has no spread", base::printable(text)));
    const std::string half(base::trimmed(text.substr(at + sign.size())));
    std::string middle(base::trimmed(text.substr(0, at)));
    const auto blank = half.find(' ');
    if (!middle.empty() && middle.find(' ') == std::string::npos && !half.ends_with('%') &&
        blank != std::string::npos)
      middle += half.substr(blank);
    const double center = middle.empty() ? nominal : number(middle);
    const auto share = base::read_quantity(half, "1");
    const double width =
        half.ends_with('%') && share.ok() ? std::abs(center) * share.value : number(half);
    if (!(width > 0.0))
      base::refuse(place, fmt::format("the spread of '{}' is {:g}; it must be more than 0",
                                      base::printable(text), width));
    return {center, width};
  }
};

void truncate(Distribution& d, const Reader& reader, std::string_view within) {
  const auto bounds = reader.range(within, 2);
  d.low = bounds[0];
  d.high = bounds[1];
  constexpr double least = 1e-6;  // of the probability: below, F⁻¹ has lost half its digits
  if (probability(d, *d.high) - probability(d, *d.low) < least)
    base::refuse(reader.place, fmt::format("hardly any of the distribution lies within '{}'",
                                           base::printable(within)));
}

}  // namespace

double quantile(const Distribution& d, double u) {
  if (!d.low || !d.high) return untruncated(d, u);
  const double low = probability(d, *d.low), high = probability(d, *d.high);
  return std::clamp(untruncated(d, low + u * (high - low)), *d.low, *d.high);
}

Distribution read_distribution(std::string_view text, std::string_view unit, double nominal,
                               const std::string& place) {
  const Reader reader{unit, place};
  const std::string_view whole = base::trimmed(text);
  const auto end = std::min(whole.find(' '), whole.size());
  const std::string word(whole.substr(0, end));
  std::string_view rest = base::trimmed(whole.substr(end));
  std::string_view within;
  constexpr std::string_view key = "within ";
  if (const auto at = rest.find(key); at != std::string_view::npos) {
    within = base::trimmed(rest.substr(at + key.size()));
    rest = base::trimmed(rest.substr(0, at));
  }
  Distribution d;
  if (word == "normal" || word == "lognormal") {
    d.shape = word == "normal" ? Shape::normal : Shape::lognormal;
    std::tie(d.a, d.b) = reader.spread(rest, nominal);
    if (d.shape == Shape::lognormal && !(d.a > 0.0))
      base::refuse(place, fmt::format("the mean is {:g}; that of a lognormal is more than 0", d.a));
  } else if (word == "uniform" && rest.find("..") == std::string_view::npos) {
    const auto [center, half] = reader.spread(rest, nominal);
    d = {.shape = Shape::uniform, .a = center - half, .b = center + half};
  } else if (word == "uniform") {
    const auto ends = reader.range(rest, 2);
    d = {.shape = Shape::uniform, .a = ends[0], .b = ends[1]};
  } else if (word == "triangular") {
    const auto points = reader.range(rest, 3);
    d = {.shape = Shape::triangular, .a = points[0], .b = points[2], .c = points[1]};
  } else {
    constexpr std::array<std::string_view, 4> words{"normal", "lognormal", "uniform", "triangular"};
    const auto near = base::nearest(word, words);
    reader.fail(near ? fmt::format("unknown distribution '{}', did you mean '{}'",
                                   base::printable(word), *near)
                     : fmt::format("unknown distribution '{}'", base::printable(word)));
  }
  if (!within.empty()) truncate(d, reader, within);
  return d;
}

}  // namespace hydrapod::study
