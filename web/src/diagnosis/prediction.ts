// The prediction of a hypothesis beside the measurement: frequency responses, where they were measured, and resonances.

import { overlaidMagnitudes, type OverlayLine } from '../bode/overlay';
import { DiagramStack } from '../bode/stack';
import type { Diagnosis, DiagnosedMode, Hypothesis, ResponseOverlay } from '../document';
import { button, how, html, select } from '../dom';
import { fixed, halfWidth95, hertz, signedPercent } from '../numbers';
import { palette } from '../palette';
import { numeric, scroller, tableHead } from '../table';

const entryWords = { valves: 'valve drives', forces: 'forces and moments', commands: 'commands' };

export class Prediction {
  readonly element = html('div', { class: 'prediction' });
  private readonly title = html('p', { class: 'prediction-title', 'aria-live': 'polite' });
  private readonly plots = new DiagramStack('prediction');
  private readonly modes = html('tbody');
  private readonly note = html('p', { class: 'note' });
  private readonly directions: HTMLButtonElement[];
  private readonly hypotheses: Hypothesis[];
  private readonly nominal: number;
  private overlay = 0;
  private curve = 0;
  private hypothesis = 0;
  /** Another hypothesis is shown. */
  onShow: (hypothesis: number) => void = () => {};

  constructor(private readonly found: Diagnosis) {
    this.hypotheses = found.hypotheses ?? [];
    this.nominal = this.hypotheses.findIndex((e) => e.causes.length === 0 && !e.rigid_legs);
    const overlay = this.overlays[0];
    this.directions = (overlay?.curves ?? []).map(({ direction }, k) =>
      button(direction, () => this.choose(this.overlay, k), { 'data-direction': direction }),
    );
    this.curve = this.clearest();
    this.element.append(this.title, ...(overlay ? [this.choosers(), this.plots.element, this.legend()] : []), this.table(), this.note);
  }

  private get overlays(): ResponseOverlay[] {
    return (this.found.responses ?? []).filter(({ frequency_hz }) => frequency_hz.length > 1);
  }

  show(hypothesis: number): void {
    this.hypothesis = hypothesis;
    this.draw();
    this.onShow(hypothesis);
  }

  choose(overlay: number, curve: number): void {
    this.overlay = overlay;
    this.curve = curve;
    this.draw();
  }

  /** What is drawn, for tests; null: no response was measured. */
  drawn() {
    const overlay = this.overlays[this.overlay];
    if (!overlay) return null;
    const curve = overlay.curves[this.curve];
    return {
      frequency_hz: overlay.frequency_hz,
      measured: curve.measured,
      predicted: this.predicted(this.hypothesis),
      nominal: this.predicted(this.nominal),
    };
  }

  get shown(): number {
    return this.hypothesis;
  }

  draw(): void {
    const { name } = this.hypotheses[this.hypothesis];
    const curve = this.overlays[this.overlay]?.curves[this.curve];
    const motion = curve ? `: motion in ${curve.direction}` : '';
    this.title.replaceChildren('Prediction of ', html('strong', {}, name), `, compared with the measurement${motion}`);
    this.directions.forEach((b, k) => b.setAttribute('aria-pressed', String(k === this.curve)));
    this.drawResponse();
    this.drawModes();
    this.note.replaceChildren(
      `${this.words()} `,
      this.overlays.length > 0 ? how('Drag across the diagram to zoom, double-click for the whole range.') : '',
    );
  }

  /** Values of a hypothesis; null: there are none. */
  private predicted(hypothesis: number): (number | null)[] | null {
    const overlay = this.overlays[this.overlay];
    const at = overlay?.hypotheses.indexOf(hypothesis) ?? -1;
    const values = overlay?.curves[this.curve].predicted[at] ?? [];
    return values.length > 0 ? values : null;
  }

  private drawResponse(): void {
    const overlay = this.overlays[this.overlay];
    if (!overlay) return;
    const { direction, unit, measured } = overlay.curves[this.curve];
    const colours = palette();
    const positive = (values: (number | null)[]) => values.map((v) => (v !== null && v > 0 ? v : null));
    const nominal = this.predicted(this.nominal);
    const own = this.predicted(this.hypothesis);
    const name = `Motion in ${direction} over frequency: measured, ${this.hypotheses[this.hypothesis].name}, nominal machine`;
    const lines: OverlayLine[] = [{ label: 'measured', stroke: colours.flexible, values: positive(measured) }];
    if (nominal && this.hypothesis !== this.nominal)
      lines.push({ label: 'nominal', stroke: colours.faint, width: 1.4, dash: [2, 3], values: positive(nominal) });
    if (own) lines.push({ label: 'predicted', stroke: colours.rigid, width: 1.8, dash: [6, 4], values: positive(own) });
    this.plots.show([overlaidMagnitudes({ name, frequency_hz: overlay.frequency_hz, lines }, unit)]);
  }

  private words(): string {
    const overlay = this.overlays[this.overlay];
    const lines: string[] = [];
    if (overlay) {
      lines.push(
        overlay.direct
          ? 'Each diagram is the response to the force or moment in the same direction.'
          : 'Each diagram is the motion in one direction: the root of the sum of squares over all inputs.',
      );
      if (overlay.scaled)
        lines.push(
          'The gains of valves and controllers are not known. Each prediction is multiplied by one factor over all frequencies: compare the frequencies of the peaks, not their heights.',
        );
      if (!this.predicted(this.hypothesis)) lines.push('The response of this hypothesis cannot be computed; its resonances are below.');
    }
    lines.push('Filled circle: measured, with its 95 % interval. Open diamond: predicted. Vertical line: nominal machine.');
    return lines.join(' ');
  }

  private choosers(): HTMLElement {
    const poses = this.overlays.map(({ pose, entry }) => `pose ${pose}, ${entryWords[entry]}`);
    return html(
      'div',
      { class: 'row' },
      poses.length > 1 ? select('Measured at', poses, (k) => this.choose(k, this.curve), 'overlay') : null,
      html(
        'div',
        { class: 'group directions', role: 'group', 'aria-label': 'Direction of the response' },
        html('span', { 'aria-hidden': 'true' }, 'Motion in'),
        ...this.directions,
      ),
    );
  }

  private legend(): HTMLElement {
    const item = (kind: string, text: string) => html('li', {}, html('i', { class: `line line-${kind}` }), text);
    return html('ul', { class: 'legend' }, item('flexible', 'measured'), item('rigid', 'predicted'), item('nominal', 'nominal machine'));
  }

  /** The direction whose measured frequency differs most from that of the nominal machine. */
  private clearest(): number {
    const modes = (this.found.measured_modes ?? []).filter((mode) => mode.direction !== null);
    const off = (mode: DiagnosedMode) => Math.abs(mode.nominal_hz / mode.frequency_hz - 1);
    const most = [...modes].sort((a, b) => off(b) - off(a))[0];
    return Math.max(0, (this.overlays[0]?.curves ?? []).findIndex(({ direction }) => direction === most?.direction));
  }

  private table(): HTMLElement {
    return scroller(
      'Measured and predicted resonances',
      html(
        'table',
        { class: 'predictions' },
        html('caption', { class: 'unseen' }, 'Measured modes with the resonances of the hypothesis that is shown'),
        tableHead(
          ['measured mode'],
          ['Hz', 'numeric measured-hz'],
          ['predicted, Hz', 'numeric'],
          ['difference', 'numeric'],
          ['MAC', 'numeric shape-mac'],
          ['frequency', 'lane-head'],
        ),
        this.modes,
      ),
    );
  }

  private drawModes(): void {
    const measured = this.found.measured_modes ?? [];
    const { targets = [] } = this.hypotheses[this.hypothesis];
    const all = [...measured.flatMap((mode) => [mode.frequency_hz, mode.nominal_hz]), ...targets.map((t) => t.frequency_hz)].filter((f) => f > 0);
    const range: [number, number] = [0.95 * Math.min(...all), 1.05 * Math.max(...all)];
    this.modes.replaceChildren(
      ...measured.map((mode, k) => {
        const predicted = targets[k]?.frequency_hz ?? 0;
        const mac = targets[k]?.shape_mac ?? null;
        return html(
          'tr',
          {},
          html('th', { scope: 'row' }, `${mode.direction ?? '?'}, ${mode.pose}`),
          numeric(hertz(mode.frequency_hz), 'measured-hz'),
          numeric(predicted > 0 ? hertz(predicted) : '–'),
          numeric(predicted > 0 ? signedPercent(100 * (predicted / mode.frequency_hz - 1)) : '–'),
          numeric(mac !== null && mac > 0 ? fixed(mac, 2) : '–', 'shape-mac'),
          html('td', { class: 'lane-cell' }, lane(mode, predicted, range)),
        );
      }),
    );
  }
}

/** The frequencies of a measured mode on one axis, with the 95 % interval; 0: not predicted. */
function lane(mode: DiagnosedMode, predicted: number, [low, high]: [number, number]): HTMLElement {
  const element = html('div', { class: 'lane', 'aria-hidden': 'true' });
  const place = (frequency: number) => `${((100 * (frequency - low)) / (high - low)).toFixed(2)}%`;
  const half = halfWidth95 * mode.deviation_hz;
  const interval = html('i', { class: 'interval' });
  interval.style.left = place(mode.frequency_hz - half);
  interval.style.width = `${((200 * half) / (high - low)).toFixed(3)}%`;
  element.append(interval);
  const marks: [string, number][] = [['nominal', mode.nominal_hz], ['measured', mode.frequency_hz], ['predicted', predicted]];
  for (const [kind, frequency] of marks) {
    if (!(frequency > 0)) continue;
    const mark = html('i', { class: kind });
    mark.style.left = place(frequency);
    element.append(mark);
  }
  return element;
}
