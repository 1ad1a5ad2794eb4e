#include <fmt/format.h>

#include <algorithm>

#include "gnuplot.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using Eigen::Index;

/// A matrix with the names of its rows and columns.
struct MacPicture {
  Eigen::MatrixXd values{};
  std::vector<std::string> rows{}, columns{};
  std::string row_title{}, column_title{};
};

void draw_mac(const MacPicture& picture, const PlotText& text, const std::string& path) {
  const auto rows = static_cast<int>(picture.values.rows()),
             columns = static_cast<int>(picture.values.cols());
  constexpr int right = 120, top = 80, bottom = 110;
  const int cell = std::clamp(520 / std::max(rows, columns), 22, 70);
  const int width = std::max(640, 130 + right + cell * columns);  // the heading has room
  const int left = 130 + (width - (130 + right + cell * columns)) / 2;
  const int height = top + bottom + cell * rows;
  const double across = width, up = height;
  std::string script =
      titles(text.title, text.subtitle, width, height) + thin_axes +
      block_of("mac", matrix_rows(picture.values, 1)) +
      at_screen({left / across, (left + cell * columns) / across, 1.0 - top / up, bottom / up});
  script += fmt::format("set xrange [0.5:{}.5]\nset yrange [{}.5:0.5]\n", columns, rows);
  script += named_tics('x', picture.columns) + named_tics('y', picture.rows);
  script += fmt::format(
      "set xtics out nomirror rotate by 45 right\nset ytics out nomirror\n"
      "set cbrange [0:1]\nset cbtics 0.2\n"
      "set palette defined (0 '#ffffff', 0.5 '#a9d3ea', 1 '#4aa3d0')\nset cblabel 'MAC'\n"
      "set xlabel {} offset 0,-0.5\nset ylabel {}\nunset key\n"
      "plot $mac using 1:2:3 with image pixels, "
      "$mac using 1:2:($3 >= 0.05 ? sprintf('%.2f', $3) : '') with labels font ',{}' "
      "tc rgb '#101010'\n",
      quoted(picture.column_title), quoted(picture.row_title), cell < 30 ? 6 : 8);
  draw(path, width, height, script);
}

std::vector<std::string> measured_names(const std::vector<identification::IdentifiedMode>& modes) {
  std::vector<std::string> names;
  for (std::size_t r = 0; r < modes.size(); ++r)
    names.push_back(fmt::format("{}: {:.4g} Hz", r + 1, modes[r].fit.omega() / two_pi));
  return names;
}

}  // namespace

void plot_mac(const identification::Identification& result, const PlotText& text,
              const std::string& path) {
  std::vector<Eigen::VectorXcd> shapes;
  for (const auto& m : result.modes) shapes.push_back(m.displacement);
  const auto names = measured_names(result.modes);
  draw_mac({identification::mac_matrix(shapes, shapes), names, names, "mode", "mode"}, text, path);
}

void plot_cross_mac(const ComparedModes& compared, const identification::Identification& measured,
                    const PlotText& text, const std::string& path) {
  const auto& c = compared.result;
  if (c.mac.rows() == 0 || c.mac.cols() == 0)
    base::refuse(path,
                 "no output has a direction of the platform or a leg: there are no shapes to "
                 "compare with the model");
  std::vector<int> shown;
  for (const auto& pair : c.pairs) shown.push_back(pair.model);
  for (const auto& left : c.model_left)
    if (left.reason != observation::Unpaired::not_felt) shown.push_back(left.model);
  std::ranges::sort(shown);
  MacPicture picture{
      .rows = measured_names(measured.modes), .row_title = "measured", .column_title = "model"};
  picture.values.resize(c.mac.rows(), static_cast<Index>(shown.size()));
  for (std::size_t k = 0; k < shown.size(); ++k) {
    picture.values.col(static_cast<Index>(k)) = c.mac.col(shown[k]);
    picture.columns.push_back(
        fmt::format("{:.4g} Hz", c.model[static_cast<std::size_t>(shown[k])].omega() / two_pi));
  }
  if (shown.empty()) base::refuse(path, "the model has no mode in the band to compare with");
  draw_mac(picture, text, path);
}

}  // namespace hydrapod::report
