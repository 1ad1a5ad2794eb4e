// Lines of equal value over a grid, and round numbers for scales.

type Point = [number, number];

/** Round numbers within a range, four to eight of them; none where the range is empty. */
export function niceLevels(least: number, most: number): number[] {
  const span = most - least;
  if (!(span > 0) || !Number.isFinite(span)) return Number.isFinite(least) ? [least] : [];
  const raw = span / 5;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= raw * 0.75) ?? 10);
  const levels: number[] = [];
  for (let k = Math.ceil(least / step); k * step <= most; ++k) levels.push(Number((k * step).toPrecision(12)));
  return levels;
}

/** Segments of the line `level` over values[row][column], in units of cells; none next to a gap. */
export function contour(values: number[][], level: number): [Point, Point][] {
  const segments: [Point, Point][] = [];
  for (let j = 0; j + 1 < values.length; ++j)
    for (let i = 0; i + 1 < values[j]!.length; ++i) {
      const corners: [Point, number][] = [
        [[i, j], values[j]![i]!],
        [[i + 1, j], values[j]![i + 1]!],
        [[i + 1, j + 1], values[j + 1]![i + 1]!],
        [[i, j + 1], values[j + 1]![i]!],
      ];
      if (!corners.every(([, value]) => Number.isFinite(value))) continue;
      const crossings = corners.flatMap(([a, from], k) => {
        const [b, to] = corners[(k + 1) % 4]!;
        if (from < level === to < level) return [];
        const share = (level - from) / (to - from);
        return [[a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share] as Point];
      });
      for (let k = 0; k + 1 < crossings.length; k += 2) segments.push([crossings[k]!, crossings[k + 1]!]);
    }
  return segments;
}
