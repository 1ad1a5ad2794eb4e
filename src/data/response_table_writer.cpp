#include <fmt/format.h>

#include <cmath>

#include "hydrapod/base/file.hpp"
#include "hydrapod/data/frequency_response.hpp"
#include "response_comments.hpp"

namespace hydrapod::data {

namespace {

using Eigen::Index;
using Matrices = PerLine<Eigen::MatrixXcd>;

/// Columns of complex entries: their titles, then their numbers line by line.
struct Entries {
  const char* group{};  ///< empty: responses
  const Matrices* matrices{};
  const std::vector<Channel>*rows{}, *columns{};
  bool lower_triangle{};

  template <class Use>
  void each(Use use) const {
    for (std::size_t i = 0; i < rows->size(); ++i)
      for (std::size_t j = 0; j < (lower_triangle ? i + 1 : columns->size()); ++j)
        use(static_cast<Index>(i), static_cast<Index>(j));
  }
  [[nodiscard]] std::string pair(Index i, Index j) const {
    return (*rows)[static_cast<std::size_t>(i)].name + "/" +
           (*columns)[static_cast<std::size_t>(j)].name;
  }
};

void add_titles(const Entries& entries, std::string& text) {
  const std::string group = std::string(entries.group) + " ";
  entries.each([&](Index i, Index j) {
    for (const char* part : {"re ", "im "})
      text += "," + base::quoted_cell(group + part + entries.pair(i, j));
  });
}

void add_numbers(const Entries& entries, std::size_t line, std::string& text) {
  entries.each([&](Index i, Index j) {
    const auto value = (*entries.matrices)[line](i, j);
    text += fmt::format(",{:.17g},{:.17g}", value.real(), value.imag());
  });
}

std::string title_row(const FrequencyResponses& all, const Entries& shown,
                      const std::vector<Entries>& others) {
  std::string text = "frequency_hz";
  shown.each([&](Index o, Index i) {
    const std::string pair = shown.pair(o, i);
    text += fmt::format(",{},{}", base::quoted_cell("re " + pair), base::quoted_cell("im " + pair));
    if (all.has_errors()) text += "," + base::quoted_cell("deviation " + pair);
  });
  for (const Channel& output : all.outputs)
    text += "," + base::quoted_cell("coherence " + output.name);
  text += ",condition";
  for (const Entries& entries : others) add_titles(entries, text);
  return text + "\n";
}

}  // namespace

std::string response_table(const FrequencyResponses& all) {
  validate(all);
  const Entries shown{"", &required_on_axis(all), &all.outputs, &all.inputs};
  std::vector<Entries> others;
  if (all.shift > 0.0)
    others.push_back({response_part::beside_axis, &all.H, &all.outputs, &all.inputs});
  if (all.has_errors()) {
    others.push_back({response_part::noise, &all.noise, &all.outputs, &all.outputs, true});
    others.push_back(
        {response_part::input_factor, &all.input_factor, &all.inputs, &all.inputs, true});
  }
  std::string text = response_comments(all) + title_row(all, shown, others);
  for (std::size_t k = 0; k < all.lines(); ++k) {
    text += fmt::format("{:.17g}", all.frequency[k]);
    shown.each([&](Index o, Index i) {
      const auto value = (*shown.matrices)[k](o, i);
      text += fmt::format(",{:.17g},{:.17g}", value.real(), value.imag());
      if (all.has_errors()) text += fmt::format(",{:.6g}", std::sqrt(all.variance(k, o, i)));
    });
    for (Index o = 0; o < all.H[k].rows(); ++o)
      text += all.multiple_coherence.empty() ? ","
                                             : fmt::format(",{:.6g}", all.multiple_coherence[k][o]);
    text += all.condition.empty() ? "," : fmt::format(",{:.6g}", all.condition[k]);
    for (const Entries& entries : others) add_numbers(entries, k, text);
    text += '\n';
  }
  return text;
}

}  // namespace hydrapod::data
