// Scatter: what deviations of parameters do to the modes. The samples are those of `hydrapod montecarlo`.

import { map, mapStatus, type Core, type Parameter, type Scatter as Request } from '../core/core';
import { assignments, noCommand, shellCommand } from '../core/edits';
import { beginWhenSeen, failureText, idle, sharedCore } from '../core/shared';
import type { Editable } from '../document';
import { button, html, identifier, onNewWidth, showCommand } from '../dom';
import { fixed, significant } from '../numbers';
import { describe, histogram } from '../scatter/distribution';
import type { State } from '../state';
import { displacementOf } from '../workspace/displacement';
import { nameOf, poseText, quantities } from '../workspace/quantities';
import { refill, scroller, tableHead } from '../table';
import type { Section } from './section';

export const scatter: Section = {
  id: 'scatter',
  title: 'Scatter',
  applies: (report) => report.editable !== undefined && report.poses.length > 0,
  render: (state, host) => {
    new Scatter(state, host);
  },
};

const samples = 1000;
/** So few that a slider never waits for long. */
const atOnce = 10;
const seed = 1;
/** Parameters that vary at first: no lengths, and of the others those that change the lowest frequency most. */
const first = 3;
const usual = 0.1;

type Varied = Request['vary'][number];

/** As the command line: four standard deviations must be numbers that the machine can have. */
function forbidden({ value, bound }: Parameter, share: number): string | null {
  if (!(share > 0 && share <= 1)) return 'expected more than 0 and at most 100 %';
  const reach = 4 * share * Math.abs(value);
  const [low, high] = [value - reach, value + reach];
  const beyond = low < (bound.lowest ?? -Infinity) ? low : high > (bound.highest ?? Infinity) ? high : null;
  return beyond === null ? null : `four standard deviations reach ${Number(beyond.toPrecision(4))}, which the machine cannot have`;
}

const isOfLegs = (path: string): boolean => path.startsWith('legs.');

class Scatter {
  private core: Core | null = null;
  private readonly ready: () => Promise<void>;
  private running: Promise<void> | null = null;
  private again = false;
  private varied: Varied[] = [];
  private choices: Parameter[] = [];
  private rows: Float64Array[] = [];
  private request: Omit<Request, 'from' | 'count'> | null = null;
  private quantity = quantities[0]!;
  private bound: number | null = null;
  private atLeast = true;

  private readonly list = html('ul', { class: 'scatter-list', 'aria-label': 'Parameters that vary' });
  private readonly count = html('p', { class: 'note', 'aria-live': 'polite' });
  private readonly picture = html('div', {});
  private readonly table = scroller('Distribution');
  private readonly verdict = html('p', {});
  private readonly commandLine = html('pre', { class: 'what-if-command', tabindex: 0, role: 'region', 'aria-label': 'Command of the samples' });

  constructor(
    private readonly state: State,
    host: HTMLElement,
  ) {
    host.append(
      html('p', { class: 'note' }, `${samples} machines whose parameters deviate, normally distributed about the values shown on this page, at the pose that is shown.`),
      html(
        'div',
        { class: 'scatter' },
        html('div', {}, html('h3', {}, 'Standard deviations'), this.list, this.adder(), this.chooser()),
        html('div', {}, this.count, this.picture, this.table, this.verdict, html('p', { class: 'note' }, 'The command of these samples:'), this.commandLine),
      ),
    );
    state.listen((change) => (change === 'numbers' || change === 'pose') && this.core && this.calculate());
    this.ready = beginWhenSeen(host, () => this.start(), (words) => host.append(failureText(words)));
    onNewWidth(this.picture, () => this.rows.length > 0 && this.show());
    this.offerHook();
  }

  private async start(): Promise<void> {
    const core = await sharedCore(this.state);
    this.core = core;
    this.choices = core.parameters.filter(({ path, value, mechanics, single }) => mechanics && value !== 0 && !single && !path.startsWith('poses.'));
    const slopes = await core.sensitivities(this.state.poseNumber);
    const scattering = this.choices.filter((one) => one.unit !== 'm' && one.unit !== 'rad' && !one.path.startsWith('environment.') && forbidden(one, usual) === null);
    const known = new Set(scattering.map(({ path }) => path));
    const largest = Object.keys(slopes).filter((path) => known.has(path)).sort((a, b) => Math.abs(slopes[b]!) - Math.abs(slopes[a]!));
    if (this.varied.length === 0) this.varied = largest.slice(0, first).map((path) => [path, usual, false]);
    this.options.replaceChildren(...this.choices.map(({ path }) => html('option', { value: path })));
    this.showList();
    this.calculate();
  }

  // ---- what varies -------------------------------------------------------------------------------

  private showList(): void {
    this.list.replaceChildren(...this.varied.map((one, k) => this.row(one, k)));
  }

  private row([path, share, perLeg]: Varied, k: number): HTMLElement {
    const id = identifier('deviation');
    const input = html('input', { type: 'text', inputmode: 'decimal', id, value: Number((100 * share).toPrecision(6)), 'data-deviation': path, autocomplete: 'off' });
    input.addEventListener('change', () => {
      const wanted = Number(input.value.replace(',', '.')) / 100;
      const parameter = this.choices.find((one) => one.path === path);
      const why = parameter ? forbidden(parameter, wanted) : null;
      input.setAttribute('aria-invalid', String(why !== null));
      problem.textContent = why ?? '';
      if (why === null) this.change(k, [path, wanted, perLeg]);
    });
    const problem = html('p', { class: 'problem', role: 'alert' });
    const each = html('input', { type: 'checkbox', checked: perLeg, 'data-per-leg': path });
    each.addEventListener('change', () => this.change(k, [path, share, each.checked]));
    return html(
      'li',
      {},
      html('label', { for: id }, html('code', {}, path)),
      html('span', { class: 'value' }, '± ', input, ' %'),
      isOfLegs(path) ? html('label', { class: 'check' }, each, 'each leg for itself') : html('span', {}),
      button('✕', () => this.remove(k), { class: 'quiet', 'aria-label': `${path} does not vary` }),
      problem,
    );
  }

  private change(k: number, one: Varied): void {
    this.varied = this.varied.map((other, n) => (n === k ? one : other));
    this.showList();
    this.calculate();
  }

  private remove(k: number): void {
    this.varied = this.varied.filter((_, n) => n !== k);
    this.showList();
    this.calculate();
  }

  private readonly options = html('datalist', { id: identifier('scatter-paths') });

  private adder(): HTMLElement {
    const id = identifier('scatter-path');
    const input = html('input', { type: 'text', id, list: this.options.id, placeholder: 'legs.rod.mass', 'data-control': 'scatter-path', autocomplete: 'off', spellcheck: 'false' });
    const problem = html('p', { class: 'problem', role: 'alert' });
    const form = html('form', { class: 'scatter-adder', novalidate: true }, html('label', { for: id }, 'Another parameter'), input, html('button', { type: 'submit' }, 'Add'), this.options, problem);
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      const path = input.value.trim();
      problem.textContent = '';
      if (this.varied.some(([other]) => other === path)) return;
      const parameter = this.choices.find((one) => one.path === path);
      if (!parameter) {
        problem.textContent = `${path || 'nothing'}: not a parameter of the linear models; the list has them`;
        return;
      }
      const share = [usual, usual / 10, usual / 100].find((one) => forbidden(parameter, one) === null);
      if (share === undefined) {
        problem.textContent = `${path}: it stands at the end of what the machine can have`;
        return;
      }
      this.varied = [...this.varied, [path, share, false]];
      input.value = '';
      this.showList();
      this.calculate();
    });
    return form;
  }

  private chooser(): HTMLElement {
    const [valueId, senseId, boundId] = ['scatter-value', 'scatter-sense', 'scatter-bound'].map(identifier) as [string, string, string];
    const value = html('select', { id: valueId, 'data-control': 'scatter-value' }, ...quantities.map((one, k) => html('option', { value: k }, nameOf(one, this.state.report.editable as Editable))));
    const sense = html('select', { id: senseId }, html('option', { value: 'least' }, 'at least'), html('option', { value: 'most' }, 'at most'));
    const bound = html('input', { type: 'text', inputmode: 'decimal', id: boundId, placeholder: 'none', 'data-control': 'scatter-bound', autocomplete: 'off' });
    const read = () => {
      this.quantity = quantities[Number(value.value)]!;
      this.atLeast = sense.value === 'least';
      const number = Number(bound.value.replace(',', '.'));
      this.bound = bound.value.trim() !== '' && Number.isFinite(number) ? number : null;
      this.show();
    };
    for (const control of [value, sense, bound]) control.addEventListener('change', read);
    const field = (id: string, label: string, control: HTMLElement) => html('div', { class: 'field' }, html('label', { for: id }, label), control);
    return html('div', { class: 'row fields-row' }, field(valueId, 'Value shown', value), field(senseId, 'Required', sense), field(boundId, 'Bound', bound));
  }

  // ---- samples -----------------------------------------------------------------------------------

  /** From the first sample on, of what is shown now. */
  private calculate(): void {
    this.again = true;
    this.running ??= this.run().finally(() => (this.running = null));
  }

  private async run(): Promise<void> {
    while (this.again) {
      this.again = false;
      const { values, poseNumber, displaced } = this.state;
      this.request = { set: values, pose: poseNumber, ...(displaced ? { displaced } : {}), vary: this.varied, seed };
      this.rows = [];
      void this.showCommand();
      for (let from = 0; from < samples && !this.again && this.varied.length > 0; from += atOnce) {
        await idle();
        if (this.again) break;
        const found = await (this.core as Core).scatter({ ...this.request, from, count: atOnce });
        for (let k = 0; k < atOnce; ++k) this.rows.push(found.subarray(k * map.columns, (k + 1) * map.columns));
        if (this.rows.length % 250 === 0) this.show();
      }
      this.show();
    }
  }

  private show(): void {
    const { rows, quantity, bound, atLeast } = this;
    const computed = rows.filter((row) => row[map.status] === 0);
    const reasons = mapStatus.slice(1).flatMap((name, k) => {
      const count = rows.filter((row) => row[map.status] === k + 1).length;
      return count > 0 ? [`${count} ${name}`] : [];
    });
    this.count.textContent = rows.length === 0
      ? 'Nothing varies: add a parameter.'
      : `${rows.length} of ${samples} samples${reasons.length > 0 ? `; without a value: ${reasons.join(', ')}` : ''}`;
    const values = computed.map((row) => quantity.of(row));
    this.picture.replaceChildren(histogram(values, `${nameOf(quantity, this.state.report.editable as Editable)}, in ${quantity.unit}`, bound, atLeast, this.picture.clientWidth));
    const found = describe(values);
    const cells: [string, number][] = found
      ? [['mean', found.mean], ['standard deviation', found.deviation], ['5 %', found.quantiles[0]], ['median', found.quantiles[1]], ['95 %', found.quantiles[2]]]
      : [];
    refill(
      this.table,
      html('table', { class: 'scatter-numbers' },
        tableHead(...cells.map(([name]): [string] => [name])),
        html('tbody', {}, html('tr', {}, ...cells.map(([, value]) => html('td', {}, `${significant(value, 5)} ${quantity.unit}`))))),
    );
    this.showVerdict();
  }

  /** A sample without a value misses the requirement. */
  private showVerdict(): void {
    const { rows, quantity, bound, atLeast } = this;
    this.verdict.textContent = '';
    if (bound === null || rows.length === 0) return;
    const meets = (row: Float64Array) => row[map.status] === 0 && (atLeast ? quantity.of(row) >= bound : quantity.of(row) <= bound);
    const missed = rows.filter((row) => !meets(row)).length;
    this.verdict.append(html('strong', {}, `${missed} of ${rows.length} samples miss the requirement`), `: ${fixed((100 * missed) / rows.length, 1)} %.`);
  }

  /** The command follows modes from the machine as it is shown: it must have some. */
  private async showCommand(): Promise<void> {
    const { report, poseNumber } = this.state;
    const { set, displaced, vary } = this.request!;
    const place = displaced ?? displacementOf(report.editable as Editable, poseNumber);
    const row = await (this.core as Core).map(set, Float64Array.from(place));
    const status = row[map.status] as number;
    const none = `No command has these samples: the machine that is shown has no modes to follow (${mapStatus[status]}).`;
    showCommand(this.commandLine, vary.length === 0 ? '' : status === 0 ? this.command() : none);
  }

  private command(): string {
    const { report, stated } = this.state;
    const { overrides, model } = report.editable as Editable;
    if (!overrides) return noCommand;
    const { set, displaced, vary } = this.request!;
    const changed = assignments(new Map(set), this.core?.parameters ?? []);
    return shellCommand([
      'hydrapod', 'montecarlo', report.machine.file, '--pose', displaced ? poseText(displaced) : stated.pose.name, '--model', model,
      ...vary.flatMap(([path, share, perLeg]) => ['--vary', `${path}=normal ± ${Number((100 * share).toPrecision(12))} %${perLeg ? ' per leg' : ''}`]),
      '--samples', String(samples), '--seed', String(seed), ...[...overrides, ...changed].flatMap((text) => ['--set', text]),
    ]);
  }

  private offerHook(): void {
    const { ready } = this;
    window.hydrapod.scatter = {
      get ready() {
        return ready();
      },
      vary: (given) => {
        this.varied = given;
        this.showList();
        this.calculate();
      },
      complete: async () => {
        while (this.running) await this.running;
      },
      rows: () => this.rows.map((row) => [...row]),
      command: () => this.command(),
    };
  }
}
