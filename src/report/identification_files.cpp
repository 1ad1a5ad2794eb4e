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
constexpr double band = numerics::normal_half_width;

void add_channels(const std::string& prefix, const std::vector<data::Channel>& channels,
                  std::vector<data::MatVariable>& all) {
  std::vector<std::string> names, units;
  for (const auto& c : channels) {
    names.push_back(c.name);
    units.push_back(c.unit);
  }
  all.push_back(data::mat_list(prefix + "s", names));
  all.push_back(data::mat_list(prefix + "_units", units));
}

std::vector<data::MatVariable> response_variables(const FrequencyResponses& r) {
  std::vector<data::MatVariable> all;
  const auto lines = static_cast<Index>(r.lines());
  all.push_back(data::mat_array("frequency_hz", VectorXd::Map(r.frequency.data(), lines)));
  all.push_back(data::mat_pages("response", r.H));
  if (r.has_errors()) {
    std::vector<MatrixXd> deviation;
    for (std::size_t k = 0; k < r.lines(); ++k) {
      deviation.emplace_back(r.H[k].rows(), r.H[k].cols());
      for (Index o = 0; o < r.H[k].rows(); ++o)
        for (Index i = 0; i < r.H[k].cols(); ++i)
          deviation.back()(o, i) = std::sqrt(r.variance(k, o, i));
    }
    all.push_back(data::mat_pages("deviation", deviation));
  }
  if (!r.multiple_coherence.empty()) {
    MatrixXd coherence(static_cast<Index>(r.outputs.size()), lines);
    for (Index k = 0; k < lines; ++k)
      coherence.col(k) = r.multiple_coherence[static_cast<std::size_t>(k)];
    all.push_back(data::mat_array("coherence", coherence));
    all.push_back(data::mat_array("condition", VectorXd::Map(r.condition.data(), lines)));
  }
  add_channels("output", r.outputs, all);
  add_channels("input", r.inputs, all);
  return all;
}

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

void write_responses_mat(const std::string& path, const FrequencyResponses& responses) {
  data::write_mat_variables(path, response_variables(responses));
}

void write_modes_mat(const std::string& path, const Identification& result) {
  const auto& modes = result.modes;
  auto all = response_variables(result.responses);
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
        [](const Mode& m) { return band * m.fit.omega_deviation / two_pi; }},
       {"damping_ratio", [](const Mode& m) { return m.fit.damping_ratio(); }},
       {"damping_95", [](const Mode& m) { return band * m.fit.damping_deviation; }},
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
