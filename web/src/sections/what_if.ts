// What if: sliders on every number of the machine, calculated here by the library's own mechanics.

import type { Brief, Buckling, Core, Setting } from '../core/core';
import { assignments, displacementIn, Edits, fragmentOf, fromFragment, holdsState, noCommand, settings, shellCommand, type Values } from '../core/edits';
import { beginWhenSeen, failureText, sharedCore, touch } from '../core/shared';
import { directions, type Editable, type PoseReport } from '../document';
import { button, html, showCommand } from '../dom';
import type { State } from '../state';
import { refill, scroller } from '../table';
import { ParameterList } from '../whatif/list';
import { quantity, unitOf } from '../whatif/quantity';
import { bucklingText, magnitudes, resultTable, SmallBode, type Curve } from '../whatif/results';
import type { Section } from './section';

export const whatIf: Section = {
  id: 'what-if',
  title: 'What if',
  applies: (report) => report.editable !== undefined && report.poses.length > 0,
  render: (state, host) => {
    new WhatIf(state, host);
  },
};

/** More than the diagram has pixels. */
const lineCount = 1000;
/** After the last change, until what takes longer is done [ms]. */
const rest = 150;

/** A machine, with the values that differ from the report's, at a pose. */
interface Side {
  values: Values;
  displaced: number[] | null;
  computed: Brief;
  buckling: Buckling | null;
}

class WhatIf {
  private core: Core | null = null;
  private list: ParameterList | null = null;
  /** Of the value that was typed last. */
  private judged: Promise<string> | null = null;
  private readonly base = new Map<string, number>();
  private readonly edits = new Edits((path) => this.base.get(path));
  /** What is compared with. */
  private a: Side | null = null;
  private b: Side | null = null;
  private running: Promise<void> | null = null;
  /** Until A and B are at the chosen pose. */
  private placed: Promise<void> = Promise.resolve();
  private timer = 0;
  private direction = 0;
  private readonly omega: Float64Array;
  private readonly ready: () => Promise<void>;

  private readonly parameters = html('div', { class: 'what-if-parameters' }, html('p', { class: 'note' }, 'The parameters are read …'));
  private readonly state_ = html('p', { class: 'what-if-state', 'aria-live': 'polite' });
  private readonly table = scroller('Results');
  private readonly buckling = html('p', { class: 'note' });
  private readonly plot = new SmallBode();
  private readonly commandLine = html('pre', { class: 'what-if-command', tabindex: 0, role: 'region', 'aria-label': 'Command of B' });
  private readonly undoButton = button('Undo', () => this.edits.undo(), { 'data-control': 'undo' });
  private readonly redoButton = button('Redo', () => this.edits.redo(), { 'data-control': 'redo' });

  constructor(
    private readonly state: State,
    host: HTMLElement,
  ) {
    this.omega = grid(state.stated);
    this.direction = Math.max(0, directions.indexOf((state.pose.answer?.directions.split(' ')[0] ?? 'x') as 'x'));
    const where = state.report.studio ? 'Other pages of this studio show the same values.' : 'Nothing leaves the page.';
    host.append(
      html(
        'p',
        { class: 'note' },
        `Change a value: this page calculates modes, energies, the Bode diagram and the picture anew, with the mechanics of hydrapod itself. ${where}`,
      ),
      html(
        'div',
        { class: 'what-if' },
        this.parameters,
        html(
          'div',
          { class: 'what-if-outcome', role: 'group', 'aria-label': 'Results' },
          this.tools(),
          this.state_,
          this.table,
          this.buckling,
          this.directionChooser(),
          this.plot.element,
          legend(this.state.pose.model),
          html('p', { class: 'note' }, 'The command that computes B:'),
          this.commandLine,
        ),
      ),
    );
    this.ready = beginWhenSeen(host, () => this.start(), (words) => this.parameters.replaceChildren(failureText(words)));
    this.offerHook();
    const wanted = () => holdsState(location.hash) && void this.ready();
    wanted();
    addEventListener('hashchange', wanted);
    this.state.listen((change) => change === 'displaced' && void this.ready());
  }

  private get editable(): Editable {
    return this.state.report.editable as Editable;
  }

  private async start(): Promise<void> {
    this.core = await sharedCore(this.state);
    for (const { path, value } of this.core.parameters) this.base.set(path, value);
    this.list = new ParameterList(this.editable, this.core.parameters, this.edits, (path, value) => (this.judged = this.judge(path, value)));
    this.parameters.replaceChildren(this.list.element);
    this.edits.onChange = () => this.changed();
    addEventListener('hashchange', () => this.takeFragment());
    addEventListener('keydown', (event) => this.key(event));
    this.state.listen((change) => {
      if (change === 'pose') this.placed = this.newPose();
      if (change === 'displaced') void this.update();
    });
    const given = fromFragment(location.hash, (path) => this.base.get(path));
    const displaced = displacementIn(location.hash);
    await this.newPose();
    if (given.size > 0) this.edits.replace(given);
    if (displaced) this.state.displace(displaced);
    void this.core.sensitivities(this.state.poseNumber).then((slopes) => this.list?.order(slopes));
  }

  /** A is the machine of the report at the pose that is shown; B has the changed values. */
  private async newPose(): Promise<void> {
    this.a = this.b = null; // what is being calculated for another pose is not shown any more
    this.omega.set(grid(this.state.stated));
    const computed = await this.compute(new Map(), null);
    this.a = { values: new Map(), displaced: null, computed, buckling: null };
    this.b = this.a;
    await this.update();
  }

  private place(displaced: number[] | null) {
    return { pose: this.state.poseNumber, ...(displaced ? { displaced } : {}) };
  }

  private compute(values: Values, displaced: number[] | null): Promise<Brief> {
    touch();
    // what the rest of the page shows follows in settle()
    return (this.core as Core).brief({ set: settings(values), ...this.place(displaced) }, this.omega);
  }

  /** In words what the core finds wrong with a value that was typed, and with nothing else. */
  private async judge(path: string, value: number): Promise<string> {
    const find = async (values: Values) => {
      const { findings } = await (this.core as Core).brief({ set: settings(values), ...this.place(this.state.displaced) });
      return findings.filter(({ error }) => error).map(({ key, message }) => `${key}: ${message}`);
    };
    const found = await find(new Map(this.edits.values).set(path, value));
    const before = found.length > 0 ? await find(this.edits.values) : [];
    return found.filter((text) => !before.includes(text)).join('; ');
  }

  /** Are the values and the pose of `side` those that were chosen last? */
  private isNewest(side: Side | null): boolean {
    return side?.values === this.edits.values && side.displaced === this.state.displaced;
  }

  private changed(): void {
    this.list?.show();
    this.undoButton.disabled = !this.edits.canUndo;
    this.redoButton.disabled = !this.edits.canRedo;
    void this.update();
  }

  /** One calculation at a time, always of the newest values. */
  private update(): Promise<void> {
    this.running ??= (async () => {
      try {
        while (!this.isNewest(this.b)) {
          const { values } = this.edits;
          const { displaced } = this.state;
          this.b = { values, displaced, computed: await this.compute(values, displaced), buckling: null };
          this.show();
        }
        this.show();
      } finally {
        this.running = null;
      }
      clearTimeout(this.timer);
      this.timer = window.setTimeout(() => void this.settle(), rest);
    })();
    return this.running;
  }

  /** What takes longer: the rest of the page, buckling, the address. */
  private async settle(): Promise<void> {
    const { a, b } = this;
    if (!a || !b || !this.isNewest(b)) return;
    if (b.computed.pose) {
      const points = this.state.stated.bode?.points ?? 0;
      const request = { set: settings(b.values), ...this.place(b.displaced), points };
      const isOther = b.values.size > 0 || b.displaced !== null;
      const pose = isOther ? (await (this.core as Core).compute(request)).pose : null;
      if (this.b !== b) return;
      this.state.values = settings(b.values);
      this.state.changes = this.changes(b.values);
      this.state.showOther(pose ?? null);
      this.state.onValues?.(settings(b.values), assignments(b.values, this.core?.parameters ?? []));
    }
    const hash = fragmentOf(b.values, b.displaced);
    if (hash || holdsState(location.hash))
      history.replaceState(null, '', hash ? `#${hash}` : location.href.split('#')[0]);
    for (const side of new Set([a, b]))
      if (!side.buckling && side.computed.pose)
        side.buckling = await (this.core as Core).buckling({ set: settings(side.values), ...this.place(side.displaced) });
    if (this.b === b) this.showBuckling();
  }

  /** In words, beside the values of the report. */
  private changes(values: Values): string[] {
    return (this.core?.parameters ?? []).flatMap((parameter) => {
      const value = values.get(parameter.path);
      const unit = unitOf(this.editable, parameter);
      const [now, before] = [value ?? 0, parameter.value].map((one) => quantity(one, unit));
      return value === undefined ? [] : [`${parameter.path} ${now} (report: ${before})`];
    });
  }

  private show(): void {
    const { a, b } = this;
    if (!a || !b) return;
    const { findings, problem, pose } = b.computed;
    const words = findings.filter((finding) => finding.error || !pose);
    const text = problem ?? words.map((finding) => `${finding.key}: ${finding.message}`).join('; ');
    const count = b.values.size;
    this.state_.classList.toggle('problem', text !== '');
    this.state_.textContent = text
      ? `Not computed: ${text}. The rest of the page shows the last values that a machine can have.`
      : count === 0 && !b.displaced
        ? 'B is the machine of this report. Change a value.'
        : `B: ${count} changed value${count === 1 ? '' : 's'}${b.displaced ? `, at the pose ${pose?.pose.name ?? ''}` : ''}. The whole page shows B.`;
    const warnings = findings.filter((finding) => !finding.error);
    if (!text && count > 0 && warnings.length > 0)
      this.state_.textContent += ` Warning: ${warnings.map((w) => `${w.key}: ${w.message}`).join('; ')}.`;
    refill(this.table, resultTable(a.computed.pose ?? null, pose ?? null));
    this.showBuckling();
    this.showCurves();
    showCommand(this.commandLine, this.command());
  }

  private showBuckling(): void {
    const { a, b } = this;
    if (!a || !b) return;
    const of = (side: typeof a) => (side.computed.pose ? bucklingText(side.buckling) : 'not computed');
    this.buckling.textContent = b === a ? `Buckling: ${of(b)}.` : `Buckling: B: ${of(b)}. A: ${of(a)}.`;
  }

  private showCurves(): void {
    const { a, b, omega, direction } = this;
    if (!a || !b) return;
    const curve = (kind: Curve['kind'], computed: Brief): Curve => ({
      kind,
      omega,
      size: magnitudes(computed, lineCount, direction, kind === 'rigid'),
    });
    const curves = [curve('rigid', b.computed), curve('before', a.computed), curve('now', b.computed)];
    const name = directions[direction];
    const unit = direction < 3 ? 'm/N' : 'rad/(N m)';
    this.plot.show(b === a ? [curves[0]!, curves[2]!] : curves, `Motion in ${name} per force or moment in ${name}`, unit);
  }

  private tools(): HTMLElement {
    this.undoButton.disabled = this.redoButton.disabled = true;
    const group = (label: string, ...buttons: HTMLElement[]) =>
      html('div', { class: 'group', role: 'group', 'aria-label': label }, ...buttons);
    return html(
      'div',
      { class: 'row what-if-tools' },
      group('History', this.undoButton, this.redoButton, button('Reset all', () => this.edits.replace(new Map()), { 'data-control': 'reset-all' })),
      group(
        'Comparison',
        button('Keep B as A', () => this.keepAsA(), { 'data-control': 'keep-as-a' }),
        button('Swap A and B', () => this.swap(), { 'data-control': 'swap' }),
      ),
    );
  }

  private keepAsA(): void {
    if (!this.b?.computed.pose) return;
    this.a = this.b;
    this.show();
  }

  private swap(): void {
    const { a, b } = this;
    if (!a || !b?.computed.pose) return;
    this.a = b;
    if (a.displaced !== b.displaced) this.state.displace(a.displaced);
    this.edits.replace(a.values);
  }

  private directionChooser(): HTMLElement {
    const buttons = directions.map((name, d) =>
      button(name, () => {
        this.direction = d;
        mark();
        this.showCurves();
      }, { 'data-direction': name }),
    );
    const mark = () => buttons.forEach((b, d) => b.setAttribute('aria-pressed', String(d === this.direction)));
    mark();
    return html('div', { class: 'group directions', role: 'group', 'aria-label': 'Direction of the Bode diagram' }, html('span', { 'aria-hidden': 'true' }, 'Bode diagram'), ...buttons);
  }

  private command(): string {
    const { report, stated } = this.state;
    const { overrides, model } = this.editable;
    if (!overrides) return noCommand;
    const changed = assignments(this.edits.values, this.core?.parameters ?? []);
    return shellCommand([
      'hydrapod',
      'modes',
      report.machine.file,
      '--pose',
      (this.b?.displaced && this.b.computed.pose?.pose.name) || stated.pose.name,
      '--model',
      model,
      ...[...overrides, ...changed].flatMap((text) => ['--set', text]),
    ]);
  }

  private takeFragment(): void {
    const { hash } = location;
    if (holdsState(hash)) {
      this.edits.replace(fromFragment(hash, (path) => this.base.get(path)));
      this.state.displace(displacementIn(hash));
      return;
    }
    const own = fragmentOf(this.edits.values, this.state.displaced);
    // a link to a section was followed; the address keeps what is shown
    if (own) history.replaceState(null, '', `#${own}`);
  }

  private key(event: KeyboardEvent): void {
    const typing = event.target instanceof HTMLInputElement && event.target.type !== 'range';
    if (typing || !(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    if (key !== 'z' && key !== 'y') return;
    event.preventDefault();
    if (key === 'y' || event.shiftKey) this.edits.redo();
    else this.edits.undo();
  }

  private offerHook(): void {
    const { ready } = this;
    window.hydrapod.whatIf = {
      get ready() {
        return ready();
      },
      drag: (path: string, value: number) => this.edits.drag(path, value),
      keep: () => this.edits.keep(),
      undo: () => this.edits.undo(),
      redo: () => this.edits.redo(),
      changed: (): Setting[] => settings(this.edits.values),
      replace: (set: Setting[]) => this.edits.replace(new Map(set)),
      shown: async () => {
        await this.judged;
        await this.placed;
        while (this.running) await this.running;
        clearTimeout(this.timer);
        await this.settle();
      },
      compute: (set: Setting[], omega?: Float64Array) =>
        (this.core as Core).compute({ set, pose: this.state.poseNumber }, omega),
      values: () => Object.fromEntries(this.base),
      overrides: (set: Setting[]) => assignments(new Map(set), this.core?.parameters ?? []),
      command: () => this.command(),
    };
  }
}

/** Evenly spaced on a logarithmic axis over the band of the report's Bode diagram [rad/s]. */
function grid(pose: PoseReport): Float64Array {
  const [from, to] = [pose.bode?.from_rad_s ?? 1, pose.bode?.to_rad_s ?? 1000];
  return Float64Array.from({ length: lineCount }, (_, k) => from * (to / from) ** (k / (lineCount - 1)));
}

function legend(model: PoseReport['model']): HTMLElement {
  const item = (kind: string, text: string) => html('li', {}, html('i', { class: `line line-${kind}` }), text);
  const legs = model === 'rigid' ? 'rigid legs' : 'flexible legs';
  const rigid = model === 'rigid' ? [] : [item('rigid', 'B, rigid legs')];
  return html('ul', { class: 'legend' }, item('flexible', `B, ${legs}`), item('before', `A, ${legs}`), ...rigid);
}
