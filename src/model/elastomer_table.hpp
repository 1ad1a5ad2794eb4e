#pragma once
/// Maxwell arms for a measured stiffness over frequency. Private to the module.
///
/// The arms are those whose k(iω)/k is nearest to r (1 + iη) of the rows, in the sum of squares of
/// relative errors, with g ≥ 0. Their times are looked for on a grid that becomes finer: for given
/// times the problem is linear, and of the eight sets of arms with g > 0 the best counts.

#include <map>
#include <vector>

#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

struct ElastomerRow {
  double frequency{};  ///< [Hz]
  double ratio{};      ///< k'(ω)/k
  double loss{};       ///< k''/k'
};

struct FittedArms {
  MaxwellArms arms{};
  double worst{};  ///< largest relative error of k(iω)
  double worst_frequency{};
};

/// `rows`: at least two, frequencies and losses above 0, ratios above 1.
FittedArms fitted_arms(const std::vector<ElastomerRow>& rows);

/// Those of tables that several legs share.
using KnownFits = std::map<const Node*, FittedArms>;

/// Arms for the key `table` of a seal's elastomer, where the file has it; what is wrong is
/// reported, arms that miss the table are a finding.
void read_elastomer_table(const Section& seal, std::optional<Elastomer>& elastomer,
                          KnownFits& known, std::vector<Finding>& findings);

}  // namespace hydrapod::model
