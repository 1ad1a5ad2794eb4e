#include "array_candidates.hpp"

#include <algorithm>
#include <array>

#include "hydrapod/base/text.hpp"
#include "response_files.hpp"
#include "variables_beside.hpp"

namespace hydrapod::data {

namespace {

constexpr std::array<std::string_view, 15> hertz_words{"f",
                                                       "freq",
                                                       "freqs",
                                                       "frequency",
                                                       "frequencies",
                                                       "frequency_hz",
                                                       "freq_hz",
                                                       "f_hz",
                                                       "fhz",
                                                       "hz",
                                                       "frequenz",
                                                       "freqvec",
                                                       "freq_vector",
                                                       "frequency_vector",
                                                       "freq_vector_hz"};
constexpr std::array<std::string_view, 5> circular_words{"omega", "w", "ω", "omega_rad_s",
                                                         "w_rad_s"};
struct PartEndings {
  std::string_view real, imaginary;
};
constexpr std::array part_endings{PartEndings{"_re", "_im"}, PartEndings{"_real", "_imag"},
                                  PartEndings{"/re", "/im"}, PartEndings{"/real", "/imag"},
                                  PartEndings{".re", ".im"}, PartEndings{".real", ".imag"}};

bool is_text(const std::vector<Variable>& all, const std::string& name, const char* text) {
  return std::ranges::any_of(all, [&](const Variable& v) {
    return v.kind == VariableKind::text && v.name == name && v.text == text;
  });
}

/// MATLAB names the index first that runs fastest, numpy the one that runs slowest.
std::vector<std::uint64_t> users_sizes(const VariableFile& file, const Variable& v) {
  auto sizes = v.sizes;
  if (file.format() == RecordFormat::hdf5) std::ranges::reverse(sizes);
  if (file.format() == RecordFormat::hdf5 && sizes.size() == 2 && sizes[0] == 1)
    sizes.erase(sizes.begin());  // a list
  return sizes;
}

bool is_list(const Variable& v) {
  return v.kind == VariableKind::numbers && !v.is_complex && std::min(v.fast, v.slow) == 1 &&
         std::max(v.fast, v.slow) > 1;
}

}  // namespace

std::vector<Candidate> candidates(const VariableFile& file) {
  const auto& all = file.variables();
  std::vector<Candidate> found;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool holds = all[k].kind == VariableKind::numbers || all[k].kind == VariableKind::array;
    if (!holds) continue;
    if (all[k].is_complex) found.push_back({all[k].name, k, {}, users_sizes(file, all[k])});
    if (all[k].is_complex) continue;
    const std::string name = base::lower_case(all[k].name);
    for (const auto& [real, imaginary] : part_endings) {
      if (!name.ends_with(real) || name.size() == real.size()) continue;
      const std::string stem = all[k].name.substr(0, name.size() - real.size());
      const std::string other = base::lower_case(stem) + std::string(imaginary);
      for (std::size_t j = 0; j < all.size(); ++j)
        if (base::lower_case(all[j].name) == other && all[j].sizes == all[k].sizes &&
            !all[j].is_complex)
          found.push_back({stem, k, j, users_sizes(file, all[k])});
    }
  }
  return found;
}

bool has_size(const Candidate& candidate, std::uint64_t size) {
  return std::ranges::find(candidate.sizes, size) != candidate.sizes.end();
}

bool is_circular_frequency(const std::string& name) { return is_one_of(circular_words, name); }

std::vector<std::size_t> frequency_lists(const VariableFile& file,
                                         const std::vector<Candidate>& arrays) {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < file.variables().size(); ++k) {
    const Variable& v = file.variables()[k];
    if (!is_list(v) || !(is_one_of(hertz_words, v.name) || is_circular_frequency(v.name))) continue;
    const auto fits = [&](const Candidate& c) { return has_size(c, std::max(v.fast, v.slow)); };
    if (std::ranges::any_of(arrays, fits)) found.push_back(k);
  }
  return found;
}

bool holds_own_responses(const VariableFile& file) {
  return is_text(file.variables(), "format", responses_mark);
}

void require_imaginary_parts(const FrequencyResponses& all, const Notes& notes) {
  const auto is_real = [](const Eigen::MatrixXcd& H) { return H.imag().isZero(0.0); };
  if (std::ranges::all_of(all.H, is_real))
    notes.fail(
        "all imaginary parts are 0: these are magnitudes, or real parts alone; expected are "
        "frequency responses with their phases");
}

bool holds_responses(VariableFile& file) {
  const auto& all = file.variables();
  if (holds_own_responses(file)) return true;
  const bool times = std::ranges::any_of(
      all, [](const Variable& v) { return is_list(v) && is_time_variable(v.name); });
  const auto lists = times ? std::vector<std::size_t>{} : frequency_lists(file, candidates(file));
  std::vector<std::complex<double>> numbers;  // a force may be called f too, but does not ascend
  return std::ranges::any_of(lists, [&](std::size_t list) {
    return file.read_all(list, numbers) &&
           std::ranges::adjacent_find(numbers, std::greater_equal<>(),
                                      [](const std::complex<double>& f) { return f.real(); }) ==
               numbers.end();
  });
}

const char* what_else(VariableFile& file) {
  if (is_text(file.variables(), "format", "hydrapod state space"))
    return "the file holds a state space that `hydrapod export` wrote, no samples over time";
  return holds_responses(file) ? "the file holds frequency responses, no samples over time"
                               : nullptr;
}

}  // namespace hydrapod::data
