#pragma once
/// Which poles are the machine's: those that come back whatever the model order.
///
/// A pole of one order matches one of another order when
///
///     |Δω|/ω ≤ frequency,   |Δζ| ≤ damping · ζ + damping_floor,   MAC ≥ vector,
///
/// MAC being that of its shape (and of its participation) with what the other order has within
/// `neighbourhood` of it: with the subspace that those poles span, so that repeated modes, whose
/// shapes may be mixed at will, count as the same. A cluster takes one pole of every order at most;
/// the pole that most other orders match begins the first one, and so on with what is left. So
/// a repeated mode makes as many clusters as it has poles. A cluster is kept when it has at
/// least `persistence` of the orders from the one on at which it first appears, and at least
/// `fewest`.

#include "hydrapod/data/modal_results.hpp"
#include "hydrapod/identification/poly_reference.hpp"

namespace hydrapod::identification {

using data::mac;

struct SelectionOptions {
  double frequency{0.01};
  double damping{0.2};
  double damping_floor{0.002};
  double vector{0.8};
  double neighbourhood{0.02};
  double persistence{0.5};
  int fewest{4};
  double highest_damping{0.9};  ///< poles with more than this are not looked at
};

/// Which pole of which order.
struct PoleIndex {
  std::size_t order{}, pole{};
};

struct PoleCluster {
  PoleEstimate representative{};     ///< of the highest order in which all clusters near it are
  std::vector<PoleIndex> members{};  ///< one per order at most
  double persistence{};              ///< share of the orders from the first one on
  double frequency_scatter{};        ///< standard deviation of ω over its mean, over members
  double damping_scatter{};          ///< standard deviation of ζ
  double vector_consistency{};       ///< mean MAC of the members with the representative
};

/// Ascending in frequency.
std::vector<PoleCluster> select_poles(const std::vector<OrderPoles>& chart,
                                      const SelectionOptions& options = {});

}  // namespace hydrapod::identification
