// What can be calculated, and what is asked for it.

import { button, html, identifier } from '../dom';
import type { KnownRecord } from './client';
import { setValues, valuesIn, type Draft } from './draft';

interface Field {
  name: string;
  label: string;
  /** `lines`: one value a line; `record`: one that is known, or a path. */
  kind: 'text' | 'lines' | 'check' | 'record' | 'path';
  hint?: string;
  value?: string;
  required?: boolean;
}

interface Form {
  kind: string;
  title: string;
  what: string;
  fields: Field[];
}

const pose = 'x=-100:100:21 mm\nz=-100:100:21 mm';

export const forms: Form[] = [
  {
    kind: 'identify',
    title: 'Identify a record',
    what: 'Modes of a measured record, with confidence intervals, beside those of the machine.',
    fields: [
      { name: 'records', label: 'Record', kind: 'record', required: true },
      { name: 'from', label: 'Lowest frequency', kind: 'text', hint: '2 Hz' },
      { name: 'to', label: 'Highest frequency', kind: 'text', hint: '80 Hz' },
      { name: 'from_drive', label: 'Inputs are the valve drives', kind: 'check' },
    ],
  },
  {
    kind: 'diagnose',
    title: 'Diagnose a record',
    what: 'Hypotheses for the measured modes, ranked, and the required stiffness of the guide sleeves.',
    fields: [
      { name: 'records', label: 'Record or list of modes', kind: 'record', required: true },
      { name: 'want', label: 'Goal', kind: 'text', hint: '2 %, or x=5 Hz' },
      { name: 'modes_only', label: 'Compare modes only', kind: 'check' },
    ],
  },
  {
    kind: 'simulate',
    title: 'Simulate a motion',
    what: 'The machine under its controller, in time.',
    fields: [
      { name: 'commands', label: 'Commands, one a line', kind: 'lines', value: 'step z=5 mm', required: true },
      { name: 'until', label: 'Until', kind: 'text', hint: '2 s' },
    ],
  },
  {
    kind: 'rig',
    title: 'Measure on the simulated test rig',
    what: 'Excites the machine and writes a record with the noise of instruments.',
    fields: [
      { name: 'excite', label: 'Signals, one a line', kind: 'lines', hint: 'noise x=1 mm, ry=0.1 deg, to=40' },
      { name: 'duration', label: 'Duration', kind: 'text', value: '60 s' },
      { name: 'seed', label: 'Seed', kind: 'text', hint: '1' },
      { name: 'output', label: 'Record to write', kind: 'path', hint: 'run.h5', required: true },
    ],
  },
  {
    kind: 'calibrate',
    title: 'Calibrate parameters',
    what: 'Fits free parameters to measured modes or to a record.',
    fields: [
      { name: 'targets', label: 'Targets', kind: 'record', required: true },
      { name: 'free', label: 'Free parameters, one a line', kind: 'lines', value: 'legs.guide_sleeve.stiffness', required: true },
      { name: 'output', label: 'Calibrated machine file to write (optional)', kind: 'path', hint: 'calibrated.toml' },
    ],
  },
  {
    kind: 'map',
    title: 'Map of the workspace',
    what: 'Modes over two directions of the pose.',
    fields: [
      { name: 'over', label: 'Directions, one a line', kind: 'lines', value: pose, required: true },
      { name: 'worst_over', label: 'Worst over further directions, one a line (optional)', kind: 'lines', hint: 'rx=-5:5:3 deg' },
      { name: 'also', label: 'Further outputs, one a line (optional)', kind: 'lines', hint: 'stiffness' },
      { name: 'value', label: 'Value shown', kind: 'text', hint: 'lowest' },
      { name: 'want', label: 'Requirements, one a line', kind: 'lines', hint: 'lowest >= 5 Hz' },
      { name: 'rows', label: 'HDF5 file of all rows (optional)', kind: 'path', hint: 'map.h5' },
    ],
  },
  {
    kind: 'montecarlo',
    title: 'Monte Carlo',
    what: 'Effect of scatter on the modes, and the probability of missing a requirement.',
    fields: [
      { name: 'vary', label: 'Distributions, one a line', kind: 'lines', value: 'legs.guide_sleeve.stiffness=normal ± 10 % per leg', required: true },
      { name: 'correlate', label: 'Correlations, one a line (optional)', kind: 'lines', hint: 'platform.mass, legs.rod.mass = 0.6' },
      { name: 'commands', label: 'Motion that every sample makes, one a line (optional)', kind: 'lines', hint: 'step z=5 mm' },
      { name: 'also', label: 'Further outputs, one a line (optional)', kind: 'lines', hint: 'stiffness' },
      { name: 'want', label: 'Requirements, one a line', kind: 'lines', hint: 'x >= 6 Hz' },
      { name: 'samples', label: 'Samples', kind: 'text', hint: '1000' },
      { name: 'rows', label: 'HDF5 file of all rows (optional)', kind: 'path', hint: 'scatter.h5' },
    ],
  },
];

export type Values = Record<string, string | string[] | boolean>;

interface Control {
  element: HTMLElement;
  value(): string | string[] | boolean | null;
  records?(known: KnownRecord[]): void;
}

const lines = (text: string): string[] =>
  text.split('\n').map((line) => line.trim()).filter(Boolean);

function textControl(field: Field): Control {
  const id = identifier('studio-field');
  const many = field.kind === 'lines';
  const attributes = { id, 'data-field-of-job': field.name, placeholder: field.hint ?? '', required: field.required ?? false, spellcheck: 'false', autocomplete: 'off' };
  const input = many
    ? html('textarea', { ...attributes, rows: 2 }, field.value ?? '')
    : html('input', { ...attributes, type: 'text', value: field.value ?? '' });
  return {
    element: html('div', { class: 'field' }, html('label', { for: id }, field.label), input),
    value: () => {
      if (many) return lines(input.value).length > 0 ? lines(input.value) : null;
      return input.value.trim() || null;
    },
  };
}

function checkControl(field: Field): Control {
  const input = html('input', { type: 'checkbox', 'data-field-of-job': field.name });
  return {
    element: html('label', { class: 'check' }, input, field.label),
    value: () => (input.checked ? true : null),
  };
}

function recordControl(field: Field): Control {
  const id = identifier('studio-field');
  const list = html('select', { id, 'data-field-of-job': field.name });
  const pathId = identifier('studio-field');
  const path = html('input', { type: 'text', id: pathId, placeholder: 'run.h5', 'data-path-of-record': field.name, spellcheck: 'false', autocomplete: 'off' });
  const pathField = html('div', { class: 'field' }, html('label', { for: pathId }, 'Path on this computer'), path);
  const show = () => (pathField.hidden = list.value !== '');
  list.addEventListener('change', show);
  let shown = '';
  return {
    element: html('div', { class: 'fields' }, html('div', { class: 'field' }, html('label', { for: id }, field.label), list), pathField),
    value: () => {
      const chosen = list.value || path.value.trim();
      if (!chosen) return null;
      return field.name === 'records' ? [chosen] : chosen;
    },
    records: (known) => {
      const names = JSON.stringify(known);
      if (names === shown) return;
      shown = names;
      const before = list.value;
      const options = known.map(({ number, name }) => html('option', { value: `record:${number}` }, name));
      list.replaceChildren(...options.reverse(), html('option', { value: '' }, 'a file of this computer'));
      if (before && [...list.options].some(({ value }) => value === before)) list.value = before;
      show();
    },
  };
}

function control(field: Field): Control {
  if (field.kind === 'check') return checkControl(field);
  if (field.kind === 'record') return recordControl(field);
  return textControl(field);
}

export interface JobForm {
  element: HTMLElement;
  /** Those that can be chosen. */
  records(known: KnownRecord[]): void;
  /** What is typed in the forms of all kinds. */
  draft(): Pick<Draft, 'kind' | 'fields'>;
  restore(draft: Draft): void;
}

/** `start` gets the kind and the fields that are not empty. */
export function jobForm(start: (kind: string, fields: Values) => void): JobForm {
  const id = identifier('studio-kind');
  const choice = html('select', { id, 'data-control': 'job-kind' }, ...forms.map(({ kind, title }) => html('option', { value: kind }, title)));
  const what = html('p', { class: 'note' });
  const place = html('div', { class: 'fields' });
  const made = new Map<string, Map<string, Control>>();
  let known: KnownRecord[] = [];
  let controls = new Map<string, Control>();
  const make = (form: Form) => {
    const parts = made.get(form.kind) ?? new Map(form.fields.map((field) => [field.name, control(field)]));
    made.set(form.kind, parts);
    for (const one of parts.values()) one.records?.(known);
    return parts;
  };
  const show = () => {
    const form = forms.find(({ kind }) => kind === choice.value) as Form;
    controls = make(form);
    what.textContent = form.what;
    place.replaceChildren(...[...controls.values()].map(({ element }) => element));
  };
  choice.addEventListener('change', show);
  const element = html(
    'form',
    { class: 'job-form', novalidate: true, 'aria-label': 'New job' },
    html('div', { class: 'field' }, html('label', { for: id }, 'Calculate'), choice),
    what,
    place,
    html('div', { class: 'row' }, html('button', { type: 'submit', class: 'primary', 'data-control': 'start-job' }, 'Start')),
  );
  element.addEventListener('submit', (event) => {
    event.preventDefault();
    const fields: Values = {};
    for (const [name, one] of controls) {
      const value = one.value();
      if (value !== null) fields[name] = value;
    }
    start(choice.value, fields);
  });
  show();
  return {
    element,
    records: (list) => {
      known = list;
      for (const one of controls.values()) one.records?.(known);
    },
    draft: () => {
      const fields: Draft['fields'] = {};
      for (const [kind, parts] of made)
        for (const [name, { element: field }] of parts) fields[`${kind}.${name}`] = valuesIn(field);
      return { kind: choice.value, fields };
    },
    restore: ({ kind, fields }) => {
      for (const form of forms) {
        if (!Object.keys(fields).some((name) => name.startsWith(`${form.kind}.`))) continue;
        for (const [name, { element: field }] of make(form)) setValues(field, fields[`${form.kind}.${name}`]);
      }
      if (forms.some((form) => form.kind === kind)) choice.value = kind;
      show();
    },
  };
}

/** A path and what to do with it; where a file exists there, a second button replaces it. */
export function pathForm(
  label: string,
  hint: string,
  action: string,
  run: (path: string, replace: boolean) => Promise<string>,
  name: string,
): HTMLElement {
  const id = identifier('studio-path');
  const input = html('input', { type: 'text', id, placeholder: hint, required: true, spellcheck: 'false', autocomplete: 'off', 'data-path': name });
  const said = html('p', { class: 'said', role: 'status' });
  const replace = button('Replace it', () => void tryIt(true), { 'data-control': `${name}-replace` });
  replace.hidden = true;
  const tryIt = async (replacing: boolean): Promise<void> => {
    replace.hidden = true;
    said.classList.remove('problem');
    try {
      said.textContent = await run(input.value.trim(), replacing);
    } catch (error) {
      const refused = error as { message: string; exists?: boolean };
      said.classList.add('problem');
      said.textContent = refused.message;
      replace.hidden = !refused.exists;
    }
  };
  input.addEventListener('input', () => (replace.hidden = true));
  const form = html('form', { class: 'path-form', novalidate: true },
    html('label', { for: id }, label), input,
    html('button', { type: 'submit', 'data-control': name }, action), replace, said);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    void tryIt(false);
  });
  return form;
}
