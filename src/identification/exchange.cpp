#include "hydrapod/identification/exchange.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hydrapod::identification {

using Eigen::Index;

data::FrequencyResponse to_exchange(const FrequencyResponses& r, const std::string& title) {
  data::FrequencyResponse file;
  file.title = title;
  file.inputs = r.inputs;
  file.outputs = r.outputs;
  file.frequency = Eigen::VectorXd::Map(r.frequency.data(), static_cast<Index>(r.lines()));
  file.response = r.H;
  const auto outputs = static_cast<Index>(r.outputs.size()),
             inputs = static_cast<Index>(r.inputs.size());
  for (std::size_t k = 0; r.has_errors() && k < r.lines(); ++k) {
    Eigen::MatrixXd V(outputs, inputs);
    for (Index o = 0; o < outputs; ++o)
      for (Index i = 0; i < inputs; ++i)
        V(o, i) = r.variance(k, static_cast<int>(o), static_cast<int>(i));
    file.variance.push_back(std::move(V));
  }
  if (r.multiple_coherence.empty()) return file;
  file.coherence.resize(static_cast<Index>(r.lines()), outputs);
  for (std::size_t k = 0; k < r.lines(); ++k)
    file.coherence.row(static_cast<Index>(k)) = r.multiple_coherence[k].transpose();
  return file;
}

FrequencyResponses from_exchange(const data::FrequencyResponse& file, const std::string& path) {
  FrequencyResponses r;
  r.inputs = file.inputs;
  r.outputs = file.outputs;
  r.frequency.assign(file.frequency.begin(), file.frequency.end());
  r.H = file.response;
  for (std::size_t k = 0; k < r.lines(); ++k)
    for (Index o = 0; o < r.H[k].rows(); ++o)
      for (Index i = 0; i < r.H[k].cols(); ++i)
        if (!std::isfinite(std::abs(r.H[k](o, i))))
          throw base::InputError(
              {{.file = path,
                .message =
                    fmt::format("the response of {} to {} is missing at {:.6g} Hz; modes need "
                                "all pairs of outputs and inputs at all frequencies",
                                r.outputs[static_cast<std::size_t>(o)].name,
                                r.inputs[static_cast<std::size_t>(i)].name, r.frequency[k])}});
  for (const auto& V : file.variance) {
    const Eigen::VectorXd rows = V.rowwise().mean();
    const Eigen::RowVectorXd columns = V.colwise().mean() / V.mean();
    r.noise.emplace_back(Eigen::MatrixXcd(rows.cast<std::complex<double>>().asDiagonal()));
    r.input_factor.emplace_back(
        Eigen::MatrixXcd(columns.transpose().cast<std::complex<double>>().asDiagonal()));
  }
  for (Index k = 0; k < file.coherence.rows(); ++k)
    r.multiple_coherence.emplace_back(file.coherence.row(k).transpose());
  return r;
}

}  // namespace hydrapod::identification
