// Rows of the core's map over two directions of the pose, calculated coarse first.

import { map, type Core, type Setting } from '../core/core';

export type Range = [number, number];

/** Points along each direction at the finest level, and at the first one. */
export const finest = 33;
const coarsest = 9;
/** So few at a time that a slider never waits for long. */
const atOnce = 8;

export class Field {
  private readonly rows = new Float64Array(finest * finest * map.columns).fill(Number.NaN);
  private readonly known = new Uint8Array(finest * finest);
  private stopped = false;
  /** Points along each direction that are known. */
  count = 0;

  constructor(
    private readonly core: Core,
    private readonly set: Setting[],
    readonly across: number,
    readonly up: number,
    readonly ranges: Range[],
    private readonly fixed: readonly number[],
  ) {}

  /** Position k of `count` along a direction [m, rad]. */
  at(direction: number, k: number, count = finest): number {
    const [from, to] = this.ranges[direction] as Range;
    return from + ((to - from) * k) / (count - 1);
  }

  /** Of the level that is known: column i, row j from below. */
  row(i: number, j: number): Float64Array {
    const step = (finest - 1) / (this.count - 1);
    return this.rowAt(i * step, j * step);
  }

  private rowAt(i: number, j: number): Float64Array {
    const at = (j * finest + i) * map.columns;
    return this.rows.subarray(at, at + map.columns);
  }

  stop(): void {
    this.stopped = true;
  }

  /** `shown` after each level; `pause` resolves when nothing more urgent is to be done. */
  async fill(shown: () => void, pause: () => Promise<void>): Promise<void> {
    for (let count = coarsest; count <= finest; count = 2 * count - 1) {
      const missing = this.missing((finest - 1) / (count - 1));
      for (let k = 0; k < missing.length; k += atOnce) {
        await pause();
        if (this.stopped) return;
        await this.calculate(missing.slice(k, k + atOnce));
      }
      if (this.stopped) return;
      this.count = count;
      shown();
    }
  }

  private missing(step: number): [number, number][] {
    const list: [number, number][] = [];
    for (let j = 0; j < finest; j += step)
      for (let i = 0; i < finest; i += step) if (!this.known[j * finest + i]) list.push([i, j]);
    return list;
  }

  private async calculate(points: [number, number][]): Promise<void> {
    const displacements = new Float64Array(6 * points.length);
    points.forEach(([i, j], k) => {
      displacements.set(this.fixed, 6 * k);
      displacements[6 * k + this.across] = this.at(this.across, i);
      displacements[6 * k + this.up] = this.at(this.up, j);
    });
    const found = await this.core.map(this.set, displacements);
    points.forEach(([i, j], k) => {
      this.rowAt(i, j).set(found.subarray(k * map.columns, (k + 1) * map.columns));
      this.known[j * finest + i] = 1;
    });
  }
}
