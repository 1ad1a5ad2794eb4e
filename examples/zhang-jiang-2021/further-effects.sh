#!/bin/bash
# What else might explain the last 0.043 rad/s between model and Table 2: one effect after the other is
# added to the reading of Table 1 that fits, and everything fitted anew. Prints a Markdown table.
set -euo pipefail

here=$(cd -P -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")" && pwd)
hydrapod=${HYDRAPOD:-$here/../../hydrapod}
targets=$(mktemp --suffix=.toml)
trap 'rm -f "$targets"' EXIT
# the targets and the free numbers, without the readings that do not fit
awk '/^\[\[alternative\]\]/ { skip = 1 } /^\[fit\]/ { skip = 0 } !skip' "$here/table-2.toml" >"$targets"

# effect, then options of calibrate
fit() {
  local effect=$1 worst
  shift
  worst=$("$hydrapod" calibrate "$here/table-1.toml" --targets "$targets" --format json \
    --set base.joints.circle.radius=0.5995 --set platform.joints.circle.radius=0.4 \
    --set "platform.mass_center[2]=-0.163" --set model.flexible_axes=gimbal "$@" |
    awk '/"worst_rad_s"/ && !found++ { gsub(/[^0-9.e-]/, "", $2); printf "%.4f", $2 }')
  printf '| %s | %s |\n' "$effect" "$worst"
}

printf '| effect | worst difference, rad/s |\n| --- | ---: |\n'
fit "none: the model as it is"
fit "first gimbal axis along the base's x" --set "legs.gimbal_axis=[1, 0, 0]"
fit "first gimbal axis at 15° to y" --set "legs.gimbal_axis=[0.2588190451, 0.9659258263, 0]"
fit "oil in the lines, m_a free" --free "legs.added_axial_inertia=0.001..30" --set legs.added_axial_inertia=1
fit "gravity, 9.81 m/s²" --set environment.gravity=9.81
fit "leg length of 0.86 m, as printed: platform at 0.768 m" --set "poses.neutral.position=[0, 0, 0.7680]"
fit "guide sleeve's stiffness free, as if not printed" --free "legs.guide_sleeve.stiffness=5e4..5e5"
fit "piston rings, stiffness free" --model full --set legs.piston_ring.stiffness=1e7 \
  --free "legs.piston_ring.stiffness=1e5..1e9"
fit "platform not round: I_xx and I_yy apart by 0.02 kg m²" --free "platform.inertia.xy=-0.02..0.02"
fit "mass centre off the axis by up to 5 mm" --free "platform.mass_center[0]=-0.005..0.005" \
  --free "platform.mass_center[1]=-0.005..0.005"
fit "legs 1, 3, 5 apart from 2, 4, 6 in the sleeve" --free \
  "leg.1.guide_sleeve.position,leg.3.guide_sleeve.position,leg.5.guide_sleeve.position=0.15..0.85"
fit "inertia of the lower gimbal's cross free" --set legs.gimbal_cross_inertia=0.05 \
  --free "legs.gimbal_cross_inertia=0.001..3" --starts 64
own=()
for leg in 1 2 3 4 5 6; do own+=(--free "leg.$leg.guide_sleeve.stiffness=1.5e5..1.65e5"); done
fit "every leg's guide sleeve of its own stiffness" "${own[@]}"
