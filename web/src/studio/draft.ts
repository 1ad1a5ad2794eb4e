// What was typed and not yet sent, kept while the page loads again with a new result.

/** Values of the inputs of each form, by its name, and what is unfolded. */
export interface Draft {
  kind: string;
  fields: Record<string, (string | boolean)[]>;
  unfolded: boolean[];
}

type Input = HTMLInputElement | HTMLTextAreaElement | HTMLSelectElement;

const key = 'hydrapod-draft';

const inputsOf = (form: HTMLElement): Input[] => [...form.querySelectorAll<Input>('input, textarea, select')];
const isCheck = (input: Input): input is HTMLInputElement => input.type === 'checkbox';

export const valuesIn = (form: HTMLElement): (string | boolean)[] =>
  inputsOf(form).map((input) => (isCheck(input) ? input.checked : input.value));

export function setValues(form: HTMLElement, values: (string | boolean)[] = []): void {
  inputsOf(form).forEach((input, k) => {
    const value = values[k];
    if (value === undefined) return;
    if (isCheck(input)) input.checked = value === true;
    // a record that is no longer in the list stays unchosen
    else if (!(input instanceof HTMLSelectElement) || [...input.options].some((one) => one.value === value))
      input.value = String(value);
    input.dispatchEvent(new Event(input instanceof HTMLSelectElement ? 'change' : 'input'));
  });
}

export const keepDraft = (draft: Draft): void => sessionStorage.setItem(key, JSON.stringify(draft));

/** The draft that was kept, once. */
export function takeDraft(): Draft | null {
  const text = sessionStorage.getItem(key);
  sessionStorage.removeItem(key);
  return text ? JSON.parse(text) : null;
}
