// Check and capability: is the machine sound, what do its legs bear at rest, what can it do.

import { directions, type Ability, type PoseCheck, type Reach } from '../document';
import { html, svg } from '../dom';
import { fixed, hertz, significant } from '../numbers';
import type { State } from '../state';
import { scroller } from '../table';
import type { Section } from './section';

export const check: Section = {
  id: 'check',
  title: 'Check and capability',
  of: 'report at pose',
  applies: (report) => report.check !== undefined && report.poses.length > 0,
  render: (state, host) => {
    const place = html('div', { class: 'check-result' });
    host.append(place);
    const show = () => place.replaceChildren(...parts(state));
    state.listen((change) => (change === 'pose' || change === 'numbers') && show());
    show();
  },
};

const degrees = 180 / Math.PI;

interface Axis {
  ability: Ability;
  title: string;
  /** Of translations and of rotations, with what SI is multiplied by. */
  units: [[name: string, factor: number], [name: string, factor: number]];
}

const axes: Axis[] = [
  { ability: 'force', title: 'Force', units: [['kN', 1e-3], ['kN m', 1e-3]] },
  { ability: 'velocity', title: 'Speed', units: [['m/s', 1], ['°/s', degrees]] },
  { ability: 'acceleration', title: 'Acceleration', units: [['m/s²', 1], ['°/s²', degrees]] },
  { ability: 'excursion', title: 'Excursion', units: [['mm', 1e3], ['°', degrees]] },
];

/** Kinds that concern the same part share a colour. */
const limits: Record<string, [family: string, text: string]> = {
  push: ['oil', 'oil force'],
  pull: ['oil', 'oil force'],
  column: ['column', 'rod buckles'],
  extending: ['valve', 'valve'],
  retracting: ['valve', 'valve'],
  pump: ['pump', 'pump'],
  stroke_out: ['stroke', 'stroke'],
  stroke_in: ['stroke', 'stroke'],
  base_joint: ['joint', 'base joint'],
  platform_joint: ['joint', 'platform joint'],
  torque: ['motor', 'motor torque'],
  motor_speed: ['motor', 'motor speed'],
  singular: ['other', 'singular pose'],
  range: ['other', 'not reached'],
};
const families: Record<string, string> = {
  oil: 'oil force of a leg',
  column: 'a rod buckles',
  valve: 'valve of a leg fully open',
  pump: 'flow of the pump',
  stroke: 'stroke of a leg',
  joint: 'joint angle',
  motor: 'motor of a leg: torque or speed',
  other: 'singular pose, or nothing within the range',
};

function parts(state: State): HTMLElement[] {
  const { report, poseNumber } = state;
  const found = report.check!;
  const pose = found.poses[poseNumber]!;
  const other = state.isWhatIf
    ? [html('p', { class: 'note' }, 'Of the machine of this report at its pose, without the changed values.')]
    : [];
  return [
    html('p', { class: found.sound ? 'check-verdict' : 'check-verdict problem' }, html('strong', {}, found.verdict)),
    ...other,
    ...(pose.warnings.length > 0 ? [html('ul', { class: 'check-warnings' }, ...pose.warnings.map((text) => html('li', {}, text)))] : []),
    html('p', {}, facts(pose)),
    html(
      'div',
      { class: 'check-parts' },
      scroller('Legs at rest', legTable(pose)),
      html('div', { class: 'check-abilities' }, ...(pose.capability ? capability(pose) : unable(pose))),
    ),
    ...(found.simulation_assumptions.length > 0
      ? [html('details', {}, html('summary', {}, 'Assumed values'), html('ul', {}, ...found.simulation_assumptions.map(({ key, text }) => html('li', {}, html('code', {}, key), `: ${text}`))))]
      : []),
  ];
}

/** Struts move nothing, and of motors without limits it is not said what they can do. */
function unable(pose: PoseCheck): HTMLElement[] {
  const moves = pose.legs.every((leg) => leg.piston_m !== null && (leg.holding_torque_N_m === undefined || leg.torque_limit_N_m !== undefined));
  return moves ? [html('p', {}, 'The machine does not stand at this pose: it can do nothing there.')] : [];
}

function facts(pose: PoseCheck): string {
  const { buckling, first_resonance_rad_s: first, capability: able } = pose;
  const payload = Math.abs(buckling.payload_kg ?? 0);
  const load = {
    found: `the legs buckle with ${fixed(payload, 0)} kg more on the platform`,
    not_found: 'the legs do not buckle up to 100 times the mass of the platform',
    buckled: `the legs buckle: ${fixed(payload, 0)} kg must come off`,
    not_sought: '',
  }[buckling.status];
  return [
    first === undefined ? '' : `lowest mode ${hertz(first / (2 * Math.PI))} Hz (|λ| of the damped mode)`,
    load,
    able?.gain_limit_1_s === undefined ? '' : `a position loop without damping feedback is stable up to a gain of ${fixed(able.gain_limit_1_s, 1)} 1/s`,
    `condition of the Jacobian ${fixed(pose.condition, 1)}`,
  ]
    .filter(Boolean)
    .join('; ')
    .replace(/^./, (letter) => letter.toUpperCase())
    .concat('.');
}

function legTable(pose: PoseCheck): HTMLElement {
  type Leg = PoseCheck['legs'][number];
  const ofOil = (force: (leg: Leg) => number | null) => (leg: Leg) => {
    const value = force(leg);
    return value === null || leg.holding_torque_N_m !== undefined ? null : 1e-3 * value;
  };
  const columns: [title: string, (leg: Leg) => number | null | undefined, digits: number][] = [
    ['length, mm', (leg) => 1e3 * leg.length_m, 1],
    ['stroke left in, mm', (leg) => leg.retract_left_m && 1e3 * leg.retract_left_m, 1],
    ['stroke left out, mm', (leg) => leg.extend_left_m && 1e3 * leg.extend_left_m, 1],
    ['force at rest, kN', (leg) => 1e-3 * leg.axial_force_N, 2],
    ['oil can push, kN', ofOil((leg) => leg.largest_push_N), 1],
    ['oil can pull, kN', ofOil((leg) => leg.largest_pull_N), 1],
    ['torque at rest, N m', (leg) => leg.holding_torque_N_m, 2],
    ['torque limit, N m', (leg) => leg.torque_limit_N_m, 1],
    ['largest speed, m/s', (leg) => leg.largest_speed_m_s, 3],
    ['column bears, kN', (leg) => leg.column && 1e-3 * leg.column.strength_N, 1],
    ['cap side, bar', (leg) => leg.cap_pressure_Pa && 1e-5 * leg.cap_pressure_Pa, 1],
    ['rod side, bar', (leg) => leg.rod_pressure_Pa && 1e-5 * leg.rod_pressure_Pa, 1],
    ['rod off its axis, mm', (leg) => (leg.piston_m === null ? null : 1e3 * leg.sleeve_offset_m), 2],
    ['gap of the guide, mm', (leg) => leg.guide_gap_m && 1e3 * leg.guide_gap_m, 2],
    ['bow of rod and case, mm', (leg) => leg.bow_m && 1e3 * leg.bow_m, 3],
  ];
  const shown = columns.filter(([, value]) => pose.legs.some((leg) => typeof value(leg) === 'number'));
  return html(
    'table',
    { class: 'numbers-table check-legs' },
    html('caption', {}, 'Legs at rest; forces are positive in compression, pressures absolute'),
    html('thead', {}, html('tr', {}, html('th', { scope: 'col' }, 'leg'), ...shown.map(([title]) => html('th', { scope: 'col' }, title)))),
    html('tbody', {}, ...pose.legs.map((leg, i) => html('tr', {}, html('th', { scope: 'row' }, i + 1), ...shown.map(([, value, digits]) => {
      const number = value(leg);
      return html('td', {}, typeof number === 'number' ? fixed(number, digits) : '–');
    })))),
  );
}

function capability(pose: PoseCheck): HTMLElement[] {
  const { directions: rows, combined } = pose.capability!;
  const used = new Set(axes.flatMap(({ ability }) => rows.flatMap((row) => row[ability].map(({ limit }) => limits[limit]?.[0] ?? 'other'))));
  const together = axes.flatMap(({ ability, title }) => {
    const share = combined[ability];
    return share === undefined ? [] : [`${title.toLowerCase()} ${fixed(100 * share, 0)} %`];
  });
  return [
    html('h3', {}, 'What it can do from rest, one direction at a time'),
    html('div', { class: 'abilities' }, ...axes.map((axis) => abilityPicture(axis, rows))),
    html('ul', { class: 'legend' }, ...Object.entries(families).filter(([family]) => used.has(family)).map(([family, text]) => html('li', {}, html('i', { class: `limit limit-${family}` }), `limited by: ${text}`))),
    ...(together.length > 0 ? [html('p', { class: 'note' }, `In all directions at once: ${together.join(', ')} of these.`)] : []),
  ];
}

const short = (value: number): string => significant(value, 3);

/** Bars along the axis to the right, against it to the left, as shares of the longest of three. */
function abilityPicture({ ability, title, units }: Axis, rows: NonNullable<PoseCheck['capability']>['directions']): HTMLElement {
  const [width, line, top] = [300, 26, 30];
  const [middle, longest] = [width / 2 + 10, 72];
  const height = top + 6 * line + 6;
  const most = [0, 3].map((first) => Math.max(...rows.slice(first, first + 3).flatMap((row) => row[ability].map(({ value }) => Math.abs(value))), Number.MIN_VALUE));
  const bar = (reach: Reach, d: number, sense: 1 | -1) => {
    const group = d < 3 ? 0 : 1;
    const [, factor] = units[group]!;
    const length = (longest * Math.abs(reach.value)) / most[group]!;
    const [family, text] = limits[reach.limit] ?? ['other', reach.limit];
    const who = reach.leg === undefined ? text : `${text} ${reach.leg}`;
    const y = top + d * line;
    return [
      svg('rect', { class: `limit-${family}`, x: sense > 0 ? middle : middle - length, y: y + 4, width: Math.max(length, 0.5), height: line - 9 }),
      svg('text', { x: middle + sense * (length + 4), y: y + 17, 'text-anchor': sense > 0 ? 'start' : 'end' }, short(factor * Math.abs(reach.value))),
      svg('title', {}, `${directions[d]} ${sense > 0 ? '+' : '−'}: ${who}`),
    ];
  };
  const words = rows.map((row, d) => `${directions[d]} ${row[ability].map((reach) => short(units[d < 3 ? 0 : 1]![1] * Math.abs(reach.value))).join(' and ')}`).join(', ');
  return html(
    'figure',
    { class: 'ability' },
    svg(
      'svg',
      { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': `${title} along the axis and against it, in ${units[0][0]} and ${units[1][0]}: ${words}` },
      svg('text', { class: 'ability-title', x: 4, y: 17 }, `${title} in ${units[0][0]}, ${units[1][0]}`),
      ...rows.flatMap((row, d) => [
        svg('text', { x: 4, y: top + d * line + 17 }, directions[d]),
        ...[1, -1].map((sense, k) => svg('g', {}, ...bar(row[ability][k]!, d, sense as 1 | -1))),
      ]),
      svg('line', { class: 'axis', x1: middle, x2: middle, y1: top, y2: height - 4 }),
    ),
  );
}
