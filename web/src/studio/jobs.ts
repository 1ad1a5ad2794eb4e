// The jobs of the studio: progress with the time left, messages, cancel, results.

import { button, html } from '../dom';
import type { Client, Job } from './client';
import { showResult } from './results';

const duration = (seconds: number): string =>
  seconds < 90 ? `${Math.max(1, Math.round(seconds))} s` : `${Math.round(seconds / 60)} min`;

function stateText(job: Job): string {
  switch (job.state) {
    case 'waiting':
      return 'waits for its turn';
    case 'running': {
      const left = job.seconds_left === null ? '' : `, ${duration(job.seconds_left)} left`;
      return `${Math.round(100 * job.fraction)} %${left}`;
    }
    case 'done':
      return `done in ${job.seconds < 1 ? 'less than 1 s' : duration(job.seconds)}${job.output ? `; wrote ${job.output}` : ''}`;
    case 'failed':
      return 'failed';
    case 'cancelled':
      return 'cancelled';
  }
}

const isOver = ({ state }: Job): boolean => state !== 'waiting' && state !== 'running';

class Row {
  readonly element: HTMLElement;
  private readonly words = html('span', { class: 'job-state' });
  private readonly bar: HTMLProgressElement;
  private readonly cancel: HTMLButtonElement;
  private readonly messages = html('div', { class: 'messages' });
  private readonly place = html('div', { class: 'result' });
  private readonly tools: HTMLElement;
  private shownMessages = 0;

  constructor(
    private job: Job,
    client: Client,
    say: (text: string) => void,
  ) {
    this.bar = html('progress', { max: 1, 'aria-label': `Progress: ${job.title}` });
    this.cancel = button('Cancel', () => {
      this.cancel.disabled = true;
      client.post(`cancel/${job.id}`).catch((error: Error) => say(error.message));
    }, { 'data-control': 'cancel-job', 'aria-label': `Cancel: ${job.title}` });
    this.tools = html('span', { class: 'row' });
    this.element = html(
      'li',
      { class: 'job', 'data-job': job.id },
      html('div', { class: 'job-head' }, html('strong', {}, job.title), this.words, this.bar, this.cancel, this.tools),
      this.messages,
      this.place,
    );
    this.show(job);
    if (job.has_result) this.offerResult(client, say);
  }

  private offerResult(client: Client, say: (text: string) => void): void {
    const control = button('Show result', () => {
      const shown = this.place.childElementCount > 0;
      control.setAttribute('aria-expanded', String(!shown));
      control.textContent = shown ? 'Show result' : 'Hide result';
      if (shown) this.place.replaceChildren();
      else showResult(client, this.job.id, this.place).catch((error: Error) => say(error.message));
    }, { 'aria-expanded': 'false', 'data-control': 'show-result' });
    this.tools.append(control);
  }

  show(job: Job): void {
    this.job = job;
    this.element.dataset['state'] = job.state;
    this.words.textContent = stateText(job);
    this.bar.hidden = this.cancel.hidden = isOver(job);
    if (job.state === 'running' && job.fraction > 0) this.bar.value = job.fraction;
    if (isOver(job) && job.section && job.state === 'done' && this.tools.childElementCount === 0)
      this.tools.append(html('a', { href: `#${job.section}` }, 'Result on this page'));
    if (job.messages.length === this.shownMessages) return;
    this.shownMessages = job.messages.length;
    const list = html('ul', {}, ...job.messages.map((text) => html('li', { class: text.includes('error:') ? 'problem' : '' }, text)));
    if (job.state === 'failed') this.messages.replaceChildren(list);
    else
      this.messages.replaceChildren(
        html('details', {}, html('summary', {}, `${job.messages.length} message${job.messages.length > 1 ? 's' : ''}`), list),
      );
  }

  /** Is this row, built once for a job with its result, too old? */
  outdated(job: Job): boolean {
    return job.state !== this.job.state && isOver(job);
  }
}

export class JobList {
  readonly element = html('ul', { class: 'jobs', 'aria-label': 'Jobs' });
  private readonly rows = new Map<number, Row>();
  private readonly states = new Map<number, string>();

  constructor(
    private readonly client: Client,
    private readonly say: (text: string) => void,
  ) {}

  show(jobs: Job[]): void {
    for (const job of jobs) {
      const before = this.states.get(job.id);
      const row = this.rows.get(job.id);
      if (!row || row.outdated(job)) {
        const made = new Row(job, this.client, this.say);
        if (row) row.element.replaceWith(made.element);
        else this.element.prepend(made.element);
        this.rows.set(job.id, made);
      } else row.show(job);
      if (before !== undefined && before !== job.state && isOver(job)) this.announce(job);
      this.states.set(job.id, job.state);
    }
    const there = new Set(jobs.map(({ id }) => id));
    for (const [id, row] of this.rows)
      if (!there.has(id)) {
        row.element.remove();
        this.rows.delete(id);
      }
  }

  /** For those who do not see the list change. */
  private announce(job: Job): void {
    const cause = job.state === 'failed' ? `: ${job.messages[job.messages.length - 1] ?? ''}` : '';
    this.say(`${job.title}: ${stateText(job)}${cause}`);
  }
}
