#include <cmath>

#include "hydrapod/data/frequency_response.hpp"
#include "response_comments.hpp"
#include "response_files.hpp"

namespace hydrapod::data {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void add_channels(const std::string& prefix, const std::vector<Channel>& channels,
                  std::vector<MatVariable>& all) {
  std::vector<std::string> names, units;
  for (const auto& c : channels) {
    names.push_back(c.name);
    units.push_back(c.unit);
  }
  all.push_back(mat_list(prefix + "s", names));
  all.push_back(mat_list(prefix + "_units", units));
}

std::vector<MatrixXd> deviations(const FrequencyResponses& r) {
  std::vector<MatrixXd> all;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    MatrixXd& deviation = all.emplace_back(r.H[k].rows(), r.H[k].cols());
    for (Index o = 0; o < deviation.rows(); ++o)
      for (Index i = 0; i < deviation.cols(); ++i) deviation(o, i) = std::sqrt(r.variance(k, o, i));
  }
  return all;
}

}  // namespace

std::vector<MatVariable> response_arrays(const FrequencyResponses& r) {
  validate(r);
  std::vector<MatVariable> all;
  const auto lines = static_cast<Index>(r.lines());
  all.push_back(mat_text("format", responses_mark));
  all.push_back(mat_number("format_version", responses_version));
  all.push_back(mat_text("title", r.title));
  all.push_back(mat_text("date", r.date));
  all.push_back(mat_array("frequency_hz", VectorXd::Map(r.frequency.data(), lines)));
  all.push_back(mat_pages("response", required_on_axis(r)));
  if (r.has_errors()) all.push_back(mat_pages("deviation", deviations(r)));
  if (!r.multiple_coherence.empty()) {
    MatrixXd coherence(static_cast<Index>(r.outputs.size()), lines);
    for (Index k = 0; k < lines; ++k)
      coherence.col(k) = r.multiple_coherence[static_cast<std::size_t>(k)];
    all.push_back(mat_array("coherence", coherence));
  }
  if (r.condition.size() == r.lines())
    all.push_back(mat_array("condition", VectorXd::Map(r.condition.data(), lines)));
  add_channels("output", r.outputs, all);
  add_channels("input", r.inputs, all);
  if (r.shift > 0.0) all.push_back(mat_pages("beside_axis", r.H));
  if (r.has_errors()) {
    all.push_back(mat_pages("noise", r.noise));
    all.push_back(mat_pages("input_factor", r.input_factor));
  }
  all.push_back(mat_text("description", response_comments(r)));
  return all;
}

}  // namespace hydrapod::data
