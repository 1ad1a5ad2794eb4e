// A leg at large motions, solved numerically: what the page's first-order motion is checked
// against.
//
// In the case's axes the platform joint stands at (u1 + l_mn e1, u2 + l_mn e2, s + l_mn e3), with e
// the rod's direction for tilts φ1 and φ2 about t and a2. The case turns about a1 = t + τ n, fixed
// in the base, and then about its own a2. Extension s and the two angles follow from where the
// joint is, by Newton with differences.

const rotate = (axis, angle, v) => {
  const size = Math.hypot(...axis);
  const k = axis.map((x) => x / size);
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  const dot = k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
  const cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
  return v.map((x, i) => x * c + cross[i] * s + k[i] * dot * (1 - c));
};

const direction = (p1, p2) => rotate([1, 0, 0], p1, rotate([0, 1, 0], p2, [0, 0, 1]));

/** Case coordinates to base axes for gimbal angles α and β. */
function place(leg, alpha, beta, v) {
  const { t, a2, n } = leg.axes;
  const own = rotate([0, 1, 0], beta, v);
  const inBase = [0, 1, 2].map((i) => own[0] * t[i] + own[1] * a2[i] + own[2] * n[i]);
  const a1 = t.map((x, i) => x + leg.tan_gimbal * n[i]);
  return rotate(a1, alpha, inBase);
}

function solve3(columns, right) {
  const det = (a, b, c) =>
    a[0] * (b[1] * c[2] - b[2] * c[1]) -
    a[1] * (b[0] * c[2] - b[2] * c[0]) +
    a[2] * (b[0] * c[1] - b[1] * c[0]);
  const whole = det(...columns);
  return [0, 1, 2].map((k) => det(...columns.map((c, i) => (i === k ? right : c))) / whole);
}

/** Points of `leg` when its joint is moved by `joint` and its tilt and offset by `flexible`. */
export function exactPoints(leg, joint, flexible) {
  const [p1, p2] = leg.tilt_rad.map((x, i) => x + flexible[i]);
  const [u1, u2] = leg.offset_m.map((x, i) => x + flexible[2 + i]);
  const e = direction(p1, p2);
  const arm = (s) => [u1 + leg.l_mn * e[0], u2 + leg.l_mn * e[1], s + leg.l_mn * e[2]];
  const target = leg.platform_joint_m.map((x, i) => x + joint[i] - leg.base_joint_m[i]);
  const residual = ([s, alpha, beta]) =>
    place(leg, alpha, beta, arm(s)).map((x, i) => x - target[i]);
  let x = [leg.l_m, 0, 0];
  for (let iteration = 0; iteration < 20; ++iteration) {
    const h = 1e-6;
    const columns = [0, 1, 2].map((k) => {
      const shifted = (by) => residual(x.map((value, i) => (i === k ? value + by : value)));
      const [up, down] = [shifted(h), shifted(-h)];
      return up.map((value, i) => (value - down[i]) / (2 * h));
    });
    const step = solve3(columns, residual(x));
    x = x.map((value, i) => value - step[i]);
    if (Math.hypot(...step) < 1e-14) break;
  }
  const [s, alpha, beta] = x;
  const at = (v) => place(leg, alpha, beta, v).map((value, i) => value + leg.base_joint_m[i]);
  return {
    base: leg.base_joint_m,
    sleeve: at([0, 0, leg.L_g]),
    piston: at([u1, u2, s]),
    rodAtSleeve: at([u1 + leg.l_mh * e[0], u2 + leg.l_mh * e[1], s + leg.l_mh * e[2]]),
    joint: leg.platform_joint_m.map((value, i) => value + joint[i]),
  };
}

/** Where the points are to first order when the leg moves by `amplitude` times `motion`: by differences. */
export function firstOrderPoints(leg, motion, amplitude) {
  const h = 1e-5;
  const at = (factor) =>
    exactPoints(
      leg,
      motion.joint.map((x) => factor * x),
      motion.flexible.map((x) => factor * x),
    );
  const [up, down, rest] = [at(h), at(-h), at(0)];
  const moved = {};
  for (const key of Object.keys(rest))
    moved[key] = rest[key].map((x, i) => x + (amplitude * (up[key][i] - down[key][i])) / (2 * h));
  return moved;
}

/** The straight leg of a rigid machine in the same place; its axes but n do not matter. */
export function straight(leg) {
  const n = leg.platform_joint_m.map((x, i) => (x - leg.base_joint_m[i]) / leg.length_m);
  const side = Math.abs(n[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0];
  const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0],
  ];
  const w = cross(n, side);
  const a2 = w.map((x) => x / Math.hypot(...w));
  return {
    ...leg,
    axes: { t: cross(a2, n), a2, n },
    l_m: leg.length_m - leg.l_mn,
    l_mh: leg.L_g - leg.length_m + leg.l_mn,
    tan_gimbal: 0,
    tilt_rad: [0, 0],
    offset_m: [0, 0],
  };
}
