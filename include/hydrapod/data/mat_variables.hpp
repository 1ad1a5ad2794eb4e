#pragma once
/// Named variables in a MAT file of version 5, for results that are no record.
///
/// The writers of MAT files are hydrapod's own. libmatio 1.5.23 cannot append to a variable of
/// version 5. On a full disk its functions for version 5 return 0 and leave a truncated file, those
/// for version 7.3 end in a segmentation fault. Files of version 7.3 have time stamps, so that equal
/// records are not equal files. tests/data/matio_test.cpp reads with libmatio what is written here,
/// and the reverse.

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
