#pragma once
/// Which known word was probably meant.

#include <optional>
#include <span>
#include <string_view>

namespace hydrapod::base {

/// Edits (insert, delete, replace, swap two neighbours) that turn `a` into `b`, letter case
/// counting as half an edit: restricted Damerau-Levenshtein distance in half edits.
int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`, the first of equally near ones; none when no candidate is near
/// enough to be a slip of the finger (one edit per three letters, at least one, and fewer edits
/// than the word has letters; a difference in letter case alone always is near). Words longer than
/// 64 bytes match nothing.
std::optional<std::string_view> nearest(std::string_view word,
                                        std::span<const std::string_view> candidates);

}  // namespace hydrapod::base
