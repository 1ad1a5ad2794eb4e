// A simulated run: the platform moving along its path in 3D, and what happened over time.

import uPlot from 'uplot';
import type { Simulation, Vector } from '../document';
import { button, html, slider } from '../dom';
import { movedMachine } from '../mechanics/platform_motion';
import { fixed } from '../numbers';
import { axisStyle, palette } from '../palette';
import type { View } from '../scene/view';
import { sizesOf } from '../scene/view';
import { WebglView } from '../scene/webgl_view';
import { SvgView } from '../scene/svg_view';
import type { State } from '../state';
import type { Section } from './section';

export const simulation: Section = {
  id: 'simulation',
  title: 'In time',
  applies: (report) => (report.simulation?.trace.time_s.length ?? 0) > 1,
  render,
};

const legColours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#c79a00', '#56b4e9'];

interface Diagram {
  title: string;
  unit: string;
  factor: number;
  lines: { label: string; values: number[]; dashed?: boolean; colour?: string }[];
}

function diagrams({ trace }: Simulation): Diagram[] {
  const directions = ['x', 'y', 'z', 'rx', 'ry', 'rz'];
  const platform = directions.map((direction, i): Diagram => {
    const turns = i > 2;
    return {
      title: direction,
      unit: turns ? '°' : 'mm',
      factor: turns ? 180 / Math.PI : 1000,
      lines: [
        { label: 'commanded', values: trace.command[i], dashed: true },
        { label: 'platform', values: trace.motion[i] },
      ],
    };
  });
  const perLeg = (values: number[][]) =>
    values.map((list, i) => ({ label: `leg ${i + 1}`, values: list, colour: legColours[i] }));
  return [
    ...platform,
    { title: 'pistons', unit: 'mm', factor: 1000, lines: perLeg(trace.piston_m) },
    { title: 'drives', unit: '%', factor: 100, lines: perLeg(trace.drive) },
    { title: 'cap pressures', unit: 'bar', factor: 1e-5, lines: perLeg(trace.cap_pressure_Pa) },
    { title: 'rod pressures', unit: 'bar', factor: 1e-5, lines: perLeg(trace.rod_pressure_Pa) },
  ];
}

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
    view.orbit(0, 0, 0.75); // a wide picture shows less of the height
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

  /** The sample nearest to a time. */
  nearest(time: number): number {
    const step = this.times[1] - this.times[0];
    return Math.round((time - this.times[0]) / step);
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
      const next = this.nearest(this.times[this.index] + elapsed);
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

function makeView(onChange: () => void): View {
  try {
    return new WebglView(onChange);
  } catch {
    return new SvgView();
  }
}

/** The value of a tick, small ones included. */
const plain = (value: number): string => String(Number(value.toPrecision(3))).replace('-', '−');

function plotOf(diagram: Diagram, times: number[], width: number): uPlot {
  const colours = palette();
  const axis = { ...axisStyle(colours), labelSize: 18 };
  const data = [
    times,
    ...diagram.lines.map((line) => line.values.map((v) => v * diagram.factor)),
  ] as uPlot.AlignedData;
  const plot = new uPlot(
    {
      width,
      height: 210,
      title: diagram.title,
      legend: { show: false },
      cursor: { y: false, sync: { key: 'time' }, drag: { x: true, y: false } },
      scales: { x: { time: false } },
      axes: [
        { ...axis, label: 's', size: 36 },
        { ...axis, label: diagram.unit, size: 56, values: (_, splits) => splits.map(plain) },
      ],
      series: [
        {},
        ...diagram.lines.map((line) => ({
          label: line.label,
          stroke: line.colour ?? (line.dashed ? colours.rigid : colours.flexible),
          width: 1.5,
          points: { show: false },
          ...(line.dashed ? { dash: [6, 4] } : {}),
        })),
      ],
    },
    data,
    document.createElement('div'),
  );
  const canvas = plot.root.querySelector('canvas');
  canvas?.setAttribute('role', 'img');
  canvas?.setAttribute('aria-label', `${diagram.title} in ${diagram.unit} over time`);
  return plot;
}

/** All diagrams; a click shows that moment on the machine. */
function histories(run: Simulation, player: Run, state: State): HTMLElement {
  const grid = html('div', { class: 'histories' });
  let plots: uPlot[] = [];
  const width = () => {
    const room = grid.clientWidth || 900;
    const columns = Math.max(1, Math.floor(room / 330));
    return Math.floor(room / columns) - 8;
  };
  const make = () => {
    for (const plot of plots) plot.destroy();
    plots = diagrams(run).map((diagram) => plotOf(diagram, run.trace.time_s, width()));
    grid.replaceChildren(...plots.map((plot) => plot.root));
    for (const plot of plots)
      plot.over.addEventListener('click', () => {
        const { idx } = plot.cursor;
        if (idx === null || idx === undefined) return;
        player.setPlaying(false);
        player.show(idx);
      });
  };
  make();
  new ResizeObserver(() => {
    const now = width();
    for (const plot of plots)
      if (plot.width !== now) plot.setSize({ width: now, height: plot.height });
  }).observe(grid);
  state.listen((change) => change === 'theme' && make());
  return grid;
}

function legend(): HTMLElement {
  const item = (colour: string, text: string) => {
    const swatch = html('i', { class: 'swatch' });
    swatch.style.background = colour;
    return html('li', {}, swatch, text);
  };
  return html(
    'ul',
    { class: 'legend' },
    item(palette().rigid, 'commanded (dashed)'),
    item(palette().flexible, 'platform'),
    ...legColours.map((colour, i) => item(colour, `leg ${i + 1}`)),
  );
}

function render(state: State, host: HTMLElement): void {
  const run = state.report.simulation as Simulation;
  let player: Run | null = null;
  const view = makeView(() => player?.refresh());
  view.element.setAttribute('aria-label', 'The machine in the simulated run');
  player = new Run(view, run);
  player.exaggeration = visibleExaggeration(run);
  const now = player;

  const play = button('Play', () => now.setPlaying(!now.playing), { 'data-control': 'run' });
  now.onPlaying = (playing) => (play.textContent = playing ? 'Pause' : 'Play');
  const last = run.trace.time_s.length - 1;
  const seconds = (index: number) => `${fixed(run.trace.time_s[Math.round(index)] ?? 0, 3)} s`;
  const time = slider(
    'Time',
    { min: 0, max: last, step: 1, value: 0 },
    seconds,
    (index) => {
      if (now.playing) now.setPlaying(false);
      now.index = index;
      now.refresh();
    },
    'run-time',
  );
  const output = time.element.querySelector('output');
  now.onIndex = (index) => {
    time.input.value = String(index);
    time.input.setAttribute('aria-valuetext', seconds(index));
    if (output) output.textContent = seconds(index);
  };
  const exaggeration = slider(
    'Motion',
    { min: 1, max: 100, step: 1, value: now.exaggeration },
    (value) => (value === 1 ? 'to scale' : `× ${value}`),
    (value) => {
      now.exaggeration = value;
      now.refresh();
    },
    'run-exaggeration',
  );
  host.append(
    html('p', {}, `${run.commands.join('; ')}, from pose ${run.pose}. ${run.summary}`),
    html('div', { class: 'stage single' }, view.element),
    html(
      'div',
      { class: 'controls' },
      html('div', { class: 'row' }, play, time.element, exaggeration.element),
    ),
    histories(run, now, state),
    legend(),
    html(
      'p',
      { class: 'note' },
      'Motion is relative to the initial pose. Drag across a diagram to zoom, double-click for the whole range, ' +
        'click to show the machine at this time. Legs are drawn straight.',
    ),
  );
  new IntersectionObserver((entries) => {
    now.visible = entries.some((entry) => entry.isIntersecting);
  }).observe(view.element);
  state.listen((change) => {
    if (change !== 'theme') return;
    view.recolour();
    now.refresh();
  });
  window.hydrapod.simulation = {
    setTime: (at) => {
      now.setPlaying(false);
      now.exaggeration = 1;
      now.show(now.nearest(at));
      now.draw();
    },
    time: () => run.trace.time_s[now.index],
    frames: () => now.frames,
    jointPositions: (leg) => view.readPoints('flexible', leg - 1),
  };
  now.refresh();
}
