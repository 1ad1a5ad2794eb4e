// The one core of the page, for all sections that calculate.

import { html } from '../dom';
import type { State } from '../state';
import { Core } from './core';

let started: Promise<Core> | null = null;

/** Starts the core where nobody has, and opens the machine of the report. */
export function sharedCore(state: State): Promise<Core> {
  const module = document.getElementById('core')?.textContent ?? '';
  if (!state.report.editable) throw new Error('this report has no machine to calculate with');
  started ??= Core.start(module, state.report.editable);
  return started;
}

/**
 * What a section calculates begins when it is about to be seen, or when the returned function is called; once.
 * `failed` gets words for the reader.
 */
export function beginWhenSeen(host: HTMLElement, begin: () => Promise<void>, failed: (words: string) => void): () => Promise<void> {
  let begun: Promise<void> | null = null;
  const ready = (): Promise<void> => {
    if (!begun) {
      begun = begin();
      begun.catch((error) => failed(coreFailure(error)));
    }
    return begun;
  };
  const seen = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    seen.disconnect();
    void ready();
  }, { rootMargin: '200px' });
  seen.observe(host);
  return ready;
}

export const failureText = (words: string): HTMLElement => html('p', { class: 'problem', role: 'alert' }, words);

/** Maps and samples wait so long after the last value that was dragged [ms]: a slider goes first. */
const rest = 100;
let touched = Number.NEGATIVE_INFINITY;

/** Somebody drags something. */
export const touch = (): void => {
  touched = performance.now();
};

/** Resolves when nobody has dragged anything for a while. */
export async function idle(): Promise<void> {
  for (let left; (left = touched + rest - performance.now()) > 0; )
    await new Promise((resolve) => setTimeout(resolve, left));
}

export const coreFailure = (error: unknown): string =>
  `This browser cannot run the core: ${error}. Everything else on this page is as the program computed it.`;
