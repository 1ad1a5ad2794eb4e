// A Bode diagram as an SVG picture, for download and for print: magnitude above, phase below.

import { svg } from '../dom';
import { magnitude, phase, type Complex } from '../complex';
import { tick } from '../numbers';
import type { Palette } from '../palette';
import { titleOf, unitOf, type Curves, type Mark } from './curves';
import { isCut, phaseCut, phaseText, phaseTicks, withinTurn } from './phase';
import { labelled, magnitudeTicks, tickText } from './ticks';

interface Frame {
  x(frequency: number): number;
  left: number;
  right: number;
}

const [width, height] = [860, 560];
const margin = { left: 78, right: 18, top: 44, bottom: 46 };
const lineHeight = 16;
const phaseHeight = 130;
const gap = 26;
const headroom = 22;

function path(
  frame: Frame,
  frequency: number[],
  y: (i: number) => number,
  breaks: (i: number) => boolean,
): string {
  return frequency
    .map((f, i) => `${i === 0 || breaks(i) ? 'M' : 'L'}${frame.x(f).toFixed(1)} ${y(i).toFixed(1)}`)
    .join('');
}

/** `lines` stand below the title. */
export function bodePicture(curves: Curves, lines: string[], colours: Palette): SVGSVGElement {
  const top = margin.top + lineHeight * (lines.length - 1);
  const { frequency } = curves;
  const [from, to] = [frequency[0], frequency[frequency.length - 1]];
  const span = Math.log(to / from);
  const [left, right] = [margin.left, width - margin.right];
  const frame: Frame = {
    left,
    right,
    x: (f) => left + ((right - left) * Math.log(f / from)) / span,
  };
  const picture = svg(
    'svg',
    {
      xmlns: 'http://www.w3.org/2000/svg',
      viewBox: `0 0 ${width} ${height}`,
      width,
      height,
      role: 'img',
      'font-family': 'system-ui, "Liberation Sans", Arial, sans-serif',
      'font-size': 12,
      fill: colours.text,
    },
    svg('title', {}, `Bode diagram, ${titleOf(curves.pair)}`),
    svg('rect', { width, height, fill: colours.background }),
    svg('text', { x: left, y: 18, 'font-size': 15, 'font-weight': 600 }, titleOf(curves.pair)),
    ...lines.map((text, k) => svg('text', { x: left, y: 34 + lineHeight * k, fill: colours.faint }, text)),
  );
  const bottom = height - margin.bottom;
  frequencyAxis(picture, frame, from, to, top, bottom, colours);
  magnitudePart(picture, curves, frame, top, bottom - phaseHeight - gap, colours);
  phasePart(picture, curves, frame, bottom - phaseHeight, bottom, colours);
  legend(picture, curves, colours);
  return picture;
}

function frequencyAxis(
  picture: SVGElement,
  frame: Frame,
  from: number,
  to: number,
  top: number,
  bottom: number,
  colours: Palette,
) {
  for (const f of labelled(from, to, frame.x, width)) {
    const x = frame.x(f);
    picture.append(
      svg('line', {
        x1: x,
        x2: x,
        y1: top,
        y2: bottom,
        stroke: colours.grid,
        'stroke-width': 0.7,
      }),
      svg(
        'text',
        { x, y: bottom + 16, 'text-anchor': 'middle', fill: colours.faint },
        tickText(f),
      ),
    );
  }
  const middle = (frame.left + frame.right) / 2;
  picture.append(
    svg('text', { x: middle, y: bottom + 34, 'text-anchor': 'middle' }, 'frequency in Hz'),
  );
}

function lines(colours: Palette): { stroke: string; dash: string | null; width: number }[] {
  return [
    { stroke: colours.flexible, dash: null, width: 2 },
    { stroke: colours.rigid, dash: '6 4', width: 1.4 },
  ];
}

/** In the order of drawing: the dashed line last, so that it shows where both agree. */
const both = (curves: Curves): (Complex[] | null)[] => [curves.flexible, curves.rigid];

function magnitudePart(
  picture: SVGElement,
  curves: Curves,
  frame: Frame,
  top: number,
  bottom: number,
  colours: Palette,
) {
  const values = both(curves)
    .flatMap((H) => (H ?? []).map(magnitude))
    .filter((value) => value > 0);
  const low = values.reduce((a, b) => Math.min(a, b), Infinity);
  const most = values.reduce((a, b) => Math.max(a, b), 0);
  // room for the number of a mode above its peak
  const high = most * Math.max(1.5, (most / low) ** (headroom / (bottom - top - headroom)));
  const y = (value: number) =>
    bottom - ((bottom - top) * Math.log(Math.max(value, low) / low)) / Math.log(high / low);
  box(picture, frame, top, bottom, colours);
  for (const value of magnitudeTicks(low, high))
    axisLine(picture, frame, y(value), tick(value), colours);
  picture.append(
    svg(
      'text',
      {
        x: 16,
        y: (top + bottom) / 2,
        transform: `rotate(-90 16 ${(top + bottom) / 2})`,
        'text-anchor': 'middle',
      },
      unitOf(curves.pair),
    ),
  );
  both(curves).forEach((H, k) => {
    if (H)
      curve(
        picture,
        path(
          frame,
          curves.frequency,
          (i) => y(magnitude(H[i])),
          () => false,
        ),
        k,
        colours,
      );
  });
  marksAt(picture, curves.rigidMarks, frame, y, colours.rigid, true);
  marksAt(picture, curves.marks, frame, y, colours.flexible, false);
}

function phasePart(
  picture: SVGElement,
  curves: Curves,
  frame: Frame,
  top: number,
  bottom: number,
  colours: Palette,
) {
  const cut = phaseCut(both(curves).flatMap((H) => (H ? [H] : [])));
  const all = both(curves).map((H) => (H ?? []).map((h) => withinTurn(phase(h), cut)));
  const [least, most] = [Math.min, Math.max].map((pick) => all.flat().reduce((a, b) => pick(a, b)));
  const [low, high] = [least! - 10, most! + 10];
  const y = (degrees: number) => bottom - ((bottom - top) * (degrees - low)) / (high - low);
  box(picture, frame, top, bottom, colours);
  for (const value of phaseTicks(low, high)) axisLine(picture, frame, y(value), phaseText(value), colours);
  both(curves).forEach((H, k) => {
    if (!H) return;
    const angles = all[k]!;
    const wraps = (i: number) => isCut(angles[i - 1]!, angles[i]!);
    curve(
      picture,
      path(frame, curves.frequency, (i) => y(angles[i]), wraps),
      k,
      colours,
    );
  });
}

function box(picture: SVGElement, frame: Frame, top: number, bottom: number, colours: Palette) {
  const { left, right } = frame;
  picture.append(
    svg('rect', {
      x: left,
      y: top,
      width: right - left,
      height: bottom - top,
      fill: 'none',
      stroke: colours.faint,
    }),
  );
}

function axisLine(picture: SVGElement, frame: Frame, y: number, text: string, colours: Palette) {
  picture.append(
    svg('line', {
      x1: frame.left,
      x2: frame.right,
      y1: y,
      y2: y,
      stroke: colours.grid,
      'stroke-width': 0.7,
    }),
    svg('text', { x: frame.left - 6, y: y + 4, 'text-anchor': 'end', fill: colours.faint }, text),
  );
}

function curve(picture: SVGElement, d: string, kind: number, colours: Palette) {
  const line = lines(colours)[kind];
  picture.append(
    svg('path', {
      d,
      fill: 'none',
      stroke: line.stroke,
      'stroke-width': line.width,
      'stroke-dasharray': line.dash,
      'stroke-linejoin': 'round',
    }),
  );
}

/** Marks nearer than `apart` share one label. */
export function clusters(
  marks: Mark[],
  x: (mark: Mark) => number,
  apart: number,
): { mark: Mark; text: string }[] {
  const groups: Mark[][] = [];
  for (const mark of [...marks].sort((a, b) => a.frequency - b.frequency)) {
    const last = groups[groups.length - 1];
    if (last && x(mark) - x(last[last.length - 1]) < apart) last.push(mark);
    else groups.push([mark]);
  }
  return groups.map((group) => ({
    mark: group.reduce((a, b) => (b.magnitude > a.magnitude ? b : a)),
    text: [...new Set(group.map((mark) => mark.mode))].join(', '),
  }));
}

function marksAt(
  picture: SVGElement,
  marks: Mark[],
  frame: Frame,
  y: (value: number) => number,
  color: string,
  hollow: boolean,
) {
  for (const mark of marks)
    picture.append(
      svg('circle', {
        cx: frame.x(mark.frequency),
        cy: y(mark.magnitude),
        r: 3.2,
        fill: hollow ? 'none' : color,
        stroke: color,
        'stroke-width': 1.3,
      }),
    );
  if (hollow) return;
  for (const { mark, text } of clusters(marks, (m) => frame.x(m.frequency), 16))
    picture.append(
      svg(
        'text',
        {
          x: frame.x(mark.frequency),
          y: y(mark.magnitude) - 7,
          fill: color,
          'text-anchor': 'middle',
          'font-weight': 600,
        },
        text,
      ),
    );
}

function legend(picture: SVGElement, curves: Curves, colours: Palette) {
  const names = ['flexible legs (numbers: modes)', 'rigid legs'];
  let x = width - margin.right - (curves.flexible ? 342 : 100);
  both(curves).forEach((H, k) => {
    if (!H) return;
    const line = lines(colours)[k];
    picture.append(
      svg('line', {
        x1: x,
        x2: x + 26,
        y1: 14,
        y2: 14,
        stroke: line.stroke,
        'stroke-width': line.width,
        'stroke-dasharray': line.dash,
      }),
      svg('text', { x: x + 32, y: 18 }, names[k]),
    );
    x += 248;
  });
}

/** The picture as a file's text. */
export function svgText(picture: SVGSVGElement): string {
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(picture)}\n`;
}

export async function pngOf(picture: SVGSVGElement, scale = 2): Promise<Blob> {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svgText(picture))}`;
  await image.decode();
  const canvas = document.createElement('canvas');
  canvas.width = scale * width;
  canvas.height = scale * height;
  const pen = canvas.getContext('2d');
  if (!pen) throw new Error('no canvas');
  pen.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((resolve, reject) =>
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('no picture'))), 'image/png'),
  );
}
