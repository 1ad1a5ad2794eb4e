#include "tone_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>

#include "evenness.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "hydrapod/numerics/statistics.hpp"

namespace hydrapod::identification {

namespace {

constexpr Index smoothed_rows = 16;                   // rows of a zoom: four of its windows
constexpr Index smoothed_step = 4;                    // rows between values of the smoothed zoom
constexpr Index least_rows = 64;                      // of a zoom in which a tone is looked for
constexpr double bins_of_hann = 1.5;                  // that are one independent value
constexpr double beside_from = 1.0, beside_to = 6.0;  // lines from where the tone may be

VectorXd hann_window(Index n) { return window_samples(Window::hann, static_cast<int>(n)); }

/// Lines of a zoom over its whole length, and their distance from its frequency [rad/sample].
struct LongLines {
  MatrixXcd lines{};  // lines × channels
  VectorXd offset{};
};

LongLines long_lines(const Zoom& zoom) {
  const Index rows = zoom.z.rows();
  LongLines result{MatrixXcd(rows, zoom.z.cols()), VectorXd(rows)};
  const VectorXd window = hann_window(rows);
  std::vector<Complex> x(static_cast<std::size_t>(rows));
  for (Index c = 0; c < zoom.z.cols(); ++c) {
    for (Index j = 0; j < rows; ++j) {
      const Complex z = zoom.z(j, c);
      x[static_cast<std::size_t>(j)] = std::isfinite(std::norm(z)) ? window[j] * z : 0.0;
    }
    const auto X = numerics::complex_fft(x);
    for (Index b = 0; b < rows; ++b) result.lines(b, c) = X[static_cast<std::size_t>(b)];
  }
  for (Index b = 0; b < rows; ++b)
    result.offset[b] = two_pi * static_cast<double>(b < (rows + 1) / 2 ? b : b - rows) /
                       static_cast<double>(rows * zoom.hop);
  return result;
}

/// u with the largest uᴴ T u/uᴴ N u: T at the tone, N beside it.
VectorXcd best_combination(const std::vector<Zoom>& zooms, double line, double wander) {
  const Index q = zooms[0].z.cols();
  MatrixXcd T = MatrixXcd::Zero(q, q), N = T;
  double beside = 0.0;
  for (const auto& zoom : zooms) {
    if (zoom.z.rows() < least_rows) continue;
    const auto all = long_lines(zoom);
    for (Index b = 0; b < all.offset.size(); ++b) {
      const double away = std::abs(all.offset[b]) - (line + wander);
      const VectorXcd z = all.lines.row(b).transpose();
      if (away <= 0.0) T += z * z.adjoint();
      if (away < beside_from * line || away > beside_to * line) continue;
      N += z * z.adjoint();
      beside += 1.0 / bins_of_hann;
    }
  }
  constexpr double enough = 3.0;  // values per channel: N is then known well enough to be inverted
  if (beside < enough * static_cast<double>(q)) N = MatrixXcd(N.diagonal().asDiagonal());
  constexpr double rounding = 1e-10;
  for (Index c = 0; c < q; ++c) N(c, c) = std::max(N(c, c).real() * (1.0 + rounding), 1e-300);
  const Eigen::LLT<MatrixXcd> root(N);
  const MatrixXcd half = root.matrixL().solve(T);
  const MatrixXcd whitened = root.matrixL().solve(MatrixXcd(half.adjoint()));
  if (!whitened.allFinite()) return {};
  const Eigen::SelfAdjointEigenSolver<MatrixXcd> solver(whitened);
  return root.matrixU().solve(solver.eigenvectors().col(q - 1));
}

/// uᴴz, turned so that the tone stands still; rows that are missing are 0.
struct Series {
  const Zoom* zoom{};
  VectorXcd y{};
  double omega{};  // [rad/sample] of the tone
};

Complex turned_back(const Zoom& zoom, double omega, Index row) {
  return std::polar(1.0, (zoom.omega - omega) * zoom.time(row));
}

bool is_whole(const Zoom& zoom, Index row) {
  return std::isfinite(zoom.z.row(row).cwiseAbs2().sum());
}

/// |Σ h_j y_j e^(−iδ t_j)|².
double power_at(const VectorXcd& y, const VectorXd& window, double turn) {
  Complex sum = 0.0, phase = 1.0;
  const Complex each = std::polar(1.0, -turn);
  for (Index j = 0; j < y.size(); ++j, phase *= each) sum += window[j] * phase * y[j];
  return std::norm(sum);
}

/// Turn per row at which the power is largest, within ±`reach`.
double best_turn(const VectorXcd& y, double reach) {
  const VectorXd window = hann_window(y.size());
  const double bin = two_pi / static_cast<double>(y.size());
  double best = 0.0, largest = -1.0;
  const auto steps = static_cast<Index>(std::ceil(4.0 * reach / bin));
  for (Index k = -steps; k <= steps; ++k) {
    const double turn = 0.25 * bin * static_cast<double>(k);
    if (const double power = power_at(y, window, turn); power > largest) {
      largest = power;
      best = turn;
    }
  }
  // in bins: a tolerance is absolute around 0
  const auto loss = [&](double off) { return -power_at(y, window, best + off * bin); };
  constexpr int bits = std::numeric_limits<double>::digits / 2;
  return best + bin * boost::math::tools::brent_find_minima(loss, -0.25, 0.25, bits).first;
}

std::vector<Series> series_of(const std::vector<Zoom>& zooms, const VectorXcd& u, double reach) {
  std::vector<Series> list;
  for (const auto& zoom : zooms) {
    Series s{.zoom = &zoom, .y = VectorXcd::Zero(zoom.z.rows()), .omega = zoom.omega};
    if (zoom.z.rows() >= least_rows) {
      for (Index j = 0; j < zoom.z.rows(); ++j)
        if (is_whole(zoom, j)) s.y[j] = (u.adjoint() * zoom.z.row(j).transpose())(0, 0);
      s.omega +=
          best_turn(s.y, reach * static_cast<double>(zoom.hop)) / static_cast<double>(zoom.hop);
      for (Index j = 0; j < s.y.size(); ++j) s.y[j] *= turned_back(zoom, s.omega, j);
    }
    list.push_back(std::move(s));
  }
  return list;
}

/// Does the power stand out of what is 3 or more lines of whole records away, however near?
bool is_resolved(const std::vector<Series>& list, double chance) {
  constexpr Index nearest = 3;
  for (const Index farthest : std::array<Index, 4>{6, 12, 24, 48}) {
    double own = 0.0, around = 0.0, records = 0.0, values = 0.0;
    for (const auto& s : list) {
      const Index rows = s.y.size();
      if (rows < least_rows) continue;
      const VectorXd window = hann_window(rows);
      const double bin = two_pi / static_cast<double>(rows);
      const Index to = std::min(farthest, rows / 8);
      double sum = 0.0;
      for (Index b = nearest; b <= to; ++b)
        sum += power_at(s.y, window, bin * static_cast<double>(b)) +
               power_at(s.y, window, -bin * static_cast<double>(b));
      const auto count = static_cast<double>(2 * (to - nearest + 1));
      own += power_at(s.y, window, 0.0);
      around += sum / count;
      records += 1.0;
      values += count / bins_of_hann;
    }
    if (records == 0.0 ||
        !(own > around * numerics::fisher_quantile(1.0 - chance, 2.0 * records, 2.0 * values)))
      return false;
  }
  return true;
}

/// A multisine has many lines side by side. Are there hardly any others, as strong as a tenth of
/// the tone, within `reach` [rad/sample]?
bool is_alone(const std::vector<Series>& list, double filled, double reach) {
  constexpr double as_strong = 0.1;
  constexpr int most_others = 1;
  for (const auto& s : list) {
    if (s.y.size() < least_rows) continue;
    const VectorXd window = hann_window(s.y.size());
    const double bin = two_pi / static_cast<double>(s.y.size()),
                 hop = static_cast<double>(s.zoom->hop);
    const auto nearest = 3 + static_cast<Index>(std::ceil(filled * hop / bin)),
               farthest = static_cast<Index>(reach * hop / bin);
    const double least = as_strong * power_at(s.y, window, 0.0);
    int others = 0;
    for (const double side : {-1.0, 1.0})
      for (Index b = nearest; b <= farthest; ++b) {
        const auto at = [&](Index k) {
          return power_at(s.y, window, side * bin * static_cast<double>(k));
        };
        const double own = at(b);
        if (own > least && own >= at(b - 1) && own > at(b + 1)) ++others;
      }
    if (others > most_others) return false;
  }
  return true;
}

/// Values of the splines that are not zero at a sample: coefficients `first` … `first` + 3.
struct SplineRow {
  Index first{};
  std::array<double, 4> weight{};
};

SplineRow spline_row(double at, Index coefficients) {
  const double x = std::clamp(at, 0.0, static_cast<double>(coefficients - 3) * (1.0 - 1e-12));
  const auto i = static_cast<Index>(x);
  const double u = x - static_cast<double>(i), v = 1.0 - u;
  return {i,
          {v * v * v / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
           (-3.0 * u * u * u + 3.0 * u * u + 3.0 * u + 1.0) / 6.0, u * u * u / 6.0}};
}

Index coefficient_count(const Zoom& zoom, double spacing) {
  if (spacing == 0.0) return 1;
  const double end = zoom.time(zoom.z.rows() - 1) + static_cast<double>(zoom.window);
  return static_cast<Index>(std::ceil(end / spacing)) + 3;
}

void add_splines(double sample, double spacing, Complex factor,
                 Eigen::Ref<Eigen::RowVectorXcd> to) {
  if (spacing == 0.0) {
    to[0] += factor;
    return;
  }
  const auto row = spline_row(sample / spacing, to.size());
  for (Index k = 0; k < 4; ++k) to[row.first + k] += factor * row.weight[static_cast<size_t>(k)];
}

/// What a zoom would show of each spline times e^(iωt), turned back: of a periodic record less the
/// mean period.
MatrixXcd design_of(const Series& s, double spacing) {
  const auto& zoom = *s.zoom;
  MatrixXcd D = MatrixXcd::Zero(zoom.z.rows(), coefficient_count(zoom, spacing));
  const auto P = static_cast<double>(zoom.period);
  for (Index j = 0; j < D.rows(); ++j) {
    Eigen::RowVectorXcd row = Eigen::RowVectorXcd::Zero(D.cols());
    const double t = zoom.time(j);
    add_splines(t, spacing, 1.0, row);
    if (zoom.periods > 0) {
      const double own = std::floor((t - static_cast<double>(zoom.first)) / P);
      for (Index m = 0; m < zoom.periods; ++m) {
        const double later = (static_cast<double>(m) - own) * P;
        add_splines(t + later, spacing,
                    -std::polar(1.0 / static_cast<double>(zoom.periods), s.omega * later), row);
      }
    }
    D.row(j) = row;
  }
  return D;
}

/// Every `smoothed_step`-th mean over `smoothed_rows` rows under Hann's window, where none of them
/// is missing.
MatrixXcd smoothed(const Zoom& zoom, const MatrixXcd& rows) {
  const VectorXd window = hann_window(smoothed_rows) / hann_window(smoothed_rows).norm();
  std::vector<Index> starts;
  for (Index j = 0; j + smoothed_rows <= rows.rows(); j += smoothed_step) {
    bool whole = true;
    for (Index k = 0; k < smoothed_rows; ++k) whole = whole && is_whole(zoom, j + k);
    if (whole) starts.push_back(j);
  }
  MatrixXcd result(static_cast<Index>(starts.size()), rows.cols());
  for (Index k = 0; k < result.rows(); ++k)
    result.row(k) =
        window.transpose() * rows.middleRows(starts[static_cast<std::size_t>(k)], smoothed_rows);
  return result;
}

/// Values of a smoothed series that are independent.
double independent_values(Index rows) {
  return static_cast<double>(rows) * bins_of_hann * static_cast<double>(smoothed_step) /
         static_cast<double>(smoothed_rows);
}

/// Envelopes of all records with knots of one spacing.
struct EnvelopeFit {
  double spacing{};
  double criterion{};  // Schwarz's, in units of ln likelihood
  std::vector<VectorXcd> coefficients{};
};

EnvelopeFit fit_envelopes(const std::vector<Series>& list, double spacing) {
  EnvelopeFit fit{.spacing = spacing};
  double squares = 0.0, values = 0.0, parameters = 0.0;
  for (const auto& s : list) {
    fit.coefficients.emplace_back();
    if (s.y.size() < least_rows) continue;
    const MatrixXcd y = smoothed(*s.zoom, s.y), D = smoothed(*s.zoom, design_of(s, spacing));
    if (y.rows() == 0) continue;
    MatrixXcd G = D.adjoint() * D;
    constexpr double ridge = 1e-9;
    G.diagonal().array() += ridge * std::max(G.diagonal().real().maxCoeff(), 1e-300);
    fit.coefficients.back() = G.llt().solve(MatrixXcd(D.adjoint() * y)).col(0);
    squares += (y - D * fit.coefficients.back()).squaredNorm();
    values += independent_values(y.rows());
    parameters += static_cast<double>(D.cols()) + 0.5;  // the frequency is half of one
  }
  fit.criterion = parameters < 0.5 * values ? values * std::log(std::max(squares, 1e-300)) +
                                                  parameters * std::log(std::max(values, 2.0))
                                            : std::numeric_limits<double>::infinity();
  return fit;
}

/// The same without a tone.
double criterion_without(const std::vector<Series>& list) {
  double squares = 0.0, values = 0.0;
  for (const auto& s : list) {
    if (s.y.size() < least_rows) continue;
    const MatrixXcd y = smoothed(*s.zoom, s.y);
    squares += y.squaredNorm();
    values += independent_values(y.rows());
  }
  return values * std::log(std::max(squares, 1e-300));
}

EnvelopeFit best_envelopes(const std::vector<Series>& list) {
  auto best = fit_envelopes(list, 0.0);
  double longest = 0.0, shortest = 0.0;
  for (const auto& s : list) {
    const auto hop = static_cast<double>(s.zoom->hop);
    longest = std::max(longest, hop * static_cast<double>(s.y.size()));
    shortest = hop * static_cast<double>(smoothed_rows);
  }
  // knots in a record of hours: a frequency that wanders there within less than a minute is not
  // followed
  constexpr double denser = 1.4, first = 3.0, most = 128.0;
  shortest = std::max(shortest, longest / most);
  for (double spacing = longest / first; spacing > shortest; spacing /= denser)
    if (auto fit = fit_envelopes(list, spacing); fit.criterion < best.criterion)
      best = std::move(fit);
  return best;
}

/// e at the rows of a zoom.
VectorXcd envelope_at(const Series& s, const ToneEnvelope& envelope) {
  VectorXcd e(s.y.size());
  for (Index j = 0; j < e.size(); ++j) e[j] = envelope.at(s.zoom->time(j));
  return e;
}

/// Relative variance of |e|².
double unevenness_of(const VectorXcd& e) {
  const Eigen::ArrayXd power = e.cwiseAbs2();
  return (power / std::max(power.mean(), 1e-300) - 1.0).square().mean();
}

/// Is the modulus more nearly constant than that of a Gaussian process?
bool is_even(const std::vector<Series>& list, const std::vector<ToneTrack>& tracks, double chance) {
  double J = 0.0, squares = 0.0, rows = 0.0;
  for (std::size_t r = 0; r < list.size(); ++r) {
    if (tracks[r].envelope.coefficients.size() < 2) continue;
    const VectorXcd e = envelope_at(list[r], tracks[r].envelope);
    const Index n = e.size();
    double together = 1.0;  // Σ of |correlation|²
    for (Index k = 1; k < n; ++k)
      together += 2.0 * std::norm(e.head(n - k).dot(e.tail(n - k))) / std::pow(e.squaredNorm(), 2);
    J += static_cast<double>(n) / together;
    squares += static_cast<double>(n) * tracks[r].unevenness;
    rows += static_cast<double>(n);
  }
  constexpr double fewest = 3.0;
  if (J < fewest) return false;
  return log_chance_of_evenness(J, std::max(squares / rows, 1e-12)) < std::log(chance);
}

/// A_c by least squares.
VectorXcd tone_amplitudes(const Series& s, const VectorXcd& coefficients, double spacing) {
  const auto& zoom = *s.zoom;
  MatrixXcd still = zoom.z;
  for (Index j = 0; j < still.rows(); ++j) still.row(j) *= turned_back(zoom, s.omega, j);
  const VectorXcd e = smoothed(zoom, design_of(s, spacing) * coefficients);
  const MatrixXcd z = smoothed(zoom, still);
  return (e.adjoint() * z).transpose() / std::max(e.squaredNorm(), 1e-300);
}

}  // namespace

Complex ToneEnvelope::at(double sample) const {
  if (spacing == 0.0) return coefficients[0];
  const auto row = spline_row(sample / spacing, coefficients.size());
  Complex sum = 0.0;
  for (Index k = 0; k < 4; ++k)
    sum += row.weight[static_cast<std::size_t>(k)] * coefficients[row.first + k];
  return sum;
}

std::vector<ToneTrack> fit_tone(const std::vector<Zoom>& zooms, double line, double wander,
                                const ToneOptions& options) {
  if (zooms.empty() ||
      std::ranges::all_of(zooms, [](const Zoom& zoom) { return zoom.z.rows() < least_rows; }))
    return {};
  const VectorXcd u = best_combination(zooms, line, wander);
  if (u.size() == 0) return {};
  const auto list = series_of(zooms, u, line + wander);
  const auto fit = best_envelopes(list);
  if (!(criterion_without(list) - fit.criterion > options.evidence)) return {};
  std::vector<ToneTrack> tracks;
  for (std::size_t r = 0; r < list.size(); ++r) {
    ToneTrack track{.omega = list[r].omega, .envelope = {}};
    if (auto c = fit.coefficients[r]; c.size() > 0) {
      ToneEnvelope envelope{fit.spacing, c};
      const VectorXcd e = envelope_at(list[r], envelope);
      track.unevenness = unevenness_of(e);
      c /= std::max(e.norm() / std::sqrt(static_cast<double>(e.size())), 1e-300);
      track.envelope = {fit.spacing, c};
      track.amplitude = tone_amplitudes(list[r], c, fit.spacing);
    }
    tracks.push_back(std::move(track));
  }
  if (!is_alone(list, wander, beside_to * line)) return {};
  if (!is_resolved(list, options.resolved_chance) &&
      !is_even(list, tracks, options.envelope_chance))
    return {};
  return tracks;
}

}  // namespace hydrapod::identification
