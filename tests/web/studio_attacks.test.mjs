// The studio against others on the same computer, other pages in the same browser, and wrong input: refused,
// nothing told, still serving afterwards.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { chmodSync, copyFileSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { StudioServer } from './studio_server.mjs';

const { HYDRAPOD_PROGRAM, HYDRAPOD_SOURCE } = process.env;
const folder = mkdtempSync(join(tmpdir(), 'hydrapod-attacks-'));
const machine = join(folder, 'machine.toml');
const temporary = join(folder, 'tmp');
let server;

before(async () => {
  execFileSync('mkdir', [temporary]);
  copyFileSync(join(HYDRAPOD_SOURCE, 'models', 'zhang-jiang-2021.toml'), machine);
  server = await StudioServer.start([machine], { cwd: folder, env: { ...process.env, TMPDIR: temporary } });
});

after(async () => {
  await server.stop();
  rmSync(folder, { recursive: true, force: true });
});

/** The server answers its owner as ever. */
async function serves() {
  const begin = Date.now();
  const { status, text } = await server.ask('state');
  assert.equal(status, 200);
  assert.equal(JSON.parse(text).file, machine);
  return Date.now() - begin;
}

/** No file of the user, no key, no address of the machine file. */
function tellsNothing(text, what) {
  for (const secret of [server.key, machine, folder, 'root:', 'platform'])
    assert.ok(!text.includes(secret), `${what} tells ${secret}`);
}

const head = (lines) => `${lines.join('\r\n')}\r\n\r\n`;
const statusOf = (answer) => Number(/^HTTP\/1\.1 (\d+)/.exec(answer)?.[1] ?? 0);
const wait = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

test('names of other hosts are refused, so that DNS rebinding reaches nothing', async () => {
  for (const host of [
    'evil.example', `evil.example:${server.port}`, `127.0.0.1.evil.example:${server.port}`,
    `localhost.evil.example:${server.port}`, `localhost:${server.port + 1}`, '127.0.0.1', 'localhost',
    `10.0.0.1:${server.port}`, `0.0.0.0:${server.port}`, `[::ffff:10.0.0.1]:${server.port}`, `2130706433:${server.port}`,
    `127.0.0.1:${server.port}@evil.example`, '',
  ]) {
    const answer = await server.raw(head([`GET /${server.key}/state HTTP/1.1`, `Host: ${host}`]));
    assert.equal(statusOf(answer), 403, `${host}: ${answer}`);
    tellsNothing(answer, host);
  }
  const none = await server.raw(head([`GET /${server.key}/state HTTP/1.1`]));
  assert.equal(statusOf(none), 400);
  const two = await server.raw(head([`GET /${server.key}/state HTTP/1.1`, `Host: ${server.host}`, 'Host: evil.example']));
  assert.equal(statusOf(two), 400);
  for (const host of [server.host, `localhost:${server.port}`]) {
    const answer = await server.raw(head([`GET /${server.key}/state HTTP/1.1`, `Host: ${host}`, 'Connection: close']));
    assert.equal(statusOf(answer), 200, host);
  }
});

test('pages of other origins are refused, also with the key', async () => {
  for (const origin of ['http://evil.example', 'null', `http://localhost:${server.port}`, `https://${server.host}`, 'file://', `http://${server.host}.evil.example`]) {
    const { status, text } = await server.ask('state', { headers: { Origin: origin } });
    assert.equal(status, 403, origin);
    tellsNothing(text, origin);
    const socket = await server.ask('events', { headers: { Origin: origin, Connection: 'Upgrade', Upgrade: 'websocket', 'Sec-WebSocket-Key': 'dGhlIHNhbXBsZSBub25jZQ==', 'Sec-WebSocket-Version': '13' } });
    assert.equal(socket.status, 403, `WebSocket from ${origin}`);
  }
  for (const site of ['cross-site', 'same-site'])
    assert.equal((await server.ask('state', { headers: { 'Sec-Fetch-Site': site } })).status, 403);
  assert.equal((await server.ask('state', { headers: { Origin: `http://${server.host}` } })).status, 200);
  const { headers } = await server.ask('');
  assert.equal(headers['access-control-allow-origin'], undefined);
  assert.equal(headers['x-frame-options'], 'DENY');
  assert.equal(headers['cache-control'], 'no-store');
  assert.equal(headers['referrer-policy'], 'no-referrer');
});

test('forms of other pages cannot post: only types that a browser asks for first', async () => {
  for (const type of ['text/plain', 'application/x-www-form-urlencoded', 'multipart/form-data', ''])
    assert.equal((await server.ask('reload', { method: 'POST', headers: type ? { 'Content-Type': type } : {} })).status, 415, type);
  for (const method of ['PUT', 'DELETE', 'OPTIONS', 'TRACE', 'PATCH', 'HEAD'])
    assert.equal((await server.ask('state', { method })).status, 405, method);
});

test('without the key everything is the same "not found"', async () => {
  const { key } = server;
  const almost = `${key.slice(0, -1)}${key.endsWith('0') ? '1' : '0'}`;
  const answers = new Set();
  for (const target of ['/', '/state', `/${almost}/`, `/${key.slice(0, -1)}/`, `/${key}`, `/${key}x/`, `//${key}/`, `/${key.toUpperCase()}x/state`, '/favicon.ico', '/..', `http://${server.host}/${key}/state`, '*'])
    answers.add(JSON.stringify((({ status, text }) => ({ status, text }))(await server.ask('', { target }))));
  assert.deepEqual([...answers], [JSON.stringify({ status: 404, text: '{"error":"not found"}' })]);
  assert.match(key, /^[0-9a-f]{32}$/);
});

test('no path leads to a file', async () => {
  for (const path of ['../../etc/passwd', '..%2f..%2fetc%2fpasswd', '%2e%2e/%2e%2e/etc/passwd', '/etc/passwd', './state', 'state/', 'state/../state', 'job/../state', 'job/-1', 'job/1e9', 'job/99999999999999999999', 'cancel/1', 'machine.toml', 'state%00', 'events', '\\..\\state'])
    for (const method of ['GET', 'POST']) {
      const { status, text } = await server.ask(path, { method, headers: { 'Content-Type': 'application/json' }, body: method === 'POST' ? '{}' : undefined });
      assert.ok(status === 404, `${method} ${path}: ${status} ${text}`);
      tellsNothing(text, path);
    }
  await serves();
});

test('a record stays in the folder of records, whatever it is called', async () => {
  const names = ['../../../escape.csv', '..', '/etc/cron.d/x', '-rf', 'a\0b.csv', `${'x'.repeat(300)}.csv`, 'C:\\evil.csv', '<script>.csv', '%2e%2e%2fescape.csv'];
  for (const name of names) {
    const { status, text } = await server.upload(name, 'time [s],x [m]\n0,0\n');
    assert.equal(status, 200, text);
  }
  assert.ok(!existsSync(join(temporary, 'escape.csv')) && !existsSync(join(folder, 'escape.csv')));
  const inside = execFileSync('find', [temporary, '-type', 'f'], { encoding: 'utf8' }).trim().split('\n');
  assert.equal(inside.length, names.length);
  for (const path of inside) {
    assert.match(path, /\/hydrapod-studio-\w{6}\/\d+\/[\w.-]+$/);
    assert.ok(!/\/[.-][^/]*$/.test(path), path);
  }
  const modes = execFileSync('stat', ['-c', '%a', ...readdirSync(temporary).map((name) => join(temporary, name))], { encoding: 'utf8' });
  assert.equal(modes.trim(), '700');
});

test('oversized requests are refused before they are read', async () => {
  assert.equal(statusOf(await server.raw(head([`GET /${server.key}/ HTTP/1.1`, `Host: ${server.host}`, `X: ${'a'.repeat(60000)}`]))), 431);
  assert.equal(statusOf(await server.raw(head([`GET /${'a'.repeat(60000)} HTTP/1.1`]))), 431);
  assert.equal(statusOf(await server.raw(head([`GET /${server.key}/ HTTP/1.1`, `Host: ${server.host}`, ...Array.from({ length: 3000 }, (_, k) => `A${k}: b`)]))), 431);
  assert.equal((await server.post('values', `{"values": "${'x'.repeat(2 << 20)}"}`)).status, 413);
  const begin = (...lines) => head([`POST /${server.key}/values HTTP/1.1`, `Host: ${server.host}`, 'Content-Type: application/json', ...lines]);
  assert.equal(statusOf(await server.raw(begin('Content-Length: 99999999999'))), 413);
  const chunk = `${(300000).toString(16)}\r\n${'x'.repeat(300000)}\r\n`;
  const chunked = await server.raw(`${begin('Transfer-Encoding: chunked')}${chunk.repeat(6)}0\r\n\r\n`);
  assert.equal(statusOf(chunked), 413);
  const record = head([`POST /${server.key}/record?x.h5 HTTP/1.1`, `Host: ${server.host}`, 'Content-Type: application/octet-stream', `Content-Length: ${2 ** 31}`]);
  assert.equal(statusOf(await server.raw(record)), 413);
  await serves();
});

test('malformed requests are refused', async () => {
  const line = `POST /${server.key}/values HTTP/1.1`;
  const own = [`Host: ${server.host}`, 'Content-Type: application/json'];
  for (const [what, bytes] of Object.entries({
    'two lengths': `${head([line, ...own, 'Content-Length: 2', 'Content-Length: 3'])}{}x`,
    'a negative length': head([line, ...own, 'Content-Length: -1']),
    'a length in hexadecimal': `${head([line, ...own, 'Content-Length: 0x2'])}{}`,
    'length and chunks': `${head([line, ...own, 'Content-Length: 2', 'Transfer-Encoding: chunked'])}0\r\n\r\n`,
    'a folded header': `${line}\r\nHost: ${server.host}\r\n folded\r\n\r\n`,
    'another version': head([`GET /${server.key}/state HTTP/9.9`, ...own]),
    'no version': `GET /${server.key}/state\r\n\r\n`,
    'a NUL': head([`GET /${server.key}/st\0ate HTTP/1.1`, ...own]),
    'TLS': Buffer.from('160301020001000001fc0303', 'hex'),
    'a chunk that is none': `${head([line, ...own, 'Transfer-Encoding: chunked'])}zz\r\n`,
  })) {
    const answer = await server.raw(bytes, { wait: 15000 });
    assert.ok([0, 400, 403, 404].includes(statusOf(answer)), `${what}: ${answer}`);
    tellsNothing(answer, what);
  }
  await serves();
});

test('random bytes change nothing', async () => {
  let seed = 20261125;
  const random = () => ((seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) / 2 ** 32);
  const good = head([`POST /${server.key}/values HTTP/1.1`, `Host: ${server.host}`, 'Content-Type: application/json', 'Content-Length: 2']) + '{}';
  const tries = Array.from({ length: 200 }, (_, k) => {
    const bytes = Buffer.from(k % 2 ? good : '\0'.repeat(Math.floor(1 + 300 * random())), 'latin1');
    const hits = k % 2 ? 1 + Math.floor(4 * random()) : bytes.length;
    for (let n = 0; n < hits; ++n) bytes[k % 2 ? Math.floor(bytes.length * random()) : n] = Math.floor(256 * random());
    return bytes;
  });
  await Promise.all(tries.map((bytes) => server.raw(bytes, { wait: 1000 })));
  await serves();
});

test('JSON that is none, or not what a page writes, is refused with its cause', async () => {
  const bad = ['{"values":[],"assignments":[],"from":1}', '', 'x', '[]', 'null', '{"values":', `${'['.repeat(200000)}`, `${'{"a":'.repeat(100000)}`, '{"values":1,"assignments":2}', '{"values":[["a"]],"assignments":[]}', '{"values":[["a",1e999]],"assignments":[]}', '{"values":[],"assignments":[1]}', '{"values":[],"assignments":["x"]}', '{"values":[],"assignments":["platform.mass=-1"]}', '{"values":[],"assignments":["no.such=1"]}', '\xff\xfe'];
  for (const text of bad) {
    const { status, text: said } = await server.post('values', text);
    assert.equal(status, 422, `${text.slice(0, 40)}: ${said}`);
    assert.ok(JSON.parse(said).error.length > 5);
  }
  for (const asked of [{}, { kind: 1 }, { kind: 'x' }, { kind: 'identify' }, { kind: 'identify', fields: 3 }, { kind: 'identify', fields: { records: [] } }, { kind: 'identify', fields: { records: ['record:99'] } }, { kind: 'identify', fields: { records: ['record:-1'] } }, { kind: 'identify', fields: { records: [''] } }, { kind: 'map', fields: { over: 'x' } }, { kind: 'map', fields: { over: ['x'], unknown: 1 } }, { kind: 'map', pose: 7, fields: { over: ['x'] } }, { kind: 'map', pose: -1, fields: { over: ['x'] } }, { kind: 'identify', fields: { records: ['a'] }, then: ['identify'] }, { kind: 'rig', fields: { output: 'a\0b' } }]) {
    const { status, text } = await server.post('job', asked);
    assert.equal(status, 422, `${JSON.stringify(asked)}: ${text}`);
  }
  assert.deepEqual((await server.json('state')).jobs, []);
});

test('no value becomes an option, and no output takes the place of a file', async () => {
  const target = join(folder, 'evil.h5');
  const text = readFileSync(machine, 'utf8');
  for (const fields of [
    { commands: [`--record=${target}`] },
    { commands: ['step z=1 mm'], until: `1 s --record=${target}` },
    { commands: ['step z=1 mm'], until: `1\n-o\n${target}` },
  ]) {
    const { status, text: said } = await server.post('job', { kind: 'simulate', fields });
    assert.equal(status, 200, said);
    assert.equal((await server.over(JSON.parse(said).id)).state, 'failed');
  }
  assert.ok(!existsSync(target));
  const existing = join(folder, 'kept.h5');
  writeFileSync(existing, 'of somebody');
  for (const output of [existing, 'kept.h5', machine, `${folder}/./tmp/../kept.h5`]) {
    const { status, text: said } = await server.post('job', { kind: 'rig', fields: { duration: '1 s', output } });
    assert.equal(status, 422);
    assert.match(said, /a file exists there and was left as it is/);
  }
  for (const [path, name] of [['save', machine], ['page', existing.replace('.h5', '.html')]]) {
    if (path === 'page') writeFileSync(name, 'of somebody');
    const { status, text: said } = await server.post(path, { path: name });
    assert.equal(status, 422);
    assert.match(said, /a file exists there/);
  }
  assert.equal(readFileSync(existing, 'utf8'), 'of somebody');
  assert.equal(readFileSync(machine, 'utf8'), text);
  // nor that of an input, also where it may be replaced
  const itself = await server.post('job', { kind: 'rig', replace: true, fields: { duration: '1 s', output: machine } });
  assert.equal((await server.over(JSON.parse(itself.text).id)).state, 'failed');
  assert.equal(readFileSync(machine, 'utf8'), text);
});

test('an upload that breaks off leaves nothing', async () => {
  const files = () => execFileSync('find', [temporary, '-type', 'f'], { encoding: 'utf8' }).trim().split('\n').length;
  const before = files();
  const records = (await server.json('state')).records.length;
  await new Promise((resolve) => {
    const socket = connect(server.port, '127.0.0.1', () => {
      socket.write(head([`POST /${server.key}/record?part.h5 HTTP/1.1`, `Host: ${server.host}`, 'Content-Type: application/octet-stream', 'Content-Length: 100000']));
      socket.write('x'.repeat(5000), () => setTimeout(() => socket.destroy(), 200));
    });
    socket.on('close', resolve);
  });
  await wait(300);
  assert.equal(files(), before);
  assert.equal((await server.json('state')).records.length, records);
});

const descriptors = () => readdirSync(`/proc/${server.process.pid}/fd`).length;
const resident = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${server.process.pid}/status`, 'utf8'))[1]) / 1024;

test('1000 connections and slow clients: bounded, the owner is served meanwhile, and they end by themselves', { timeout: 120000 }, async () => {
  const [files, memory] = [descriptors(), resident()];
  let open = 0;
  let refused = 0;
  const sockets = Array.from({ length: 1000 }, (_, k) => {
    const socket = connect(server.port, '127.0.0.1');
    socket.on('connect', () => {
      ++open;
      if (k % 2) socket.write(`GET /${'x'.repeat(k % 7)}`); // half of them send a little, then wait
    });
    socket.on('error', () => ++refused);
    socket.on('close', () => --open);
    return socket;
  });
  const slow = setInterval(() => sockets.forEach((s, k) => k % 20 === 1 && !s.destroyed && s.writable && s.write('y')), 500);
  const begin = Date.now();
  let slowest = 0;
  while (Date.now() - begin < 5000) {
    slowest = Math.max(slowest, await serves());
    assert.ok(descriptors() < files + 110, `${descriptors()} descriptors`);
    await wait(100);
  }
  assert.ok(slowest < 2000, `answered within ${slowest} ms`);
  while (open > 0 && Date.now() - begin < 40000) await wait(100);
  clearInterval(slow);
  assert.equal(open, 0, 'all were closed by the server');
  assert.ok(Date.now() - begin < 25000, `after ${Date.now() - begin} ms`);
  sockets.forEach((socket) => socket.destroy());
  await wait(500);
  await serves();
  assert.ok(descriptors() <= files + 8, `${descriptors()} descriptors, ${files} before`);
  assert.ok(resident() < memory + 64, `${resident()} MiB, ${memory} before`);
});

test('pages that listen are limited, and so is who never reads', async () => {
  const upgrade = head([`GET /${server.key}/events HTTP/1.1`, `Host: ${server.host}`, 'Connection: Upgrade', 'Upgrade: websocket', 'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==', 'Sec-WebSocket-Version: 13']);
  const sockets = [];
  const answers = await Promise.all(
    Array.from({ length: 40 }, () => new Promise((resolve) => {
      const socket = connect(server.port, '127.0.0.1', () => socket.write(upgrade));
      sockets.push(socket);
      socket.once('data', (data) => resolve(statusOf(data.toString('latin1'))));
    })),
  );
  assert.equal(answers.filter((status) => status === 101).length, 32);
  assert.equal(answers.filter((status) => status === 503).length, 8);
  sockets.forEach((socket) => socket.destroy());
  await wait(300);
  await serves();
});

test('the key is in no command line and no file that others can read', async () => {
  const started = await server.post('job', { kind: 'rig', fields: { duration: '20000 s', output: 'long.h5' } });
  const { id } = JSON.parse(started.text);
  await wait(300);
  const lines = readdirSync('/proc').filter((name) => /^\d+$/.test(name)).map((pid) => {
    try {
      return readFileSync(`/proc/${pid}/cmdline`, 'latin1');
    } catch {
      return '';
    }
  });
  assert.ok(lines.some((line) => line.includes('long.h5')), 'the job runs');
  assert.ok(!lines.some((line) => line.includes(server.key)));
  assert.equal((await server.post(`cancel/${id}`)).status, 200);
  assert.equal((await server.over(id)).state, 'cancelled');
  assert.equal((await server.post(`cancel/${id}`)).status, 404);
});

test('another address needs a key that others cannot read', () => {
  const run = (...words) => spawnSync(HYDRAPOD_PROGRAM, ['studio', machine, '--no-browser', ...words], { encoding: 'utf8', timeout: 20000 });
  const refused = (words, message) => {
    const { status, stderr } = run(...words);
    assert.equal(status, 2, stderr);
    assert.match(stderr, message);
  };
  const key = join(folder, 'key');
  refused(['--bind', '0.0.0.0'], /--bind: error: needs --key FILE/);
  writeFileSync(key, '0123456789abcdef0123456789abcdef\n', { mode: 0o600 });
  refused(['--key', key], /--key: error: needs --bind ADDRESS/);
  chmodSync(key, 0o644);
  refused(['--bind', '127.0.0.1', '--key', key], /other users may read or write the key/);
  chmodSync(key, 0o600);
  writeFileSync(key, 'short');
  refused(['--bind', '127.0.0.1', '--key', key], /expected one line of 22 to 128 letters/);
  writeFileSync(key, 'a/../b'.repeat(6));
  refused(['--bind', '127.0.0.1', '--key', key], /expected one line of 22 to 128 letters/);
  writeFileSync(key, '0123456789abcdef0123456789abcdef\n');
  refused(['--bind', 'evil.example', '--key', key], /cannot listen there|expected/);
  refused(['--bind', '203.0.113.7', '--key', key], /cannot listen there/);
  refused(['--port', String(server.port)], /cannot listen there/);
});

test('with a key and an address, numbers of any interface are hosts and names are not', async () => {
  const key = join(folder, 'key-2');
  writeFileSync(key, 'fedcba9876543210fedcba9876543210\n', { mode: 0o600 });
  const other = await StudioServer.start([machine, '--bind', '0.0.0.0', '--key', key], { cwd: folder });
  try {
    assert.equal(other.key, 'fedcba9876543210fedcba9876543210');
    const asked = (host) => other.raw(head([`GET /${other.key}/state HTTP/1.1`, `Host: ${host}:${other.port}`, 'Connection: close']));
    for (const host of ['127.0.0.1', '192.0.2.5', '[2001:db8::1]', 'localhost']) assert.equal(statusOf(await asked(host)), 200, host);
    assert.equal(statusOf(await asked('evil.example')), 403);
  } finally {
    await other.stop();
  }
});

test('Ctrl-C ends it at once with its jobs and its folder; a kill takes the jobs along', async () => {
  for (const signal of ['SIGINT', 'SIGTERM', 'SIGKILL']) {
    const place = join(temporary, signal);
    execFileSync('mkdir', [place]);
    const other = await StudioServer.start([machine], { cwd: folder, env: { ...process.env, TMPDIR: place } });
    const { text } = await other.post('job', { kind: 'rig', fields: { duration: '20000 s', output: `${signal}.h5` } });
    while ((await other.json(`job/${JSON.parse(text).id}`)).state !== 'running') await wait(20);
    const { code, milliseconds } = await other.stop(signal);
    assert.ok(milliseconds < 3000, `${signal}: ${milliseconds} ms`);
    if (signal !== 'SIGKILL') {
      assert.equal(code, 0, signal);
      assert.deepEqual(readdirSync(place), [], signal);
    }
    const running = () => spawnSync('pgrep', ['-f', `${signal}[.]h5`], { encoding: 'utf8' }).stdout.trim();
    for (let tries = 0; running() && tries < 100; ++tries) await wait(50);
    assert.equal(running(), '', `${signal}: the job has ended`);
  }
  await serves();
});
