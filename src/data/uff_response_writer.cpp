#include <fmt/format.h>

#include <cmath>

#include "hydrapod/base/file.hpp"
#include "hydrapod/data/frequency_response.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

/// Increments of even frequencies; 0 where they are not even.
double even_step(const std::vector<double>& frequency) {
  if (frequency.size() < 2) return 0.0;
  const double step =
      (frequency.back() - frequency.front()) / static_cast<double>(frequency.size() - 1);
  constexpr double tolerance = 1e-6;
  for (std::size_t k = 0; k < frequency.size(); ++k)
    if (std::abs(frequency[k] - (frequency[0] + static_cast<double>(k) * step)) > tolerance * step)
      return 0.0;
  return step;
}

/// Does the six-digit abscissa of a header say all of it?
bool fits_six_digits(double first, double step, std::size_t count) {
  const auto rounded = [](double value) {
    return fortran_number(fortran_e(value, 13, 5)).value_or(0.0);
  };
  const double last = static_cast<double>(count - 1);
  return std::abs(rounded(first) + last * rounded(step) - (first + last * step)) <= 1e-6 * step;
}

UffFunction head_of(const FrequencyResponses& all, const Channel& output, bool binary) {
  UffFunction f;
  f.id = {output.name, all.title, uff_date(all.date), output.name, "NONE"};
  f.response = uff_place(output);
  f.declared = all.lines();
  const double step = even_step(all.frequency);
  f.is_even = step > 0.0 && fits_six_digits(all.frequency[0], step, all.frequency.size());
  f.first = f.is_even ? all.frequency[0] : 0.0;
  f.step = f.is_even ? step : 0.0;
  f.binary = binary;
  f.abscissa = {.quantity = uff_quantity::frequency, .label = "Frequency", .unit = "Hz"};
  return f;
}

/// The head, then the numbers that `value` gives for a frequency.
template <typename Value>
std::string function_text(const UffFunction& f, const std::vector<double>& frequency, Value value) {
  std::string out = uff_function_head(f);
  UffNumbers numbers(f);
  for (std::size_t k = 0; k < frequency.size(); ++k) {
    if (!f.is_even) numbers.add(frequency[k], out);
    const std::complex<double> number = value(k);
    numbers.add(number.real(), out);
    if (f.is_complex) numbers.add(number.imag(), out);
  }
  numbers.finish(out);
  return out;
}

}  // namespace

void write_frequency_responses(const std::string& path, const FrequencyResponses& all,
                               bool binary) {
  validate(all);
  std::string out = uff_beginning(all.title, all.date);
  long long number = 0;
  for (std::size_t o = 0; o < all.outputs.size(); ++o) {
    const auto row = static_cast<Eigen::Index>(o);
    for (std::size_t i = 0; i < all.inputs.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      UffFunction f = head_of(all, all.outputs[o], binary);
      f.type = uff_function::frequency_response;
      f.number = ++number;
      f.is_complex = true;
      f.id[0] = fmt::format("{} from {}", all.outputs[o].name, all.inputs[i].name);
      f.id[4] = all.inputs[i].name;
      f.reference = uff_place(all.inputs[i]);
      f.ordinate = uff_axis_of(all.outputs[o].name, all.outputs[o].unit);
      f.denominator = uff_axis_of(all.inputs[i].name, all.inputs[i].unit);
      out += function_text(f, all.frequency, [&](std::size_t k) { return all.H[k](row, column); });
      if (!all.has_errors()) continue;
      f.type = uff_function::general;
      f.is_complex = false;
      f.id[0] = "variance";
      f.ordinate.unit = f.denominator.unit = "NONE";
      f.ordinate.quantity = f.denominator.quantity = uff_quantity::unknown;
      out += function_text(f, all.frequency, [&](std::size_t k) {
        return all.variance(k, static_cast<int>(o), static_cast<int>(i));
      });
    }
    if (all.multiple_coherence.empty()) continue;
    UffFunction f = head_of(all, all.outputs[o], binary);
    f.type = uff_function::multiple_coherence;
    f.ordinate = {.quantity = uff_quantity::unknown, .label = "multiple coherence", .unit = "1"};
    out += function_text(f, all.frequency,
                         [&](std::size_t k) { return all.multiple_coherence[k][row]; });
  }
  base::write_file_whole(path, out);
}

}  // namespace hydrapod::data
