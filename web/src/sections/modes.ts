// The mode table: sortable, with bars; local seal modes are collapsed into one row.

import { energyParts, legend, motionParts, stackedBar } from '../bars';
import type { Mode, PoseReport } from '../document';
import { folded, repeated } from '../document';
import { button, html, unseen } from '../dom';
import { fixed, hertz, signedPercent } from '../numbers';
import type { State } from '../state';
import { scroller } from '../table';
import type { Section } from './section';

export const modes: Section = {
  id: 'modes',
  title: 'Modes',
  of: 'shown',
  applies: (report) => report.poses.some((pose) => pose.modes.length > 0),
  render,
};

interface Column {
  id: string;
  title: string;
  /** Spoken and shown on hover where the title is short. */
  long?: string;
  key(mode: Mode): number;
  cell(mode: Mode, pose: PoseReport): (Node | string)[];
  numeric: boolean;
  flexibleOnly?: boolean;
}

const legsShare = (mode: Mode) => mode.leg_energy.reduce((a, b) => a + b, 0);

const columns: Column[] = [
  {
    id: 'frequency',
    title: 'Hz',
    long: 'Hz: frequency in hertz',
    key: (mode) => mode.omega_rad_s,
    cell: (mode) => [mode.stable ? hertz(mode.frequency_hz) : 'unstable'],
    numeric: true,
  },
  {
    id: 'omega',
    title: 'rad/s',
    long: 'rad/s: angular frequency',
    key: (mode) => mode.omega_rad_s,
    cell: (mode) => [mode.stable ? fixed(mode.omega_rad_s, 2) : ''],
    numeric: true,
  },
  {
    id: 'damping',
    title: 'ζ',
    long: 'ζ: damping ratio',
    key: (mode) => mode.damping_ratio,
    cell: (mode) => [`${fixed(100 * mode.damping_ratio, 2)} %`],
    numeric: true,
  },
  {
    id: 'motion',
    title: 'Motion',
    long: 'Motion: shares of the kinetic energy',
    key: legsShare,
    cell: (mode) => [
      html('span', { class: 'mode-label' }, mode.label),
      stackedBar(motionParts(mode), 150),
    ],
    numeric: false,
  },
  {
    id: 'energy',
    title: 'Compliance',
    long: 'Compliance: shares of the elastic energy',
    key: (mode) => mode.strain_energy.oil,
    cell: (mode) => [stackedBar(energyParts(mode.strain_energy))],
    numeric: false,
  },
  {
    id: 'rigid',
    title: 'Rigid Hz',
    long: 'Rigid Hz: frequency of the rigid counterpart',
    key: (mode) => mode.rigid?.omega_rad_s ?? -1,
    cell: (mode) => [mode.rigid ? hertz(mode.rigid.omega_rad_s / (2 * Math.PI)) : ''],
    numeric: true,
    flexibleOnly: true,
  },
  {
    id: 'shift',
    title: 'Shift',
    long: 'Shift of the frequency relative to the rigid counterpart',
    key: (mode) => mode.rigid?.shift_percent ?? Number.POSITIVE_INFINITY,
    cell: (mode) => [mode.rigid && mode.stable ? signedPercent(mode.rigid.shift_percent) : ''],
    numeric: true,
    flexibleOnly: true,
  },
  {
    id: 'mac',
    title: 'MAC',
    long: 'MAC: share of the rigid counterpart in this mode (modal assurance criterion)',
    key: (mode) => mode.rigid?.mac ?? -1,
    cell: (mode) => [mode.rigid ? fixed(mode.rigid.mac, 2) : ''],
    numeric: true,
    flexibleOnly: true,
  },
];

class ModeTable {
  private column = 'number';
  private ascending = true;
  private open = false;
  private readonly head = html('thead');
  private readonly body = html('tbody');

  constructor(
    private readonly state: State,
    host: HTMLElement,
  ) {
    const caption = html(
      'caption',
      { class: 'unseen' },
      'Modes: the number of a mode shows its motion; column heads sort.',
    );
    const table = html('table', { class: 'modes sorted' }, caption, this.head, this.body);
    host.append(scroller('Mode table', table));
    state.listen((change) =>
      change === 'mode'
        ? this.markChosen()
        : (change === 'pose' || change === 'numbers') && this.show(),
    );
    this.show();
  }

  private get columns(): Column[] {
    return columns.filter((column) => !column.flexibleOnly || this.state.pose.model !== 'rigid');
  }

  private sorted(): Mode[] {
    const column = columns.find((c) => c.id === this.column);
    const key = column?.key ?? ((mode: Mode) => mode.number);
    const sign = this.ascending ? 1 : -1;
    return [...this.state.pose.modes].sort(
      (a, b) => sign * (key(a) - key(b)) || a.number - b.number,
    );
  }

  private sortBy(id: string): void {
    this.ascending = this.column === id ? !this.ascending : true;
    this.column = id;
    this.show();
    this.head.querySelector<HTMLButtonElement>(`[data-sort="${id}"]`)?.focus();
  }

  show(): void {
    const all = this.sorted();
    const hidden = all.filter(folded);
    this.head.replaceChildren(this.headRow());
    const rows = all.filter((mode) => !folded(mode)).map((mode) => this.row(mode));
    if (hidden.length > 0) {
      rows.push(this.foldRow(hidden));
      if (this.open) rows.push(...hidden.map((mode) => this.row(mode)));
    }
    this.body.replaceChildren(...rows);
    this.markChosen();
  }

  private headRow(): HTMLTableRowElement {
    const head = (id: string, title: string, long: string | undefined, kind: string) => {
      const sorted = this.column === id;
      const arrow = sorted ? (this.ascending ? ' ▲' : ' ▼') : '';
      const control = button(title, () => this.sortBy(id), { 'data-sort': id, title: long });
      if (long && long !== title) control.setAttribute('aria-label', long);
      control.append(html('span', { 'aria-hidden': 'true' }, arrow));
      return html(
        'th',
        {
          scope: 'col',
          class: kind,
          'data-title': title,
          'aria-sort': sorted ? (this.ascending ? 'ascending' : 'descending') : 'none',
        },
        control,
      );
    };
    return html(
      'tr',
      {},
      head('number', 'Mode', 'Mode number', ''),
      ...this.columns.map((c) =>
        head(c.id, c.title, c.long, `col-${c.id}${c.numeric ? ' numeric' : ''}`),
      ),
    );
  }

  private row(mode: Mode): HTMLTableRowElement {
    const { pose } = this.state;
    const choose = () => this.state.chooseMode(mode.number);
    const twins = repeated(pose.modes, mode).filter((other) => other !== mode);
    const control = button(String(mode.number), choose, {
      'data-mode': mode.number,
      class: 'mode-number',
    });
    const number = html('th', { scope: 'row' }, control);
    if (twins.length > 0) {
      const words = `repeats with ${twins.map((twin) => twin.number).join(', ')}`;
      number.append(
        html('span', { class: 'repeat', title: words, 'aria-hidden': 'true' }, '='),
        unseen(words),
      );
    }
    const row = html(
      'tr',
      { 'data-row': mode.number, class: folded(mode) ? 'seal' : '' },
      number,
      ...this.columns.map((c) =>
        html('td', { class: `col-${c.id}${c.numeric ? ' numeric' : ''}` }, ...c.cell(mode, pose)),
      ),
    );
    row.addEventListener('click', (event) => {
      if (!(event.target instanceof HTMLButtonElement)) choose();
    });
    return row;
  }

  private foldRow(hidden: Mode[]): HTMLTableRowElement {
    const frequencies = hidden.filter((mode) => mode.stable).map((mode) => mode.frequency_hz);
    const [low, high] = [Math.min(...frequencies), Math.max(...frequencies)];
    const unstable = hidden.length - frequencies.length;
    const stable =
      high - low < 5e-4 ? `at ${hertz(low)} Hz` : `from ${hertz(low)} to ${hertz(high)} Hz`;
    const parts = [frequencies.length > 0 ? stable : '', unstable > 0 ? `${unstable} unstable` : ''];
    const band = parts.filter(Boolean).join(', ');
    const many = hidden.length === 1 ? '1 local seal mode' : `${hidden.length} local seal modes`;
    const control = button(
      `${this.open ? '▾' : '▸'} ${many} (platform energy < 0.01 %), ${band}`,
      () => {
        this.open = !this.open;
        this.show();
        this.body.querySelector<HTMLButtonElement>('[data-control="fold"]')?.focus();
      },
      { 'aria-expanded': String(this.open), 'data-control': 'fold', class: 'fold' },
    );
    return html(
      'tr',
      { class: 'fold-row' },
      html('td', { colspan: this.columns.length + 1 }, control),
    );
  }

  markChosen(): void {
    const { number } = this.state.mode;
    for (const row of this.body.querySelectorAll<HTMLTableRowElement>('[data-row]')) {
      const chosen = row.dataset['row'] === String(number);
      row.classList.toggle('chosen', chosen);
      row.querySelector('.mode-number')?.setAttribute('aria-pressed', String(chosen));
    }
  }
}

function render(state: State, host: HTMLElement): void {
  new ModeTable(state, host);
  const sample = state.pose.modes[0];
  const { model } = state.pose;
  const isThere = ({ kind }: { kind: string }) => (kind === 'ring' ? model === 'full' : kind !== 'sleeve' || model !== 'rigid');
  if (sample)
    host.append(
      html(
        'div',
        { class: 'legend-line' },
        legend(motionParts(sample).filter(({ kind }) => kind !== 'legs' || model !== 'rigid')),
        legend(energyParts(sample.strain_energy).filter(isThere)),
      ),
    );
  host.append(
    html(
      'p',
      { class: 'note' },
      'Hz and rad/s: |λ| of the damped modes. = marks modes of equal frequency: any combination of them is a mode. ',
      model === 'rigid' ? '' : 'Shift and MAC compare with the most similar mode with rigid legs. ',
      'The elastic energy of oil, struts or screws includes compliant gimbals in series and sticking cylinder seals in parallel.',
    ),
  );
}
