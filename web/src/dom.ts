// Elements without markup strings: text is always text, whatever it holds.

type Value = string | number | boolean | EventListener | null | undefined;
type Child = Node | string | number | null | undefined | false;

function set(element: Element, name: string, value: Value): void {
  if (typeof value === 'function') element.addEventListener(name.replace(/^on/, ''), value);
  else if (value === true) element.setAttribute(name, '');
  else if (value !== false && value !== null && value !== undefined)
    element.setAttribute(name, String(value));
}

function fill<E extends Element>(
  element: E,
  attributes: Record<string, Value>,
  children: Child[],
): E {
  for (const [name, value] of Object.entries(attributes)) set(element, name, value);
  for (const child of children)
    if (child !== null && child !== undefined && child !== false)
      element.append(typeof child === 'number' ? String(child) : child);
  return element;
}

/** An HTML element; attributes that are functions become listeners (`onclick`). */
export function html<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, Value> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  return fill(document.createElement(tag), attributes, children);
}

/** An SVG element. */
export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, Value> = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  return fill(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, children);
}

/** Text for screen readers only. */
export function unseen(text: string): HTMLSpanElement {
  return html('span', { class: 'unseen' }, text);
}

let identifiers = 0;
export const identifier = (prefix: string): string => `${prefix}-${++identifiers}`;

/** Shows a command. Its lines end at spaces, not within a name or an option (`--pose`). */
export function showCommand(element: HTMLElement, text: string): void {
  const words = text.split(' ').map((word) => html('span', { class: 'word' }, word));
  element.replaceChildren(...words.flatMap((word, k) => (k === 0 ? [word] : [' ', word])));
}

/** A button that says what it does. */
export function button(
  text: string,
  action: () => void,
  attributes: Record<string, Value> = {},
): HTMLButtonElement {
  return html('button', { type: 'button', onclick: () => action(), ...attributes }, text);
}

export interface Slider {
  element: HTMLElement;
  input: HTMLInputElement;
}

/** A labelled slider with its value beside it. */
export function slider(
  label: string,
  range: { min: number; max: number; step: number; value: number },
  show: (value: number) => string,
  change: (value: number) => void,
  name: string,
): Slider {
  const id = identifier(name);
  const input = html('input', { type: 'range', id, 'data-control': name, ...range });
  const output = html('output', { for: id }, show(range.value));
  input.addEventListener('input', () => {
    const value = Number(input.value);
    output.textContent = show(value);
    input.setAttribute('aria-valuetext', show(value));
    change(value);
  });
  input.setAttribute('aria-valuetext', show(range.value));
  return {
    element: html('div', { class: 'slider' }, html('label', { for: id }, label), input, output),
    input,
  };
}

/** A labelled checkbox. */
export function checkbox(
  label: string,
  checked: boolean,
  change: (checked: boolean) => void,
  name: string,
): HTMLLabelElement {
  const input = html('input', { type: 'checkbox', checked, 'data-control': name });
  input.addEventListener('change', () => change(input.checked));
  return html('label', { class: 'check' }, input, label);
}

/** A labelled list of `options`; `change` gets the number of the chosen one. */
export function select(
  label: string,
  options: readonly string[],
  change: (option: number) => void,
  name: string,
): HTMLElement {
  const id = identifier(name);
  const input = html(
    'select',
    { id, 'data-control': name },
    ...options.map((text, k) => html('option', { value: k }, text)),
  );
  input.addEventListener('change', () => change(Number(input.value)));
  return html('span', { class: 'select' }, html('label', { for: id }, label), input);
}

/** Controls side by side. */
export function controlRow(...controls: Child[]): HTMLElement {
  return html('div', { class: 'controls' }, html('div', { class: 'row' }, ...controls));
}

/** Says to screen readers what the canvas in `element` shows. */
export function describeCanvas(element: HTMLElement, words: string): void {
  const canvas = element.querySelector('canvas');
  canvas?.setAttribute('role', 'img');
  canvas?.setAttribute('aria-label', words);
}

/** Calls `act` where `element` has another width than before. It must not change the height of `element`. */
export function onNewWidth(element: Element, act: () => void): void {
  let width = 0;
  new ResizeObserver(() => {
    if (element.clientWidth === width) return;
    width = element.clientWidth;
    act();
  }).observe(element);
}

/** Of the text on A4 with the margins of print.css [px]. */
export const paper = 680;

/** Calls `act` before a print and after it: what is drawn for a width has that of the paper meanwhile. */
export function onPrint(act: (printed: boolean) => void): void {
  for (const event of ['beforeprint', 'afterprint']) addEventListener(event, () => act(event === 'beforeprint'));
}

/** What to do with the page: nothing for paper. */
export const how = (words: string): HTMLElement => html('span', { class: 'how' }, words);

/** On paper in place of what is still being calculated. */
export const notReady = (what: string): HTMLElement =>
  html('span', { class: 'print-only not-ready' }, `${what} was not calculated yet when this page was printed.`);

/** Offers `content` as a file, made here and now. */
export function download(name: string, content: Blob): void {
  const url = URL.createObjectURL(content);
  const link = html('a', { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
