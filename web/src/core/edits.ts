// What the reader has changed: values by path, in SI, with undo, redo, and the words for it.

import type { Parameter, Setting } from './core';

export type Values = ReadonlyMap<string, number>;

export const settings = (values: Values): Setting[] => [...values];

const same = (a: Values, b: Values): boolean =>
  a.size === b.size && [...a].every(([path, value]) => b.get(path) === value);

export class Edits {
  private present: Values = new Map();
  private undone: Values[] = [];
  private done: Values[] = [];
  /** The state before a drag that has not ended. */
  private before: Values | null = null;
  onChange: () => void = () => {};

  constructor(private readonly base: (path: string) => number | undefined) {}

  get values(): Values {
    return this.present;
  }

  get canUndo(): boolean {
    return this.done.length > 0;
  }

  get canRedo(): boolean {
    return this.undone.length > 0;
  }

  /** A value on the way: one step of undo for all until keep(). */
  drag(path: string, value: number): void {
    this.before ??= this.present;
    this.change(path, value);
  }

  set(path: string, value: number): void {
    this.drag(path, value);
    this.keep();
  }

  reset(path: string): void {
    const base = this.base(path);
    if (base !== undefined) this.set(path, base);
  }

  replace(values: Values): void {
    this.before ??= this.present;
    this.present = values;
    this.keep();
    this.onChange();
  }

  /** The drag has ended. */
  keep(): void {
    if (this.before && !same(this.before, this.present)) {
      this.done.push(this.before);
      this.undone = [];
    }
    this.before = null;
    this.onChange();
  }

  undo(): void {
    this.step(this.done, this.undone);
  }

  redo(): void {
    this.step(this.undone, this.done);
  }

  private step(from: Values[], to: Values[]): void {
    const other = from.pop();
    if (!other) return;
    to.push(this.present);
    this.present = other;
    this.onChange();
  }

  private change(path: string, value: number): void {
    const values = new Map(this.present);
    if (value === this.base(path)) values.delete(path);
    else values.set(path, value);
    this.present = values;
    this.onChange();
  }
}

/** "set=legs.rod.mass%3D7.2&set=…&pose=0.01,0,0,0,0,0", as the part of an address behind "#". */
export const fragmentOf = (values: Values, displaced: number[] | null): string =>
  [
    ...[...values].map(([path, value]) => `set=${encodeURIComponent(`${path}=${value}`)}`),
    ...(displaced ? [`pose=${displaced.join(',')}`] : []),
  ].join('&');

/** Is it an address of changed values or of a displacement? */
export const holdsState = (fragment: string): boolean => /^#(set|pose)=/.test(fragment);

/** The displacement in such a part [m, rad]; null where there is none. */
export function displacementIn(fragment: string): number[] | null {
  const given = new URLSearchParams(fragment.replace(/^#/, '')).get('pose');
  const numbers = given?.split(',').map((text) => (text.trim() === '' ? Number.NaN : Number(text))) ?? [];
  return numbers.length === 6 && numbers.every(Number.isFinite) ? numbers : null;
}

/** The values in such a part; what is not known or no number is left out. */
export function fromFragment(
  fragment: string,
  base: (path: string) => number | undefined,
): Values {
  const values = new Map<string, number>();
  for (const [key, text] of new URLSearchParams(fragment.replace(/^#/, ''))) {
    const at = text.lastIndexOf('=');
    const [path, number] = [text.slice(0, at), text.slice(at + 1)];
    const value = Number(number);
    if (key !== 'set' || number.trim() === '' || !Number.isFinite(value)) continue;
    const known = base(path);
    if (known !== undefined && known !== value) values.set(path, value);
  }
  return values;
}

/** The arguments of `--set`; arrays as a whole, with what the machine has for the other elements. */
export function assignments(values: Values, parameters: Parameter[]): string[] {
  const texts = new Set<string>();
  for (const parameter of parameters) {
    const { path, array } = parameter;
    const value = values.get(path);
    if (value === undefined) continue;
    if (!array) {
      texts.add(`${path}=${value}`);
      continue;
    }
    const elements = parameters.filter((other) => other.array?.[0] === array[0]);
    const numbers = elements.map((other) => values.get(other.path) ?? other.value);
    const keyed = array[1].startsWith('.');
    const list = numbers.map((number, k) =>
      keyed ? `${elements[k]!.array![1].slice(1)} = ${number}` : String(number),
    );
    texts.add(`${array[0]}=${keyed ? `{ ${list.join(', ')} }` : `[${list.join(', ')}]`}`);
  }
  return [...texts];
}

/** A word as a POSIX shell takes it. */
const quoted = (word: string): string =>
  /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;

export const shellCommand = (words: string[]): string => words.map(quoted).join(' ');

/** Instead of a command. */
export const noCommand = 'No command leads to this machine: its numbers come from a diagnosis.';
