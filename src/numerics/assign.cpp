#include <fmt/format.h>

#include <limits>
#include <stdexcept>

#include "hydrapod/numerics/dense.hpp"

namespace hydrapod::numerics {

std::vector<int> assign(const Eigen::MatrixXd& cost) {
  const auto rows = static_cast<int>(cost.rows()), columns = static_cast<int>(cost.cols());
  if (rows > columns)
    throw std::invalid_argument(
        fmt::format("{} rows cannot each have one of {} columns", rows, columns));
  if (!cost.allFinite()) throw std::invalid_argument("the costs of an assignment are not finite");
  // Shortest augmenting paths with potentials u, v; row and column 0 are a sentinel.
  constexpr double far = std::numeric_limits<double>::infinity();
  std::vector<double> u(rows + 1, 0.0), v(columns + 1, 0.0);
  std::vector<int> row_of(columns + 1, 0), way(columns + 1, 0);
  for (int row = 1; row <= rows; ++row) {
    row_of[0] = row;
    int column = 0;
    std::vector<double> least(columns + 1, far);
    std::vector<bool> used(columns + 1, false);
    do {
      used[column] = true;
      const int from = row_of[column];
      double step = far;
      int next = 0;
      for (int j = 1; j <= columns; ++j) {
        if (used[j]) continue;
        const double reduced = cost(from - 1, j - 1) - u[from] - v[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          way[j] = column;
        }
        if (least[j] < step) {
          step = least[j];
          next = j;
        }
      }
      for (int j = 0; j <= columns; ++j) {
        if (used[j]) {
          u[row_of[j]] += step;
          v[j] -= step;
        } else {
          least[j] -= step;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = way[column]) row_of[column] = row_of[way[column]];
  }
  std::vector<int> column_of(rows, -1);
  for (int j = 1; j <= columns; ++j)
    if (row_of[j] != 0) column_of[row_of[j] - 1] = j - 1;
  return column_of;
}

}  // namespace hydrapod::numerics
