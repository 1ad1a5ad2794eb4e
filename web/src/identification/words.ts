// What an identification found, in one sentence.

import { fixed, hertz } from '../numbers';
import type { Identification } from './types';

/** "1.2 to 3.4", of one number "1.2". */
const span = (low: string, high: string): string => (low === high ? low : `${low} to ${high}`);

const signedFixed = (value: number): string => `${value > 0.005 ? '+' : ''}${fixed(Math.abs(value) < 0.005 ? 0 : value, 2)}`;

export function identifiedWords({ modes, comparison }: Identification): string {
  if (modes.length === 0) return 'Measured: no mode was identified.';
  const frequencies = modes.map((mode) => mode.frequency_hz);
  const count = modes.length === 1 ? '1 mode' : `${modes.length} modes`;
  const found = `Measured: ${count}, ${span(hertz(Math.min(...frequencies)), hertz(Math.max(...frequencies)))} Hz`;
  const differences = (comparison?.pairs ?? []).map((pair) => pair.frequency_difference_percent);
  if (differences.length === 0) return `${found}.`;
  const range = span(signedFixed(Math.min(...differences)), signedFixed(Math.max(...differences)));
  return `${found}; ${differences.length} with a partner in the model, whose frequencies differ by ${range} %.`;
}
