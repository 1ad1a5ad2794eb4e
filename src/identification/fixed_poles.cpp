#include "fixed_poles.hpp"

#include <cmath>

#include "line_weights.hpp"

namespace hydrapod::identification {

namespace {

void add_modes(const FitSystem& system, const FitState& state, ModalModel& model) {
  const Index modes = state.shared.poles.size(), inputs = system.inputs(),
              outputs = system.outputs();
  for (Index r = 0; r < modes; ++r) {
    FittedMode mode;
    mode.pole = state.shared.poles[r];
    mode.participation = state.shared.participations.col(r);
    mode.shape.resize(outputs);
    for (Index o = 0; o < outputs; ++o)
      mode.shape[o] = shape_row(state.own[static_cast<size_t>(o)], modes)[r];
    // steps may have made another element the largest
    Index largest = 0;
    mode.participation.cwiseAbs().maxCoeff(&largest);
    const Complex unit = mode.participation[largest];
    mode.participation /= unit;
    mode.shape *= unit;
    model.modes.push_back(std::move(mode));
  }
  for (int t = 0; t < system.residual_terms(); ++t) {
    MatrixXd C(outputs, inputs);
    for (Index o = 0; o < outputs; ++o)
      C.row(o) = state.own[static_cast<size_t>(o)].segment(2 * modes + t * inputs, inputs);
    model.residuals.push_back(std::move(C));
  }
  model.omega_scale = system.omega_scale();
}

/// Σ over lines of |e U|² and |H U|², per output; e as FitState::residual.
struct SeenPowers {
  VectorXd rest, measured;
};

SeenPowers seen_in_record(const FrequencyResponses& r, const MatrixXcd& residual) {
  const Index outputs = r.H[0].rows(), inputs = r.H[0].cols();
  SeenPowers sum{VectorXd::Zero(outputs), VectorXd::Constant(outputs, 1e-300)};
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const VectorXcd& U = r.excitation[k];
    sum.measured += (r.H[k] * U).cwiseAbs2();
    for (Index o = 0; o < outputs; ++o) {
      const Complex seen = residual.row(static_cast<Index>(k)).segment(o * inputs, inputs) * U;
      sum.rest[o] += std::norm(seen);
    }
  }
  return sum;
}

/// Seen in the responses themselves, each output in proportion to its own size.
double error_of(const FrequencyResponses& responses, const MatrixXcd& residual) {
  if (!responses.excitation.empty()) {
    const auto [rest, measured] = seen_in_record(responses, residual);
    return std::sqrt(rest.cwiseQuotient(measured).sum() / static_cast<double>(measured.size()));
  }
  const Index p = responses.H[0].cols();
  const VectorXd size = row_sizes(responses);
  double off = 0.0, whole = 0.0;
  for (Index o = 0; o < size.size(); ++o) {
    const double square = size[o] * size[o];
    if (!(square > 0.0)) continue;
    off += residual.middleCols(o * p, p).squaredNorm() / square;
    for (const auto& H : responses.H) whole += H.row(o).squaredNorm() / square;
  }
  return whole > 0.0 ? std::sqrt(off / whole) : 0.0;
}

}  // namespace

SharedParameters shared_parameters(const std::vector<PoleEstimate>& poles, Index inputs) {
  SharedParameters shared;
  const auto modes = static_cast<Index>(poles.size());
  shared.poles.resize(modes);
  shared.participations.resize(inputs, modes);
  for (Index r = 0; r < modes; ++r) {
    const auto& e = poles[static_cast<size_t>(r)];
    Index largest = 0;
    e.participation.cwiseAbs().maxCoeff(&largest);
    shared.poles[r] = e.pole;
    shared.participations.col(r) = e.participation / e.participation[largest];
    shared.fixed.push_back(largest);
  }
  return shared;
}

ModalModel model_of(const FitSystem& system, const FrequencyResponses& responses,
                    const FitState& state) {
  ModalModel model;
  add_modes(system, state, model);
  model.cost = state.cost;
  model.error = error_of(responses, state.residual);
  return model;
}

}  // namespace hydrapod::identification
