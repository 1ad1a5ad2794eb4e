// The program behind the page, as the page sees it: requests, and events of what has changed.

import type { Setting } from '../core/core';

export interface Job {
  id: number;
  kind: string;
  title: string;
  state: 'waiting' | 'running' | 'done' | 'failed' | 'cancelled';
  fraction: number;
  /** Of a job that is over, that it took. */
  seconds: number;
  seconds_left: number | null;
  /** Of the page, where its result goes; empty: it is shown with the job. */
  section: string;
  /** File that it writes. */
  output: string;
  has_result: boolean;
  messages: string[];
}

export interface WholeJob extends Job {
  arguments: string[];
  result: unknown;
  /** SVG */
  picture: string;
}

export interface KnownRecord {
  number: number;
  name: string;
  given: boolean;
}

export interface StudioState {
  /** A page of another number shows other results. */
  page: number;
  /** Empty: the machine has no file yet. */
  file: string;
  folder: string;
  differs_on_disk: boolean;
  /** Is there anything to save? */
  changed: boolean;
  values: Setting[];
  values_number: number;
  /** The page that changed them. */
  values_by: string;
  records: KnownRecord[];
  jobs: Job[];
}

/** What the program said instead of doing it. */
export class Refused extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }

  /** A file exists at the path that was given. */
  get exists(): boolean {
    return this.message.includes('a file exists there');
  }
}

const noAnswer = 'the program does not answer; it may have ended';
/** Between two attempts to find the program again [ms]. */
const patience = 2000;

export class Client {
  /** Of this page among others. */
  readonly name = `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;
  state: StudioState | null = null;
  connected = false;
  private listeners: (() => void)[] = [];
  private leaving = false;

  constructor() {
    addEventListener('pagehide', () => (this.leaving = true));
    this.connect();
  }

  listen(listener: () => void): void {
    this.listeners.push(listener);
  }

  private tell(): void {
    for (const listener of this.listeners) listener();
  }

  private connect(): void {
    const address = new URL('events', location.href.split('#')[0]);
    address.protocol = address.protocol.replace('http', 'ws');
    const socket = new WebSocket(address);
    socket.onmessage = ({ data }) => {
      this.connected = true;
      this.take(JSON.parse(data as string));
    };
    socket.onclose = () => {
      if (this.leaving) return;
      if (this.connected || !this.state) {
        this.connected = false;
        this.tell();
      }
      setTimeout(() => this.connect(), patience);
    };
  }

  private take(event: { state?: StudioState; job?: Job }): void {
    if (event.state) this.state = event.state;
    const { job } = event;
    if (job && this.state) {
      const at = this.state.jobs.findIndex(({ id }) => id === job.id);
      if (at >= 0) this.state.jobs[at] = job;
      else this.state.jobs.push(job);
    }
    this.tell();
  }

  async get<T>(path: string): Promise<T> {
    return this.answer(fetch(path));
  }

  async post<T>(path: string, body: object = {}): Promise<T> {
    const headers = { 'Content-Type': 'application/json' };
    return this.answer(fetch(path, { method: 'POST', headers, body: JSON.stringify(body) }));
  }

  private async answer<T>(request: Promise<Response>): Promise<T> {
    const response = await request.catch(() => {
      throw new Refused(0, noAnswer);
    });
    const json = await response.json();
    if (!response.ok) throw new Refused(response.status, json.error);
    return json;
  }

  /** Sends a measured file; its number in the list of records. */
  send(file: File, progress: (share: number) => void): Promise<number> {
    return new Promise((resolve, reject) => {
      const request = new XMLHttpRequest();
      request.open('POST', `record?${encodeURIComponent(file.name)}`);
      request.setRequestHeader('Content-Type', 'application/octet-stream');
      request.responseType = 'json';
      request.upload.onprogress = ({ loaded, total }) => progress(total > 0 ? loaded / total : 0);
      request.onerror = () => reject(new Refused(0, noAnswer));
      request.onload = () =>
        request.status === 200
          ? resolve(request.response.number)
          : reject(new Refused(request.status, request.response?.error ?? noAnswer));
      request.send(file);
    });
  }
}
