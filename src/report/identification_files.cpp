#include "hydrapod/report/measured_results.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/numerics/statistics.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using identification::FrequencyResponses;
using identification::Identification;
using identification::IdentifiedMode;
constexpr double half_width = numerics::normal_half_width;

template <class Vector>
data::MatVariable mode_vectors(const char* name, const std::vector<IdentifiedMode>& modes,
                               std::size_t size, const Vector& vector) {
  MatrixXcd columns(static_cast<Index>(size), static_cast<Index>(modes.size()));
  for (Index r = 0; r < columns.cols(); ++r)
    columns.col(r) = vector(modes[static_cast<std::size_t>(r)]);
  return data::mat_complex(name, columns);
}

}  // namespace

void write_modes_uff(const std::string& path, const Identification& result,
                     const std::string& title, const std::string& date) {
  auto all = identification::modal_results(result);
  all.title = title;
  all.date = date;
  // repeated modes as they were fitted: only these have residues
  for (std::size_t r = 0; r < result.modes.size() && !result.responses.whole; ++r) {
    const auto& fit = result.modes[r].fit;
    all.modes[r].participation = fit.participation;
    if (result.modes[r].repeated == 1) continue;
    for (Index o = 0; o < fit.shape.size(); ++o)
      all.modes[r].shape[o] =
          fit.shape[o] /
          std::pow(fit.pole, data::time_derivatives(all.outputs[static_cast<std::size_t>(o)].unit));
  }
  data::write_modal_results(path, all);
}

void write_modes_mat(const std::string& path, const Identification& result) {
  const auto& modes = result.modes;
  auto responses = result.responses;
  if (responses.shift > 0.0 && responses.on_axis.empty() && !modes.empty())
    responses.on_axis = identification::on_imaginary_axis(responses, result);
  // without a mode nothing brings responses to iω
  const bool shared = !(responses.shift > 0.0) || !responses.on_axis.empty();
  auto all = shared ? data::response_arrays(responses) : std::vector<data::MatVariable>{};
  Eigen::VectorXcd poles(static_cast<Index>(modes.size()));
  std::vector<Eigen::VectorXcd> shapes;
  for (std::size_t r = 0; r < modes.size(); ++r) {
    poles[static_cast<Index>(r)] = modes[r].fit.pole;
    shapes.push_back(modes[r].displacement);
  }
  all.push_back(data::mat_complex("pole", poles));
  using Mode = IdentifiedMode;
  constexpr std::array<std::pair<const char*, double (*)(const Mode&)>, 7> columns{
      {{"mode_frequency_hz", [](const Mode& m) { return m.fit.omega() / two_pi; }},
       {"mode_frequency_95_hz",
        [](const Mode& m) { return half_width * m.fit.omega_deviation / two_pi; }},
       {"damping_ratio", [](const Mode& m) { return m.fit.damping_ratio(); }},
       {"damping_95", [](const Mode& m) { return half_width * m.fit.damping_deviation; }},
       {"mpc", [](const Mode& m) { return m.mpc; }},
       {"mpd_rad", [](const Mode& m) { return m.mpd; }},
       {"quality", [](const Mode& m) { return m.quality(); }}}};
  for (const auto& [name, number] : columns) {
    VectorXd values(poles.size());
    std::ranges::transform(modes, values.begin(), number);
    all.push_back(data::mat_array(name, values));
  }
  const std::size_t outputs = result.responses.outputs.size();
  all.push_back(mode_vectors("shape", modes, outputs, [](const auto& m) { return m.fit.shape; }));
  all.push_back(mode_vectors("displacement_shape", modes, outputs,
                             [](const auto& m) { return m.displacement; }));
  all.push_back(mode_vectors("participation", modes, result.responses.inputs.size(),
                             [](const auto& m) { return m.fit.participation; }));
  all.push_back(data::mat_array("mac", identification::mac_matrix(shapes, shapes)));
  if (!result.model.residuals.empty()) {
    std::vector<MatrixXcd> fitted;
    for (const double f : result.responses.frequency)
      fitted.push_back(identification::synthesised(result.model, f));
    all.push_back(data::mat_pages("fitted", fitted));
  }
  data::write_mat_variables(path, all);
}

}  // namespace hydrapod::report
