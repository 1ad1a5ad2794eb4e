// The report: sections over one JSON document.

import type { Report } from './document';
import { showCoreFailures } from './core/shared';
import { html } from './dom';
import { onSystemTheme } from './palette';
import { renderSections } from './sections/registry';
import { State } from './state';

function start(): void {
  const host = document.getElementById('report') as HTMLElement;
  const report = JSON.parse(document.getElementById('data')?.textContent ?? '{}') as Report;
  const state = new State(report);
  window.hydrapod = { report, state };
  onSystemTheme(() => state.tell('theme'));
  showCoreFailures(host);
  renderSections(state, host);
  // on paper nothing is folded
  addEventListener('beforeprint', () => {
    for (const part of host.querySelectorAll('details')) part.open = true;
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
