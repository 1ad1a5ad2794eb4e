#pragma once
/// Named variables in a MAT file of version 5, for results that are no record.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace hydrapod::data {

/// An array of numbers, a text, or a row of texts (a cell array).
struct MatVariable {
  std::string name{};
  std::vector<int> size{};  ///< of the array, two numbers or more; numbers by columns
  std::vector<double> real{};
  std::vector<double> imaginary{};  ///< empty: real
  std::vector<std::string> texts{};
  bool is_text{}, is_list{};
};

MatVariable mat_number(const std::string& name, double value);
MatVariable mat_array(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& values);
MatVariable mat_complex(const std::string& name, const Eigen::Ref<const Eigen::MatrixXcd>& values);
/// One matrix behind the other: rows × columns × pages. All of one size.
MatVariable mat_pages(const std::string& name, const std::vector<Eigen::MatrixXcd>& pages);
MatVariable mat_pages(const std::string& name, const std::vector<Eigen::MatrixXd>& pages);
MatVariable mat_text(const std::string& name, const std::string& text);
MatVariable mat_list(const std::string& name, const std::vector<std::string>& texts);

/// Written whole or not at all. Throws std::invalid_argument for names that MATLAB does not take
/// and sizes that do not fit, base::ComputationError for more than 2 GiB, else as
/// base::write_file_whole.
void write_mat_variables(const std::string& path, const std::vector<MatVariable>& variables);

}  // namespace hydrapod::data
