// The core of the page: one for all sections that calculate.

import { html } from '../dom';
import type { State } from '../state';
import { Core, CoreError } from './core';

let started: Promise<Core> | null = null;

/** Starts the core at the first call, with the machine of the report. */
export async function sharedCore(state: State): Promise<Core> {
  const module = document.getElementById('core')?.textContent ?? '';
  if (!state.report.editable) throw new CoreError('the report contains no machine');
  started ??= Core.start(module, state.report.editable);
  return started;
}

/**
 * Calls `begin` once: when `host` comes near the window, or when the returned function is called. `failed` gets the
 * message for the user.
 */
export function beginWhenSeen(host: HTMLElement, begin: () => Promise<void>, failed: (message: string) => void): () => Promise<void> {
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
    ready().catch(() => {}); // `failed` has it
  }, { rootMargin: '200px' });
  seen.observe(host);
  return ready;
}

/** Calls `act` once the page is loaded, was drawn twice and has nothing else to do. */
export function whenIdle(act: () => void): void {
  const free = () => ('requestIdleCallback' in window ? requestIdleCallback(act, { timeout: 2000 }) : setTimeout(act, 500));
  const drawn = () => requestAnimationFrame(() => requestAnimationFrame(free));
  if (document.readyState === 'complete') drawn();
  else addEventListener('load', drawn, { once: true });
}

export const failureText = (message: string): HTMLElement => html('p', { class: 'problem', role: 'alert' }, message);

/** Time from the last change of a slider to the calculation of maps and samples [ms]. */
const rest = 100;
let touched = Number.NEGATIVE_INFINITY;

/** Notes that a slider was changed. */
export const touch = (): void => {
  touched = performance.now();
};

/** Resolves when no slider was changed for the time `rest`. */
export async function idle(): Promise<void> {
  for (let left; (left = touched + rest - performance.now()) > 0; )
    await new Promise((resolve) => setTimeout(resolve, left));
}

const reasonOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

export const coreFailure = (error: unknown): string =>
  `The page could not calculate: ${reasonOf(error)}. The results of the program are still shown.`;

/** Failures of the core that no section shows: one message at the top of the page, that of the first. */
export function showCoreFailures(page: HTMLElement): void {
  addEventListener('unhandledrejection', (event) => {
    if (!(event.reason instanceof CoreError)) return;
    event.preventDefault();
    if (page.querySelector('.core-failure')) return;
    const text = failureText(coreFailure(event.reason));
    text.classList.add('core-failure');
    page.prepend(text);
  });
}
