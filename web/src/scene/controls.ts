// What a picture of machines has beside it: controls of view and motion, and titles.

import { button, html, slider, type Slider } from '../dom';
import { fixed } from '../numbers';
import type { Player } from './player';
import type { View } from './view';

/** Buttons that turn and zoom the picture; `changed` draws it anew. */
export function cameraButtons(view: View, changed: () => void): HTMLElement {
  const turn = (azimuth: number, elevation: number, zoom: number) => () => {
    view.orbit(azimuth, elevation, zoom);
    changed();
  };
  const angle = Math.PI / 12;
  return html(
    'div',
    { class: 'group', role: 'group', 'aria-label': 'View' },
    button('←', turn(-angle, 0, 1), { 'aria-label': 'Turn left' }),
    button('→', turn(angle, 0, 1), { 'aria-label': 'Turn right' }),
    button('↑', turn(0, angle, 1), { 'aria-label': 'View from higher up' }),
    button('↓', turn(0, -angle, 1), { 'aria-label': 'View from lower down' }),
    button('+', turn(0, 0, 1.2), { 'aria-label': 'Zoom in' }),
    button('−', turn(0, 0, 1 / 1.2), { 'aria-label': 'Zoom out' }),
  );
}

interface Playable {
  readonly playing: boolean;
  setPlaying(playing: boolean): void;
  onPlaying: (playing: boolean) => void;
}

export function playButton(player: Playable, name: string, kind?: 'primary'): HTMLButtonElement {
  const play = button('Play', () => player.setPlaying(!player.playing), { class: kind, 'data-control': name });
  player.onPlaying = (playing) => (play.textContent = playing ? 'Pause' : 'Play');
  player.onPlaying(player.playing);
  return play;
}

export function amplitudeSlider(player: Player, name: string): Slider {
  return slider(
    'Amplitude',
    { min: 0, max: 30, step: 0.5, value: 100 * player.relativeAmplitude },
    (value) => `${fixed(value, 1)} % of size`,
    (value) => {
      player.relativeAmplitude = value / 100;
      player.reshape();
    },
    name,
  );
}

/** The title over one machine of the picture, in the colour of its side. */
export const viewportHead = (kind: 'flexible' | 'rigid', title: string, text: string): HTMLElement =>
  html('div', { class: `viewport-head ${kind}` }, html('strong', {}, title), ' ', html('span', {}, text));

/** Draws again when the picture comes into sight; what stands still was drawn when it changed. */
export function setVisible(player: Player, visible: boolean): void {
  player.visible = visible;
  if (visible && player.playing) player.refresh();
}
