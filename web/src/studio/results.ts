// Results that have no section of their own: what a job found, with its picture.

import { button, download, html } from '../dom';
import { scroller, tableHead } from '../table';
import type { Client, WholeJob } from './client';

interface Fitted {
  candidates: {
    name: string;
    misfit?: number;
    parameters?: {
      paths: string[];
      unit: string;
      start: number;
      value: number;
      deviation: number | null;
      verdict: string;
    }[];
  }[];
}

interface Studied {
  rows: number;
  statuses: Record<string, number>;
  outputs: {
    name: string;
    unit: string;
    meaning: string;
    count: number;
    least?: number;
    most?: number;
    quantiles?: { probability: number; value: number }[];
  }[];
  requirements: {
    requirement: string;
    samples: number;
    missed: number;
    probability_of_missing: number;
    interval: [number, number] | null;
  }[];
}

const plain = (value: number | null | undefined): string =>
  value === null || value === undefined ? '' : Number(value.toPrecision(5)).toString();

function table(caption: string, titles: string[], rows: string[][]): HTMLElement {
  return scroller(
    caption,
    html(
      'table',
      { class: 'numbers-table' },
      html('caption', {}, caption),
      tableHead(...titles.map((title): [string] => [title])),
      html(
        'tbody',
        {},
        ...rows.map(([first, ...others]) =>
          html('tr', {}, html('th', { scope: 'row' }, first), ...others.map((text) => html('td', {}, text))),
        ),
      ),
    ),
  );
}

function fitted(result: Fitted): HTMLElement[] {
  return result.candidates
    .filter(({ parameters }) => parameters)
    .slice(0, 3)
    .map(({ name, misfit, parameters }) =>
      table(
        `Fitted parameters${name ? `, ${name}` : ''}${misfit === undefined ? '' : `; misfit ${plain(misfit)}`}`,
        ['parameter', 'before', 'fitted', '±', 'unit', 'verdict'],
        (parameters ?? []).map((p) => [p.paths.join(', '), plain(p.start), plain(p.value), plain(p.deviation), p.unit === '1' ? '' : p.unit, p.verdict]),
      ),
    );
}

function studied(result: Studied): HTMLElement[] {
  const at = (output: Studied['outputs'][number], probability: number) =>
    plain(output.quantiles?.find((q) => q.probability === probability)?.value);
  const outputs = (caption: string, shown: Studied['outputs']) =>
    table(
      caption,
      ['output', 'least', '5 %', 'median', '95 %', 'most', 'meaning'],
      shown.map((o) => [o.name, plain(o.least), at(o, 0.05), at(o, 0.5), at(o, 0.95), plain(o.most), o.meaning]),
    );
  const known = result.outputs.filter(({ count, least }) => count > 0 && least !== undefined);
  const missing = Object.entries(result.statuses).filter(([name, count]) => name !== 'computed' && count > 0);
  const parts = [
    outputs(`Frequencies, Hz, in ${result.rows} rows`, known.filter(({ unit }) => unit === 'Hz')),
  ];
  const others = known.filter(({ unit }) => unit !== 'Hz');
  if (others.length > 0)
    parts.push(
      html('details', {}, html('summary', {}, `${others.length} other outputs`), outputs('Other outputs', others)),
    );
  if (result.requirements.length > 0)
    parts.unshift(
      table(
        'Requirements',
        ['requirement', 'missed', 'of', 'probability of missing', '95 % interval'],
        result.requirements.map((r) => [r.requirement, String(r.missed), String(r.samples), plain(r.probability_of_missing), r.interval ? r.interval.map(plain).join(' to ') : '']),
      ),
    );
  if (missing.length > 0)
    parts.unshift(html('p', {}, `Rows without a result: ${missing.map(([name, count]) => `${count} ${name.replaceAll('_', ' ')}`).join(', ')}.`));
  return parts;
}

/** The whole job, fetched and drawn. */
export async function showResult(client: Client, id: number, host: HTMLElement): Promise<void> {
  const job = await client.get<WholeJob>(`job/${id}`);
  const result = job.result as (Fitted & Studied) | null;
  const parts: HTMLElement[] = [];
  if (job.picture)
    parts.push(
      html('figure', { class: 'result-picture' }, html('img', {
        src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(job.picture)}`,
        alt: `Picture of the result of ${job.title}; the table beside it has its numbers`,
      })),
    );
  const tables = result?.candidates ? fitted(result) : result?.outputs ? studied(result) : [];
  if (tables.length > 0) parts.push(html('div', { class: 'result-tables' }, ...tables));
  const name = `${job.kind}-${job.id}`;
  const tools = html('div', { class: 'row' });
  if (result)
    tools.append(button('Download JSON', () => download(`${name}.json`, new Blob([JSON.stringify(result, null, 1)], { type: 'application/json' }))));
  if (job.picture)
    tools.append(button('Download SVG', () => download(`${name}.svg`, new Blob([job.picture], { type: 'image/svg+xml' }))));
  host.replaceChildren(html('div', { class: 'result-parts' }, ...parts), tools);
}
