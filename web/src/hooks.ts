// The members of `window.hydrapod`, for tests and for the console; see docs/howto/report.md.

import type { Report } from './document';
import type { LegPoints } from './scene/motion';
import type { Complex } from './complex';
import type { Computed, Setting } from './core/core';
import type { State } from './state';

export interface SceneHook {
  /** 'webgl', or 'svg' where there is no WebGL. */
  kind: 'webgl' | 'svg';
  /** Points of leg 1…6 as drawn at this moment, base axes [m], read back from the drawing. */
  jointPositions(leg: number, side?: 'flexible' | 'rigid'): LegPoints;
  /** Metres (and radians) per unit of the mode's shape, phase [rad], factor on the rod tilt. */
  motion(): {
    amplitude: number;
    rigidAmplitude: number;
    phase: number;
    tilt: number;
    playing: boolean;
  };
  /** Stops the animation at a phase [rad] and draws it. */
  setPhase(phase: number): void;
  /** Frames drawn so far. */
  frames(): number;
}

export interface BodeHook {
  /** Resolves when the curves of the chosen band are shown; nothing below works before the first. */
  readonly ready: Promise<void>;
  choose(output: number, input: number): void;
  /** Puts the cursor on the point of the curve that is nearest to `frequency` [Hz]. */
  setCursor(frequency: number): void;
  /** What the readout shows, in full digits; null off the plot. */
  cursor(): Readout | null;
  /** Shown band [Hz]. */
  band(): [number, number];
}

export interface Readout {
  frequency_hz: number;
  flexible: { re: number; im: number } | null;
  rigid: { re: number; im: number };
}

export interface SimulationHook {
  /** Stops the motion at the sample nearest to `time` [s] and draws it, to scale. */
  setTime(time: number): void;
  /** Time of the sample that is shown [s]. */
  time(): number;
  jointPositions(leg: number): LegPoints;
  /** Frames drawn so far. */
  frames(): number;
  /** The part of the run in the diagrams [s]. */
  view(): [number, number];
  showPart(from: number, to: number): void;
  /** Times and lines that a diagram draws now. */
  data(diagram: number): number[][];
  /** The ends of the value axis of a diagram, in its unit. */
  span(diagram: number): [number, number];
}

export interface IdentificationHook {
  /** Resolves when what was chosen last is fitted and shown. */
  readonly ready: Promise<void>;
  /** Marks of the stabilisation chart as drawn, px of the picture. */
  marks(): { order: number; frequency_hz: number; x: number; y: number }[];
  /** Poles [1/s] that are switched on, in the order of the table. */
  chosen(): Complex[];
  /** Of the fit: √(Σ|Ĥ − H|²/Σ|Ĥ|²). NaN, and no shapes and responses, until there is one. */
  error(): number;
  /** Fitted shapes, by pole that is on and output. */
  shapes(): Complex[][];
  /** The fit at the measured lines, including the effect of the measurement window. */
  fitted(output: number, input: number): Complex[];
  /** The shape that is shown. */
  shape: {
    /** Points of leg 1…6 as drawn; null: nothing is drawn on this side. */
    jointPositions(leg: number, side?: 'measured' | 'model'): LegPoints | null;
    /** As of the scene; null: not drawn yet. */
    motion(): ReturnType<SceneHook['motion']> | null;
    setPhase(phase: number): void;
    frames(): number;
  };
}

export interface DiagnosisHook {
  /** Shows the prediction of a hypothesis, by its number in the document. */
  show(hypothesis: number): void;
  shown(): number;
  /** A measured response by pose and entry, and its direction 0 … 5. */
  choose(overlay: number, direction: number): void;
  /** The curves as drawn; null: no response was measured. `predicted` null: none can be computed. */
  drawn(): {
    frequency_hz: number[];
    measured: (number | null)[];
    predicted: (number | null)[] | null;
    nominal: (number | null)[] | null;
  } | null;
}

export interface ComparisonHook {
  /** Shows the response of this name. */
  choose(name: string): void;
  /** The curves as drawn, of the things from 0 that have the response; null: no line there. */
  drawn(): { thing: number; unit: string; frequency_hz: number[]; magnitude: (number | null)[]; phase: (number | null | undefined)[] }[];
}

export interface WhatIfHook {
  /** Starts the core where it has not started; resolves when it has opened the machine. */
  readonly ready: Promise<void>;
  /** Changes a value [SI], as a slider does while it is dragged; keep() ends the drag. */
  drag(path: string, value: number): void;
  keep(): void;
  undo(): void;
  redo(): void;
  changed(): Setting[];
  /** Has these values changed and no others. */
  replace(set: Setting[]): void;
  /** Resolves when what was dragged last is shown. */
  shown(): Promise<void>;
  /** What the core computes for these values, and responses at angular frequencies [rad/s]. */
  compute(set: Setting[], omega?: Float64Array): Promise<Computed>;
  /** The machine's own values [SI]. */
  values(): Record<string, number>;
  /** The arguments of `--set` for these values. */
  overrides(set: Setting[]): string[];
  /** The command that computes what is shown. */
  command(): string;
}

export interface WorkspaceHook {
  /** Starts the core where it has not started; resolves when the map is being calculated. */
  readonly ready: Promise<void>;
  /** Has the page show the machine there: x … rz from the neutral pose [m, rad]; null: at the report's. */
  displace(displaced: number[] | null): void;
  /** Resolves when the map has its finest level. */
  complete(): Promise<void>;
  /** Points of the map [m, rad] with their rows, see web/core/core.hpp. */
  rows(): { across: number; up: number; row: number[] }[];
  /** The command of the map that is shown. */
  command(): string;
}

export interface ScatterHook {
  /** Starts the core where it has not started; resolves when samples are being calculated. */
  readonly ready: Promise<void>;
  /** Path, standard deviation as a share of the value, each leg for itself. */
  vary(given: [path: string, share: number, perLeg: boolean][]): void;
  /** Resolves when all samples are there. */
  complete(): Promise<void>;
  /** A row per sample, see web/core/core.hpp. */
  rows(): number[][];
  /** The command of the samples. */
  command(): string;
}

declare global {
  interface Window {
    hydrapod: {
      report: Report;
      state: State;
      scene?: SceneHook;
      bode?: BodeHook;
      simulation?: SimulationHook;
      whatIf?: WhatIfHook;
      workspace?: WorkspaceHook;
      scatter?: ScatterHook;
      identification?: IdentificationHook;
      diagnosis?: DiagnosisHook;
      comparison?: ComparisonHook;
      /** When the machine was drawn first [ms since the page began to load]. */
      firstFrame?: number;
    };
  }
}
