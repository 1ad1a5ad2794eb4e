// Parts of tables.

import { html } from './dom';

/** Scrolls a table that is wider than the page, by keyboard too. */
export function scroller(label: string, ...content: HTMLElement[]): HTMLElement {
  return html('div', { class: 'scroller', tabindex: 0, role: 'region', 'aria-label': label }, ...content);
}

/** A head of column titles, each with its class. */
export function tableHead(...columns: [title: string, kind?: string][]): HTMLElement {
  const cells = columns.map(([title, kind]) => html('th', { scope: 'col', class: kind }, title));
  return html('thead', {}, html('tr', {}, ...cells));
}

export const numeric = (text: string, kind = ''): HTMLElement =>
  html('td', { class: `numeric ${kind}`.trim() }, text);
