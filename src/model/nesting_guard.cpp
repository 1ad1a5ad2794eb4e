#include "nesting_guard.hpp"

namespace hydrapod::model {

namespace {

constexpr int deepest = 32;

/// Just enough of TOML's lexical rules to tell brackets and dots from the insides of strings and
/// comments. Malformed text may be judged either way: the parser has the last word on it.
class NestingScanner {
 public:
  explicit NestingScanner(std::string_view text) : text_(text) {}

  std::optional<NestingFault> scan() {
    while (at_ < text_.size()) {
      const std::size_t here = at_;
      step();
      if (brackets_ > deepest) return NestingFault{here, "brackets nested more than 32 deep"};
      if (dots_ > deepest) return NestingFault{here, "a dotted key of more than 32 parts"};
    }
    return std::nullopt;
  }

 private:
  void step() {
    const char c = text_[at_];
    if (c == '#') {
      skip_to_end_of_line();
    } else if (c == '"' || c == '\'') {
      skip_string(c);
    } else {
      ++at_;
      count(c);
    }
  }

  void count(char c) {
    if (c == '[' || c == '{') {
      ++brackets_;
    } else if (c == ']' || c == '}') {
      if (brackets_ > 0) --brackets_;
    } else if (c == '.') {
      ++dots_;
      return;
    }
    constexpr std::string_view ends_a_key = "[]{}=,\n";
    if (ends_a_key.find(c) != std::string_view::npos) dots_ = 0;
  }

  void skip_to_end_of_line() {
    const auto end = text_.find('\n', at_);
    at_ = end == std::string_view::npos ? text_.size() : end;
  }

  void skip_string(char quote) {
    const std::string triple(3, quote);
    const bool multiline = text_.substr(at_).starts_with(triple);
    const std::string_view closing = std::string_view(triple).substr(0, multiline ? 3 : 1);
    at_ += closing.size();
    while (at_ < text_.size() && !text_.substr(at_).starts_with(closing)) {
      if (!multiline && text_[at_] == '\n') return;
      at_ += quote == '"' && text_[at_] == '\\' ? 2 : 1;
    }
    at_ = at_ < text_.size() ? at_ + closing.size() : text_.size();
    // Up to two quotes before the closing three belong to the string.
    for (int i = 0; multiline && i < 2 && at_ < text_.size() && text_[at_] == quote; ++i) ++at_;
  }

  std::string_view text_;
  std::size_t at_{};
  int brackets_{};
  int dots_{};
};

}  // namespace

std::optional<NestingFault> check_nesting(std::string_view text) {
  return NestingScanner(text).scan();
}

}  // namespace hydrapod::model
