// The parameters: a slider, a field and a reset each. What is changed stands first, then what the lowest
// frequency depends on most; a search finds the others.

import type { Parameter } from '../core/core';
import type { Edits } from '../core/edits';
import type { Editable } from '../document';
import { button, html, identifier, svg } from '../dom';
import { fixed } from '../numbers';
import {
  atStep,
  inUnit,
  quantity,
  rangeOf,
  read,
  sliderSteps,
  stepOf,
  unitName,
  unitOf,
} from './quantity';

const shownAtFirst = 8;
const shownAtMost = 40;
/** After the list was used last, until its rows may change their places [ms]: a click elsewhere must have ended. */
const rest = 400;

/** Why the machine cannot have this value [SI] beside the others; empty where it can. */
export type Judge = (path: string, value: number) => Promise<string>;

class Row {
  readonly element: HTMLElement;
  private readonly field: HTMLInputElement;
  private readonly slider: HTMLInputElement | null = null;
  private readonly back: HTMLButtonElement;
  private readonly problem = html('p', { class: 'problem', role: 'alert' });
  private readonly sensitivity = html('span', { class: 'sensitivity' });

  constructor(
    private readonly editable: Editable,
    private readonly parameter: Parameter,
    private readonly edits: Edits,
    private readonly judge: Judge,
  ) {
    const { path, meaning } = parameter;
    const unit = unitOf(editable, parameter);
    const id = identifier('parameter');
    this.field = html('input', {
      type: 'text',
      id,
      inputmode: 'decimal',
      autocomplete: 'off',
      spellcheck: 'false',
      'data-field': path,
    });
    this.field.addEventListener('change', () => void this.typed());
    this.field.addEventListener('input', () => this.tell(''));
    this.back = button('↺', () => edits.reset(path), {
      class: 'quiet reset',
      'aria-label': `Reset ${path} to ${quantity(parameter.value, unit)}`,
      title: `Reset to ${quantity(parameter.value, unit)}`,
    });
    const range = rangeOf(parameter);
    if (range) {
      const slider = html('input', {
        type: 'range',
        min: 0,
        max: sliderSteps,
        step: 1,
        'aria-label': path,
        'data-slider': path,
      });
      slider.addEventListener('input', () => {
        const step = Number(slider.value);
        const own = step === stepOf(range, parameter.value);
        edits.drag(path, own ? parameter.value : atStep(range, step));
      });
      slider.addEventListener('change', () => edits.keep());
      this.slider = slider;
    }
    this.element = html(
      'li',
      { class: 'parameter', 'data-parameter': path },
      html('label', { for: id, title: meaning }, html('code', {}, path), this.sensitivity),
      html('span', { class: 'value' }, this.field, html('span', { class: 'unit' }, unitName(unit)), this.back),
      this.slider ?? html('span', { class: 'no-slider' }, 'is 0: type a value'),
      this.problem,
    );
    this.show();
  }

  /** A value that the machine cannot have stays in the field; it is no change. */
  private async typed(): Promise<void> {
    const { value: text } = this.field;
    const result = read(text, this.editable, this.parameter);
    const problem = 'problem' in result ? result.problem : await this.judge(this.parameter.path, result.value);
    if (this.field.value !== text) return; // typed on
    if (problem) this.tell(problem);
    else if ('value' in result) this.edits.set(this.parameter.path, result.value);
  }

  private tell(problem: string): void {
    this.problem.textContent = problem;
    this.field.setAttribute('aria-invalid', String(problem !== ''));
  }

  /** As the edits have it. */
  show(): void {
    const { parameter } = this;
    const value = this.edits.values.get(parameter.path) ?? parameter.value;
    const unit = unitOf(this.editable, parameter);
    this.field.value = inUnit(value, unit);
    this.tell('');
    const changed = this.edits.values.has(parameter.path);
    this.element.classList.toggle('changed', changed);
    this.back.disabled = !changed;
    const range = rangeOf(parameter);
    if (!this.slider || !range) return;
    this.slider.setAttribute('aria-valuetext', quantity(value, unit));
    const step = stepOf(range, value);
    if (Number(this.slider.value) !== step) this.slider.value = String(step);
  }

  /** A bar from the middle, as long as the largest of all is `most`, and the number. */
  showSensitivity(slope: number | undefined, most: number): void {
    this.sensitivity.title = 'Change of the lowest frequency with platform motion, % per %';
    this.sensitivity.replaceChildren();
    if (slope === undefined || Math.abs(slope) < 5e-4) return;
    const [half, length] = [24, (24 * Math.abs(slope)) / Math.max(most, Math.abs(slope))];
    this.sensitivity.append(
      svg(
        'svg',
        { class: 'sensitivity-bar', viewBox: `0 0 ${2 * half} 10`, 'aria-hidden': 'true' },
        svg('rect', { x: slope > 0 ? half : half - length, y: 1, width: length, height: 8, class: slope > 0 ? 'raises' : 'lowers' }),
        svg('line', { x1: half, x2: half, y1: 0, y2: 10 }),
      ),
      `${slope > 0 ? '+' : ''}${fixed(slope, 3)}`,
    );
  }
}

export class ParameterList {
  readonly element: HTMLElement;
  private readonly rows = new Map<string, Row>();
  private readonly list = html('ul', { class: 'parameters' });
  private readonly count = html('p', { class: 'note', 'aria-live': 'polite' });
  private readonly search: HTMLInputElement;
  private slopes: Record<string, number> = {};
  private most = 0;
  /** The order is another one than that of the rows. */
  private isOld = false;

  constructor(
    private readonly editable: Editable,
    private readonly parameters: Parameter[],
    private readonly edits: Edits,
    private readonly judge: Judge,
  ) {
    const id = identifier('search');
    this.search = html('input', {
      type: 'search',
      id,
      placeholder: 'rod mass, leg.3, gravity …',
      'data-control': 'parameter-search',
    });
    this.search.addEventListener('input', () => this.choose());
    const left = () => setTimeout(() => this.isOld && this.chooseUnused(), rest);
    for (const event of ['focusout', 'pointerup', 'pointercancel']) this.list.addEventListener(event, left);
    this.element = html(
      'div',
      { class: 'parameter-list' },
      html('div', { class: 'row search' }, html('label', { for: id }, 'Find a parameter'), this.search),
      this.list,
      this.count,
    );
    this.choose();
  }

  /** % of the lowest frequency per %. */
  order(slopes: Record<string, number>): void {
    this.slopes = slopes;
    this.most = Math.max(0, ...Object.values(slopes).map(Math.abs));
    for (const [path, row] of this.rows) row.showSensitivity(slopes[path], this.most);
    this.chooseUnused();
  }

  /** A field that changes its place loses the focus, and what was typed so far counts as entered. */
  private chooseUnused(): void {
    this.isOld = this.list.matches(':focus-within, :active');
    if (!this.isOld) this.choose();
  }

  show(): void {
    for (const row of this.rows.values()) row.show();
    const there = new Set([...this.list.children].map((child) => (child as HTMLElement).dataset['parameter']));
    if ([...this.edits.values.keys()].some((path) => !there.has(path))) this.choose();
  }

  private weight = ({ path, mechanics, single }: Parameter): number =>
    Math.abs(this.slopes[path] ?? 0) + (mechanics ? 1e-9 : 0) - (single ? 1e-9 : 0);

  /** Which rows are there; they stay where they are while they are used. */
  choose(): void {
    this.isOld = false;
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const matching = this.parameters.filter(({ path, meaning }) =>
      words.every((word) => `${path} ${path.replace(/[._]/g, ' ')} ${meaning}`.toLowerCase().includes(word)),
    );
    const order = [...matching].sort((a, b) => this.weight(b) - this.weight(a));
    const some = words.length > 0 ? order.slice(0, shownAtMost) : order.slice(0, shownAtFirst);
    const changed = this.parameters.filter(({ path }) => this.edits.values.has(path));
    const all = [...new Set([...changed, ...some])];
    this.list.replaceChildren(...all.map((parameter) => this.row(parameter).element));
    this.count.textContent =
      words.length > 0
        ? `${some.length} of ${matching.length} that match`
        : `The ${some.length} with the largest effect on the lowest frequency (% per %), of ${this.parameters.length}; the others by search.`;
  }

  private row(parameter: Parameter): Row {
    let row = this.rows.get(parameter.path);
    if (!row) {
      row = new Row(this.editable, parameter, this.edits, this.judge);
      row.showSensitivity(this.slopes[parameter.path], this.most);
      this.rows.set(parameter.path, row);
    }
    return row;
  }
}
