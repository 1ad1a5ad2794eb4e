// Stacked bars: shares of an energy, with their names where there is room and in words for screen
// readers.

import type { Mode } from './document';
import { directions } from './document';
import { html, svg, unseen } from './dom';
import { share } from './numbers';

export interface Part {
  name: string;
  long: string;
  value: number;
  kind: string;
}

export const energyParts = (strain: {
  oil: number;
  axial?: string;
  guide_sleeve: number;
  piston_ring: number;
  base_mount?: number;
  payload?: number;
  bending?: number;
}): Part[] => [
  { name: strain.axial ?? 'oil', long: strain.axial ?? 'oil', value: strain.oil, kind: 'oil' },
  { name: 'sleeves', long: 'guide sleeves', value: strain.guide_sleeve, kind: 'sleeve' },
  { name: 'rings', long: 'piston rings', value: strain.piston_ring, kind: 'ring' },
  ...(strain.base_mount
    ? [{ name: 'base', long: 'base', value: strain.base_mount, kind: 'legs' }]
    : []),
  ...(strain.payload
    ? [{ name: 'payload', long: 'payload', value: strain.payload, kind: 'legs' }]
    : []),
  ...(strain.bending
    ? [{ name: 'bending', long: 'bending of rods and cases', value: strain.bending, kind: 'legs' }]
    : []),
];

export const motionParts = (mode: Mode): Part[] => [
  ...directions.map((name, d) => ({
    name,
    long: name,
    value: mode.platform_energy[d],
    kind: name,
  })),
  { name: 'legs', long: 'legs', value: mode.leg_energy.reduce((a, b) => a + b, 0), kind: 'legs' },
  ...(mode.base_energy
    ? [
        {
          name: 'base',
          long: 'base',
          value: mode.base_energy.reduce((a, b) => a + b, 0),
          kind: 'legs',
        },
      ]
    : []),
  ...(mode.payload_energy
    ? [{ name: 'payload', long: 'payload', value: mode.payload_energy, kind: 'legs' }]
    : []),
];

/** "x 97 %, legs 2 %" */
export function inWords(parts: Part[]): string {
  const named = parts.filter((part) => part.value >= 0.005);
  return named.map((part) => `${part.long} ${share(part.value)}`).join(', ') || 'none';
}

/** `pixels`: the least width that the bar will have, which decides what names fit into it. */
export function stackedBar(parts: Part[], pixels = 96): HTMLElement {
  const width = 100;
  const picture = svg('svg', {
    viewBox: `0 0 ${width} 10`,
    preserveAspectRatio: 'none',
    'aria-hidden': 'true',
  });
  const bar = html('span', { class: 'bar', title: inWords(parts) }, picture);
  let x = 0;
  for (const part of parts) {
    const w = width * Math.max(0, part.value);
    if (w < 0.2) continue;
    picture.append(
      svg('rect', {
        x: x.toFixed(2),
        y: 0,
        width: w.toFixed(2),
        height: 10,
        class: `part-${part.kind}`,
      }),
    );
    if ((w / 100) * pixels > 7 * part.name.length + 6) {
      const label = html(
        'span',
        { class: `bar-label on-${part.kind}`, 'aria-hidden': 'true' },
        part.name,
      );
      label.style.left = `${x + w / 2}%`;
      bar.append(label);
    }
    x += w;
  }
  bar.append(unseen(inWords(parts)));
  return bar;
}

export function legend(parts: Part[]): HTMLElement {
  return html(
    'ul',
    { class: 'legend', 'aria-hidden': 'true' },
    ...parts.map((part) =>
      html('li', {}, html('i', { class: `swatch swatch-${part.kind}` }), part.name),
    ),
  );
}
