#pragma once
/// NumPy archives: a ZIP file (PKWARE APPNOTE 6.3.3, method 0) of .npy members (NEP 1,
/// version 1.0). Dates of members are 1980-01-01, so that equal data give equal bytes.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace hydrapod::exchange {

class NpzWriter {
 public:
  void add(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& matrix);
  void add_list(const std::string& name, const std::vector<double>& numbers);
  void add_number(const std::string& name, double number);
  /// UTF-8; as an array of kind U.
  void add_texts(const std::string& name, const std::vector<std::string>& texts);
  /// A text without dimensions.
  void add_text(const std::string& name, const std::string& text);
  /// The whole archive.
  [[nodiscard]] std::string bytes() const;

 private:
  void add_member(const std::string& name, const std::string& kind, const std::string& shape,
                  const std::string& data, bool by_columns);
  std::string members_{};
  std::string directory_{};
  int count_{};
};

}  // namespace hydrapod::exchange
