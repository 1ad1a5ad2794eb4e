// The part of the document that `hydrapod report --measured` adds; fields as in docs/howto/json.md.

import type { Complex } from '../complex';

export interface Vector {
  re: number[];
  im: number[];
}

/** What the window does to an impulse response. */
export interface Taper {
  duration_s: number;
  /** ρ − 1 at even steps from lag 0 on; a power of two of them. */
  values: number[];
}

/** Measured frequency responses by output and input. */
export interface Measured {
  frequency_hz: number[];
  response: { re: number[]; im: number[]; deviation?: number[] }[][];
}

/** A pole λ [1/s] with its participation L. */
export interface Pole {
  pole: Complex;
  participation: Vector;
}

export interface Channel {
  name: string;
  unit: string;
  /** "x" … "rz" of the platform, "-x" against it, "leg 1", or none. */
  direction?: string;
  /** 1: a speed, 2: an acceleration. */
  time_derivatives?: number;
}

export interface FittedPole extends Pole {
  frequency_hz: number;
  frequency_95_hz: number;
  damping_ratio: number;
  damping_95: number;
  shape: Vector;
}

export interface IdentifiedMode extends FittedPole {
  displacement_shape: Vector;
  mpc: number;
  mpd_rad: number;
  quality: number;
  /** The outputs that move most, as `hydrapod identify` says it. */
  motion: string;
}

export type Agreement = 'new' | 'frequency' | 'damping' | 'vector';

export interface ChartPole extends Pole {
  frequency_hz: number;
  damping_ratio: number;
  stable: boolean;
  agrees: Agreement;
  /** From 1; null: of none. */
  cluster: number | null;
}

export interface ModelMode {
  frequency_hz: number;
  damping_ratio: number;
  label: string;
  /** Of the mass centre, x … rz [m, rad]; of modes that have a partner. */
  motion?: Vector;
}

export interface Comparison {
  heading: string;
  pairs: {
    mode: number;
    model: ModelMode;
    frequency_difference_percent: number;
    damping_difference_percent: number;
    mac: number | null;
  }[];
  not_in_model: number[];
  not_measured: (ModelMode & { reason: string })[];
}

export interface Identification {
  records: string[];
  measured: string;
  frame: string;
  band_hz: [number, number];
  inputs: Channel[];
  outputs: Channel[];
  modes: IdentifiedMode[];
  heavily_damped: FittedPole[];
  mac: number[][];
  fit_error: number;
  /** C_k, k = −2 …, of (s/scale)^k, by output and input. */
  residuals: { omega_scale_rad_s: number; terms: number[][][] };
  clusters: { mode: number | null; heavily_damped: number | null }[];
  stabilisation: { order: number; poles: ChartPole[] }[];
  indicator: { frequency_hz: number[]; values: number[][] };
  responses: Measured & {
    radius_95: number | null;
    shift_per_s: number;
    /** Of the errors of inputs, by pairs i < j. */
    input_correlation: Vector[] | null;
    multiple_coherence?: number[][];
  };
  taper: Taper | null;
  comparison: Comparison | null;
  warnings: string[];
  findings?: { kind: string }[];
}
