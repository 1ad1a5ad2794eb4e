// A simulated run: the platform moving along its path in 3D, and what happened over time.

import type { Simulation, Vector } from '../document';
import { controlRow, how, html, slider } from '../dom';
import { movedMachine } from '../scene/moved_machine';
import { fixed } from '../numbers';
import { palette } from '../palette';
import { Histories, legColours } from '../simulation/histories';
import { nearest } from '../simulation/lines';
import type { View } from '../scene/view';
import { sizesOf } from '../scene/view';
import { anyView } from '../scene/any_view';
import { playButton } from '../scene/controls';
import type { State } from '../state';
import type { Section } from './section';

export const simulation: Section = {
  id: 'simulation',
  title: 'In time',
  of: 'report',
  applies: (report) => (report.simulation?.trace.time_s.length ?? 0) > 1,
  render,
};

/** Plays the run on the machine. */
class Run {
  playing = false;
  index = 0;
  exaggeration = 1;
  visible = true;
  /** Frames drawn so far. */
  frames = 0;
  private last = 0;
  private scheduled = false;
  onIndex: (index: number) => void = () => {};
  onPlaying: (playing: boolean) => void = () => {};

  constructor(
    private readonly view: View,
    private readonly run: Simulation,
  ) {
    view.setMachine(run.geometry, ['flexible']);
    view.setPoints('flexible', movedMachine(run.geometry, [0, 0, 0], [0, 0, 0]));
    view.orbit(0, 0, 0.88); // room for the motion
  }

  get times(): number[] {
    return this.run.trace.time_s;
  }

  setPlaying(playing: boolean): void {
    this.playing = playing;
    this.last = 0;
    if (playing && this.index >= this.times.length - 1) this.index = 0;
    this.onPlaying(playing);
    this.refresh();
  }

  show(index: number): void {
    this.index = Math.max(0, Math.min(this.times.length - 1, Math.round(index)));
    this.onIndex(this.index);
    this.refresh();
  }

  refresh(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame((now) => {
      this.scheduled = false;
      this.advance(now);
      // out of sight the run goes on, without pictures
      if (this.visible || !this.playing) this.draw();
      if (this.playing) this.refresh();
    });
  }

  private advance(now: number): void {
    if (this.playing && this.last > 0) {
      const elapsed = Math.min(0.1, (now - this.last) / 1000);
      const next = nearest(this.times, this.times[this.index] + elapsed);
      this.index = Math.min(this.times.length - 1, Math.max(next, this.index + 1));
      this.onIndex(this.index);
      if (this.index === this.times.length - 1) this.setPlaying(false);
    }
    this.last = this.playing ? now : 0;
  }

  draw(): void {
    const at = (k: number) => this.exaggeration * this.run.trace.motion[k][this.index];
    const shift: Vector = [at(0), at(1), at(2)];
    const angles: Vector = [at(3), at(4), at(5)];
    this.view.setPoints('flexible', movedMachine(this.run.geometry, shift, angles));
    this.view.draw();
    ++this.frames;
  }
}

/** 1, 2, 5, 10, …: so that the largest motion is some per cent of the machine. */
function visibleExaggeration(run: Simulation): number {
  const { size, radius } = sizesOf(run.geometry);
  let largest = 0;
  run.trace.motion.forEach((values, i) => {
    for (const value of values) largest = Math.max(largest, Math.abs(value) * (i < 3 ? 1 : radius));
  });
  const steps = [1, 2, 5, 10, 20, 50, 100];
  return steps.find((step) => step * largest > 0.04 * size) ?? 100;
}

function legend(): HTMLElement {
  const item = (colour: string, text: string, dashed = false) => {
    const line = html('i', { class: 'line' });
    line.style.borderColor = colour;
    if (dashed) line.style.borderTopStyle = 'dashed';
    return html('li', {}, line, text);
  };
  return html(
    'ul',
    { class: 'legend' },
    item(palette().rigid, 'commanded', true),
    item(palette().flexible, 'platform'),
    ...legColours.map((colour, i) => item(colour, `leg ${i + 1}`)),
  );
}

/** Time and magnification beside the play button; the time goes along with the run. */
function controls(player: Run, times: number[], histories: Histories): HTMLElement {
  const seconds = (index: number) => `${fixed(times[Math.round(index)] ?? 0, 3)} s`;
  const time = slider(
    'Time',
    { min: 0, max: times.length - 1, step: 1, value: 0 },
    seconds,
    (index) => {
      if (player.playing) player.setPlaying(false);
      player.show(index);
    },
    'run-time',
  );
  const output = time.element.querySelector('output');
  player.onIndex = (index) => {
    histories.mark(index);
    time.input.value = String(index);
    time.input.setAttribute('aria-valuetext', seconds(index));
    if (output) output.textContent = seconds(index);
  };
  const exaggeration = slider(
    'Motion',
    { min: 1, max: 100, step: 1, value: player.exaggeration },
    (value) => (value === 1 ? 'to scale' : `× ${value}`),
    (value) => {
      player.exaggeration = value;
      player.refresh();
    },
    'run-exaggeration',
  );
  return controlRow(playButton(player, 'run'), time.element, exaggeration.element);
}

function offerHook(player: Run, view: View, times: number[], histories: Histories): void {
  window.hydrapod.simulation = {
    setTime: (at) => {
      player.setPlaying(false);
      player.exaggeration = 1;
      player.show(nearest(times, at));
      player.draw();
    },
    time: () => times[player.index],
    frames: () => player.frames,
    view: () => histories.view,
    showPart: (from, to) => histories.show(from, to),
    data: (diagram) => histories.data(diagram),
    span: (diagram) => histories.span(diagram),
    jointPositions: (leg) => view.readPoints('flexible', leg - 1),
  };
}

function render(state: State, host: HTMLElement): void {
  const run = state.report.simulation as Simulation;
  let drawn: Run | null = null;
  const view = anyView(() => drawn?.refresh());
  view.element.setAttribute('aria-label', 'The machine in the simulated run');
  const player = new Run(view, run);
  drawn = player;
  player.exaggeration = visibleExaggeration(run);
  const histories = new Histories(run);
  histories.onTime = (index) => {
    player.setPlaying(false);
    player.show(index);
  };
  const keys = legend();
  host.append(
    html('p', {}, `${run.commands.join('; ')}, from pose ${run.pose}. ${run.summary}`),
    html(
      'div',
      { class: 'run' },
      html(
        'div',
        { class: 'run-machine' },
        html('div', { class: 'stage single' }, view.element),
        controls(player, run.trace.time_s, histories),
        keys,
        html(
          'p',
          { class: 'note' },
          'Motion is relative to the initial pose. ',
          how(
            'Drag across a diagram to zoom all of them, double-click for the whole run, click to show the machine at this time. ' +
              'The vertical line is the time at which the machine is shown. Legs are drawn straight.',
          ),
        ),
      ),
      histories.element,
    ),
  );
  new IntersectionObserver((entries) => {
    player.visible = entries.some((entry) => entry.isIntersecting);
  }).observe(view.element);
  state.listen((change) => {
    if (change !== 'theme') return;
    view.recolour();
    player.refresh();
    histories.make();
    keys.replaceChildren(...legend().children);
  });
  offerHook(player, view, run.trace.time_s, histories);
  player.refresh();
}
