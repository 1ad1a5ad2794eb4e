// Workspace: a map of modes over two directions of the pose, calculated here. The cross is the pose at
// which the whole page shows the machine.

import { map, mapStatus, type Core } from '../core/core';
import { assignments, noCommand, shellCommand } from '../core/edits';
import { beginWhenSeen, failureText, idle, sharedCore, whenIdle } from '../core/shared';
import { directions, type Editable } from '../document';
import { button, html, identifier, notReady, showCommand, slider, type Slider } from '../dom';
import { fixed } from '../numbers';
import type { State } from '../state';
import { displacementOf } from '../workspace/displacement';
import { Field, finest, type Range } from '../workspace/field';
import { HeatMap } from '../workspace/heat_map';
import { displacementText, nameOf, poseText, quantities, unitOf } from '../workspace/quantities';
import type { Section } from './section';

export const workspace: Section = {
  id: 'workspace',
  title: 'Workspace',
  of: 'shown',
  applies: (report) => report.editable !== undefined && report.poses.length > 0,
  render: (state, host) => {
    new Workspace(state, host);
  },
};

/** As it is shown, so that a command can name it. */
const rounded = (value: number, direction: number): number => {
  const size = unitOf(direction)[1];
  return Number((value / size).toFixed(direction < 3 ? 1 : 2)) * size;
};

/** Towards zero, to a tenth of a millimetre or a hundredth of a degree. */
function inwards(value: number, direction: number): number {
  const step = unitOf(direction)[1] / (direction < 3 ? 10 : 100);
  return Math.trunc(value / step) * step;
}

class Workspace {
  private core: Core | null = null;
  /** The values of the machine that the map is of. */
  private set: State['values'] | null = null;
  private readonly ready: () => Promise<void>;
  private ranges: Range[] = [];
  private field: Field | null = null;
  /** Where the map is in the other directions. */
  private fixed: readonly number[] = [];
  private filling: Promise<void> | null = null;
  private across = 0;
  private up = 2;
  private quantity = quantities[0]!;
  private sliders: Slider[] = [];
  /** While the cross is dragged, nothing else is calculated. */
  private released: Promise<void> = Promise.resolve();
  private release: () => void = () => {};

  private readonly poses = html('div', { class: 'workspace-poses', role: 'group', 'aria-label': 'Pose' });
  private readonly words = html('p', { class: 'workspace-words', 'aria-live': 'polite' });
  private readonly least = html('p', { class: 'note' });
  private readonly commandLine = html('pre', { class: 'what-if-command', tabindex: 0, role: 'region', 'aria-label': 'Command of the map' });
  private readonly picture = new HeatMap(
    (across, up) => this.drag(across, up),
    () => this.release(),
  );

  constructor(
    private readonly state: State,
    private readonly host: HTMLElement,
  ) {
    host.append(
      html('p', { class: 'note' }, 'Each cell is a pose, calculated here. Drag the cross or a slider: the whole page shows the machine at that pose. The other four directions stay where their sliders are.'),
      html(
        'div',
        { class: 'workspace' },
        html('div', {}, this.choosers(), this.picture.element),
        html('div', {}, this.words, this.poses, this.least, html('p', { class: 'note' }, 'The command of this map:'), this.commandLine),
      ),
    );
    host.append(notReady('The map'));
    state.listen((change) => this.heard(change));
    this.ready = beginWhenSeen(host, () => this.start(), (words) => host.append(failureText(words)));
    whenIdle(() => void this.ready().catch(() => {})); // a print has the map wherever the reader is
    this.offerHook();
  }

  private get displaced(): readonly number[] {
    return this.state.displaced ?? displacementOf(this.state.report.editable as Editable, this.state.poseNumber);
  }

  private async start(): Promise<void> {
    this.core = await sharedCore(this.state);
    await this.measure();
    this.calculate();
  }

  private heard(change: string): void {
    if (!this.core) return;
    if (change === 'displaced' || change === 'pose') this.follow();
    if (change === 'pose' || (change === 'numbers' && JSON.stringify(this.set) !== JSON.stringify(this.state.values)))
      void this.measure().then(() => this.calculate());
    if (change === 'numbers') this.showWords();
  }

  /** How far each direction goes: new sliders. */
  private async measure(): Promise<void> {
    this.set = this.state.values;
    this.host.classList.remove('calculated');
    const reach = await (this.core as Core).reach(this.set);
    this.ranges = reach.map(([least, most], d) => [inwards(least, d), inwards(most, d)]);
    this.sliders = directions.map((name, d) => {
      const [least, most] = this.ranges[d]!;
      const from = Math.min(least, this.displaced[d]!);
      const to = Math.max(most, this.displaced[d]!);
      const made = slider(
        name,
        { min: from, max: to, step: (to - from) / 1000 || 1, value: this.displaced[d]! },
        (value) => displacementText(d, value),
        (value) => this.move(d, Math.abs(value) < (to - from) / 1000 ? 0 : rounded(value, d)),
        `pose-${name}`,
      );
      made.input.disabled = to === from;
      return made;
    });
    this.poses.replaceChildren(
      ...this.sliders.map(({ element }) => element),
      html('div', { class: 'row' }, button('Back to the pose of the report', () => this.state.displace(null), { 'data-control': 'pose-reset' })),
    );
  }

  private move(direction: number, value: number): void {
    const displaced = [...this.displaced];
    displaced[direction] = value;
    this.state.displace(displaced);
    if (direction !== this.across && direction !== this.up) this.calculate();
  }

  private drag(across: number, up: number): void {
    this.released = new Promise((resolve) => (this.release = resolve));
    const displaced = [...this.displaced];
    displaced[this.across] = rounded(across, this.across);
    displaced[this.up] = rounded(up, this.up);
    this.state.displace(displaced);
  }

  /** The cross and the sliders go where the page is. */
  private follow(): void {
    const { displaced } = this;
    this.sliders.forEach(({ input, element }, d) => {
      input.value = String(displaced[d]);
      const output = element.querySelector('output');
      if (output) output.textContent = displacementText(d, displaced[d]!);
      input.setAttribute('aria-valuetext', displacementText(d, displaced[d]!));
    });
    this.picture.mark(displaced);
    const changed = this.field && directions.some((_, d) => d !== this.across && d !== this.up && this.fixed[d] !== displaced[d]);
    if (changed) this.calculate();
    this.showWords();
  }

  private calculate(): void {
    if (!this.core || !this.set) return;
    this.field?.stop();
    this.fixed = [...this.displaced];
    const field = new Field(this.core, this.set, this.across, this.up, this.ranges, this.fixed);
    this.field = field;
    this.host.classList.remove('calculated');
    this.filling = field.fill(
      () => this.show(),
      () => this.released.then(idle),
    );
    void this.showCommand();
    this.showWords();
  }

  private show(): void {
    const { field, quantity } = this;
    if (!field || field.count === 0) return;
    this.host.classList.add('calculated');
    this.picture.show(field, quantity, `${nameOf(quantity, this.state.report.editable as Editable)} over ${directions[this.across]} and ${directions[this.up]}; the line below says where it is least`);
    this.picture.mark(this.displaced);
    const least = this.picture.least(quantity);
    this.least.replaceChildren(
      ...(least
        ? [`Least on this map: ${least.text}. `, button('Go there', () => this.goTo(least.displaced), { 'data-control': 'go-to-least' })]
        : ['No pose of this map has a value.']),
    );
  }

  private goTo([across, up]: [number, number]): void {
    const displaced = [...this.displaced];
    [displaced[this.across], displaced[this.up]] = [across, up];
    this.state.displace(displaced);
  }

  private showWords(): void {
    const place = poseText(this.displaced);
    this.words.replaceChildren(html('strong', {}, place === 'neutral' ? 'At the neutral pose' : `At ${place}`));
    const displaced = Float64Array.from(this.displaced);
    void this.core?.map(this.set ?? [], displaced).then((row) => {
      if (place !== poseText(this.displaced)) return;
      const status = row[map.status] as number;
      const value = (name: string) => quantities.find(({ column }) => column === name)!.of(row);
      // a drop says little without what the mode holds of the motion and how high its peak is
      const drop = (of: string, motion: string) =>
        `, drop ${fixed(value('drop' + of), 2)} % (${fixed(value('share' + of), 0)} % of the motion ${motion}, peak ${fixed(value('peak' + of), 2)} times as high)`;
      const d = /r?[xyz]$/.exec(this.quantity.column)?.[0];
      const text = status !== 0
        ? `: ${mapStatus[status]}.`
        : `: lowest mode ${value('lowest').toFixed(3)} Hz (${(this.state.report.editable as Editable).frequencies}) in ${directions[(row[map.direction] as number) - 1]}${drop('', 'with rigid legs')}${d && value(d) ? `; first resonance in ${d} ${value(d).toFixed(3)} Hz${drop(`_${d}`, `in ${d}`)}` : ''}${Number.isFinite(value('stroke')) ? `, stroke left ${value('stroke').toFixed(1)} mm` : ''}.`;
      this.words.replaceChildren(this.words.firstChild as Node, text);
    });
  }

  /** Modes are followed from the pose of the command: it must have some. */
  private async showCommand(): Promise<void> {
    const other = this.fixed.map((value, d) => (d === this.across || d === this.up ? 0 : value));
    const row = await (this.core as Core).map(this.set ?? [], Float64Array.from(other));
    if (row[map.status] === 0) this.showCommandFrom(other);
    else showCommand(this.commandLine, `No command has this map: at the pose ${poseText(other)} there are no modes to follow (${mapStatus[row[map.status] as number]}).`);
  }

  private showCommandFrom(other: number[]): void {
    const { report } = this.state;
    const { overrides, model } = report.editable as Editable;
    const turns = directions.filter((_, d) => d > 2 && (d === this.across || d === this.up || other[d] !== 0)).length;
    if (!overrides || (turns > 1 && other.slice(3).some((value) => value !== 0))) {
      const none = overrides
        ? 'hydrapod map counts rotations from the pose of --pose: no command has this slice.'
        : noCommand;
      showCommand(this.commandLine, none);
      return;
    }
    const over = [this.across, this.up].flatMap((d) => {
      const [unit, size] = unitOf(d);
      const [from, to] = this.ranges[d]!.map((value) => Number((value / size).toPrecision(12)));
      return ['--over', `${directions[d]}=${from}:${to}:${finest} ${unit}`];
    });
    const pose = poseText(other);
    const changed = assignments(new Map(this.set ?? []), this.core?.parameters ?? []);
    const words = [
      'hydrapod', 'map', report.machine.file, ...(pose === 'neutral' ? [] : ['--pose', pose]), '--model', model, ...over,
      ...[...overrides, ...changed].flatMap((text) => ['--set', text]), '--plot', 'map.svg', '--value', this.quantity.column,
    ];
    showCommand(this.commandLine, shellCommand(words));
  }

  private choosers(): HTMLElement {
    const chooser = (label: string, names: string[], chosen: number, choose: (k: number) => void, name: string) => {
      const id = identifier('workspace');
      const list = html('select', { id, 'data-control': name }, ...names.map((text, k) => html('option', { value: k, selected: k === chosen }, text)));
      list.addEventListener('change', () => choose(Number(list.value)));
      return { list, element: html('div', { class: 'field' }, html('label', { for: id }, label), list) };
    };
    const names = [...directions];
    // a direction that is taken already changes places with the other one
    const across = chooser('Across', names, this.across, (d) => this.turn(d, d === this.up ? this.across : this.up), 'map-across');
    const up = chooser('Up', names, this.up, (d) => this.turn(d === this.across ? this.up : this.across, d), 'map-up');
    this.showTurn = () => {
      across.list.value = String(this.across);
      up.list.value = String(this.up);
    };
    const value = chooser('Value shown', quantities.map((one) => nameOf(one, this.state.report.editable as Editable)), 0, (k) => {
      this.quantity = quantities[k]!;
      this.show();
      this.showWords();
      void this.showCommand();
    }, 'map-value');
    return html('div', { class: 'row fields-row workspace-choosers' }, value.element, across.element, up.element);
  }

  private showTurn: () => void = () => {};

  private turn(across: number, up: number): void {
    [this.across, this.up] = [across, up];
    this.showTurn();
    this.calculate();
  }

  private offerHook(): void {
    const { ready } = this;
    window.hydrapod.workspace = {
      get ready() {
        return ready();
      },
      displace: (displaced) => this.state.displace(displaced),
      complete: async () => {
        while (this.field && this.field.count < finest) await this.filling;
      },
      rows: () => {
        const { field } = this;
        if (!field) return [];
        return Array.from({ length: field.count ** 2 }, (_, k) => {
          const [i, j] = [k % field.count, Math.floor(k / field.count)];
          return { across: field.at(field.across, i, field.count), up: field.at(field.up, j, field.count), row: [...field.row(i, j)] };
        });
      },
      command: () => this.commandLine.textContent ?? '',
    };
  }
}
