// The studio as a process: started on a free port, spoken to, stopped.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { after } from 'node:test';
import { request } from 'node:http';
import { connect } from 'node:net';

const { HYDRAPOD_PROGRAM } = process.env;
assert.ok(HYDRAPOD_PROGRAM, 'started by ctest, which says where things are');

/** Of anything that must end [ms]; machines with other work take long. */
export const patience = 60000;

// A test that fails leaves its server running, and node waits for it until ctest has lost patience.
const started = [];
after(() => started.forEach((server) => server.process.kill('SIGKILL')));

export class StudioServer {
  /** Starts it with `words`; resolves when it has said its address. */
  static async start(words, options = {}) {
    const server = new StudioServer();
    started.push(server);
    server.process = spawn(HYDRAPOD_PROGRAM, ['studio', ...words, '--no-browser'], {
      stdio: ['ignore', 'pipe', 'pipe'],
      ...options,
    });
    server.errors = '';
    server.process.stderr.on('data', (data) => (server.errors += data));
    server.ended = once(server.process, 'exit');
    const address = await Promise.race([
      once(server.process.stdout, 'data').then(([data]) => String(data).trim()),
      server.ended.then(() => Promise.reject(new Error(server.errors))),
    ]);
    server.url = address;
    server.key = new URL(address).pathname.replaceAll('/', '');
    server.port = Number(new URL(address).port);
    server.host = `127.0.0.1:${server.port}`;
    return server;
  }

  /** Ctrl-C; its exit code and how long it took [ms]. */
  async stop(signal = 'SIGINT') {
    const begin = Date.now();
    if (this.process.exitCode === null && this.process.signalCode === null) this.process.kill(signal);
    const [code] = await this.ended;
    return { code, milliseconds: Date.now() - begin };
  }

  /** { status, text, headers } of a request below the key. */
  ask(path, { method = 'GET', headers = {}, body, target } = {}) {
    return new Promise((resolve, reject) => {
      const sent = request(
        { host: '127.0.0.1', port: this.port, method, path: target ?? `/${this.key}/${path}`, headers, agent: false },
        (response) => {
          const parts = [];
          response.on('data', (part) => parts.push(part));
          response.on('end', () => resolve({ status: response.statusCode, headers: response.headers, text: String(Buffer.concat(parts)) }));
        },
      );
      sent.on('error', reject);
      if (body !== undefined) sent.write(body);
      sent.end();
    });
  }

  async json(path) {
    return JSON.parse((await this.ask(path)).text);
  }

  post(path, body = {}) {
    return this.ask(path, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: typeof body === 'string' ? body : JSON.stringify(body),
    });
  }

  upload(name, bytes) {
    return this.ask(`record?${encodeURIComponent(name)}`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/octet-stream' },
      body: bytes,
    });
  }

  /** What comes back for these bytes until the connection ends; '' where it was just ended. */
  raw(bytes, { wait = patience } = {}) {
    return new Promise((resolve) => {
      let answer = '';
      const socket = connect(this.port, '127.0.0.1');
      const end = () => {
        socket.destroy();
        resolve(answer);
      };
      socket.setTimeout(wait, end);
      socket.on('data', (data) => (answer += data.toString('latin1')));
      socket.on('error', end);
      socket.on('close', end);
      socket.write(bytes);
    });
  }

  /** The job when it is over. */
  async over(id) {
    for (const begin = Date.now(); Date.now() - begin < 5 * patience; ) {
      const job = await this.json(`job/${id}`);
      if (job.state !== 'waiting' && job.state !== 'running') return job;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    throw new Error(`job ${id} does not end`);
  }
}
