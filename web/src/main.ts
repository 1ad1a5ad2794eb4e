// The report: sections over one JSON document.

import type { Report } from './document';
import { showCoreFailures } from './core/shared';
import { html } from './dom';
import { onSystemTheme, setPaper } from './palette';
import { renderSections } from './sections/registry';
import { State } from './state';

function start(): void {
  const host = document.getElementById('report') as HTMLElement;
  const report = JSON.parse(document.getElementById('data')?.textContent ?? '{}') as Report;
  const state = new State(report);
  window.hydrapod = { report, state };
  onSystemTheme(() => state.tell('theme'));
  showCoreFailures(host);
  // before the listeners of the diagrams: those that are drawn anew get the width of the paper afterwards
  const turn = (paper: boolean) => setPaper(paper) && state.tell('theme');
  let folded: HTMLDetailsElement[] = [];
  const unfold = (open: boolean) => folded.forEach((part) => (part.open = open));
  addEventListener('beforeprint', () => {
    turn(true);
    folded = [...host.querySelectorAll<HTMLDetailsElement>('details:not([open])')]; // on paper nothing is
    unfold(true);
  });
  addEventListener('afterprint', () => {
    turn(false);
    unfold(false);
  });
  renderSections(state, host);
  namePages(state);
}

/** As much of a text as has `most` characters. */
const shortened = (text: string, most: number): string =>
  text.length > most ? `${text.slice(0, most - 1).trimEnd()}…` : text;

/** Printed pages say what they are of. The policy of the page allows rules that are added like this. */
function namePages(state: State): void {
  const { report } = state;
  const sheet = document.styleSheets[0];
  if (!sheet) return;
  const date = report.reproduction?.date.slice(0, 10) ?? '';
  const name = () => {
    const parts = [
      shortened(report.title, 48),
      [shortened(report.machine.state, 56), state.changedWords].filter(Boolean).join(', '),
      shortened(state.poseWords, 40),
      `hydrapod ${report.assumptions.hydrapod}`,
      date,
    ];
    const safe = parts.filter(Boolean).join(' · ').replace(/[\\"]/g, '\\$&').replace(/\s+/g, ' ');
    return `@page { @bottom-left { content: "${safe}"; width: 86%; font: 8pt sans-serif; color: #56616e; } }`;
  };
  let at = sheet.insertRule(name(), sheet.cssRules.length);
  state.listen((change) => {
    if (change !== 'pose' && change !== 'numbers') return;
    sheet.deleteRule(at);
    at = sheet.insertRule(name(), sheet.cssRules.length);
  });
}

try {
  start();
} catch (error) {
  document
    .getElementById('report')
    ?.append(html('p', { role: 'alert' }, `This report cannot be shown: ${error}`));
  throw error;
}
