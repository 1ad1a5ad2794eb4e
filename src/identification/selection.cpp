#include "selection.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace hydrapod::identification {

namespace {

using Chart = std::vector<OrderPoles>;

/// Columns of unit length from the poles of `order` near `omega`.
template <class Vector>
MatrixXcd span_near(const OrderPoles& order, double omega, double neighbourhood,
                    Vector PoleEstimate::*vector) {
  MatrixXcd span;
  for (const auto& e : order.poles) {
    if (e.pole.real() >= 0.0 || std::abs(e.omega() - omega) > neighbourhood * omega) continue;
    add_direction(e.*vector, span);
  }
  return span;
}

class Matcher {
 public:
  Matcher(const Chart& chart, const SelectionOptions& options) : chart_(chart), options_(options) {
    for (const auto& order : chart) taken_.emplace_back(order.poles.size(), false);
    for (std::size_t n = 0; n < chart.size(); ++n)
      for (std::size_t i = 0; i < chart[n].poles.size(); ++i)
        if (!candidate(chart[n].poles[i])) taken_[n][i] = true;
  }

  [[nodiscard]] bool taken(PoleIndex at) const { return taken_[at.order][at.pole]; }
  void take(PoleIndex at) { taken_[at.order][at.pole] = true; }

  /// The pole of `order` that is most like `e`, if one matches.
  [[nodiscard]] std::optional<std::size_t> match(const PoleEstimate& e, std::size_t order) const {
    std::optional<std::size_t> best;
    double least = std::numeric_limits<double>::infinity();
    const auto& poles = chart_[order].poles;
    for (std::size_t j = 0; j < poles.size(); ++j) {
      if (taken_[order][j]) continue;
      const double frequency = std::abs(poles[j].omega() / e.omega() - 1.0);
      if (frequency > options_.frequency ||
          !same_damping(poles[j].damping_ratio(), e.damping_ratio(), options_))
        continue;
      // poles apart, and shapes apart: of two close modes the one with the same shape
      const double cost = std::abs(poles[j].pole - e.pole) / e.omega() / options_.frequency + 1.0 -
                          mac(poles[j].shape, e.shape);
      if (cost < least) {
        least = cost;
        best = j;
      }
    }
    if (best && !vectors_agree(e, order)) best.reset();
    return best;
  }

 private:
  [[nodiscard]] bool candidate(const PoleEstimate& e) const {
    return e.pole.real() < 0.0 && e.damping_ratio() <= options_.highest_damping;
  }

  [[nodiscard]] bool vectors_agree(const PoleEstimate& e, std::size_t order) const {
    const auto shapes =
        span_near(chart_[order], e.omega(), options_.neighbourhood, &PoleEstimate::shape);
    const auto participations =
        span_near(chart_[order], e.omega(), options_.neighbourhood, &PoleEstimate::participation);
    return share_in(e.shape, shapes) >= options_.vector &&
           share_in(e.participation, participations) >= options_.vector;
  }

  const Chart& chart_;
  const SelectionOptions& options_;
  std::vector<std::vector<bool>> taken_;
};

std::vector<PoleIndex> members_of(const Chart& chart, const Matcher& matcher, PoleIndex seed) {
  std::vector<PoleIndex> members;
  const auto& e = chart[seed.order].poles[seed.pole];
  for (std::size_t n = 0; n < chart.size(); ++n) {
    if (n == seed.order) {
      members.push_back(seed);
    } else if (const auto j = matcher.match(e, n)) {
      members.push_back({n, *j});
    }
  }
  return members;
}

double persistence_of(const std::vector<PoleIndex>& members, std::size_t orders) {
  const auto first = std::ranges::min(members, {}, &PoleIndex::order).order;
  return static_cast<double>(members.size()) / static_cast<double>(orders - first);
}

void describe(const Chart& chart, double neighbourhood, PoleCluster& cluster) {
  const auto count = static_cast<double>(cluster.members.size());
  double omega = 0.0, damping = 0.0;
  for (const auto& [n, i] : cluster.members) {
    omega += chart[n].poles[i].omega() / count;
    damping += chart[n].poles[i].damping_ratio() / count;
  }
  double omega2 = 0.0, damping2 = 0.0, vector = 0.0;
  for (const auto& [n, i] : cluster.members) {
    const auto& e = chart[n].poles[i];
    omega2 += std::pow(e.omega() / omega - 1.0, 2) / count;
    damping2 += std::pow(e.damping_ratio() - damping, 2) / count;
    const auto span = span_near(chart[n], e.omega(), neighbourhood, &PoleEstimate::shape);
    vector += share_in(cluster.representative.shape, span) / count;
  }
  cluster.frequency_scatter = std::sqrt(omega2);
  cluster.damping_scatter = std::sqrt(damping2);
  cluster.vector_consistency = vector;
}

/// The order in which most of the clusters around `cluster` have a pole, the highest of such.
std::size_t common_order(const std::vector<PoleCluster>& clusters, const Chart& chart,
                         const PoleCluster& cluster, double reach) {
  std::vector<int> votes(chart.size(), 0);
  const double omega = cluster.representative.omega();
  for (const auto& other : clusters)
    if (std::abs(other.representative.omega() - omega) <= reach * omega)
      for (const auto& member : other.members) ++votes[member.order];
  std::size_t best = cluster.members.back().order;
  for (const auto& member : cluster.members)
    if (votes[member.order] >= votes[best]) best = member.order;
  return best;
}

PoleStability stability_of(const PoleEstimate& e, const OrderPoles& before,
                           const SelectionOptions& options) {
  auto found = PoleStability::fresh;
  MatrixXcd shapes, participations;
  for (const auto& other : before.poles) {
    const double apart = std::abs(other.omega() / e.omega() - 1.0);
    if (apart <= options.neighbourhood) {
      add_direction(other.shape, shapes);
      add_direction(other.participation, participations);
    }
    if (apart > options.frequency) continue;
    found = std::max(found, PoleStability::frequency);
    if (same_damping(other.damping_ratio(), e.damping_ratio(), options))
      found = PoleStability::damping;
  }
  if (found == PoleStability::damping && share_in(e.shape, shapes) >= options.vector &&
      share_in(e.participation, participations) >= options.vector)
    found = PoleStability::vector;
  return found;
}

}  // namespace

double share_in(const VectorXcd& vector, const MatrixXcd& span) {
  const double whole = vector.squaredNorm();
  if (!(whole > 0.0) || span.cols() == 0) return 0.0;
  const Eigen::ColPivHouseholderQR<MatrixXcd> qr(span);
  const VectorXcd coordinates = qr.householderQ().adjoint() * vector;
  return coordinates.head(std::min(qr.rank(), coordinates.size())).squaredNorm() / whole;
}

void add_direction(const VectorXcd& vector, MatrixXcd& span) {
  span.conservativeResize(vector.size(), span.cols() + 1);
  span.rightCols<1>() = vector.normalized();
}

bool is_near(Complex a, Complex b, double near) {
  return std::abs(std::abs(a) / std::abs(b) - 1.0) < near;
}

bool same_damping(double other, double ratio, const SelectionOptions& options) {
  return std::abs(other - ratio) <= options.damping * ratio + options.damping_floor;
}

Complex mean_pole(const PoleCluster& cluster, const std::vector<OrderPoles>& chart) {
  Complex mean = 0.0;
  for (const auto& [n, i] : cluster.members)
    mean += chart[n].poles[i].pole / static_cast<double>(cluster.members.size());
  return mean;
}

std::vector<PoleCluster> select_poles(const std::vector<OrderPoles>& chart,
                                      const SelectionOptions& options) {
  Matcher matcher(chart, options);
  // how many orders match each pole, when none is taken yet
  struct Seed {
    PoleIndex at;
    std::size_t matches;
  };
  std::vector<Seed> seeds;
  for (std::size_t n = 0; n < chart.size(); ++n)
    for (std::size_t i = 0; i < chart[n].poles.size(); ++i)
      if (!matcher.taken({n, i}))
        seeds.push_back({{n, i}, members_of(chart, matcher, {n, i}).size()});
  std::ranges::stable_sort(seeds, [](const Seed& a, const Seed& b) {
    return a.matches != b.matches ? a.matches > b.matches : a.at.order > b.at.order;
  });
  std::vector<PoleCluster> clusters;
  const auto fewest = std::min<std::size_t>(static_cast<std::size_t>(options.fewest), chart.size());
  for (const auto& seed : seeds) {
    if (matcher.taken(seed.at)) continue;
    PoleCluster cluster;
    cluster.members = members_of(chart, matcher, seed.at);
    cluster.persistence = persistence_of(cluster.members, chart.size());
    if (cluster.members.size() < fewest || cluster.persistence < options.persistence) continue;
    for (const auto& member : cluster.members) matcher.take(member);
    cluster.representative = chart[seed.at.order].poles[seed.at.pole];
    clusters.push_back(std::move(cluster));
  }
  auto chosen = clusters;
  for (auto& cluster : chosen) {
    const auto order =
        common_order(clusters, chart, cluster, options.voters * options.neighbourhood);
    for (const auto& [n, i] : cluster.members)
      if (n == order) cluster.representative = chart[n].poles[i];
    describe(chart, options.neighbourhood, cluster);
  }
  std::ranges::sort(chosen, {}, [](const PoleCluster& c) { return c.representative.omega(); });
  return chosen;
}

std::vector<std::vector<PoleStability>> pole_stability(const std::vector<OrderPoles>& chart,
                                                       const SelectionOptions& options) {
  std::vector<std::vector<PoleStability>> all;
  for (std::size_t n = 0; n < chart.size(); ++n) {
    all.emplace_back();
    for (const auto& e : chart[n].poles)
      all.back().push_back(n == 0 ? PoleStability::fresh : stability_of(e, chart[n - 1], options));
  }
  return all;
}

}  // namespace hydrapod::identification
