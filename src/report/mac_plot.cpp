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

std::string tics(const char* axis, const std::vector<std::string>& names) {
  std::string text = fmt::format("set {}tics out nomirror font ',9' (", axis);
  for (std::size_t k = 0; k < names.size(); ++k)
    text += fmt::format("{}{} {}", k == 0 ? "" : ", ", quoted(names[k]), k + 1);
  return text + ")\n";
}

void draw_mac(const MacPicture& picture, const PlotText& text, const std::string& path) {
  const auto rows = picture.values.rows(), columns = picture.values.cols();
  constexpr int left = 130, right = 120, top = 70, bottom = 110;
  const int cell = std::clamp(520 / static_cast<int>(std::max(rows, columns)), 22, 70);
  const int width = std::max(460, left + right + cell * static_cast<int>(columns));
  const int height = top + bottom + cell * static_cast<int>(rows);
  draw(path, width, height, [&](const std::string& terminal, const std::string& file) {
    std::string script = fmt::format(
        "set terminal {}\nset output {}\nset encoding utf8\nset termoption noenhanced\n"
        "set label 101 {} at screen 0.5,{:.4f} center font ',14'\n"
        "set label 102 {} at screen 0.5,{:.4f} center font ',10' tc rgb '#444444'\n"
        "set border lw 0.8 lc rgb '#444444'\n$mac << END\n",
        terminal, quoted(file), quoted(text.title), 1.0 - 22.0 / height, quoted(text.subtitle),
        1.0 - 46.0 / height);
    for (Index i = 0; i < rows; ++i)
      for (Index j = 0; j < columns; ++j)
        script += fmt::format("{} {} {:.4f}\n", j + 1, i + 1, picture.values(i, j));
    script += fmt::format(
        "END\nset lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\n"
        "set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n"
        "set xrange [0.5:{}]\nset yrange [{}:0.5]\n",
        static_cast<double>(left) / width, static_cast<double>(left + cell * columns) / width,
        1.0 - static_cast<double>(top) / height, static_cast<double>(bottom) / height,
        static_cast<double>(columns) + 0.5, static_cast<double>(rows) + 0.5);
    script += tics("x", picture.columns) + tics("y", picture.rows);
    script += fmt::format(
        "set xtics rotate by 45 right\nset cbrange [0:1]\nset cbtics 0.2 font ',9'\n"
        "set palette defined (0 '#ffffff', 0.5 '#a9d3ea', 1 '#4aa3d0')\nset cblabel 'MAC'\n"
        "set xlabel {} offset 0,-0.5\nset ylabel {}\nunset key\n"
        "plot $mac using 1:2:3 with image pixels, "
        "$mac using 1:2:($3 >= 0.05 ? sprintf('%.2f', $3) : '') with labels font ',{}' "
        "tc rgb '#101010'\nunset output\n",
        quoted(picture.column_title), quoted(picture.row_title), cell < 30 ? 6 : 8);
    return script;
  });
}

std::string frequency_name(std::size_t number, double omega) {
  return fmt::format("{}: {:.4g} Hz", number, omega / two_pi);
}

std::vector<std::string> measured_names(const std::vector<identification::IdentifiedMode>& modes) {
  std::vector<std::string> names;
  for (std::size_t r = 0; r < modes.size(); ++r)
    names.push_back(frequency_name(r + 1, modes[r].fit.omega()));
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
    throw base::InputError({{.file = path,
                             .message = "no output has a direction of the platform or a leg: there "
                                        "are no shapes to compare with the model"}});
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
  if (shown.empty())
    throw base::InputError(
        {{.file = path, .message = "the model has no mode in the band to compare with"}});
  draw_mac(picture, text, path);
}

}  // namespace hydrapod::report
