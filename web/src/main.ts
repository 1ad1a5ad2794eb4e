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
  namePages(report);
}

/** Printed pages say what they are of. The policy of the page allows rules that are added like this. */
function namePages(report: Report): void {
  const date = report.reproduction?.date.slice(0, 10) ?? '';
  const text = [report.title, report.machine.state, `hydrapod ${report.assumptions.hydrapod}`, date].filter(Boolean).join(' · ');
  const safe = text.replace(/[\\"]/g, '\\$&').replace(/\s+/g, ' ');
  const rule = `@page { @bottom-left { content: "${safe}"; font: 9pt sans-serif; color: #56616e; } }`;
  document.styleSheets[0]?.insertRule(rule, document.styleSheets[0].cssRules.length);
}

try {
  start();
} catch (error) {
  document
    .getElementById('report')
    ?.append(html('p', { role: 'alert' }, `This report cannot be shown: ${error}`));
  throw error;
}
