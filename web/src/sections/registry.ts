// The sections of the page, in their order. A section appears when the document holds what it
// shows, so that a later kind of result needs one more line here and nothing else.

import { html } from '../dom';
import type { State } from '../state';
import { about } from './about';
import { bode } from './bode';
import { diagnosis } from './diagnosis';
import { header } from './header';
import { identification } from './identification';
import { mechanism } from './mechanism';
import { modes } from './modes';
import { pictures } from './pictures';
import type { Section } from './section';
import { simulation } from './simulation';

export const sections: Section[] = [
  mechanism,
  diagnosis,
  modes,
  pictures,
  bode,
  simulation,
  identification,
  about,
];

/** A section can be drawn late where it is far down: the page is usable before. */
export function renderSections(state: State, page: HTMLElement): void {
  const shown = sections.filter((section) => section.applies(state.report));
  header(state, shown, page);
  const main = html('main', { id: 'main' });
  page.append(main);
  for (const section of shown) {
    const heading = html('h2', { id: `${section.id}-title` }, section.title);
    const host = html('section', { id: section.id, 'aria-labelledby': heading.id }, heading);
    main.append(host);
    section.render(state, host);
  }
}
