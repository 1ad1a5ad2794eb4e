// A section of the page.

import type { Report } from '../document';
import type { State } from '../state';

export interface Section {
  id: string;
  title: string;
  /** Shown on paper only. */
  printed?: boolean;
  applies(report: Report): boolean;
  /** Fills `host` once; listens to `state` for later choices. */
  render(state: State, host: HTMLElement): void;
}
