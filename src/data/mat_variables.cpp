#include "hydrapod/data/record_io.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "mat5_elements.hpp"
#include "mat5_layout.hpp"

namespace hydrapod::data {

namespace {

constexpr std::size_t longest_name = 63;

void require_name(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto allowed = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  if (name.empty() || name.size() > longest_name || !letter(name[0]) ||
      !std::ranges::all_of(name, allowed))
    throw std::invalid_argument(
        fmt::format("'{}' is no name of a MAT variable: letters, digits and _, at most {}", name,
                    longest_name));
}

std::string bytes_of(const std::vector<double>& values) {
  return mat5_element(mat5_type::double_float, {reinterpret_cast<const char*>(values.data()),
                                                sizeof(double) * values.size()});
}

std::string array_text(const MatVariable& v) {
  const double count =
      std::accumulate(v.size.begin(), v.size.end(), 1.0, [](double n, int s) { return n * s; });
  if (v.size.size() < 2 || count != static_cast<double>(v.real.size()) ||
      (!v.imaginary.empty() && v.imaginary.size() != v.real.size()))
    throw std::invalid_argument(
        fmt::format("MAT variable {}: {} numbers do not fit its size", v.name, v.real.size()));
  const std::uint64_t bytes = sizeof(double) * (v.real.size() + v.imaginary.size());
  if (bytes > mat5_most_bytes)
    throw base::ComputationError(
        fmt::format("{} is larger than the 2 GiB that a variable of a MAT file can hold", v.name));
  std::string inner =
      mat5_array_head(mat5_class::double_float, v.size, v.name, !v.imaginary.empty()) +
      bytes_of(v.real);
  if (!v.imaginary.empty()) inner += bytes_of(v.imaginary);
  return mat5_element(mat5_type::matrix, inner);
}

template <class Matrix>
MatVariable pages_of(const std::string& name, const std::vector<Matrix>& pages) {
  MatVariable v{.name = name};
  const int rows = pages.empty() ? 0 : static_cast<int>(pages[0].rows()),
            columns = pages.empty() ? 0 : static_cast<int>(pages[0].cols());
  v.size = {rows, columns, static_cast<int>(pages.size())};
  for (const auto& page : pages)
    for (Eigen::Index j = 0; j < page.cols(); ++j)
      for (Eigen::Index i = 0; i < page.rows(); ++i) {
        v.real.push_back(std::real(page(i, j)));
        if constexpr (Eigen::NumTraits<typename Matrix::Scalar>::IsComplex)
          v.imaginary.push_back(std::imag(page(i, j)));
      }
  return v;
}

}  // namespace

MatVariable mat_number(const std::string& name, double value) {
  return {.name = name, .size = {1, 1}, .real = {value}};
}

MatVariable mat_array(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  auto v = pages_of<Eigen::MatrixXd>(name, {values});
  v.size = {static_cast<int>(values.rows()), static_cast<int>(values.cols())};
  return v;
}

MatVariable mat_complex(const std::string& name, const Eigen::Ref<const Eigen::MatrixXcd>& values) {
  auto v = pages_of<Eigen::MatrixXcd>(name, {values});
  v.size = {static_cast<int>(values.rows()), static_cast<int>(values.cols())};
  return v;
}

MatVariable mat_pages(const std::string& name, const std::vector<Eigen::MatrixXcd>& pages) {
  return pages_of(name, pages);
}

MatVariable mat_pages(const std::string& name, const std::vector<Eigen::MatrixXd>& pages) {
  return pages_of(name, pages);
}

MatVariable mat_text(const std::string& name, const std::string& text) {
  return {.name = name, .texts = {text}, .is_text = true};
}

MatVariable mat_list(const std::string& name, const std::vector<std::string>& texts) {
  return {.name = name, .texts = texts, .is_list = true};
}

void write_mat_variables(const std::string& path, const std::vector<MatVariable>& variables) {
  std::string text = mat5_file_head();
  for (const auto& v : variables) {
    require_name(v.name);
    if (v.is_text)
      text += mat5_text(v.name, v.texts.empty() ? "" : v.texts[0]);
    else if (v.is_list)
      text += mat5_text_list(v.name, v.texts);
    else
      text += array_text(v);
  }
  base::write_file_whole(path, text);
}

}  // namespace hydrapod::data
