// Measured modes: an interactive stabilisation chart, the fit of the selected poles, and the
// comparison with the model.

import { agreements, Chart, markPath } from '../identification/chart';
import { Choice, type ChosenPole } from '../identification/choice';
import { Fitter, type Fit } from '../identification/fitter';
import { ResponsePlots } from '../identification/plots';
import { MovingShape, type ShownShape } from '../identification/moving_shape';
import { displacementOf, platformMotion } from '../identification/platform_motion';
import { isOfWholeRecord, programFit, whyNoRefit } from '../identification/program_fit';
import { comparisonTable, macTable, PoleTable } from '../identification/tables';
import type { ChartPole, Identification, Pole, Vector } from '../identification/types';
import { coreFailure, sharedCore } from '../core/shared';
import { button, controlRow, how, html, identifier, notReady, select, svg } from '../dom';
import { fixed, hertz, signedPercent, withInterval } from '../numbers';
import { palette } from '../palette';
import type { State } from '../state';
import type { Section } from './section';

export const identification: Section = {
  id: 'identification',
  title: 'Identified modes',
  of: 'report',
  applies: (report) => (report.identification?.responses.frequency_hz.length ?? 0) > 1,
  render: (state, host) => {
    new IdentificationSection(state, host);
  },
};

/** The pole whose shape is shown: one of the table, or one of the chart that is in none. */
interface Selected {
  pole: Pole & { frequency_hz: number; damping_ratio: number };
  known?: ChosenPole;
  mark?: ChartPole;
  order?: number;
}

function poleName({ known, order }: Selected): string {
  if (known?.kind === 'mode') return `mode ${known.number}`;
  if (known?.kind === 'heavy') return 'heavily damped';
  return `pole of order ${known?.number ?? order ?? '?'}`;
}

const ofTheFit = 'Its shape is that of the fit with the poles that are switched on.';

/** Of a pole that is not one of the modes. `identified`: with its shape in the identification. */
function poleCaption({ pole, known }: Selected, identified: boolean): string {
  const kind = known?.kind === 'heavy' ? 'Heavily damped pole' : 'Pole that belongs to no mode';
  return `${kind}, damping ratio ${fixed(100 * pole.damping_ratio, 2)} %.${identified ? '' : ` ${ofTheFit}`}`;
}

function fitText({ poles, error }: Fit): string {
  const count = poles.length === 1 ? '1 pole' : `${poles.length} poles`;
  return `${count} switched on: error of the synthesised responses ${fixed(100 * error, 2)} %.`;
}

const programFitText = ({ error }: Fit): string =>
  `Error of the synthesised spectra of the outputs: ${fixed(100 * error, 2)} %. ${whyNoRefit}`;

const shownName = (selected: Selected): string => `${poleName(selected)}, ${hertz(selected.pole.frequency_hz)} Hz`;

const noPicture = (): HTMLElement =>
  html('p', { class: 'note' }, 'The report has no geometry of the machine: shapes are not drawn. The table lists their motion.');

class IdentificationSection {
  private readonly data: Identification;
  private readonly choice: Choice;
  /** null: the page cannot make the fit of the program. */
  private readonly fitter: Promise<Fitter> | null;
  private readonly chart: Chart;
  private readonly plots: ResponsePlots;
  private readonly table: PoleTable;
  private readonly error = html('p', { class: 'note', 'aria-live': 'polite' });
  private readonly keys = html('ul', { class: 'legend' });
  private readonly macHost = html('div');
  private readonly shape: MovingShape | null;
  private readonly selectedName = html('span');
  private readonly switchButton = button('Switch off', () => this.switchSelected(), { 'data-control': 'selected-switch' });
  private selected: Selected | null = null;
  /** The last one that the core has answered. */
  private fit: Fit | null = null;
  /** What is switched on, a new list for every change. */
  private active: ChosenPole[] = [];
  /** Until what was chosen last is fitted and shown. */
  private ready = Promise.resolve();
  private output = 0;
  private input = 0;

  constructor(state: State, host: HTMLElement) {
    this.data = state.report.identification as Identification;
    this.choice = new Choice(this.data);
    this.fitter = isOfWholeRecord(this.data) ? null : this.startFitter(state);
    this.chart = new Chart(this.data, this.choice);
    this.plots = new ResponsePlots(this.data);
    this.table = new PoleTable(this.data, this.choice, this.fitter !== null);
    const geometry = state.report.poses[0]?.geometry;
    this.shape = geometry ? new MovingShape(geometry) : null;
    this.choice.onChange = () => this.refit();
    this.chart.onSelect = (mark, order) => this.select(this.chosen(mark, order), true);
    this.table.onShow = (known) => {
      this.select({ pole: known, known }, true);
      this.shape?.element.scrollIntoView({ behavior: 'auto', block: 'nearest' });
    };
    if (this.fitter) this.error.replaceChildren(how('The fit is calculated …'), notReady('The fit'));
    host.append(...this.parts());
    state.listen((change) => {
      if (change !== 'theme') return;
      this.draw();
      this.shape?.recolour();
    });
    this.refit();
    const first = this.choice.poles[0];
    if (first) this.select({ pole: first, known: first }, false);
    this.offerHook();
  }

  private parts(): Node[] {
    const { data } = this;
    const output = select('Output', data.outputs.map(({ name }) => name), (k) => {
      this.output = k;
      this.drawResponse();
    }, 'measured-output');
    const input = select('from input', data.inputs.map(({ name }) => name), (k) => {
      this.input = k;
      this.drawResponse();
    }, 'measured-input');
    return [
      html('p', {}, `${data.records.join(', ')}: ${data.measured}; ${data.frame}.`),
      ...data.warnings.map((text) => html('p', { class: 'warning' }, html('strong', {}, 'Warning: '), text)),
      html('h3', {}, 'Stabilisation'),
      html(
        'div',
        { class: 'stabilisation' },
        html('div', { class: 'stabilisation-part' }, this.chart.element, this.keys, this.byHand()),
        html('div', { class: 'stabilisation-part' }, this.shape?.element ?? noPicture(), this.selection()),
      ),
      html('h3', {}, 'Modes'),
      this.table.element,
      html('p', { class: 'note' }, 'Hz: |λ| of damped modes.'),
      this.error,
      html('h3', {}, 'Response and fit'),
      controlRow(output, input),
      this.plots.element,
      html('p', { class: 'note' }, this.fitNote(), how('Drag across a diagram to zoom, double-click for the whole range.')),
      ...(data.modes.length > 0 ? [html('h3', {}, 'MAC of the shapes'), this.macHost] : []),
      ...(data.comparison ? [comparisonTable(data, data.comparison)] : []),
    ];
  }

  /** The pole that is shown, and its switch: also where there is no picture of it. */
  private selection(): HTMLElement {
    return html('div', { class: 'row selection' }, this.selectedName, this.fitter ? this.switchButton : null);
  }

  private fitNote(): string {
    if (!this.fitter)
      return (
        'Solid, for phases points: parametric model of the record, with its 95 % band; dashed: sum of the identified modes and of the ' +
        `residual terms. `
      );
    const shift = this.data.responses.shift_per_s;
    const window = this.data.taper
      ? ', including the effect of the measurement window'
      : shift > 0
        ? `; both at s = a + iω with a = ${shift.toPrecision(2)} 1/s, which widens the resonances`
        : '';
    return (
      `Solid, for phases points: measured, with its 95 % band where errors are known; dashed: fit of the poles that are ` +
      `switched on${window}. `
    );
  }

  /** Adding a pole by order and frequency. */
  private byHand(): HTMLElement {
    const order = html(
      'select',
      { id: identifier('order'), 'data-control': 'hand-order' },
      ...this.data.stabilisation.map(({ order: n }) => html('option', { value: n }, n)),
    );
    const orders = this.data.stabilisation.map((n) => n.order);
    order.value = String(orders[orders.length - 1] ?? '');
    const frequency = html('input', {
      id: identifier('near'),
      type: 'number',
      step: 'any',
      min: 0,
      'data-control': 'hand-frequency',
      value: Number(this.data.band_hz[0].toPrecision(3)),
    });
    const nearest = (): ChartPole | undefined => {
      const poles = this.data.stabilisation.find((n) => n.order === Number(order.value))?.poles ?? [];
      const wanted = Number(frequency.value);
      return poles
        .filter((pole) => pole.stable)
        .sort((a, b) => Math.abs(a.frequency_hz - wanted) - Math.abs(b.frequency_hz - wanted))[0];
    };
    const show = () => {
      const mark = nearest();
      if (mark) this.select(this.chosen(mark, Number(order.value)), true);
    };
    const toggle = () => {
      const mark = nearest();
      if (mark) this.choice.toggle(mark, Number(order.value));
    };
    return controlRow(
      html('label', { for: order.id }, 'Pole of order'),
      order,
      html('label', { for: frequency.id }, 'closest to Hz'),
      frequency,
      button('Show shape', show, { 'data-control': 'hand-show' }),
      this.fitter && button('Switch', toggle, { 'data-control': 'hand-switch' }),
      this.fitter && button('Reset', () => this.choice.reset(), { 'data-control': 'as-found' }),
    );
  }

  /** A mark of the chart: the mode that it belongs to, or itself. */
  private chosen(mark: ChartPole, order: number): Selected {
    const known = this.choice.of(mark);
    return { pole: known ?? mark, ...(known ? { known } : {}), mark, order };
  }

  private async startFitter(state: State): Promise<Fitter> {
    return Fitter.start(await sharedCore(state), this.data);
  }

  private select(selected: Selected, moving: boolean): void {
    this.selected = selected;
    this.chart.select(selected.mark ?? null);
    this.nameSwitch();
    this.showShape(selected, moving);
  }

  /** That of the identification, until the reader changes the poles; then that of the fit. */
  private showShape(selected: Selected, moving: boolean): void {
    const { active } = this;
    const found = this.choice.untouched ? this.foundShape(selected) : null;
    if (found) this.shape?.show(this.shownShape(selected, found, true), moving);
    else this.queue(() => this.showFitted(selected, active, moving));
  }

  /** One after the other: what was chosen meanwhile is seen before the core is asked. */
  private queue(work: () => Promise<void>): void {
    this.ready = this.ready.then(work);
  }

  private nameSwitch(): void {
    const known = this.selected?.mark ? this.choice.of(this.selected.mark) : this.selected?.known;
    const added = known && (known.kind !== 'hand' || known.on); // not one that was taken out again
    if (this.selected) this.selectedName.textContent = shownName(this.selected);
    this.switchButton.textContent = !added ? 'Add to the fit' : known.on ? 'Switch off' : 'Switch on';
  }

  private switchSelected(): void {
    const { known, mark, order } = this.selected ?? {};
    if (mark && order !== undefined) this.choice.toggle(mark, order);
    else if (known) this.choice.set(known, !known.on);
  }

  /** Of a mode or a heavily damped pole as the program found it; null: the fit has to tell. */
  private foundShape({ pole, known }: Selected): Vector | null {
    if (known?.kind === 'mode') return this.data.modes[known.number - 1].displacement_shape;
    if (known?.kind !== 'heavy') return null;
    const { re, im } = this.data.heavily_damped[known.number - 1].shape;
    return displacementOf(this.data.outputs, pole.pole, re.map((part, o) => ({ re: part, im: im[o] })));
  }

  /** The shape in the fit beside the poles that are switched on. */
  private async showFitted(selected: Selected, active: ChosenPole[], moving: boolean): Promise<void> {
    if (selected !== this.selected || active !== this.active) return; // another choice was made meanwhile
    const { known, mark } = selected;
    const pole = (mark ? this.choice.of(mark) : known) ?? selected.pole;
    let shown: ShownShape;
    try {
      const fit = await this.fitWith(pole);
      const shape = fit.shapes[fit.poles.indexOf(pole)];
      shown = this.shownShape(selected, displacementOf(this.data.outputs, pole.pole, shape), false);
    } catch (error) {
      const problem = this.fitter ? coreFailure(error) : whyNoRefit;
      shown = { ...this.shownShape(selected, this.foundShape(selected), true), problem };
    }
    if (selected === this.selected && active === this.active) this.shape?.show(shown, moving);
  }

  /** What is switched on, and `pole`. */
  private async fitWith(pole: Pole): Promise<Fit> {
    const { fit, active } = this;
    if (fit?.poles === active && active.some((other) => other === pole)) return fit;
    if (!this.fitter) throw new Error(whyNoRefit);
    return (await this.fitter).fit([...active.filter((other) => other !== pole), pole]);
  }

  private shownShape(selected: Selected, displacement: Vector | null, identified: boolean): ShownShape {
    const { known } = selected;
    const { outputs, comparison } = this.data;
    const number = known?.kind === 'mode' ? known.number : null;
    const partner = comparison?.pairs.find((p) => p.mode === number)?.model;
    return {
      name: shownName(selected),
      caption: number === null ? poleCaption(selected, identified) : this.modeCaption(number, identified),
      motion: displacement && platformMotion(outputs, displacement),
      model: partner?.motion
        ? { name: `${partner.label}, ${hertz(partner.frequency_hz)} Hz`, motion: partner.motion }
        : null,
    };
  }

  private modeCaption(number: number, identified: boolean): string {
    const mode = this.data.modes[number - 1];
    const pair = this.data.comparison?.pairs.find((p) => p.mode === number);
    const [damping, interval] = withInterval(100 * mode.damping_ratio, 100 * mode.damping_95, 2);
    const ratio = `amping ratio ${damping} ± ${interval} %`;
    const own = identified
      ? `Mode ${number}: ${mode.motion}. D${ratio}, MPC ${fixed(mode.mpc, 3)}.`
      : `Mode ${number}: d${ratio}. ${ofTheFit}`;
    if (!pair) return own;
    const mac = pair.mac === null || !identified ? '' : `, MAC ${fixed(pair.mac, 3)}`;
    return (
      `${own} Model: ${pair.model.label}; the measured frequency is ` +
      `${signedPercent(pair.frequency_difference_percent)} relative to it${mac}.`
    );
  }

  private refit(): void {
    const active = this.choice.active;
    this.active = active;
    this.nameSwitch();
    this.draw();
    this.queue(() => this.showFit(active));
    if (this.selected) this.showShape(this.selected, false);
  }

  private async showFit(active: ChosenPole[]): Promise<void> {
    if (active !== this.active) return; // others were chosen meanwhile
    let fit: Fit | null = null;
    let words: string;
    try {
      fit = this.fitter ? await (await this.fitter).fit(active) : programFit(this.data, active);
      words = this.fitter ? fitText(fit) : programFitText(fit);
    } catch (error) {
      words = coreFailure(error);
    }
    if (active !== this.active) return;
    this.fit = fit;
    this.error.textContent = words;
    this.table.showMotions(fit);
    this.drawResponse();
  }

  private draw(): void {
    this.chart.draw();
    this.drawKeys();
    this.table.show(this.fit);
    this.drawResponse();
    if (this.data.modes.length > 0) this.macHost.replaceChildren(macTable(this.data));
  }

  private drawKeys(): void {
    this.keys.replaceChildren(
      ...agreements.map(({ agrees, label, colour }) => {
        const mark = svg(
          'svg',
          { width: 14, height: 12, viewBox: '-7 -6 14 12', 'aria-hidden': 'true' },
          svg('path', {
            d: markPath(agrees),
            fill: agrees === 'new' ? 'none' : colour(),
            stroke: colour(),
          }),
        );
        return html('li', {}, mark, label);
      }),
      html('li', {}, this.indicatorKey(), 'mode indicator: singular values of H (right axis)'),
    );
  }

  private indicatorKey(): SVGElement {
    const stroke = palette().ghost;
    return svg(
      'svg',
      { width: 18, height: 12, 'aria-hidden': 'true' },
      svg('line', { x1: 0, x2: 18, y1: 6, y2: 6, stroke, 'stroke-width': 2 }),
    );
  }

  private drawResponse(): void {
    const { fit } = this;
    const any = fit !== null && fit.poles.length > 0;
    this.plots.show(this.output, this.input, any ? fit.synthesis(this.output, this.input) : null);
  }

  private offerHook(): void {
    const section = this;
    window.hydrapod.identification = {
      get ready() {
        return section.ready;
      },
      marks: () => this.chart.positions(),
      chosen: () => this.choice.active.map(({ pole }) => pole),
      error: () => this.fit?.error ?? Number.NaN,
      shapes: () => this.fit?.shapes ?? [],
      fitted: (output, input) => this.fit?.synthesis(output, input) ?? [],
      shape: {
        jointPositions: (leg, side = 'measured') => this.shape?.jointPositions(leg, side) ?? null,
        motion: () => this.shape?.motion() ?? null,
        setPhase: (phase) => this.shape?.setPhase(phase),
        frames: () => this.shape?.frames() ?? 0,
      },
    };
  }
}
