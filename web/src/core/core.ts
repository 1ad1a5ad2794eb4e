// The core of the page that calculates, as the page sees it.

import script from 'core-worker';
import type { BriefPose, Editable, PoseReport } from '../document';
import type { Pole } from '../identification/types';
import type { Answered, Asked } from './worker';

export interface Parameter {
  path: string;
  /** SI */
  unit: string;
  value: number;
  bound: {
    lowest?: number;
    highest?: number;
    more_than_lowest?: boolean;
    less_than_highest?: boolean;
  };
  meaning: string;
  /** It enters the linear models of the mechanism. */
  mechanics: boolean;
  /** Of one leg. */
  single: boolean;
  /** Of an element: the array's path, and "[2]" or ".xy". */
  array?: [path: string, element: string];
}

export type Setting = [path: string, value: number];

export interface Request {
  set: Setting[];
  pose: number;
  /** Instead: a displacement from the neutral pose, x … rz [m, rad]. */
  displaced?: number[];
  points?: number;
}

/** Bode curves over a band (web/core/curves.hpp). */
export interface Band {
  /** Lines [rad/s]. */
  omega: Float64Array;
  /** All 36 with flexible, then with rigid legs: by line, output and input: re, im. */
  responses: Float64Array;
  /** Peaks of responses between different directions, with the mode behind them. */
  peaks: { legs: 'flexible' | 'rigid'; output: number; input: number; line: number; mode: number }[];
}

export interface Computed<Pose = PoseReport> {
  findings: { error: boolean; key: string; message: string }[];
  pose?: Pose;
  /** Why there are no modes. */
  problem?: string;
  /** Flexible then rigid legs, by line, output and input: re, im; of brief(): by line and direction. */
  responses?: Float64Array;
  milliseconds: number;
}

export type Brief = Computed<BriefPose>;

export interface Buckling {
  status: 'found' | 'none' | 'buckled';
  payload_kg?: number;
}

/** Samples with normal distributions about the values of the machine. */
export interface Scatter {
  set: Setting[];
  pose: number;
  displaced?: number[];
  /** Path, standard deviation as a share of the value, each leg for itself. */
  vary: [path: string, share: number, perLeg: boolean][];
  seed: number;
  from: number;
  count: number;
}

/** What the numbers of measured responses are (web/core/measured_fit.hpp). */
export interface MeasuredShape {
  outputs: number;
  inputs: number;
  lines: number;
  deviations: boolean;
  correlation: boolean;
  shift: number;
  residual_terms: number;
  window: number;
  duration: number;
}

/** Columns of a map (web/core/core.hpp). */
export const map = {
  columns: 31, status: 0, lowest: 1, direction: 2, drop: 3, first: 4, drops: 10, stroke: 16, share: 17, peak: 18, shares: 19, peaks: 25,
};

/** What the status of a row says, as in study::Status. */
export const mapStatus = ['computed', 'not allowed', 'out of reach', 'no equilibrium', 'buckled'];

/** What the core could not do; the message is its reason. */
export class CoreError extends Error {}

interface Waiting {
  resolve(answer: Answered): void;
  reject(error: CoreError): void;
}

export class Core {
  private waiting = new Map<number, Waiting>();
  private last = 0;
  /** Why the worker answers no more. */
  private broken: CoreError | null = null;
  parameters: Parameter[] = [];

  private constructor(private readonly worker: Worker) {
    worker.onmessage = ({ data }: MessageEvent<Answered>) => {
      const asked = this.waiting.get(data.id);
      this.waiting.delete(data.id);
      if (data.ok) asked?.resolve(data);
      else asked?.reject(new CoreError(data.text));
    };
    worker.onerror = (event) => {
      event.preventDefault();
      this.stop(event.message || 'its script did not start');
    };
    worker.onmessageerror = () => this.stop('an answer could not be read');
  }

  /** Without its worker nothing is answered any more. */
  private stop(reason: string): void {
    this.broken ??= new CoreError(reason);
    for (const { reject } of this.waiting.values()) reject(this.broken);
    this.waiting.clear();
  }

  /** Starts the worker with `module`, gzip in base 85, and opens the machine. */
  static async start(module: string, editable: Editable): Promise<Core> {
    const url = URL.createObjectURL(new Blob([script], { type: 'text/javascript' }));
    const core = new Core(new Worker(url));
    URL.revokeObjectURL(url);
    await core.call('start', module);
    core.parameters = JSON.parse((await core.call('open', JSON.stringify(editable))).text);
    return core;
  }

  private call(call: Asked['call'], text: string, numbers?: Float64Array): Promise<Answered> {
    if (this.broken) return Promise.reject(this.broken);
    const id = ++this.last;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, call, text, ...(numbers ? { numbers } : {}) } satisfies Asked);
    });
  }

  async compute(request: Request, omega?: Float64Array): Promise<Computed> {
    return this.computed({ points: 600, ...request }, omega);
  }

  /** While a value is dragged: frequencies, and direct responses. */
  async brief(request: Omit<Request, 'points'>, omega?: Float64Array): Promise<Brief> {
    return this.computed({ ...request, brief: true }, omega);
  }

  private async computed<Pose>(request: Request & { brief?: boolean }, omega?: Float64Array): Promise<Computed<Pose>> {
    const answer = await this.call('compute', JSON.stringify(request), omega);
    return {
      ...JSON.parse(answer.text),
      milliseconds: answer.milliseconds,
      ...(answer.numbers ? { responses: answer.numbers } : {}),
    };
  }

  /** Bode curves from … to [rad/s], with `points` lines and more around resonances. */
  async curves(request: Request & { from: number; to: number; points: number }): Promise<Band> {
    const numbers = (await this.call('curves', JSON.stringify(request))).numbers as Float64Array;
    const [begin, end] = [1 + numbers[0], 1 + 145 * numbers[0]];
    const peaks: Band['peaks'] = [];
    for (let at = end; at < numbers.length; at += 5) {
      const [legs, output, input, line, mode] = numbers.subarray(at, at + 5);
      peaks.push({ legs: legs === 0 ? 'flexible' : 'rigid', output, input, line, mode });
    }
    return { omega: numbers.subarray(1, begin), responses: numbers.subarray(begin, end), peaks };
  }

  async buckling(request: Request): Promise<Buckling> {
    return JSON.parse((await this.call('buckling', JSON.stringify(request))).text);
  }

  /** A row of `map.columns` numbers for each displacement from the neutral pose (six numbers). */
  async map(set: Setting[], displacements: Float64Array): Promise<Float64Array> {
    return (await this.call('map', JSON.stringify({ set }), displacements)).numbers as Float64Array;
  }

  /** Rows of the samples `from` … of `hydrapod montecarlo`, as of map(). */
  async scatter(request: Scatter): Promise<Float64Array> {
    return (await this.call('scatter', JSON.stringify(request))).numbers as Float64Array;
  }

  /** Has the core keep these responses for fit(). */
  async measured(shape: MeasuredShape, numbers: Float64Array): Promise<void> {
    await this.call('measured', JSON.stringify(shape), numbers);
  }

  /** The fit of poles to the measured responses: numbers as web/core/measured_fit.hpp says. */
  async fit(poles: Pole[]): Promise<Float64Array> {
    return (await this.call('fit', JSON.stringify({ poles }))).numbers as Float64Array;
  }

  /** Per direction the displacements from the neutral pose that are within reach. */
  async reach(set: Setting[]): Promise<[number, number][]> {
    return JSON.parse((await this.call('reach', JSON.stringify({ set }))).text);
  }

  async sensitivities(pose: number): Promise<Record<string, number>> {
    return JSON.parse((await this.call('sensitivities', JSON.stringify({ pose }))).text);
  }
}
