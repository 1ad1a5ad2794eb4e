#pragma once
/// What a reader has to say about a file, without saying the same thing a million times.

#include <map>
#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"

namespace hydrapod::data {

class Notes {
 public:
  explicit Notes(std::string file) : file_(std::move(file)) {}

  /// A warning. Of those with the same non-empty `kind` only the first is kept; it counts the
  /// others
  /// ("and 14 more").
  void add(std::string message, unsigned line = 0, unsigned column = 0,
           const std::string& kind = "");

  [[nodiscard]] const std::vector<base::Diagnostic>& all() const { return all_; }
  [[nodiscard]] const std::string& file() const { return file_; }

  /// Throws base::InputError: what has been noted, then an error at that place.
  [[noreturn]] void fail(std::string message, unsigned line = 0, unsigned column = 0) const;

 private:
  struct Repeated {
    std::size_t index{};
    std::string message{};
    std::size_t more{};
  };
  static constexpr std::size_t most = 100;  ///< notes; a broken file must not fill the screen

  std::string file_;
  std::vector<base::Diagnostic> all_;
  std::map<std::string, Repeated> repeated_;
};

}  // namespace hydrapod::data
