// Every kind of section at every width: nothing is cut, overlaps or leaves the window.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { damped, model, published, report, hydrapod, still, temporary, withKeptPage, withPage } from './support.mjs';

const widths = [360, 768, 1400, 2560, 3840];

/** Sections that calculate show what they have: coarse maps and a quarter of the samples look like all of them. */
const calculated = (page) =>
  page.evaluate(async () => {
    const { bode, whatIf, workspace, scatter, identification } = window.hydrapod;
    for (const part of [bode, whatIf, workspace, scatter, identification]) await part?.ready;
    const shown = () => document.querySelector('#workspace.calculated') && scatter.rows().length >= 250;
    while (workspace && !shown()) await new Promise((resolve) => setTimeout(resolve, 10));
  });

/** They have calculated all of it. */
const completed = (page) =>
  page.evaluate(async () => {
    await window.hydrapod.workspace.complete();
    await window.hydrapod.scatter.complete();
  });

/** What is wrong with the layout of the page as it stands, in words. */
const faults = (page) =>
  page.evaluate(() => {
    const found = new Set();
    const root = document.documentElement;
    if (root.scrollWidth > root.clientWidth) found.add(`the page is ${root.scrollWidth} px wide in a window of ${root.clientWidth} px`);
    const named = (e) => {
      const words = (e.textContent || e.getAttribute('aria-label') || '').trim().replace(/\s+/g, ' ').slice(0, 50);
      return `${e.closest('main > section')?.id ?? 'top'}: <${e.localName} class="${e.getAttribute('class') ?? ''}"> "${words}"`;
    };
    // what is for screen readers only is one pixel large
    const unseen = (e) => e.closest('.unseen, .skip, .stacked:not(.sorted) > thead') !== null;
    const isSeen = (e) => e.checkVisibility() && !unseen(e);
    for (const e of document.querySelectorAll('#report *')) {
      if (!isSeen(e)) continue;
      const box = e.getBoundingClientRect();
      if (box.width === 0 || box.height === 0) continue;
      if (box.right > root.clientWidth + 0.5 || box.left < -0.5) found.add(`leaves the window: ${named(e)}`);
      const style = getComputedStyle(e);
      const isBox = e instanceof HTMLElement && style.display !== 'inline' && e.clientWidth > 0;
      const isFile = e.matches('pre.file'); // long lines of a file scroll
      if (isBox && !isFile && !e.matches('.plots, .plots *') && e.scrollWidth > e.clientWidth + 1)
        found.add(`${e.scrollWidth - e.clientWidth} px of it are cut: ${named(e)}`);
      if (e instanceof SVGTextElement) {
        const frame = e.ownerSVGElement.getBoundingClientRect();
        const beyond = Math.max(frame.left - box.left, box.right - frame.right);
        if (beyond > 1) found.add(`${beyond.toFixed(1)} px of the label are cut: ${named(e)}`);
        const scale = Math.hypot(e.getScreenCTM().a, e.getScreenCTM().b);
        if (scale * parseFloat(style.fontSize) < 10) found.add(`too small to be read: ${named(e)}`);
      }
    }
    for (const label of document.querySelectorAll('.bar-label'))
      if (isSeen(label) && label.offsetHeight > 20) found.add(`broken in two: ${named(label)}`);
    for (const picture of document.querySelectorAll('svg')) {
      const labels = [...picture.querySelectorAll('text')].filter(isSeen).map((e) => [e, e.getBoundingClientRect()]);
      labels.forEach(([e, a], k) => {
        for (const [other, b] of labels.slice(0, k)) {
          const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
          const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
          if (across > 1 && down > 4) found.add(`"${e.textContent}" overlaps "${other.textContent}": ${named(picture)}`);
        }
      });
    }
    return [...found];
  });

let words;
/** Of a report with all sections. */
function everything() {
  if (words) return words;
  const record = temporary('layout.h5');
  hydrapod('rig', published, '--entry', 'wrench', '--excite', 'noise all=200, to=60', '--duration', '60 s', '-o', record);
  const comparison = temporary('layout-comparison.json');
  hydrapod('compare', published, record, '-o', comparison);
  return (words = [published, '--command', 'step z=5 mm', '--until', '1 s', '--measured', record, '--diagnose', record, '--compare', comparison]);
}

const kinds = {
  'two poses with gravity, seals and stroke limits': () => [model('heavy-platform.toml'), '--pose', 'neutral', '--pose', 'low'],
  'all sections': everything,
};

for (const [name, of] of Object.entries(kinds))
  for (const width of widths)
    test(`${name}: nothing is cut at ${width} px`, async () => {
      const options = { ...still, viewport: { width, height: 900 }, ...(width < 500 ? { hasTouch: true, isMobile: true } : {}) };
      await withPage(report(...of()), options, async (page) => {
        await calculated(page);
        if (width === 768) await completed(page);
        assert.deepEqual(await faults(page), []);
        const fold = page.locator('[data-control="fold"]');
        if ((await fold.count()) > 0) await fold.click();
        await page.evaluate(() => document.querySelectorAll('details').forEach((part) => (part.open = true)));
        await page.evaluate(() => {
          window.hydrapod.bode.setCursor(8);
          window.hydrapod.whatIf.drag('platform.mass', 1234.5);
          window.hydrapod.whatIf.keep();
        });
        await page.evaluate(() => window.hydrapod.whatIf.shown());
        await calculated(page);
        assert.deepEqual(await faults(page), [], 'with all parts open and a changed value');
      });
    });

test('on paper all sections fit the width, and nothing is folded', async () => {
  const paper = 688; // px of the text on A4 with the margins of the page
  await withKeptPage(report(...everything()), { ...still, viewport: { width: 2560, height: 1400 } }, async (page) => {
    await calculated(page);
    await page.evaluate(() => dispatchEvent(new Event('beforeprint'))); // as a browser does before it prints
    await page.emulateMedia({ media: 'print' });
    const wide = await page.evaluate((most) => {
      const seen = [...document.querySelectorAll('.uplot, svg, table')].filter((e) => e.checkVisibility());
      document.getElementById('report').style.width = `${most}px`;
      return seen.filter((e) => e.getBoundingClientRect().width > most + 0.5).map((e) => `${e.closest('section')?.id} ${e.getAttribute('class')}`);
    }, paper);
    assert.deepEqual(wide, []);
    assert.equal(await page.locator('details:not([open])').count(), 0);
    await page.emulateMedia({ media: 'screen' });
    await page.evaluate(() => {
      document.getElementById('report').style.width = '';
      dispatchEvent(new Event('afterprint'));
    });
    assert.deepEqual(await faults(page), [], 'afterwards it is as wide as before');
  });
});

test('printed tables go on with their heads, and printed pages say what they are of', async () => {
  await withPage(report(...everything(), '--title', 'A "B" \\\\ </style>'), { ...still, viewport: { width: 1400, height: 900 } }, async (page) => {
    await calculated(page);
    await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
    await page.emulateMedia({ media: 'print' });
    await page.evaluate(() => (document.getElementById('report').style.width = '688px'));
    const shown = await page.evaluate(() => ({
      rule: [...document.styleSheets[0].cssRules].at(-1).cssText,
      // Chromium repeats no head that has buttons
      buttons: [...document.querySelectorAll('thead button')].filter((e) => e.checkVisibility()).length,
      heads: [...document.querySelectorAll('table.modes.sorted thead th')].map((e) => getComputedStyle(e, '::before').content),
      value: document.querySelector('[data-control="map-value"]').checkVisibility(),
      tops: [...document.querySelectorAll('.histories > .uplot')].map((e) => Math.round(e.getBoundingClientRect().top)),
    }));
    assert.match(shown.rule, /@page.*A \\"B\\" \\\\.* hydrapod \d/);
    assert.equal(shown.buttons, 0);
    assert.ok(shown.heads.includes('"Hz"'), shown.heads.join());
    assert.ok(shown.value, 'which value the map shows');
    assert.ok(shown.tops.length > 0 && shown.tops[0] === shown.tops[1], 'two diagrams side by side');
  });
});

test('what was asked for comes first', async () => {
  await withKeptPage(report(...everything()), { ...still, viewport: { width: 1400, height: 900 } }, async (page) => {
    const order = await page.locator('#main > section').evaluateAll((all) => all.map((e) => e.id));
    const asked = ['diagnosis', 'identification', 'comparison', 'mechanism'];
    assert.deepEqual(order.filter((id) => asked.includes(id)), asked);
    assert.ok(order.indexOf('simulation') < order.indexOf('what-if'), order.join());
  });
});

/** Contrast of two CSS colours. */
const contrast = (a, b) => {
  const light = (colour) => {
    const [red, green, blue] = colour.match(/[\d.]+/g).map((part) => {
      const c = Number(part) / 255;
      return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
    });
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
  };
  const [high, low] = [light(a), light(b)].sort((x, y) => y - x);
  return (high + 0.05) / (low + 0.05);
};

test('paper is light, also of a dark page', async () => {
  await withKeptPage(report(...everything()), { ...still, colorScheme: 'dark', viewport: { width: 1400, height: 900 } }, async (page) => {
    await calculated(page);
    /** Most frequent colour of the lines of each diagram: that of its grid. */
    const grids = () =>
      page.evaluate(() =>
        [...document.querySelectorAll('.uplot canvas')].filter((e) => e.width > 0).map((e) => {
          const { data } = e.getContext('2d').getImageData(0, 0, e.width, e.height);
          const counts = new Map();
          for (let k = 0; k < data.length; k += 4)
            if (data[k + 3] === 255) {
              const colour = `rgb(${data[k]}, ${data[k + 1]}, ${data[k + 2]})`;
              counts.set(colour, (counts.get(colour) ?? 0) + 1);
            }
          return [...counts].sort((a, b) => b[1] - a[1])[0]?.[0] ?? 'rgb(0, 0, 0)';
        }),
      );
    for (const colour of await grids()) assert.ok(contrast(colour, 'rgb(0, 0, 0)') < 5, `on screen: ${colour}`);
    const open = await page.locator('details[open]').count();
    const keys = () => page.locator('.run .legend .line').evaluateAll((all) => all.slice(0, 2).map((e) => getComputedStyle(e).borderTopColor));
    const dark = await keys();
    await page.emulateMedia({ media: 'print', colorScheme: 'dark' });
    await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
    for (const colour of await grids()) assert.ok(contrast(colour, 'rgb(255, 255, 255)') < 2, `on paper: ${colour}`);
    for (const colour of await keys()) assert.ok(!dark.includes(colour), `key on paper: ${colour}`);
    const labels = await page.evaluate(() =>
      [...document.querySelectorAll('.chart text, .stiffness text')].filter((e) => e.checkVisibility()).map((e) => getComputedStyle(e).fill),
    );
    assert.ok(labels.length > 10);
    for (const colour of labels) assert.ok(contrast(colour, 'rgb(255, 255, 255)') >= 4.5, `label on paper: ${colour}`);
    const useless = await page.evaluate(() =>
      [...document.querySelectorAll('.how, .stabilisation select, .identified input')].filter((e) => e.checkVisibility()).map((e) => e.outerHTML),
    );
    assert.deepEqual(useless, [], 'nothing on paper says what to do with the page');
    await page.emulateMedia({ media: 'screen', colorScheme: 'dark' });
    await page.evaluate(() => dispatchEvent(new Event('afterprint')));
    for (const colour of await grids()) assert.ok(contrast(colour, 'rgb(0, 0, 0)') < 5, `on screen again: ${colour}`);
    assert.deepEqual(await keys(), dark);
    assert.equal(await page.locator('details[open]').count(), open, 'what was folded is folded again');
  });
});

test('fields look alike in the dark, and what they suggest can be read', async () => {
  await withKeptPage(report(...everything()), { ...still, colorScheme: 'dark', viewport: { width: 1400, height: 900 } }, async (page) => {
    await calculated(page);
    const fields = await page.evaluate(() =>
      [...document.querySelectorAll('input:not([type="range"], [type="checkbox"], [type="file"]), select')].filter((e) => e.checkVisibility()).map((e) => {
        const { backgroundColor: back, color } = getComputedStyle(e);
        return { name: e.dataset.control ?? e.id, back, color, hint: getComputedStyle(e, '::placeholder').color };
      }),
    );
    assert.ok(fields.length > 10);
    assert.deepEqual([...new Set(fields.map(({ back }) => back))].length, 1, JSON.stringify(fields));
    for (const { name, back, color, hint } of fields) {
      assert.ok(contrast(color, back) >= 4.5, `${name}: ${color} on ${back}`);
      assert.ok(contrast(hint, back) >= 4.5, `hint of ${name}: ${hint} on ${back}`);
    }
  });
});

const groupedBy = (list, key) => {
  const groups = new Map();
  for (const one of list) groups.set(key(one), [...(groups.get(key(one)) ?? []), one]);
  return groups;
};

/** Boxes of the sections that are seen, in their order. */
const boxes = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll('main > section')].filter((e) => e.checkVisibility()).map((e) => {
      const { left, right, top, bottom } = e.getBoundingClientRect();
      return { id: e.id, left, right, top: top + scrollY, bottom: bottom + scrollY };
    }),
  );

/** The sections stand in this many columns, without gaps and overlaps. */
async function standInColumns(page, number) {
  const all = await boxes(page);
  const columns = groupedBy(all, ({ left }) => Math.round(left));
  assert.equal(columns.size, number);
  for (const column of columns.values())
    column.slice(1).forEach(({ id, top }, k) => {
      const gap = top - column[k].bottom;
      assert.ok(gap > 12 && gap < 18, `${gap} px between ${column[k].id} and ${id}`);
    });
  return all;
}

for (const [width, number] of [[2560, 2], [3840, 3]])
  test(`a window of ${width} px: ${number} columns of sections from edge to edge, without gaps`, async () => {
    await withKeptPage(report(...everything()), { ...still, viewport: { width, height: 1400 } }, async (page) => {
      await calculated(page);
      const all = await standInColumns(page, number);
      const used = Math.max(...all.map(({ right }) => right)) - Math.min(...all.map(({ left }) => left));
      assert.ok(used > 0.97 * width, `${used} px of ${width} px are used`);
      all.slice(1).forEach(({ id, top }, k) => assert.ok(top >= all[k].top - 4, `${id} does not stand above what comes before it`));
      const lines = await page.evaluate(() => Math.max(...[...document.querySelectorAll('p')].map((e) => e.offsetWidth)));
      assert.ok(lines < 1000, `lines of ${lines} px`);
      await page.evaluate(() => document.querySelectorAll('details').forEach((part) => (part.open = !part.open)));
      await page.waitForTimeout(200);
      const later = await standInColumns(page, number);
      assert.deepEqual(later.map(({ left }) => left), all.map(({ left }) => left), 'no section changes its column');
      await page.setViewportSize({ width: 1400, height: 900 });
      await page.waitForFunction(() => !document.querySelector('main').classList.contains('columns'));
      const narrow = await boxes(page);
      assert.equal(Math.min(...narrow.map(({ left }) => left)), narrow[0].left);
      assert.ok(narrow.every(({ right }) => right <= 1400));
    });
  });

test('no section ends with an empty part, and things that belong together stand side by side', async () => {
  await withKeptPage(report(...everything()), { ...still, viewport: { width: 1400, height: 900 } }, async (page) => {
    await calculated(page);
    const empty = await page.evaluate(() =>
      [...document.querySelectorAll('main > section')].filter((e) => e.checkVisibility()).flatMap((section) => {
        const parts = [...section.querySelectorAll('p, table, figure, pre, button, svg, canvas, li, input')].filter((e) => e.checkVisibility());
        const end = Math.max(...parts.map((e) => e.getBoundingClientRect().bottom));
        const left = section.getBoundingClientRect().bottom - end;
        return left > 45 && !['mechanism', 'modes'].includes(section.id) ? [`${section.id}: ${left} px`] : [];
      }),
    );
    assert.deepEqual(empty, []);
    const box = (selector) => page.locator(selector).first().boundingBox();
    const [machine, signals] = [await box('.run .machine'), await box('.histories')];
    assert.ok(machine.x + machine.width < signals.x && Math.abs(machine.y - signals.y) < 60, 'the machine beside its signals');
    const tops = await page.locator('.histories .uplot').evaluateAll((all) => all.map((e) => Math.round(e.getBoundingClientRect().top)));
    const rows = [...groupedBy(tops, (top) => top).values()].map((row) => row.length);
    assert.equal(new Set(rows).size, 1, `rows of diagrams: ${rows}`);
    const [legs, abilities] = [await box('.check-legs'), await box('.abilities')];
    assert.ok(legs.x + legs.width < abilities.x, 'what the machine can do beside the legs at rest');
    const [chooser, values] = [await box('.chooser'), await box('.readout')];
    assert.ok(values.y > chooser.y && values.x < chooser.x + chooser.width, 'the values at the cursor below the chooser');
  });
});

/** A machine with turned neutral pose on plain struts. */
function struts() {
  const file = temporary('struts.toml');
  writeFileSync(
    file,
    `name = "Strut platform"
[base.joints]
circle = { radius = 1.137, spacing = 0.263 }
[platform.joints]
circle = { radius = 0.811, spacing = 0.247 }
[platform]
mass = 1387.3
mass_center = [0.013, -0.021, 0.187]
inertia = { xx = 431.7, yy = 517.9, zz = 763.1 }
[poses.neutral]
position = [0.031, -0.017, 1.393]
rotation = [0.03, -0.05, 0.02]
[legs.strut]
stiffness = "17.3 kN/mm"
damping = "2.7 kN s/m"
`,
  );
  return file;
}

test('a machine without flexible legs has no columns and keys for them; its turned neutral pose is the neutral one', async () => {
  await withPage(report(struts()), { ...still, viewport: { width: 1400, height: 900 } }, async (page) => {
    await calculated(page);
    assert.deepEqual(await page.locator('.what-if-results thead th').allTextContents(), ['Direction', 'Rigid legs, Hz', 'A, Hz', 'B − A']);
    assert.deepEqual(await page.locator('#what-if .legend li').allTextContents(), ['B, rigid legs', 'A, rigid legs']);
    assert.deepEqual(await page.locator('#modes .legend li').allTextContents(), ['x', 'y', 'z', 'rx', 'ry', 'rz', 'struts']);
    assert.match(await page.locator('.workspace-words').textContent(), /^At the neutral pose: /);
    assert.doesNotMatch(await page.evaluate(() => window.hydrapod.workspace.command()), /e-\d\d deg/);
    const [machine, modes] = [await page.locator('#mechanism').boundingBox(), await page.locator('#modes').boundingBox()];
    assert.ok(modes.height >= machine.height - 1, 'no hole below a short table');
    assert.deepEqual(await faults(page), []);
  });
});

test('the machine stays in sight beside thirty modes, and values stand beside their sliders', async () => {
  await withPage(report(...damped), { ...still, viewport: { width: 1400, height: 900 } }, async (page) => {
    await calculated(page);
    const last = page.locator('#modes tbody tr').last();
    await last.evaluate((e) => e.scrollIntoView({ block: 'end', behavior: 'instant' }));
    const { y, height } = await page.locator('#mechanism .machine').boundingBox();
    assert.ok(y >= 0 && y + height <= 900, `from ${y} to ${y + height} px`);
    await page.locator('#what-if').evaluate((e) => e.scrollIntoView({ behavior: 'instant' }));
    const ends = await page.locator('.in-sight').evaluate((e) => e.getBoundingClientRect().bottom);
    assert.ok(ends <= (await page.locator('#what-if').boundingBox()).y, 'it does not cover what follows');
    for (const width of [1400, 1920]) {
      await page.setViewportSize({ width, height: 900 });
      const below = await page.evaluate(() =>
        [...document.querySelectorAll('.slider')].filter((e) => e.checkVisibility() && e.querySelector('output').getBoundingClientRect().top > e.querySelector('input').getBoundingClientRect().bottom).map((e) => e.textContent),
      );
      assert.deepEqual(below, [], `${width} px`);
    }
  });
});

test('a MAC matrix of many modes fits a phone', async () => {
  await withPage(report(...everything()), { ...still, viewport: { width: 360, height: 740 }, isMobile: true }, async (page) => {
    await page.evaluate(() => {
      for (const row of document.querySelectorAll('.mac tr'))
        for (let k = row.cells.length; k <= 18; ++k) {
          const cell = row.lastElementChild.cloneNode(true);
          if (cell.localName === 'th') cell.textContent = String(k);
          row.append(cell);
        }
    });
    await page.waitForFunction(() => document.querySelector('.mac').classList.contains('stacked'));
    const [table, room] = await page.locator('.mac').evaluate((e) => [e.getBoundingClientRect().width, e.parentElement.clientWidth]);
    assert.ok(table <= room + 0.5, `${table} px in ${room} px`);
  });
});

test('a window that becomes narrow and wide again: the tables follow', async () => {
  await withPage(report(published), { ...still, viewport: { width: 1400, height: 900 } }, async (page) => {
    await calculated(page);
    const stacked = () => page.locator('.stacked').count();
    assert.equal(await stacked(), 0, 'tables are tables where there is room');
    await page.setViewportSize({ width: 360, height: 740 });
    await page.waitForFunction(() => document.querySelector('#modes .stacked') !== null);
    const row = page.locator('#modes .stacked tbody tr').first();
    const names = await row.locator('[data-column]').evaluateAll((cells) => cells.map((cell) => cell.dataset.column));
    assert.deepEqual(names, ['Mode', 'Hz', 'rad/s', 'ζ', 'Motion', 'Compliance', 'Rigid Hz', 'Shift', 'MAC']);
    await page.locator('#modes [data-sort="shift"]').click(); // the head still sorts
    assert.equal(await page.locator('#modes [aria-sort="ascending"]').count(), 1);
    assert.deepEqual(await faults(page), []);
    await page.setViewportSize({ width: 1400, height: 900 });
    await page.waitForFunction(() => document.querySelector('.stacked') === null);
    assert.deepEqual(await faults(page), []);
  });
});

test('diagrams of a narrow page: the labels of each axis stand apart', async () => {
  await withPage(report(published), { ...still, viewport: { width: 360, height: 740 } }, async (page) => {
    await calculated(page);
    const drawn = page.locator('#what-if .small-bode text');
    const labels = (await drawn.allTextContents()).filter((text) => /^\d+$/.test(text));
    assert.ok(labels.length >= 3, `an axis can be read: ${labels}`);
  });
});
