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
  /// With gravity: the guide sleeves are so stiff that the axial force of each leg is this share of
  /// what would buckle it as a straight knee, F l_m l_mn / (l k_s l_mh²).
  double lowest_load{0.05};
  double highest_load{0.6};
};

/// poses[0] is "neutral", poses[1] "tilted" (up to 25° and a tenth of the machine's height away).
model::Machine random_machine(Random& random, const RandomMachineOptions& options = {});

/// Share of each leg's buckling load as RandomMachineOptions means it; the largest of the six.
double largest_load_share(const model::Machine& machine, const model::Pose& X_BP);

}  // namespace hydrapod::test
