// Numbers as people read them.

const minus = (text: string): string => text.replace(/^-/, '−');

export const fixed = (value: number, digits: number): string => minus(value.toFixed(digits));

/** Does the reader's language write "2,5"? */
const decimalComma = (1.5).toLocaleString().includes(',');

/** A typed number with a decimal point, and with a decimal comma where the reader's language has it. */
export const withPoint = (text: string): string =>
  decimalComma ? text.replace(/^([^.,]*),(\d*)(?![\d.,])/, '$1.$2') : text;

/** With at most `digits` significant digits: "0.0123", "−40". */
export const significant = (value: number, digits: number): string =>
  String(Number(value.toPrecision(digits))).replace('-', '−');

/** With four digits: "0.4882", "1.573e5". */
export const plain = (value: number): string =>
  Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-2)
    ? value.toPrecision(4).replace('e+', 'e')
    : String(Number(value.toPrecision(4)));

/**
 * A value and half of its interval to the same decimal place, that of the second significant digit of the half;
 * `otherwise`: decimals where there is no interval.
 */
export function withInterval(value: number, half: number, otherwise: number): [value: string, half: string] {
  const known = half > 0 && Number.isFinite(half);
  const leading = known ? Math.floor(Math.log10(Number(half.toPrecision(2)))) : 0;
  const digits = known ? Math.min(12, Math.max(0, 1 - leading)) : otherwise;
  return [fixed(value, digits), fixed(half, digits)];
}

/** Half of a 95 % interval in standard deviations, of a normal distribution. */
export const halfWidth95 = 1.959963984540054;

/** "12 %", "<1 %". */
export function share(value: number): string {
  const percent = 100 * value;
  return percent > 0 && percent < 0.5 ? '<1 %' : `${fixed(percent, 0)} %`;
}

/** "−0.13 %", "+14 %". */
export function signedPercent(percent: number): string {
  const digits = Math.abs(percent) < 10 ? 2 : 1;
  if (Math.abs(percent) < 0.005) return '0.00 %';
  return `${percent > 0 ? '+' : ''}${fixed(percent, digits)} %`;
}

export function hertz(frequency: number): string {
  return frequency >= 1000 ? fixed(frequency, 0) : fixed(frequency, frequency < 100 ? 3 : 2);
}

const superscripts = '⁰¹²³⁴⁵⁶⁷⁸⁹';
/** "⁻⁷" */
export const raised = (exponent: number): string =>
  (exponent < 0 ? '⁻' : '') +
  [...String(Math.abs(exponent))].map((d) => superscripts[Number(d)]).join('');

/** "3.142·10⁻⁷" */
export function scientific(value: number, digits = 4): string {
  if (!Number.isFinite(value)) return '∞';
  if (value === 0) return '0';
  const [mantissa, exponent] = value.toExponential(digits - 1).split('e') as [string, string];
  return `${minus(mantissa)}·10${raised(Number(exponent))}`;
}

/** "10⁻⁷", or "3·10⁻⁷". */
export function tick(value: number): string {
  const exponent = Math.floor(Math.log10(value) + 1e-9);
  const mantissa = value / 10 ** exponent;
  return Math.abs(mantissa - 1) < 1e-6
    ? `10${raised(exponent)}`
    : `${mantissa.toFixed(0)}·10${raised(exponent)}`;
}

export const list = (values: readonly number[], digits: number): string =>
  values.map((value) => fixed(value, digits)).join(', ');
