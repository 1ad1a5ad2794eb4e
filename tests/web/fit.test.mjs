// The fit of chosen poles in the core of the page: against the identification of the program, against systems that
// are written out here, and with what no page gives it.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { correlated, hannTaper, json, near, published, random, responses } from './support.mjs';

const { startCore } = await import(pathToFileURL(join(process.env.HYDRAPOD_SOURCE, 'web', 'core', 'module.mjs')));
const { call, give, taken } = await startCore();

const c = (re, im = 0) => ({ re, im });
const add = (a, b) => c(a.re + b.re, a.im + b.im);
const less = (a, b) => c(a.re - b.re, a.im - b.im);
const times = (a, b) => c(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
const over = (a, b) => {
  const square = b.re ** 2 + b.im ** 2;
  return c((a.re * b.re + a.im * b.im) / square, (a.im * b.re - a.re * b.im) / square);
};
const conj = (a) => c(a.re, -a.im);
const exp = (a) => c(Math.exp(a.re) * Math.cos(a.im), Math.exp(a.re) * Math.sin(a.im));
const size = (a) => Math.hypot(a.re, a.im);
const power = (a, n) => (n < 0 ? over(c(1), power(a, -n)) : n === 0 ? c(1) : times(a, power(a, n - 1)));

const two_pi = 2 * Math.PI;

/** 1/(s − λ) */
const plain = (s, pole) => over(c(1), less(s, pole));

/** ∫_0^T (1 − τ/T) e^((λ − s) τ) dτ: a pole behind the triangle's window. */
const behindTriangle = (T) => (s, pole) => {
  const a = less(pole, s);
  const aT = times(a, c(T));
  return over(less(less(exp(aT), c(1)), aT), times(times(a, a), c(T)));
};

/** A system of three poles, `q` outputs and `p` inputs. */
function system(q, p, seed = 3) {
  const some = random(seed);
  const vector = (n) => Array.from({ length: n }, () => c(some() - 0.5, some() - 0.5));
  const modes = [[6, 0.02], [9, 0.01], [14, 0.04]].map(([f, zeta]) => ({
    pole: c(-zeta * two_pi * f, two_pi * f * Math.sqrt(1 - zeta * zeta)),
    shape: vector(q),
    participation: vector(p).map((value, i) => (i === 1 % p ? c(1) : times(value, c(0.9)))),
  }));
  const terms = [-2, -1, 0, 1].map(() =>
    Array.from({ length: q }, () => Array.from({ length: p }, () => 0.003 * (some() - 0.5))),
  );
  return { q, p, modes, terms };
}

const scale = two_pi * 20;

/** What `given` has at (o, i) and s, its poles by `g`. */
function value({ modes, terms }, o, i, s, g) {
  let h = c(0);
  for (const { pole, shape, participation } of modes) {
    const A = times(shape[o], participation[i]);
    h = add(h, add(times(A, g(s, pole)), times(conj(A), g(s, conj(pole)))));
  }
  terms.forEach((C, k) => {
    h = add(h, times(power(over(s, c(scale)), k - 2), c(C[o][i])));
  });
  return h;
}

const lines = (count, step = 1 / 16, from = 2) => Array.from({ length: count }, (_, k) => from + step * k);

/** By output and input the response at the lines. */
const measured = (given, frequency, { g = plain, shift = 0 } = {}) =>
  Array.from({ length: given.q }, (_, o) =>
    Array.from({ length: given.p }, (__, i) => frequency.map((f) => value(given, o, i, c(shift, two_pi * f), g))),
  );

/** Hands responses over; what is in `shape` stands in place of what fits. */
function hand(frequency, H, { deviation, correlation, window = [], shape = {} } = {}) {
  const numbers = [...frequency];
  H.forEach((row, o) =>
    row.forEach((h, i) => {
      numbers.push(...h.map(({ re }) => re), ...h.map(({ im }) => im));
      if (deviation) numbers.push(...frequency.map((_, k) => deviation(o, i, k)));
    }),
  );
  if (correlation)
    H[0].forEach((_, i) =>
      H[0].slice(i + 1).forEach((__, n) => {
        const both = frequency.map((___, k) => correlation(i, i + 1 + n, k));
        numbers.push(...both.map(({ re }) => re), ...both.map(({ im }) => im));
      }),
    );
  numbers.push(...window);
  give(Float64Array.from(numbers));
  call('core_measured', {
    outputs: H.length,
    inputs: H[0]?.length ?? 0,
    lines: frequency.length,
    deviations: deviation !== undefined,
    correlation: correlation !== undefined,
    shift: 0,
    residual_terms: 4,
    window: window.length,
    duration: 16,
    ...shape,
  });
}

const asked = ({ pole, participation }) => ({
  pole,
  participation: { re: participation.map(({ re }) => re), im: participation.map(({ im }) => im) },
});

/** The fit of poles to what was handed over last, of q × p responses at `count` lines. */
function fitted(poles, q, p, count) {
  const numbers = taken(Number(call('core_fit', { poles: poles.map(asked) })));
  assert.equal(numbers.length, 1 + 2 * q * (poles.length + p * count));
  let at = 1;
  const next = () => c(numbers[at++], numbers[at++]);
  const list = (n, of) => Array.from({ length: n }, of);
  return {
    error: numbers[0],
    shapes: poles.map(() => list(q, next)),
    model: list(q, () => list(p, () => list(count, next))),
  };
}

function nearAll(actual, expected, tolerance, what) {
  const whole = Math.hypot(...expected.map(size));
  actual.forEach((a, k) => {
    const off = size(less(a, expected[k]));
    assert.ok(off <= tolerance * whole, `${what}, ${k}: off by ${off / whole}`);
  });
}

/** Of exact responses the fit finds the shapes that are in them. */
function findsTheSystem(given, frequency, options, tolerance) {
  const H = measured(given, frequency, options);
  hand(frequency, H, options);
  const found = fitted(given.modes, given.q, given.p, frequency.length);
  given.modes.forEach(({ shape }, r) => nearAll(found.shapes[r], shape, tolerance, `shape ${r + 1}`));
  H.forEach((row, o) => row.forEach((h, i) => nearAll(found.model[o][i], h, tolerance, `response ${o}, ${i}`)));
  assert.ok(found.error <= tolerance, `error ${found.error}`);
}

test('shapes of a system that is written out: on the imaginary axis, beside it, with one input', () => {
  findsTheSystem(system(4, 3), lines(300), {}, 1e-9);
  findsTheSystem(system(4, 3), lines(300), { shift: 0.9, shape: { shift: 0.9 } }, 1e-9);
  findsTheSystem(system(6, 1), lines(200), {}, 1e-9);
  findsTheSystem(system(1, 6), lines(200), {}, 1e-9);
  // with errors, which of exact responses change nothing
  const deviation = (o, i, k) => (1 + o) * (2 - 0.2 * i) * (1 + 0.01 * k);
  findsTheSystem(system(4, 3), lines(300), { deviation }, 1e-9);
});

test('the same through a window, whose integral is known in closed form', () => {
  const count = 8192;
  const T = 16;
  const window = Array.from({ length: count }, (_, t) => -t / count);
  // the trapezoidal rule of steps T/8192 is off by some 1e-6 of the smallest responses
  findsTheSystem(system(4, 3), lines(300), { g: behindTriangle(T), window }, 1e-5);
  // poles and shapes are not those without the window
  const given = system(4, 3);
  hand(lines(300), measured(given, lines(300), { g: behindTriangle(T) }));
  assert.ok(fitted(given.modes, 4, 3, 300).error > 0.05);
});

/**
 * Is it a least-squares fit? Then what it leaves over is orthogonal, in the weighted sum, to everything it may add:
 * to both parts of every pole and to every residual term, for every output. And what it adds is nothing else.
 */
function isOptimal(frequency, H, poles, found, weight, what) {
  H.forEach((row, o) => {
    const columns = [];
    poles.forEach(({ pole, participation }) => {
      const parts = row.map((_, i) => frequency.map((f) => {
        const s = c(0, two_pi * f);
        return [times(participation[i], plain(s, pole)), times(conj(participation[i]), plain(s, conj(pole)))];
      }));
      columns.push(parts.map((line) => line.map(([a, b]) => add(a, b))));
      columns.push(parts.map((line) => line.map(([a, b]) => times(c(0, 1), less(a, b)))));
    });
    row.forEach((_, input) =>
      [-2, -1, 0, 1].forEach((n) =>
        columns.push(row.map((__, i) => frequency.map((f) => (i === input ? power(c(0, (two_pi * f) / scale), n) : c(0))))),
      ),
    );
    let rest = 0;
    row.forEach((h, i) => h.forEach((v, k) => (rest += weight(o, i, k) * size(less(v, found.model[o][i][k])) ** 2)));
    columns.forEach((column, a) => {
      let [inner, own] = [0, 0];
      column.forEach((values, i) =>
        values.forEach((v, k) => {
          const e = less(H[o][i][k], found.model[o][i][k]);
          inner += weight(o, i, k) * (v.re * e.re + v.im * e.im);
          own += weight(o, i, k) * size(v) ** 2;
        }),
      );
      near(inner / Math.sqrt(own * rest), 0, 1e-8, `${what}: output ${o}, column ${a}`);
    });
    row.forEach((_, i) => {
      // what is no pole is a sum of residual terms: real numbers, found here from the first two lines
      const left = frequency.map((f, k) => {
        const s = c(0, two_pi * f);
        return poles.reduce((sum, { pole, participation }, r) => {
          const A = times(found.shapes[r][o], participation[i]);
          return less(sum, add(times(A, plain(s, pole)), times(conj(A), plain(s, conj(pole)))));
        }, found.model[o][i][k]);
      });
      const w = frequency.map((f) => (two_pi * f) / scale);
      const [m, n] = [0, frequency.length - 1];
      // Re = C₀ − C₋₂/w², Im = C₁ w − C₋₁/w
      const below = (left[m].re - left[n].re) / (w[n] ** -2 - w[m] ** -2);
      const constant = left[n].re + below / w[n] ** 2;
      const slope = (left[n].im * w[n] - left[m].im * w[m]) / (w[n] ** 2 - w[m] ** 2);
      const inverse = slope * w[n] ** 2 - left[n].im * w[n];
      const whole = Math.hypot(...found.model[o][i].map(size));
      left.forEach((v, k) => {
        near(v.re, constant - below / w[k] ** 2, 1e-9 * whole, `${what}: residual terms`);
        near(v.im, slope * w[k] - inverse / w[k], 1e-9 * whole, `${what}: residual terms`);
      });
    });
  });
}

const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
/** Over each line and two on either side. */
const smooth = (values) => values.map((_, k) => mean(values.slice(Math.max(0, k - 2), k + 3)));

test('other poles than those of the system: the fit of least squares, with the weights of the program', () => {
  const given = system(3, 2);
  const frequency = lines(240);
  const some = random(11);
  const noisy = measured(given, frequency).map((row) => row.map((h) => h.map((v) => add(v, c(1e-3 * some(), 1e-3 * some())))));
  const [first, second, third] = given.modes;
  const other = { ...second, pole: c(-2, two_pi * 7.3) };
  const choices = { all: given.modes, 'one left out': [third, first], 'one of another place': [first, other], none: [] };
  // errors are not known: one over the mean square of the row and of its neighbours, plus the median
  const square = noisy.map((row) => frequency.map((_, k) => mean(row.map((h) => size(h[k]) ** 2))));
  const median = square.map((own) => [...own].sort((a, b) => a - b)[own.length / 2]);
  const squareNear = square.map(smooth);
  const unknown = (o, i, k) => 1 / (squareNear[o][k] + median[o]);
  // errors are known: those of an output, averaged likewise, in the proportion that inputs have
  const deviation = (o, i, k) => 1e-3 * (1 + o) * [1, 3][i] * (1 + 0.2 * Math.sin(k));
  const varianceNear = noisy.map((_, o) => smooth(frequency.map((__, k) => mean([0, 1].map((n) => deviation(o, n, k) ** 2)))));
  const known = (o, i, k) => 5 / [1, 9][i] / varianceNear[o][k];
  for (const [name, poles] of Object.entries(choices))
    for (const [weight, options] of [[unknown, {}], [known, { deviation }]]) {
      hand(frequency, noisy, options);
      isOptimal(frequency, noisy, poles, fitted(poles, 3, 2, frequency.length), weight, name);
    }
});

test('more poles fit better; order and scale of what is given do not matter', () => {
  const given = system(3, 2);
  const frequency = lines(240);
  hand(frequency, measured(given, frequency));
  const errors = [0, 1, 2, 3].map((n) => fitted(given.modes.slice(0, n), 3, 2, 240).error);
  errors.slice(1).forEach((error, n) => assert.ok(error < errors[n], errors.join(', ')));
  const [first, second, third] = given.modes;
  const before = fitted([first, second], 3, 2, 240);
  const turned = { ...second, participation: second.participation.map((value) => times(value, c(3, -2))) };
  const after = fitted([turned, first], 3, 2, 240);
  nearAll(after.shapes[1], before.shapes[0], 1e-9, 'first shape');
  nearAll(after.shapes[0], before.shapes[1], 1e-9, 'second shape');
  near(after.error, before.error, 1e-9, 'error');
  // a pole twice determines the sum of its shapes alone, and that is that of one
  const twice = fitted([first, second, third, third], 3, 2, 240);
  nearAll(twice.shapes[2].map((a, o) => add(a, twice.shapes[3][o])), third.shape, 1e-6, 'a pole twice');
});

test('as many residual terms as the identification has', () => {
  const given = system(2, 2);
  const frequency = lines(240);
  const more = measured(given, frequency).map((row) =>
    row.map((h) => h.map((v, k) => add(v, times(power(c(0, (two_pi * frequency[k]) / scale), 3), c(0.1))))),
  );
  const error = (terms) => {
    hand(frequency, more, { shape: { residual_terms: terms } });
    return fitted(given.modes, 2, 2, 240).error;
  };
  assert.ok(error(4) > 1e-3);
  assert.ok(error(6) < 1e-9);
  near(error(0), error(4), 0, 'none are told: four');
});

const deviations = [2e-9, 2e-9, 1e-9, 3e-9, 3e-9, 2e-9];
const complex = ({ re, im }) => re.map((part, k) => c(part, im[k]));

for (const [name, more] of Object.entries({
  'on the imaginary axis': {},
  'beside it': { shift_per_s: 0.9 },
  'through a window': { sample_rate_hz: 128, taper: hannTaper(2048) },
  'with inputs whose errors are correlated': correlated,
}))
  test(`with the program's poles and participations its shapes and its error, ${name}`, () => {
    const modes = json('modes', published, '--model', 'rigid').modes;
    const file = responses('fit.json', modes, { damping: 0.013, deviation: deviations, more });
    const found = json('identify', file);
    const poles = [...found.modes, ...found.heavily_damped].map(({ pole, participation }) => ({
      pole,
      participation: complex(participation),
    }));
    const whole = JSON.parse(readFileSync(file, 'utf8'));
    const [from, to] = found.band_hz;
    const used = whole.frequency_hz.map((_, k) => k).filter((k) => whole.frequency_hz[k] >= from && whole.frequency_hz[k] <= to);
    const frequency = used.map((k) => whole.frequency_hz[k]);
    const H = whole.response.map((row) => row.map(({ re, im }) => used.map((k) => c(re[k], im[k]))));
    const Q = whole.input_factor.map((row) => row.map(({ re, im }) => c(re[0], im[0])));
    const isCorrelated = Q[0][1].re !== 0;
    hand(frequency, H, {
      deviation: (o, i) => deviations[o] * Math.sqrt(Q[i][i].re),
      ...(isCorrelated ? { correlation: (i, j) => over(Q[i][j], c(Math.sqrt(Q[i][i].re * Q[j][j].re))) } : {}),
      window: (more.taper ?? []).map((rho) => rho - 1),
      shape: { shift: more.shift_per_s ?? 0, residual_terms: found.residuals.terms.length },
    });
    const fit = fitted(poles, 6, 6, frequency.length);
    const tolerance = isCorrelated ? 1e-6 : 1e-8; // a little less correlation is taken than is said
    [...found.modes, ...found.heavily_damped].forEach(({ shape }, r) =>
      nearAll(fit.shapes[r], complex(shape), tolerance, `shape ${r + 1}`),
    );
    near(fit.error, found.fit_error, tolerance * found.fit_error, 'error');
  });

test('outputs without any response have no shape and leave the others as they are', () => {
  const given = system(3, 2);
  const frequency = lines(240);
  const H = measured(given, frequency);
  const silent = H.map((row, o) => (o === 1 ? row.map((h) => h.map(() => c(0))) : row));
  for (const deviation of [undefined, (o) => (o === 1 ? 0 : 1e-3)]) {
    hand(frequency, silent, { deviation });
    const fit = fitted(given.modes, 3, 2, 240);
    given.modes.forEach(({ shape }, r) => {
      assert.deepEqual(fit.shapes[r][1], c(0));
      nearAll([0, 2].map((o) => fit.shapes[r][o]), [0, 2].map((o) => shape[o]), 1e-9, 'the others');
    });
    assert.ok(fit.error < 1e-9);
  }
  hand(frequency, H.map((row) => row.map((h) => h.map(() => c(0)))));
  const nothing = fitted(given.modes, 3, 2, 240);
  assert.equal(nothing.error, 0);
  assert.ok(nothing.shapes.flat().every((v) => v.re === 0 && v.im === 0));
});

test('lines that are not those of the window are taken without it; lines above its rate do not disturb', () => {
  const given = system(3, 2);
  const uneven = lines(240).map((f, k) => f + 0.004 * Math.sin(k));
  const window = Array.from({ length: 4096 }, (_, t) => -t / 4096);
  findsTheSystem(given, uneven, { window }, 1e-9);
  const far = lines(240, 1, 1);
  hand(far, measured(given, far), { window: window.slice(0, 64) });
  assert.ok(Number.isFinite(fitted(given.modes, 3, 2, 240).error));
});

test('what is no measurement and no pole is refused, and the core goes on', () => {
  const given = system(2, 2);
  const frequency = lines(60);
  const H = measured(given, frequency);
  const good = () => hand(frequency, H);
  const broken = (value) => H.map((row, o) => row.map((h, i) => h.map((v, k) => (o + i + k === 7 ? c(value, v.im) : v))));
  const cases = [
    [/not all values are finite/, () => hand(frequency, broken(Number.NaN))],
    [/not all values are finite/, () => hand(frequency, broken(Number.POSITIVE_INFINITY))],
    [/not all values are finite/, () => hand(frequency, H, { deviation: (o, i, k) => (k === 3 ? Number.NaN : 1) })],
    [/do not ascend from above 0/, () => hand([...frequency].reverse(), H)],
    [/do not ascend from above 0/, () => hand(frequency.map((f) => f - 2), H)],
    [/do not ascend from above 0/, () => hand(frequency.map(() => 5), H)],
    [/another number of values/, () => hand(frequency, H, { shape: { lines: 61 } })],
    [/another number of values/, () => hand(frequency, H, { shape: { window: 64 } })],
    [/another number of values/, () => hand(frequency, H, { shape: { deviations: true } })],
    [/no lines/, () => hand(frequency, H, { shape: { outputs: 0 } })],
    [/no lines/, () => hand(frequency, H, { shape: { outputs: 4294967295, inputs: 4294967295 } })],
    [/no lines/, () => hand([5], H.map((row) => row.map((h) => h.slice(0, 1))))],
    [/no lines/, () => hand([], [[]])],
    [/correlation is above 1/, () => hand(frequency, H, { deviation: () => 1, correlation: () => c(0.9, 0.9) })],
    [/errors that are not known/, () => hand(frequency, H, { correlation: () => c(0.1) })],
    [/another number of values/, () => hand(frequency, H, { deviation: () => 1, shape: { correlation: true } })],
    [/no number from 0 on/, () => hand(frequency, H, { shape: { shift: -1 } })],
    [/has no duration/, () => hand(frequency, H, { window: [0, 0], shape: { duration: 0 } })],
    [/number/, () => hand(frequency, H, { shape: { shift: null } })],
    [/not found/, () => call('core_measured', {})],
  ];
  for (const [words, attempt] of cases) {
    assert.throws(attempt, words);
    assert.throws(() => fitted(given.modes, 2, 2, 60), 'there is nothing to fit to');
  }
  good();
  const [first] = given.modes;
  const poles = [
    [/no pole/, { ...first, participation: [c(1)] }],
    [/no pole/, { ...first, participation: [c(0), c(0)] }],
    [/number/, { ...first, participation: [c(1), c(Number.NaN)] }],
    [/number/, { ...first, pole: c(Number.NaN, 1) }],
    [/number/, { ...first, pole: { re: '1', im: 2 } }],
    [/not finite|no finite/, { ...first, pole: c(0, two_pi * frequency[9]) }], // on a line, undamped
  ];
  for (const [words, pole] of poles) {
    assert.throws(() => fitted([first, pole], 2, 2, 60), words);
    assert.ok(fitted(given.modes, 2, 2, 60).error < 1e-9, 'the responses are still there');
  }
  assert.throws(() => call('core_fit', {}), /not found/);
  hand(frequency, H, { deviation: () => 1, correlation: () => c(1) });
  assert.ok(fitted(given.modes, 2, 2, 60).error < 1e-6, 'one of 1 is taken');
  assert.throws(() => call('core_fit', { poles: 5 }), /at|number|pole/);
});
