#pragma once
/// "z=5 mm, rx=0.5 deg": keys with values, as people write them in one argument.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::base {

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
