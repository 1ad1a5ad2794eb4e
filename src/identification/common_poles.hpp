#pragma once
/// Poles that all responses have in common: those of a filter that all sensors pass and no input
/// does, of a hold, of a converter. Private to the module.
///
/// With such a filter the responses are F(s) G(s), F a scalar and G those of the machine. At a pole
/// of the machine the residue is φ Lᵀ, of rank one. At a pole λ of F it is G(λ) times the residue
/// of F:
///
/// - with n = min(outputs, inputs) > 1 its rank is n, and a sum of φ Lᵀ has n terms for it: n poles
///   at one place. Symmetry makes two of a machine, not more, and none with high damping;
/// - with n = 1 it is a vector, which varies slowly above the modes of the machine: all poles of F
///   that are above these have the same shape.
///
/// A low-pass filter of third order or higher has a pole with high damping, those that are called
/// modes beside it.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

struct CommonPoleOptions {
  /// Poles stand at one place: |Δλ| ≤ near |Re λ|. Terms of one pole scatter by less than that, as
  /// what other filters and delays do to the fit is not the same in all.
  double near{0.25};
  /// They are n: the n-th singular value of their shapes, each of length 1, > rank · the first one,
  /// and that of their participations. Of two equal shapes it is what noise makes of them.
  double rank{0.1};
  /// The same shape, with n = 1: MAC > alike; of a pole of high damping, which is farther from the
  /// axis, where G differs more: > alike_damped. By chance five numbers have that once in 250.
  double alike{0.98}, alike_damped{0.9};
  Eigen::Index fewest_entries{3};  ///< of a shape: with fewer such a MAC says little
  /// So many modes of one shape, with n = 1, or an n of so many, need no pole of high damping
  /// beside them.
  std::size_t alone{3};
  double quality{0.3};  ///< at most
};

/// Names modes that are such poles, and lowers their quality. Not those whose quality is that low
/// for what another warning says: a resonance that moves makes modes of one shape too.
void find_common_poles(Identification& result, const CommonPoleOptions& options = {});

}  // namespace hydrapod::identification
