// A distribution of numbers: what describes it, and its histogram.

import { svg } from '../dom';
import { significant } from '../numbers';
import { niceLevels } from '../workspace/contour';

export interface Description {
  count: number;
  mean: number;
  deviation: number;
  /** At 5 %, 50 % and 95 %. */
  quantiles: [number, number, number];
}

export function describe(values: number[]): Description | null {
  const known = values.filter(Number.isFinite).sort((a, b) => a - b);
  const count = known.length;
  if (count === 0) return null;
  const mean = known.reduce((sum, value) => sum + value, 0) / count;
  const squares = known.reduce((sum, value) => sum + (value - mean) ** 2, 0);
  const at = (share: number) => {
    const place = share * (count - 1);
    const k = Math.floor(place);
    return known[k]! + ((known[Math.min(k + 1, count - 1)]! - known[k]!) * (place - k));
  };
  return { count, mean, deviation: Math.sqrt(squares / Math.max(1, count - 1)), quantiles: [at(0.05), at(0.5), at(0.95)] };
}

const height = 260;
const [narrowest, widest] = [280, 760];
const inside = { left: 46, right: 14, top: 12, bottom: 40 };
const bins = 32;

/** Bars of equal width; those that miss the requirement have another colour. */
export function histogram(values: number[], axis: string, bound: number | null, atLeast: boolean, room: number): SVGSVGElement {
  const width = Math.min(widest, Math.max(narrowest, room));
  const known = values.filter(Number.isFinite);
  const picture = svg('svg', { class: 'histogram', viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': `Histogram of ${axis}; the table beside it has its numbers` });
  if (known.length === 0) return picture;
  const [least, most] = [Math.min(...known), Math.max(...known)];
  const pad = most > least ? 0 : Math.max(1e-9, Math.abs(most) * 1e-3);
  const ends = bound === null ? [least, most] : [Math.min(least, bound), Math.max(most, bound)];
  const [from, to] = [ends[0]! - pad, ends[1]! + pad];
  const counts = new Array<number>(bins).fill(0);
  for (const value of known) ++counts[Math.min(bins - 1, Math.floor((bins * (value - from)) / (to - from)))]!;
  const tallest = Math.max(...counts);
  const bottom = height - inside.bottom;
  const x = (value: number) => inside.left + ((width - inside.left - inside.right) * (value - from)) / (to - from);
  const y = (count: number) => bottom - ((bottom - inside.top) * count) / tallest;
  const bars = counts.map((count, k) => {
    const [a, b] = [from + ((to - from) * k) / bins, from + ((to - from) * (k + 1)) / bins];
    const middle = (a + b) / 2;
    const missed = bound !== null && (atLeast ? middle < bound : middle > bound);
    return svg('rect', { class: missed ? 'count missed' : 'count', x: x(a) + 0.5, width: Math.max(0, x(b) - x(a) - 1), y: y(count), height: bottom - y(count) });
  });
  picture.append(
    ...niceLevels(0, tallest).map((count) => svg('g', {}, svg('line', { class: 'grid', x1: inside.left, x2: width - inside.right, y1: y(count), y2: y(count) }), svg('text', { x: inside.left - 6, y: y(count) + 4, 'text-anchor': 'end' }, String(count)))),
    ...bars,
    ...niceLevels(from, to).map((tick) => svg('text', { x: x(tick), y: bottom + 16, 'text-anchor': 'middle' }, significant(tick, 4))),
    ...(bound === null ? [] : [svg('line', { class: 'bound', x1: x(bound), x2: x(bound), y1: inside.top, y2: bottom })]),
    svg('text', { x: (inside.left + width - inside.right) / 2, y: height - 6, 'text-anchor': 'middle' }, axis),
  );
  return picture;
}
