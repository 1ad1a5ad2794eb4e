// The mechanism in 3D, moving in the chosen mode, and its rigid counterpart.

import type { Mode, PoseReport } from '../document';
import { repeated } from '../document';
import { button, checkbox, html, slider } from '../dom';
import { fixed, hertz, signedPercent } from '../numbers';
import { comparable, Player } from '../scene/player';
import { anyView } from '../scene/any_view';
import { amplitudeSlider, cameraButtons, playButton, setVisible, viewportHead } from '../scene/controls';
import type { View } from '../scene/view';
import type { State } from '../state';
import type { Section } from './section';

export const mechanism: Section = {
  id: 'mechanism',
  title: 'Mechanism',
  applies: (report) => report.poses.length > 0,
  render,
};

function render(state: State, host: HTMLElement): void {
  let player: Player | null = null;
  const view = anyView(() => player?.refresh());
  player = new Player(view);
  const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
  player.playing = !calm;

  const heads = html('div', { class: 'viewport-heads' });
  const caption = html('p', { class: 'caption', 'aria-live': 'polite' });
  const stage = html('div', { class: 'stage' }, heads, view.element);
  const parts = html('div', { class: 'in-sight' }, stage, controls(player, view, state), caption);
  if (view.kind === 'svg')
    parts.append(html('p', { class: 'note', role: 'note' }, 'This browser has no WebGL. The drawing is flat.'));
  parts.append(legendOfParts(state.pose));
  host.append(parts);

  const show = () => {
    const { pose, mode } = state;
    stage.classList.toggle('single', pose.model === 'rigid');
    heads.replaceChildren(...viewportHeads(pose, mode));
    caption.textContent = captionOf(pose, mode);
    view.element.setAttribute(
      'aria-label',
      `The machine moving in mode ${mode.number}. ${captionOf(pose, mode)}`,
    );
    player.show(pose, mode);
  };
  state.listen((change) => {
    if (change === 'theme') {
      view.recolour();
      player.refresh();
    } else {
      show();
    }
  });
  watchVisibility(view, player);
  show();
  offerHook(view, player);
}

function watchVisibility(view: View, player: Player): void {
  new IntersectionObserver((entries) => {
    setVisible(player, entries.some((entry) => entry.isIntersecting));
  }).observe(view.element);
}

function offerHook(view: View, player: Player): void {
  window.hydrapod.scene = {
    kind: view.kind,
    jointPositions: (leg, side = 'flexible') => view.readPoints(side, leg - 1),
    motion: () => player.motion(),
    setPhase: (phase) => player.setPhase(phase),
    frames: () => player.frames,
  };
}

const numberAndFrequency = (mode: Mode): string =>
  `mode ${mode.number}, ${mode.stable ? `${hertz(mode.frequency_hz)} Hz` : 'unstable'}`;

function viewportHeads(pose: PoseReport, mode: Mode): HTMLElement[] {
  if (pose.model === 'rigid') return [viewportHead('rigid', 'Rigid legs', numberAndFrequency(mode))];
  const flexible = viewportHead('flexible', 'Flexible legs', numberAndFrequency(mode));
  const counterpart = mode.rigid && pose.rigid_modes[mode.rigid.mode - 1];
  const rigid =
    counterpart && mode.rigid && mode.rigid.mac >= comparable
      ? viewportHead('rigid', 'Rigid legs', numberAndFrequency(counterpart))
      : viewportHead('rigid', 'Rigid legs', 'at rest: no similar mode');
  return [flexible, rigid];
}

function captionOf(pose: PoseReport, mode: Mode): string {
  const parts = [`${mode.label}.`];
  const group = repeated(pose.modes, mode).filter((other) => other !== mode);
  if (group.length > 0) {
    const others = group.map((other) => other.number).join(', ');
    parts.push(
      `Repeats with mode${group.length > 1 ? 's' : ''} ${others}: equal frequency. Any combination of them is a mode. ` +
        'The combinations along the axes are shown.',
    );
  }
  if (mode.shape_imaginary)
    parts.push('Complex mode: its components are out of phase.');
  if (!mode.stable) parts.push('Unstable: the legs buckle.');
  if (mode.rigid && mode.stable)
    parts.push(
      mode.rigid.mac >= comparable
        ? `${signedPercent(mode.rigid.shift_percent)} relative to rigid legs (MAC ${fixed(mode.rigid.mac, 2)}).`
        : `No similar mode with rigid legs (MAC at most ${fixed(mode.rigid.mac, 2)}).`,
    );
  else if (pose.model !== 'rigid' && !mode.rigid) parts.push('A machine with rigid legs does not have this mode.');
  return parts.join(' ');
}

function modeStepper(state: State): HTMLElement {
  const name = html('output', { 'aria-live': 'off' });
  const step = (by: number) => {
    const { modes } = state.pose;
    const at = modes.indexOf(state.mode);
    state.chooseMode(modes[(at + by + modes.length) % modes.length].number);
  };
  const show = () => (name.textContent = `mode ${state.mode.number} of ${state.pose.modes.length}`);
  state.listen(show);
  show();
  return html(
    'div',
    { class: 'group', role: 'group', 'aria-label': 'Mode' },
    button('‹', () => step(-1), { 'aria-label': 'Previous mode' }),
    name,
    button('›', () => step(1), { 'aria-label': 'Next mode' }),
  );
}

function controls(player: Player, view: View, state: State): HTMLElement {
  const play = playButton(player, 'play', 'primary');
  const camera = cameraButtons(view, () => player.refresh());
  const sliders = motionSliders(player);
  const reset = button(
    'Reset',
    () => {
      view.resetCamera();
      for (const { input } of sliders) {
        input.value = input.defaultValue;
        input.dispatchEvent(new Event('input'));
      }
      player.phase = 0;
      player.setPlaying(true);
    },
    { 'data-control': 'reset' },
  );
  return html(
    'div',
    { class: 'controls' },
    html('div', { class: 'row' }, play, reset, modeStepper(state), camera, labelsBox(view, player)),
    html('div', { class: 'row sliders' }, ...sliders.map((s) => s.element)),
  );
}

function labelsBox(view: View, player: Player): HTMLElement {
  const change = (shown: boolean) => {
    view.setLabels(shown);
    player.refresh();
  };
  return checkbox('Leg numbers', true, change, 'labels');
}

function motionSliders(player: Player) {
  const made = [
    amplitudeSlider(player, 'amplitude'),
    slider(
      'Speed',
      { min: 0.1, max: 2, step: 0.1, value: player.speed },
      (value) => `${fixed(value, 1)} periods/s`,
      (value) => (player.speed = value),
      'speed',
    ),
    slider(
      'Rod tilt',
      { min: 1, max: 10, step: 0.5, value: player.tilt },
      (value) => (value === 1 ? 'to scale' : `× ${fixed(value, 1)}`),
      (value) => {
        player.tilt = value;
        player.reshape();
      },
      'tilt',
    ),
  ];
  for (const { input } of made) input.defaultValue = input.value;
  return made;
}

function legendOfParts(pose: PoseReport): HTMLElement {
  const drawn = pose.geometry.legs.every((leg) => leg.bore_m !== undefined)
    ? 'All lengths and diameters to scale.'
    : 'All lengths to scale. The machine file states no diameters; usual diameters are drawn.';
  const item = (kind: string, text: string) =>
    html('li', {}, html('i', { class: `swatch swatch-${kind}` }), text);
  const legs = pose.geometry.legs.every((leg) => leg.strut)
    ? [item('rod', 'struts'), item('sleeve', 'mass centre')]
    : [
        item('case', 'case'),
        item('rod', 'rod'),
        item('sleeve', 'guide sleeve, mass centre'),
        item('piston', 'piston'),
      ];
  return html(
    'div',
    { class: 'legend-line' },
    html(
      'ul',
      { class: 'legend' },
      ...legs,
      item('gimbal', 'gimbals'),
      item('ghost', 'at rest'),
    ),
    html(
      'p',
      { class: 'note' },
      `${drawn} The motion is magnified by the amplitude. After a click into the picture, the wheel zooms.`,
    ),
  );
}
