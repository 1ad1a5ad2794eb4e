// The sections of the page, in their order. A section is shown where the document contains its
// data. A new kind of result needs one more line here.

import { placeInColumns } from '../columns';
import { html } from '../dom';
import type { State } from '../state';
import { about } from './about';
import { bode } from './bode';
import { check } from './check';
import { comparison } from './comparison';
import { diagnosis } from './diagnosis';
import { header } from './header';
import { identification } from './identification';
import { mechanism } from './mechanism';
import { modes } from './modes';
import { pictures } from './pictures';
import type { Section } from './section';
import { scatter } from './scatter';
import { simulation } from './simulation';
import { studio } from './studio';
import { whatIf } from './what_if';
import { workspace } from './workspace';

export const sections: Section[] = [
  studio,
  diagnosis,
  identification,
  comparison,
  mechanism,
  modes,
  pictures,
  simulation,
  whatIf,
  workspace,
  check,
  scatter,
  bode,
  about,
];

/** Renders the sections whose data the document contains. */
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
  placeInColumns(main);
}
