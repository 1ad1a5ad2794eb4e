/// Matrices of superelements in Universal Files: datasets 250, 252 and 2453.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "hydrapod/base/text.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "uff_dataset.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

using Eigen::Index;

constexpr long long most_rows = 3000;  // a dense matrix of 72 MB; larger ones are to be reduced

namespace storage {
constexpr long long rows = 1, columns = 2, sparse = 11;
}

class MatrixReader {
 public:
  MatrixReader(const UffLines& dataset, const Notes& notes) : dataset_(dataset), notes_(notes) {}

  MatrixDataset read() {
    MatrixDataset matrix{.identifier = static_cast<int>(whole(0, 0)), .line = dataset_.line};
    const auto type = whole(1, 0), rows = whole(1, 2), columns = whole(1, 3), key = whole(1, 4);
    constexpr long long single_precision = 2, double_precision = 4;
    if (type != single_precision && type != double_precision)
      fail(1, fmt::format("data type {}, expected 2 (real) or 4 (double precision)", type));
    if (rows < 1 || columns < 1 || rows > most_rows || columns > most_rows)
      fail(1, fmt::format("{} rows and {} columns, expected 1 to {} of each: reduce it first", rows,
                          columns, most_rows));
    matrix.values = Eigen::MatrixXd::Zero(rows, columns);
    if (key == storage::sparse)
      read_sparse(matrix.values);
    else if (key == storage::rows || key == storage::columns)
      read_dense(key == storage::rows || matrix.identifier == matrix_identifier::coupling_mass,
                 matrix.values);
    else
      fail(1, fmt::format("storage key {}, expected 1 (rows), 2 (columns) or 11 (sparse)", key));
    if (dataset_.units) {
      if (!dataset_.units->usable)
        fail(0, "the units of the file are unknown, expected dataset 164 to state them");
      matrix.length = dataset_.units->length;
      matrix.force = dataset_.units->force;
    }
    return matrix;
  }

 private:
  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    const auto below = static_cast<unsigned>(std::min(line, dataset_.lines.size()));
    notes_.fail("matrix: " + what, dataset_.line > 0 ? dataset_.line + below : 0);
  }

  /// A field of ten columns; an empty one is 0.
  [[nodiscard]] long long whole(std::size_t line, std::size_t field) const {
    if (line >= dataset_.lines.size()) fail(line, "ends before its second record");
    const auto text = columns(dataset_.lines[line], 10 * field, 10);
    const auto value = text.empty() ? 0 : fortran_integer(text);
    if (!value)
      fail(line, fmt::format("field {} is \"{}\", expected a whole number", field + 1,
                             base::printable(text, 20)));
    return *value;
  }

  /// The next number of record 3; none at the end. All fields have a blank before them.
  std::optional<double> next() {
    while (rest_.empty()) {
      if (at_ + 1 >= dataset_.lines.size()) return {};
      rest_ = base::trimmed(dataset_.lines[++at_]);
    }
    const auto end = std::min(rest_.find_first_of(" \t"), rest_.size());
    const auto number = fortran_number(rest_.substr(0, end));
    if (!number || !std::isfinite(*number))
      fail(at_, fmt::format("\"{}\", expected a finite number",
                            base::printable(rest_.substr(0, end), 20)));
    rest_ = base::trimmed(rest_.substr(end));
    return number;
  }

  void read_dense(bool by_rows, Eigen::MatrixXd& values) {
    const Index count = values.size();
    for (Index k = 0; k < count; ++k) {
      const auto value = next();
      if (!value) fail(at_ + 1, fmt::format("ends after {} of {} values", k, count));
      if (by_rows)
        values(k / values.cols(), k % values.cols()) = *value;
      else
        values(k % values.rows(), k / values.rows()) = *value;
    }
    if (next()) fail(at_, fmt::format("more than {} values", count));
  }

  void read_sparse(Eigen::MatrixXd& values) {
    const auto entries = whole(1, 5);
    if (entries < 1) fail(1, fmt::format("{} entries, expected at least 1", entries));
    for (long long k = 0; k < entries; ++k) {
      const Index row = place(values.rows(), "row"), column = place(values.cols(), "column");
      const auto value = next();
      if (!value) fail(at_ + 1, fmt::format("ends after {} of {} entries", k, entries));
      values(row, column) += *value;
    }
    if (next()) fail(at_, fmt::format("more than {} entries", entries));
  }

  Index place(Index count, const char* what) {
    const auto number = next();
    if (!number) fail(at_ + 1, fmt::format("ends where a {} should be", what));
    const auto whole = static_cast<Index>(std::clamp(*number, -1.0, 1e9));
    if (static_cast<double>(whole) != *number || whole < 1 || whole > count)
      fail(at_, fmt::format("{} {}, expected 1 to {}", what, *number, count));
    return whole - 1;
  }

  const UffLines& dataset_;
  const Notes& notes_;
  std::size_t at_{1};  ///< line of `rest_`
  std::string_view rest_{};
};

}  // namespace

std::vector<MatrixDataset> read_matrix_datasets(const std::string& path) {
  Notes notes(path);
  const UffContents contents = scan_uff(path, notes, true);
  if (contents.matrices.empty() && contents.modes.empty())
    notes.fail(
        "the Universal File holds neither matrices (datasets 252 and 2453) nor modes (dataset 55 "
        "or 2414)");
  std::vector<MatrixDataset> all;
  std::set<int> taken;
  for (const UffLines& dataset : contents.matrices) {
    all.push_back(MatrixReader(dataset, notes).read());
    if (!taken.insert(all.back().identifier).second)
      notes.fail(fmt::format("a second matrix with the identifier {}", all.back().identifier),
                 dataset.line);
  }
  return all;
}

}  // namespace hydrapod::data
