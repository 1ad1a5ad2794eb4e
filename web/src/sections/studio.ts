// The studio: the machine's file, records, jobs. Only on a page that the program serves.

import { button, html, identifier } from '../dom';
import type { State } from '../state';
import { Client, type StudioState } from '../studio/client';
import { keepDraft, setValues, takeDraft, valuesIn } from '../studio/draft';
import { jobForm, pathForm, type Values } from '../studio/forms';
import { JobList } from '../studio/jobs';
import { shareValues } from '../studio/sharing';
import type { Section } from './section';

export const studio: Section = {
  id: 'studio',
  title: 'Studio',
  applies: (report) => report.studio !== undefined,
  render: (state, host) => {
    new Studio(state, host);
  },
};

/** Jobs that were begun on this page, and the section to show when it loads again. */
const ownJobs = 'hydrapod-own-jobs';
const sectionToShow = 'hydrapod-show';

class Studio {
  private readonly client = new Client();
  private readonly file = html('p', { class: 'studio-file' });
  private readonly changed = html('p', { class: 'note' });
  private readonly said = html('p', { class: 'said', role: 'status', 'aria-live': 'polite' });
  private readonly values = html('p', { class: 'said problem', role: 'alert' });
  private readonly warning = html('div', { class: 'studio-warning', role: 'alert' });
  private readonly edits = html('div', { class: 'planned' });
  private readonly records = html('ul', { class: 'records', 'aria-label': 'Records' });
  private readonly jobs = new JobList(this.client, (text) => this.say(text));
  private readonly form = jobForm((kind, fields) => void this.start(kind, fields));
  private readonly save = button('Save', () => void this.saveInPlace(), { class: 'primary', 'data-control': 'save' });
  private readonly files = this.otherFiles();
  private readonly page: number;
  private shownRecords = '';
  private draft = takeDraft();

  constructor(
    private readonly state: State,
    host: HTMLElement,
  ) {
    this.page = state.report.studio?.page ?? 0;
    const box = (title: string, ...parts: HTMLElement[]) =>
      html('div', { class: 'studio-part' }, html('h3', {}, title), ...parts);
    host.append(
      this.warning,
      html(
        'div',
        { class: 'studio-parts' },
        box('Machine file', this.file, this.changed, this.values, html('div', { class: 'row' }, this.save), this.edits, this.files),
        box('Records', this.dropZone(), this.records),
        box('New job', this.form.element),
      ),
      this.said,
      this.jobs.element,
    );
    document.body.addEventListener('dragover', (event) => this.over(event));
    document.body.addEventListener('drop', (event) => this.dropped(event));
    document.body.addEventListener('dragleave', () => document.body.classList.remove('dragging'));
    shareValues(state, this.client, (problem) => (this.values.textContent = problem));
    this.client.listen(() => this.show());
    this.showSection();
  }

  private say(text: string, problem = false): void {
    this.said.textContent = text;
    this.said.classList.toggle('problem', problem);
  }

  /** After the page has loaded again with a result that was begun here. */
  private showSection(): void {
    const id = sessionStorage.getItem(sectionToShow);
    sessionStorage.removeItem(sectionToShow);
    if (!id) return;
    requestAnimationFrame(() => {
      const heading = document.getElementById(`${id}-title`);
      heading?.setAttribute('tabindex', '-1');
      heading?.focus({ preventScroll: true });
      document.getElementById(id)?.scrollIntoView({ behavior: 'auto' });
    });
  }

  private get own(): number[] {
    return JSON.parse(sessionStorage.getItem(ownJobs) ?? '[]');
  }

  private show(): void {
    const { state, connected } = this.client;
    if (!connected) return this.showLost();
    if (!state) return;
    if (document.body.classList.contains('lost')) return this.load();
    if (state.page !== this.page) return this.loadAgain(state);
    this.warning.replaceChildren();
    if (state.differs_on_disk) this.showDiffering();
    this.file.replaceChildren(
      ...(state.file ? [html('code', {}, state.file)] : ['A new machine, in no file yet: save it under a name.']),
    );
    this.changed.textContent = state.changed
      ? 'Values were changed that are not in the file. Jobs use them.'
      : 'The file has the values that are shown.';
    this.save.disabled = !state.changed || !state.file || state.differs_on_disk;
    void this.showEdits(state.changed);
    this.showRecords(state);
    this.jobs.show(state.jobs);
    this.form.records(state.records);
    this.restoreDraft();
  }

  /** After the page has loaded again: records can only be chosen once they are known. */
  private restoreDraft(): void {
    const { draft } = this;
    this.draft = null;
    if (!draft) return;
    this.form.restore(draft);
    setValues(this.files, draft.fields['files']);
    [this.files, this.edits.querySelector('details')].forEach((part, k) => part?.toggleAttribute('open', draft.unfolded[k]));
  }

  /** With what was typed and not yet sent. */
  private load(): void {
    const { kind, fields } = this.form.draft();
    const unfolded = [this.files, this.edits.querySelector('details')].map((part) => part?.hasAttribute('open') ?? false);
    keepDraft({ kind, fields: { ...fields, files: valuesIn(this.files) }, unfolded });
    location.reload();
  }

  private loadAgain(state: StudioState): void {
    const own = this.own;
    const done = state.jobs.filter((job) => own.includes(job.id) && job.state === 'done' && job.section);
    const newest = done[done.length - 1];
    const shown = sessionStorage.getItem(ownJobs + '-shown');
    if (newest && shown !== String(newest.id)) {
      sessionStorage.setItem(sectionToShow, newest.section);
      sessionStorage.setItem(ownJobs + '-shown', String(newest.id));
    }
    this.load();
  }

  private showLost(): void {
    if (this.warning.dataset['kind'] === 'lost') return;
    this.warning.dataset['kind'] = 'lost';
    this.warning.replaceChildren(
      html('strong', {}, 'The program behind this page does not answer.'),
      ' It was ended, or the connection is lost. What the page shows stays, and sliders go on; jobs and saving need the program. To go on, run ',
      html('code', {}, 'hydrapod studio'),
      ' again and open the address that it prints.',
    );
    document.body.classList.add('lost');
    for (const control of document.querySelectorAll<HTMLButtonElement>('#studio button')) control.disabled = true;
  }

  private showDiffering(): void {
    this.warning.replaceChildren(
      html('strong', {}, 'The machine file on the disk has changed since it was read.'),
      ' It is not written over. ',
      button('Read it again', () => void this.post('reload', {}, 'The file was read again.'), { 'data-control': 'reload' }),
      ' The values changed here are lost then; save them under another name to keep them.',
    );
  }

  private async post(path: string, body: object, done: string): Promise<void> {
    try {
      await this.client.post(path, body);
      this.say(done);
    } catch (error) {
      this.say((error as Error).message, true);
    }
  }

  private saveInPlace(): Promise<void> {
    return this.post('save', {}, 'Saved.');
  }

  /** What saving would write. */
  private async showEdits(changed: boolean): Promise<void> {
    if (!changed) return this.edits.replaceChildren();
    const edits = await this.client.get<{ path: string; value: string }[]>('edits').catch(() => []);
    const open = this.edits.querySelector('details')?.open ?? false;
    this.edits.replaceChildren(
      html(
        'details',
        { open },
        html('summary', {}, `What saving writes: ${edits.length} value${edits.length === 1 ? '' : 's'}; comments and all else stay`),
        html('ul', {}, ...edits.map(({ path, value }) => html('li', {}, html('code', {}, `${path} = ${value}`)))),
      ),
    );
  }

  private otherFiles(): HTMLElement {
    const saveAs = (path: string, replace: boolean) =>
      this.client.post('save', { path, replace }).then(() => `Saved as ${path}.`);
    const savePage = (path: string, replace: boolean) =>
      this.client.post<{ written: string }>('page', { path, replace }).then(({ written }) => `Wrote ${written}.`);
    return html(
      'details',
      { class: 'other-files' },
      html('summary', {}, 'Save under another name, or as a report'),
      pathForm('Machine file', 'changed.toml', 'Save as', saveAs, 'save-as'),
      pathForm('Report with the results of this page', 'report.html', 'Save report', savePage, 'save-page'),
    );
  }

  // ---- records ----------------------------------------------------------------------------------

  private dropZone(): HTMLElement {
    const id = identifier('record-file');
    const input = html('input', { type: 'file', id, class: 'unseen', 'data-control': 'record-file' });
    input.addEventListener('change', () => {
      for (const file of input.files ?? []) void this.take(file);
      input.value = '';
    });
    return html('div', { class: 'drop-zone' }, input,
      html('label', { for: id }, html('strong', {}, 'Choose a record'), ' or drop it onto the page: HDF5, MAT, CSV, Universal File, RPC III. It is identified and diagnosed.'));
  }

  private over(event: DragEvent): void {
    if (![...(event.dataTransfer?.types ?? [])].includes('Files')) return;
    event.preventDefault();
    document.body.classList.add('dragging');
  }

  private dropped(event: DragEvent): void {
    document.body.classList.remove('dragging');
    const files = [...(event.dataTransfer?.files ?? [])];
    if (files.length === 0) return;
    event.preventDefault();
    for (const file of files) void this.take(file);
  }

  /** Sends a record, then has it identified and diagnosed. */
  private async take(file: File): Promise<void> {
    try {
      const number = await this.client.send(file, (share) => this.say(`Sending ${file.name}: ${Math.round(100 * share)} %`));
      this.say(`${file.name} has arrived.`);
      await this.measure(number);
    } catch (error) {
      this.say(`${file.name}: ${(error as Error).message}`, true);
    }
  }

  private async measure(record: number): Promise<void> {
    await this.begin('identify', { records: [`record:${record}`] }, ['diagnose']);
  }

  private showRecords({ records }: StudioState): void {
    const names = JSON.stringify(records);
    if (names === this.shownRecords) return;
    this.shownRecords = names;
    this.records.replaceChildren(
      ...records.map(({ number, name }) =>
        html('li', {}, html('span', { class: 'record-name' }, name),
          button('Identify and diagnose', () => void this.measure(number).catch((error: Error) => this.say(error.message, true)), { 'aria-label': `Identify and diagnose ${name}` })),
      ),
    );
  }

  // ---- jobs -------------------------------------------------------------------------------------

  private async begin(kind: string, fields: Values, then: string[] = [], replace = false): Promise<void> {
    const asked = { kind, fields, then, replace, pose: this.state.poseNumber };
    const { id } = await this.client.post<{ id: number }>('job', asked);
    // those that follow have the next numbers
    const more = then.map((_, k) => id + 1 + k);
    sessionStorage.setItem(ownJobs, JSON.stringify([...this.own, id, ...more].slice(-50)));
  }

  private async start(kind: string, fields: Values, replace = false): Promise<void> {
    try {
      await this.begin(kind, fields, [], replace);
      this.say('The job was started.');
    } catch (error) {
      const refused = error as { message: string; exists?: boolean };
      this.say(refused.message, true);
      if (refused.exists)
        this.said.append(' ', button('Replace the file', () => void this.start(kind, fields, true), { 'data-control': 'job-replace' }));
    }
  }
}
