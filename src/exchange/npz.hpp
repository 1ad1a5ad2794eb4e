#pragma once
/// NumPy archives: a ZIP file of .npy members (NEP 1, version 1.0), not compressed.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "zip.hpp"

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
  [[nodiscard]] std::string bytes() const { return zip_.bytes(); }

 private:
  void add_member(const std::string& name, const std::string& kind, const std::string& shape,
                  const std::string& data, bool by_columns);
  ZipWriter zip_{};
};

}  // namespace hydrapod::exchange
