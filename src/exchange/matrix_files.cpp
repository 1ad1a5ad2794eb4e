/// Matrices that other programs have written: Matrix Market, and DMIG entries of Nastran.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/exchange/exchange.hpp"

namespace hydrapod::exchange {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::size_t largest_file = 256U << 20U;
constexpr Index most_rows = 3000;  // a dense matrix of 72 MB; larger ones are to be reduced first

/// Lines of a text file with their numbers.
class Lines {
 public:
  Lines(const std::string& path, std::string_view expected)
      : path_(path), text_(base::read_file(path, largest_file, expected)) {}

  bool next(std::string_view& line) {
    if (at_ >= text_.size()) return false;
    const auto end = std::min(text_.find('\n', at_), text_.size());
    line = std::string_view(text_).substr(at_, end - at_);
    if (line.ends_with('\r')) line.remove_suffix(1);
    at_ = end + 1;
    ++number_;
    return true;
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw base::InputError({{.file = path_, .line = number_, .column = 1, .message = message}});
  }

 private:
  std::string path_, text_;
  std::size_t at_{};
  unsigned number_{};
};

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> all;
  for (std::size_t at = line.find_first_not_of(" \t"); at != std::string_view::npos;) {
    const auto end = std::min(line.find_first_of(" \t", at), line.size());
    all.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(" \t", end);
  }
  return all;
}

std::optional<double> number_in(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<long> whole_in(std::string_view text) {
  long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// ---- Matrix Market ---------------------------------------------------------------------------

struct MarketHead {
  bool coordinates{}, symmetric{};
};

MarketHead market_head(Lines& lines) {
  std::string_view line;
  if (!lines.next(line)) lines.fail("is empty, expected a Matrix Market file");
  const auto head = words(line);
  const auto is = [&](std::size_t k, std::string_view word) {
    return head.size() > k && base::lower_case(head[k]) == word;
  };
  const bool known =
      (is(0, "%%matrixmarket") && is(1, "matrix")) && (is(2, "coordinate") || is(2, "array")) &&
      (is(3, "real") || is(3, "integer")) && (is(4, "general") || is(4, "symmetric"));
  if (!known)
    lines.fail(
        fmt::format("begins with \"{}\", expected \"%%MatrixMarket matrix coordinate real "
                    "symmetric\" (or array, integer, general)",
                    base::printable(line)));
  return {is(2, "coordinate"), is(4, "symmetric")};
}

/// The next line that is no comment and not empty.
std::vector<std::string_view> market_line(Lines& lines, const char* expected) {
  std::string_view line;
  while (lines.next(line)) {
    if (line.starts_with('%')) continue;
    if (auto all = words(line); !all.empty()) return all;
  }
  lines.fail(fmt::format("ends here, expected {}", expected));
}

double market_number(const Lines& lines, std::string_view text) {
  const auto value = number_in(text);
  if (!value) lines.fail(fmt::format("\"{}\" is no number", base::printable(text)));
  return *value;
}

void read_coordinates(Lines& lines, bool symmetric, long entries, MatrixXd& A) {
  for (long k = 0; k < entries; ++k) {
    const auto entry = market_line(lines, "one more entry: row, column, value");
    const auto row = entry.size() == 3 ? whole_in(entry[0]) : std::nullopt,
               column = entry.size() == 3 ? whole_in(entry[1]) : std::nullopt;
    if (!row || !column || *row < 1 || *column < 1 || *row > A.rows() || *column > A.cols())
      lines.fail(fmt::format("expected row and column from 1 to {} and a value", A.rows()));
    const double value = market_number(lines, entry[2]);
    A(*row - 1, *column - 1) += value;
    if (symmetric && *row != *column) A(*column - 1, *row - 1) += value;
  }
}

void read_array(Lines& lines, bool symmetric, MatrixXd& A) {
  for (Index j = 0; j < A.cols(); ++j)
    for (Index i = symmetric ? j : 0; i < A.rows(); ++i) {
      const auto entry = market_line(lines, "one more value");
      if (entry.size() != 1) lines.fail("expected one value in a line");
      A(i, j) = market_number(lines, entry[0]);
      if (symmetric) A(j, i) = A(i, j);
    }
}

// ---- Nastran ---------------------------------------------------------------------------------

/// "1.25-3" has no letter before its exponent, "1.25D-3" another one.
std::optional<double> nastran_number(std::string_view text) {
  std::string plain(text);
  std::ranges::replace_if(
      plain, [](char c) { return c == 'd' || c == 'D' || c == 'E'; }, 'e');
  const auto sign = plain.find_last_of("+-");
  if (sign != std::string::npos && sign > 0 && plain[sign - 1] != 'e') plain.insert(sign, "e");
  return number_in(plain);
}

/// One bulk data entry: its fields behind the first, without blanks around.
struct Entry {
  std::string name{};
  std::vector<std::string> fields{};
};

void add_fields(std::string_view line, Entry& entry) {
  if (line.find(',') != std::string_view::npos) {
    auto parts = base::split(line, ",");
    parts.resize(std::max<std::size_t>(parts.size(), 9));
    entry.fields.insert(entry.fields.end(), parts.begin() + 1, parts.begin() + 9);
    return;
  }
  const bool large = line.substr(0, 8).find('*') != std::string_view::npos;
  const std::size_t width = large ? 16 : 8, count = large ? 4 : 8;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = 8 + k * width;
    const auto field = at < line.size() ? line.substr(at, width) : std::string_view{};
    entry.fields.emplace_back(base::trimmed(field));
  }
}

/// Where a coordinate stands: the platform's six first, then others by point and component.
struct Coordinate {
  bool inner{};
  long point{}, component{};
  friend auto operator<=>(const Coordinate&, const Coordinate&) = default;
};

using Terms = std::map<std::pair<Coordinate, Coordinate>, double>;

class Punch {
 public:
  Punch(const std::string& path, int grid) : lines_(path, "a Nastran punch file"), grid_(grid) {}

  PayloadElement read() {
    std::string_view line;
    Entry entry;
    while (lines_.next(line)) {
      const auto comment = line.find('$');
      if (comment != std::string_view::npos) line = line.substr(0, comment);
      if (base::trimmed(line).empty()) continue;
      const bool continues =
          line.front() == '*' || line.front() == '+' || line.front() == ' ' || line.front() == ',';
      if (!continues) {
        take(entry);
        const auto end =
            std::min(line.find_first_of(" *,\t"), std::min<std::size_t>(line.size(), 8));
        entry = {std::string(line.substr(0, end)), {}};
      }
      add_fields(line, entry);
    }
    take(entry);
    return element();
  }

 private:
  void take(const Entry& entry) {
    if (base::lower_case(entry.name) != "dmig" || entry.fields.size() < 4) return;
    const auto& f = entry.fields;
    const auto column_point = whole(f[1]);
    if (column_point == 0) return take_head(f);
    const char letter = f[0].empty() ? ' ' : static_cast<char>(std::toupper(f[0][0]));
    auto* terms = letter == 'K' ? &K_ : letter == 'M' ? &M_ : letter == 'B' ? &B_ : nullptr;
    if (terms == nullptr) return;
    const auto symmetric = symmetric_.find(base::lower_case(f[0]));
    if (symmetric == symmetric_.end())
      lines_.fail(
          fmt::format("matrix {} has terms before its head, expected DMIG, {}, 0, 1 or 6, "
                      "1 or 2 first",
                      base::printable(f[0]), base::printable(f[0])));
    const auto column = coordinate(column_point, whole(f[2]));
    for (std::size_t k = 4; k + 2 < f.size(); k += 4) {
      if (f[k].empty()) continue;
      const auto value = nastran_number(f[k + 2]);
      if (!value) lines_.fail(fmt::format("\"{}\" is no number", base::printable(f[k + 2])));
      const auto row = coordinate(whole(f[k]), whole(f[k + 1]));
      (*terms)[{row, column}] = *value;
      if (symmetric->second) (*terms)[{column, row}] = *value;
    }
  }

  void take_head(const std::vector<std::string>& f) {
    constexpr long square = 1, symmetric = 6;
    const auto form = whole(f[2]), type = whole(f[3]);
    if (form != square && form != symmetric)
      lines_.fail(fmt::format("matrix {} has the form {}, expected 1 (square) or 6 (symmetric)",
                              f[0], form));
    if (type != 1 && type != 2)
      lines_.fail(
          fmt::format("matrix {} has numbers of type {}, expected 1 or 2 (real)", f[0], type));
    symmetric_[base::lower_case(f[0])] = form == symmetric;
  }

  [[nodiscard]] long whole(const std::string& text) const {
    if (text.empty()) return 0;
    const auto value = whole_in(text);
    if (!value) lines_.fail(fmt::format("\"{}\" is no whole number", base::printable(text)));
    return *value;
  }

  [[nodiscard]] Coordinate coordinate(long point, long component) {
    const Coordinate c{point != grid_, point, component};
    coordinates_.try_emplace(c, 0);
    return c;
  }

  PayloadElement element() {
    for (long component = 1; component <= 6; ++component)
      if (!coordinates_.contains({false, grid_, component}))
        lines_.fail(
            fmt::format("the file has no term of component {} of grid point {}, which is "
                        "meant to be the platform; expected another --grid, or a "
                        "superelement with this point",
                        component, grid_));
    if (static_cast<Index>(coordinates_.size()) > most_rows)
      lines_.fail(fmt::format("has {} coordinates, expected no more than {}: reduce it first",
                              coordinates_.size(), most_rows));
    if (K_.empty() || M_.empty())
      lines_.fail("has no matrix with a name that begins with K, or none with M");
    Index next = 0;
    for (auto& [coordinate, number] : coordinates_) number = next++;
    return {matrix(M_), matrix(K_), B_.empty() ? MatrixXd() : matrix(B_)};
  }

  [[nodiscard]] MatrixXd matrix(const Terms& terms) const {
    const auto n = static_cast<Index>(coordinates_.size());
    MatrixXd A = MatrixXd::Zero(n, n);
    for (const auto& [at, value] : terms)
      A(coordinates_.at(at.first), coordinates_.at(at.second)) = value;
    return A;
  }

  Lines lines_;
  long grid_;
  std::map<std::string, bool> symmetric_{};  ///< by the name of the matrix, in its head
  std::map<Coordinate, Index> coordinates_{};
  Terms K_{}, M_{}, B_{};
};

}  // namespace

MatrixXd read_matrix_market(const std::string& path) {
  Lines lines(path, "a Matrix Market file");
  const auto head = market_head(lines);
  const auto size = market_line(lines, "rows, columns and number of entries");
  const auto rows = !size.empty() ? whole_in(size[0]) : std::nullopt,
             columns = size.size() > 1 ? whole_in(size[1]) : std::nullopt,
             entries = size.size() > 2 ? whole_in(size[2]) : std::nullopt;
  if (!rows || !columns || *rows != *columns || *rows < 1 || *rows > most_rows ||
      (head.coordinates && (!entries || *entries < 0)))
    lines.fail(fmt::format("expected a square matrix of no more than {} rows{}", most_rows,
                           head.coordinates ? ", and the number of its entries" : ""));
  MatrixXd A = MatrixXd::Zero(*rows, *columns);
  if (head.coordinates)
    read_coordinates(lines, head.symmetric, *entries, A);
  else
    read_array(lines, head.symmetric, A);
  return A;
}

PayloadElement read_dmig_punch(const std::string& path, int grid) {
  return Punch(path, grid).read();
}

}  // namespace hydrapod::exchange
