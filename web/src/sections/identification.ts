// Measured modes: an interactive stabilisation chart, the fit of the selected poles, and the
// comparison with the model.

import { agreements, Chart, markPath } from '../identification/chart';
import { Choice } from '../identification/choice';
import { Fitter, type Fit } from '../identification/fit';
import { ResponsePlots } from '../identification/plots';
import { comparisonTable, macTable, PoleTable } from '../identification/tables';
import type { Channel, Identification } from '../identification/types';
import { button, html, identifier, svg } from '../dom';
import { fixed } from '../numbers';
import { palette } from '../palette';
import type { State } from '../state';
import type { Section } from './section';

export const identification: Section = {
  id: 'identification',
  title: 'Identified modes',
  applies: (report) => (report.identification?.responses.frequency_hz.length ?? 0) > 1,
  render: (state, host) => {
    new IdentificationSection(state, host);
  },
};

function select(label: string, channels: Channel[], name: string, change: (k: number) => void) {
  const id = identifier(name);
  const element = html(
    'select',
    { id, 'data-control': name },
    ...channels.map((channel, k) => html('option', { value: k }, channel.name)),
  );
  element.addEventListener('change', () => change(Number(element.value)));
  return {
    element: html('span', { class: 'select' }, html('label', { for: id }, label), element),
    input: element,
  };
}

class IdentificationSection {
  private readonly data: Identification;
  private readonly choice: Choice;
  private readonly fitter: Fitter;
  private readonly chart: Chart;
  private readonly plots: ResponsePlots;
  private readonly table: PoleTable;
  private readonly error = html('p', { class: 'note', 'aria-live': 'polite' });
  private readonly keys = html('ul', { class: 'legend' });
  private readonly macHost = html('div');
  private fit!: Fit;
  private output = 0;
  private input = 0;

  constructor(state: State, host: HTMLElement) {
    this.data = state.report.identification as Identification;
    this.choice = new Choice(this.data);
    this.fitter = new Fitter(this.data.responses, this.data.taper, this.data.responses.shift_per_s);
    this.chart = new Chart(this.data, this.choice);
    this.plots = new ResponsePlots(this.data);
    this.table = new PoleTable(this.data, this.choice);
    this.choice.onChange = () => this.refit();
    host.append(...this.parts());
    state.listen((change) => change === 'theme' && this.draw());
    this.refit();
    this.offerHook();
  }

  private parts(): Node[] {
    const { data } = this;
    const output = select('Output', data.outputs, 'measured-output', (k) => {
      this.output = k;
      this.drawResponse();
    });
    const input = select('from input', data.inputs, 'measured-input', (k) => {
      this.input = k;
      this.drawResponse();
    });
    return [
      html('p', {}, `${data.records.join(', ')}: ${data.measured}; ${data.frame}.`),
      ...data.warnings.map((text) => html('p', { class: 'note' }, `Warning: ${text}`)),
      html('h3', {}, 'Stabilisation'),
      this.chart.element,
      this.keys,
      this.byHand(),
      html('h3', {}, 'Modes'),
      this.table.element,
      this.error,
      html('h3', {}, 'Response and fit'),
      html('div', { class: 'controls' }, html('div', { class: 'row' }, output.element, input.element)),
      this.plots.element,
      html('p', { class: 'note' }, this.fitNote()),
      ...(data.modes.length > 0 ? [html('h3', {}, 'MAC of the shapes'), this.macHost] : []),
      ...(data.comparison ? [comparisonTable(data, data.comparison)] : []),
    ];
  }

  private fitNote(): string {
    const shift = this.data.responses.shift_per_s;
    const window = this.data.taper
      ? ', including the effect of the measurement window'
      : shift > 0
        ? `; both at s = a + iω with a = ${shift.toPrecision(2)} 1/s, which widens the resonances`
        : '';
    return (
      `Solid: measured, with its 95 % band where errors are known; dashed: fit of the poles that are ` +
      `switched on${window}. Drag across a diagram to zoom, double-click for the whole range.`
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
    const toggle = () => {
      const poles = this.data.stabilisation.find((n) => n.order === Number(order.value))?.poles ?? [];
      const wanted = Number(frequency.value);
      const nearest = poles
        .filter((pole) => pole.stable)
        .sort((a, b) => Math.abs(a.frequency_hz - wanted) - Math.abs(b.frequency_hz - wanted))[0];
      if (nearest) this.choice.toggle(nearest, Number(order.value));
    };
    return html(
      'div',
      { class: 'controls' },
      html(
        'div',
        { class: 'row' },
        html('label', { for: order.id }, 'Pole of order'),
        order,
        html('label', { for: frequency.id }, 'closest to Hz'),
        frequency,
        button('Switch', toggle, { 'data-control': 'hand-switch' }),
        button('Reset', () => this.choice.reset(), { 'data-control': 'as-found' }),
      ),
    );
  }

  private refit(): void {
    this.fit = this.fitter.fit(this.choice.active);
    this.draw();
  }

  private draw(): void {
    this.chart.draw();
    this.drawKeys();
    this.table.show(this.fit);
    this.error.textContent = this.errorText();
    this.drawResponse();
    if (this.data.modes.length > 0) this.macHost.replaceChildren(macTable(this.data));
  }

  private errorText(): string {
    const count = this.choice.active.length;
    const poles = count === 1 ? '1 pole' : `${count} poles`;
    return `${poles} switched on: error of the synthesised responses ${fixed(100 * this.fit.error, 2)} %.`;
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
    const any = this.choice.active.length > 0;
    this.plots.show(
      this.output,
      this.input,
      any ? this.fit.synthesis(this.output, this.input) : null,
    );
  }

  private offerHook(): void {
    window.hydrapod.identification = {
      marks: () => this.chart.positions(),
      chosen: () => this.choice.active.map(({ pole }) => pole),
      error: () => this.fit.error,
      shapes: () => this.fit.shapes,
      fitted: (output, input) => this.fit.synthesis(output, input),
      responseAt: (output, input, frequency) => this.fit.at(output, input, frequency),
    };
  }
}
