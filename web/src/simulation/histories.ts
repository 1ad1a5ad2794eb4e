// The quantities of a simulated run over time: diagrams that zoom together, with a line at the moment that
// the machine is shown at.

import uPlot from 'uplot';
import { fitWidth } from '../bode/stack';
import { directions, type Simulation } from '../document';
import { button, controlRow, describeCanvas, html, onPrint, paper } from '../dom';
import { fixed, significant } from '../numbers';
import { axisStyle, palette } from '../palette';
import { drawnPoints, Line, nearest } from './lines';

export const legColours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#c79a00', '#56b4e9'];

interface Diagram {
  title: string;
  unit: string;
  lines: { label: string; line: Line; dashed?: boolean; colour?: string }[];
  /** Room above and below the lines at least: small motions stay small beside the others. */
  room?: number;
}

/** A hundredth of the largest motion of the platform; a metre counts as a radian. */
const leastRoom = ({ trace }: Simulation): number =>
  0.01 * [...trace.command, ...trace.motion].reduce((most, values) => values.reduce((a, b) => Math.max(a, Math.abs(b)), most), 1e-7);

function diagrams(run: Simulation): Diagram[] {
  const { trace } = run;
  const room = leastRoom(run);
  const scaled = (values: number[], factor: number) => new Line(Float64Array.from(values, (v) => v * factor));
  const platform = directions.map((direction, i): Diagram => {
    const turns = i > 2;
    const factor = turns ? 180 / Math.PI : 1000;
    return {
      title: direction,
      unit: turns ? '°' : 'mm',
      room: factor * room,
      lines: [
        { label: 'commanded', line: scaled(trace.command[i], factor), dashed: true },
        { label: 'platform', line: scaled(trace.motion[i], factor) },
      ],
    };
  });
  const perLeg = (title: string, unit: string, factor: number, values: number[][]): Diagram => ({
    title,
    unit,
    lines: values.map((list, i) => ({ label: `leg ${i + 1}`, line: scaled(list, factor), ...(legColours[i] ? { colour: legColours[i] } : {}) })),
  });
  const actuators =
    trace.torque_N_m && trace.motor_speed_rad_s
      ? [perLeg('motor torques', 'N m', 1, trace.torque_N_m), perLeg('motor speeds', 'rad/s', 1, trace.motor_speed_rad_s)]
      : [perLeg('cap pressures', 'bar', 1e-5, trace.cap_pressure_Pa), perLeg('rod pressures', 'bar', 1e-5, trace.rod_pressure_Pa)];
  return [
    ...platform,
    perLeg('pistons', 'mm', 1000, trace.piston_m),
    perLeg('drives', '%', 100, trace.drive),
    ...actuators,
  ];
}

function withRoom(low: number, high: number, least: number): [number, number] {
  const room = Math.max(0.08 * (high - low), least);
  return [low - room, high + room];
}

/** Width of what is between the axes [px], without a layout of the page. */
const inner = (plot: uPlot): number => plot.bbox.width / devicePixelRatio || plot.width - 70;

const lineWidth = 1.5;
const straight = uPlot.paths.linear!();

interface Drawn {
  plot: uPlot;
  diagram: Diagram;
  head: HTMLElement;
}

export class Histories {
  readonly element = html('div', {});
  private readonly grid = html('div', { class: 'histories' });
  private readonly range = html('span', { class: 'note' });
  private readonly times: Float64Array;
  private readonly diagrams: Diagram[];
  private drawn: Drawn[] = [];
  /** What is shown [s]. */
  private from: number;
  private to: number;
  private now = 0;
  private printed = false;
  /** The points in the diagrams are pairs of lowest and highest values. */
  private banded = false;
  /** Where the last drag began. */
  private dragged: uPlot | null = null;
  /** A moment was clicked. */
  onTime: (index: number) => void = () => {};

  constructor(run: Simulation) {
    this.times = Float64Array.from(run.trace.time_s);
    this.diagrams = diagrams(run);
    [this.from, this.to] = this.whole;
    this.element.append(this.tools(), this.grid);
    this.make();
    const fit = () => {
      fitWidth(this.drawn.map(({ plot }) => plot), this.width());
      this.fill();
    };
    new ResizeObserver(fit).observe(this.grid);
    onPrint((printed) => {
      this.printed = printed;
      fit();
    });
  }

  get view(): [number, number] {
    return [this.from, this.to];
  }

  private get whole(): [number, number] {
    return [this.times[0], this.times[this.times.length - 1]];
  }

  /** Shows a range of times [s], of at least four samples. */
  show(from: number, to: number): void {
    const [first, last] = this.whole;
    const least = (4 * (last - first)) / (this.times.length - 1);
    const width = Math.min(last - first, Math.max(least, to - from));
    const begin = Math.min(last - width, Math.max(first, 0.5 * (from + to - width)));
    if (begin === this.from && begin + width === this.to) return;
    [this.from, this.to] = [begin, begin + width];
    this.fill();
  }

  /** The moment at which the machine is shown; a part of the run goes along with it. */
  mark(index: number): void {
    this.now = this.times[index] ?? 0;
    const width = this.to - this.from;
    if (this.now > this.to || this.now < this.from) this.show(this.now - 0.05 * width, this.now + 0.95 * width);
    for (const one of this.drawn) this.placeHead(one);
  }

  /** What a diagram draws: times and lines. */
  data(diagram: number): number[][] {
    return this.drawn[diagram].plot.data.map((values) => Array.from(values as ArrayLike<number>));
  }

  /** The value axis of a diagram. */
  span(diagram: number): [number, number] {
    const { min, max } = this.drawn[diagram].plot.scales.y;
    return [min ?? 0, max ?? 0];
  }

  make(): void {
    for (const { plot } of this.drawn) plot.destroy();
    this.drawn = this.diagrams.map((diagram) => {
      const plot = this.plot(diagram);
      const head = html('div', { class: 'playhead' });
      plot.over.append(head);
      return { plot, diagram, head };
    });
    this.grid.replaceChildren(...this.drawn.map(({ plot }) => plot.root));
    this.fill();
  }

  private width(): number {
    const room = this.printed ? paper : this.grid.clientWidth || 900;
    const number = this.diagrams.length;
    let columns = Math.max(1, Math.min(number, Math.floor(room / 240)));
    while (number % columns > 0) --columns; // no row is shorter than the others
    return Math.floor(room / columns) - 8;
  }

  /** Gives all diagrams the points of what is shown. */
  private fill(): void {
    const { from: min, to: max } = this;
    for (const one of this.drawn) {
      const { plot, diagram } = one;
      const pixels = Math.max(50, Math.round(inner(plot)));
      const { banded, data } = drawnPoints(this.times, diagram.lines.map(({ line }) => line), min, max, pixels);
      this.banded = banded;
      plot.batch(() => {
        plot.setData(data as unknown as uPlot.AlignedData, false);
        plot.setScale('x', { min, max });
      });
      this.placeHead(one);
    }
    this.range.textContent = `${fixed(min, 3)} s to ${fixed(max, 3)} s`;
  }

  /** A line through the samples; of more samples than pixels the band that they fill, which has no dashes. */
  private path(u: uPlot, series: number, begin: number, end: number): uPlot.Series.Paths | null {
    if (!this.banded || u.series[series].dash) {
      const paths = straight(u, series, begin, end);
      return paths ? { ...paths, fill: null } : null;
    }
    const [times, values] = [u.data[0], u.data[series] as number[]];
    const half = 0.5 * lineWidth * devicePixelRatio;
    const x = (k: number) => u.valToPos(times[k], 'x', true);
    const [edge, band] = [(value: number) => u.valToPos(value, 'y', true), new Path2D()];
    // along the highest values, and back along the lowest
    for (let k = 0; k + 1 < values.length; k += 2) band.lineTo(x(k), edge(Math.max(values[k], values[k + 1])) - half);
    for (let k = values.length - 2; k >= 0; k -= 2) band.lineTo(x(k), edge(Math.min(values[k], values[k + 1])) + half);
    band.closePath();
    return { stroke: null, fill: band, flags: 1 };
  }

  private placeHead({ plot, head }: Drawn): void {
    const share = (this.now - this.from) / (this.to - this.from);
    head.hidden = share < 0 || share > 1;
    head.style.transform = `translateX(${(share * inner(plot)).toFixed(1)}px)`;
  }

  private plot(diagram: Diagram): uPlot {
    const colours = palette();
    const axis = { ...axisStyle(colours), labelSize: 18 };
    const plot = new uPlot(
      {
        width: this.width(),
        height: 210,
        title: diagram.title,
        legend: { show: false },
        cursor: {
          y: false,
          sync: { key: 'time' },
          drag: { x: true, y: false, setScale: false },
          bind: {
            dblclick: () => () => {
              this.show(...this.whole);
              return null;
            },
          },
        },
        hooks: { setSelect: [(u) => this.zoomTo(u)] },
        scales: {
          x: { time: false, auto: false, min: this.from, max: this.to },
          ...(diagram.room ? { y: { range: (_: uPlot, low: number | null, high: number | null) => withRoom(low ?? 0, high ?? 0, diagram.room!) } } : {}),
        },
        axes: [
          { ...axis, label: 's', size: 36 },
          { ...axis, label: diagram.unit, size: 56, values: (_, splits) => splits.map((value) => significant(value, 3)) },
        ],
        series: [
          {},
          ...diagram.lines.map((line) => {
            const colour = line.colour ?? (line.dashed ? colours.rigid : colours.flexible);
            return {
              label: line.label,
              stroke: colour,
              fill: colour,
              width: lineWidth,
              points: { show: false },
              paths: (u: uPlot, series: number, begin: number, end: number) => this.path(u, series, begin, end),
              ...(line.dashed ? { dash: [6, 4] } : {}),
            };
          }),
        ],
      },
      [[], ...diagram.lines.map(() => [])] as uPlot.AlignedData,
      document.createElement('div'),
    );
    plot.over.addEventListener('mousedown', () => (this.dragged = plot), { capture: true });
    plot.over.addEventListener('click', () => {
      const { left } = plot.cursor;
      if (left !== undefined && left >= 0) this.onTime(nearest(this.times, plot.posToVal(left, 'x')));
    });
    describeCanvas(plot.root, `${diagram.title} in ${diagram.unit} over time`);
    return plot;
  }

  /** After a drag across a diagram, whose cursor all others share. */
  private zoomTo(plot: uPlot): void {
    const { left, width } = plot.select;
    if (plot !== this.dragged || width < 2) return;
    const [from, to] = [plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x')];
    // when all others know that the drag has ended: they take its place from the scale of this one
    queueMicrotask(() => {
      for (const one of this.drawn) one.plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
      this.show(from, to);
    });
  }

  private tools(): HTMLElement {
    const zoom = (factor: number) => () => {
      // about the moment that is shown, where it is in the picture
      const at = this.now >= this.from && this.now <= this.to ? this.now : 0.5 * (this.from + this.to);
      this.show(at - (at - this.from) / factor, at + (this.to - at) / factor);
    };
    const move = (share: number) => () => {
      const by = share * (this.to - this.from);
      this.show(this.from + by, this.to + by);
    };
    return controlRow(
      html(
        'div',
        { class: 'group', role: 'group', 'aria-label': 'Part of the run in the diagrams' },
        button('+', zoom(2), { 'aria-label': 'Shorter part of the run', 'data-control': 'time-in' }),
        button('−', zoom(0.5), { 'aria-label': 'Longer part of the run', 'data-control': 'time-out' }),
        button('←', move(-0.25), { 'aria-label': 'Earlier' }),
        button('→', move(0.25), { 'aria-label': 'Later' }),
        button('Whole run', () => this.show(...this.whole), { 'data-control': 'time-whole' }),
      ),
      this.range,
    );
  }
}
