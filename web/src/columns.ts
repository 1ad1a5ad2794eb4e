// Wide windows: sections side by side in columns, in their order, without gaps between them.

import { onNewWidth } from './dom';

/** Least width of a column [px]: all sections are whole in it. */
const least = 1200;
const gap = 14;
/** Rows of the grid [px]. A section covers as many as it is high. */
const row = 2;

/** Sections that go across all columns. */
const isWhole = (section: HTMLElement): boolean => section.id === 'studio';

/** How many columns a page of this width has. */
const columnsIn = (width: number): number => Math.max(1, Math.floor((width + gap) / (least + gap)));

export function placeInColumns(main: HTMLElement): void {
  const sections = [...main.children] as HTMLElement[];
  const shown = () => sections.filter((section) => section.offsetHeight > 0);
  let columns = 1;

  const rowsOf = (section: HTMLElement) => Math.ceil((section.offsetHeight + gap) / row);

  /** Each section below the shortest column. Later it stays in its column, whatever opens or closes. */
  const place = () => {
    columns = columnsIn(main.clientWidth);
    main.classList.toggle('columns', columns > 1);
    main.style.setProperty('--columns', String(columns));
    if (columns === 1) return;
    const ends = Array<number>(columns).fill(0);
    for (const section of shown()) {
      const at = ends.indexOf(Math.min(...ends));
      section.style.setProperty('--column', isWhole(section) ? '1 / -1' : String(at + 1));
      if (isWhole(section)) ends.fill(Math.max(...ends) + rowsOf(section));
      else ends[at]! += rowsOf(section);
    }
    follow();
  };
  const follow = () => {
    if (columns > 1) for (const section of shown()) section.style.setProperty('--rows', String(rowsOf(section)));
  };
  onNewWidth(main, place);
  const heights = new ResizeObserver(follow);
  for (const section of sections) heights.observe(section);
}
