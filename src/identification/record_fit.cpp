#include "record_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fit_covariance.hpp"
#include "identify_steps.hpp"
#include "line_noise.hpp"
#include "pole_basis.hpp"
#include "prune.hpp"
#include "varx.hpp"

namespace hydrapod::identification {

namespace {

/// Rounding: E|V|² ≥ least_noise · mean |Y|².
constexpr double least_noise = 1e-14;

/// Constant spectrum of what rings: about as large as the inputs.
double transient_size(const RecordLines& lines) {
  return std::max(std::sqrt(lines.U.squaredNorm() / static_cast<double>(lines.U.size())), 1e-300);
}

/// (U, the transients' inputs) at a line.
VectorXcd excitation_at(const RecordLines& lines, Index line, double transient) {
  VectorXcd all = VectorXcd::Zero(lines.U.cols() + lines.records);
  all.head(lines.U.cols()) = lines.U.row(line).transpose();
  all[lines.U.cols() + lines.record[static_cast<std::size_t>(line)]] = transient;
  return all;
}

VectorXd mean_squares(const MatrixXcd& Y) {
  return Y.cwiseAbs2().colwise().mean().transpose().cwiseMax(1e-300);
}

/// The same at all lines.
std::vector<MatrixXcd> flat_noise(const RecordLines& lines, double share) {
  const MatrixXcd V = (share * mean_squares(lines.Y)).cast<Complex>().asDiagonal();
  return std::vector<MatrixXcd>(static_cast<std::size_t>(lines.size()), V);
}

/// Complex numbers of each output that the fit has taken from a line. Parameters of a mode lie
/// where the mode does, those of residual terms everywhere.
VectorXd taken_by(const FrequencyResponses& r, const ModalModel& model) {
  const PoleBasis basis(r, false);
  const auto lines = static_cast<double>(r.lines()), inputs = static_cast<double>(r.H[0].cols()),
             outputs = static_cast<double>(r.H[0].rows());
  VectorXd taken =
      VectorXd::Constant(static_cast<Index>(r.lines()),
                         0.5 * static_cast<double>(model.residuals.size()) * inputs / lines);
  for (const auto& mode : model.modes) {
    const VectorXd near = basis.at(mode.pole).g.cwiseAbs2();
    taken += (1.0 + inputs / outputs) / near.sum() * near;
  }
  return taken;
}

/// E[V Vᴴ]: means over lines up to `reach` away, of what the fit has left there. Weights that are
/// means of n squares scatter: they raise the variance of what is fitted with them by 1/n, and one
/// over them is on average too large by 1/n.
std::vector<MatrixXcd> smooth_noise(const RecordLines& lines, const MatrixXcd& V,
                                    const VectorXd& taken, Index reach) {
  const Index n = V.rows(), q = V.cols(), width = std::min(n, 2 * reach + 1);
  const VectorXd least = least_noise * mean_squares(lines.Y);
  const auto product = [&](Index k) -> MatrixXcd {
    return V.row(k).transpose() * V.row(k).conjugate();
  };
  std::vector<MatrixXcd> noise;
  MatrixXcd sum = MatrixXcd::Zero(q, q);
  Index from = 0, to = 0;  // of the sum
  for (Index k = 0; k < n; ++k) {
    // as many lines at the ends as in the middle
    const Index first = std::clamp<Index>(k - reach, 0, n - width);
    while (to < first + width) sum += product(to++);
    while (from < first) sum -= product(from++);
    const auto count = static_cast<double>(width);
    const double left = std::max(count - taken.segment(first, width).sum(), 0.5 * count);
    MatrixXcd mean = (1.0 + 2.0 / left) / left * sum;
    mean.diagonal() += least.cast<Complex>();
    noise.push_back(std::move(mean));
  }
  return noise;
}

/// −2 ln of the likelihood of V, each output by itself, but for a constant.
double deviance(const MatrixXcd& V, const std::vector<MatrixXcd>& noise) {
  double sum = 0.0;
  for (Index k = 0; k < V.rows(); ++k) {
    const VectorXd S = noise[static_cast<std::size_t>(k)].diagonal().real().cwiseMax(1e-300);
    sum += S.array().log().sum() + V.row(k).cwiseAbs2().transpose().cwiseQuotient(S).sum();
  }
  return 2.0 * sum;
}

/// That of the model of the time record, with the level that V has: forces that nobody measured
/// make peaks where the modes are, which a mean over many lines does not have.
std::vector<MatrixXcd> peaked_noise(const RecordLines& lines, const MatrixXcd& V,
                                    const VectorXd& taken) {
  auto noise = lines.model_noise;
  const VectorXd least = least_noise * mean_squares(lines.Y);
  VectorXd level = VectorXd::Zero(V.cols());
  for (Index k = 0; k < V.rows(); ++k) {
    auto& S = noise[static_cast<std::size_t>(k)];
    S.diagonal() += least.cast<Complex>();
    level += V.row(k).cwiseAbs2().transpose().cwiseQuotient(S.diagonal().real());
  }
  const double left = static_cast<double>(V.rows()) - taken.sum();
  const VectorXcd root =
      (level / std::max(left, 0.5 * static_cast<double>(V.rows()))).cwiseSqrt().cast<Complex>();
  for (auto& S : noise) S = MatrixXcd(root.asDiagonal() * S * root.asDiagonal());
  return noise;
}

/// Of both the one that explains V better.
std::vector<MatrixXcd> best_noise(const RecordLines& lines, const MatrixXcd& V,
                                  const VectorXd& taken, Index reach) {
  auto smooth = smooth_noise(lines, V, taken, reach), peaked = peaked_noise(lines, V, taken);
  return deviance(V, peaked) < deviance(V, smooth) ? peaked : smooth;
}

/// H at the lines, outputs × (inputs, transients).
std::vector<MatrixXcd> model_lines(const FrequencyResponses& r, const ModalModel& model) {
  const PoleBasis basis(r, false);
  std::vector<PoleLines> lines;
  for (const auto& mode : model.modes) lines.push_back(basis.at(mode.pole));
  std::vector<MatrixXcd> H;
  for (std::size_t k = 0; k < r.lines(); ++k)
    H.push_back(modelled(model, lines, static_cast<Index>(k), r));
  return H;
}

/// V = Y − H (U, transients).
MatrixXcd residual_in(const RecordLines& lines, const std::vector<MatrixXcd>& H) {
  const double transient = transient_size(lines);
  MatrixXcd V = lines.Y;
  for (Index k = 0; k < V.rows(); ++k)
    V.row(k) -= (H[static_cast<std::size_t>(k)] * excitation_at(lines, k, transient)).transpose();
  return V;
}

/// Lines on either side in the mean of the noise.
Index reach_in(const IdentifyOptions& options, const RecordLines& lines) {
  return std::max(options.record.reach, static_cast<Index>(options.record.reach_share *
                                                           static_cast<double>(lines.size())));
}

/// The next round's responses.
FrequencyResponses improved(const IdentifyOptions& options, const RecordLines& lines,
                            const FrequencyResponses& r, const ModalModel& model) {
  const auto H = model_lines(r, model);
  auto next = responses_in_record(lines, best_noise(lines, residual_in(lines, H),
                                                    taken_by(r, model), reach_in(options, lines)));
  next.inputs = r.inputs;
  next.outputs = r.outputs;
  next.degrees = r.degrees;
  next.sample_rate = r.sample_rate;
  return next;
}

/// Gives each candidate its part in the records' transients: what the residues of its pole there
/// have in common with its shape, all fitted at once at the candidates' poles. Without them the
/// first steps would move poles to explain what rings.
void add_transients(const IdentifyOptions& options, const RecordLines& lines,
                    const FrequencyResponses& r, std::vector<PoleCluster>& clusters) {
  const Index p = lines.U.cols(), m = lines.records;
  auto fit = options.fit;
  fit.deviations = Deviations::none;
  fit.max_iterations = 0;
  std::vector<PoleEstimate> start;
  for (auto& cluster : clusters) {
    auto& e = cluster.representative;
    e.participation.conservativeResize(p + m);
    e.participation.tail(m).setZero();
    start.push_back(e);
    for (Index k = 0; k < m; ++k) {
      start.push_back(e);
      start.back().participation = VectorXcd::Unit(p + m, p + k);
    }
  }
  const auto model = fit_modes(r, start, fit);
  std::size_t at = 0;
  for (auto& cluster : clusters) {
    const auto& own = model.modes[at++];
    cluster.representative.participation = own.participation;
    cluster.representative.shape = own.shape;
    for (Index k = 0; k < m; ++k)
      cluster.representative.participation[p + k] =
          own.shape.dot(model.modes[at++].shape) / std::max(own.shape.squaredNorm(), 1e-300);
    if (!cluster.representative.participation.allFinite())
      cluster.representative.participation.tail(m).setZero();
  }
}

}  // namespace

RecordLines lines_in_band(const Signals& signals, double from, double to, const Varx& model) {
  RecordLines lines{.records = static_cast<Index>(signals.pieces.size())};
  std::vector<MatrixXcd> Y, U;
  std::vector<std::pair<Index, Index>> places;  // record, line
  std::vector<double> frequency, durations;
  for (Index m = 0; m < lines.records; ++m) {
    const auto& piece = signals.pieces[static_cast<std::size_t>(m)];
    const double T = static_cast<double>(good_length(piece.outputs.rows())) / signals.sample_rate;
    lines.duration = std::max(lines.duration, T);
    durations.push_back(T);
    Y.push_back(lines_of(piece.outputs));
    U.push_back(lines_of(piece.inputs));
    for (Index k = 1; k + 1 < Y.back().rows(); ++k)
      if (const double f = static_cast<double>(k) / T; f >= from && f <= to) {
        places.emplace_back(m, k);
        frequency.push_back(f);
      }
  }
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return frequency[i]; });
  const auto n = static_cast<Index>(order.size());
  lines.Y.resize(n, signals.pieces.front().outputs.cols());
  lines.U.resize(n, signals.pieces.front().inputs.cols());
  for (Index k = 0; k < n; ++k) {
    const auto i = order[static_cast<std::size_t>(k)];
    const auto [m, line] = places[i];
    lines.frequency.push_back(frequency[i]);
    lines.record.push_back(m);
    lines.Y.row(k) = Y[static_cast<std::size_t>(m)].row(line);
    lines.U.row(k) = U[static_cast<std::size_t>(m)].row(line);
    // lines are 2/n times the transform of n samples
    lines.model_noise.push_back(4.0 * model.interval / durations[static_cast<std::size_t>(m)] *
                                noise_at(model, frequency[i]));
  }
  return lines;
}

FrequencyResponses responses_in_record(const RecordLines& lines, std::vector<MatrixXcd> noise) {
  FrequencyResponses r;
  const double transient = transient_size(lines);
  const Index inputs = lines.U.cols() + lines.records;
  std::vector<MatrixXcd> H;
  std::vector<VectorXcd> excitation;
  for (Index k = 0; k < lines.size(); ++k) {
    excitation.push_back(excitation_at(lines, k, transient));
    const auto& U = excitation.back();
    H.push_back(lines.Y.row(k).transpose() * U.adjoint() / U.squaredNorm());
  }
  r.frequency = lines.frequency;
  r.H = std::move(H);
  r.excitation = std::move(excitation);
  r.noise = std::move(noise);
  r.input_factor.assign(static_cast<std::size_t>(lines.size()),
                        MatrixXcd::Identity(inputs, inputs));
  return r;
}

void fit_record(const IdentifyOptions& options, const RecordLines& lines,
                std::vector<PoleCluster> clusters, Identification& result) {
  const auto& rules = options.record;
  auto first = responses_in_record(lines, flat_noise(lines, rules.first_noise));
  first.inputs = result.responses.inputs;
  first.outputs = result.responses.outputs;
  first.sample_rate = result.responses.sample_rate;
  first.degrees = static_cast<double>(2 * reach_in(options, lines) + 1);
  result.responses = std::move(first);
  result.from = lines.frequency.front();
  result.to = lines.frequency.back();
  if (clusters.empty()) return;
  add_transients(options, lines, result.responses, clusters);
  const auto candidates = clusters;
  auto start = options.fit;
  start.deviations = Deviations::none;
  std::vector<PoleEstimate> poles;
  for (const auto& cluster : clusters) poles.push_back(cluster.representative);
  result.model = fit_modes(result.responses, poles, start);
  for (std::size_t r = 0; r < clusters.size(); ++r)
    clusters[r].representative = result.model.modes[r];
  for (int round = 0; round < rules.rounds && !clusters.empty(); ++round) {
    result.responses = improved(options, lines, result.responses, result.model);
    result.left_out.clear();
    fit_and_prune(options, clusters, result);
    if (round + 1 < rules.rounds) {
      add_tones(options, lines, result);
      add_candidates(options, candidates, result);
      add_hidden_modes(options, result);
    }
    clusters = result.clusters;
    for (std::size_t r = 0; r < clusters.size(); ++r)
      clusters[r].representative = result.model.modes[r];
  }
}

void without_transients(Index inputs, ModalModel& model) {
  for (auto& mode : model.modes) {
    mode.participation = VectorXcd(mode.participation.head(inputs));
    Index largest = 0;
    const double size = mode.participation.cwiseAbs().maxCoeff(&largest);
    if (!(size > 0.0)) continue;
    const Complex unit = mode.participation[largest];
    mode.participation /= unit;
    mode.shape *= unit;
    mode.shape_deviation *= std::abs(unit);
  }
  for (auto& C : model.residuals) C = MatrixXd(C.leftCols(inputs));
}

}  // namespace hydrapod::identification
