#pragma once
/// Which fitted poles stay. Private to the module.

#include <vector>

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Of half spectra, modes whose going makes the misfit needed_by_others times as large stay: the
/// fit of the rest runs after what they explained, and loses its own. Modes that are nothing raise
/// it by less than one half, and one that the fit cannot do without by a thousand and more.
inline constexpr double needed_by_others = 10.0;

/// Fits the modal model to the representatives of `clusters`, takes out those that PruneOptions and
/// the limits of IdentifyOptions object to, and fits again, until all stay. Afterwards the modes of
/// result.model are those of result.clusters, in the same order; objections are appended to
/// result.left_out.
void fit_and_prune(const IdentifyOptions& options, std::vector<PoleCluster> clusters,
                   Identification& result);

/// The same for a trial of the clusters from number `tried` on: false, with an unfinished result,
/// as soon as there is an objection, or will be.
bool fit_if_all_stay(const IdentifyOptions& options, std::vector<PoleCluster> clusters,
                     std::size_t tried, Identification& result);

std::vector<PoleEstimate> estimates(const ModalModel& model);

/// The clusters of the modes that `result` has, at where the fit put them.
std::vector<PoleCluster> fitted_clusters(const Identification& result);

}  // namespace hydrapod::identification
