#include <fmt/format.h>

#include <cmath>

#include "hydrapod/base/file.hpp"
#include "hydrapod/data/frequency_response.hpp"
#include "response_comments.hpp"
#include "uff_geometry.hpp"
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

/// The functions of all responses, one behind the other.
class ResponseText {
 public:
  ResponseText(const FrequencyResponses& all, bool binary) : all_(all), binary_(binary) {}

  std::string text() {
    text_ = uff_beginning(all_.title, all_.date, response_comments(all_)) +
            uff_geometry_text(all_.geometry);
    const auto& shown = required_on_axis(all_);
    for (std::size_t o = 0; o < all_.outputs.size(); ++o) {
      for (std::size_t i = 0; i < all_.inputs.size(); ++i) add_response(shown, o, i);
      if (!all_.multiple_coherence.empty()) add_coherence(o);
    }
    if (all_.shift > 0.0)
      for (std::size_t o = 0; o < all_.outputs.size(); ++o)
        for (std::size_t i = 0; i < all_.inputs.size(); ++i)
          add_part(response_part::beside_axis, all_.H, all_.outputs[o], o, all_.inputs[i], i);
    if (all_.has_errors()) {
      add_covariance(response_part::noise, all_.noise, all_.outputs);
      add_covariance(response_part::input_factor, all_.input_factor, all_.inputs);
    }
    return std::move(text_);
  }

 private:
  void add_response(const PerLine<Eigen::MatrixXcd>& H, std::size_t o, std::size_t i) {
    const Channel &output = all_.outputs[o], &input = all_.inputs[i];
    UffFunction f = head_of(all_, output, binary_);
    f.type = uff_function::frequency_response;
    f.number = ++number_;
    f.is_complex = true;
    f.id[0] = fmt::format("{} from {}", output.name, input.name);
    f.id[4] = input.name;
    const auto own_lines = f.id;
    if (!all_.id_lines.empty()) put_id_lines(all_.id_lines[o * all_.inputs.size() + i], f.id);
    f.reference = uff_place(input);
    f.ordinate = uff_axis_of(output.name, output.unit);
    f.denominator = uff_axis_of(input.name, input.unit);
    const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(i);
    text_ += function_text(f, all_.frequency, [&](std::size_t k) { return H[k](row, column); });
    if (!all_.has_errors()) return;
    f.type = uff_function::general;
    f.is_complex = false;
    f.id = own_lines;
    f.id[0] = response_part::variance;
    f.ordinate.unit = f.denominator.unit = "NONE";
    f.ordinate.quantity = f.denominator.quantity = uff_quantity::unknown;
    text_ += function_text(f, all_.frequency,
                           [&](std::size_t k) { return all_.variance(k, row, column); });
  }

  void add_coherence(std::size_t o) {
    UffFunction f = head_of(all_, all_.outputs[o], binary_);
    f.type = uff_function::multiple_coherence;
    f.ordinate = {.quantity = uff_quantity::unknown, .label = "multiple coherence", .unit = "1"};
    text_ += function_text(f, all_.frequency, [&](std::size_t k) {
      return all_.multiple_coherence[k][static_cast<Eigen::Index>(o)];
    });
  }

  /// An entry of matrices that other programs do not know.
  void add_part(const char* name, const PerLine<Eigen::MatrixXcd>& matrices, const Channel& of,
                std::size_t row, const Channel& to, std::size_t column) {
    UffFunction f = head_of(all_, of, binary_);
    f.is_complex = true;
    f.id[0] = name;
    f.id[4] = to.name;
    f.reference = uff_place(to);
    f.ordinate = {.label = name};
    text_ += function_text(f, all_.frequency, [&](std::size_t k) {
      return matrices[k](static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    });
  }

  /// The lower triangles.
  void add_covariance(const char* name, const PerLine<Eigen::MatrixXcd>& matrices,
                      const std::vector<Channel>& channels) {
    for (std::size_t i = 0; i < channels.size(); ++i)
      for (std::size_t j = 0; j <= i; ++j) add_part(name, matrices, channels[i], i, channels[j], j);
  }

  const FrequencyResponses& all_;
  bool binary_;
  std::string text_{};
  long long number_{};
};

}  // namespace

void write_frequency_responses(const std::string& path, const FrequencyResponses& all,
                               bool binary) {
  validate(all);
  base::write_file_whole(path, ResponseText(all, binary).text());
}

}  // namespace hydrapod::data
