// The machine as an SVG drawing: for print, and where there is no WebGL. Orthographic, nearest
// things last.

import type { Geometry, Vector } from '../document';
import { svg } from '../dom';
import type { MachinePoints } from './motion';
import { add, cross, dot, scale, subtract, unit } from './vector';
import type { Palette } from '../palette';
import { outline, sizesOf, type Camera } from './view';

interface Item {
  depth: number;
  element: SVGElement;
}

export interface Drawing {
  element: SVGSVGElement;
  /** Base-frame points to picture coordinates. */
  project(point: Vector): [number, number];
}

class Projection {
  private readonly right: Vector;
  private readonly top: Vector;
  private readonly forward: Vector;

  constructor(
    camera: Camera,
    private readonly target: Vector,
  ) {
    const { azimuth: a, elevation: e } = camera;
    this.forward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    this.right = [-Math.sin(a), Math.cos(a), 0];
    this.top = cross(this.forward, this.right);
  }

  /** x to the right, y downwards. */
  flat(p: Vector): [number, number] {
    const d = subtract(p, this.target);
    return [dot(d, this.right), -dot(d, this.top)];
  }

  depth(p: Vector): number {
    return dot(subtract(p, this.target), this.forward);
  }
}

const coordinate = (value: number): string => value.toFixed(4);

/** Lines, dots and plates with their depths. */
class Parts {
  readonly items: Item[] = [];
  readonly at = (p: Vector) => this.projection.flat(p);

  constructor(
    private readonly projection: Projection,
    private readonly size: number,
  ) {}

  line(from: Vector, to: Vector, width: number, color: string, extra = {}): void {
    const [x1, y1] = this.at(from).map(coordinate);
    const [x2, y2] = this.at(to).map(coordinate);
    this.items.push({
      depth: this.projection.depth(scale(0.5, add(from, to))),
      element: svg('line', { x1, y1, x2, y2, stroke: color, 'stroke-width': coordinate(width), ...extra }),
    });
  }

  dot(p: Vector, r: number, color: string, lift = 0): void {
    const [cx, cy] = this.at(p).map(coordinate);
    this.items.push({
      depth: this.projection.depth(p) + lift,
      element: svg('circle', { cx, cy, r: coordinate(r), fill: color }),
    });
  }

  plate(corners: Vector[], color: string): void {
    const center = scale(1 / corners.length, corners.reduce(add));
    this.items.push({
      depth: this.projection.depth(center) - 0.5 * this.size,
      element: svg('polygon', {
        points: corners.map((p) => this.at(p).map(coordinate).join(',')).join(' '),
        fill: color,
        'fill-opacity': 0.35,
        stroke: color,
        'stroke-width': coordinate(0.012 * this.size),
        'stroke-linejoin': 'round',
      }),
    });
  }
}

function addLeg(parts: Parts, points: MachinePoints, i: number, isStrut: boolean, sizes: ReturnType<typeof sizesOf>, colours: Palette): void {
  const leg = points.legs[i];
  const R = sizes.caseRadius(i);
  if (isStrut) {
    parts.line(leg.base, leg.joint, 2 * sizes.rodRadius(i), colours.rod, { 'stroke-linecap': 'round' });
  } else {
    const half = scale(0.35 * R, unit(subtract(leg.sleeve, leg.base)));
    parts.line(leg.base, leg.sleeve, 2 * R, colours.case, { 'stroke-opacity': 0.55 });
    parts.line(leg.piston, leg.joint, 2 * sizes.rodRadius(i), colours.rod, { 'stroke-linecap': 'round' });
    parts.line(subtract(leg.sleeve, half), add(leg.sleeve, half), 2.6 * R, colours.sleeve);
    parts.dot(leg.piston, 0.8 * R, colours.piston, 0.01 * sizes.size);
  }
  parts.dot(leg.base, 1.1 * R, colours.faint);
  parts.dot(leg.joint, 0.95 * R, colours.faint);
}

/** The number of a leg beyond its base joint. */
function legNumber(base: Vector, i: number, at: Parts['at'], size: number, fill: string): SVGElement {
  const [bx, by] = at(base);
  const [ox, oy] = at([0, 0, 0]);
  const away = (0.085 * size) / (Math.hypot(bx - ox, by - oy) || 1);
  const [x, y] = [bx + away * (bx - ox), by + away * (by - oy)].map(coordinate);
  const middle = { 'text-anchor': 'middle', 'dominant-baseline': 'central' };
  return svg('text', { x, y, fill, 'font-size': coordinate(0.075 * size), ...middle }, String(i + 1));
}

/** A picture of `points`, with thin lines where the machine is at rest. */
export function drawing(
  geometry: Geometry,
  points: MachinePoints,
  rest: MachinePoints,
  camera: Camera,
  colours: Palette,
  options: { labels: boolean; title: string },
): Drawing {
  const sizes = sizesOf(geometry);
  const parts = new Parts(new Projection(camera, sizes.target), sizes.size);
  const { at, items } = parts;
  const feet = points.legs.map((leg) => leg.base);
  const joints = points.legs.map((leg) => leg.joint);
  const order = outline(geometry.legs.map((leg) => leg.platform_joint_m), geometry.platform.origin_m);
  parts.plate(outline(feet, [0, 0, 0]).map((i) => feet[i]), colours.base);
  parts.plate(order.map((i) => joints[i]), colours.platform);
  points.legs.forEach((_, i) => addLeg(parts, points, i, geometry.legs[i]?.strut === true, sizes, colours));
  parts.dot(add(points.center, points.displacement), 0.02 * sizes.size, colours.sleeve, sizes.size);
  items.sort((a, b) => a.depth - b.depth);
  const element = svg(
    'svg',
    { viewBox: frame(rest, at, 0.2 * sizes.size), role: 'img', class: 'drawing' },
    svg('title', {}, options.title),
    ...ghost(rest, order, at, colours, sizes.size),
    ...items.map((item) => item.element),
  );
  if (options.labels) element.append(...feet.map((base, i) => legNumber(base, i, at, sizes.size, colours.text)));
  return { element, project: at };
}

/** The picture's frame: what the machine takes up at rest and room to move. */
function frame(rest: MachinePoints, at: (p: Vector) => [number, number], room: number): string {
  const flat = rest.legs.flatMap((leg) => [at(leg.base), at(leg.joint)]);
  const xs = flat.map(([x]) => x);
  const ys = flat.map(([, y]) => y);
  const [left, top] = [Math.min(...xs) - room, Math.min(...ys) - room];
  return [left, top, Math.max(...xs) + room - left, Math.max(...ys) + room - top]
    .map(coordinate)
    .join(' ');
}

function ghost(
  rest: MachinePoints,
  order: number[],
  at: (p: Vector) => [number, number],
  colours: Palette,
  size: number,
): SVGElement[] {
  const pairs: [Vector, Vector][] = rest.legs.map((leg) => [leg.base, leg.joint]);
  order.forEach((i, k) => pairs.push([rest.legs[i].joint, rest.legs[order[(k + 1) % 6]].joint]));
  return pairs.map(([from, to]) => {
    const [x1, y1] = at(from).map(coordinate);
    const [x2, y2] = at(to).map(coordinate);
    return svg('line', {
      x1,
      y1,
      x2,
      y2,
      stroke: colours.ghost,
      'stroke-width': coordinate(0.006 * size),
      'stroke-dasharray': coordinate(0.02 * size),
    });
  });
}
