// The studio in a browser: sliders against the command line, saving, records, jobs, several pages.
import assert from 'node:assert/strict';
import { copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { spawnSync } from 'node:child_process';
import { after, before, test } from 'node:test';
import { findings, hydrapod, json, near, open, openAt, published, still, temporary } from './support.mjs';
import { StudioServer } from './studio_server.mjs';

const { HYDRAPOD_PROGRAM } = process.env;
const machine = join(temporary('studio'), 'machine.toml');
const folder = dirname(machine);
const record = join(folder, 'run.h5');
let server;

before(async () => {
  mkdirSync(folder);
  copyFileSync(published, machine);
  hydrapod('rig', published, '--entry', 'wrench', '--excite', 'noise all=200, to=60', '--duration', '40 s', '-o', record);
  server = await StudioServer.start([machine], { cwd: folder });
});

after(async () => {
  await server?.stop();
});

/** The page of `of`, with the state of the program in it. */
async function openStudio(options = still, of = server) {
  const page = await openAt(of.url, (url) => url.startsWith(of.url) || url.startsWith(of.url.replace('http', 'ws')), options);
  await page.waitForFunction(() => document.querySelector('.studio-file')?.textContent);
  return page;
}

async function closeStudio(page, allowed = /^$/) {
  assert.deepEqual(page.problems.filter((text) => !allowed.test(text)), []);
  await page.close();
}

const ready = (page) => page.evaluate(() => window.hydrapod.whatIf.ready);
const shown = (page) => page.evaluate(() => window.hydrapod.whatIf.shown());
const changed = (page) => page.evaluate(() => window.hydrapod.whatIf.changed());
const frequencies = (page) => page.evaluate(() => window.hydrapod.state.pose.modes.map((mode) => mode.omega_rad_s));

/** As a person does: find the parameter, type, press Enter. */
async function type(page, path, text) {
  await ready(page);
  await page.locator('[data-control="parameter-search"]').fill(path);
  const field = page.locator(`[data-field="${path}"]`);
  await field.fill(text);
  await field.press('Enter');
  await shown(page);
}

const waitForState = (page, test, argument) => page.waitForFunction(test, argument);
const job = (page, id) => page.locator(`[data-job="${id}"]`);

/** Drops a file onto the page. */
async function drop(page, path, name) {
  const bytes = readFileSync(path).toString('base64');
  const data = await page.evaluateHandle(([bytes, name]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], name));
    return transfer;
  }, [bytes, name]);
  await page.locator('body').dispatchEvent('dragover', { dataTransfer: data });
  await page.locator('body').dispatchEvent('drop', { dataTransfer: data });
}

function sameModes(actual, words, what) {
  const expected = json('modes', ...words).modes.map((mode) => mode.omega_rad_s);
  assert.equal(actual.length, expected.length);
  actual.forEach((omega, k) => near(omega, expected[k], 1e-12 * expected[k], `${what}, mode ${k + 1}`));
}

test('a typed value gives the numbers of the command line, in all pages and in all jobs', async () => {
  const page = await openStudio();
  const other = await openStudio();
  await type(page, 'legs.guide_sleeve.stiffness', '0.7371 kN/mm');
  await type(page, 'platform.mass', '1017.3 kg');
  const set = ['--set', 'legs.guide_sleeve.stiffness=0.7371 kN/mm', '--set', 'platform.mass=1017.3 kg'];
  sameModes(await frequencies(page), [machine, ...set], 'the page');
  await ready(other);
  await other.waitForFunction(() => window.hydrapod.whatIf.changed().length === 2);
  await shown(other);
  sameModes(await frequencies(other), [machine, ...set], 'the other page');
  // and back, from the other one
  await type(other, 'platform.mass', '990 kg');
  await page.waitForFunction(() => window.hydrapod.whatIf.changed().some(([, value]) => value === 990));
  const started = await server.post('job', { kind: 'montecarlo', fields: { vary: ['legs.rod.mass=normal ± 0.1 %'], samples: '4' } });
  const over = await server.over(JSON.parse(started.text).id);
  assert.equal(over.state, 'done', over.messages.join('\n'));
  assert.ok(over.arguments.includes('--set=platform.mass=990'), over.arguments.join(' '));
  await page.evaluate(() => window.hydrapod.whatIf.replace([]));
  await other.waitForFunction(() => window.hydrapod.whatIf.changed().length === 0);
  await closeStudio(other);
  await closeStudio(page);
});

test('what no machine can have is not taken, and the page says why', async () => {
  const page = await openStudio();
  await type(page, 'platform.mass', '-3 kg');
  const field = page.locator('[data-field="platform.mass"]');
  await page.waitForFunction(() => document.querySelector('[data-field="platform.mass"]')?.getAttribute('aria-invalid') === 'true');
  assert.equal(await field.inputValue(), '-3 kg', 'what was typed can be corrected');
  assert.deepEqual(await page.evaluate(() => window.hydrapod.whatIf.changed()), []);
  assert.deepEqual((await server.json('state')).values, []);
  await page.evaluate(() => window.hydrapod.whatIf.replace([]));
  await shown(page);
  await closeStudio(page);
});

test('saving keeps comments and units, and writes over nothing that it has not read', async () => {
  const own = await StudioServer.start([machine], { cwd: folder });
  const before = readFileSync(machine, 'utf8');
  const page = await openStudio(still, own);
  await type(page, 'legs.rod.mass', '23.4567 kg');
  const { modes } = json('modes', machine, '--set', 'legs.rod.mass=23.4567 kg');
  await page.waitForFunction(() => document.querySelector('.planned')?.textContent.includes('legs.rod.mass'));
  // somebody else edits the file
  writeFileSync(machine, `${before}\n# of somebody else\n`);
  await page.locator('[data-control="reload"]').waitFor();
  assert.ok(await page.locator('[data-control="save"]').isDisabled());
  const refused = await own.post('save');
  assert.equal(refused.status, 422);
  assert.match(refused.text, /has changed since it was read and was left as it is/);
  assert.equal(readFileSync(machine, 'utf8'), `${before}\n# of somebody else\n`);
  // under another name, and not over a file either
  await page.getByText('Save under another name').click();
  const path = page.locator('[data-path="save-as"]');
  writeFileSync(join(folder, 'taken.toml'), 'of somebody');
  await path.fill('taken.toml');
  await path.press('Enter');
  await page.getByText('a file exists there').waitFor();
  assert.equal(readFileSync(join(folder, 'taken.toml'), 'utf8'), 'of somebody');
  writeFileSync(machine, before);
  await page.waitForFunction(() => !document.querySelector('[data-control="save"]').disabled);
  await page.locator('[data-control="save"]').click();
  await page.waitForFunction(() => document.querySelector('.studio-part .note').textContent.startsWith('The file has'));
  const after = readFileSync(machine, 'utf8');
  const [lines, old] = [after.split('\n'), before.split('\n')];
  assert.equal(lines.length, old.length);
  const different = lines.flatMap((line, k) => (line === old[k] ? [] : [line]));
  assert.equal(different.length, 1, different.join('\n'));
  assert.match(different[0], /23\.4567/);
  const unit = /mass\s*=\s*("?)[\d.]+( kg)?\1/;
  assert.equal(unit.exec(different[0])[2], unit.exec(old[lines.indexOf(different[0])])[2], 'its unit as before');
  assert.deepEqual(json('modes', machine).modes.map((m) => m.omega_rad_s), modes.map((m) => m.omega_rad_s));
  await waitForState(page, () => window.hydrapod.whatIf?.changed().length === 0);
  await closeStudio(page, /422/);
  await own.stop();
  writeFileSync(machine, before);
});

test('a record dropped onto the page is identified and diagnosed, as the command line does', async () => {
  const own = await StudioServer.start([machine], { cwd: folder });
  const page = await openStudio(still, own);
  await drop(page, record, 'run of today.h5');
  await page.waitForFunction(() => window.hydrapod?.report?.identification && window.hydrapod.report.diagnosis, null, { timeout: 240000 });
  const { identification, diagnosis } = await page.evaluate(() => window.hydrapod.report);
  const expected = JSON.parse(hydrapod('report', machine, '--measured', record, '--format', 'json', '-o', '-'));
  assert.deepEqual(identification.modes, expected.identification.modes);
  assert.deepEqual(diagnosis.summary, json('diagnose', machine, '--measured', record).summary);
  await page.locator('#identification').waitFor();
  await page.locator('#diagnosis').waitFor();
  // a page that is opened later has them too, and the saved report without the program
  const later = await openStudio(still, own);
  assert.ok(await later.evaluate(() => window.hydrapod.report.diagnosis !== undefined));
  await closeStudio(later);
  await page.getByText('Save under another name').click();
  await page.locator('[data-path="save-page"]').fill('report.html');
  await page.locator('[data-path="save-page"]').press('Enter');
  await page.getByText(`Wrote ${join(folder, 'report.html')}`).waitFor();
  const saved = await open(join(folder, 'report.html'), still);
  assert.ok(await saved.evaluate(() => window.hydrapod.report.identification && !document.getElementById('studio')));
  assert.deepEqual(saved.problems, []);
  await saved.close();
  assert.deepEqual(await findings(page), []);
  await closeStudio(page);
  await own.stop();
});

test('a damaged record gives its message, and the page goes on', async () => {
  const page = await openStudio();
  const damaged = join(folder, 'damaged.h5');
  writeFileSync(damaged, readFileSync(record).subarray(0, 30000));
  await drop(page, damaged, 'damaged.h5');
  const failed = page.locator('.job[data-state="failed"]', { hasText: 'identify damaged.h5' });
  await failed.waitFor();
  const said = await failed.locator('.messages').textContent();
  const { stderr, status } = spawnSync(HYDRAPOD_PROGRAM, ['report', machine, '--measured', damaged, '-o', temporary('x.html')], { encoding: 'utf8' });
  assert.equal(status, 2);
  const words = (text) => text.trim().replaceAll(damaged, 'damaged.h5').replace(/\s+/g, ' ');
  assert.equal(words(said), words(stderr), 'the name that was dropped, no folder of the program');
  assert.equal(await page.evaluate(() => document.querySelector('#studio > .said').textContent.includes('failed')), true);
  writeFileSync(join(folder, 'empty.h5'), '');
  await drop(page, join(folder, 'empty.h5'), 'empty.h5');
  await page.waitForFunction(() => document.querySelectorAll('.job[data-state="failed"]').length === 2);
  assert.deepEqual(await findings(page), []);
  await closeStudio(page);
});

test('a job shows its progress and the time left, and is cancelled', async () => {
  const page = await openStudio();
  await page.locator('[data-control="job-kind"]').selectOption('rig');
  await page.locator('[data-field-of-job="duration"]').fill('9000 s');
  await page.locator('[data-field-of-job="output"]').fill('long.h5');
  await page.locator('[data-control="start-job"]').click();
  await page.waitForFunction(() => /^\d+ %, .* left$/.test(document.querySelector('.job[data-state="running"] .job-state')?.textContent ?? ''));
  const running = page.locator('.job[data-state="running"]').first();
  assert.deepEqual(await findings(page), []);
  const id = await running.getAttribute('data-job');
  const other = await openStudio();
  await job(other, id).locator('progress').waitFor();
  await running.locator('[data-control="cancel-job"]').click();
  await page.waitForFunction((id) => document.querySelector(`[data-job="${id}"]`).dataset.state === 'cancelled', id);
  await other.waitForFunction((id) => document.querySelector(`[data-job="${id}"]`).dataset.state === 'cancelled', id);
  await closeStudio(other);
  await closeStudio(page);
});

test('results without a section are shown with their job: map, Monte Carlo, calibration', async () => {
  const page = await openStudio();
  const start = async (kind, fields) => {
    await page.locator('[data-control="job-kind"]').selectOption(kind);
    for (const [name, text] of Object.entries(fields)) await page.locator(`[data-field-of-job="${name}"]`).fill(text);
    const before = await page.locator('.job').count();
    await page.locator('[data-control="start-job"]').click();
    await page.waitForFunction((count) => document.querySelectorAll('.job').length > count, before);
    const id = await page.locator('.job').first().getAttribute('data-job');
    await job(page, id).locator('[data-control="show-result"]').click();
    return job(page, id).locator('.result');
  };
  const map = await start('map', { over: 'x=-50:50:5 mm\nz=-50:50:5 mm', worst_over: 'rx=-1:1:3 deg', also: 'stiffness', value: 'stiffness_x' });
  await map.locator('img').waitFor();
  assert.ok(await map.locator('img').evaluate((image) => image.decode().then(() => image.naturalWidth > 100)));
  const scatter = await start('montecarlo', { vary: 'legs.guide_sleeve.stiffness=normal ± 10 % per leg', want: 'x >= 6 Hz', samples: '200' });
  await scatter.locator('table').first().waitFor();
  const expected = json('montecarlo', machine, '--vary', 'legs.guide_sleeve.stiffness=normal ± 10 % per leg', '--want', 'x >= 6 Hz', '--samples', '200', '--results', temporary('rows.h5'));
  const cells = await scatter.locator('tbody tr').first().locator('td').allTextContents();
  assert.deepEqual(cells.slice(0, 2), [String(expected.requirements[0].missed), '200']);
  assert.deepEqual(await findings(page), []);
  await closeStudio(page);
});

test('what is typed and not yet sent stays when a result arrives', async () => {
  const page = await openStudio();
  const kind = page.locator('[data-control="job-kind"]');
  await kind.selectOption('simulate');
  await page.locator('[data-field-of-job="until"]').fill('1.7 s');
  await kind.selectOption('diagnose');
  await page.locator('[data-field-of-job="modes_only"]').check();
  await page.locator('[data-field-of-job="records"]').selectOption('');
  await page.locator('[data-path-of-record="records"]').fill('mine.h5');
  await page.getByText('Save under another name').click();
  await page.locator('[data-path="save-as"]').fill('half typ');
  const number = await page.evaluate(() => window.hydrapod.report.studio.page);
  const started = await server.post('job', { kind: 'simulate', fields: { commands: ['step z=1 mm'], until: '0.1 s' } });
  assert.equal((await server.over(JSON.parse(started.text).id)).state, 'done');
  await page.waitForFunction((before) => window.hydrapod?.report.studio.page > before, number);
  await page.waitForFunction(() => document.querySelector('[data-path="save-as"]')?.value === 'half typ');
  assert.ok(await page.locator('[data-path="save-as"]').isVisible());
  assert.equal(await kind.inputValue(), 'diagnose');
  assert.ok(await page.locator('[data-field-of-job="modes_only"]').isChecked());
  assert.equal(await page.locator('[data-path-of-record="records"]').inputValue(), 'mine.h5');
  await kind.selectOption('simulate');
  assert.equal(await page.locator('[data-field-of-job="until"]').inputValue(), '1.7 s');
  // once: a page that is opened anew is empty
  await page.reload();
  await page.waitForFunction(() => document.querySelector('.studio-file')?.textContent);
  assert.equal(await page.locator('[data-path="save-as"]').inputValue(), '');
  await closeStudio(page);
});

test('wrong input of a form is said, and nothing begins', async () => {
  const page = await openStudio();
  await page.locator('[data-control="job-kind"]').selectOption('simulate');
  await page.locator('[data-field-of-job="commands"]').fill('');
  await page.locator('[data-control="start-job"]').click();
  await page.getByText('simulate: commands: error: is missing').waitFor();
  await page.locator('[data-field-of-job="commands"]').fill('stp z=5 mm');
  await page.locator('[data-control="start-job"]').click();
  await page.locator('.job[data-state="failed"]').first().getByText('step').first().waitFor();
  await page.locator('[data-control="job-kind"]').selectOption('rig');
  await page.locator('[data-field-of-job="output"]').fill('run.h5');
  await page.locator('[data-control="start-job"]').click();
  await page.locator('[data-control="job-replace"]').waitFor();
  await closeStudio(page, /422/);
});

test('the file that the browser is opened with leads to the page', async () => {
  const file = join(folder, 'open.html');
  writeFileSync(file, `<!DOCTYPE html>\n<meta http-equiv="refresh" content="0;url=${server.url}">`);
  const page = await openAt(`file://${file}`, () => true, still);
  await page.waitForURL(server.url);
  await page.waitForFunction(() => window.hydrapod?.state && document.querySelector('.studio-file')?.textContent);
  await closeStudio(page);
});

test('without a machine file it begins with a new machine, which is saved under a name', async () => {
  const own = await StudioServer.start([], { cwd: folder });
  const page = await openStudio(still, own);
  assert.ok(await page.locator('[data-control="save"]').isDisabled());
  await page.getByText('Save under another name').click();
  await page.locator('[data-path="save-as"]').fill('new.toml');
  await page.locator('[data-path="save-as"]').press('Enter');
  await page.waitForFunction(() => document.querySelector('.studio-file')?.textContent.endsWith('new.toml'));
  assert.ok(existsSync(join(folder, 'new.toml')));
  await closeStudio(page);
  await own.stop();
});

test('a program that has ended is said, and the page goes on without it', async () => {
  const own = await StudioServer.start([machine], { cwd: folder });
  const page = await openStudio(still, own);
  await ready(page);
  await own.stop();
  await page.getByText('The program behind this page does not answer').waitFor();
  assert.ok(await page.locator('[data-control="start-job"]').isDisabled());
  await page.evaluate(() => {
    window.hydrapod.whatIf.drag('platform.mass', 1000);
    window.hydrapod.whatIf.keep();
  });
  await shown(page);
  sameModes(await frequencies(page), [machine, '--set', 'platform.mass=1000'], 'without the program');
  assert.deepEqual(await findings(page), []);
  await closeStudio(page, /ERR_CONNECTION|WebSocket|Failed to load/);
});

test('it fits every width, in light and dark, and axe has nothing to say', async () => {
  for (const width of [360, 768, 1400, 2560])
    for (const colorScheme of ['light', 'dark']) {
      const page = await openStudio({ ...still, viewport: { width, height: 900 }, colorScheme });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      assert.ok(wide <= 0, `${width} px: ${wide} px too wide`);
      if (width === 360 || colorScheme === 'dark') assert.deepEqual(await findings(page), [], `${width} px, ${colorScheme}`);
      await closeStudio(page);
    }
});
