// Lines over time with as many points as a picture can show, of runs of any length.
//
// A line keeps the lowest and highest value of stretches of 16, 256, … samples. Of a range of samples
// every pixel gets its lowest and highest value, in a time that hardly depends on the length: no peak is
// lost, and a hundred thousand samples are drawn as fast as a thousand.

const step = 16;

interface Level {
  low: Float64Array;
  high: Float64Array;
}

export class Line {
  /** The samples, then stretches of stretches. */
  private readonly levels: Level[];

  constructor(readonly values: Float64Array) {
    this.levels = [{ low: values, high: values }];
    for (let below = this.levels[0]; below.low.length > step; ) {
      const count = Math.ceil(below.low.length / step);
      const level = { low: new Float64Array(count), high: new Float64Array(count) };
      for (let k = 0; k < count; ++k) {
        level.low[k] = Infinity;
        level.high[k] = -Infinity;
        const end = Math.min(below.low.length, (k + 1) * step);
        for (let i = k * step; i < end; ++i) {
          if (below.low[i] < level.low[k]) level.low[k] = below.low[i];
          if (below.high[i] > level.high[k]) level.high[k] = below.high[i];
        }
      }
      this.levels.push(level);
      below = level;
    }
  }

  /** Lowest and highest of the samples `from` … `to` − 1. */
  extent(from: number, to: number): [number, number] {
    const result: [number, number] = [Infinity, -Infinity];
    this.take(0, from, to, result);
    return result;
  }

  private take(level: number, from: number, to: number, result: [number, number]): void {
    const first = Math.ceil(from / step);
    const last = Math.floor(to / step);
    if (level + 1 < this.levels.length && last > first) {
      this.scan(level, from, first * step, result);
      this.take(level + 1, first, last, result);
      this.scan(level, last * step, to, result);
    } else {
      this.scan(level, from, to, result);
    }
  }

  private scan(level: number, from: number, to: number, result: [number, number]): void {
    const { low, high } = this.levels[level];
    for (let i = from; i < to; ++i) {
      if (low[i] < result[0]) result[0] = low[i];
      if (high[i] > result[1]) result[1] = high[i];
    }
  }
}

/** Number of the first of ascending `times` that is not below `time`. */
function firstFrom(times: ArrayLike<number>, time: number): number {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The sample nearest to a time. */
export function nearest(times: ArrayLike<number>, time: number): number {
  const above = Math.min(times.length - 1, firstFrom(times, time));
  return above > 0 && time - times[above - 1] < times[above] - time ? above - 1 : above;
}

/**
 * Times and values to draw between two times on `pixels`: the samples themselves where they are few, else two
 * points a pixel with its lowest and highest value. One sample more on either side leads the lines out of it.
 */
export function drawnPoints(times: Float64Array, lines: Line[], from: number, to: number, pixels: number): { banded: boolean; data: Float64Array[] } {
  const begin = Math.max(0, firstFrom(times, from) - 1);
  const end = Math.min(times.length, firstFrom(times, to) + 2);
  const count = end - begin;
  if (count <= 2 * pixels)
    return { banded: false, data: [times, ...lines.map(({ values }) => values)].map((values) => values.subarray(begin, end)) };
  const data = Array.from({ length: lines.length + 1 }, () => new Float64Array(2 * pixels));
  for (let p = 0; p < pixels; ++p) {
    const a = begin + Math.floor((p * count) / pixels);
    const b = begin + Math.floor(((p + 1) * count) / pixels);
    data[0][2 * p] = times[a];
    data[0][2 * p + 1] = times[(a + b) >> 1];
    lines.forEach((line, k) => {
      const [low, high] = line.extent(a, b);
      // in the order that the line goes on in
      const rises = line.values[b - 1] >= line.values[a];
      data[k + 1][2 * p] = rises ? low : high;
      data[k + 1][2 * p + 1] = rises ? high : low;
    });
  }
  return { banded: true, data };
}
