// What others take of an identification, and numbers about modes that they show.
#include <Eigen/SVD>

#include "hydrapod/identification/identify.hpp"
#include "hydrapod/identification/responses.hpp"
#include "line_weights.hpp"
#include "names.hpp"

namespace hydrapod::identification {

data::ModalResults modal_results(const Identification& identified) {
  const auto& responses = identified.responses;
  data::ModalResults results{.title = responses.title,
                             .date = responses.date,
                             .outputs = responses.outputs,
                             .inputs = responses.inputs,
                             .from = identified.from,
                             .to = identified.to};
  results.geometry = responses.geometry;
  if (responses.lines() > 1)
    results.line_spacing = (responses.frequency.back() - responses.frequency.front()) /
                           static_cast<double>(responses.lines() - 1);
  for (const auto& mode : identified.modes) {
    data::ModalResult result{.pole = mode.fit.pole,
                             .shape = mode.displacement,
                             .participation = {},
                             .omega_deviation = mode.fit.omega_deviation,
                             .damping_deviation = mode.fit.damping_deviation,
                             .shape_deviation = mode.fit.shape_deviation,
                             .significance = mode.fit.significance};
    // of repeated modes other mixtures are shown; of half spectra references stand for inputs
    if (mode.repeated == 1 && !responses.whole) result.participation = mode.fit.participation;
    // those of φ; the displacement is φ/λ^d
    for (Index o = 0; o < result.shape_deviation.size(); ++o) {
      const double size = std::abs(mode.fit.shape[o]);
      result.shape_deviation[o] *= size > 0.0 ? std::abs(mode.displacement[o]) / size : 0.0;
    }
    results.modes.push_back(std::move(result));
  }
  return results;
}

MatrixXd mode_indicator(const FrequencyResponses& r) {
  if (r.H.empty()) return {};  // a result that was read back
  const Index count = std::min(r.H[0].rows(), r.H[0].cols());
  const VectorXd size = row_sizes(r);
  MatrixXd values(static_cast<Index>(r.lines()), count);
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const MatrixXcd scaled = size.cwiseInverse().asDiagonal() * r.H[k];
    values.row(static_cast<Index>(k)) =
        Eigen::JacobiSVD<MatrixXcd>(scaled).singularValues().transpose();
  }
  return values;
}

MatrixXd mac_matrix(const std::vector<VectorXcd>& a, const std::vector<VectorXcd>& b) {
  MatrixXd M(static_cast<Index>(a.size()), static_cast<Index>(b.size()));
  for (Index i = 0; i < M.rows(); ++i)
    for (Index j = 0; j < M.cols(); ++j)
      M(i, j) = mac(a[static_cast<std::size_t>(i)], b[static_cast<std::size_t>(j)]);
  return M;
}

}  // namespace hydrapod::identification
