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
  const projection = new Projection(camera, sizes.target);
  const items: Item[] = [];
  const at = (p: Vector) => projection.flat(p);
  const line = (from: Vector, to: Vector, width: number, color: string, extra = {}) => {
    const [x1, y1] = at(from).map(coordinate);
    const [x2, y2] = at(to).map(coordinate);
    items.push({
      depth: projection.depth(scale(0.5, add(from, to))),
      element: svg('line', {
        x1,
        y1,
        x2,
        y2,
        stroke: color,
        'stroke-width': coordinate(width),
        ...extra,
      }),
    });
  };
  const dot_ = (p: Vector, r: number, color: string, lift = 0) => {
    const [cx, cy] = at(p).map(coordinate);
    items.push({
      depth: projection.depth(p) + lift,
      element: svg('circle', { cx, cy, r: coordinate(r), fill: color }),
    });
  };
  const plate = (corners: Vector[], color: string) => {
    const text = corners.map((p) => at(p).map(coordinate).join(',')).join(' ');
    const center = scale(1 / corners.length, corners.reduce(add));
    items.push({
      depth: projection.depth(center) - 0.5 * sizes.size,
      element: svg('polygon', {
        points: text,
        fill: color,
        'fill-opacity': 0.35,
        stroke: color,
        'stroke-width': coordinate(0.012 * sizes.size),
        'stroke-linejoin': 'round',
      }),
    });
  };

  const feet = points.legs.map((leg) => leg.base);
  const joints = points.legs.map((leg) => leg.joint);
  plate(
    outline(feet, [0, 0, 0]).map((i) => feet[i]),
    colours.base,
  );
  const order = outline(
    geometry.legs.map((leg) => leg.platform_joint_m),
    geometry.platform.origin_m,
  );
  plate(
    order.map((i) => joints[i]),
    colours.platform,
  );
  points.legs.forEach((leg, i) => {
    const R = sizes.caseRadius(i);
    if (geometry.legs[i]?.strut) {
      line(leg.base, leg.joint, 2 * sizes.rodRadius(i), colours.rod, { 'stroke-linecap': 'round' });
      dot_(leg.base, 1.1 * R, colours.faint);
      dot_(leg.joint, 0.95 * R, colours.faint);
      return;
    }
    const axis = unit(subtract(leg.sleeve, leg.base));
    line(leg.base, leg.sleeve, 2 * R, colours.case, { 'stroke-opacity': 0.55 });
    line(leg.piston, leg.joint, 2 * sizes.rodRadius(i), colours.rod, { 'stroke-linecap': 'round' });
    const half = scale(0.35 * R, axis);
    line(subtract(leg.sleeve, half), add(leg.sleeve, half), 2.6 * R, colours.sleeve);
    dot_(leg.piston, 0.8 * R, colours.piston, 0.01 * sizes.size);
    dot_(leg.base, 1.1 * R, colours.faint);
    dot_(leg.joint, 0.95 * R, colours.faint);
  });
  dot_(add(points.center, points.displacement), 0.02 * sizes.size, colours.sleeve, sizes.size);
  items.sort((a, b) => a.depth - b.depth);

  const element = svg(
    'svg',
    { viewBox: frame(rest, at, 0.2 * sizes.size), role: 'img', class: 'drawing' },
    svg('title', {}, options.title),
    ...ghost(rest, order, at, colours, sizes.size),
    ...items.map((item) => item.element),
  );
  if (options.labels)
    points.legs.forEach((leg, i) => {
      const [bx, by] = at(leg.base);
      const [ox, oy] = at([0, 0, 0]);
      const away = (0.085 * sizes.size) / (Math.hypot(bx - ox, by - oy) || 1);
      const [x, y] = [bx + away * (bx - ox), by + away * (by - oy)];
      element.append(
        svg(
          'text',
          {
            x: coordinate(x),
            y: coordinate(y),
            fill: colours.text,
            'font-size': coordinate(0.075 * sizes.size),
            'text-anchor': 'middle',
            'dominant-baseline': 'central',
          },
          String(i + 1),
        ),
      );
    });
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
