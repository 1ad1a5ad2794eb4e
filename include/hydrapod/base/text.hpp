#pragma once
/// Small operations on text. Letters are those of ASCII.
///
/// Which known word was probably meant.
///
/// Text from outside, made fit for a message.
///
/// "z=5 mm, rx=0.5 deg": keys with values, as people write them in one argument.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// `text` in one line of valid UTF-8: control characters and broken bytes become `?`, and what goes
/// beyond `limit` bytes is cut off between two characters and marked with `...`.
std::string printable(std::string_view text, std::size_t limit = 60);

/// Number of characters of UTF-8, not of bytes.
inline std::size_t characters(std::string_view text) {
  std::size_t count = 0;
  for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
  return count;
}

/// Byte at which `text` stops being valid UTF-8; npos when all of it is.
std::size_t first_invalid_utf8(std::string_view text);

/// Is it UTF-16, two bytes per character, as "Unicode" of editors and spreadsheets? By the byte
/// order mark, or by a zero in every second byte of the beginning.
bool is_utf16(std::string_view text);
inline constexpr std::string_view utf16_refused = "UTF-16 text; save the file as UTF-8";

/// `text` without blanks, tabs and line ends at both ends.
std::string_view trimmed(std::string_view text);

std::string lower_case(std::string_view text);

/// `text` cut at each `separator`, every part trimmed. An empty text is one empty part.
std::vector<std::string> split(std::string_view text, std::string_view separator);

/// Does `path` end with one of `endings`? Upper and lower case are the same.
bool has_ending(std::string_view path, std::initializer_list<std::string_view> endings);

/// One argument's keys and values. What is wrong throws base::InputError with the place and what
/// would be accepted.
class KeyValues {
 public:
  /// `place` is what messages call the argument.
  KeyValues(std::string place, std::string_view text);

  std::optional<std::string> text(std::string_view key);
  /// A quantity of the dimension of `unit`, or a plain number: SI.
  std::optional<double> number(std::string_view key, const char* unit);
  /// A whole number between `low` and `high`.
  std::optional<int> whole(std::string_view key, int low, int high);
  /// Any number of 64 bits.
  std::optional<std::uint64_t> seed(std::string_view key);
  /// One of two words; whether it is the first.
  std::optional<bool> choice(std::string_view key, std::string_view yes, std::string_view no);

  /// Throws for a key that was not asked for; those that were are the known ones.
  void finish() const;
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string place_;
  std::map<std::string, std::string, std::less<>> values_{};
  std::vector<std::string> known_{};
};

}  // namespace hydrapod::base
