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

/** On paper the heading says what the section is of. */
function what(state: State, of: Section['of']): HTMLElement {
  const element = html('span', { class: 'print-only of' });
  const show = () => {
    const named = of === 'report at pose' && (state.report.poses.length > 1 || state.isWhatIf);
    const place = named ? `pose ${state.stated.pose.name}` : '';
    const unchanged = state.changedWords ? 'the machine of the report, unchanged' : '';
    const words = of === 'shown' ? state.shownWords : [place, unchanged].filter(Boolean).join(', ');
    element.textContent = words ? `: ${words}` : '';
  };
  state.listen((change) => (change === 'pose' || change === 'numbers') && show());
  show();
  return element;
}

/** Renders the sections whose data the document contains. */
export function renderSections(state: State, page: HTMLElement): void {
  const shown = sections.filter((section) => section.applies(state.report));
  header(state, shown, page);
  const main = html('main', { id: 'main' });
  page.append(main);
  for (const section of shown) {
    const heading = html('h2', { id: `${section.id}-title` }, section.title);
    if (section.of) heading.append(what(state, section.of));
    const host = html('section', { id: section.id, 'aria-labelledby': heading.id }, heading);
    main.append(host);
    section.render(state, host);
  }
  placeInColumns(main);
}
