// A measured mode moving in 3D, beside the mode of the model that is its partner.

import type { Geometry } from '../document';
import { html } from '../dom';
import { anyView } from '../scene/any_view';
import { amplitudeSlider, cameraButtons, playButton, setVisible, viewportHead } from '../scene/controls';
import { Player, type MovingPose } from '../scene/player';
import { sizesOf, type Side, type View } from '../scene/view';
import type { LegPoints } from '../scene/motion';
import { turnedToReal, type PlatformMotion } from './platform_motion';
import type { Vector } from './types';

export interface ShownShape {
  /** "mode 3, 12.34 Hz" */
  name: string;
  caption: string;
  /** null: there is none to draw. */
  motion: PlatformMotion | null;
  /** Why there is none; else: the outputs are no directions of the platform. */
  problem?: string;
  model: { name: string; motion: Vector } | null;
}

const noDirections =
  'The outputs are not directions of the platform. The shape cannot be drawn in 3D; the table lists its motion.';

export class MovingShape {
  readonly element = html('div', { class: 'moving-shape' });
  private readonly heads = html('div', { class: 'viewport-heads' });
  private readonly stage = html('div', { class: 'stage' }, this.heads);
  private readonly caption = html('p', { class: 'caption', 'aria-live': 'polite' });
  private readonly controls = html('div', { class: 'controls' });
  private view: View | null = null;
  private player: Player | null = null;
  private shown: ShownShape | null = null;
  private readonly calm = matchMedia('(prefers-reduced-motion: reduce)').matches;

  constructor(private readonly geometry: Geometry) {
    this.element.append(this.stage, this.controls, this.caption);
    // the picture is made when it is about to be seen: that takes time, and the page opens with another one
    const seen = new IntersectionObserver(
      (entries) => {
        const visible = entries.some((entry) => entry.isIntersecting);
        if (visible) this.start();
        if (this.player) setVisible(this.player, visible);
      },
      { rootMargin: '200px' },
    );
    seen.observe(this.element);
  }

  /** Shows a shape; `moving`: starts it. */
  show(shown: ShownShape, moving: boolean): void {
    this.shown = shown;
    if (moving) this.start();
    this.draw();
    if (moving && !this.calm && shown.motion) this.player?.setPlaying(true);
  }

  recolour(): void {
    this.view?.recolour();
    this.player?.refresh();
  }

  motion(): ReturnType<Player['motion']> | null {
    return this.player?.motion() ?? null;
  }

  frames(): number {
    return this.player?.frames ?? 0;
  }

  setPhase(phase: number): void {
    this.start();
    this.player?.setPhase(phase);
  }

  /** Points of leg 1 … 6 as drawn; null: nothing is drawn on this side. */
  jointPositions(leg: number, side: 'measured' | 'model'): LegPoints | null {
    const paired = this.shown?.model ?? null;
    if (!this.view || !this.shown?.motion || (side === 'model' && !paired)) return null;
    const drawn: Side = side === 'measured' && paired ? 'flexible' : 'rigid';
    return this.view.readPoints(drawn, leg - 1);
  }

  private start(): void {
    if (this.view) return;
    const view = anyView(() => this.player?.refresh());
    this.view = view;
    const player = new Player(view);
    player.playing = false;
    this.player = player;
    this.stage.append(view.element);
    this.controls.append(
      html('div', { class: 'row' }, playButton(player, 'shape-play', 'primary'), cameraButtons(view, () => player.refresh())),
      html('div', { class: 'row sliders' }, amplitudeSlider(player, 'shape-amplitude').element),
    );
    this.draw();
  }

  private draw(): void {
    const { shown, view, player } = this;
    if (!shown) return;
    const { motion, model } = shown;
    this.stage.hidden = this.controls.hidden = motion === null;
    this.caption.textContent = motion ? `${shown.caption}${missing(motion)}` : `${shown.caption} ${shown.problem ?? noDirections}`;
    if (!motion || !view || !player) return;
    this.heads.replaceChildren(
      viewportHead('flexible', 'Measured', shown.name),
      ...(model ? [viewportHead('rigid', 'Model', model.name)] : []),
    );
    this.stage.classList.toggle('single', !model);
    view.element.setAttribute('aria-label', `The machine moving in the measured shape of ${shown.name}. ${shown.caption}`);
    const arm = sizesOf(this.geometry).radius;
    const measured = turnedToReal(motion, arm);
    const pose = model ? this.pair(turnedToReal(model.motion, arm)) : this.alone;
    player.show(pose, model ? { ...measured, rigid: { mode: 1, mac: 1 } } : measured);
  }

  private readonly alone: MovingPose = { model: 'rigid', geometry: this.geometry, coordinates: [], rigid_modes: [] };
  private readonly both: MovingPose = { model: 'full', geometry: this.geometry, coordinates: [], rigid_modes: [] };

  /** One object for all pairs: a new one would build the picture anew. */
  private pair(model: MovingPose['rigid_modes'][number]): MovingPose {
    this.both.rigid_modes = [model];
    return this.both;
  }
}

const missing = (motion: PlatformMotion): string =>
  motion.missing.length > 0 ? ` Not measured, drawn at rest: ${motion.missing.join(', ')}.` : '';
