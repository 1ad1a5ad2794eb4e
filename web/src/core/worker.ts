// The library's own mechanics (web/core, WebAssembly) beside the page, so that the page never stalls.
//
// Messages: { id, call, text, numbers? }; answers: { id, ok, text, numbers?, milliseconds }. `start`
// takes the module as gzip in base 85.

import { fromBase85 } from './base85';

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  core_room(bytes: number): number;
  core_answer(): number;
  core_answer_size(): number;
  core_lines(lines: number): number;
  core_sweep(): number;
  core_numbers(): number;
  core_open(): number;
  core_compute(): number;
  core_buckling(): number;
  core_sensitivities(): number;
  core_reach(): number;
  core_map(): number;
  core_curves(): number;
  core_scatter(): number;
  core_measured(): number;
  core_fit(): number;
}

type Call =
  | 'open'
  | 'compute'
  | 'buckling'
  | 'sensitivities'
  | 'reach'
  | 'map'
  | 'curves'
  | 'scatter'
  | 'measured'
  | 'fit';

/** Calls that `numbers` are for. */
const taking: Call[] = ['map', 'measured'];
/** Calls whose answer is how many numbers there are. */
const giving: Call[] = ['map', 'curves', 'scatter', 'fit'];

export interface Asked {
  id: number;
  call: Call | 'start';
  text: string;
  /**
   * With `compute`: also responses at these angular frequencies [rad/s]. With `map`: displacements,
   * six numbers each. With `measured`: measured responses.
   */
  numbers?: Float64Array;
}

export interface Answered {
  id: number;
  ok: boolean;
  text: string;
  numbers?: Float64Array;
  milliseconds: number;
}

const scope = self as unknown as {
  onmessage: (event: { data: Asked }) => void;
  postMessage(message: Answered, transfer?: Transferable[]): void;
};

let core: Exports;

async function start(module: string): Promise<void> {
  const packed = fromBase85(module);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  const nothing = () => 0; // no environment, no files
  const { instance } = await WebAssembly.instantiate(await new Response(stream).arrayBuffer(), {
    env: { emscripten_notify_memory_growth: nothing },
    wasi_snapshot_preview1: {
      proc_exit: (code: number) => {
        throw new Error(`the core ended with ${code}`);
      },
      environ_sizes_get: (count: number, size: number) => {
        new DataView(core.memory.buffer).setUint32(count, 0, true);
        new DataView(core.memory.buffer).setUint32(size, 0, true);
        return 0;
      },
      environ_get: nothing,
      fd_write: nothing,
      fd_close: nothing,
      fd_seek: nothing,
    },
  });
  core = instance.exports as unknown as Exports;
  core._initialize();
}

/** Calls with `text`; the answer, or why there is none. */
function called(call: Call, text: string): [boolean, string] {
  const bytes = new TextEncoder().encode(text);
  const at = core.core_room(bytes.length);
  new Uint8Array(core.memory.buffer, at, bytes.length).set(bytes);
  const refused = core[`core_${call}`]() !== 0;
  const answer = new Uint8Array(core.memory.buffer, core.core_answer(), core.core_answer_size());
  return [!refused, new TextDecoder().decode(answer)];
}

function give(numbers: Float64Array): void {
  const at = core.core_lines(numbers.length);
  new Float64Array(core.memory.buffer, at, numbers.length).set(numbers);
}

const taken = (count: number): Float64Array =>
  new Float64Array(core.memory.buffer, core.core_numbers(), count).slice();

function sweep(omega: Float64Array): Float64Array {
  give(omega);
  return taken(core.core_sweep());
}


scope.onmessage = async ({ data: { id, call, text, numbers } }) => {
  const begin = performance.now();
  const answer: Answered = { id, ok: true, text: '', milliseconds: 0 };
  try {
    if (call === 'start') await start(text);
    else {
      if (taking.includes(call) && numbers) give(numbers);
      [answer.ok, answer.text] = called(call, text);
      if (answer.ok && giving.includes(call)) answer.numbers = taken(Number(answer.text));
      else if (answer.ok && call === 'compute' && numbers) answer.numbers = sweep(numbers);
    }
  } catch (error) {
    answer.ok = false;
    answer.text = String(error);
  }
  answer.milliseconds = performance.now() - begin;
  scope.postMessage(answer, answer.numbers ? [answer.numbers.buffer] : []);
};
