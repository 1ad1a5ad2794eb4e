// Poses of the report as displacements.

import type { Editable, Place } from '../document';

/** Where a pose of the report is, as a displacement from the neutral one [m, rad]. */
export function displacementOf(editable: Editable, pose: number): number[] {
  const shown = editable.shown[pose]!;
  if (shown.of === 0) return Array(6).fill(0); // without the rounding of a product of rotations
  const neutral = editable.poses[0]!;
  const place: Place = shown.of === null ? shown : editable.poses[shown.of]!;
  const turn = (i: number, j: number): number =>
    shown.of === null ? place.rotation[i]![j]! : [0, 1, 2].reduce((sum, k) => sum + place.rotation[i]![k]! * neutral.rotation[j]![k]!, 0);
  const moved = place.position.map((p, i) => (shown.of === null ? p : p - neutral.position[i]!));
  const pitch = Math.asin(Math.min(1, Math.max(-1, -turn(2, 0))));
  return [...moved, Math.atan2(turn(2, 1), turn(2, 2)), pitch, Math.atan2(turn(1, 0), turn(0, 0))];
}
