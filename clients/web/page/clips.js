// clips.js: motions as head and body poses: the built-in clips and dropped BVH and CSV files, both by motion.c.
import { loadWasm } from '/awt/wasm.js';

export const BUILT_IN = ['lean', 'lean-forever', 'jump', 'run', 'shake'];
const module = loadWasm('/awt/motion.wasm');
const REST = [0, 1.6, 0];

class Clip {
  constructor(wasm, handle, name) {
    Object.assign(this, { wasm, handle, name });
    const { calls } = wasm;
    this.length_us = calls.clip_length_us(handle);
    this.repeats = calls.clip_repeat_us(handle) > 0;
    this.description = wasm.text(calls.clip_description(handle));
    const [x, y, z] = this.numbersAt(0);
    this.move = name === null ? [REST[0] - x, REST[1] - y, REST[2] - z] : [0, 0, 0]; /* a file may begin anywhere */
  }

  numbersAt(time_us) {
    return [...new Float64Array(this.wasm.calls.memory.buffer, this.wasm.calls.clip_at(this.handle, time_us), 14)];
  }

  /** { head, body } at a time from the clip's beginning; it holds at its end. */
  at(time_us) {
    const n = this.numbersAt(time_us), move = (from) => [0, 1, 2].map((k) => n[from + k] + this.move[k]);
    return { head: { position: move(0), orientation: n.slice(3, 7) }, body: { position: move(7), orientation: n.slice(10, 14) } };
  }

  dispose() {
    this.wasm.calls.clip_destroy(this.handle);
  }
}

export async function builtInClip(name) {
  const wasm = await module, bytes = new TextEncoder().encode(`${name}\0`);
  return new Clip(wasm, wasm.withBytes(bytes, (at) => wasm.calls.clip_builtin(at)), name);
}

/** Throws what is wrong with the file, for people. */
export async function fileClip(bytes) {
  const wasm = await module, handle = wasm.withBytes(bytes, (at, size) => wasm.calls.clip_read(at, size));
  if (!handle) {
    throw new Error(wasm.text(wasm.calls.clip_error()));
  }
  return new Clip(wasm, handle, null);
}
