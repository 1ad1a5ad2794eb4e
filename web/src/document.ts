// The JSON that src/report writes; fields as in docs/howto/json.md.

import type { Identification } from './identification/types';

export type Vector = [number, number, number];

export interface Strain {
  /** Of `axial` where the legs have no oil. */
  oil: number;
  axial?: 'struts' | 'screws';
  guide_sleeve: number;
  piston_ring: number;
  base_mount?: number;
  payload?: number;
  /** Of legs that bend. */
  bending?: number;
  preload: number;
  per_leg: { oil: number[]; guide_sleeve: number[]; piston_ring: number[]; bending?: number[] };
}

export interface Mode {
  number: number;
  omega_rad_s: number;
  frequency_hz: number;
  damping_ratio: number;
  stable: boolean;
  label: string;
  moves_platform: boolean;
  group: number;
  platform_energy: number[];
  leg_energy: number[];
  /** Of a base with coordinates of its own. */
  base_energy?: number[];
  /** Of modes of the payload, in absolute motion. */
  payload_energy?: number;
  strain_energy: Strain;
  shape: number[];
  shape_imaginary?: number[];
  rigid?: { mode: number; omega_rad_s: number; mac: number; shift_percent: number };
}

/** Where it is, and its motion per motion of the platform joint and of φ1, φ2 (, u1, u2), row by row. */
export interface DrawnPoint {
  at_m: Vector;
  motion: number[][];
}

export interface DrawnLeg {
  sleeve: DrawnPoint;
  piston: DrawnPoint;
  rod_at_sleeve: DrawnPoint;
}

export interface Leg {
  base_joint_m: Vector;
  platform_joint_m: Vector;
  length_m: number;
  L_g: number;
  l_mn: number;
  /** Not in the rigid model. */
  bent?: DrawnLeg;
  straight: DrawnLeg;
  bore_m?: number;
  rod_diameter_m?: number;
  /** A spring between the joints, without case, rod and sleeve. */
  strut?: boolean;
}

export interface Geometry {
  platform: { origin_m: Vector; rotation: [Vector, Vector, Vector]; mass_center_m: Vector };
  legs: Leg[];
}

export interface Peak {
  direction: string;
  omega_rad_s: number;
  frequency_hz: number;
  /** null where its mode has no damping */
  magnitude: number | null;
  mode: number;
  own: boolean;
}

export interface Bode {
  point: string;
  point_m: Vector;
  from_rad_s: number;
  to_rad_s: number;
  points: number;
  peaks: Peak[];
  rigid_peaks: Peak[];
}

export interface Answer {
  text: string;
  stable: boolean;
  mode: number;
  frequency_hz: number;
  directions: string;
  strain_energy: {
    oil: number;
    axial?: 'struts' | 'screws';
    guide_sleeve: number;
    piston_ring: number;
    bending?: number;
  };
  rigid_mode?: number;
  rigid_frequency_hz?: number;
  drop_percent?: number;
  share_of_rigid_mode?: number;
  peak_height?: number;
  main_mode?: number;
  main_frequency_hz?: number;
  main_share_of_rigid_mode?: number;
  main_peak_height?: number;
}

export interface PoseReport {
  pose: { name: string; position_m: Vector; rotation_rad: Vector };
  answer: Answer | null;
  model: 'rigid' | 'guide' | 'full';
  coordinates: string[];
  modes: Mode[];
  rigid_modes: Mode[];
  geometry: Geometry;
  bode?: Bode;
}

/** As much of it as a comparison of frequencies needs. */
export interface BriefPose {
  pose: Pick<PoseReport['pose'], 'name'>;
  answer: Pick<Answer, 'stable'> | null;
  model: PoseReport['model'];
  modes: BriefMode[];
  rigid_modes: BriefMode[];
}

export interface BriefMode extends Pick<Mode, 'number' | 'frequency_hz' | 'stable' | 'platform_energy'> {
  rigid?: Pick<NonNullable<Mode['rigid']>, 'mode' | 'mac'>;
}

/** A run of `hydrapod simulate`; lists of six, per direction or leg, of values over time. */
export interface Simulation {
  pose: string;
  geometry: Geometry;
  commands: string[];
  summary: string;
  trace: {
    time_s: number[];
    /** From the pose at which it began [m, rad]. */
    command: number[][];
    motion: number[][];
    piston_m: number[][];
    drive: number[][];
    cap_pressure_Pa: number[][];
    rod_pressure_Pa: number[][];
    /** Of electric drives, whose pressures are empty. */
    nut_m?: number[][];
    motor_speed_rad_s?: number[][];
    torque_N_m?: number[][];
  };
}

/** What a direction or a leg can do at most, and what limits it. */
export interface Reach {
  value: number;
  limit: string;
  leg?: number;
}

export type Ability = 'force' | 'velocity' | 'acceleration' | 'jerk' | 'excursion';

export interface PoseCheck {
  condition: number;
  equilibrium: boolean;
  sound: boolean;
  warnings: string[];
  legs: {
    length_m: number;
    axial_force_N: number;
    static_tilt_rad: number;
    sleeve_offset_m: number;
    guide_gap_m?: number;
    bow_m?: number;
    retract_left_m?: number;
    extend_left_m?: number;
    cap_pressure_Pa?: number | null;
    rod_pressure_Pa?: number | null;
    /** null of a strut, as the largest forces */
    piston_m: number | null;
    largest_push_N: number | null;
    largest_pull_N: number | null;
    /** Of electric cylinders. */
    holding_torque_N_m?: number;
    torque_limit_N_m?: number;
    largest_speed_m_s?: number;
    column?: { strength_N: number };
  }[];
  buckling: { status: 'found' | 'not_found' | 'buckled' | 'not_sought'; payload_kg?: number };
  first_resonance_rad_s?: number;
  capability?: {
    /** Along the axis and against it, from rest. */
    directions: ({ direction: string } & Record<Ability, [Reach, Reach]>)[];
    /** Share of it that is there in all directions at once. */
    combined: Partial<Record<Ability, number>>;
    gain_limit_1_s?: number;
  };
}

/** As `hydrapod check` has it, at the poses of the report. */
export interface Check {
  sound: boolean;
  verdict: string;
  simulation_assumptions: { key: string; text: string }[];
  poses: PoseCheck[];
}

/** How a result was made. */
export interface Reproduction {
  program: string;
  version: string;
  /** Of the program's sources; "-changed" behind it where they were changed since. */
  commit: string | null;
  date: string;
  /** The arguments of the program. */
  command: string[];
  inputs: { option: string; path: string; bytes: number | null; sha256: string | null }[];
}

export interface Place {
  name: string;
  position: Vector;
  rotation: [Vector, Vector, Vector];
}

/** The machine as the page's core takes it (src/report/editable_machine.hpp). */
export interface Editable {
  /** Units as the machine file writes them, by path; `size` in SI. */
  units: Record<string, { name: string; size: number }>;
  /** By SI unit: units in which a value may be typed, by their size. */
  scales: Record<string, Record<string, number>>;
  model: 'rigid' | 'guide' | 'full';
  /** Of which modes the frequencies of maps and samples are. */
  frequencies: 'undamped' | 'damped';
  /** Poses of the machine, the neutral one first. */
  poses: Place[];
  /** Poses of the report: `of` the machine's, or a displacement from the neutral one. */
  shown: (Place & { of: number | null })[];
  /** `--set` that lead from the machine file to this machine; absent where none do. */
  overrides?: string[];
}

/** A difference and whether it is one. */
export interface TestedDifference {
  difference: number;
  deviation: number | null;
  p: number | null;
  verdict: 'cannot_say' | 'not_significant' | 'significant' | 'calculated';
}

export interface ComparedThing {
  what: 'machine' | 'modes' | 'record';
  name: string;
  description: string;
  modes: {
    omega_rad_s: number;
    frequency_hz: number;
    damping_ratio: number;
    omega_deviation_rad_s: number | null;
    damping_deviation: number | null;
    label: string;
  }[];
  responses: { name: string; unit: string; frequency_hz: number[]; re: number[]; im: number[] }[];
}

/** What `hydrapod compare --format json` writes, with the verdict in words. */
export interface SideBySide {
  level_percent: number;
  test: string;
  things: ComparedThing[];
  comparisons: {
    /** From 1; the first is what the others are compared with. */
    thing: number;
    shapes: string;
    verdict: string;
    pairs: {
      first: number;
      second: number;
      mac: number | null;
      omega_rad_s: TestedDifference;
      damping_ratio: TestedDifference;
    }[];
    first_left: number[];
    second_left: number[];
  }[];
}

export interface Report {
  kind: string;
  title: string;
  machine: {
    name: string;
    description: string;
    source: string;
    /** Which machine the results are of: nominal, calibrated, with which overrides. */
    state: string;
    file: string;
    overrides: string[];
    text?: string;
    warnings?: string[];
  };
  assumptions: {
    hydrapod: string;
    gravity_m_s2: Vector;
    gravity: string;
    flexible_axes: string;
    damping: string;
    modal_ratio: number;
    modal_ratio_is_default: boolean;
  };
  pictured_modes: number[];
  /** How this page was made; absent where a program called the library. */
  reproduction?: Reproduction;
  poses: PoseReport[];
  editable?: Editable;
  check?: Check;
  simulation?: Simulation;
  diagnosis?: Diagnosis;
  identification?: Identification;
  comparison?: SideBySide;
  /** Of a page that `hydrapod studio` serves. */
  studio?: { page: number };
}

export const directions = ['x', 'y', 'z', 'rx', 'ry', 'rz'] as const;

/** Modes of the same frequency as `mode`, itself included. */
export function repeated(modes: Mode[], mode: Mode): Mode[] {
  return modes.filter((other) => other.group === mode.group);
}

/** Is it a local seal mode? */
export const folded = (mode: Mode): boolean => !mode.moves_platform;

const platformShare = (mode: Mode): number =>
  mode.platform_energy.reduce((sum, part) => sum + part, 0);

/**
 * The modes shown in print: those of --modes, else at most six without local seal modes: the
 * lowest three with a tenth of the energy in the platform, and those that move it most. A diagnosis
 * without --modes names the mode that is shown first, which is one of them.
 */
export function pictured(report: Report, pose: PoseReport): Mode[] {
  const named = report.pictured_modes.flatMap((number) => pose.modes.filter((m) => m.number === number));
  const asked = report.reproduction?.command.some((word) => /^--modes(=|$)/.test(word)) ?? true;
  if (named.length > 0 && (asked || !report.diagnosis)) return named;
  const felt = pose.modes.filter((mode) => mode.moves_platform);
  const lowest = felt.filter((mode) => platformShare(mode) >= 0.1).slice(0, 3);
  const moving = [...felt].sort((a, b) => platformShare(b) - platformShare(a));
  return [...new Set([...named, ...lowest, ...moving])].slice(0, 6).sort((a, b) => a.number - b.number);
}

/** The mode that is shown when the page opens. */
export function firstMode(report: Report, pose: PoseReport): number {
  return report.pictured_modes[0] ?? pose.answer?.mode ?? 1;
}

/** A measured mode and its counterparts in the models. */
export interface DiagnosedMode {
  pose: string;
  direction: string | null;
  /** What the mode paired with it mainly does, where that contradicts `direction`. */
  mode_direction?: string;
  frequency_hz: number;
  deviation_hz: number;
  nominal_hz: number;
  fitted_hz: number;
  rigid_hz: number | null;
  rigid_mac: number;
  drop: number;
  strain_energy: {
    oil: number;
    /** What `oil` is of where it is no oil. */
    axial?: string;
    guide_sleeve: number;
    piston_ring: number;
    base_mount: number;
    payload?: number;
    bending?: number;
  };
}

export interface Hypothesis {
  name: string;
  rigid_legs: boolean;
  /** In the order of the measured modes. */
  targets?: { frequency_hz: number; shape_mac: number | null }[];
  causes: { name: string; statement: string; family: string }[];
  bic_above_best: number;
  equally_good: boolean;
  parameters: {
    paths: string[];
    unit: string;
    value: number;
    deviation: number | null;
    at_bound: boolean;
  }[];
  contradictions: string[];
}

interface RemedyPoint {
  factor: number;
  /** Of the stiffest leg; `softest_N_m` of the softest where legs differ. */
  stiffness_N_m: number;
  softest_N_m?: number;
  frequency_hz: number;
  drop: number;
}

export interface Remedy {
  goal: { words: string; drop?: number; frequency_hz?: number; direction?: string };
  status: 'found' | 'met_already' | 'out_of_reach';
  present: RemedyPoint;
  required: RemedyPoint;
  curve: RemedyPoint[];
}

/** Measured responses at a pose with those of hypotheses at the same lines. */
export interface ResponseOverlay {
  pose: string;
  entry: 'valves' | 'forces' | 'commands';
  /** Response to the input of the same direction, else of all inputs together. */
  direct: boolean;
  /** Predictions are multiplied by one factor per curve. */
  scaled: boolean;
  frequency_hz: number[];
  /** Which hypotheses the predictions are of. */
  hypotheses: number[];
  curves: {
    direction: string;
    unit: string;
    measured: (number | null)[];
    /** Empty: this machine has no such response. */
    predicted: (number | null)[][];
  }[];
}

/** What `hydrapod diagnose --format json` writes, and `responses`. */
export interface Diagnosis {
  responses?: ResponseOverlay[];
  summary: string[];
  finding?: string;
  measured_modes?: DiagnosedMode[];
  hypotheses?: Hypothesis[];
  /** Of attribution and remedy. */
  computed_machine: 'nominal' | 'fitted';
  remedy?: Remedy;
}
