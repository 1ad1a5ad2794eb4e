// Top of the page: the machine, the result in words, and four numbers.

import type { Answer, PoseReport, Report } from '../document';
import { button, html } from '../dom';
import { fixed, hertz, share, signedPercent } from '../numbers';
import { theme, type Theme } from '../palette';
import type { State } from '../state';
import { energyParts, stackedBar } from '../bars';
import { identifiedWords } from '../identification/words';
import { numeric, tableHead } from '../table';
import type { Section } from './section';

const modelNames = {
  rigid: 'rigid legs',
  guide: 'compliant guide sleeves',
  full: 'compliant guide sleeves and piston rings',
};

export function header(state: State, sections: Section[], page: HTMLElement): void {
  const { report } = state;
  const top = html(
    'header',
    { class: 'top' },
    html('a', { class: 'skip', href: '#main' }, 'Skip to the content'),
    html(
      'div',
      { class: 'titles' },
      html('h1', {}, report.title),
      ...subtitles(state),
      html('p', { class: 'subtitle print-only' }, madeBy(report)),
    ),
    html('div', { class: 'tools' }, navigation(sections), themeChooser(state)),
  );
  page.append(top);
  if (report.poses.length === 0) return;
  if (report.poses.length > 1) {
    page.classList.add('several-poses');
    page.append(poseChooser(state));
  }
  const host = html('section', {
    class: 'answer',
    id: 'answer',
    'aria-label': 'Result',
    'aria-live': 'polite',
  });
  page.append(host);
  const show = () => {
    host.classList.toggle('changed-machine', state.isWhatIf);
    const what = [
      ...(state.values.length > 0 ? ['with the changed values below'] : []),
      ...(state.displaced ? [`at the pose ${state.pose.pose.name}`] : []),
    ].join(', ');
    const words = `${what.charAt(0).toUpperCase()}${what.slice(1)}, not ${state.values.length > 0 ? 'the machine of this report' : 'at a pose of this report'}:`;
    const found = verdict(report);
    const several = report.poses.length > 1;
    const atPose = () => html('span', { class: 'print-only' }, `At the pose ${state.pose.pose.name}: `);
    host.replaceChildren(
      ...found,
      ...(state.isWhatIf ? [html('p', { class: 'words changed-words' }, words), ...changedOnPaper(state)] : []),
      ...answer(state.pose, [
        ...(found.length > 0 ? ['Calculated for this machine: '] : []),
        ...(several ? [atPose()] : []),
      ]),
      ...(several && !state.isWhatIf ? [posesOnPaper(report)] : []),
    );
  };
  state.listen((change) => (change === 'pose' || change === 'numbers') && show());
  show();
}

/** What a diagnosis, an identification or a comparison found stands above what was calculated. */
function verdict(report: Report): HTMLElement[] {
  const { diagnosis, identification, comparison } = report;
  const found = diagnosis?.summary[0] ?? (identification ? identifiedWords(identification) : comparison?.comparisons[0]?.verdict);
  return found ? [html('p', { class: 'words verdict' }, html('strong', {}, found))] : [];
}

/** Which values the machine has that is shown, and what of the page is not of it. */
function changedOnPaper({ changes, values }: State): HTMLElement[] {
  const list = html('ul', { class: 'print-only changes' }, ...changes.map((text) => html('li', {}, text)));
  const others = 'Measurements, simulation, check and reproduction are those of the report, without these changes.';
  return [...(values.length > 0 ? [list] : []), html('p', { class: 'note print-only' }, others)];
}

/** Modes of all poses: paper has the page of one of them. */
function posesOnPaper({ poses }: Report): HTMLElement {
  const rigid = poses.some(({ answer }) => answer?.rigid_frequency_hz !== undefined);
  const row = ({ pose, answer: found }: PoseReport) => {
    const stable = found?.stable ? found : null;
    const hz = found && !found.stable ? 'unstable' : stable ? hertz(stable.frequency_hz) : '–';
    const compared = [
      stable?.rigid_frequency_hz === undefined ? '–' : hertz(stable.rigid_frequency_hz),
      stable?.drop_percent === undefined ? '–' : signedPercent(-stable.drop_percent),
    ];
    return html(
      'tr',
      {},
      html('th', { scope: 'row' }, pose.name),
      numeric(hz),
      html('td', {}, stable?.directions ?? ''),
      ...(rigid ? compared.map((text) => numeric(text)) : []),
    );
  };
  const heads: [string, string][] = [['With rigid legs, Hz', 'numeric'], ['Change', 'numeric']];
  return html(
    'table',
    { class: 'poses-table' },
    html('caption', {}, 'Lowest mode with platform motion at the poses of the report'),
    tableHead(['Pose'], ['Hz', 'numeric'], ['Direction'], ...(rigid ? heads : [])),
    html('tbody', {}, ...poses.map(row)),
  );
}

/** The machine and the assumptions of the calculation. */
function subtitles(state: State): HTMLElement[] {
  const { report } = state;
  const { machine, assumptions } = report;
  const pose = report.poses[0];
  const name = machine.name !== report.title ? machine.name : '';
  const facts = [
    pose ? `${modelNames[pose.model]}, ${pose.modes.length} modes` : '',
    assumptions.gravity,
    `damping ${assumptions.damping}`,
  ];
  const line = (text: string) => html('p', { class: 'subtitle' }, text);
  const described = [name, machine.description].filter(Boolean).join(': ');
  const which = line('');
  const show = () => {
    which.textContent = `Machine: ${[machine.state, state.changedWords].filter(Boolean).join(', ')}`;
    if (state.poseWords) which.append(html('span', { class: 'print-only' }, `; ${state.poseWords}`));
  };
  state.listen((change) => (change === 'pose' || change === 'numbers') && show());
  show();
  return [...(described ? [line(described)] : []), which, line(facts.filter(Boolean).join(' · '))];
}

/** Of a report on paper: program, version, date. */
function madeBy({ assumptions, reproduction }: Report): string {
  const date = reproduction ? new Date(reproduction.date) : null;
  const day = date && !Number.isNaN(date.getTime()) ? `, ${date.toLocaleDateString(undefined, { dateStyle: 'long' })}` : '';
  return `hydrapod ${assumptions.hydrapod}${day}`;
}

function navigation(sections: Section[]): HTMLElement {
  const links = sections
    .filter((section) => !section.printed)
    .map((section) => html('li', {}, html('a', { href: `#${section.id}` }, section.title)));
  return html('nav', { 'aria-label': 'Sections' }, html('ul', {}, ...links));
}

function themeChooser(state: State): HTMLElement {
  const names: Record<Theme, string> = { auto: 'as the system', light: 'light', dark: 'dark' };
  const order: Theme[] = ['auto', 'light', 'dark'];
  const control = button('', () => {
    const next = order[(order.indexOf(theme()) + 1) % 3] as Theme;
    document.documentElement.dataset['theme'] = next;
    label();
    state.tell('theme');
  });
  const label = () => (control.textContent = `Colours: ${names[theme()]}`);
  control.classList.add('quiet');
  label();
  return control;
}

function poseChooser(state: State): HTMLElement {
  const buttons = state.report.poses.map((entry, index) =>
    button(entry.pose.name, () => state.choosePose(index), { 'data-pose': index }),
  );
  const mark = () =>
    buttons.forEach((b, index) =>
      b.setAttribute('aria-pressed', String(index === state.poseNumber)),
    );
  state.listen((change) => change === 'pose' && mark());
  mark();
  return html(
    'section',
    { class: 'poses', 'aria-label': 'Pose' },
    html('span', { 'aria-hidden': 'true' }, 'Pose'),
    ...buttons,
  );
}

function number(
  caption: string,
  value: string,
  unit: string,
  note: string,
  kind: string,
): HTMLElement {
  return html(
    'div',
    { class: `number ${kind}` },
    html('dt', {}, caption),
    html(
      'dd',
      {},
      html('strong', {}, value),
      ' ',
      html('span', { class: 'unit' }, unit),
      html('small', {}, note),
    ),
  );
}

/** Text between backticks is code. */
const withCode = (text: string): Node[] =>
  text
    .split('`')
    .map((part, i) => (i % 2 === 1 ? html('code', {}, part) : document.createTextNode(part)));

/** `before`: what it is of. */
function answer(pose: PoseReport, before: (Node | string)[]): Node[] {
  const result = pose.answer;
  if (!result) return [html('p', { class: 'words' }, ...before, 'All modes of this model are local seal modes.')];
  const nodes: Node[] = [html('p', { class: 'words' }, ...before, ...withCode(result.text))];
  if (result.stable) nodes.push(html('dl', { class: 'numbers' }, ...numbers(pose, result)));
  return nodes;
}

/** Of the mode with rigid legs, how much of its motion this mode holds and how high it stands. */
const weight = ({ share_of_rigid_mode: part, peak_height: peak }: Answer): string =>
  part === undefined || peak === undefined
    ? ''
    : `; ${share(part)} of the motion, peak ${fixed(peak, 2)} times as high`;

function numbers(pose: PoseReport, result: Answer): HTMLElement[] {
  const { rigid_frequency_hz: rigid, drop_percent: drop } = result;
  const items: HTMLElement[] = [];
  if (rigid !== undefined)
    items.push(
      number('With rigid legs', hertz(rigid), 'Hz', `rigid mode ${result.rigid_mode}`, 'rigid'),
    );
  items.push(
    number(
      pose.model === 'rigid' ? 'With rigid legs' : 'With flexible legs',
      hertz(result.frequency_hz),
      'Hz',
      `mode ${result.mode}, ${result.directions}`,
      'real',
    ),
  );
  if (drop !== undefined)
    items.push(
      number(
        drop >= 0 ? 'Drop' : 'Rise',
        fixed(Math.abs(drop), Math.abs(drop) < 10 ? 2 : 1),
        '%',
        signedPercent(-drop) + ' relative to rigid legs' + weight(result),
        'drop',
      ),
    );
  const parts = energyParts(result.strain_energy);
  const most = parts.reduce((best, part) => (part.value > best.value ? part : best));
  items.push(
    html(
      'div',
      { class: 'number energy' },
      html('dt', {}, 'Strain energy of this mode'),
      html(
        'dd',
        {},
        html('strong', {}, share(most.value)),
        ' ',
        html('span', { class: 'unit' }, `in the ${most.long}`),
        stackedBar(parts),
      ),
    ),
  );
  return items;
}
