// The diagnosis: measured modes with those of the rigid-leg model and of the best hypothesis, the
// ranking, the required stiffness. A click on a measured mode shows the machine moving in this mode.

import { energyParts, stackedBar } from '../bars';
import { Prediction } from '../diagnosis/prediction';
import { StiffnessPicture, stiffnessWords } from '../diagnosis/stiffness';
import type { Diagnosis, DiagnosedMode, Editable, Hypothesis } from '../document';
import { button, html } from '../dom';
import { hertz, plain, raised, signedPercent, withInterval } from '../numbers';
import type { State } from '../state';
import { scroller, tableHead } from '../table';
import type { Section } from './section';

export const diagnosis: Section = {
  id: 'diagnosis',
  title: 'Diagnosis',
  of: 'report',
  applies: (report) => report.diagnosis !== undefined,
  render,
};

/** The mode of the page's first pose whose frequency is closest to the fitted one of `mode`. */
function shownMode(state: State, mode: DiagnosedMode): number {
  let best = state.pose.modes[0];
  for (const candidate of state.pose.modes)
    if (
      best === undefined ||
      Math.abs(candidate.frequency_hz - mode.fitted_hz) <
        Math.abs(best.frequency_hz - mode.fitted_hz)
    )
      best = candidate;
  return best?.number ?? 1;
}

type Units = Editable['units'];

const cell = (text: string) => html('td', {}, text);

function measuredTable(state: State, found: Diagnosis): HTMLElement {
  const rows = (found.measured_modes ?? []).map((mode) => {
    const show = () => {
      state.chooseMode(shownMode(state, mode));
      document.getElementById('mechanism')?.scrollIntoView({ behavior: 'auto' });
    };
    const here = mode.pose === state.report.poses[0]?.pose.name;
    return html(
      'tr',
      {},
      html('th', { scope: 'row' }, `${mode.direction ?? '?'}${mode.mode_direction === undefined ? '' : ` (mode: ${mode.mode_direction})`}, ${mode.pose}`),
      cell(withInterval(mode.frequency_hz, mode.deviation_hz, 3).join(' ± ')),
      cell(mode.rigid_hz !== null && mode.rigid_mac >= 0.1 ? hertz(mode.rigid_hz) : ''),
      cell(mode.rigid_hz !== null && mode.rigid_mac >= 0.1 ? signedPercent(-100 * mode.drop) : ''),
      cell(hertz(mode.nominal_hz)),
      cell(hertz(mode.fitted_hz)),
      html('td', {}, stackedBar(energyParts(mode.strain_energy))),
      html('td', {}, here ? button('Show', show, { 'data-control': 'show-mode', 'aria-label': `Show the motion of the mode at ${hertz(mode.frequency_hz)} Hz` }) : ''),
    );
  });
  const titles = [
    'measured mode',
    'measured, Hz',
    'rigid legs, Hz',
    'relative to rigid legs',
    'nominal, Hz',
    'best hypothesis, Hz',
    'compliance',
    'in 3D',
  ];
  return scroller(
    'Measured modes',
    html(
      'table',
      { class: 'diagnosed' },
      html('caption', {}, 'Measured modes with their standard deviations, rigid-leg model and best hypothesis'),
      tableHead(...titles.map((title): [string] => [title])),
      html('tbody', {}, ...rows),
    ),
  );
}

/** "5.2 ± 0.1", "(8.40 ± 0.02)·10⁵": with its standard deviation. */
function estimate(value: number, deviation: number | null): string {
  if (deviation === null || !(deviation > 0)) return plain(value);
  const size = Math.abs(value);
  const exponent = size >= 1e5 || (size > 0 && size < 1e-2) ? Math.floor(Math.log10(size)) : 0;
  const text = withInterval(value / 10 ** exponent, deviation / 10 ** exponent, 3).join(' ± ');
  return exponent === 0 ? text : `(${text})·10${raised(exponent)}`;
}

/** In the unit that the machine file has there. */
const values = (e: Hypothesis, units: Units): string =>
  e.parameters
    .map((p) => {
      const { name, size } = units[p.paths[0] ?? ''] ?? { name: p.unit === '1' ? '' : p.unit, size: 1 };
      const number = estimate(p.value / size, p.deviation === null ? null : p.deviation / size);
      return `${p.paths.join(', ')} = ${number} ${name}`.trimEnd() + (p.at_bound ? ' (at its bound)' : '');
    })
    .join('; ');

/** The first `count` of a list, the others folded. */
function folded(items: HTMLElement[], count: number, list: (part: HTMLElement[], from: number) => HTMLElement, words: (rest: number) => string): HTMLElement[] {
  const rest = items.slice(count);
  if (rest.length === 0) return [list(items, 1)];
  const more = html('details', { class: 'more' }, html('summary', {}, words(rest.length)), list(rest, count + 1));
  return [list(items.slice(0, count), 1), more];
}

/**
 * A bar per hypothesis; its length is the logarithm of its BIC above the best. The buttons show predictions;
 * `mark` marks the one that is shown.
 */
function ranking(found: Diagnosis, units: Units, show: (hypothesis: number) => void): { parts: HTMLElement[]; mark: (hypothesis: number) => void } {
  const hypotheses = found.hypotheses ?? [];
  const shown = hypotheses.filter((e, k) => k < 12 || e.causes.length === 0);
  const length = (e: Hypothesis) => Math.log10(1 + Math.max(0, e.bic_above_best));
  const longest = Math.max(1, ...shown.map(length));
  const buttons = new Map<number, HTMLButtonElement>();
  const parts = folded(
    shown.map((e) => {
      const number = hypotheses.indexOf(e);
      const showButton = button('Show', () => show(number), {
        'data-hypothesis': number,
        'aria-label': `Show the prediction of ${e.name}`,
        'aria-pressed': 'false',
      });
      buttons.set(number, showButton);
      const bar = html('i', { class: e.equally_good ? 'bar equally_good' : 'bar' });
      bar.style.width = `${2 + (98 * length(e)) / longest}%`;
      const worse = e.bic_above_best < 0.05 ? 'lowest BIC' : `BIC ${plain(e.bic_above_best)} above the best`;
      return html(
        'li',
        {},
        html('strong', {}, e.name),
        ` (${e.equally_good ? `${worse}, explains the data equally well` : worse})`,
        showButton,
        html('div', { class: 'track', 'aria-hidden': 'true' }, bar),
        html('span', { class: 'note' }, [values(e, units), e.contradictions[0] ?? ''].filter(Boolean).join(' — ')),
      );
    }),
    Math.max(3, shown.filter((e) => e.equally_good).length),
    (part, from) => html('ol', { class: 'ranking', start: from }, ...part),
    (rest) => (rest === 1 ? '1 more hypothesis' : `${rest} more hypotheses`),
  );
  const mark = (hypothesis: number) => buttons.forEach((b, k) => b.setAttribute('aria-pressed', String(k === hypothesis)));
  return { parts, mark };
}

function render(state: State, host: HTMLElement): void {
  const found = state.report.diagnosis as Diagnosis;
  const left = html('div', { class: 'diagnosis-part' });
  const right = html('div', { class: 'diagnosis-part' });
  left.append(
    ...folded(
      found.summary.map((sentence) => html('li', {}, sentence)),
      3,
      (part, from) => html('ul', { class: from === 1 ? 'findings first' : 'findings' }, ...part),
      (rest) => (rest === 1 ? '1 more finding' : `${rest} more findings`),
    ),
  );
  if (found.measured_modes && found.measured_modes.length > 0)
    left.append(measuredTable(state, found));
  if (found.hypotheses && found.hypotheses.length > 1) {
    const prediction = new Prediction(found);
    const { parts, mark } = ranking(found, state.report.editable?.units ?? {}, (hypothesis) => prediction.show(hypothesis));
    prediction.onShow = mark;
    prediction.show(0);
    state.listen((change) => change === 'theme' && prediction.draw());
    right.append(html('h3', {}, 'Hypotheses'), ...parts, html('h3', {}, 'Prediction and measurement'), prediction.element);
    window.hydrapod.diagnosis = {
      show: (hypothesis) => prediction.show(hypothesis),
      shown: () => prediction.shown,
      choose: (overlay, curve) => prediction.choose(overlay, curve),
      drawn: () => prediction.drawn(),
    };
  }
  if (found.remedy)
    left.append(
      html('h3', {}, `Required stiffness of the guide sleeves for ${found.remedy.goal.words}`),
      new StiffnessPicture(found.remedy, found.computed_machine).element,
      html('p', { class: 'note' }, stiffnessWords(found.remedy, found.computed_machine)),
    );
  const parts = [left, right].filter((part) => part.childElementCount > 0);
  host.append(html('div', { class: parts.length > 1 ? 'diagnosis-parts' : '' }, ...parts));
}
