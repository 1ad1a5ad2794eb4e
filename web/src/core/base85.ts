// Bytes as text, four of them in five characters, of those that mean nothing to HTML, to C++ and to templates. A
// quarter more than the bytes, where base64 has a third. web/build.mjs writes it, the worker reads it.

const printable = Array.from({ length: 95 }, (_, k) => String.fromCharCode(32 + k));
const digits = printable.filter((character) => !' "$%&<\\`{}'.includes(character));

/** A last group of n bytes has n + 1 characters. */
export function toBase85(bytes: Uint8Array): string {
  let text = '';
  for (let at = 0; at < bytes.length; at += 4) {
    const count = Math.min(4, bytes.length - at);
    let value = 0;
    for (let k = 0; k < 4; ++k) value = value * 256 + (k < count ? bytes[at + k] : 0);
    const group: string[] = [];
    for (let k = 0; k < 5; ++k, value = Math.floor(value / 85)) group.unshift(digits[value % 85]);
    text += group.slice(0, count + 1).join('');
  }
  return text;
}

export function fromBase85(text: string): Uint8Array<ArrayBuffer> {
  const digitOf = new Int8Array(128).fill(-1);
  digits.forEach((character, digit) => (digitOf[character.charCodeAt(0)] = digit));
  const bytes = new Uint8Array(Math.floor((text.length * 4) / 5));
  for (let at = 0, to = 0; at < text.length; at += 5, to += 4) {
    let value = 0;
    for (let k = 0; k < 5; ++k) value = value * 85 + (at + k < text.length ? (digitOf[text.charCodeAt(at + k)] ?? 0) : 84);
    for (let k = 3; k >= 0; --k, value = Math.floor(value / 256)) if (to + k < bytes.length) bytes[to + k] = value % 256;
  }
  return bytes;
}
