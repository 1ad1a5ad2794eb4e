// A section of the page.

import type { Report } from '../document';
import type { State } from '../state';

export interface Section {
  id: string;
  title: string;
  /** Shown on paper only. */
  printed?: boolean;
  /** What it is of, said on paper: the machine and pose shown, the report's machine at that pose, or that alone. */
  of?: 'shown' | 'report at pose' | 'report';
  applies(report: Report): boolean;
  /** Fills `host` once; listens to `state` for later choices. */
  render(state: State, host: HTMLElement): void;
}
