// Static pictures of the chosen modes, for paper.

import { energyParts, inWords, motionParts } from '../bars';
import type { Mode, PoseReport } from '../document';
import { pictured } from '../document';
import { html } from '../dom';
import { largest, pointsAt, shapeOf, sizeOf } from '../scene/motion';
import { hertz, signedPercent } from '../numbers';
import { light } from '../palette';
import { drawing } from '../scene/drawing';
import { homeCamera } from '../scene/view';
import type { State } from '../state';
import type { Section } from './section';

export const pictures: Section = {
  id: 'pictures',
  title: 'Pictures of the modes',
  printed: true,
  applies: (report) => report.poses.some((pose) => pose.modes.length > 0),
  render,
};

const amplitude = 0.1;

export function picture(pose: PoseReport, mode: Mode): HTMLElement {
  const shape = shapeOf(pose, mode);
  const scale = (amplitude * sizeOf(pose.geometry)) / Math.max(largest(shape), Number.MIN_VALUE);
  const frequency = mode.stable ? `${hertz(mode.frequency_hz)} Hz` : 'unstable';
  const title = `Mode ${mode.number}, ${frequency}: ${mode.label}`;
  const rest = pointsAt(shape, 0, 0);
  const { element } = drawing(pose.geometry, pointsAt(shape, scale, 0), rest, homeCamera, light, {
    labels: true,
    title,
  });
  const shift =
    mode.stable && mode.rigid && mode.rigid.mac >= 0.1
      ? `, ${signedPercent(mode.rigid.shift_percent)} relative to rigid legs`
      : '';
  return html(
    'figure',
    {},
    element,
    html(
      'figcaption',
      {},
      html('strong', {}, `Mode ${mode.number}: ${frequency}${shift}`),
      html('br'),
      mode.label,
      html('br'),
      `motion: ${inWords(motionParts(mode))}; strain energy: ${inWords(energyParts(mode.strain_energy))}`,
    ),
  );
}

function render(state: State, host: HTMLElement): void {
  host.classList.add('print-only');
  const { report } = state;
  const parts = html('div', {});
  host.append(parts);
  /** What is drawn; of a machine with other numbers, the pose that is shown. */
  let drawn: PoseReport | null | undefined;
  const show = () => {
    const other = state.isWhatIf ? state.pose : null;
    if (drawn === other) return;
    drawn = other;
    const poses = other ? [other] : report.poses;
    const heading = (pose: PoseReport) => (other ? state.shownWords : poses.length > 1 ? `pose ${pose.pose.name}` : '');
    parts.replaceChildren(
      ...poses.flatMap((pose) => [
        ...(heading(pose) ? [html('h3', {}, heading(pose).replace(/^./, (letter) => letter.toUpperCase()))] : []),
        html('div', { class: 'figures' }, ...pictured(report, pose).map((mode) => picture(pose, mode))),
      ]),
    );
  };
  addEventListener('beforeprint', show);
  show();
}
