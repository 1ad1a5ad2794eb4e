// The 6×6 chooser: a table of buttons, each with a small picture of its response.

import { directions } from '../document';
import { html, svg, unseen } from '../dom';
import { titleOf, type Pair, type Sweep } from './curves';

const [width, height] = [44, 22];

function sparkline(omega: Float64Array, values: number[]): SVGElement {
  const logs = values.map((value) => Math.log(Math.max(value, 1e-300)));
  const low = Math.min(...logs);
  const high = Math.max(...logs);
  const points = logs.map((value, i) => {
    const x =
      (width * Math.log(omega[i] / omega[0])) / Math.log(omega[omega.length - 1] / omega[0]);
    const y = height - 2 - ((height - 4) * (value - low)) / (high - low || 1);
    return `${x.toFixed(1)},${y.toFixed(1)}`;
  });
  return svg(
    'svg',
    { viewBox: `0 0 ${width} ${height}`, 'aria-hidden': 'true', preserveAspectRatio: 'none' },
    svg('polyline', { points: points.join(' '), class: 'spark' }),
  );
}

export class Chooser {
  readonly element = html('table', { class: 'chooser' });
  private buttons: HTMLButtonElement[] = [];

  constructor(private readonly choose: (pair: Pair) => void) {
    this.element.addEventListener('keydown', (event) => this.key(event));
  }

  show(sweep: Sweep, chosen: Pair): void {
    this.buttons = [];
    const rows = directions.map((name, output) =>
      html(
        'tr',
        {},
        html('th', { scope: 'row' }, name),
        ...directions.map((_, input) => html('td', {}, this.cell(sweep, { output, input }))),
      ),
    );
    const head = directions.map((name, d) =>
      html('th', { scope: 'col' }, d < 3 ? `F${name}` : `M${name[1]}`),
    );
    this.element.replaceChildren(
      html('caption', {}, 'Motion (rows) per force or moment (columns)'),
      html('thead', {}, html('tr', {}, html('td', {}), ...head)),
      html('tbody', {}, ...rows),
    );
    this.mark(chosen);
  }

  private cell(sweep: Sweep, pair: Pair): HTMLButtonElement {
    const coupled = sweep.isCoupled(pair);
    const control = html('button', {
      type: 'button',
      onclick: () => this.choose(pair),
      'data-pair': `${pair.output},${pair.input}`,
      class: coupled ? '' : 'uncoupled',
    });
    control.append(
      coupled ? sparkline(sweep.omega, sweep.magnitudes(pair)) : html('span', { 'aria-hidden': 'true' }, '·'),
    );
    control.append(unseen(titleOf(pair) + (coupled ? '' : ', not coupled')));
    this.buttons.push(control);
    return control;
  }

  /** Arrow keys move within the table; one button is in the tab order. */
  private key(event: KeyboardEvent): void {
    const steps: Record<string, number> = {
      ArrowLeft: -1,
      ArrowRight: 1,
      ArrowUp: -6,
      ArrowDown: 6,
    };
    const step = steps[event.key];
    const at = this.buttons.indexOf(document.activeElement as HTMLButtonElement);
    if (step === undefined || at < 0) return;
    event.preventDefault();
    const next = this.buttons[(at + step + 36) % 36];
    next.focus();
    next.click();
  }

  mark(chosen: Pair): void {
    this.buttons.forEach((control, i) => {
      const pressed = i === 6 * chosen.output + chosen.input;
      control.setAttribute('aria-pressed', String(pressed));
      control.tabIndex = pressed ? 0 : -1;
    });
  }
}
