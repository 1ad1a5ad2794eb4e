#pragma once
/// Machines that nobody would build, but that could be built: every leg different in every
/// parameter, joints scattered around circles, inertia tensors with products, a gimbal axis per
/// leg, the platform shifted and tilted. All pass kinematics::check_machine at both of their poses.

#include "hydrapod/model/machine.hpp"
#include "support/random.hpp"

namespace hydrapod::test {

enum class Gravity { none, down, anywhere };

struct RandomMachineOptions {
  model::FlexibleAxes axes{model::FlexibleAxes::transverse};
  bool piston_ring{true};
  Gravity gravity{Gravity::none};
  /// With gravity: the guide sleeves are so stiff that, of what each knee can take, the axial force
  /// (buckling of a straight knee at F l_m l_mn / l = k_s l_mh²) and the leg's own weight (bending
  /// it by 0.1 rad) together use a share between these two at the worse of both poses.
  double lowest_load{0.05};
  double highest_load{0.6};
};

/// poses[0] is "neutral", poses[1] "tilted" (up to 25° and a tenth of the machine's height away).
model::Machine random_machine(Random& random, const RandomMachineOptions& options = {});

/// F l_m l_mn / (l k_s l_mh²): 1 where a straight weightless knee would buckle. The largest of the
/// six.
double largest_load_share(const model::Machine& machine, const model::Pose& X_BP);

}  // namespace hydrapod::test
