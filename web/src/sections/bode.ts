// Bode diagrams: 6×6 chooser, magnitude and phase, cursor with values, zoom, downloads.

import { Chooser } from '../bode/chooser';
import { csv, Sweep, titleOf, unitOf, type Curves, type Pair } from '../bode/curves';
import { bodePicture, pngOf, svgText } from '../bode/picture';
import { BodePlot } from '../bode/plot';
import { coreFailure, sharedCore } from '../core/shared';
import type { Bode } from '../document';
import { directions } from '../document';
import { button, download, how, html, notReady, slider } from '../dom';
import type { Readout } from '../hooks';
import { magnitude, phase, type Complex } from '../complex';
import { fixed, hertz, scientific } from '../numbers';
import { light, palette } from '../palette';
import type { State } from '../state';
import type { Section } from './section';

export const bode: Section = {
  id: 'bode',
  title: 'Bode diagrams',
  of: 'shown',
  applies: ({ editable, poses }) =>
    editable !== undefined && poses.length > 0 && poses.every((pose) => pose.bode !== undefined),
  render: (state, host) => {
    new BodeSection(state, host);
  },
};

const two_pi = 2 * Math.PI;
const sliderSteps = 1000;

class BodeSection {
  private pair: Pair;
  /** [Hz]; another one for every calculation. */
  private band: [number, number] = [1, 2];
  private sweep!: Sweep;
  private curves!: Curves;
  /** Of which pose they are, where there are several, and of which changed values. */
  private about: string[] = [];
  /** Until the curves of the chosen band are shown. */
  private ready = Promise.resolve();
  private chooserIsOld = true;
  private index: number | null = null;
  private readonly plot: BodePlot;
  private readonly chooser: Chooser;
  private readonly heading = html('h3', { id: 'bode-pair' });
  private readonly note = html('p', { class: 'note', 'aria-live': 'polite' });
  private readonly readout = html('div', { class: 'readout', 'aria-live': 'polite' });
  private readonly peaks = html('p', { class: 'note' });
  private readonly print = html('div', { class: 'print-only figures' });
  private readonly frequency;
  /** On the page from the first curves on. */
  private readonly content = html('div', { class: 'bode' });

  constructor(
    private readonly state: State,
    host: HTMLElement,
  ) {
    const main = state.pose.answer?.directions.split(' ')[0] ?? 'x';
    const d = Math.max(0, directions.indexOf(main as (typeof directions)[number]));
    this.pair = { output: d, input: d };
    this.plot = new BodePlot({
      cursor: (index) => this.setIndex(index),
      zoom: (from, to) => this.zoom(from, to),
      reset: () => this.reset(),
    });
    this.chooser = new Chooser((pair) => this.choose(pair));
    this.frequency = slider(
      'Cursor',
      { min: 0, max: sliderSteps, step: 1, value: 0 },
      (value) => `${hertz(this.frequencyAt(value))} Hz`,
      (value) => this.setCursor(this.frequencyAt(value)),
      'cursor',
    );
    this.content.append(
      html('div', { class: 'bode-choice' }, this.chooser.element, this.peaks),
      html(
        'div',
        { class: 'bode-plots' },
        this.heading,
        this.legend(),
        this.plot.element,
        this.tools(),
      ),
      this.readout,
    );
    host.append(this.note, this.print);
    state.listen((change) => {
      if (change === 'pose' || change === 'numbers') this.newPose();
      if (change === 'theme' && this.content.isConnected) this.draw();
    });
    this.newPose();
    this.offerHook();
  }

  private get data(): Bode {
    return this.state.pose.bode as Bode;
  }

  private newPose(): void {
    this.chooserIsOld = true;
    if (this.state.pose.bode) {
      if (!this.content.isConnected) this.note.replaceChildren(how('The curves are calculated …'));
      this.print.replaceChildren(notReady('The diagram')); // and none of another machine is printed
      this.reset();
    } else this.clear();
  }

  /** No mode of the platform is stable. */
  private clear(): void {
    this.band = [1, 2]; // curves that are being computed are of another machine
    this.ready = Promise.resolve();
    this.content.remove();
    this.print.replaceChildren();
    this.note.textContent = 'There is no stable response at this pose: no stable mode moves the platform. No curves are drawn.';
  }

  private reset(): void {
    this.zoom(this.data.from_rad_s / two_pi, this.data.to_rad_s / two_pi);
  }

  /** Shows the band [Hz]; the core computes the curves for it, so that resonances stay resolved. */
  private zoom(from: number, to: number): void {
    this.band = [from, to];
    this.ready = this.compute().catch((error) => {
      this.note.textContent = coreFailure(error);
      this.print.replaceChildren();
    });
  }

  private async compute(): Promise<void> {
    const { band, state } = this;
    const { pose, isWhatIf, displaced } = state;
    const core = await sharedCore(state);
    const curves = await core.curves({
      set: isWhatIf ? state.values : [],
      pose: state.poseNumber,
      ...(isWhatIf && displaced ? { displaced } : {}),
      from: two_pi * band[0],
      to: two_pi * band[1],
      points: this.data.points,
    });
    if (band !== this.band) return this.ready; // another one was chosen meanwhile
    this.sweep = new Sweep(pose, curves);
    this.about = [...(state.poseWords ? [state.poseWords] : []), ...(isWhatIf ? state.changes : [])];
    if (!this.content.isConnected) this.note.before(this.content);
    if (this.chooserIsOld) this.chooser.show(this.sweep, this.pair);
    this.chooserIsOld = false;
    this.draw();
  }

  /** By a factor about the cursor, or about the middle. */
  private zoomBy(factor: number): void {
    const [from, to] = this.band;
    const middle = this.index !== null ? this.curves.frequency[this.index] : Math.sqrt(from * to);
    const low = this.data.from_rad_s / two_pi;
    const high = this.data.to_rad_s / two_pi;
    const stretch = (f: number) => middle * (f / middle) ** (1 / factor);
    this.zoom(Math.max(low, stretch(from)), Math.min(high, stretch(to)));
  }

  private choose(pair: Pair): void {
    this.pair = pair;
    this.chooser.mark(pair);
    if (this.content.isConnected) this.draw();
  }

  private draw(): void {
    this.curves = this.sweep.curves(this.pair);
    this.heading.textContent = titleOf(this.pair);
    this.note.textContent = this.explanation();
    this.peaks.textContent = this.peakText();
    this.plot.show(this.curves, palette());
    if (!this.chooserIsOld) this.print.replaceChildren(html('figure', {}, this.picture()));
    this.setCursor(this.firstPeak());
  }

  private firstPeak(): number {
    const [from, to] = this.band;
    const peak = this.curves.marks[0] ?? this.curves.rigidMarks[0];
    return peak?.frequency ?? Math.sqrt(from * to);
  }

  private explanation(): string {
    const { point } = this.data;
    const where = `Force or moment at the ${point}, displacement at this point, base axes. Damping: ${this.state.report.assumptions.damping}.`;
    const none = `${titleOf(this.pair)}: not coupled at this pose; the curve is rounding error. `;
    const unstable = 'The machine is unstable at this pose: it does not follow the curves with flexible legs. ';
    const stands = this.state.pose.answer?.stable !== false;
    return (this.sweep.isCoupled(this.pair) ? '' : none) + (stands ? '' : unstable) + where;
  }

  private peakText(): string {
    const { marks, rigidMarks } = this.curves;
    const text = (list: Curves['marks']) =>
      list.map((mark) => `${hertz(mark.frequency)} Hz (mode ${mark.mode})`).join(', ') || 'none';
    const rigid = `Peaks with rigid legs: ${text(rigidMarks)}.`;
    return this.curves.flexible ? `Peaks with flexible legs: ${text(marks)}. ${rigid}` : rigid;
  }

  private legend(): HTMLElement {
    const item = (kind: string, text: string) =>
      html('li', {}, html('i', { class: `line line-${kind}` }), text);
    const items = [item('rigid', 'rigid legs')];
    if (this.state.pose.model !== 'rigid')
      items.unshift(item('flexible', 'flexible legs (numbers: modes)'));
    return html('ul', { class: 'legend' }, ...items);
  }

  private tools(): HTMLElement {
    const name = () => `bode-${directions[this.pair.output]}-${directions[this.pair.input]}`;
    return html(
      'div',
      { class: 'row' },
      this.frequency.element,
      html(
        'div',
        { class: 'group', role: 'group', 'aria-label': 'Zoom' },
        button('Zoom in', () => this.zoomBy(2), { 'data-control': 'zoom-in' }),
        button('Zoom out', () => this.zoomBy(0.5), { 'data-control': 'zoom-out' }),
        button('Whole band', () => this.reset(), { 'data-control': 'zoom-reset' }),
      ),
      html(
        'div',
        { class: 'group', role: 'group', 'aria-label': 'Download' },
        button('SVG', () => this.save(`${name()}.svg`, svgText(this.picture()), 'image/svg+xml'), {
          'data-control': 'svg',
        }),
        button(
          'PNG',
          () => void pngOf(this.picture()).then((blob) => download(`${name()}.png`, blob)),
          { 'data-control': 'png' },
        ),
        button('CSV', () => this.save(`${name()}.csv`, csv(this.curves, this.about), 'text/csv'), {
          'data-control': 'csv',
        }),
      ),
    );
  }

  private save(name: string, text: string, type: string): void {
    download(name, new Blob([text], { type }));
  }

  private picture(): SVGSVGElement {
    const { report, pose, isWhatIf, changes, values } = this.state;
    const short = (text: string) => (text.length > 110 ? `${text.slice(0, 109)}…` : text);
    const what = short(`${report.title}, pose ${pose.pose.name}; damping ${report.assumptions.damping}`);
    const changed = isWhatIf && values.length > 0 ? [short(`Changed: ${changes.join('; ')}`)] : [];
    return bodePicture(this.curves, [what, ...changed], light);
  }

  private frequencyAt(step: number): number {
    const [from, to] = this.band;
    return from * (to / from) ** (step / sliderSteps);
  }

  private setCursor(frequency: number): void {
    const all = this.curves.frequency;
    let best = 0;
    all.forEach((f, i) => {
      if (Math.abs(Math.log(f / frequency)) < Math.abs(Math.log(all[best] / frequency))) best = i;
    });
    this.plot.setCursor(best);
    this.setIndex(best);
  }

  private setIndex(index: number | null): void {
    this.index = index;
    this.readout.replaceChildren(this.values());
    if (index !== null) {
      const [from, to] = this.band;
      const f = this.curves.frequency[index];
      const step = Math.round((sliderSteps * Math.log(f / from)) / Math.log(to / from));
      if (document.activeElement !== this.frequency.input)
        this.frequency.input.value = String(step);
      const output = this.frequency.element.querySelector('output');
      if (output) output.textContent = `${hertz(f)} Hz`;
    }
  }

  private cursor(): Readout | null {
    const i = this.index;
    if (i === null) return null;
    const { frequency, flexible, rigid } = this.curves;
    return { frequency_hz: frequency[i], flexible: flexible ? flexible[i] : null, rigid: rigid[i] };
  }

  private values(): HTMLElement {
    const now = this.cursor();
    const unit = unitOf(this.pair);
    const row = (name: string, h: Complex | null | undefined) =>
      html(
        'tr',
        {},
        html('th', { scope: 'row' }, name),
        html('td', { class: 'numeric' }, h ? `${scientific(magnitude(h), 6)} ${unit}` : '–'),
        html('td', { class: 'numeric' }, h ? `${fixed(phase(h), 2)}°` : '–'),
      );
    const rows = [row('Rigid legs', now?.rigid)];
    if (this.curves.flexible) rows.unshift(row('Flexible legs', now?.flexible));
    const where = now
      ? `${scientificOrPlain(now.frequency_hz)} Hz = ${scientificOrPlain(two_pi * now.frequency_hz)} rad/s`
      : 'Point at the diagram, or move the slider of the cursor';
    return html(
      'table',
      { class: 'values' },
      html('caption', {}, where),
      html(
        'thead',
        {},
        html(
          'tr',
          {},
          html('th', { scope: 'col' }, 'At the cursor'),
          html('th', { scope: 'col' }, 'Magnitude'),
          html('th', { scope: 'col' }, 'Phase'),
        ),
      ),
      html('tbody', {}, ...rows),
    );
  }

  private offerHook(): void {
    const section = this;
    window.hydrapod.bode = {
      get ready() {
        return section.ready;
      },
      choose: (output, input) => this.choose({ output, input }),
      setCursor: (frequency) => this.setCursor(frequency),
      cursor: () => this.cursor(),
      band: () => this.band,
    };
  }
}

const scientificOrPlain = (value: number): string => String(Number(value.toPrecision(6)));
