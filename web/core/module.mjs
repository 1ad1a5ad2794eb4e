// The core of the page in node, for tests and measurements: the same engine (V8) as in Chromium, without a browser
// around it.
import { readFileSync } from 'node:fs';

/** A module of its own, from the file that the page has in it. */
export async function startCore() {
  const nothing = () => 0; // no environment, no files
  const { instance } = await WebAssembly.instantiate(readFileSync(new URL('hydrapod.wasm', import.meta.url)), {
    env: { emscripten_notify_memory_growth: nothing },
    wasi_snapshot_preview1: {
      proc_exit: nothing,
      environ_sizes_get: nothing,
      environ_get: nothing,
      fd_write: nothing,
      fd_close: nothing,
      fd_seek: nothing,
    },
  });
  const core = instance.exports;
  core._initialize();
  return {
    core,
    /** The answer; throws what the core refuses. */
    call(name, value) {
      const bytes = new TextEncoder().encode(JSON.stringify(value));
      new Uint8Array(core.memory.buffer, core.core_room(bytes.length), bytes.length).set(bytes);
      const refused = core[name]() !== 0;
      const text = new TextDecoder().decode(
        new Uint8Array(core.memory.buffer, core.core_answer(), core.core_answer_size()),
      );
      if (refused) throw new Error(text);
      return text;
    },
    /** Numbers for the next call. */
    give(numbers) {
      const at = core.core_lines(numbers.length);
      new Float64Array(core.memory.buffer, at, numbers.length).set(numbers);
    },
    /** `count` numbers of the last call. */
    taken: (count) => new Float64Array(core.memory.buffer, core.core_numbers(), count).slice(),
  };
}
