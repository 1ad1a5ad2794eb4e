// Parts of tables.

import { html } from './dom';

/** How a table stands, from wide to narrow: as it is, with less space, each row as a block of named values. */
const layouts = ['', 'tight', 'stacked'];

/** Each cell gets the title of its column, which stands above its value where rows are stacked. */
function nameCells(table: HTMLTableElement): void {
  const titles = [...(table.tHead?.rows[0]?.cells ?? [])].map((cell) => cell.dataset['title'] ?? cell.textContent ?? '');
  for (const row of table.tBodies[0]?.rows ?? [])
    [...row.cells].forEach((cell, k) => {
      if (cell.colSpan === 1) cell.dataset['column'] = titles[k] ?? '';
    });
}

/** Gives the tables in `element` the first layout that fits into it. */
class Fitting {
  private layout = 0;

  constructor(private readonly element: HTMLElement) {}

  /** From `layout` on. */
  fit(layout: number): void {
    if (this.element.clientWidth === 0) return;
    for (this.layout = layout; ; ++this.layout) {
      this.apply();
      if (this.layout + 1 === layouts.length || this.element.scrollWidth <= this.element.clientWidth) return;
    }
  }

  /** There is other content: it never goes back to a wider layout, or rows would jump while numbers change. */
  refit(): void {
    this.fit(this.layout);
  }

  private apply(): void {
    for (const table of this.element.querySelectorAll('table')) {
      layouts.slice(1).forEach((name, k) => table.classList.toggle(name, this.layout === k + 1));
      if (layouts[this.layout] === 'stacked') nameCells(table);
    }
  }
}

/** Holds tables: they take less space where the page is narrow. What is still wider scrolls, by keyboard too. */
export function scroller(label: string, ...content: HTMLElement[]): HTMLElement {
  // has the width of the scroller, but not its height, which depends on the layout
  const measure = html('div', {});
  const element = html('div', { class: 'scroller', tabindex: 0, role: 'region', 'aria-label': label }, measure, ...content);
  const fitting = new Fitting(element);
  new ResizeObserver(() => fitting.fit(0)).observe(measure);
  new MutationObserver(() => fitting.refit()).observe(element, { childList: true, subtree: true, characterData: true });
  return element;
}

/** Puts other content into a scroller. */
export function refill(element: HTMLElement, ...content: HTMLElement[]): void {
  element.replaceChildren(element.firstElementChild!, ...content);
}

/** A head of column titles, each with its class. */
export function tableHead(...columns: [title: string, kind?: string][]): HTMLElement {
  const cells = columns.map(([title, kind]) => html('th', { scope: 'col', class: kind }, title));
  return html('thead', {}, html('tr', {}, ...cells));
}

export const numeric = (text: string, kind = ''): HTMLElement =>
  html('td', { class: `numeric ${kind}`.trim() }, text);
