// The changed values of the machine are those of all pages of the studio.

import type { Setting } from '../core/core';
import type { State } from '../state';
import type { Client } from './client';

const key = (values: Setting[]): string =>
  JSON.stringify([...values].sort(([a], [b]) => (a < b ? -1 : 1)));

/** `say`: what the program thinks of the values of this page; empty: nothing is wrong. */
export function shareValues(state: State, client: Client, say: (problem: string) => void): void {
  let known: string | null = null;
  let number = -1;
  // the program knows the values; an address that was kept may have older ones
  if (location.hash.startsWith('#set=')) history.replaceState(null, '', location.pathname);

  const take = async (values: Setting[]): Promise<void> => {
    const { whatIf } = window.hydrapod;
    if (!whatIf || (values.length === 0 && whatIf.changed().length === 0)) return;
    await whatIf.ready;
    if (key(whatIf.changed()) !== key(values)) whatIf.replace(values);
  };

  client.listen(() => {
    const current = client.state;
    if (!current || current.values_number === number) return;
    number = current.values_number;
    known = key(current.values);
    if (current.values_by !== client.name) void take(current.values);
  });

  state.onValues = (values, assignments) => {
    if (known === null || key(values) === known) return say('');
    known = key(values);
    client.post('values', { values, assignments, from: client.name }).then(
      () => say(''),
      (error: Error) => {
        known = '';
        say(`The program does not take these values: ${error.message}`);
      },
    );
  };
}
