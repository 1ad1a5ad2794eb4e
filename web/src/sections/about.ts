// All data to reproduce the numbers.

import type { PoseReport, Report } from '../document';
import { button, download, html, showCommand } from '../dom';
import { list } from '../numbers';
import type { State } from '../state';
import type { Section } from './section';

export const about: Section = {
  id: 'about',
  title: 'Reproduction',
  of: 'report',
  applies: () => true,
  render,
};

const degrees = (radians: number[]): string =>
  list(
    radians.map((r) => (r * 180) / Math.PI),
    3,
  );

/** A word for a shell, in quotes where needed. */
const shellWord = (word: string): string =>
  /^[\w./=+-]+$/.test(word) ? word : `'${word.replaceAll("'", `'\\''`)}'`;

export const command = (words: string[]): string =>
  ['hydrapod', ...words].map(shellWord).join(' ');

function program({ assumptions, reproduction }: Report): string {
  const commit = reproduction?.commit ? `, commit ${reproduction.commit}` : '';
  return `hydrapod ${assumptions.hydrapod}${commit}`;
}

function facts(report: Report): [string, string][] {
  const { assumptions: a, machine } = report;
  const rows: [string, string][] = [
    ['Program', program(report)],
    ...(report.reproduction ? [['Date', report.reproduction.date] as [string, string]] : []),
    ['Machine', machine.name || 'without a name'],
    ['Source', machine.source || 'not stated'],
    ['State', machine.state],
    ['File', machine.file],
    ['Overrides', machine.overrides.join('\n') || 'none'],
    ['Gravity', `${a.gravity}: (${list(a.gravity_m_s2, 5)}) m/s² in base axes`],
    ['Flexible axes', flexibleAxes(a.flexible_axes)],
    ['Damping', a.damping],
  ];
  const pose = report.poses[0];
  if (pose) rows.push(['Model', `${pose.model}: ${pose.modes.length} modes`]);
  for (const entry of report.poses) rows.push([`Pose ${entry.pose.name}`, poseText(entry)]);
  if (pose?.bode)
    rows.push([
      'Bode diagrams',
      `force or moment at the ${pose.bode.point}, displacement at this point, base axes; exact at every drawn frequency`,
    ]);
  rows.push(
    [
      'Axes',
      'base frame: origin at the centre of the base joints, z towards the platform; SI units',
    ],
    [
      'Mode shapes',
      'normalised so that φᵀ M φ = 1; motion of the platform’s mass centre, base axes',
    ],
  );
  for (const input of report.reproduction?.inputs ?? [])
    rows.push([
      `Read with ${input.option}`,
      `${input.path}\n${input.bytes ?? '?'} bytes, SHA-256 ${input.sha256 ?? 'unknown: the file was changed while the command ran'}`,
    ]);
  if (machine.warnings && machine.warnings.length > 0)
    rows.push(['Warnings', machine.warnings.join('\n')]);
  return rows;
}

function flexibleAxes(name: string): string {
  return name === 'gimbal'
    ? 'gimbal: parallel to the axes of the lower gimbals'
    : 'transverse: normal to each leg, no spin about the axis of the leg';
}

function poseText({ pose }: PoseReport): string {
  return `position (${list(pose.position_m, 4)}) m, rotation (${degrees(pose.rotation_rad)})° about x, y, z`;
}

function commandLine(words: string[]): HTMLElement {
  const element = html('pre', { class: 'command', tabindex: 0, 'aria-label': 'Command' });
  showCommand(element, command(words));
  return element;
}

/** "Read with --measured" on one line. */
const unbroken = (name: string): (Node | string)[] =>
  name.split(/(--\w+)/).map((part, k) => (k % 2 === 1 ? html('span', { class: 'word' }, part) : part));

function render(state: State, host: HTMLElement): void {
  const { report } = state;
  const rows = facts(report).map(([name, value]) =>
    html('tr', {}, html('th', { scope: 'row' }, ...unbroken(name)), html('td', {}, value)),
  );
  host.append(
    html(
      'table',
      { class: 'facts' },
      html('caption', { class: 'unseen' }, 'Assumptions of the calculation'),
      html('tbody', {}, ...rows),
    ),
    ...(report.reproduction
      ? [
          html('h3', {}, 'Command'),
          commandLine(report.reproduction.command),
        ]
      : []),
    button(
      'Download the data (JSON)',
      () =>
        download(
          'report.json',
          new Blob([JSON.stringify(report, null, 1)], { type: 'application/json' }),
        ),
      { 'data-control': 'json' },
    ),
  );
  if (report.machine.text !== undefined)
    host.append(
      html(
        'details',
        { open: true },
        html('summary', {}, html('h3', {}, `The machine file ${report.machine.file}`)),
        html(
          'pre',
          { class: 'file', tabindex: 0, 'aria-label': 'Machine file' },
          report.machine.text,
        ),
      ),
    );
  host.append(
    html(
      'p',
      { class: 'note' },
      'Drawn with three.js and uPlot, both under the MIT licence. Their notices are at the beginning of this file.',
    ),
  );
}
