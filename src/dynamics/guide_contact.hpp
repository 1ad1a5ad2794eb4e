#pragma once
/// The guide ring on which a rod lies when the O-rings of its seals give way by more than the gap.
///
/// Beside k_s d the guide presses with k_c h(|d| − g) against the offset d, g being the radial gap.
/// h is the ramp max(0, x), smooth so that Newton's method and integrators hold, with t = x / w and
/// w = `smoothing` g:
///
///     h = 0                            x ≤ −w
///     h = w (t + 1)³ (3 − t) / 16      |x| < w
///     h = x                            x ≥ w
///
/// h'' = 3 (1 − t²)/(4 w) is continuous: so is the stiffness, and its slope is bounded. The smooth
/// force exceeds that of the sharp corner by 3 k_c w / 16 at most (at x = 0) and equals it outside
/// of g ± w; under the same force the offset is smaller by less than w.
///
/// Energy U_c = k_c w² (t + 1)⁴ (4 − t) / 80 in the corner, k_c (x²/2 + w²/10) beyond it. The force
/// is along d, so that the stiffness differs with direction: the secant k_c h/|d| across d, the
/// tangent k_c h' along it. h is convex and zero up to x = −w > −|d|, so h' ≥ h/|d|.

#include <algorithm>
#include <cmath>

#include "hydrapod/model/machine.hpp"

namespace hydrapod::dynamics {

struct GuideContact {
  static constexpr double smoothing = 0.1;  ///< half width of the corner, of the gap

  double secant{};   ///< force per offset [N/m]
  double tangent{};  ///< [N/m]
  double energy{};   ///< [J]
};

/// At the offset |d| [m] for a gap [m] > 0 and the stiffness k_c [N/m].
inline GuideContact guide_contact(double offset, double gap, double k_c) {
  const double w = GuideContact::smoothing * gap, x = offset - gap;
  if (!(x > -w)) return {};
  if (x >= w) return {k_c * x / offset, k_c, k_c * (0.5 * x * x + 0.1 * w * w)};
  const double t = x / w, q = t + 1.0;
  return {k_c * w * q * q * q * (3.0 - t) / (16.0 * offset), k_c * q * q * (2.0 - t) / 4.0,
          k_c * w * w * q * q * q * q * (4.0 - t) / 80.0};
}

/// Of the seal δ, where rod and case in series with it give way by f per force: the root of
/// δ + f (k_s δ + k_c h(δ − g)) = `chords`. Convex in δ, so that Newton's method falls on it from
/// above. `gap` may be infinite.
inline double seal_offset(double chords, double f, double k_s, double gap, double k_c) {
  const double slope = 1.0 + f * k_s, free = chords / slope;
  const double w = GuideContact::smoothing * gap;
  if (!(free > gap - w)) return free;
  const double pressed = (chords + f * k_c * gap) / (slope + f * k_c);
  if (pressed >= gap + w) return pressed;
  double delta = std::min(free, gap + w);
  constexpr int most = 60;
  for (int k = 0; k < most; ++k) {
    const auto contact = guide_contact(delta, gap, k_c);
    const double excess = (slope + f * contact.secant) * delta - chords;
    const double next = delta - excess / (slope + f * contact.tangent);
    if (!(next < delta)) break;
    delta = next;
  }
  return delta;
}

inline GuideContact guide_contact(const model::GuideSleeve& sleeve, double offset) {
  return sleeve.gap ? guide_contact(offset, *sleeve.gap, sleeve.guide_stiffness) : GuideContact{};
}

}  // namespace hydrapod::dynamics
