#pragma once
/// ZIP files (PKWARE APPNOTE 6.3.3) of members below 4 GiB, stored or deflated. Dates of members
/// are 1980-01-01, so that equal data give equal bytes.

#include <string>

namespace hydrapod::exchange {

class ZipWriter {
 public:
  enum class Method { stored, deflated };
  /// `name` in ASCII, folders with slashes.
  void add(const std::string& name, const std::string& content, Method method = Method::stored);
  /// The whole archive.
  [[nodiscard]] std::string bytes() const;

 private:
  std::string members_{};
  std::string directory_{};
  int count_{};
};

}  // namespace hydrapod::exchange
