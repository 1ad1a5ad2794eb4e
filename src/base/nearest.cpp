#include "hydrapod/base/text.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace hydrapod::base {

namespace {
constexpr std::size_t longest_word = 64;
constexpr int whole_edit = 2;

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

int replacement_cost(char a, char b) {
  if (a == b) return 0;
  return lower(a) == lower(b) ? 1 : whole_edit;
}

int allowed_distance(std::string_view word) {
  const int letters = static_cast<int>(word.size());
  const int edits = std::max(1, letters / 3);
  return std::min(edits * whole_edit, letters * whole_edit - 1);
}
}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
  // Rows i-2, i-1 and i of the table of distances between the first i and the first j letters.
  std::array<std::vector<int>, 3> rows;
  for (auto& row : rows) row.assign(b.size() + 1, 0);
  for (std::size_t j = 0; j <= b.size(); ++j) rows[0][j] = static_cast<int>(j) * whole_edit;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    const auto& before = rows[(i - 1) % 3];
    auto& row = rows[i % 3];
    row[0] = static_cast<int>(i) * whole_edit;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({before[j] + whole_edit, row[j - 1] + whole_edit,
                         before[j - 1] + replacement_cost(a[i - 1], b[j - 1])});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                           lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], rows[(i - 2) % 3][j - 2] + whole_edit);
    }
  }
  return rows[a.size() % 3][b.size()];
}

std::optional<std::string_view> nearest(std::string_view word,
                                        std::span<const std::string_view> candidates) {
  if (word.empty() || word.size() > longest_word) return std::nullopt;
  std::optional<std::string_view> best;
  int best_distance = allowed_distance(word) + 1;
  for (const std::string_view candidate : candidates) {
    const bool same_letters =
        std::equal(word.begin(), word.end(), candidate.begin(), candidate.end(),
                   [](char a, char b) { return lower(a) == lower(b); });
    if (same_letters) return candidate;
    const int distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace hydrapod::base
